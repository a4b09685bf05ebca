//! A scene carried by a flow, in a loop.

use super::arguments::{AnimateArgs, FRAMES_OF_LOOP, FlowFrom};
use super::play::{idle, play_all};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::frames::Frames;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{check_files, outputs};
use crate::cli::options::frames::Played;
use crate::cli::output::DrawingOptions;
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::Summary;
use vtex::flow::{Flow, FlowParams, Flowing};
use vtex::output::file::BackgroundChoice;
use vtex::output::raster_animation::RasterAnimation;
use vtex::output::svg::SvgOptions;
use vtex::{Progress, control};

/// A scene, its flow, and the outputs.
pub(super) struct Flowed {
    scene: Input,
    flow: FlowFrom,
    params: FlowParams,
    animation: RasterAnimation,
    /// The outputs, at least one.
    wanted: Vec<Played>,
    drawing: DrawingOptions<'static>,
}

impl Flowed {
    pub(super) fn new(
        mut a: AnimateArgs,
        scene: Input,
        seed: u64,
        drawing: DrawingOptions<'static>,
    ) -> Result<Self, Failure> {
        let flow = a.flow.take().unwrap_or(FlowFrom::Known(Flow::Wind));
        let mut read = vec![("the scene", &scene)];
        if let FlowFrom::File(file) = &flow {
            read.push(("--flow", file));
        }
        check_files(&read, &outputs(&a.output))?;
        let params = FlowParams { rounds: a.rounds, strength: a.strength, seed };
        let animation = RasterAnimation { frames: a.frames.unwrap_or(FRAMES_OF_LOOP), rate: a.fps };
        let wanted = a.played("'vtex edit' writes them")?;
        Ok(Self { scene, flow, params, animation, wanted, drawing })
    }
}

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Flowed) -> anyhow::Result<()> {
    job.wanted.iter().try_for_each(Played::probe)?;
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
    let (drawing, animation) = (job.drawing, job.animation);
    idle(&drawing, &job.wanted, true).iter().for_each(|warning| reporter.warn(warning));
    let share = |k: u32| f64::from(k) / f64::from(animation.frames);
    let frames = Frames { reporter, drawing, animation, scene: &|k| flowing.at(share(k)) };
    let opaque = drawing.render.background != Some(BackgroundChoice::None) && scene.domain.is_none();
    let seconds = f64::from(animation.frames) / animation.rate;
    let written = play_all(&frames, &job.wanted, opaque, |target| {
        target.write_flow(&flowing, seconds, &SvgOptions::from(drawing.svg).fit(&scene))
    })?;
    let first = &job.wanted[0];
    let summary = Summary {
        seed: Some(job.params.seed),
        size: drawing.size_of(&scene, first.format()),
        page: drawing.page(&scene),
        ..Summary::new("animate", vec![job.scene.name()], first.path(), written, reporter)
    };
    summary.print(common, false)
}
