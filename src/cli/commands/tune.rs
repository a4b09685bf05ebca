//! `vtex tune`: library → weights of the score.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format::weights_path;
use crate::cli::input::{Input, InputKind};
use crate::cli::number::Takes;
use crate::cli::options::files::{ForceArgs, required};
use crate::cli::output::{Destination, print_json, say};
use crate::cli::progress::Reporter;
use crate::cli::summary::{Seconds, bytes, peak_memory};
use crate::cli::values::{Name, Size};
use crate::cli::weights::read_weights;
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use vtex::library::Library;
use vtex::scene::SynthParams;
use vtex::tune::{Terms, TuneParams, TunedWeights, tune};

/// Search for placement weights that suit a library
#[derive(Args)]
#[command(
    override_usage = "vtex tune [OPTIONS] <LIBRARY>",
    after_long_help = "\
Examples:
  vtex tune photo.lib.json
  vtex tune photo.lib.json --name slow --seeds 10 --evaluations 2000 --seed 7

The weights are written beside the library, as photo.tuned.weights.json. To use
them: vtex synth photo.lib.json --weights tuned"
)]
pub(crate) struct TuneArgs {
    /// The library, plain or gzip
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Option<PathBuf>,
    /// Name of the weights: letters, digits, - and _ [default: tuned]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<Name>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) search: TuneFlags,
}

/// How weights are searched.
#[derive(Args)]
pub(crate) struct TuneFlags {
    /// Number of canvases to place for each set of weights
    #[arg(long, number = TuneParams::SEEDS, default_value_t = TuneParams::SEEDS.default())]
    pub(crate) seeds: u32,
    /// Number of sets of weights to try
    #[arg(long, number = TuneParams::EVALUATIONS, default_value_t = TuneParams::EVALUATIONS.default())]
    pub(crate) evaluations: u32,
    /// Canvas size: 1000, 1000x600, or at 96 px per inch: 300mm, 12in
    #[arg(long, value_name = "SIZE")]
    #[arg(takes = format!("{}, default: {}", Size::canvas(TuneParams::SIDE), TuneParams::SIDE.default()))]
    pub(crate) size: Option<Size>,
}

/// Parameters of the search, and the output.
struct Tuning {
    name: String,
    parameters: TuneParams,
    place: Destination,
}

impl Arguments for TuneArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Resolved { mut parameters, .. } = resolved;
        let library = required(self.library.clone())?;
        read_weights(parameters.weights.take(), &library, &mut parameters.synth)?;
        let tuning = Tuning::new(*self, &library, parameters.synth)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &library, &tuning)))
    }
}

impl Tuning {
    fn new(a: TuneArgs, library: &Input, synth: SynthParams) -> anyhow::Result<Self> {
        let Input::File(beside) = library else {
            let failure = Failure::usage("the weights are written beside the library, so it must be a file");
            return Err(failure.hint("write the library to a file first").into());
        };
        let defaults = TuneParams::default();
        let [width, height] =
            a.search.size.and_then(Size::pixels).unwrap_or([defaults.synth.width, defaults.synth.height]);
        let parameters = TuneParams {
            synth: SynthParams { width, height, ..synth },
            seeds: a.search.seeds,
            evaluations: a.search.evaluations,
        };
        parameters.validate()?;
        let name = a.name.map_or("tuned".into(), |n| n.as_str().to_owned());
        let path = weights_path(beside, &name);
        Ok(Self { name, parameters, place: Destination::File { path, force: a.force.force } })
    }
}

/// The summary in JSON.
#[derive(Serialize)]
struct TuneSummary<'a> {
    program: &'static str,
    command: &'static str,
    input: String,
    output: String,
    /// Bytes written.
    bytes: u64,
    /// The written file.
    tuned: &'a TunedWeights,
    seconds: Seconds,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_memory: Option<u64>,
    warnings: Vec<String>,
}

fn run(common: &Common, reporter: &Reporter, input: &Input, tuning: &Tuning) -> anyhow::Result<()> {
    let Tuning { name, parameters, place } = tuning;
    place.probe()?;
    reporter.stage("reading")?;
    let content = input.read()?;
    InputKind::expect(&content, input, &[InputKind::Library, InputKind::Unknown])?;
    let library = Library::from_bytes(content, &input.name())?;
    if common.verbosity > 1 {
        say(&format!("{parameters:#?}"));
    }
    let tuned = tune(&library, parameters, reporter)?;
    reporter.stage("writing")?;
    let json = tuned.to_json();
    let (_, written) = place.write(|out| out.write_all(&json))?;
    let (seconds, warnings) = reporter.finish();
    let seconds = Seconds(seconds);
    let output = place.path().display().to_string();
    if common.json {
        let summary = TuneSummary {
            program: vtex::PROGRAM,
            command: "tune",
            input: input.name(),
            output,
            bytes: written,
            tuned: &tuned,
            seconds,
            peak_memory: peak_memory(),
            warnings,
        };
        return print_json(&summary, false);
    }
    if common.quiet {
        return Ok(());
    }
    say(&format!(
        "{output}: {} sets of weights on {} canvases of {} x {} px each, {} in {:.2} s",
        tuned.evaluations,
        tuned.seeds,
        tuned.size[0],
        tuned.size[1],
        bytes(written),
        seconds.total()
    ));
    say(table(&tuned).trim_end());
    if common.seed_chosen {
        say(&format!("seed: {0} (give --seed {0} to make the same again)", tuned.seed));
    }
    if tuned.after.objective() < tuned.before.objective() {
        say(&format!("use them with 'vtex synth {} --weights {name}'", input.name()));
    } else {
        say(&format!("no better weights were found: '{output}' contains those that the search began with"));
    }
    Ok(())
}

/// The terms before and after the search; smaller is better for all.
fn table(tuned: &TunedWeights) -> String {
    let w = &tuned.weights;
    let weights = [w.target, w.uncovered, w.empty, w.mismatched, w.same_overlap].map(|v| v.to_string());
    let mut text =
        format!("  weights        {}\n  {:12} {:>8} {:>8}\n", weights.join(","), "", "before", "after");
    type Term = (&'static str, fn(&Terms) -> f64);
    let terms: [Term; 5] = [
        ("coverage", |t| t.coverage),
        ("overlap", |t| t.overlap),
        ("repetition", |t| t.repetition),
        ("correlation", |t| t.correlation),
        ("objective", Terms::objective),
    ];
    for (name, term) in terms {
        let _ = writeln!(text, "  {name:12} {:8.4} {:8.4}", term(&tuned.before), term(&tuned.after));
    }
    text
}
