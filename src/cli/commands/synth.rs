//! `vtex synth`: library → texture.

use crate::cli::input::{Input, Kind};
use crate::cli::options::{Common, Synthesis};
use crate::cli::output::{Place, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Coverage, Seconds, Summary, peak_memory};
use vtex::Progress;
use vtex::library::Library;

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    input: &Input,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    synthesis.target.place.probe()?;
    reporter.stage("reading")?;
    let bytes = input.read()?;
    // What is nothing known may still be a damaged library, and reading it says where.
    Kind::expect(&bytes, input, &[Kind::Library, Kind::Unknown])?;
    let library = Library::from_bytes(&bytes, &input.name())?;
    finish(common, reporter, "synth", input.name(), library, synthesis)
}

/// Makes, writes and sums up a texture: the second half of `texture` too.
pub(super) fn finish(
    common: &Common,
    reporter: &Reporter,
    command: &'static str,
    input: String,
    library: Library,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    let Synthesis { parameters, svg, target } = synthesis;
    if common.verbosity > 1 {
        say(&format!("{:#?}\n{parameters:#?}", library.source.parameters));
    }
    let (scene, report) = stages::synthesize(library, parameters, reporter)?;
    reporter.stage("writing")?;
    let written = target.write_scene(&scene, &(*svg).into(), 1.0)?;
    for warning in &written.warnings {
        reporter.warn(warning);
    }
    let (seconds, warnings) = reporter.finish();
    let summary = Summary {
        program: vtex::PROGRAM,
        command,
        input,
        output: target.place.path().display().to_string(),
        bytes: written.bytes,
        seed: Some(parameters.seed),
        size: [scene.width, scene.height],
        counts: Some(Counts::of_scene(&scene)),
        coverage: Some(Coverage {
            wanted: Some(report.coverage_wanted),
            got: Some(report.coverage),
            categories: report.categories,
        }),
        overlap: Some(report.overlap),
        repetition: Some(report.repetition),
        seconds: Seconds(seconds),
        peak_memory: peak_memory(),
        warnings,
    };
    summary.tell(common, target.place == Place::Stdout)
}
