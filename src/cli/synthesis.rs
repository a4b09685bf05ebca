//! Makes a texture of libraries, writes it, and prints a summary.

use super::common::Common;
use super::config::Parameters;
use super::failure::Failure;
use super::hints::of_no_elements;
use super::options::context::ContextFiles;
use super::options::control::Steering;
use super::options::files::ForceArgs;
use super::options::pattern::{PatternArgs, pattern};
use super::options::render::RenderParameters;
use super::options::svg::{SvgForm, SvgParameters};
use super::options::variants::{VariantsArgs, of_seed, target_of_seed};
use super::output::{DrawingOptions, Target, Targets, say};
use super::progress::Reporter;
use super::recipe::of_variant;
use super::replacing::{self, TextureOrigin};
use super::summary::{
    Coverage, ElementCounts, LayersReport, MotifCount, PhotographPreparation, PhotographReduction, SEVERAL,
    Summary, bytes, exemplar_of, few_whole,
};
use super::values::Resolution;
use serde_json::Value;
use vtex::Progress;
use vtex::library::Library;
use vtex::output::file::Format;
use vtex::scene::{Scene, SynthParams, splat};
use vtex::synth::{CanvasSize, Controls, Cost, SynthReport, reconstruct, synthesize_with};

/// How a texture is made and written.
pub(crate) struct Synthesis {
    pub(crate) parameters: SynthParams,
    /// The size of the canvas that is asked for, and its pixels to the inch.
    pub(crate) asked: (CanvasSize, Resolution),
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
        let Parameters { synth, size, svg, render, .. } = parameters;
        let pattern = pattern(pattern_args, force, &targets)?;
        for (option, given) in
            [("--pattern", pattern.is_some()), ("--as pattern", svg.form == SvgForm::Pattern)]
        {
            if given && !synth.tile.both() {
                let message = format!("{option} needs a texture that repeats along both axes");
                return Err(Failure::usage(message).hint("give --tile, for both axes"));
            }
        }
        let variants = variants.count(&targets)?;
        Ok(Self {
            parameters: synth,
            asked: (size, render.dpi),
            steering,
            context: None,
            svg,
            // The scene has the page.
            render: RenderParameters { dpi: Resolution::default(), ..render },
            targets,
            pattern,
            variants,
        })
    }

    /// Takes the page of a drawing as the canvas, unless a size was given.
    pub(crate) fn on_page(&mut self, page: [u32; 2]) {
        if self.asked.0 == CanvasSize::Auto {
            self.asked.0 = CanvasSize::Pixels(page);
        }
    }

    /// The parameters with the canvas asked for, or with that which suits the libraries.
    pub(crate) fn canvas(&self, libraries: &[Library]) -> SynthParams {
        let (size, resolution) = self.asked;
        let mut parameters = self.parameters.clone();
        self.svg.form.set_canvas(size, &mut parameters, libraries, resolution);
        parameters
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
                let size = match self.asked.0 {
                    CanvasSize::Pixels(size) => Some(size),
                    _ => None,
                };
                (targets, TextureOrigin { seed, size, exemplars: exemplars.map(<[String]>::to_vec) })
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

/// Makes and writes a texture, and prints its summary; also the second half of `texture`.
pub(crate) fn finish(
    common: &Common,
    reporter: &Reporter,
    sources: Sources<'_>,
    controls: &Controls,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    let Sources { command, inputs, libraries, recipe } = sources;
    let Synthesis { svg, render, targets, .. } = synthesis;
    let parameters = &synthesis.canvas(libraries);
    if let Some(warning) = render.warning(targets.any_uses(|uses| uses.scale)) {
        reporter.warn(warning);
    }
    if common.verbosity > 1 {
        for library in libraries {
            say(&format!("{:#?}", library.source.parameters));
        }
        say(&format!("{parameters:#?}"));
    }
    let as_pdf = !targets.has(Format::Svg) && targets.has(Format::Pdf);
    if let Some([warning, hint]) = heavy(parameters, libraries, as_pdf) {
        reporter.warn(&warning);
        reporter.hint(&hint);
    }
    let drawing = DrawingOptions { svg: *svg, render: *render, recipe: None };
    if render.ink.is_some() || svg.form == SvgForm::Pattern {
        // Faults that the exemplars show are reported before the synthesis.
        libraries.iter().try_for_each(|library| drawing.check(&reconstruct(library)))?;
    }
    for variant in 0..synthesis.variants {
        let (seed, targets, pattern) = synthesis.variant(variant);
        let parameters = SynthParams { seed, ..parameters.clone() };
        let (scene, report) = synthesize_with(libraries, &parameters, controls, reporter)?;
        if scene.individuals().next().is_none()
            && let Some(hint) = of_no_elements(libraries, &parameters)
        {
            reporter.hint(hint);
        }
        let library = libraries.first();
        let recipe = recipe.map(|recipe| of_variant(recipe, variant));
        let drawing = DrawingOptions { recipe: recipe.as_ref(), ..drawing };
        let exemplar = exemplar_of(libraries);
        let result = FinishedTexture { command, inputs: inputs.clone(), library, exemplar, scene, report };
        result.write(common, reporter, drawing, &targets, pattern.as_ref())?;
    }
    Ok(())
}

/// What a texture costs that is much larger than usual, as an SVG or a PDF, and a size that costs less; `None` for
/// another.
pub(crate) fn heavy(parameters: &SynthParams, libraries: &[Library], as_pdf: bool) -> Option<[String; 2]> {
    let usual = CanvasSize::usual_for(parameters, libraries);
    let [cost, less] = [parameters, &usual].map(|parameters| Cost::of(libraries, parameters));
    if !cost.is_heavy(&less) {
        return None;
    }
    let words = |cost: &Cost| {
        let file = match as_pdf {
            false => format!("an SVG of {}", bytes(cost.svg_bytes as u64)),
            true => format!("a PDF of {}", bytes(cost.pdf_bytes as u64)),
        };
        let time = match cost.seconds {
            seconds if seconds < 120.0 => format!("{:.0} s", seconds.max(1.0)),
            seconds => format!("{:.0} min", seconds / 60.0),
        };
        let shapes = match cost.shapes {
            shapes if shapes < 1e6 => format!("{:.0} thousand shapes", (shapes / 1e3).max(1.0)),
            shapes => format!("{:.1} million shapes", shapes / 1e6),
        };
        format!("about {shapes}, {file}, {time}")
    };
    let SynthParams { width, height, .. } = *parameters;
    let warning = format!("a canvas of {width} x {height} px is large for this exemplar: {}", words(&cost));
    let instead = match parameters.page {
        Some([width, height]) => format!("--size {width}x{height} without --dpi"),
        None => format!("--size {}x{}", usual.width, usual.height),
    };
    let hint = format!("{instead} has larger elements, which are vectors and stay sharp: {}", words(&less));
    Some([warning, hint])
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
        let own = library.filter(|_| exemplar != SEVERAL).map(|library| library.coverage);
        let summary = Summary {
            pattern: pattern.map(|p| p.place.path().display().to_string()),
            seed: scene.parameters.as_ref().map(|p| p.seed),
            size: drawing.size_of(&scene, targets.first.kind.format),
            page: drawing.page(&scene),
            reduced: library.filter(|_| command == "texture").and_then(PhotographReduction::of_library),
            prepared: library
                .filter(|_| command == "texture")
                .map(PhotographPreparation::of_library)
                .unwrap_or_default(),
            counts: Some(ElementCounts::of_scene(&scene)),
            coverage: Some(Coverage {
                wanted: Some(report.coverage_wanted),
                got: Some(report.coverage),
                categories: report.categories,
                exemplar,
                own,
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
