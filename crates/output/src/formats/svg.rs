//! SVG, plain or packed.

use super::signature::in_markup;
use super::{Ending, Signature, Uses, WriteOptions, Writer};
use crate::svg::{BEGINNING, write_pattern, write_with_recipe};
use std::io::{self, Write};
use vtex_base::Progress;
use vtex_scene::scene::Scene;

pub(super) static WRITER: Writer = Writer {
    name: "svg",
    purpose: "Vectors, in groups by layer and category",
    endings: &[
        Ending { text: ".svg", title: "SVG", gzip: false },
        Ending { text: ".svgz", title: "SVGZ", gzip: true },
    ],
    uses: Uses { max_bytes: true, pattern: true, ..Uses::NONE },
    signature: &Signature {
        beginning: BEGINNING.as_bytes(),
        end: b"",
        seal: in_markup,
        is_own: |start, _| Ok(start.starts_with(BEGINNING.as_bytes())),
    },
    write: Some(write),
};

fn write(
    scene: &Scene,
    options: &WriteOptions<'_>,
    _: &dyn Progress,
    out: &mut dyn Write,
) -> io::Result<Vec<String>> {
    let summary = match options.pattern {
        true => write_pattern(scene, &options.svg, out),
        false => write_with_recipe(scene, &options.svg, options.recipe, out),
    };
    Ok(summary?.warnings)
}
