//! Faults of a JSON file in plain words: which entry of the file it is, and what belongs there.

use super::without_list;
use crate::error::clip;
use std::borrow::Cow;

/// A message of the JSON reader, which names types of this program, in the words of the file.
pub(crate) fn in_plain_words(json: &[u8], error: &serde_json::Error) -> String {
    let whole = error.to_string();
    let position = format!(" at line {} column {}", error.line(), error.column());
    let Some(text) = whole.strip_suffix(&position) else { return whole };
    if error.is_eof() {
        return format!("it ends too early{position}");
    }
    if error.is_syntax() {
        return format!("it is not valid JSON: {text}{position}");
    }
    let text = without_list(text.to_owned());
    let mut entry = entry_at(read_up_to(json, error));
    if text.starts_with("unknown field") {
        // The message names it.
        entry.truncate(entry.rfind('.').unwrap_or(0));
    }
    let entry = if entry.is_empty() { entry } else { format!("{entry}: ") };
    format!("{entry}{}{position}", expectation(&text))
}

/// The bytes that were read before an error.
fn read_up_to<'a>(json: &'a [u8], error: &serde_json::Error) -> &'a [u8] {
    let lines = json.split_inclusive(|byte| *byte == b'\n');
    let before: usize = lines.take(error.line().saturating_sub(1)).map(<[u8]>::len).sum();
    &json[..json.len().min(before + error.column())]
}

/// What was found and what is expected, without types of this program.
fn expectation(text: &str) -> String {
    let found = |what: &str| match what {
        "sequence" => "a list".to_owned(),
        "map" => "an object".to_owned(),
        other => other.to_owned(),
    };
    let Some((what, expected)) = text.split_once(", expected ") else { return text.to_owned() };
    let what = if let Some(what) = what.strip_prefix("invalid type: ") {
        format!("found {}", found(what))
    } else if let Some(what) = what.strip_prefix("invalid value: ") {
        format!("found {}", found(what))
    } else if let Some(length) = what.strip_prefix("invalid length ") {
        format!("found a list of {length}")
    } else {
        what.to_owned()
    };
    format!("{what}, expected {}", plain_type(expected))
}

/// A type of this program as it is in JSON.
fn plain_type(expected: &str) -> Cow<'_, str> {
    let up_to = |most: u64| Cow::<str>::Owned(format!("a whole number from 0 to {most}"));
    match expected {
        "a sequence" => "a list".into(),
        "a map" => "an object".into(),
        "a boolean" => "true or false".into(),
        "f32" | "f64" => "a number".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "u8" => up_to(u8::MAX.into()),
        "u16" => up_to(u16::MAX.into()),
        "u32" => up_to(u32::MAX.into()),
        "u64" | "usize" => "a whole number from 0".into(),
        _ if expected.starts_with("struct ") => "an object".into(),
        _ => {
            let lists = ["an array of length ", "a tuple of size "];
            let length = lists.iter().find_map(|list| expected.strip_prefix(list));
            length.map_or(expected.into(), |length| format!("a list of {length}").into())
        }
    }
}

/// An object or a list that has begun and not ended: the key of the entry at hand, empty before the first, or its index.
enum Level {
    Object(String),
    List(Option<usize>),
}

/// The entry in which a JSON text stops, such as `layers[2].name`; empty outside of all.
fn entry_at(json: &[u8]) -> String {
    let mut levels: Vec<Level> = Vec::new();
    let mut at = 0;
    while let Some(&byte) = json.get(at) {
        at += 1;
        let is_value = !byte.is_ascii_whitespace() && byte != b']';
        if let (Some(Level::List(index @ None)), true) = (levels.last_mut(), is_value) {
            *index = Some(0);
        }
        match (byte, levels.last_mut()) {
            (b'{', _) => levels.push(Level::Object(String::new())),
            (b'[', _) => levels.push(Level::List(None)),
            (b'}' | b']', _) => drop(levels.pop()),
            (b',', Some(Level::List(Some(index)))) => *index += 1,
            (b',', Some(Level::Object(key))) => key.clear(),
            (b'"', level) => {
                let length = string_length(&json[at..]);
                if let Some(Level::Object(key)) = level
                    && key.is_empty()
                {
                    *key = clip(&String::from_utf8_lossy(&json[at..at + length]));
                }
                at += length + 1;
            }
            _ => {}
        }
    }
    levels.iter().fold(String::new(), |path, level| match level {
        Level::Object(key) if path.is_empty() || key.is_empty() => path + key,
        Level::Object(key) => path + "." + key,
        Level::List(Some(index)) => format!("{path}[{index}]"),
        Level::List(None) => path,
    })
}

/// Number of bytes before the quote that ends a string, or all of them.
fn string_length(json: &[u8]) -> usize {
    let mut is_escaped = false;
    let ends = |byte: &u8| {
        let ends = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && !is_escaped;
        ends
    };
    json.iter().position(ends).unwrap_or(json.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        size: u16,
        ratio: Option<f64>,
        pair: Option<[bool; 2]>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    struct Outer {
        all: Vec<Inner>,
        name: Option<String>,
    }

    #[test]
    fn faults_name_their_entry_and_no_type() {
        let sound = Outer { all: vec![Inner { size: 1, ratio: None, pair: None }], name: None };
        assert_eq!(serde_json::from_str::<Outer>(r#"{"all":[{"size":1}]}"#).unwrap(), sound);
        for (json, said) in [
            (r#"{"name":"a\"]","all":[{"size":1},7]}"#, "all[1]: found integer `7`, expected an object"),
            (r#"{"all":{}}"#, "all: found an object, expected a list"),
            (r#"{"all":[{"size":-1}]}"#, "all[0].size: found integer `-1`, expected a whole number from 0"),
            (r#"{"all":[{"size":1,"ratio":"x"}]}"#, "all[0].ratio: found string \"x\", expected a number"),
            (r#"{"all":[{"size":1,"pair":[true]}]}"#, "found a list of 1, expected a list of 2"),
            (r#"{"all":[{"ratio":1}]}"#, "all[0]: missing field `size`"),
            (r#"{"all":[{"size":1},{"b":2}]}"#, "all[1]: unknown field `b`"),
            ("{\"all\":\n [],\n \"name\": 7}", "name: found integer `7`, expected a string at line 3 column"),
            (r#"{"all":["#, "it ends too early at line 1 column 8"),
            ("hello", "it is not valid JSON: expected value at line 1 column 1"),
        ] {
            let error = serde_json::from_str::<Outer>(json).unwrap_err();
            let found = in_plain_words(json.as_bytes(), &error);
            assert!(found.contains(said), "{json}: {found}");
            assert!(!found.contains("struct") && !found.contains("u16"), "{found}");
        }
    }
}
