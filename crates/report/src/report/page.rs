//! The page's HTML: a frame, a style sheet, a script, data, and compressed pictures.
//!
//! The output is both HTML and well-formed XML, so it can be validated.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;
use std::io::{self, Write};
use vtex_base::document::turns_text;
use vtex_output::formats::PAGE_BEGINNING;

const FRAME: &str = include_str!("page/frame.html");
const STYLE: &str = include_str!("page/style.css");
/// The parts of the script, in order of dependency.
const SCRIPT: [&str; 9] = [
    include_str!("page/base.js"),
    include_str!("page/pictures.js"),
    include_str!("page/moving.js"),
    include_str!("page/layers.js"),
    include_str!("page/categories.js"),
    include_str!("page/surroundings.js"),
    include_str!("page/plots.js"),
    include_str!("page/facts.js"),
    include_str!("page/start.js"),
];

/// A file that is part of the page.
pub(super) struct Embedded<'a> {
    /// Its id on the page.
    pub(super) id: String,
    /// Media type of its uncompressed content.
    pub(super) media_type: &'static str,
    /// Whether it is compressed.
    pub(super) gzip: bool,
    pub(super) bytes: Cow<'a, [u8]>,
}

/// The contents of a page.
pub(super) struct ReportPage<'a> {
    pub(super) title: String,
    /// Data for the script.
    pub(super) json: String,
    pub(super) files: Vec<Embedded<'a>>,
}

impl ReportPage<'_> {
    /// Writes the page.
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let program = vtex_base::PROGRAM.strip_prefix("vtex ").unwrap_or_default();
        writeln!(out, "{PAGE_BEGINNING}{program} -->")?;
        // Only the frame is searched for placeholders, never the text inserted.
        let mut parts = FRAME.split("{{");
        out.write_all(parts.next().unwrap_or_default().as_bytes())?;
        for part in parts {
            let (mark, rest) = part.split_once("}}").unwrap_or((part, ""));
            match mark {
                "title" => out.write_all(text(&self.title).as_bytes())?,
                "program" => out.write_all(vtex_base::PROGRAM.as_bytes())?,
                "style" => out.write_all(STYLE.as_bytes())?,
                "data" => out.write_all(script_data(&self.json).as_bytes())?,
                "files" => self.write_files(out)?,
                "script" => SCRIPT.iter().try_for_each(|part| out.write_all(part.as_bytes()))?,
                other => debug_assert!(false, "the frame has the unknown mark {other}"),
            }
            out.write_all(rest.as_bytes())?;
        }
        out.flush()
    }

    fn write_files(&self, out: &mut impl Write) -> io::Result<()> {
        for file in &self.files {
            let Embedded { id, media_type, gzip, bytes } = file;
            write!(out, "<script type=\"text/plain\" id=\"{id}\" data-type=\"{media_type}\"")?;
            writeln!(out, " data-gzip=\"{gzip}\">{}</script>", STANDARD.encode(bytes))?;
        }
        Ok(())
    }
}

/// Text as element content: escaped, without characters that HTML or XML forbid.
fn text(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            c if turns_text(c) => escaped.push('\u{fffd}'),
            ' '..='\u{7e}' | '\u{a0}'..='\u{fffd}' | '\u{10000}'.. => escaped.push(c),
            _ => escaped.push('\u{fffd}'),
        }
    }
    escaped
}

/// JSON as content of a `<script>`: characters that could end the element or begin markup are
/// escaped by `\u`. They occur only in strings.
fn script_data(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            // The page shows its data as text.
            c if turns_text(c) => escaped.push('\u{fffd}'),
            '<' | '>' | '&' | '\u{7f}'..='\u{9f}' | '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}' => {
                escaped.push_str(&format!("\\u{:04x}", u32::from(c)));
            }
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_data_comes_back(words in proptest::collection::vec("\\PC*|[<>&\"'\\\\/!\u{0}\u{7f}-\u{9f}\u{2028}\u{fffe}-]*", 1..4)) {
            let json = serde_json::to_string(&words).unwrap();
            let page = ReportPage { title: words.concat(), json, files: Vec::new() };
            let mut bytes = Vec::new();
            page.write(&mut bytes).unwrap();
            let page = String::from_utf8(bytes).unwrap();
            let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
            let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
            let data = document.descendants().find(|n| n.attribute("id") == Some("data")).unwrap();
            let text = data.text().unwrap();
            prop_assert!(!text.contains(['<', '>', '&']));
            prop_assert_eq!(serde_json::from_str::<Vec<String>>(text).unwrap(), words);
        }
    }
}
