//! 1. A photograph in, a vector texture out: the three stages in a row.
//!
//! `cargo run --release --example 01_photo_to_svg [PHOTO [OUT.svg]]`

use std::error::Error;
use std::path::PathBuf;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::output::{file, svg};
use vtex::scene::SynthParams;
use vtex::segment::texton::Texton;
use vtex::synth::synthesize;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let photo = arguments.next().unwrap_or("examples/exemplars/terrazzo.png".into());
    let out = arguments.next().unwrap_or(std::env::temp_dir().join("terrazzo.svg"));

    // Photograph → library. `Texton` is the program's default segmenter. `()` is a `Progress` that reports
    // nothing and never stops the work.
    let exemplar = Exemplar::open(&photo, &Limits::default())?;
    let segmenter = Texton::new()?;
    let library = analyze(&exemplar, &segmenter, &AnalyzeParams::default(), &())?;
    println!(
        "{} primaries in {} categories cover {:.0} % of {}",
        library.primaries().len(),
        library.categories.len(),
        100.0 * library.coverage,
        library.source.file,
    );

    // Library → scene, of any size. The same seed always gives the same scene.
    let params = SynthParams { width: 900, height: 600, seed: 7, ..SynthParams::default() };
    let scene = synthesize(&library, &params, &())?;

    // Scene → file. `write_file` keeps the old file until the new one is complete.
    let options = svg::SvgOptions::default();
    let (summary, _) = file::write_file(&out, false, |to| svg::write(&scene, &options, to))?;
    println!("{}: {} elements, {} kB", out.display(), summary.elements, summary.bytes / 1000);
    Ok(())
}
