//! PDF.

use super::{Ending, Signature, Uses, Writer};
use std::io::{self, Read};

const BEGINNING: &[u8] = b"%PDF-";

pub(super) static WRITER: Writer = Writer {
    name: "pdf",
    purpose: "One page of vectors",
    endings: &[Ending { text: ".pdf", title: "PDF", gzip: false }],
    uses: Uses { max_bytes: true, ..Uses::NONE },
    signature: &Signature {
        beginning: BEGINNING,
        end: b"%%EOF",
        seal: |sum| format!("% sha256 {sum}\n").into_bytes(),
        is_own,
    },
    write: Some(|scene, _, _, out| crate::pdf::write(scene, out).map(|_| Vec::new())),
};

/// Whether the information at the end names vtex.
fn is_own(start: &[u8], rest: &mut dyn Read) -> io::Result<bool> {
    if !start.starts_with(BEGINNING) {
        return Ok(false);
    }
    let mut whole = start.to_vec();
    rest.read_to_end(&mut whole)?;
    let marks: [&[u8]; 2] = [b"/Producer(vtex ", b"/Producer (vtex "];
    Ok(marks.iter().any(|mark| whole.windows(mark.len()).any(|w| w == *mark)))
}
