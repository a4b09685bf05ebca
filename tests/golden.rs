//! Results compared with what is stored in `tests/golden`.
//!
//! `results.sha256` lists commands and the SHA-256 of what each writes: without the metadata of an SVG, and of
//! the pixels of a PNG. A new command is added as a line with any word before it. Pictures of larger scenes
//! are compared within a tolerance. A picture that differs is left, with the picture of the difference, in the
//! target folder's folder for temporary files. `VTEX_BLESS=1 cargo test --test all golden::` stores what is
//! made now.
#![cfg(feature = "cli")]

use crate::cli::support::{Folder, steering};
use image::RgbImage;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use vtex::output::png;
use vtex::scene::{Scene, SynthParams};
use vtex::synth::synthesize;
use vtex_testing::{SceneKind, SceneParams, generate};

/// Largest mean difference of a picture to the stored one, of 255.
const MEAN: f64 = 0.1;
/// Largest share of components that differ by more than [`FAR`].
const SHARE: f64 = 0.001;
const FAR: u8 = 16;

fn folder_of_results() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn bless() -> bool {
    std::env::var_os("VTEX_BLESS").is_some()
}

/// The scene of one of the bundled exemplars.
fn scene(name: &str) -> Scene {
    let params = SynthParams { width: 200, height: 160, seed: 5, ..SynthParams::default() };
    synthesize(&crate::support::library(name), &params, &()).unwrap()
}

/// A PNG beside the stored one.
fn compare(name: &str, picture: &RgbImage) -> Result<(), String> {
    let path = folder_of_results().join(format!("{name}.png"));
    if bless() {
        return picture.save(&path).map_err(|e| e.to_string());
    }
    let stored = image::open(&path).map_err(|e| format!("{}: {e}", path.display()))?.into_rgb8();
    if stored.dimensions() != picture.dimensions() {
        return Err(format!("{name}: another size"));
    }
    let apart: Vec<u8> = stored.iter().zip(picture.iter()).map(|(a, b)| a.abs_diff(*b)).collect();
    let mean = apart.iter().map(|&d| f64::from(d)).sum::<f64>() / apart.len() as f64;
    let far = apart.iter().filter(|&&d| d > FAR).count() as f64 / apart.len() as f64;
    if mean <= MEAN && far <= SHARE {
        return Ok(());
    }
    let left = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let enlarged: Vec<u8> = apart.iter().map(|d| d.saturating_mul(8)).collect();
    let difference = RgbImage::from_raw(stored.width(), stored.height(), enlarged).unwrap();
    picture.save(left.join(format!("{name}.png"))).unwrap();
    difference.save(left.join(format!("{name}.difference.png"))).unwrap();
    Err(format!("{name}: mean {mean:.3}, share {far:.5}; the pictures are in {}", left.display()))
}

/// The inputs of the commands: photographs, maps and shapes, a library and a scene of each photograph, and a
/// library with layers.
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, kind) in [("pebbles", SceneKind::Pebbles), ("flowers", SceneKind::Flowers)] {
        let params = SceneParams { width: 112, height: 96, kind, size: 18.0, ..SceneParams::default() };
        generate(&params).unwrap().image.save(folder.path(&format!("{name}.png"))).unwrap();
        folder.run(&format!("analyze {name}.png --segmenter regions --seed 1")).succeeds();
        folder.run(&format!("synth {name}.lib.json -o {name}.scene.json --size 120x90 --seed 2")).succeeds();
    }
    steering(&folder.path(""));
    let drawing = |path: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="120" height="90"><path d="{path}"/></svg>"#)
    };
    folder.write("before.svg", drawing("M0 0H120V90H0z"));
    folder.write("after.svg", drawing("M0 0C40 30 80 30 120 0V60C80 90 40 90 0 60z"));
    folder.write("mark.svg", drawing("M0 40H120V44H0z"));
    folder.write("four.txt", "#203040 #a04020 #d0b060 #f0f0e0");
    folder.write("garden.svg", include_str!("../examples/drawings/garden.svg"));
    folder.run("analyze photo.png --segmenter regions --seed 1").succeeds();
    folder.run("analyze garden.svg --seed 1").succeeds();
    let layered = "analyze pebbles.png --segmenter regions --layers 2 --seed 1";
    folder.run(&format!("{layered} -o layered.lib.json --save-layers layers.png")).succeeds();
    folder.run("render mark.svg -o hole.png").succeeds();
    folder.run("layers layers.png -o where.png --size 120x90 --seed 4").succeeds();
    folder
}

/// The hash of a command's result.
fn hash(folder: &Folder, command: &str) -> String {
    let named = command.split(" -o ").nth(1).and_then(|rest| rest.split_whitespace().next());
    let to = if named.is_none() { " -o -" } else { "" };
    // The number of threads must not matter.
    let threads = if bless() { 1 } else { 3 };
    let run = folder.run(&format!("{command}{to} --threads {threads}"));
    if run.code != Some(0) {
        return run.stderr.lines().next().unwrap_or_default().to_owned();
    }
    let bytes = named.map_or(run.stdout, |name| folder.read(name));
    let bytes = match String::from_utf8(bytes) {
        Ok(text) => {
            let (before, rest) = text.split_once("<metadata>").unwrap_or((&text, ""));
            format!("{before}{}", rest.split_once("</metadata>").map_or(rest, |parts| parts.1)).into_bytes()
        }
        Err(binary) => match image::load_from_memory(binary.as_bytes()) {
            Ok(picture) => picture.into_bytes(),
            Err(_) => binary.into_bytes(),
        },
    };
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

#[test]
fn commands_write_what_they_wrote() {
    let file = folder_of_results().join("results.sha256");
    let stored = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<(&str, &str)> = stored.lines().map(|line| line.split_once("  ").unwrap()).collect();
    assert!(lines.len() > 70);
    let folder = folder();
    let found: Vec<String> = lines.par_iter().map(|(_, command)| hash(&folder, command)).collect();
    if bless() && found.iter().all(|found| !found.starts_with("error")) {
        let line = |(hash, (_, command)): (&String, &(&str, &str))| format!("{hash}  {command}\n");
        return std::fs::write(&file, found.iter().zip(&lines).map(line).collect::<String>()).unwrap();
    }
    let changed = lines.iter().zip(&found).filter(|((hash, _), found)| hash != found);
    let changed: Vec<String> = changed.map(|((_, command), found)| format!("{command}: {found}")).collect();
    assert!(changed.is_empty(), "{} of {} changed: {changed:#?}", changed.len(), lines.len());
}

#[test]
fn larger_scenes_look_as_they_did() {
    let picture = |name: &str| {
        let drawn = png::render(&scene(name), 1.0).unwrap();
        let rgb = drawn.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        compare(name, &RgbImage::from_raw(drawn.width(), drawn.height(), rgb).unwrap())
    };
    let faults: Vec<String> =
        ["pebbles", "flowers", "leaves"].map(picture).into_iter().filter_map(Result::err).collect();
    assert!(faults.is_empty(), "{faults:#?}\nVTEX_BLESS=1 stores what is made now");
}
