//! The whole way, from generated exemplars to files, compared with what is stored in `tests/golden`.
//!
//! SVG and PDF are compared by their hashes, PNG pixel by pixel within a tolerance. A PNG that differs
//! is left, with the picture of the difference, in the target folder's folder for temporary files.
//! `VTEX_BLESS=1 cargo test --test all golden::` stores what is made now.

use image::RgbImage;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use vtex::output::{pdf, png, svg};
use vtex::scene::{Scene, SynthParams};
use vtex::synth::synthesize;

/// Largest mean difference of a picture to the stored one, of 255.
const MEAN: f64 = 0.1;
/// Largest share of components that differ by more than [`FAR`].
const SHARE: f64 = 0.001;
const FAR: u8 = 16;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn bless() -> bool {
    std::env::var_os("VTEX_BLESS").is_some()
}

/// The scene of one of the generated exemplars.
fn scene(name: &str) -> Scene {
    let params = SynthParams { width: 200, height: 160, seed: 5, ..SynthParams::default() };
    synthesize(&crate::support::library(name), &params, &()).unwrap()
}

/// A PNG beside the stored one.
fn compare(name: &str, picture: &RgbImage) -> Result<(), String> {
    let path = folder().join(format!("{name}.png"));
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

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

#[test]
fn results_are_the_stored_ones() {
    let mut hashes = String::new();
    let mut faults = Vec::new();
    for name in ["pebbles", "flowers", "leaves"] {
        let scene = scene(name);
        let mut text = Vec::new();
        svg::write(&scene, &svg::SvgOptions::default(), &mut text).unwrap();
        let text = String::from_utf8(text).unwrap().replace(vtex::PROGRAM, "vtex");
        let mut document = Vec::new();
        pdf::write(&scene, &mut document).unwrap();
        hashes += &format!("{} {name}.svg\n{} {name}.pdf\n", hash(text.as_bytes()), hash(&document));
        let drawn = png::render(&scene, 1.0).unwrap();
        let rgb = drawn.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        let picture = RgbImage::from_raw(drawn.width(), drawn.height(), rgb).unwrap();
        faults.extend(compare(name, &picture).err());
    }
    let path = folder().join("results.sha256");
    if bless() {
        std::fs::write(&path, &hashes).unwrap();
    } else {
        let stored = std::fs::read_to_string(&path).unwrap();
        let changed = hashes.lines().filter(|line| !stored.lines().any(|s| s == *line));
        faults.extend(changed.map(|line| format!("another hash: {line}")));
    }
    assert!(faults.is_empty(), "{faults:#?}\nVTEX_BLESS=1 stores what is made now");
}
