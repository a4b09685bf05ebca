//! Fits the judge of `--segmenter texton` to procedural scenes and writes it as Rust source.
//!
//! `cargo run --release --example fit_texton -- crates/segment/src/segment/texton/weights.rs [scenes] [passes]`
//!
//! To be run again whenever the network in `tools/texton` changes. Candidates are the network's
//! masks and the nodes of the region tree. Seeds start at 5 000 000: neither the network's training
//! nor any test or evaluation uses them.

use vtex::segment::texton::{Judge, Texton};

mod fitting;

const FIRST_SEED: u64 = 5_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: fit_texton OUT.rs [scenes] [passes]")?;
    let scenes: u64 = arguments.next().map_or(Ok(400), |n| n.parse())?;
    let passes: usize = arguments.next().map_or(Ok(10), |n| n.parse())?;
    let segmenter = Texton::new()?;
    let mut samples = fitting::samples(FIRST_SEED, scenes, |image| {
        let found = segmenter.candidates(image, &()).expect("nothing interrupts");
        found.into_iter().map(|c| (c.mask, c.features)).collect()
    });
    let judge: Judge = fitting::fit(&mut samples, passes);
    let made_by =
        format!("fitted by `tools/fit_texton.rs` to {scenes} procedural scenes in\n//! {passes} passes");
    std::fs::write(path, fitting::source(&judge, &made_by, "super::Judge"))?;
    Ok(())
}
