//! A small streaming XML writer: escapes, closes what was opened, counts elements and bytes.

use std::fmt::{Display, Write as _};
use std::io::{self, Write};
use vtex_base::document::turns_text;

/// Size of the buffer, in bytes.
const BUFFER: usize = 1 << 16;

/// Numbers of elements and references that a viewer processes if it follows every `<use>`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ViewerLoad {
    pub(super) elements: u64,
    /// Number of references: those of `<use>`, gradients, masks and clip paths.
    pub(super) references: u64,
}

impl ViewerLoad {
    /// The difference to `before`.
    pub(super) fn since(self, before: Self) -> Self {
        Self { elements: self.elements - before.elements, references: self.references - before.references }
    }
}

/// Writes elements as they come; holds no more than a buffer and the names of open elements.
pub(super) struct Xml<W> {
    out: W,
    buffer: String,
    open: Vec<&'static str>,
    /// Whether the innermost start tag still lacks its `>`.
    in_tag: bool,
    bytes: u64,
    elements: u64,
    drawn: ViewerLoad,
}

impl<W: Write> Xml<W> {
    /// A document that begins with the given text, markup included.
    pub(super) fn new(out: W, prolog: &str) -> Self {
        let buffer = String::from(prolog);
        Self {
            out,
            buffer,
            open: Vec::new(),
            in_tag: false,
            bytes: 0,
            elements: 0,
            drawn: ViewerLoad::default(),
        }
    }

    /// Begins an element inside the one that is open.
    pub(super) fn open(&mut self, name: &'static str) {
        self.end_tag();
        self.buffer.push('<');
        self.buffer.push_str(name);
        self.open.push(name);
        self.in_tag = true;
        self.elements += 1;
        self.drawn.elements += 1;
    }

    /// Adds the load of the definition that the last `<use>` refers to.
    pub(super) fn follow(&mut self, used: ViewerLoad) {
        self.drawn.elements += used.elements;
        self.drawn.references += used.references;
    }

    /// The elements and references so far.
    pub(super) fn drawn(&self) -> ViewerLoad {
        self.drawn
    }

    /// An attribute of the element just begun.
    pub(super) fn attribute(&mut self, name: &str, value: impl Display) {
        debug_assert!(self.in_tag, "an attribute after the content of its element");
        let _ = write!(self.buffer, " {name}=\"");
        let start = self.buffer.len();
        let _ = write!(self.buffer, "{value}");
        self.drawn.references += u64::from(name == "xlink:href" || self.buffer[start..].starts_with("url(#"));
        self.escape_from(start);
        self.buffer.push('"');
    }

    /// Text inside the open element.
    pub(super) fn text(&mut self, text: &str) {
        self.end_tag();
        let start = self.buffer.len();
        self.buffer.push_str(text);
        self.escape_from(start);
    }

    /// Text inside the open element that needs no escapes.
    pub(super) fn raw_text(&mut self, text: &str) -> io::Result<()> {
        self.end_tag();
        self.buffer.push_str(text);
        if self.buffer.len() >= BUFFER { self.flush() } else { Ok(()) }
    }

    /// A line break, for people who read the file.
    pub(super) fn line(&mut self) {
        self.end_tag();
        self.buffer.push('\n');
    }

    /// Ends the innermost open element.
    pub(super) fn close(&mut self) -> io::Result<()> {
        if let Some(name) = self.open.pop() {
            if self.in_tag {
                self.buffer.push_str("/>");
                self.in_tag = false;
            } else {
                let _ = write!(self.buffer, "</{name}>");
            }
        }
        if self.buffer.len() >= BUFFER { self.flush() } else { Ok(()) }
    }

    /// Ends all open elements. Returns the bytes and elements written, and the load of a viewer.
    pub(super) fn finish(mut self) -> io::Result<(u64, u64, ViewerLoad)> {
        while !self.open.is_empty() {
            self.close()?;
        }
        self.buffer.push('\n');
        self.flush()?;
        self.out.flush()?;
        Ok((self.bytes, self.elements, self.drawn))
    }

    fn end_tag(&mut self) {
        if self.in_tag {
            self.buffer.push('>');
            self.in_tag = false;
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(self.buffer.as_bytes())?;
        self.bytes += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }

    /// Escapes the end of the buffer. What XML 1.0 cannot hold becomes U+FFFD.
    fn escape_from(&mut self, start: usize) {
        let plain = |c: char| matches!(c, ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
        let special = |c: char| matches!(c, '&' | '<' | '>' | '"') || turns_text(c) || !plain(c);
        if !self.buffer[start..].contains(special) {
            return;
        }
        for c in self.buffer.split_off(start).chars() {
            match c {
                '&' => self.buffer.push_str("&amp;"),
                '<' => self.buffer.push_str("&lt;"),
                '>' => self.buffer.push_str("&gt;"),
                '"' => self.buffer.push_str("&quot;"),
                '\n' | '\r' | '\t' => {
                    let _ = write!(self.buffer, "&#{};", u32::from(c));
                }
                c if turns_text(c) => {
                    let _ = write!(self.buffer, "&#x{:x};", u32::from(c));
                }
                c if plain(c) => self.buffer.push(c),
                _ => self.buffer.push('\u{fffd}'),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_text_comes_back(text in "\\PC*|[&<>\"'\n\t \u{202a}-\u{202e}\u{2066}\\]]*") {
            let mut bytes = Vec::new();
            let mut xml = Xml::new(&mut bytes, "");
            xml.open("a");
            xml.attribute("b", &text);
            xml.open("c");
            xml.text(&text);
            let (length, elements, _) = xml.finish().unwrap();
            prop_assert_eq!((length, elements), (bytes.len() as u64, 2));
            let source = String::from_utf8(bytes).unwrap();
            prop_assert!(!source.contains(turns_text));
            let document = roxmltree::Document::parse(&source).unwrap();
            let root = document.root_element();
            let possible = text.replace(['\u{fffe}', '\u{ffff}'], "\u{fffd}");
            prop_assert_eq!(root.attribute("b"), Some(&possible[..]));
            prop_assert_eq!(root.first_element_child().unwrap().text().unwrap_or(""), &possible[..]);
        }
    }
}
