//! Time and memory of Segment Anything's networks with each engine; results are in `docs/measurements/networks.md`.
//!
//! `cargo bench --bench networks -- ENCODER.onnx [DECODER.onnx]`, once for each engine named by
//! `VTEX_ENGINE` (`rten` or `onnxruntime`, else automatic), since peak memory is that of the process.

use image::{Rgb, RgbImage};
use std::path::PathBuf;
use std::time::Instant;
use vtex::engine::{EngineOptions, NetworkSource, Runtime};
use vtex::segment::prompt::{Prompter, Sam};

fn main() -> vtex::Result<()> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let files: Vec<NetworkSource<'_>> = files
        .iter()
        .filter(|f| !f.to_string_lossy().starts_with('-'))
        .map(|f| NetworkSource::File(f))
        .collect();
    if files.is_empty() {
        println!("networks: no files given, nothing measured");
        return Ok(());
    }
    let runtime = match std::env::var("VTEX_ENGINE").as_deref() {
        Ok("rten") => Runtime::Rten,
        Ok("onnxruntime") => Runtime::OnnxRuntime,
        _ => Runtime::Auto,
    };
    let threads = std::env::var("VTEX_THREADS").ok().and_then(|n| n.parse().ok());
    let options = EngineOptions { runtime, threads, ..EngineOptions::default() };
    let noise = |x: u32, y: u32| (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 9;
    let image = RgbImage::from_fn(500, 400, |x, y| Rgb([0, 8, 16].map(|k| (noise(x / 9, y / 7) >> k) as u8)));
    let points: Vec<[f32; 2]> = (0..32).map(|i| [(i * 83 % 500) as f32, (i * 59 % 400) as f32]).collect();

    let seconds = |name: &str, since: Instant, of: usize| {
        println!("{name:24} {:8.3} s", since.elapsed().as_secs_f64() / of as f64);
    };
    let start = Instant::now();
    let sam = Sam::open(&files, &options)?;
    println!("{}", sam.title());
    seconds("load", start, 1);
    let start = Instant::now();
    let embedded = sam.embed(&image)?;
    seconds("first image", start, 1);
    let start = Instant::now();
    drop(sam.embed(&image)?);
    seconds("image", start, 1);
    // Makes the decoder decide whether it can take several points per run.
    let mut all = embedded.masks(&points[..2])?;
    let start = Instant::now();
    all.extend(embedded.masks(&points)?);
    seconds(&format!("point, {} at a time", embedded.batch()), start, points.len());
    let logits = all.iter().flatten().flat_map(|mask| &mask.logits.values);
    // A checksum of the bits, to compare runs with different numbers of threads.
    let sum = logits.fold(0u64, |sum, value| sum.rotate_left(7) ^ u64::from(value.to_bits()));
    let first = &all[0][0].logits;
    println!("{} masks of {} x {}, bits {sum:016x}", all[0].len(), first.width, first.height);
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default();
        println!("{peak}");
    }
    Ok(())
}
