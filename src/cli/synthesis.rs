//! Makes a texture of libraries, writes it, and prints a summary.

use super::common::Common;
use super::config::Parameters;
use super::failure::Failure;
use super::options::context::ContextFiles;
use super::options::control::Steering;
use super::options::files::ForceArgs;
use super::options::pattern::{PatternArgs, pattern};
use super::options::render::RenderParameters;
use super::options::svg::SvgParameters;
use super::options::variants::{VariantsArgs, of_seed, target_of_seed};
use super::output::{DrawingOptions, Target, Targets, say};
use super::progress::Reporter;
use super::recipe::of_variant;
use super::replacing::{self, TextureOrigin};
use super::summary::{
    Coverage, ElementCounts, LayersReport, MotifCount, PhotographReduction, Summary, exemplar_of, few_whole,
};
use serde_json::Value;
use vtex::Progress;
use vtex::library::Library;
use vtex::output::file::Format;
use vtex::scene::{Scene, SynthParams, splat};
use vtex::synth::{Controls, SynthReport, default_size, synthesize_with};

/// How a texture is made and written.
pub(crate) struct Synthesis {
    pub(crate) parameters: SynthParams,
    /// Whether the size of the canvas was given.
    pub(crate) sized: bool,
    pub(crate) steering: Steering,
    /// The drawing that stays, and the region beside it.
    pub(crate) context: Option<ContextFiles>,
    pub(crate) svg: SvgParameters,
    pub(crate) render: RenderParameters,
    pub(crate) targets: Targets,
    pub(crate) pattern: Option<Target>,
    /// Number of textures: one of the seed, and one of each seed that follows it.
    pub(crate) variants: u64,
}

impl Synthesis {
    /// Checks the options.
    pub(crate) fn new(
        parameters: Parameters,
        steering: Steering,
        targets: Targets,
        (pattern_args, variants): (PatternArgs, VariantsArgs),
        force: &ForceArgs,
    ) -> Result<Self, Failure> {
        let Parameters { synth, sized, svg, render, .. } = parameters;
        let pattern = pattern(pattern_args, force, &targets)?;
        // Controls are fitted to the canvas, so its size counts as given.
        let sized = sized || steering.files().next().is_some();
        if pattern.is_some() && !synth.tile.both() {
            let message = "--pattern needs a texture that repeats along both axes";
            return Err(Failure::usage(message).hint("give --tile, for both axes"));
        }
        let variants = variants.count(&targets)?;
        Ok(Self {
            parameters: synth,
            sized,
            steering,
            context: None,
            svg,
            render,
            targets,
            pattern,
            variants,
        })
    }

    /// Takes the page of a drawing as the canvas, unless a size was given.
    pub(crate) fn on_page(&mut self, page: [u32; 2]) {
        if !self.sized {
            [self.parameters.width, self.parameters.height] = page;
            self.sized = true;
        }
    }

    /// Megapixels of the canvas.
    pub(crate) fn megapixels(&self) -> f64 {
        f64::from(self.parameters.width) * f64::from(self.parameters.height) / 1e6
    }

    /// Fails early if a file could not be written later.
    ///
    /// # Errors
    /// As [`super::output::Destination::probe`].
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        (0..self.variants).try_for_each(|variant| {
            let (_, targets, pattern) = self.variant(variant);
            targets.probe()?;
            pattern.map_or(Ok(()), |p| p.place.probe())
        })
    }

    /// Asks before pictures of other textures are replaced, or returns a hint to be printed at the end;
    /// `exemplars` are the checksums of the exemplars.
    ///
    /// # Errors
    /// Those of [`replacing::ask`].
    pub(crate) fn ask(
        &self,
        common: &Common,
        reporter: &Reporter,
        exemplars: Option<&[String]>,
    ) -> anyhow::Result<Option<String>> {
        let made: Vec<(Targets, TextureOrigin)> = (0..self.variants)
            .map(|variant| {
                let (seed, targets, _) = self.variant(variant);
                (targets, TextureOrigin { seed, exemplars: exemplars.map(<[String]>::to_vec) })
            })
            .collect();
        replacing::ask(common, reporter, &made)
    }

    /// Seed and files of a variant, counted from 0.
    fn variant(&self, variant: u64) -> (u64, Targets, Option<Target>) {
        let seed = self.parameters.seed.wrapping_add(variant);
        if self.variants == 1 {
            return (seed, self.targets.clone(), self.pattern.clone());
        }
        let pattern = self.pattern.as_ref().map(|pattern| target_of_seed(pattern, seed));
        (seed, of_seed(&self.targets, seed), pattern)
    }
}

/// The sources of a texture.
pub(crate) struct Sources<'a> {
    pub(crate) command: &'static str,
    pub(crate) inputs: Vec<String>,
    pub(crate) libraries: &'a [Library],
    /// The recipe, for a texture of a photograph.
    pub(crate) recipe: Option<&'a Value>,
}

/// The parameters with the canvas that suits the libraries, unless a size was given.
pub(crate) fn canvas(parameters: &SynthParams, sized: bool, libraries: &[Library]) -> SynthParams {
    let mut parameters = parameters.clone();
    if !sized {
        [parameters.width, parameters.height] = default_size(libraries);
    }
    parameters
}

/// Makes and writes a texture, and prints its summary; also the second half of `texture`.
pub(crate) fn finish(
    common: &Common,
    reporter: &Reporter,
    sources: Sources<'_>,
    controls: &Controls,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    let Sources { command, inputs, libraries, recipe } = sources;
    let Synthesis { parameters, svg, render, targets, sized, .. } = synthesis;
    let parameters = &canvas(parameters, *sized, libraries);
    if let Some(warning) = render.warning(targets.has(Format::Png)) {
        reporter.warn(warning);
    }
    if common.verbosity > 1 {
        for library in libraries {
            say(&format!("{:#?}", library.source.parameters));
        }
        say(&format!("{parameters:#?}"));
    }
    for variant in 0..synthesis.variants {
        let (seed, targets, pattern) = synthesis.variant(variant);
        let parameters = SynthParams { seed, ..parameters.clone() };
        let (scene, report) = synthesize_with(libraries, &parameters, controls, reporter)?;
        let library = libraries.first();
        let recipe = recipe.map(|recipe| of_variant(recipe, variant));
        let drawing = DrawingOptions { svg: svg.fit(libraries), render: *render, recipe: recipe.as_ref() };
        let exemplar = exemplar_of(libraries);
        let result = FinishedTexture { command, inputs: inputs.clone(), library, exemplar, scene, report };
        result.write(common, reporter, drawing, &targets, pattern.as_ref())?;
    }
    Ok(())
}

/// A finished texture, to be written.
pub(crate) struct FinishedTexture<'a> {
    pub(crate) command: &'static str,
    pub(crate) inputs: Vec<String>,
    /// The library that it was made from, if that may be written too.
    pub(crate) library: Option<&'a Library>,
    /// The kind of exemplar, for messages.
    pub(crate) exemplar: &'static str,
    pub(crate) scene: Scene,
    pub(crate) report: SynthReport,
}

impl FinishedTexture<'_> {
    /// Writes the texture and prints the summary.
    pub(crate) fn write(
        self,
        common: &Common,
        reporter: &Reporter,
        drawing: DrawingOptions<'_>,
        targets: &Targets,
        pattern: Option<&Target>,
    ) -> anyhow::Result<()> {
        let Self { command, inputs, library, exemplar, scene, report } = self;
        reporter.picture("gaussians", &|| splat(&scene));
        reporter.stage("writing")?;
        let written = targets.write_scene(&scene, library, drawing)?;
        if let Some(pattern) = pattern {
            pattern.write_pattern(&scene, drawing)?;
        }
        let layers = LayersReport::of_texture(&report);
        let summary = Summary {
            pattern: pattern.map(|p| p.place.path().display().to_string()),
            seed: scene.parameters.as_ref().map(|p| p.seed),
            size: drawing.size_of(&scene, targets.first.kind.format),
            reduced: library.filter(|_| command == "texture").and_then(PhotographReduction::of_library),
            counts: Some(ElementCounts::of_scene(&scene)),
            coverage: Some(Coverage {
                wanted: Some(report.coverage_wanted),
                got: Some(report.coverage),
                categories: report.categories,
                exemplar,
            }),
            layers,
            motifs: library.filter(|_| command == "texture").map_or(Vec::new(), MotifCount::of_library),
            method: Some(report.method),
            few_whole: report.structure.as_ref().zip(library).and_then(|(s, library)| few_whole(s, library)),
            structure: report.structure,
            overlap: Some(report.overlap),
            repetition: Some(report.repetition),
            period: report.period,
            clusters: report.clusters,
            curves: report.curves,
            ..Summary::new(command, inputs, targets.path(), written, reporter)
        };
        // `warp` uses the scene's own seed unless one was given.
        let seed_chosen = common.seed_chosen && command != "warp";
        summary.print(&Common { seed_chosen, ..common.clone() }, targets.piped())
    }
}
