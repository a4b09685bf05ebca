//! `vtex analyze`: photograph → library.

use crate::cli::options::{Analysis, Common};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Coverage, Seconds, Summary, peak_memory};

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    let library = stages::analyze(common, analysis, reporter)?;
    reporter.stage("writing")?;
    let written = target.write_bytes(&library.to_json())?;
    let (seconds, warnings) = reporter.finish();
    let summary = Summary {
        program: vtex::PROGRAM,
        command: "analyze",
        inputs: vec![analysis.photo.name()],
        output: target.place.path().display().to_string(),
        pattern: None,
        bytes: written.bytes,
        given_up: None,
        seed: Some(library.source.parameters.seed),
        size: [library.source.width, library.source.height],
        counts: Some(Counts::of_library(&library)),
        coverage: Some(Coverage { wanted: Some(library.coverage), got: None, categories: Vec::new() }),
        overlap: None,
        repetition: None,
        seconds: Seconds(seconds),
        peak_memory: peak_memory(),
        warnings,
    };
    summary.tell(common, target.place == Place::Stdout)
}
