//! 4. Progress: the names of stages, a time limit, and a picture of every stage.
//!
//! `cargo run --release --example 04_progress_and_pictures [PHOTO [FOLDER]]`

use image::RgbImage;
use std::error::Error;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use vtex::Progress;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::scene::SynthParams;
use vtex::segment::Regions;
use vtex::synth::synthesize;

/// Prints each stage once, saves its pictures, and stops after a time limit.
struct Watch {
    folder: PathBuf,
    stop_at: Instant,
    stage: Mutex<&'static str>,
}

impl Progress for Watch {
    fn advance(&self, stage: &'static str, _done: u64, total: u64) -> bool {
        let mut last = self.stage.lock().expect("nothing here panics");
        if *last != stage {
            println!("{stage}{}", if total > 1 { format!(" ({total} steps)") } else { String::new() });
            *last = stage;
        }
        // `false` stops the work: the stage then returns `Error::Interrupted`.
        Instant::now() < self.stop_at
    }

    fn warn(&self, message: &str) {
        println!("warning: {message}");
    }

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        let path = self.folder.join(format!("{name}.png"));
        match draw().save(&path) {
            Ok(()) => println!("  {}", path.display()),
            Err(error) => println!("  {}: {error}", path.display()),
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let photo = arguments.next().unwrap_or("examples/exemplars/flowers.png".into());
    let folder = arguments.next().unwrap_or(std::env::temp_dir().join("vtex-stages"));
    std::fs::create_dir_all(&folder)?;
    let stop_at = Instant::now() + Duration::from_secs(120);
    let watch = Watch { folder, stop_at, stage: Mutex::new("") };

    let exemplar = Exemplar::open(&photo, &Limits::default())?;
    let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &watch)?;
    let params = SynthParams { width: 600, height: 600, ..SynthParams::default() };
    let scene = synthesize(&library, &params, &watch)?;
    for layer in &scene.layers {
        println!("{}: {} elements", layer.name, layer.instances.len());
    }
    Ok(())
}
