//! PNG.

use super::{Ending, Signature, Uses, WriteOptions, Writer};
use crate::png::{encode, render_page};
use flate2::Crc;
use std::io::{self, Write};
use vtex_base::Progress;
use vtex_scene::scene::Scene;

const BEGINNING: &[u8] = b"\x89PNG\r\n\x1a\n";
/// The end of every PNG: an empty chunk.
const END: &[u8] = b"\0\0\0\0IEND\xaeB`\x82";

pub(super) static WRITER: Writer = Writer {
    name: "png",
    purpose: "Pixels; you set the scale",
    endings: &[Ending { text: ".png", title: "PNG", gzip: false }],
    uses: Uses { scale: true, ..Uses::NONE },
    signature: &Signature {
        beginning: BEGINNING,
        end: END,
        seal: |sum| text_chunk("SHA-256", sum),
        is_own: |start, _| Ok(names_vtex(start)),
    },
    write: Some(write),
};

fn write(
    scene: &Scene,
    options: &WriteOptions<'_>,
    progress: &dyn Progress,
    out: &mut dyn Write,
) -> io::Result<Vec<String>> {
    let picture = render_page(scene, options.scale, progress)?;
    encode(&picture, scene.parameters.as_ref().map(|p| p.seed), scene.page, out)?;
    Ok(Vec::new())
}

/// A text chunk with a keyword.
fn text_chunk(keyword: &str, text: &str) -> Vec<u8> {
    let content = [&b"tEXt"[..], keyword.as_bytes(), b"\0", text.as_bytes()].concat();
    let mut crc = Crc::new();
    crc.update(&content);
    let length = (content.len() - 4) as u32;
    [&length.to_be_bytes()[..], &content, &crc.sum().to_be_bytes()].concat()
}

/// Whether a text chunk names vtex.
fn names_vtex(start: &[u8]) -> bool {
    let Some(mut rest) = start.strip_prefix(BEGINNING) else { return false };
    // Length, type, data, checksum.
    while let Some((head, after)) = rest.split_at_checked(8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..] == b"tEXt" && after.starts_with(b"Software\0vtex ") {
            return true;
        }
        let Some(next) = length.checked_add(4).and_then(|n| after.get(n..)) else { return false };
        rest = next;
    }
    false
}
