//! `vtex vectorize`: photograph → the same picture in vectors.

use crate::cli::config::SvgParameters;
use crate::cli::options::{Analysis, Common};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Seconds, Summary, peak_memory};
use vtex::Progress;

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    svg: SvgParameters,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    let library = stages::analyze(common, analysis, reporter)?;
    let scene = stages::reconstruct(&library);
    reporter.stage("writing")?;
    let written = target.write_scene(&scene, svg, 1.0)?;
    for warning in &written.warnings {
        reporter.warn(warning);
    }
    let (seconds, warnings) = reporter.finish();
    let summary = Summary {
        program: vtex::PROGRAM,
        command: "vectorize",
        inputs: vec![analysis.photo.name()],
        output: target.place.path().display().to_string(),
        pattern: None,
        bytes: written.bytes,
        given_up: written.given_up,
        seed: Some(library.source.parameters.seed),
        size: [scene.width, scene.height],
        counts: Some(Counts::of_scene(&scene)),
        coverage: None,
        overlap: None,
        repetition: None,
        seconds: Seconds(seconds),
        peak_memory: peak_memory(),
        warnings,
    };
    summary.tell(common, target.place == Place::Stdout)
}
