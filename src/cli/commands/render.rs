//! `vtex render`: library, scene or SVG → picture.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::CommandLineValues;
use crate::cli::failure::Failure;
use crate::cli::format::{self, Allowed, Lists};
use crate::cli::input::{Input, InputKind};
use crate::cli::number::Takes;
use crate::cli::options::common;
use crate::cli::options::files::{ForceArgs, Makes, check_files, outputs, required, targets};
use crate::cli::options::pattern::{PatternArgs, pattern};
use crate::cli::options::render::{RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Target, Targets, WrittenFile};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use clap::Args;
use std::path::PathBuf;
use vtex::library::Library;
use vtex::output::file::Format;
use vtex::output::{png, raster_svg};
use vtex::scene::{Scene, SynthParams};
use vtex::synth::reconstruct;
use vtex::{Parameter, Progress};

/// Width of a picture.
const WIDTH: Parameter<u32> = Parameter { unit: "px", default: None, ..SynthParams::SIDE };

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Png, word: "" };
/// The formats into which an SVG is not drawn.
const OTHERS: Allowed = |format| (MAKES.allowed)(format) && format != Format::Png;

/// Draw a library (as its exemplar), a scene or an SVG as a picture
#[derive(Args)]
#[command(
    override_usage = "vtex render [OPTIONS] <FILE>",
    mut_args(common(&["scale"])),
    after_long_help = "\
Examples:
  vtex render photo.lib.json -o reconstruction.png
  vtex render out.svg -o out.png --scale 2
  vtex render out.scene.json -o out.svg"
)]
pub(crate) struct RenderArgs {
    /// A library, scene or SVG, plain or gzip; - reads stdin
    #[arg(value_name = "FILE", required = true)]
    pub(crate) file: Option<PathBuf>,
    /// Result: .png; for a library or scene also {formats} [default: ./FILE.png]
    ///
    /// - writes PNG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = OTHERS)]
    pub(crate) output: Vec<PathBuf>,
    /// Width of a PNG, if you give no scale
    #[arg(long, number_or(WIDTH, "as the scale says"), conflicts_with = "scale", help_heading = "Output")]
    pub(crate) width: Option<u32>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// How a file is drawn.
struct RenderOptions {
    width: Option<u32>,
    scale: RenderParameters,
    svg: SvgParameters,
    targets: Targets,
    pattern: Option<Target>,
}

impl Arguments for RenderArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Self { file, output, width, force, pattern: beside, .. } = *self;
        let file = required(file)?;
        let mut written = outputs(&output);
        written.push(("--pattern", beside.pattern.as_deref()));
        check_files(&[("the input", &file)], &written)?;
        let targets = targets(output, &force, &file, MAKES)?;
        let pattern = pattern(beside, &force, &targets)?;
        let (scale, svg) = (resolved.parameters.render, resolved.parameters.svg);
        let options = RenderOptions { width, scale, svg, targets, pattern };
        Ok(Box::new(move |common, reporter| run(common, reporter, &file, &options)))
    }
}

fn run(common: &Common, reporter: &Reporter, input: &Input, options: &RenderOptions) -> anyhow::Result<()> {
    let RenderOptions { width, scale: parameters, svg, targets, pattern } = options;
    let (mut parameters, svg) = (*parameters, *svg);
    targets.probe()?;
    if let Some(pattern) = pattern {
        pattern.place.probe()?;
    }
    if let Some(warning) = parameters.warning(targets.any_uses(|uses| uses.scale)) {
        reporter.warn(warning);
    }
    reporter.stage("reading")?;
    let bytes = input.read()?;
    let name = input.name();
    let scene =
        match InputKind::expect(&bytes, input, &[InputKind::Library, InputKind::Scene, InputKind::Svg])? {
            InputKind::Library => {
                let library = Library::from_bytes(&bytes, &name)?;
                Some(reconstruct(&library))
            }
            InputKind::Scene => Some(Scene::from_bytes(&bytes, &name)?),
            _ => None,
        };
    if pattern.is_some() {
        match &scene {
            None => {
                let message = "--pattern needs a scene; an SVG cannot be made to repeat";
                return Err(Failure::usage(message).hint("give the scene that it was drawn from").into());
            }
            Some(scene) if !scene.tile.both() => return Err(vtex::Error::Seams.into()),
            Some(_) => {}
        }
    }
    reporter.stage("drawing")?;
    if let Some(width) = width {
        let own = match &scene {
            Some(scene) => scene.picture_size(1.0)[0],
            None => raster_svg::render_svg(&bytes, 1.0, &name, reporter)?.width(),
        };
        parameters.scale = f64::from(*width) / f64::from(own);
    }
    let scale = parameters.scale;
    let drawing = DrawingOptions { svg, render: parameters, recipe: None };
    let (written, size) = match &scene {
        Some(scene) => {
            let written = targets.write_scene(scene, None, drawing)?;
            (written, drawing.size_of(scene, targets.first.kind.format))
        }
        None if targets.all().all(|t| t.kind.format == Format::Png) => {
            let picture = raster_svg::render_svg(&bytes, scale, &name, reporter)?;
            let write = |target: &Target| target.place.write(|out| png::encode(&picture, None, None, out));
            let written = targets.each(|target| Ok(WrittenFile::of(write(target)?.1)))?;
            (written, [picture.width(), picture.height()])
        }
        None => {
            let message = format!("'{name}' is an SVG already; it can be drawn as .png only");
            return Err(Failure::usage(message).hint("to write an SVG, give a library or a scene").into());
        }
    };
    if let (Some(pattern), Some(scene)) = (pattern, &scene) {
        pattern.write_pattern(scene, drawing)?;
    }
    let summary = Summary {
        pattern: pattern.as_ref().map(|p| p.place.path().display().to_string()),
        size,
        page: scene.as_ref().and_then(|scene| drawing.page(scene)),
        counts: scene.as_ref().map(ElementCounts::of_scene),
        ..Summary::new("render", vec![name], targets.path(), written, reporter)
    };
    summary.print(common, targets.piped())
}
