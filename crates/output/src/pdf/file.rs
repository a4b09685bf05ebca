//! A PDF file: numbered objects and the table of their offsets.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter, Result as FormatResult};
use std::io::{Result, Write};

/// The first bytes of every file: the version, and bytes that mark it as binary.
const HEAD: &[u8] = b"%PDF-1.7\n%\xff\xff\xff\xff\n";

/// The number of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Ref(usize);

impl Display for Ref {
    fn fmt(&self, f: &mut Formatter<'_>) -> FormatResult {
        write!(f, "{} 0 R", self.0 + 1)
    }
}

/// The objects of a file.
#[derive(Default)]
pub(super) struct File {
    objects: Vec<Vec<u8>>,
    /// The objects without a stream, by content. Equal ones are written once.
    by_content: BTreeMap<String, Ref>,
}

impl File {
    /// Reserves a number for an object that is added later.
    pub(super) fn reserve(&mut self) -> Ref {
        self.objects.push(Vec::new());
        Ref(self.objects.len() - 1)
    }

    /// Gives a reserved number its object.
    pub(super) fn put(&mut self, number: Ref, object: String) {
        self.objects[number.0] = object.into_bytes();
    }

    /// Adds an object.
    pub(super) fn add(&mut self, object: String) -> Ref {
        if let Some(number) = self.by_content.get(&object) {
            return *number;
        }
        let number = self.reserve();
        self.put(number, object.clone());
        self.by_content.insert(object, number);
        number
    }

    /// Adds an unpacked stream.
    pub(super) fn add_text(&mut self, content: &str) -> Ref {
        self.push_stream("", content.as_bytes())
    }

    /// Adds a stream, packed if that is shorter; `entries` are further entries of its dictionary.
    pub(super) fn add_stream(&mut self, entries: &str, content: &str) -> Result<Ref> {
        const FILTER: &str = "/Filter /FlateDecode";
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
        packer.write_all(content.as_bytes())?;
        let packed = packer.finish()?;
        Ok(if packed.len() + FILTER.len() < content.len() {
            self.push_stream(&format!("{entries}{FILTER}"), &packed)
        } else {
            self.push_stream(entries, content.as_bytes())
        })
    }

    fn push_stream(&mut self, entries: &str, content: &[u8]) -> Ref {
        let mut object = format!("<<{entries}/Length {}>>\nstream\n", content.len()).into_bytes();
        object.extend_from_slice(content);
        object.extend_from_slice(b"\nendstream");
        self.objects.push(object);
        Ref(self.objects.len() - 1)
    }

    /// The bytes of the file.
    pub(super) fn finish(self, catalog: Ref, information: Ref) -> Vec<u8> {
        let mut out = HEAD.to_vec();
        let count = self.objects.len() + 1;
        let mut table = format!("xref\n0 {count}\n0000000000 65535 f\r\n");
        for (k, object) in self.objects.iter().enumerate() {
            table += &format!("{:010} 00000 n\r\n", out.len());
            out.extend_from_slice(format!("{} 0 obj\n", k + 1).as_bytes());
            out.extend_from_slice(object);
            out.extend_from_slice(b"\nendobj\n");
        }
        let id: String = Sha256::digest(&out)[..16].iter().map(|b| format!("{b:02x}")).collect();
        let trailer = format!(
            "trailer\n<</Size {count}/Root {catalog}/Info {information}/ID [<{id}> <{id}>]>>\nstartxref\n{}\n%%EOF",
            out.len()
        );
        out.extend_from_slice(table.as_bytes());
        out.extend_from_slice(trailer.as_bytes());
        out
    }
}

/// A text string: in parentheses if all its characters are printable ASCII, else in UTF-16.
pub(super) fn text(text: &str) -> String {
    if !text.chars().all(|c| matches!(c, ' '..='~')) {
        let digits: String = text.encode_utf16().map(|unit| format!("{unit:04X}")).collect();
        return format!("<FEFF{digits}>");
    }
    let escaped = text.replace('\\', "\\\\").replace('(', "\\(").replace(')', "\\)");
    format!("({escaped})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_objects_are_one_and_short_streams_stay_plain() {
        let mut file = File::default();
        assert_eq!(file.add("<</A 1>>".into()), file.add("<</A 1>>".into()));
        assert_ne!(file.add("<</A 2>>".into()), file.add("<</A 1>>".into()));
        let short = file.add_stream("/Kind /Short", "0 0 m").unwrap();
        let long = file.add_stream("", &"0 0 m ".repeat(100)).unwrap();
        assert_eq!(file.objects[short.0], b"<</Kind /Short/Length 5>>\nstream\n0 0 m\nendstream");
        assert!(file.objects[long.0].len() < 100);
        let reserved = file.reserve();
        file.put(reserved, format!("<</Long {long}>>"));
        assert_eq!(file.objects[reserved.0], b"<</Long 4 0 R>>");
    }

    #[test]
    fn texts_are_plain_or_utf_16() {
        assert_eq!(text("stones (2)\\x"), "(stones \\(2\\)\\\\x)");
        assert_eq!(text("é😀"), "<FEFF00E9D83DDE00>");
    }
}
