//! How files of vtex begin, end and are sealed, by which they are recognised.

use std::io::{self, Read};

/// The beginning of every HTML page of vtex; its version is next.
pub const PAGE_BEGINNING: &str = "<!DOCTYPE html>\n<!-- Written by vtex ";

/// The beginning and end of files of one format.
pub(crate) struct Signature {
    /// The first bytes of every file that is sealed.
    pub(crate) beginning: &'static [u8],
    /// The last bytes, which follow the seal.
    pub(crate) end: &'static [u8],
    /// The seal with a checksum, in a form that readers of the format skip.
    pub(crate) seal: fn(&str) -> Vec<u8>,
    /// Whether vtex wrote a file, even if somebody has changed it since; by its first bytes, unpacked, and the rest.
    pub(crate) is_own: fn(&[u8], &mut dyn Read) -> io::Result<bool>,
}

/// An animated GIF.
pub(super) static GIF: Signature = Signature {
    beginning: b"GIF89a",
    end: b"\x3b",
    seal: |sum| [&[0x21, 0xfe, sum.len() as u8], sum.as_bytes(), &[0]].concat(),
    is_own: |start, _| Ok(start.starts_with(b"GIF89a") && has_own_comment(start)),
};

/// An HTML page.
pub(super) static PAGE: Signature = Signature {
    beginning: PAGE_BEGINNING.as_bytes(),
    end: b"",
    seal: in_markup,
    is_own: |start, _| Ok(start.starts_with(PAGE_BEGINNING.as_bytes())),
};

/// The seal of SVG and HTML: a comment.
pub(super) fn in_markup(sum: &str) -> Vec<u8> {
    format!("<!-- sha256 {sum} -->\n").into_bytes()
}

/// Whether a comment of a GIF names vtex.
fn has_own_comment(start: &[u8]) -> bool {
    start.windows(8).any(|w| w[..2] == [0x21, 0xfe] && w[3..] == *b"vtex ")
}
