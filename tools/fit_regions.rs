//! Fits the network of `--segmenter regions` to procedural scenes and writes it as Rust source.
//!
//! `cargo run --release --example fit_regions -- crates/segment/src/segment/regions/weights.rs [scenes] [passes]`
//!
//! Candidates are the nodes of the trees. Seeds start at 1 000 000: no test and no evaluation uses
//! them.

use vtex::segment::regions::{Network, candidates};

mod fitting;

const FIRST_SEED: u64 = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: fit_regions OUT.rs [scenes] [passes]")?;
    let scenes: u64 = arguments.next().map_or(Ok(1000), |n| n.parse())?;
    let passes: usize = arguments.next().map_or(Ok(12), |n| n.parse())?;
    let mut samples = fitting::samples(FIRST_SEED..FIRST_SEED + scenes, fitting::generated, |image| {
        let found = candidates(image, &()).expect("nothing interrupts");
        found.into_iter().map(|c| (c.mask, c.features)).collect()
    });
    let network: Network = fitting::fit(&mut samples, passes);
    let made_by =
        format!("fitted by `tools/fit_regions.rs` to {scenes} procedural scenes in\n//! {passes} passes");
    std::fs::write(path, fitting::source(&network, &made_by, "super::select::Network"))?;
    Ok(())
}
