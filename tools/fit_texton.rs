//! Fits the judge of `--segmenter texton` to scenes, and writes it as Rust source.
//!
//! `cargo run --release --example fit_texton -- crates/segment/src/segment/texton/weights.rs COMPOSED_DIR [scenes] [passes]`
//!
//! To be run again whenever the network in `tools/texton` changes. Candidates are the network's masks and the nodes of
//! the region tree. Scenes are generated ones, and those of photographs that `tools/texton/compose.py` has made in
//! `COMPOSED_DIR`. Seeds start at 5 000 000: neither the network's training nor any test or evaluation uses them.

use std::path::Path;
use vtex::segment::texton::{Judge, Texton};

mod composed;
mod fitting;

use composed::ComposedScenes;

const FIRST_SEED: u64 = 5_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: fit_texton OUT.rs COMPOSED_DIR [scenes] [passes]";
    let [path, composed] = [arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?];
    let scenes: u64 = arguments.next().map_or(Ok(240), |n| n.parse())?;
    let passes: usize = arguments.next().map_or(Ok(10), |n| n.parse())?;
    let segmenter = Texton::new()?;
    let composed = ComposedScenes::read(Path::new(&composed))?;
    let candidates = |image: &image::RgbImage| {
        let found = segmenter.candidates(image, &()).expect("nothing interrupts");
        found.into_iter().map(|c| (c.mask, c.features)).collect()
    };
    let mut samples = fitting::samples(FIRST_SEED..FIRST_SEED + scenes, fitting::generated, candidates);
    samples.extend(fitting::samples(0..composed.count(), |index| composed.scene(index), candidates));
    let judge: Judge = fitting::fit(&mut samples, passes);
    let made_by = format!(
        "fitted by `tools/fit_texton.rs` to {scenes} generated scenes and\n//! {} composed ones in {passes} passes",
        composed.count()
    );
    std::fs::write(path, fitting::source(&judge, &made_by, "super::Judge"))?;
    Ok(())
}
