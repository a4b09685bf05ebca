//! Checks the cost of placement by ratios that hold on any machine: per pixel on a large canvas against
//! a small one, controlled against plain placement, and placement against a fixed workload of similar
//! character. Exits with code 1 if a ratio exceeds its limit.
//!
//! ```text
//! cargo bench --bench placement
//! ```
//!
//! Measures the CPU seconds of target map, placement and density correction on one thread: the minimum
//! over several rounds in which all settings take turns.

#[expect(dead_code, reason = "other benchmarks print more columns")]
mod support;

use std::hint::black_box;
use std::path::Path;
use std::process::ExitCode;
use support::{MEASURE, Outcome, Watch, child, cpu_seconds, row, sum};
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::raster::ControlMap;
use vtex::scene::{Method, SynthParams, Tile};
use vtex::segment::Regions;
use vtex::synth::{self, Controls};

const ROUNDS: usize = 5;

/// Changes of the parameters and controls of a run.
type Setting = fn(&mut SynthParams, &mut Controls);

/// Side in pixels, number of libraries, setting, name, and the limit of the time per pixel relative to
/// the first row. Limits are about 1.4 times the values measured when they were set.
const SETTINGS: [(u32, usize, Setting, &str, f64); 7] = [
    (700, 1, |_, _| (), "plain, 700 × 700", 1.0),
    (2800, 1, |_, _| (), "plain, 2800 × 2800", 1.6),
    (700, 1, |p, _| p.tile = Tile { x: true, y: true }, "a tile", 1.5),
    (700, 1, |_, c| c.density = map(&[0.5, 1.5]), "a map of density", 4.8),
    (
        700,
        2,
        |_, c| c.shares = [map(&[0.0, 1.0]), map(&[1.0, 0.0])].into_iter().flatten().collect(),
        "two libraries",
        3.4,
    ),
    (700, 1, |p, _| p.mirror = true, "mirrored textons", 4.0),
    (700, 1, |p, _| (p.rotate, p.scale_jitter) = (Some(180.0), 20.0), "turned and scaled textons", 10.0),
];

/// Limit of the time of placement on the small plain canvas, relative to the yardstick.
const YARDSTICK: f64 = 1.0;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let done = match arguments.first().map(String::as_str) {
        Some(MEASURE) => measure().map(|()| true),
        Some(_) => Err("Usage: cargo bench --bench placement".into()),
        None => report(),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the table, and whether all ratios are within their limits.
fn report() -> Outcome<bool> {
    let found = child(&[], Some(1))?;
    let times: Vec<f64> =
        found.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect();
    let [yardstick, small, ..] = times[..] else { return Err("nothing was measured".into()) };
    let mut text = row(["placement of", "CPU s", "against", "ratio", "limit"].map(String::from));
    text += "|---|--:|---|--:|--:|\n";
    let mut kept = true;
    let mut line = |name: &str, seconds: f64, against: &str, ratio: f64, limit: f64| {
        kept &= ratio <= limit;
        let verdict = if ratio <= limit { "" } else { " exceeded" };
        row([
            name.into(),
            format!("{seconds:.3}"),
            against.into(),
            format!("{ratio:.2}"),
            format!("{limit:.2}{verdict}"),
        ])
    };
    text += &line(SETTINGS[0].3, small, "the yardstick", small / yardstick, YARDSTICK);
    for (&(side, .., name, limit), &seconds) in SETTINGS.iter().zip(&times[1..]).skip(1) {
        let across = f64::from(side) / f64::from(SETTINGS[0].0);
        text += &line(name, seconds, "plain, by pixel", seconds / small / (across * across), limit);
    }
    print!("{text}");
    Ok(kept)
}

/// Prints the least CPU seconds of the yardstick and of each setting.
fn measure() -> Outcome {
    let libraries = [library("terrazzo")?, library("pebbles")?];
    let mut least = [f64::INFINITY; 1 + SETTINGS.len()];
    for _ in 0..ROUNDS {
        let begin = cpu_seconds();
        black_box(yardstick());
        least[0] = least[0].min(cpu_seconds() - begin);
        for (least, &(side, count, set, ..)) in least[1..].iter_mut().zip(&SETTINGS) {
            let method = Method::Descriptor;
            let mut params = SynthParams { width: side, height: side, method, ..SynthParams::default() };
            let mut controls = Controls::default();
            set(&mut params, &mut controls);
            let watch = Watch::start("preparation");
            synth::synthesize_with(&libraries[..count], &params, &controls, &watch)?;
            *least = least.min(sum(&watch.stop(), "ground"));
        }
    }
    println!("{}", serde_json::to_string(&least.as_slice())?);
    Ok(())
}

fn library(name: &str) -> Outcome<Library> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars");
    let exemplar = Exemplar::open(&folder.join(name).with_extension("png"), &Limits::default())?;
    Ok(analyze(&exemplar, &Regions, &AnalyzeParams::default(), &())?)
}

/// A map that varies from left to right.
fn map(values: &[f32]) -> Option<ControlMap> {
    ControlMap::new(values.len() as u32, 1, values.to_vec())
}

/// A workload with the memory accesses of placement: short runs of cells read and written all over a
/// map of bytes.
fn yardstick() -> u64 {
    const SIDE: usize = 700;
    let mut cells = vec![0u8; SIDE * SIDE];
    let (mut state, mut sum) = (1u64, 0);
    for _ in 0..40_000_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let start = (state >> 33) as usize % (cells.len() - 16);
        for cell in &mut cells[start..start + 16] {
            sum += u64::from(*cell == 0);
            *cell = cell.wrapping_add(1);
        }
    }
    sum
}
