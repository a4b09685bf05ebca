//! `vtex synth`: library → texture.

use crate::cli::input::{Input, Kind};
use crate::cli::options::{Common, Synthesis};
use crate::cli::output::{Place, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Coverage, Seconds, Summary, peak_memory};
use vtex::Progress;
use vtex::library::Library;
use vtex::synth::Controls;

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    inputs: &[Input],
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    synthesis.probe()?;
    reporter.stage("reading")?;
    let controls = stages::controls(&synthesis.steering, &synthesis.parameters, inputs.len())?;
    let mut libraries = Vec::with_capacity(inputs.len());
    for input in inputs {
        let bytes = input.read()?;
        // What is nothing known may still be a damaged library, and reading it says where.
        Kind::expect(&bytes, input, &[Kind::Library, Kind::Unknown])?;
        libraries.push(Library::from_bytes(&bytes, &input.name())?);
    }
    let names = inputs.iter().map(Input::name).collect();
    finish(common, reporter, "synth", names, &libraries, &controls, synthesis)
}

/// Makes, writes and sums up a texture: the second half of `texture` too.
pub(super) fn finish(
    common: &Common,
    reporter: &Reporter,
    command: &'static str,
    inputs: Vec<String>,
    libraries: &[Library],
    controls: &Controls,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    let Synthesis { parameters, svg, target, pattern, .. } = synthesis;
    if common.verbosity > 1 {
        for library in libraries {
            say(&format!("{:#?}", library.source.parameters));
        }
        say(&format!("{parameters:#?}"));
    }
    let (scene, report) = stages::synthesize(libraries, parameters, controls, reporter)?;
    reporter.stage("writing")?;
    let written = target.write_scene(&scene, &(*svg).into(), 1.0)?;
    if let Some(pattern) = pattern {
        pattern.write_pattern(&scene, &(*svg).into())?;
    }
    for warning in &written.warnings {
        reporter.warn(warning);
    }
    let (seconds, warnings) = reporter.finish();
    let summary = Summary {
        program: vtex::PROGRAM,
        command,
        inputs,
        output: target.place.path().display().to_string(),
        pattern: pattern.as_ref().map(|p| p.place.path().display().to_string()),
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
