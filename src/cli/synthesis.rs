//! Libraries → texture, written and summed up.

use super::common::Common;
use super::config::Parameters;
use super::failure::Failure;
use super::options::control::Steering;
use super::options::files::ForceArgs;
use super::options::pattern::{PatternArgs, pattern};
use super::options::svg::SvgParameters;
use super::output::{Place, Target, say};
use super::progress::Reporter;
use super::summary::{Counts, Coverage, Summary};
use vtex::library::Library;
use vtex::scene::{Scene, SynthParams};
use vtex::synth::{Controls, Report, synthesize_with};

/// How a texture is made and written.
pub(crate) struct Synthesis {
    pub(crate) parameters: SynthParams,
    pub(crate) steering: Steering,
    pub(crate) svg: SvgParameters,
    pub(crate) target: Target,
    pub(crate) pattern: Option<Target>,
}

impl Synthesis {
    /// Checks what was asked for.
    pub(crate) fn new(
        parameters: Parameters,
        steering: Steering,
        target: Target,
        pattern_args: PatternArgs,
        force: &ForceArgs,
    ) -> Result<Self, Failure> {
        let Parameters { synth, svg, .. } = parameters;
        let pattern = pattern(pattern_args, force, &target)?;
        if pattern.is_some() && !synth.tile.both() {
            let message = "--pattern needs a texture that repeats along both axes";
            return Err(Failure::usage(message).hint("give --tile, for both axes"));
        }
        Ok(Self { parameters: synth, steering, svg, target, pattern })
    }

    /// Fails now if a file could not be written later.
    ///
    /// # Errors
    /// As [`Place::probe`].
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        self.target.place.probe()?;
        self.pattern.as_ref().map_or(Ok(()), |p| p.place.probe())
    }
}

/// Makes, writes and sums up a texture: the second half of `texture` too.
pub(crate) fn finish(
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
    let (scene, report) = synthesize_with(libraries, parameters, controls, reporter)?;
    let result = Made { command, inputs, scene, report };
    result.write(common, reporter, *svg, target, pattern.as_ref())
}

/// A texture that is done.
pub(crate) struct Made {
    pub(crate) command: &'static str,
    pub(crate) inputs: Vec<String>,
    pub(crate) scene: Scene,
    pub(crate) report: Report,
}

impl Made {
    /// Writes it and sums up.
    pub(crate) fn write(
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
