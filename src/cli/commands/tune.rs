//! `vtex tune`: library → weights of the score.

use crate::cli::input::{Input, Kind};
use crate::cli::options::{Common, Tuning};
use crate::cli::output::{print, say};
use crate::cli::progress::Reporter;
use crate::cli::summary::{Seconds, bytes, peak_memory};
use serde::Serialize;
use std::fmt::Write;
use vtex::Error;
use vtex::library::Library;
use vtex::tune::{Terms, TunedWeights, tune};

/// The summary in JSON.
#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    command: &'static str,
    input: String,
    output: String,
    /// Bytes written.
    bytes: u64,
    /// What was written.
    tuned: &'a TunedWeights,
    seconds: Seconds,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_memory: Option<u64>,
    warnings: Vec<String>,
}

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    input: &Input,
    tuning: &Tuning,
) -> anyhow::Result<()> {
    let Tuning { name, parameters, place } = tuning;
    place.probe()?;
    reporter.stage("reading")?;
    let content = input.read()?;
    Kind::expect(&content, input, &[Kind::Library, Kind::Unknown])?;
    let library = Library::from_bytes(&content, &input.name())?;
    drop(content);
    if common.verbosity > 1 {
        say(&format!("{parameters:#?}"));
    }
    let tuned = tune(&library, parameters, reporter)?;
    reporter.stage("writing")?;
    let json = tuned.to_json();
    let (_, written) = place.write(|out| out.write_all(&json).map_err(|e| Error::write(place.path(), e)))?;
    let (seconds, warnings) = reporter.finish();
    let seconds = Seconds(seconds);
    let output = place.path().display().to_string();
    if common.json {
        let summary = Summary {
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
        return print(format!("{}\n", serde_json::to_string_pretty(&summary)?).as_bytes());
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
        say(&format!("seed: {0} (give --seed {0} for the same again)", tuned.seed));
    }
    say(&format!("use them with 'vtex synth {} --weights {name}'", input.name()));
    Ok(())
}

/// What the search has changed, term by term; of all less is better.
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
