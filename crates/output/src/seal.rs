//! The seal of a file: a SHA-256 of its own bytes. It distinguishes a file that is unchanged since it was
//! written from one that somebody has worked on.
//!
//! It is stored at the end of the file, because files are written as a stream: in a comment in SVG, HTML, PDF
//! and GIF, in a text chunk in PNG, in the last field of a JSON document. In a packed file the content is
//! sealed; gzip has a checksum of its own.

use super::formats::{Signature, signatures};
use flate2::bufread::GzDecoder;
use sha2::{Digest, Sha256};
use std::io::{self, BufRead, BufReader, Read, Write};
use vtex_base::gzip;

/// Bytes by which a format is recognised; none of the beginnings is longer.
const HEAD: usize = 64;

impl Signature {
    /// Recognises a format by the first [`HEAD`] bytes, or by all if there are fewer.
    fn of(head: &[u8]) -> Option<&'static Self> {
        signatures().find(|signature| head.starts_with(signature.beginning))
    }

    /// The seal and the last bytes of a file; `sum` is that of the bytes before them.
    fn tail(&self, sum: &str) -> Vec<u8> {
        [&(self.seal)(sum), self.end].concat()
    }
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Hashes a stream except its last bytes.
struct AllBut {
    last: usize,
    held: Vec<u8>,
    hash: Sha256,
}

impl AllBut {
    fn new(last: usize) -> Self {
        Self { last, held: Vec::new(), hash: Sha256::new() }
    }

    /// Takes bytes, and passes those on that cannot be among the last `last` bytes.
    fn push(&mut self, bytes: &[u8], mut on: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
        let old = (self.held.len() + bytes.len()).saturating_sub(self.last).min(self.held.len());
        let new = bytes.len().saturating_sub(self.last);
        for part in [&self.held[..old], &bytes[..new]] {
            self.hash.update(part);
            on(part)?;
        }
        self.held.drain(..old);
        self.held.extend(&bytes[new..]);
        Ok(())
    }
}

/// A writer that adds the seal at [`Sealed::finish`], if it knows the format.
pub struct Sealed<W> {
    out: W,
    head: Vec<u8>,
    /// The format, once enough bytes were written; `Some(None)` if it is unknown.
    format: Option<Option<&'static Signature>>,
    content: AllBut,
}

impl<W: Write> Sealed<W> {
    /// A writer without any bytes yet.
    pub fn new(out: W) -> Self {
        Self { out, head: Vec::new(), format: None, content: AllBut::new(0) }
    }

    /// Writes the remaining bytes and the seal, and returns the inner writer.
    ///
    /// # Errors
    /// Those of writing.
    pub fn finish(mut self) -> io::Result<W> {
        self.begin()?;
        let Self { mut out, format, content, .. } = self;
        match format.flatten() {
            Some(format) if content.held == format.end => {
                out.write_all(&format.tail(&hexadecimal(content.hash)))?;
            }
            _ => out.write_all(&content.held)?,
        }
        Ok(out)
    }

    /// Decides on the format, and writes the bytes by which it was recognised.
    fn begin(&mut self) -> io::Result<()> {
        if self.format.is_some() {
            return Ok(());
        }
        let format = Signature::of(&self.head);
        self.format = Some(format);
        self.content = AllBut::new(format.map_or(0, |f| f.end.len()));
        let head = std::mem::take(&mut self.head);
        self.content.push(&head, |part| self.out.write_all(part))
    }
}

impl<W: Write> Write for Sealed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.format {
            None => {
                self.head.extend(bytes);
                if self.head.len() >= HEAD {
                    self.begin()?;
                }
            }
            Some(None) => self.out.write_all(bytes)?,
            Some(Some(_)) => self.content.push(bytes, |part| self.out.write_all(part))?,
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Whether a file, plain or gzip, is sealed and unchanged.
///
/// # Errors
/// Those of reading; damaged gzip is not sealed.
pub(super) fn is_whole(mut file: impl Read) -> io::Result<bool> {
    let mut start = Vec::new();
    file.by_ref().take(2).read_to_end(&mut start)?;
    let packed = gzip::is_packed(&start);
    let all = io::Cursor::new(start).chain(file);
    if !packed {
        return whole(all);
    }
    let mut unpacked = GzDecoder::new(BufReader::new(all));
    let sealed = whole(&mut unpacked).unwrap_or(false);
    // Bytes after the packed data mean a changed file.
    Ok(sealed && unpacked.into_inner().fill_buf()?.is_empty())
}

fn whole(mut file: impl Read) -> io::Result<bool> {
    let mut head = Vec::new();
    file.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let Some(format) = Signature::of(&head) else { return Ok(false) };
    let empty = "0".repeat(2 * Sha256::output_size());
    let mut content = AllBut::new(format.tail(&empty).len());
    content.push(&head, |_| Ok(()))?;
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => break,
            n => content.push(&buffer[..n], |_| Ok(()))?,
        }
    }
    Ok(content.held == format.tail(&hexadecimal(content.hash)))
}

/// The bytes of a sealed file as they were before it was sealed; `None` if it is not sealed or has been changed.
pub fn without_seal(sealed: &[u8]) -> Option<Vec<u8>> {
    let format = Signature::of(&sealed[..sealed.len().min(HEAD)])?;
    let empty = "0".repeat(2 * Sha256::output_size());
    let (content, tail) = sealed.split_at_checked(sealed.len().checked_sub(format.tail(&empty).len())?)?;
    let whole = format.tail(&hexadecimal(Sha256::new_with_prefix(content))) == tail;
    whole.then(|| [content, format.end].concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::gzip;
    use crate::testing;

    fn seal(bytes: &[u8], step: usize) -> Vec<u8> {
        let mut out = Sealed::new(Vec::new());
        bytes.chunks(step).for_each(|part| out.write_all(part).unwrap());
        out.finish().unwrap()
    }

    #[test]
    fn any_change_breaks_the_seal() {
        for file in testing::files(&testing::scene(40, 40, 1)) {
            let sealed = seal(&file, 7);
            assert_eq!(sealed, seal(&file, 100_000), "it does not matter how it is written");
            assert!(is_whole(&sealed[..]).unwrap() && !is_whole(&file[..]).unwrap());
            assert_eq!(without_seal(&sealed).as_ref(), Some(&file));
            assert_eq!([without_seal(&file), without_seal(&sealed[1..])], [None, None]);
            let mut out = gzip(Vec::new());
            out.write_all(&sealed).unwrap();
            assert!(is_whole(&out.finish().unwrap()[..]).unwrap());
            for at in (0..sealed.len()).step_by(sealed.len() / 97 + 1).chain([sealed.len() - 2]) {
                let mut changed = sealed.clone();
                changed[at] ^= 1;
                assert!(!is_whole(&changed[..]).unwrap(), "byte {at} of {}", sealed.len());
            }
            let (shorter, longer) = (&sealed[..sealed.len() - 1], [&sealed[..], b"\n"].concat());
            assert!(!is_whole(shorter).unwrap() && !is_whole(&longer[..]).unwrap());
        }
    }

    #[test]
    fn a_format_is_recognised_by_few_bytes() {
        for signature in signatures() {
            assert!((1..=HEAD).contains(&signature.beginning.len()));
            assert!(std::ptr::eq(Signature::of(signature.beginning).unwrap().end, signature.end));
        }
    }

    #[test]
    fn what_is_not_known_is_written_as_it_is() {
        for foreign in [&b""[..], b"x", b"{\"format\":\"other\"}\n", b"<svg/>", &[7; 1000]] {
            assert_eq!(seal(foreign, 3), foreign);
            assert!(!is_whole(foreign).unwrap() && without_seal(foreign).is_none());
        }
        assert!(!is_whole(&b"\x1f\x8b damaged"[..]).unwrap());
    }
}
