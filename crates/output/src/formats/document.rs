//! Documents of JSON, plain or packed: scenes and libraries.

use super::{Ending, Signature, Uses, Writer};

const BEGINNING: &[u8] = b"{\"format\":\"vtex-";

static SIGNATURE: Signature = Signature {
    beginning: BEGINNING,
    end: b"}\n",
    seal: |sum| format!(",\"sha256\":\"{sum}\"").into_bytes(),
    is_own: |start, _| Ok(names_vtex(start)),
};

pub(super) static SCENE: Writer = Writer {
    name: "scene",
    purpose: "One finished texture as data",
    endings: &[
        Ending { text: ".scene.json", title: "Scene", gzip: false },
        Ending { text: ".scene.json.gz", title: "Scene", gzip: true },
    ],
    uses: Uses::NONE,
    signature: &SIGNATURE,
    write: Some(|scene, _, _, out| out.write_all(&scene.to_json()).map(|()| Vec::new())),
};

pub(super) static LIBRARY: Writer = Writer {
    name: "library",
    purpose: "All elements found, for new textures",
    endings: &[
        Ending { text: ".lib.json", title: "Library", gzip: false },
        Ending { text: ".lib.json.gz", title: "Library", gzip: true },
    ],
    uses: Uses::NONE,
    signature: &SIGNATURE,
    write: None,
};

/// Whether the first field is `"format": "vtex-…"`.
fn names_vtex(start: &[u8]) -> bool {
    let mut rest = start.iter().filter(|b| !b.is_ascii_whitespace());
    BEGINNING.iter().all(|expected| rest.next() == Some(expected))
}
