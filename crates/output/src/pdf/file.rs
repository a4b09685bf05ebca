//! The objects of a PDF file. Those without a stream are packed in streams of objects, which PDF has since version 1.5:
//! there are many, and they are alike.

use flate2::Compression;
use flate2::read::ZlibEncoder;
use pdf_writer::writers::FormXObject;
use pdf_writer::{Chunk, Filter, Name, Obj, Pdf, Ref, Settings, XRefFilter};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Read;

/// No spaces and line breaks that only people need.
pub(super) const COMPACT: Settings = Settings { pretty: false };
/// Objects that are packed together: a reader unpacks all of them for one.
const TOGETHER: usize = 200;

/// The objects of a file.
pub(super) struct File {
    pub(super) pdf: Pdf,
    /// The number of the next object.
    next: Ref,
    /// The objects that will be packed, in their order, and the number of each by its content. Equal ones are one.
    packed: Vec<(Ref, Vec<u8>)>,
    by_content: BTreeMap<Vec<u8>, Ref>,
}

impl File {
    pub(super) fn new() -> Self {
        let pdf = Pdf::with_settings(COMPACT);
        Self { pdf, next: Ref::new(1), packed: Vec::new(), by_content: BTreeMap::new() }
    }

    /// Reserves a number for an object that is written to `pdf`.
    pub(super) fn reserve(&mut self) -> Ref {
        self.next.bump()
    }

    /// Adds an object without a stream.
    pub(super) fn add(&mut self, write: impl FnOnce(Obj<'_>)) -> Ref {
        let mut chunk = Chunk::with_settings(COMPACT);
        write(chunk.indirect(self.next));
        // The first line is the number, the last one the end.
        let lines = chunk.as_bytes().splitn(2, |byte| *byte == b'\n').nth(1).unwrap_or_default();
        let content = lines.strip_suffix(b"\nendobj\n").unwrap_or(lines);
        if let Some(number) = self.by_content.get(content) {
            return *number;
        }
        self.by_content.insert(content.to_vec(), self.next);
        self.packed.push((self.next, content.to_vec()));
        self.reserve()
    }

    /// Adds a form, packed if that is shorter; `entries` writes its dictionary.
    pub(super) fn add_form(&mut self, content: &[u8], entries: impl FnOnce(&mut FormXObject<'_>)) -> Ref {
        let number = self.reserve();
        let packed = pack(content);
        let is_shorter = packed.len() + "/Filter/FlateDecode".len() < content.len();
        let mut form = self.pdf.form_xobject(number, if is_shorter { &packed } else { content });
        if is_shorter {
            form.filter(Filter::FlateDecode);
        }
        entries(&mut form);
        number
    }

    /// The bytes of the file.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let mut places = Vec::new();
        for objects in std::mem::take(&mut self.packed).chunks(TOGETHER) {
            let stream = self.reserve();
            let (mut numbers, mut contents) = (String::new(), Vec::new());
            for (k, (number, content)) in objects.iter().enumerate() {
                let _ = write!(numbers, "{} {} ", number.get(), contents.len());
                contents.extend_from_slice(content);
                contents.push(b'\n');
                places.push((*number, stream, k as u16));
            }
            let all = pack(&[numbers.as_bytes(), &contents].concat());
            let mut out = self.pdf.stream(stream, &all);
            out.filter(Filter::FlateDecode).pair(Name(b"Type"), Name(b"ObjStm"));
            out.pair(Name(b"N"), objects.len() as i32).pair(Name(b"First"), numbers.len() as i32);
        }
        let id = Sha256::digest(self.pdf.as_bytes())[..16].to_vec();
        self.pdf.set_file_id((id.clone(), id));
        let own = self.next;
        self.pdf.finish_with_xref_stream_and_filter(own, |table| {
            // The library takes packed objects for missing ones: an entry is a kind (0 for missing, 2 for packed), the
            // stream, and the index in it.
            let mut table = table.to_vec();
            let width = table.len() / (own.get() as usize + 1);
            table[1..width - 2].fill(0);
            for (number, stream, index) in places {
                let (kind, place) = table[number.get() as usize * width..][..width].split_at_mut(1);
                let (place, end) = place.split_at_mut(width - 3);
                kind[0] = 2;
                place.copy_from_slice(&u64::to_be_bytes(stream.get() as u64)[8 - place.len()..]);
                end.copy_from_slice(&index.to_be_bytes());
            }
            (pack(&table), XRefFilter::Single(Filter::FlateDecode))
        })
    }
}

/// Packs bytes as PDFs do.
fn pack(content: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    let done = ZlibEncoder::new(content, Compression::default()).read_to_end(&mut packed);
    done.expect("bytes in memory are read and written");
    packed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_objects_are_one_and_short_streams_stay_plain() {
        let mut file = File::new();
        assert_eq!(file.add(|o| o.primitive(1)), file.add(|o| o.primitive(1)));
        assert_ne!(file.add(|o| o.primitive(2)), file.add(|o| o.primitive(1)));
        file.add_form(b"0 0 m", |_| ());
        let plain = file.pdf.len();
        file.add_form(&b"0 0 m ".repeat(100), |_| ());
        assert!(file.pdf.as_bytes()[..plain].ends_with(b"\n0 0 m\nendstream\nendobj\n"));
        assert!(file.pdf.len() - plain < 150);
    }
}
