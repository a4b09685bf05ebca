//! Versioned JSON documents, plain or gzip, such as libraries and scenes.
//!
//! Reading validates: afterwards every index is in range, every number finite and every run-length code adds
//! up, so no later stage checks again.

mod json_fault;

use crate::error::{Error, Result, clip, clip_to};
use crate::gzip;
use json_fault::in_plain_words;
use serde::de::{DeserializeOwned, DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde::{Deserializer, Serialize};
use std::borrow::Cow;
use std::path::Path;

/// A JSON document with a format name, a version and invariants.
pub trait Document: Serialize + DeserializeOwned {
    /// Value of the field `format`.
    const FORMAT: &'static str;
    /// Value of the field `version`.
    const VERSION: u32;

    /// Checks the invariants that types cannot express.
    ///
    /// # Errors A description of the first broken invariant.
    fn validate(&self) -> std::result::Result<(), String>;
}

/// Gives a document's type the names and functions that all documents have.
#[macro_export]
macro_rules! document {
    ($document:ty, $format:literal, $version:literal) => {
        impl $document {
            /// Value of the field `format`.
            pub const FORMAT: &'static str = $format;
            /// Value of the field `version`.
            pub const VERSION: u32 = $version;

            /// Reads and validates a file, plain or gzip.
            ///
            /// # Errors
            /// [`vtex_base::Error::Read`] for an unreadable file, else as `from_bytes`.
            pub fn read(path: &std::path::Path) -> $crate::Result<Self> {
                $crate::document::read(path)
            }

            /// Reads and validates bytes, plain or gzip; owned bytes are not copied. `name` appears in errors.
            ///
            /// # Errors
            /// [`vtex_base::Error::Version`] for a version that is not known,
            /// [`vtex_base::Error::Format`] for anything else that is not valid.
            pub fn from_bytes<'a>(
                bytes: impl Into<std::borrow::Cow<'a, [u8]>>,
                name: &str,
            ) -> $crate::Result<Self> {
                $crate::document::from_bytes(bytes, name)
            }

            /// The document as JSON, ending in a newline.
            pub fn to_json(&self) -> Vec<u8> {
                $crate::document::to_json(self)
            }
        }
    };
}

/// Reads and validates a document from a file.
pub fn read<T: Document>(path: &Path) -> Result<T> {
    let bytes = std::fs::read(path).map_err(|e| Error::read(path, e))?;
    from_bytes(bytes, &path.display().to_string())
}

/// Reads and validates a document from bytes, plain or gzip.
pub fn from_bytes<'a, T: Document>(bytes: impl Into<Cow<'a, [u8]>>, name: &str) -> Result<T> {
    let fail = |reason: String| Error::Format { name: name.into(), format: T::FORMAT, reason };
    let json = gzip::unpack(bytes, u64::MAX).map_err(fail)?;
    // Name and version first, so that another format is distinguished from a damaged file.
    let header = Header::of(&json).map_err(|e| fail(fault(&json, &e)))?;
    match header.format.as_deref() {
        Some(f) if f == T::FORMAT => {}
        Some(f) => return Err(fail(format!("its format is '{}'", clip(f)))),
        None => return Err(fail("it has no field 'format'".into())),
    }
    let Some(version) = header.version else { return Err(fail("it has no field 'version'".into())) };
    let known = u64::from(T::VERSION);
    if version != known {
        return Err(Error::Version { name: name.into(), format: T::FORMAT, found: version, known });
    }
    let json = without_seal(json);
    let parse = |json: &[u8]| serde_json::from_slice(json);
    let read = match parse(&json) {
        Err(e) if ends_at_seal(&json, &e) => match without_seal_elsewhere(&json) {
            Some(json) => parse(&json).map_err(|e| fault(&json, &e)),
            // An unbalanced brace before the seal makes it a field of another object.
            None => Err(braces(&json).unwrap_or_else(|| fault(&json, &e))),
        },
        read => read.map_err(|e| fault(&json, &e)),
    };
    let document: T = read.map_err(fail)?;
    document.validate().map_err(fail)?;
    Ok(document)
}

/// The message about a fault of a document.
fn fault(json: &[u8], error: &serde_json::Error) -> String {
    in_short(&in_plain_words(json, error))
}

/// Whether reading stopped at the name of a seal, which is no field of a document.
fn ends_at_seal(json: &[u8], error: &serde_json::Error) -> bool {
    let line = json.split(|byte| *byte == b'\n').nth(error.line().saturating_sub(1));
    let before = line.and_then(|line| line.get(..error.column()));
    error.is_data() && before.is_some_and(|text| text.trim_ascii_end().ends_with(b"\"sha256\""))
}

/// The message about unbalanced braces of a document; `None` if they are balanced.
fn braces(json: &[u8]) -> Option<String> {
    let broken = serde_json::from_slice::<IgnoredAny>(json).err()?;
    let place = format!("at line {} column {}", broken.line(), broken.column());
    let mut values = serde_json::Deserializer::from_slice(json).into_iter::<IgnoredAny>();
    Some(match values.next() {
        Some(Ok(_)) => {
            format!("something follows its last brace, {place}: a }} is too many, or a {{ is missing")
        }
        _ if broken.is_eof() => format!("it ends before its last brace, {place}: a }} is missing"),
        _ => broken.to_string(),
    })
}

/// Removes a long list of expected names from a message of the JSON reader.
pub fn without_list(message: String) -> String {
    const MOST: usize = 8;
    let Some((before, rest)) = message.split_once(", expected one of ") else { return message };
    // The names are in backquotes. After the last of them stands the place in the file.
    let (names, place) = rest.rsplit_once('`').unwrap_or((rest, ""));
    if names.matches("`, `").count() < MOST { message } else { format!("{before}{place}") }
}

/// A message of the JSON reader without the middle of long content that it quotes. The end says what is expected, and
/// where.
fn in_short(message: &str) -> String {
    const BEGINNING: usize = 100;
    const END: usize = 120;
    let count = message.chars().count();
    if count <= BEGINNING + END {
        return message.to_owned();
    }
    let end: String = message.chars().skip(count - END).collect();
    format!("{} … {end}", clip_to(message, BEGINNING))
}

/// The fields that identify a document.
#[derive(Default)]
struct Header {
    format: Option<String>,
    version: Option<u64>,
}

impl Header {
    /// Stops after the second of the fields, which come first; the rest is read with the document.
    fn of(json: &[u8]) -> serde_json::Result<Self> {
        let mut header = Self::default();
        let read = HeaderVisitor(&mut header).deserialize(&mut serde_json::Deserializer::from_slice(json));
        if header.format.is_some() && header.version.is_some() {
            return Ok(header);
        }
        read.map(|()| header)
    }
}

struct HeaderVisitor<'a>(&'a mut Header);

impl<'de> DeserializeSeed<'de> for HeaderVisitor<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> std::result::Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for HeaderVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<(), A::Error> {
        let Header { format, version } = self.0;
        while format.is_none() || version.is_none() {
            match map.next_key::<String>()?.as_deref() {
                Some("format") => *format = map.next_value()?,
                Some("version") => *version = map.next_value()?,
                Some(_) => _ = map.next_value::<IgnoredAny>()?,
                None => break,
            }
        }
        Ok(())
    }
}

/// A document without the seal that files of vtex have as their last field, `sha256`.
fn without_seal(json: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    const DIGITS: usize = 64;
    let end = || {
        let rest = json.trim_ascii_end().strip_suffix(b"}")?.trim_ascii_end().strip_suffix(b"\"")?;
        let (rest, sum) = rest.split_at_checked(rest.len().checked_sub(DIGITS)?)?;
        let rest = rest.strip_suffix(b"\"")?.trim_ascii_end().strip_suffix(b":")?.trim_ascii_end();
        let rest = rest.strip_suffix(b"\"sha256\"")?.trim_ascii_end().strip_suffix(b",")?;
        sum.iter().all(u8::is_ascii_hexdigit).then_some(rest.len())
    };
    let Some(end) = end() else { return json };
    let mut rest = json.into_owned();
    rest.truncate(end);
    rest.push(b'}');
    rest.into()
}

/// A document without its seal, if another program has reordered the fields so that the seal is not last;
/// `None` if there is no seal.
fn without_seal_elsewhere(json: &[u8]) -> Option<Vec<u8>> {
    let mut fields: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(json).ok()?;
    fields.remove("sha256")?;
    serde_json::to_vec(&fields).ok()
}

/// The document as JSON, ending in a newline.
pub fn to_json<T: Document>(document: &T) -> Vec<u8> {
    let text = serde_json::to_string(document).expect("documents hold nothing that JSON cannot");
    let mut bytes = json_in_order(text).into_bytes();
    bytes.push(b'\n');
    bytes
}

/// Whether a character changes the direction of the text after it, so that the displayed order differs from
/// the stored one: embeddings, overrides and isolates.
pub fn turns_text(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text with a replacement for each character that [`turns_text`].
pub fn in_order(text: String) -> String {
    if text.contains(turns_text) { text.replace(turns_text, "\u{fffd}") } else { text }
}

/// JSON with an escape for each character that [`turns_text`]; they occur only in strings.
pub fn json_in_order(json: String) -> String {
    if !json.contains(turns_text) {
        return json;
    }
    let mut escaped = String::with_capacity(json.len() + 64);
    for c in json.chars() {
        if turns_text(c) { escaped += &format!("\\u{:04x}", u32::from(c)) } else { escaped.push(c) }
    }
    escaped
}

/// Whether a name of a category is valid in all formats: 1 to 100 letters, digits, blanks and hyphens.
pub fn is_category_name(name: &str) -> bool {
    (1..=100).contains(&name.chars().count())
        && name.chars().all(|c| c.is_alphanumeric() || c == ' ' || c == '-')
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_header_is_read_as_far_as_it_reaches() {
        let of = |text: &str| super::Header::of(text.as_bytes()).map(|h| (h.format, h.version));
        assert_eq!(of(r#"{"format":"x","version":2,"rest":"#).unwrap(), (Some("x".into()), Some(2)));
        assert_eq!(of(r#"{"a":[1,{}],"version":2}"#).unwrap(), (None, Some(2)));
        for wrong in ["", "[]", r#"{"format":"x""#, r#"{"format":7}"#, r#"{"version":-1}"#] {
            assert!(of(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn long_lists_of_names_are_left_out() {
        let list = |count: usize| (0..count).map(|k| format!("`n{k}`")).collect::<Vec<_>>().join(", ");
        let message =
            |count: usize| format!("unknown field `x`, expected one of {} at line 1 column 2", list(count));
        assert_eq!(super::without_list(message(5)), message(5));
        assert_eq!(super::without_list(message(25)), "unknown field `x` at line 1 column 2");
        assert_eq!(super::without_list("trailing comma".into()), "trailing comma");
    }

    #[test]
    fn long_content_is_quoted_in_part() {
        let long = format!("invalid type: string \"{}\", expected f64 at line 1 column 9", "z".repeat(900));
        let short = super::in_short(&long);
        assert!(short.chars().count() < 230, "{short}");
        assert!(
            short.starts_with("invalid type: string \"zz")
                && short.ends_with("expected f64 at line 1 column 9")
        );
        assert_eq!(super::in_short("trailing comma"), "trailing comma");
    }

    #[test]
    fn text_that_turns_its_direction_is_written_in_order() {
        assert_eq!(super::json_in_order("[\"a\u{202e}b\u{2066}\"]".into()), r#"["a\u202eb\u2066"]"#);
        assert_eq!(super::in_order("a\u{202e}b".into()), "a\u{fffd}b");
    }

    #[test]
    fn a_seal_is_left_out_wherever_it_stands() {
        let sum = "0a".repeat(32);
        let plain = r#"{"format":"x","a":{"sha256":"y"}}"#;
        let without_seal = |text: &str| super::without_seal(text.as_bytes().to_vec().into()).into_owned();
        assert_eq!(without_seal(plain), plain.as_bytes());
        let sealed = format!("{},\"sha256\":\"{sum}\"}}\n", &plain[..plain.len() - 1]);
        assert_eq!(without_seal(&sealed), plain.as_bytes());
        let spread = sealed.replace(",\"sha256\":\"0", ",\n  \"sha256\": \"0").replace("}\n", "\n}\n\n");
        assert_eq!(without_seal(&spread), plain.as_bytes());
        let moved = format!("{{\"sha256\":\"{sum}\",\"format\":7,\"z\":[1.5]}}");
        assert_eq!(without_seal(&moved), moved.as_bytes());
        let elsewhere = super::without_seal_elsewhere(moved.as_bytes()).unwrap();
        assert_eq!(elsewhere, br#"{"format":7,"z":[1.5]}"#);
        assert_eq!(super::without_seal_elsewhere(plain.as_bytes()), None);
        for other in ["", "}", "\"}", "[1]", "{\"sha256\":1", &sum] {
            assert_eq!(without_seal(other), other.as_bytes());
        }
    }
}
