//! `vtex warp`: scene → scene of another shape.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::CommandLineValues;
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::input::{Input, InputKind};
use crate::cli::number::Takes;
use crate::cli::options::files::{ForceArgs, Makes, check_files, outputs, required, targets};
use crate::cli::options::render::RenderParameters;
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Targets};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::exemplar_of;
use crate::cli::synthesis::FinishedTexture;
use crate::cli::values::{Factors, named, one_of};
use clap::Args;
use std::path::PathBuf;
use vtex::control;
use vtex::output::file::Format;
use vtex::scene::{Edge, Scene};
use vtex::warp::{Bend, WarpParams, warp};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "warped" };

/// Bend or stretch a scene; elements keep their size and density
#[derive(Args)]
#[command(
    override_usage = "vtex warp [OPTIONS] <SCENE> <LIBRARY>...",
    after_long_help = "\
Examples:
  vtex warp wide.scene.json photo.lib.json --stretch 1.5x1 -o wider.svg
  vtex warp a.scene.json photo.lib.json --cage a.svg --to b.svg -o bent.svg

Elements move. New ones fill the gaps, and some are removed where it is crowded.
The scene's seed decides on the new ones, unless you give --seed."
)]
pub(crate) struct WarpArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scene: Option<PathBuf>,
    /// The libraries that the scene was made from, plain or gzip; - reads stdin
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Vec<PathBuf>,
    /// Cage before: an SVG with one closed path, drawn over the scene; one SVG pixel is one pixel of the
    /// scene
    #[arg(long, value_name = "FILE", requires = "to", conflicts_with = "scale")]
    pub(crate) cage: Option<PathBuf>,
    /// Cage after: a copy whose points you moved; its page is the new canvas
    #[arg(long, value_name = "FILE", requires = "cage")]
    pub(crate) to: Option<PathBuf>,
    /// Stretch the canvas: 1.5 or 1.5x2
    #[arg(long = "stretch", value_name = "FACTOR", takes = Bend::FACTORS)]
    pub(crate) scale: Option<Factors>,
    /// Elements at the edge of the new shape: keep them whole, clip them, or avoid the edge [keep, clip or
    /// avoid, default: as in the scene]
    #[arg(long, value_name = "HOW", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["keep", "clip", "avoid"], named::<Edge>))]
    pub(crate) edge: Option<Edge>,
    /// Result: {formats} [default: ./SCENE.warped.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = MAKES.allowed)]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// How a scene is bent and written.
struct Warping {
    scene: Input,
    libraries: Vec<Input>,
    how: BendInput,
    parameters: WarpParams,
    svg: SvgParameters,
    targets: Targets,
}

/// The kinds of bends.
enum BendInput {
    /// Factors along x and y.
    Scale([f64; 2]),
    /// A cage, before and after.
    Cage([Input; 2]),
}

impl Arguments for WarpArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let seed = resolved.parameters.seed.map(|s| s.0);
        let parameters = WarpParams { seed, edge: self.edge };
        let warping = Warping::new(*self, parameters, resolved.parameters.svg)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &warping)))
    }
}

impl Warping {
    fn new(a: WarpArgs, parameters: WarpParams, svg: SvgParameters) -> Result<Self, Failure> {
        let scene = required(a.scene)?;
        let libraries: Vec<Input> = a.library.into_iter().map(Input::new).collect();
        let output = a.output.clone();
        let targets = targets(a.output, &a.force, &scene, MAKES)?;
        let how = match (a.scale, a.cage, a.to) {
            (Some(Factors(factors)), ..) => BendInput::Scale(factors),
            (None, Some(cage), Some(to)) => BendInput::Cage([cage, to].map(Input::new)),
            _ => {
                return Err(Failure::usage("nothing says how to bend the scene")
                    .hint("give --stretch, or two cages with --cage and --to"));
            }
        };
        let mut read = vec![("the scene", &scene)];
        read.extend(libraries.iter().map(|file| ("the library", file)));
        if let BendInput::Cage([cage, to]) = &how {
            read.extend([("--cage", cage), ("--to", to)]);
        }
        check_files(&read, &outputs(&output))?;
        Ok(Self { scene, libraries, how, parameters, svg, targets })
    }
}

fn run(common: &Common, reporter: &Reporter, warping: &Warping) -> anyhow::Result<()> {
    let Warping { scene, libraries, how, parameters, svg, targets } = warping;
    targets.probe()?;
    reporter.stage("reading")?;
    let before = reading::scene(scene)?;
    let bend = bend(&before, how)?;
    let known = reading::libraries(libraries)?;
    let mut inputs = vec![scene.name()];
    inputs.extend(libraries.iter().map(Input::name));
    if let BendInput::Cage(cages) = how {
        inputs.extend(cages.iter().map(Input::name));
    }
    let exemplar = exemplar_of(&known);
    let (result, report) = warp(&before, known, &bend, *parameters, reporter)?;
    let drawing = DrawingOptions { svg: *svg, render: RenderParameters::default(), recipe: None };
    let made = FinishedTexture { command: "warp", inputs, library: None, exemplar, scene: result, report };
    made.write(common, reporter, drawing, targets, None)
}

/// The bend of a scene.
fn bend(scene: &Scene, how: &BendInput) -> anyhow::Result<Bend> {
    let read = |file: &Input| {
        let bytes = file.read()?;
        InputKind::expect(&bytes, file, &[InputKind::Svg, InputKind::Unknown])
            .map_err(|failure| failure.hint("a cage is drawn as an SVG with one closed path"))?;
        anyhow::Ok(control::cage(&bytes, &file.name())?)
    };
    Ok(match how {
        BendInput::Scale(factors) => Bend::scale(scene, *factors)?,
        BendInput::Cage([before, after]) => {
            let (before, _) = read(before)?;
            let (after, canvas) = read(after)?;
            Bend::cage(before, after, canvas)?
        }
    })
}
