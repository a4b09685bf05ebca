//! Makes text of files, names and other programs safe for a terminal: it cannot move the cursor, change
//! colours or fill the screen.

/// Most characters of a line that is made of foreign text.
const LONGEST: usize = 600;

/// Whether a character would control the terminal, or change how adjacent characters are displayed.
fn controls_terminal(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// The text with every character that would control the terminal escaped, as in `\u{1b}`.
pub(crate) fn escaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if controls_terminal(c) { plain.extend(c.escape_default()) } else { plain.push(c) }
    }
    plain
}

/// JSON with every character that would control the terminal escaped as in `\u202e`; line breaks occur
/// between values only, and stay.
pub(crate) fn escaped_json(json: &str) -> String {
    let mut plain = String::with_capacity(json.len());
    for c in json.chars() {
        if c != '\n' && controls_terminal(c) {
            plain += &format!("\\u{:04x}", u32::from(c))
        } else {
            plain.push(c)
        }
    }
    plain
}

/// A text on one line of limited length: [`escaped`], line breaks as blanks, the middle left out.
pub(crate) fn line(text: &str) -> String {
    let words: Vec<&str> = text.split(['\n', '\r']).map(str::trim).filter(|part| !part.is_empty()).collect();
    let plain = escaped(&words.join(" "));
    let count = plain.chars().count();
    if count <= LONGEST {
        return plain;
    }
    // The end is kept because it often states the cause.
    let end = LONGEST / 3;
    let beginning: String = plain.chars().take(LONGEST - end).collect();
    let end: String = plain.chars().skip(count - end).collect();
    format!("{beginning} … {end}")
}

/// A text of several lines, limited in the length and number of lines.
pub(crate) fn in_lines(text: &str) -> String {
    let cut = |one: &str| {
        let indent: String = one.chars().take_while(|c| *c == ' ').collect();
        indent + &line(one)
    };
    text.lines().take(60).map(cut).collect::<Vec<_>>().join("\n")
}

/// The first characters of a text, and a mark if there are more.
pub(crate) fn cut(text: &str, characters: usize) -> String {
    match text.char_indices().nth(characters) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text.to_owned(),
    }
}

/// A text of several lines. Styles of vtex are kept; all other control characters are escaped.
pub(crate) fn styled(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let style = rest.strip_prefix("\u{1b}[").and_then(|after| {
            let end = after.find(|c: char| !c.is_ascii_digit() && c != ';')?;
            after[end..].starts_with('m').then_some(2 + end + 1)
        });
        let length = style.unwrap_or(c.len_utf8());
        let part = &rest[..length];
        if style.is_some() || c == '\n' {
            plain.push_str(part)
        } else {
            plain.push_str(&escaped(part))
        }
        rest = &rest[length..];
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_acts_on_a_terminal() {
        assert_eq!(escaped("a\u{1b}[2Jb\u{7}\u{9b}ä\u{202e}"), "a\\u{1b}[2Jb\\u{7}\\u{9b}ä\\u{202e}");
        assert_eq!(line(" one\n  two\r\nthree "), "one two three");
        let long = line(&format!("begin{}end", "x".repeat(5000)));
        assert!(long.starts_with("begin") && long.ends_with("end") && long.chars().count() < 700);
        assert_eq!((cut("äöü", 2), cut("äöü", 3)), ("äö…".into(), "äöü".into()));
        assert_eq!(
            styled("\u{1b}[1mhead\u{1b}[0m\n\u{1b}]0;x\u{7}\tb"),
            "\u{1b}[1mhead\u{1b}[0m\n\\u{1b}]0;x\\u{7}\\tb"
        );
        assert_eq!(styled("\u{1b}[12"), "\\u{1b}[12");
        assert_eq!(
            escaped_json("{\n  \"a\": \"\u{202e}b\u{9b}2J\u{2066}ä\"\n}"),
            "{\n  \"a\": \"\\u202eb\\u009b2J\\u2066ä\"\n}"
        );
    }
}
