//! CPU seconds, peak memory and file sizes of each stage, on the exemplars of the repository and on
//! photographs. See `docs/measurements/stages.md`.
//!
//! Every measurement runs in a child process of this program, so that memory peaks are separate.

mod support;

use image::RgbImage;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use support::{MEASURE, Outcome, Watch, child, kilo, mega, peak_memory, row, seconds, sum};
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::output::{file, png, svg};
use vtex::scene::SynthParams;
use vtex::segment::texton::Texton;
use vtex::segment::{ScoredMask, Segmenter};
use vtex::{Progress, synth};

const USAGE: &str = "\
Usage: cargo bench --bench stages [-- [--json] [IMAGE...]]
Without images: examples/exemplars, and what has 500 x 500 pixels in ../shared/exemplars.";

/// Sides of the canvases, in pixels.
const SIDES: [u32; 2] = [500, 1000];
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let done = match arguments.first().map(String::as_str) {
        Some(MEASURE) => measure(&arguments[1..]),
        _ => report(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Measures all images and prints tables or JSON.
fn report(arguments: &[String]) -> Outcome {
    let as_json = arguments.iter().any(|a| a == "--json");
    let mut images: Vec<PathBuf> = Vec::new();
    for argument in arguments.iter().filter(|a| *a != "--json") {
        if argument.starts_with('-') {
            return Err(format!("unknown flag {argument}\n{USAGE}").into());
        }
        images.push(argument.into());
    }
    if images.is_empty() {
        images = pictures_in("examples/exemplars", |_| true);
        images.extend(pictures_in("../shared/exemplars", |size| size == (500, 500)));
    }
    let folder = tempfile::tempdir()?;
    let mut all = Vec::new();
    for image in &images {
        let library = folder.path().join("exemplar.lib.json");
        let name = image.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut found = json!({ "exemplar": name });
        found["analyze"] = child(&["analyze".as_ref(), image.as_os_str(), library.as_os_str()], None)?;
        for side in SIDES {
            let side = side.to_string();
            found[format!("synth_{side}")] =
                child(&["synth".as_ref(), library.as_os_str(), side.as_ref()], None)?;
        }
        eprintln!("measured {name}");
        all.push(found);
    }
    let text = if as_json { serde_json::to_string_pretty(&all)? + "\n" } else { tables(&all) };
    io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

/// PNG and JPEG files of a folder whose size in pixels is wanted, by name. Empty if the folder does not
/// exist.
fn pictures_in(folder: &str, wanted: impl Fn((u32, u32)) -> bool) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "png" || e == "jpg"))
        .filter(|path| image::image_dimensions(path).is_ok_and(&wanted))
        .collect();
    found.sort();
    found
}

/// A measurement, printed as JSON.
fn measure(arguments: &[String]) -> Outcome {
    let found = match arguments {
        [what, photo, library] if what == "analyze" => measure_analysis(photo.as_ref(), library.as_ref())?,
        [what, library, side] if what == "synth" => measure_synthesis(library.as_ref(), side.parse()?)?,
        _ => return Err("unknown measurement".into()),
    };
    println!("{found}");
    Ok(())
}

fn measure_analysis(photo: &Path, place: &Path) -> Outcome<Value> {
    let exemplar = Exemplar::open(photo, &Limits::default())?;
    let watch = Watch::start("segment");
    let library = analyze(&exemplar, &Silent(Texton::new()?), &AnalyzeParams::default(), &watch)?;
    let stages = watch.stop();
    let peak = peak_memory();
    let bytes = library.to_json();
    std::fs::write(place, &bytes)?;
    let scene = synth::reconstruct(&library);
    let picture = png::render(&scene, 1.0)?;
    Ok(json!({
        "seconds": sum(&stages, ""),
        "stages": stages,
        "peak_bytes": peak,
        "library_bytes": bytes.len(),
        "library_gzip_bytes": packed(|out| out.write_all(&bytes))?,
        "reconstruction_svg_bytes": svg::write(&scene, &svg::SvgOptions::default(), io::sink())?.bytes,
        "reconstruction_psnr": psnr(&exemplar.image, picture.data()),
    }))
}

fn measure_synthesis(library: &Path, side: u32) -> Outcome<Value> {
    let library = Library::read(library)?;
    let params = SynthParams { width: side, height: side, ..SynthParams::default() };
    let watch = Watch::start("preparation");
    let scene = synth::synthesize(&library, &params, &watch)?;
    watch.next("svg");
    let options = svg::SvgOptions::default();
    let svg_bytes = svg::write(&scene, &options, io::sink())?.bytes;
    let peak = peak_memory();
    watch.next("svgz");
    let svgz_bytes = packed(|out| svg::write(&scene, &options, out).map(|_| ()))?;
    watch.next("png");
    let mut png_bytes = Count(0);
    png::encode(&png::render(&scene, 1.0)?, Some(params.seed), None, &mut png_bytes)?;
    let stages = watch.stop();
    Ok(json!({
        "seconds": sum(&stages, "svgz"),
        "stages": stages,
        "peak_bytes": peak,
        "svg_bytes": svg_bytes,
        "svgz_bytes": svgz_bytes,
        "png_bytes": png_bytes.0,
    }))
}

/// A segmenter whose progress steps count as one stage.
struct Silent(Texton);

impl Segmenter for Silent {
    fn name(&self) -> String {
        self.0.name()
    }

    fn segment(&self, image: &RgbImage, _: &dyn Progress) -> vtex::Result<Vec<ScoredMask>> {
        self.0.segment(image, &())
    }
}

/// A writer that only counts bytes.
struct Count(u64);

impl Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Size in bytes of the compressed output of `content`.
fn packed(content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<u64> {
    let mut out = file::gzip(Count(0));
    content(&mut out)?;
    Ok(out.finish()?.0)
}

/// Peak signal-to-noise ratio over the sRGB components, in dB; `rgba` holds opaque pixels.
fn psnr(image: &RgbImage, rgba: &[u8]) -> f64 {
    let mut sum = 0.0;
    for (a, b) in image.pixels().zip(rgba.chunks_exact(4)) {
        for c in 0..3 {
            let d = f64::from(a.0[c]) - f64::from(b[c]);
            sum += d * d;
        }
    }
    let mean = sum / f64::from(3 * image.width() * image.height());
    10.0 * libm::log10(255.0 * 255.0 / mean)
}

/// The figures as Markdown.
fn tables(all: &[Value]) -> String {
    let mut text = String::from("### Analysis: CPU seconds, memory, library, reconstruction\n\n");
    text += &table(all, "analyze", &["all", "peak MB", "library kB", "gzip kB", "PSNR dB", "SVG kB"], |a| {
        vec![
            mega(&a["peak_bytes"]),
            kilo(&a["library_bytes"]),
            kilo(&a["library_gzip_bytes"]),
            format!("{:.1}", a["reconstruction_psnr"].as_f64().unwrap_or(f64::NAN)),
            kilo(&a["reconstruction_svg_bytes"]),
        ]
    });
    for side in SIDES {
        text += &format!("\n### Synthesis at {side} x {side}: CPU seconds, memory, files\n\n");
        let titles = ["to SVG", "peak MB", "SVG kB", "SVGZ kB", "PNG kB"];
        text += &table(all, &format!("synth_{side}"), &titles, |s| {
            let mut cells = vec![mega(&s["peak_bytes"])];
            cells.extend(["svg_bytes", "svgz_bytes", "png_bytes"].map(|k| kilo(&s[k])));
            cells
        });
    }
    text
}

/// One row for each exemplar: CPU seconds of the stages, their sum, and what `cells` gives.
fn table(all: &[Value], part: &str, titles: &[&str], cells: impl Fn(&Value) -> Vec<String>) -> String {
    let stages_of = |found: &Value| found[part]["stages"].as_array().cloned().unwrap_or_default();
    let mut names: Vec<String> = Vec::new();
    for stage in all.iter().flat_map(stages_of) {
        let name = stage["stage"].as_str().unwrap_or_default();
        if !names.iter().any(|n| n == name) {
            names.push(name.into());
        }
    }
    let head = ["exemplar".into()].into_iter().chain(names.clone());
    let mut text = row(head.chain(titles.iter().map(|t| (*t).into())));
    text += &format!("|---{}|\n", "|--:".repeat(names.len() + titles.len()));
    for found in all {
        let stages = stages_of(found);
        let mut line = vec![found["exemplar"].as_str().unwrap_or_default().to_owned()];
        for name in &names {
            let stage = stages.iter().find(|s| s["stage"] == name.as_str());
            line.push(stage.map_or("–".into(), |s| seconds(&s["seconds"])));
        }
        line.push(seconds(&found[part]["seconds"]));
        line.extend(cells(&found[part]));
        text += &row(line);
    }
    text
}
