//! `vtex synth`: library → texture.

use crate::cli::config::SvgParameters;
use crate::cli::input::Input;
use crate::cli::options::{Common, Synthesis};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Coverage, Summary};
use vtex::library::Library;
use vtex::scene::Scene;
use vtex::synth::{Controls, Report};

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    inputs: &[Input],
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    synthesis.probe()?;
    reporter.stage("reading")?;
    let controls = stages::controls(&synthesis.steering, &synthesis.parameters, inputs.len())?;
    let libraries = stages::libraries(inputs)?;
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
    let result = Made { command, inputs, scene, report };
    result.write(common, reporter, *svg, target, pattern.as_ref())
}

/// A texture that is done.
pub(super) struct Made {
    pub(super) command: &'static str,
    pub(super) inputs: Vec<String>,
    pub(super) scene: Scene,
    pub(super) report: Report,
}

impl Made {
    /// Writes it and sums up.
    pub(super) fn write(
        self,
        common: &Common,
        reporter: &Reporter,
        svg: SvgParameters,
        target: &Target,
        pattern: Option<&Target>,
    ) -> anyhow::Result<()> {
        let Self { command, inputs, scene, report } = self;
        reporter.stage("writing")?;
        let written = target.write_scene(&scene, svg, 1.0)?;
        if let Some(pattern) = pattern {
            pattern.write_pattern(&scene, svg)?;
        }
        let summary = Summary {
            pattern: pattern.map(|p| p.place.path().display().to_string()),
            seed: scene.parameters.as_ref().map(|p| p.seed),
            size: [scene.width, scene.height],
            counts: Some(Counts::of_scene(&scene)),
            coverage: Some(Coverage {
                wanted: Some(report.coverage_wanted),
                got: Some(report.coverage),
                categories: report.categories,
            }),
            method: Some(report.method),
            structure: report.structure,
            overlap: Some(report.overlap),
            repetition: Some(report.repetition),
            ..Summary::new(command, inputs, target.place.path(), written, reporter)
        };
        summary.tell(common, target.place == Place::Stdout)
    }
}
