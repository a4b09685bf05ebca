//! Quality and cost of placement: tables in Markdown for given libraries, and a picture of each
//! setting.
//!
//! ```text
//! cargo run --release --example placement_study -- [--seeds N] [--pictures DIR] [--only TABLE] LIBRARY...
//! ```
//!
//! Tables: `speed`, `coverage`, `correlation`, `ablation`. Figures are means over the seeds on canvases
//! of 500 × 500 pixels; pair correlations combine all seeds. If weights named `tuned` are stored next
//! to a library (`vtex tune`), they are compared too.

#[path = "../benches/support/mod.rs"]
mod support;

use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use support::{MEASURE, Outcome, Watch, child, kilo, mega, peak_memory, row, seconds, sum};
use vtex::library::Library;
use vtex::output::{png, svg};
use vtex::sampling::{Stream, stream};
use vtex::scene::{Ablation, Method, Scene, SynthParams};
use vtex::statistics::{Difference, Layout, PairCorrelations, largest_categories, neighbour_distance};
use vtex::synth::{self, Controls, SynthReport};
use vtex::tune::TunedWeights;

const USAGE: &str = "\
Usage: placement_study [--seeds N] [--pictures DIR] [--only speed|coverage|correlation|ablation] LIBRARY...";

/// Sides of the canvases whose cost is measured, in pixels.
const SIDES: [u32; 4] = [500, 1000, 4000, 8000];
/// Numbers of threads for which it is measured.
const THREADS: [u32; 2] = [1, 2];
/// Side of the canvases on which placement is judged, in pixels.
const SIDE: u32 = 500;
/// Parts of the method that the paper's program lacks.
const REFERENCE_LIKE: [Ablation; 5] =
    [Ablation::Growth, Ablation::Removal, Ablation::Copies, Ablation::Seeds, Ablation::Neighbourhoods];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.first().map(String::as_str) {
        Some(MEASURE) => measure(&arguments[1..]),
        _ => Study::new(&arguments).and_then(|study| study.run()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A library under study.
struct Exemplar {
    name: String,
    path: PathBuf,
    library: Library,
    /// Its five largest categories, and the mean distance between neighbours in pixels.
    categories: Vec<vtex::element::CategoryId>,
    unit: f64,
    /// Pair correlation of its own arrangement.
    correlation: PairCorrelations,
}

/// Options of a study.
struct Study {
    seeds: u64,
    pictures: Option<PathBuf>,
    only: Option<String>,
    exemplars: Vec<Exemplar>,
}

impl Study {
    fn new(arguments: &[String]) -> Outcome<Self> {
        let mut study = Self { seeds: 4, pictures: None, only: None, exemplars: Vec::new() };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value = || rest.next().ok_or_else(|| format!("{argument} needs a value\n{USAGE}"));
            match argument.as_str() {
                "--seeds" => study.seeds = value()?.parse::<u64>()?.max(1),
                "--pictures" => study.pictures = Some(value()?.into()),
                "--only" => study.only = Some(value()?.clone()),
                flag if flag.starts_with('-') => return Err(format!("unknown flag {flag}\n{USAGE}").into()),
                path => study.exemplars.push(Exemplar::read(path.as_ref())?),
            }
        }
        if study.exemplars.is_empty() {
            return Err(USAGE.into());
        }
        Ok(study)
    }

    fn run(&self) -> Outcome {
        type Table = (&'static str, fn(&Study) -> Outcome<String>);
        let tables: [Table; 4] = [
            ("speed", Self::speed),
            ("coverage", Self::coverage),
            ("correlation", Self::correlation),
            ("ablation", Self::ablation),
        ];
        let wanted = |name: &str| self.only.as_deref().is_none_or(|only| only == name);
        for (name, table) in tables.into_iter().filter(|(name, _)| wanted(name)) {
            let text = table(self)?;
            writeln!(io::stdout(), "{text}")?;
            eprintln!("measured {name}");
        }
        Ok(())
    }

    fn speed(&self) -> Outcome<String> {
        let mut text = "### Cost of synthesis: CPU seconds by stage, wall seconds, memory\n\n".to_owned();
        let titles = [
            "exemplar",
            "side",
            "threads",
            "placement",
            "density",
            "ground",
            "all",
            "µs / px",
            "wall",
            "peak MB",
            "SVG kB",
        ];
        text += &head(&titles);
        for e in &self.exemplars {
            for side in SIDES {
                for threads in THREADS {
                    let arguments = [e.path.as_os_str(), side.to_string().as_ref()].map(ToOwned::to_owned);
                    let found = child(&[&arguments[0], &arguments[1]], Some(threads))?;
                    let per_pixel =
                        found["seconds"].as_f64().unwrap_or(f64::NAN) * 1e6 / f64::from(side * side);
                    let mut cells = vec![e.name.clone(), side.to_string(), threads.to_string()];
                    cells.extend(["placement", "density", "ground"].map(|s| seconds(&found["stages"][s])));
                    cells.extend([seconds(&found["seconds"]), format!("{per_pixel:.2}")]);
                    cells.extend([
                        seconds(&found["wall"]),
                        mega(&found["peak_bytes"]),
                        kilo(&found["svg_bytes"]),
                    ]);
                    text += &row(cells);
                }
            }
        }
        Ok(text)
    }

    fn coverage(&self) -> Outcome<String> {
        let mut text = "### Coverage, overlap, repetition (per cent)\n\n".to_owned();
        let titles = [
            "exemplar",
            "wanted",
            "got",
            "by category off",
            "hidden",
            "buried",
            "textons",
            "of",
            "largest share",
            "copies within 2",
            "nearest copy px",
            "in neighbours",
            "median px",
        ];
        text += &head(&titles);
        for e in &self.exemplars {
            let f = e.figures(&[], self.seeds)?;
            text += &row([
                e.name.clone(),
                cent(e.library.coverage),
                cent(f.coverage),
                cent(f.off),
                cent(f.hidden),
                cent(f.buried),
                format!("{:.0}", f.textons),
                e.library.primaries().iter().filter(|p| !p.clipped).count().to_string(),
                cent(f.largest_share),
                cent(f.near),
                format!("{:.0}", f.shortest),
                format!("{:.1}", f.shortest / e.unit),
                format!("{:.0}", f.median),
            ]);
        }
        Ok(text)
    }

    fn correlation(&self) -> Outcome<String> {
        let mut text = String::from(
            "### Pair correlation: difference from the exemplar's, and what chance alone would give\n\n",
        );
        let with_noise =
            |d: Option<Difference>| d.map_or("–".into(), |d| format!("{:.3} ({:.3})", d.rms, d.noise));
        let titles = [
            "exemplar",
            "default",
            "reference-like",
            "tuned",
            "own halves",
            "categories shuffled",
            "scattered",
        ];
        text += &head(&titles);
        for e in &self.exemplars {
            let tuned = match e.tuned()? {
                Some(params) => with_noise(e.figures_of(&params, self.seeds)?.difference),
                None => "–".into(),
            };
            text += &row([
                e.name.clone(),
                with_noise(e.figures(&[], self.seeds)?.difference),
                with_noise(e.figures(&REFERENCE_LIKE, self.seeds)?.difference),
                tuned,
                with_noise(e.halves()),
                with_noise(e.spoilt(self.seeds, shuffle)?),
                with_noise(e.spoilt(self.seeds, scatter)?),
            ]);
        }
        Ok(text)
    }

    fn ablation(&self) -> Outcome<String> {
        let mut text = "### Parts left out (per cent, pair correlation)\n\n".to_owned();
        let titles = [
            "exemplar",
            "without",
            "coverage",
            "by category off",
            "hidden",
            "buried",
            "largest share",
            "copies within 2",
            "correlation",
            "noise",
            "CPU s",
        ];
        text += &head(&titles);
        for e in &self.exemplars {
            let mut settings: Vec<(String, SynthParams)> = vec![("nothing".into(), params(&[]))];
            for part in Ablation::ALL {
                let name = serde_json::to_value(part)?.as_str().unwrap_or_default().to_owned();
                settings.push((name, params(&[part])));
            }
            settings.push(("reference-like".into(), params(&REFERENCE_LIKE)));
            if let Some(tuned) = e.tuned()? {
                settings.push(("nothing, tuned weights".into(), tuned));
            }
            for (name, params) in settings {
                let f = e.figures_of(&params, self.seeds)?;
                let difference = |of: fn(Difference) -> f64| {
                    f.difference.map_or("–".into(), |d| format!("{:.3}", of(d)))
                };
                text += &row([
                    e.name.clone(),
                    name.clone(),
                    cent(f.coverage),
                    cent(f.off),
                    cent(f.hidden),
                    cent(f.buried),
                    cent(f.largest_share),
                    cent(f.near),
                    difference(|d| d.rms),
                    difference(|d| d.noise),
                    format!("{:.2}", f.seconds),
                ]);
                if let Some(folder) = &self.pictures {
                    std::fs::create_dir_all(folder)?;
                    let file = format!("{}-{}.png", e.name, name.replace(", ", "-").replace(' ', "-"));
                    let scene = synth::synthesize(&e.library, &params, &())?;
                    let out = io::BufWriter::new(std::fs::File::create(folder.join(file))?);
                    png::encode(&png::render(&scene, 1.0)?, Some(params.seed), None, out)?;
                }
            }
        }
        Ok(text)
    }
}

impl Exemplar {
    fn read(path: &Path) -> Outcome<Self> {
        let library = Library::read(path)?;
        let (categories, unit) = (largest_categories(&library), neighbour_distance(&library));
        let correlation = PairCorrelations::new(
            &Layout::of_library(&library),
            vtex::scene::LibraryId::default(),
            &categories,
            unit,
        );
        let name = stem(path);
        Ok(Self { name, path: path.to_owned(), library, categories, unit, correlation })
    }

    /// The default parameters with the weights named `tuned`, if there are any.
    fn tuned(&self) -> Outcome<Option<SynthParams>> {
        let path = self.path.with_file_name(format!("{}.tuned.weights.json", self.name));
        if !path.exists() {
            return Ok(None);
        }
        Ok(Some(SynthParams { weights: TunedWeights::read(&path)?.weights, ..params(&[]) }))
    }

    fn correlation_of(&self, layout: &Layout) -> PairCorrelations {
        PairCorrelations::new(layout, vtex::scene::LibraryId::default(), &self.categories, self.unit)
    }

    /// Differences between the left and the right half, and between the upper and the lower half.
    fn halves(&self) -> Option<Difference> {
        let layout = Layout::of_library(&self.library);
        let [w, h] = layout.size;
        let half = |from, to| self.correlation_of(&layout.window(from, to));
        let pairs = [
            half([0.0; 2], [w / 2.0, h]).difference(&half([w / 2.0, 0.0], [w, h])),
            half([0.0; 2], [w, h / 2.0]).difference(&half([0.0, h / 2.0], [w, h])),
        ];
        let [a, b] = pairs.map(|d| d.map(|d| [d.rms, d.noise]));
        let (a, b) = (a?, b?);
        let mean = |k: usize| libm::sqrt((a[k] * a[k] + b[k] * b[k]) / 2.0);
        Some(Difference { rms: mean(0), noise: mean(1) })
    }

    /// Difference of default scenes from the exemplar after a deliberate deterioration, as a reference for
    /// bad results.
    fn spoilt(&self, seeds: u64, spoil: fn(&mut Layout, &mut Stream)) -> Outcome<Option<Difference>> {
        let mut curves = Vec::new();
        for seed in 1..=seeds {
            let scene = synth::synthesize(&self.library, &SynthParams { seed, ..params(&[]) }, &())?;
            let mut layout = Layout::of_scene(&scene);
            spoil(&mut layout, &mut stream(seed, "study/spoil", 0));
            curves.push(self.correlation_of(&layout));
        }
        let all = curves.into_iter().reduce(|mut all, one| {
            all.add(&one);
            all
        });
        Ok(all.and_then(|c| c.difference(&self.correlation)))
    }

    fn figures(&self, without: &[Ablation], seeds: u64) -> Outcome<Figures> {
        self.figures_of(&params(without), seeds)
    }

    /// Figures of several scenes.
    fn figures_of(&self, params: &SynthParams, seeds: u64) -> Outcome<Figures> {
        let mut f = Figures::default();
        let mut curves: Option<PairCorrelations> = None;
        for seed in 1..=seeds {
            let params = SynthParams { seed, ..params.clone() };
            let watch = Watch::start("preparation");
            let libraries = std::slice::from_ref(&self.library);
            let (scene, report) = synth::synthesize_with(libraries, &params, &Controls::default(), &watch)?;
            f.seconds += sum(&watch.stop(), "") / seeds as f64;
            f.add(&report, seeds as f64);
            let one = self.correlation_of(&Layout::of_scene(&scene));
            match &mut curves {
                Some(all) => all.add(&one),
                None => curves = Some(one),
            }
        }
        f.difference = curves.and_then(|c| c.difference(&self.correlation));
        Ok(f)
    }
}

/// Keeps all positions and permutes the primaries.
fn shuffle(layout: &mut Layout, random: &mut Stream) {
    let mut places: Vec<[f64; 2]> = layout.centres.iter().map(|c| c.at).collect();
    random.shuffle(&mut places);
    layout.centres.iter_mut().zip(places).for_each(|(c, at)| c.at = at);
}

/// Moves all primaries to random positions.
fn scatter(layout: &mut Layout, random: &mut Stream) {
    let size = layout.size;
    layout.centres.iter_mut().for_each(|c| c.at = size.map(|side| random.range(0.0, side)));
}

/// Figures averaged over scenes; shares are 0 to 1, lengths in pixels.
#[derive(Default)]
struct Figures {
    coverage: f64,
    /// Missing or excess coverage, summed over categories, as a share of the wanted coverage.
    off: f64,
    hidden: f64,
    buried: f64,
    textons: f64,
    largest_share: f64,
    near: f64,
    shortest: f64,
    median: f64,
    seconds: f64,
    difference: Option<Difference>,
}

impl Figures {
    fn add(&mut self, report: &SynthReport, scenes: f64) {
        let off: f64 = report.categories.iter().map(|c| (c.got - c.wanted).abs()).sum();
        let copies = report.repetition.copies;
        for (sum, value) in [
            (&mut self.coverage, report.coverage),
            (&mut self.off, off / report.coverage_wanted),
            (&mut self.hidden, report.overlap.hidden),
            (&mut self.buried, report.overlap.buried),
            (&mut self.textons, report.repetition.textons as f64),
            (&mut self.largest_share, report.repetition.largest_share),
            (&mut self.near, report.repetition.near),
            (&mut self.shortest, copies.map_or(f64::NAN, |c| c.shortest)),
            (&mut self.median, copies.map_or(f64::NAN, |c| c.median)),
        ] {
            *sum += value / scenes;
        }
    }
}

/// Synthesises one canvas and prints its cost as JSON.
fn measure(arguments: &[String]) -> Outcome {
    let [library, side] = arguments else { return Err("unknown measurement".into()) };
    let library = Library::read(library.as_ref())?;
    let side = side.parse()?;
    let begin = std::time::Instant::now();
    let watch = Watch::start("preparation");
    let method = Method::Descriptor;
    let params = SynthParams { width: side, height: side, method, ..SynthParams::default() };
    let scene: Scene = synth::synthesize(&library, &params, &watch)?;
    let wall = begin.elapsed().as_secs_f64();
    let stages = watch.stop();
    let total = sum(&stages, "");
    let stages: serde_json::Map<String, Value> =
        stages.into_iter().map(|s| (s.stage, json!(s.seconds))).collect();
    let peak = peak_memory();
    let svg_bytes = svg::write(&scene, &svg::SvgOptions::default(), io::sink())?.bytes;
    let found = json!({
        "seconds": total,
        "stages": stages,
        "wall": wall,
        "peak_bytes": peak,
        "svg_bytes": svg_bytes,
    });
    println!("{found}");
    Ok(())
}

fn params(without: &[Ablation]) -> SynthParams {
    let (method, ablate) = (Method::Descriptor, without.to_vec());
    SynthParams { width: SIDE, height: SIDE, seed: 1, method, ablate, ..SynthParams::default() }
}

/// `photo` for `some/photo.lib.json`.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').next().unwrap_or_default().to_owned()
}

/// The first two lines of a table.
fn head(titles: &[&str]) -> String {
    row(titles.iter().map(|t| (*t).into())) + &format!("|---{}|\n", "|--:".repeat(titles.len() - 1))
}

/// A share in per cent.
fn cent(share: f64) -> String {
    format!("{:.1}", 100.0 * share)
}
