//! `vtex synth`: library → texture.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::{CommandLineValues, ConfigLayer, Parameters};
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::input::Input;
use crate::cli::options::common;
use crate::cli::options::context::{ContextArgs, ContextFiles};
use crate::cli::options::control::{ControlArgs, Steering};
use crate::cli::options::files::{ForceArgs, Makes, outputs, targets};
use crate::cli::options::pattern::PatternArgs;
use crate::cli::options::preset::PresetArgs;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::options::synth::{SynthBackgroundFlags, SynthFlags};
use crate::cli::options::variants::VariantsArgs;
use crate::cli::progress::{Plan, Reporter};
use crate::cli::reading;
use crate::cli::synthesis::{Sources, Synthesis, finish};
use crate::cli::weights::read_weights;
use clap::Args;
use std::path::PathBuf;
use vtex::output::file::Format;
use vtex::scene::{Method, SynthParams};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "" };

/// Make a vector texture from a library
#[derive(Args)]
#[command(
    override_usage = "vtex synth [OPTIONS] <LIBRARY>...",
    mut_args(common(&["size", "tile", "domain"])),
    after_long_help = "\
Examples:
  vtex synth photo.lib.json --size 1000x600 --seed 7
  vtex synth photo.lib.json --domain logo.svg --density dense-left.png
  vtex synth sand.lib.json stones.lib.json --map where-stones.png
  vtex synth photo.lib.json -o out.scene.json.gz
  vtex synth photo.lib.json --tile --pattern page.svg
  vtex synth waves.lib.json --context drawn.svg --region free.svg
  vtex synth photo.lib.json -o - | gzip > out.svgz"
)]
pub(crate) struct SynthArgs {
    /// The library, plain or gzip; - reads stdin. Several, at most 16, share the canvas with --map
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Vec<PathBuf>,
    /// Result: {formats} [default: ./LIBRARY.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = MAKES.allowed)]
    pub(crate) output: Vec<PathBuf>,
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
    pub(crate) background: SynthBackgroundFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    /// Where to use which of several libraries. For two: a grey picture, black for the first and white for
    /// the second. For more: a picture with one colour for each, in the order of its palette, or from dark to
    /// light. Or one grey picture for each, white where it is used, one after the other
    #[arg(long, value_name = "FILE", help_heading = "Control (pictures are stretched over the canvas)")]
    pub(crate) map: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) context: ContextArgs,
}

impl Arguments for SynthArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("synth", &self.synth);
        values.add("synth", &self.background);
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let (libraries, synthesis) = self.synthesis(resolved.parameters)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &libraries, synthesis)))
    }
}

impl SynthArgs {
    /// Checks the options: the libraries, and what is made of them.
    pub(crate) fn synthesis(self, mut parameters: Parameters) -> anyhow::Result<(Vec<Input>, Synthesis)> {
        let Self { library, output, force, variants, pattern, control, map, context, .. } = self;
        let context = context.files();
        let libraries: Vec<Input> = library.into_iter().map(Input::new).collect();
        let Some(first) = libraries.first() else {
            return Err(Failure::usage("no input is given").into());
        };
        let targets = targets(output.clone(), &force, first, MAKES)?;
        let steering = Steering::new(control, map);
        if context.is_some() {
            check_context(libraries.len(), &parameters.synth)?;
        }
        let mut read: Vec<_> = libraries.iter().map(|file| ("the library", file)).collect();
        read.extend(context.iter().flat_map(ContextFiles::named));
        steering.check(&read, &outputs(&output))?;
        steering.check_counts(libraries.len())?;
        read_weights(parameters.weights.clone(), first, &mut parameters.synth)?;
        let synthesis = Synthesis::new(parameters, steering, targets, (pattern, variants), &force)?;
        Ok((libraries, Synthesis { context, ..synthesis }))
    }
}

/// Refuses what does not go with a drawing that stays.
fn check_context(libraries: usize, asked: &SynthParams) -> Result<(), Failure> {
    let (message, hint) = match asked.method {
        _ if libraries > 1 => {
            let message = format!("--context is for a single library, {libraries} are given");
            (message, "give the library of which the region is to be filled")
        }
        _ if asked.tile.any() => ("--context does not go with --tile".into(), "leave out --tile"),
        Method::Auto | Method::Curves | Method::Clustered => return Ok(()),
        _ => ("--context is for --method curves and clustered".into(), "leave out --method"),
    };
    Err(Failure::usage(message).hint(hint))
}

fn run(
    common: &Common,
    reporter: &Reporter,
    inputs: &[Input],
    mut synthesis: Synthesis,
) -> anyhow::Result<()> {
    synthesis.probe()?;
    reporter.plan(Plan { canvas: Some(synthesis.megapixels()), ..Plan::default() });
    reporter.stage("reading")?;
    let drawing = synthesis.context.as_ref().map(|files| files.drawing(reporter)).transpose()?;
    if let Some(drawing) = &drawing {
        synthesis.on_page([drawing.source.width, drawing.source.height]);
    }
    let synthesis = &synthesis;
    let libraries = reading::libraries(inputs)?;
    let parameters = synthesis.canvas(&libraries);
    let mut controls = reading::controls(&synthesis.steering, &parameters, inputs.len(), &Input::read)?;
    if let Some((files, drawing)) = synthesis.context.as_ref().zip(drawing) {
        controls.context = Some(files.beside(drawing, &parameters, &libraries[0])?);
    }
    let exemplars: Vec<String> = libraries.iter().map(|l| l.source.sha256.clone()).collect();
    let replaced = synthesis.ask(common, reporter, Some(&exemplars))?;
    controls.structure = reading::structure_guide(&synthesis.steering, &libraries[0])?;
    let names = inputs.iter().map(Input::name).collect();
    let sources = Sources { command: "synth", inputs: names, libraries: &libraries, recipe: None };
    finish(common, reporter, sources, &controls, synthesis)?;
    replaced.iter().for_each(|hint| reporter.hint(hint));
    Ok(())
}
