//! `vtex texture`: photograph → texture.

use crate::cli::analysis::{Analysis, analyze};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::{CommandLineValues, ConfigLayer, Parameters};
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists, beside, default_name};
use crate::cli::input::Input;
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::common;
use crate::cli::options::control::{ControlArgs, Steering};
use crate::cli::options::files::{ForceArgs, Makes, outputs, required, targets};
use crate::cli::options::layers::LayerFilesArgs;
use crate::cli::options::masks::MasksArgs;
use crate::cli::options::pattern::PatternArgs;
use crate::cli::options::preset::PresetArgs;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::options::synth::SynthFlags;
use crate::cli::options::variants::VariantsArgs;
use crate::cli::progress::{Plan, Reporter};
use crate::cli::reading;
use crate::cli::recipe::{self, Recipe, of_variant};
use crate::cli::synthesis::{Sources, Synthesis, finish};
use crate::cli::weights::read_weights;
use clap::Args;
use std::path::PathBuf;
use vtex::Progress;
use vtex::output::file::{FileKind, Format};
use vtex::synth::Controls;

const MAKES: Makes = Makes { allowed: format::OF_PHOTO, usual: Format::Svg, word: "texture" };

/// Make a vector texture from a photograph, in one step
#[derive(Args)]
#[command(
    override_usage = "vtex texture [OPTIONS] <PHOTO>",
    mut_args(common(&["size", "tile"])),
    after_long_help = "\
Examples:
  vtex texture photo.jpg -o out.svg --size 1000
  vtex texture photo.jpg -o out.svg -o out.png --keep
  vtex texture photo.jpg -o out.svg --seed 1 --variants 8
  vtex texture photo.jpg --again out.svg --size 2000 -o large.svg
  vtex texture photo.jpg -o - --size 400x300 --seed 7 > out.svg"
)]
pub(crate) struct TextureArgs {
    /// Photograph (PNG, JPEG, TIFF, WebP, BMP, GIF, PNM) or drawing (SVG, SVGZ); - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result: {formats} [default: ./PHOTO.texture.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = MAKES.allowed)]
    pub(crate) output: Vec<PathBuf>,
    /// Also write the library and the scene, to continue later: out.lib.json and out.scene.json beside
    /// out.svg
    #[arg(long, help_heading = "Output")]
    pub(crate) keep: bool,
    /// Repeat the recipe stored in an SVG of this command, to the same bytes; options given here override it
    #[arg(long, value_name = "SVG")]
    pub(crate) again: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) variants: VariantsArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) layer_files: LayerFilesArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
    /// The recipe of `again`, once it is read.
    #[arg(skip)]
    pub(crate) recipe: Option<Recipe>,
}

impl Arguments for TextureArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("analyze", &self.analyze);
        values.add("synth", &self.synth);
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn layer(&mut self) -> anyhow::Result<Option<&ConfigLayer>> {
        self.recipe = self.again.as_deref().map(Recipe::read).transpose()?;
        Ok(self.recipe.as_ref().map(|recipe| &recipe.parameters))
    }

    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Self {
            photo,
            mut output,
            keep,
            force,
            pattern,
            mut control,
            mut masks,
            mut layer_files,
            analyze,
            recipe,
            variants,
            ..
        } = *self;
        let Resolved { mut parameters, seed, values, .. } = resolved;
        parameters.seed = Some(seed);
        if let Some(recipe) = &recipe {
            restore(recipe, &mut control, &mut masks)?;
            if analyze.layers.is_none() && layer_files.layer_map.is_none() {
                layer_files.layer_map = recipe.part("--layer-map").map(|part| part.file.clone());
            }
        }
        let photo = required(photo)?;
        // A seed given here applies to analysis and synthesis.
        let variant = recipe.as_ref().filter(|_| !values.has_seed()).map_or(0, |recipe| recipe.variant);
        parameters.synth.seed = seed.0.wrapping_add(variant);
        read_weights(parameters.weights.clone(), &photo, &mut parameters.synth)?;
        if keep {
            keep_beside(&mut output, &photo)?;
        }
        let targets = targets(output.clone(), &force, &photo, MAKES)?;
        let steering = Steering::new(control, Vec::new());
        let mut written = outputs(&output);
        written.push(("--save-masks", masks.save_masks.as_deref()));
        written.push(layer_files.written());
        steering.check(&[("the photograph", &photo)], &written)?;
        let analysis = Analysis::new(photo, (masks, layer_files), &force, &output, &parameters)?;
        let synthesis = Synthesis::new(parameters.clone(), steering, targets, (pattern, variants), &force)?;
        let texture = Texture { analysis, synthesis, parameters, recipe, variant };
        Ok(Box::new(move |common, reporter| texture.run(common, reporter)))
    }
}

/// Files and models of a recipe, unless the command line names others.
fn restore(recipe: &Recipe, control: &mut ControlArgs, masks: &mut MasksArgs) -> anyhow::Result<()> {
    let part = |role: &str| recipe.part(role).map(|part| part.file.clone());
    if control.domain.is_none() && control.mask.is_none() {
        (control.domain, control.mask) = (part("--domain"), part("--domain-mask"));
    }
    control.density = control.density.take().or_else(|| part("--density"));
    if control.control.is_none() && control.guide.is_none() {
        (control.control, control.guide) = (part("--control"), part("--guide"));
    }
    masks.masks = masks.masks.take().or_else(|| part("--masks"));
    if masks.sam.model.is_none() && masks.sam.encoder.is_none() {
        (masks.sam.encoder, masks.sam.decoder) = (part("--encoder"), part("--decoder"));
        let name = recipe.model.as_deref().map(str::parse).transpose();
        masks.sam.model =
            name.map_err(|e: String| Failure::failed(format!("{}: model: {e}", recipe.place)))?;
    }
    Ok(())
}

/// Adds the names of library and scene, which follow that of the first result.
fn keep_beside(outputs: &mut Vec<PathBuf>, photo: &Input) -> Result<(), Failure> {
    let first = match (outputs.first(), photo) {
        (Some(path), _) if path.as_os_str() != "-" => path.clone(),
        (_, Input::File(photo)) => default_name(photo, MAKES.word, Format::Svg),
        _ => {
            let failure = Failure::usage("nothing says what library and scene of --keep are called");
            return Err(failure.hint("name them, as in -o - -o a.lib.json -o a.scene.json"));
        }
    };
    if outputs.is_empty() {
        outputs.push(first.clone());
    }
    for format in [Format::Library, Format::Scene] {
        let asked = |path: &PathBuf| FileKind::from_path(path).is_some_and(|kind| kind.format == format);
        if !outputs.iter().any(asked) {
            outputs.push(beside(&first, format));
        }
    }
    Ok(())
}

/// How a photograph is analyzed and its texture made.
struct Texture {
    analysis: Analysis,
    synthesis: Synthesis,
    parameters: Parameters,
    recipe: Option<Recipe>,
    /// Offset of the texture's seed from that of the analysis.
    variant: u64,
}

impl Texture {
    fn run(&self, common: &Common, reporter: &Reporter) -> anyhow::Result<()> {
        let Self { analysis, synthesis, recipe, .. } = self;
        synthesis.probe()?;
        analysis.probe()?;
        let photo = match &analysis.input {
            Input::Stdin => None,
            photo @ Input::File(_) => Some([recipe::sum(&photo.read()?)]),
        };
        let replaced = synthesis.ask(common, reporter, photo.as_ref().map(<[String; 1]>::as_slice))?;
        // Faults of the options are reported before the analysis.
        if let Some(recipe) = recipe {
            recipe.check("photo", "the photograph", &analysis.input)?;
            let painted = analysis.layers.painted.iter().map(|file| ("--layer-map", file));
            for (role, file) in synthesis.steering.files().chain(painted) {
                recipe.check(role, &format!("the file of {role}"), file)?;
            }
            if recipe.program != vtex::PROGRAM {
                let Recipe { place, program, .. } = recipe;
                reporter.warn(&format!("{place} was made by {program}, this is {}", vtex::PROGRAM));
            }
        }
        let mut controls = reading::controls(&synthesis.steering, &synthesis.parameters, 1, &Input::read)?;
        let supposed = [synthesis.parameters.width, synthesis.parameters.height];
        let (finder, megapixels) = (Some(analysis.finder()), synthesis.megapixels());
        reporter.plan(Plan { finder, canvas: Some(megapixels), ..Plan::default() });
        let library = analyze(common, analysis, reporter)?;
        controls.structure = reading::structure_guide(&synthesis.steering, &library)?;
        let inputs = vec![analysis.input.name()];
        let synth = synthesis.canvas(std::slice::from_ref(&library));
        if [synth.width, synth.height] != supposed {
            controls = Controls {
                structure: controls.structure,
                ..reading::controls(&synthesis.steering, &synth, 1, &Input::read)?
            };
        }
        let parameters = Parameters { synth, ..self.parameters.clone() };
        let made = recipe::of(
            &parameters,
            analysis.masks(),
            (&synthesis.steering, analysis.layers.painted.as_ref()),
            &library,
            &analysis.input,
        )?;
        let made = of_variant(&made, self.variant);
        let libraries = std::slice::from_ref(&library);
        let sources = Sources { command: "texture", inputs, libraries, recipe: Some(&made) };
        finish(common, reporter, sources, &controls, synthesis)?;
        replaced.iter().for_each(|hint| reporter.hint(hint));
        Ok(())
    }
}
