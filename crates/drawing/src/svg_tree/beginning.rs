//! Recognises an SVG by its root, however much of what XML allows stands before it.

use super::LARGEST_TEXT;
use std::borrow::Cow;
use vtex_base::gzip;

/// Number of bytes in which the root of most SVGs begins.
const HEAD: usize = 4096;

/// Whether bytes, plain or gzip, begin as an SVG does, in UTF-16 too, which [`super::text`] then refuses.
pub(crate) fn is_svg(bytes: &[u8]) -> bool {
    let head = gzip::beginning(bytes, HEAD);
    let head = characters(&head);
    let head = without_blanks(&head);
    if !head.starts_with('<') {
        return false;
    }
    // A web page that shows an SVG counts as one, so that the error names the root of the page.
    if head.contains("<svg") {
        return true;
    }
    if let Some(is_svg) = has_svg_root(head) {
        return is_svg;
    }
    match gzip::unpack(bytes, LARGEST_TEXT as u64) {
        Ok(whole) => has_svg_root(without_blanks(&characters(&whole))) == Some(true),
        // The reader of the whole file says what is wrong with it.
        Err(_) => true,
    }
}

/// Bytes as text; of UTF-16, the characters of ASCII.
fn characters(bytes: &[u8]) -> Cow<'_, str> {
    if matches!(bytes.get(..2), Some([0xff, 0xfe] | [0xfe, 0xff])) {
        bytes.iter().filter(|b| b.is_ascii() && **b != 0).map(|b| char::from(*b)).collect()
    } else {
        String::from_utf8_lossy(bytes)
    }
}

fn without_blanks(text: &str) -> &str {
    text.trim_start_matches('\u{feff}').trim_start()
}

/// Whether the first element of a text is `<svg>`, with or without a prefix; `None` if the text ends before that is
/// known.
fn has_svg_root(text: &str) -> Option<bool> {
    let mut rest = text;
    loop {
        let behind = if rest.starts_with("<!--") {
            after(rest, "-->")
        } else if rest.starts_with("<?") {
            after(rest, "?>")
        } else if rest.starts_with("<!DOCTYPE") {
            after_doctype(rest)
        } else {
            break;
        };
        rest = behind?.trim_start();
    }
    let Some(tag) = rest.strip_prefix('<') else {
        return (!rest.is_empty()).then_some(false);
    };
    let end = tag.find(|c: char| c.is_whitespace() || c == '/' || c == '>');
    let name = &tag[..end.unwrap_or(tag.len())];
    let is_svg = name == "svg" || name.ends_with(":svg");
    (is_svg || end.is_some()).then_some(is_svg)
}

/// The text behind the first occurrence of an end.
fn after<'a>(text: &'a str, end: &str) -> Option<&'a str> {
    text.split_once(end).map(|(_, rest)| rest)
}

/// The text behind a DOCTYPE. It may hold declarations in brackets, with quoted values and comments.
fn after_doctype(text: &str) -> Option<&str> {
    let (mut rest, mut is_in_brackets) = (&text[1..], false);
    loop {
        let here = &rest[rest.find(['"', '\'', '[', ']', '<', '>'])?..];
        rest = match here.as_bytes()[0] {
            b'"' => after(&here[1..], "\"")?,
            b'\'' => after(&here[1..], "'")?,
            b'<' if here.starts_with("<!--") => after(here, "-->")?,
            b'<' if here.starts_with("<?") => after(here, "?>")?,
            b'>' if !is_in_brackets => return Some(&here[1..]),
            sign => {
                is_in_brackets = sign == b'[' || (is_in_brackets && sign != b']');
                &here[1..]
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_svg_is_recognised_behind_anything_that_may_precede_its_root() {
        let long = "a < b > c 'd ".repeat(1000);
        let doctype =
            format!("<!DOCTYPE svg [<!-- don't ] --><!ENTITY a \"]>{long}\"><?p ]> ' ?><!ENTITY b 'x'>]>");
        for before in [
            String::new(),
            format!("<!--{long}-->"),
            format!("<?xml version='1.0'?>\n<!--{long}-->\n<?style {long}?> <!--<html>-->"),
            format!("<!DOCTYPE svg PUBLIC '{}' \"b\">", "a>".repeat(3000)),
            doctype,
        ] {
            for root in ["<svg/>", "<svg", "<svg:svg xmlns:svg='a'>", "<s:svg>"] {
                let text = format!("\u{feff} {before}{root}");
                assert!(is_svg(text.as_bytes()), "{root} behind {} bytes", before.len());
            }
            for other in ["", "<", "<html>", "text", "<!-- and no end <s:svg>"] {
                let text = format!("{before}{other}");
                assert!(!is_svg(text.as_bytes()), "{other} behind {} bytes", before.len());
            }
        }
        let wide: Vec<u8> =
            format!("\u{feff}<!--{long}--><svg/>").encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(is_svg(&wide));
        assert!(!is_svg(b"") && !is_svg(b"\x1f\x8b damaged") && !is_svg(b"{\"svg\":1}"));
    }
}
