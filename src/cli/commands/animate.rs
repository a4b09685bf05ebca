//! `vtex animate`: a scene carried by a flow, as pictures that play in a loop.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::CommandLineValues;
use crate::cli::failure::Failure;
use crate::cli::frames::Frames;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{ForceArgs, apart, check_files, outputs, required};
use crate::cli::options::frames::{AnimationKind, FrameFormat, Played, formats, played, rate};
use crate::cli::options::render::{BackgroundChoice, RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Target};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::Summary;
use crate::cli::values::between;
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use std::ffi::OsString;
use std::path::PathBuf;
use vtex::flow::{Flow, FlowParams, Flowing};
use vtex::output::file::{FileKind, Format};
use vtex::output::raster_animation::RasterAnimation;
use vtex::{Progress, control};

/// A scene in motion: carried by a flow, in a loop without a jump
#[derive(Args)]
#[command(
    override_usage = "vtex animate [OPTIONS] <SCENE> --output <FILE>",
    after_help = "\
Examples:
  vtex animate grass.scene.json --flow wind -o grass.gif
  vtex animate pebbles.scene.json --flow vortex --frames 90 -o turning.svg
  vtex animate leaves.scene.json --flow directions.png -o frames --format png

Elements come in at the borders as others leave. Best are scenes that repeat
('vtex synth --tile'). An animated SVG moves in browsers and shows the scene
at rest elsewhere."
)]
pub(crate) struct AnimateArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scene: Option<PathBuf>,
    /// The upper and the lower third of the canvas sheared, all turned about the middle, gusts of wind,
    /// or along directions: a grey picture, black right, dark grey down, middle grey left, light grey up
    /// [shear, vortex, wind or a file, default: wind]
    #[arg(long, value_name = "FLOW", value_parser = OsStringValueParser::new().map(flow))]
    pub(crate) flow: Option<FlowFrom>,
    /// Pictures in a loop [2 to 10000, default: 60]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=10000))]
    pub(crate) frames: Option<u32>,
    /// Pictures in a second [0.1 to 100, default: 15]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = rate)]
    pub(crate) fps: Option<f64>,
    /// Rounds, or gusts, in a loop [1 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) rounds: Option<u32>,
    /// Factor of how far wind and directions carry elements [0.01 to 10, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = between(0.01, 10.0))]
    pub(crate) strength: Option<f64>,
    /// Result, by extension .svg, .svgz, .gif, .png or .apng, or a folder for frames; several -o write
    /// several files
    #[arg(short, long, value_name = "FILE", required = true, help_heading = "Output")]
    pub(crate) output: Vec<PathBuf>,
    /// Frames in a folder are [svg or png, default: svg]
    #[arg(long, value_name = "FORMAT", hide_possible_values = true, value_parser = formats())]
    pub(crate) format: Option<FrameFormat>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// A flow, or the file that says it.
#[derive(Clone, Debug)]
pub(crate) enum FlowFrom {
    Known(Flow),
    File(Input),
}

fn flow(text: OsString) -> FlowFrom {
    match text.to_str() {
        Some("shear") => FlowFrom::Known(Flow::Shear),
        Some("vortex") => FlowFrom::Known(Flow::Vortex),
        Some("wind") => FlowFrom::Known(Flow::Wind),
        _ => FlowFrom::File(Input::new(text.into())),
    }
}

/// A scene, and how it moves and is written.
struct Animating {
    scene: Input,
    flow: FlowFrom,
    params: FlowParams,
    animation: RasterAnimation,
    wanted: Vec<Played>,
    drawing: DrawingOptions<'static>,
}

impl Arguments for AnimateArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let (svg, render) = (resolved.parameters.svg, resolved.parameters.render);
        let job = Animating::new(*self, resolved.seed.0, svg, render)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &job)))
    }
}

impl Animating {
    fn new(a: AnimateArgs, seed: u64, svg: SvgParameters, render: RenderParameters) -> Result<Self, Failure> {
        let scene = required(a.scene)?;
        let flow = a.flow.unwrap_or(FlowFrom::Known(Flow::Wind));
        let mut read = vec![("the scene", &scene)];
        if let FlowFrom::File(file) = &flow {
            read.push(("--flow", file));
        }
        check_files(&read, &outputs(&a.output))?;
        apart(&outputs(&a.output))?;
        if a.output.is_empty() {
            return Err(Failure::usage("nothing says where the animation goes")
                .hint("give -o animation.svg, .gif or .png, or a folder for frames"));
        }
        let one = |path| played(path, a.format, a.force.force, "'vtex edit' writes them");
        let wanted: Vec<Played> = a.output.into_iter().map(one).collect::<Result<_, _>>()?;
        let params = FlowParams { rounds: a.rounds.unwrap_or(1), strength: a.strength.unwrap_or(1.0), seed };
        let animation = RasterAnimation { frames: a.frames.unwrap_or(60), rate: a.fps.unwrap_or(15.0) };
        let drawing = DrawingOptions { svg, render, recipe: None };
        Ok(Self { scene, flow, params, animation, wanted, drawing })
    }
}

fn run(common: &Common, reporter: &Reporter, job: &Animating) -> anyhow::Result<()> {
    for wanted in &job.wanted {
        wanted.probe()?;
    }
    reporter.stage("reading")?;
    let scene = reading::scene(&job.scene)?;
    let flow = match &job.flow {
        FlowFrom::Known(flow) => flow.clone(),
        FlowFrom::File(file) => {
            let bytes = file.read()?;
            InputKind::expect(&bytes, file, &[InputKind::Image, InputKind::Unknown])
                .map_err(|failure| failure.hint("--flow takes shear, vortex, wind or a grey picture"))?;
            Flow::Field(control::level(&bytes, &file.name())?)
        }
    };
    let flowing = Flowing::new(&scene, &flow, &job.params)?;
    if let Some(warning) = job.drawing.render.warning(job.wanted.iter().any(Played::drawn)) {
        reporter.warn(warning);
    }
    let is_svg = |w: &Played| matches!(w, Played::Animation { kind: AnimationKind::Svg { .. }, .. });
    let svg = job.wanted.first().is_some_and(is_svg);
    if job.drawing.svg.max_bytes.is_some() && job.wanted.iter().all(is_svg) {
        reporter.warn("--max-bytes has no effect here: nothing of an animation can be given up");
    }
    let share = |k: u32| f64::from(k) / f64::from(job.animation.frames);
    let frames =
        Frames { reporter, drawing: job.drawing, animation: job.animation, scene: &|k| flowing.at(share(k)) };
    let opaque = job.drawing.render.background != Some(BackgroundChoice::None) && scene.domain.is_none();
    let mut made = Vec::new();
    for wanted in &job.wanted {
        made.push(match wanted {
            Played::Frames { folder, kind, force } => {
                (folder.as_path(), frames.write_files(folder, (*kind, *force))?)
            }
            Played::Animation { place, kind: AnimationKind::Gif } => (place.path(), frames.write_gif(place)?),
            Played::Animation { place, kind: AnimationKind::Png } => {
                (place.path(), frames.write_png(place, opaque)?)
            }
            Played::Animation { place, kind: AnimationKind::Svg { gzip } } => {
                reporter.stage("drawing")?;
                let kind = FileKind { format: Format::Svg, gzip: *gzip };
                let target = Target { place: place.clone(), kind };
                let seconds = f64::from(job.animation.frames) / job.animation.rate;
                (place.path(), target.write_flow(&flowing, seconds, &job.drawing.svg.into())?)
            }
        });
    }
    let mut made = made.into_iter();
    let Some((path, mut written)) = made.next() else { return Ok(()) };
    for (path, other) in made {
        written.others.push((path.to_owned(), other.bytes));
        written.warnings.extend(other.warnings);
    }
    let summary = Summary {
        seed: Some(job.params.seed),
        size: job.drawing.size_of(&scene, if svg { Format::Svg } else { Format::Png }),
        ..Summary::new("animate", vec![job.scene.name()], path, written, reporter)
    };
    summary.tell(common, false)
}
