//! 2. Libraries and scenes are files: save them, read them again, and get the same bytes.
//!
//! `cargo run --release --example 02_save_and_replay [PHOTO]`

use std::error::Error;
use std::path::PathBuf;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::output::{png, svg};
use vtex::scene::{Scene, SynthParams};
use vtex::segment::Regions;
use vtex::synth::synthesize;

fn main() -> Result<(), Box<dyn Error>> {
    let photo = std::env::args_os().nth(1).map(PathBuf::from);
    let photo = photo.unwrap_or("examples/exemplars/pebbles.png".into());

    // Analysis is done once; later steps need only its library.
    let exemplar = Exemplar::open(&photo, &Limits::default())?;
    let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &())?;
    let saved = library.to_json();
    let library = Library::from_bytes(&saved, "pebbles.lib.json")?;
    println!("library: {} kB, read back exactly: {}", saved.len() / 1000, library.to_json() == saved);

    // A scene holds the textons that it uses, so it can be drawn without the library.
    let params = SynthParams { width: 600, height: 400, seed: 7, ..SynthParams::default() };
    let scene = synthesize(&library, &params, &())?;
    let saved = scene.to_json();
    let replayed = Scene::from_bytes(&saved, "pebbles.scene.json")?;
    println!("scene: {} kB, read back exactly: {}", saved.len() / 1000, replayed == scene);

    let (mut first, mut second) = (Vec::new(), Vec::new());
    svg::write(&scene, &svg::SvgOptions::default(), &mut first)?;
    svg::write(&replayed, &svg::SvgOptions::default(), &mut second)?;
    println!("SVG: {} kB, the same bytes from both: {}", first.len() / 1000, first == second);

    // The same scene as a picture, at twice the size.
    let picture = png::render(&replayed, 2.0)?;
    println!("PNG: {} x {} pixels", picture.width(), picture.height());
    Ok(())
}
