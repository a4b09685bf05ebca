//! `vtex stylize`: any picture redrawn in the elements of a texture.

use crate::cli::analysis::{Analysis, texture};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::CommandLineValues;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::files::{ForceArgs, Makes, check_files, outputs, required, targets};
use crate::cli::options::render::{RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Targets};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use crate::cli::values::{between, named, one_of};
use clap::Args;
use image::{Rgb, RgbImage};
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{Exemplar, Limits};
use vtex::output::file::Format;
use vtex::output::raster_svg::render_svg;
use vtex::transfer::{Keep, StylizeParams, stylize};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "stylized" };

/// Any picture, redrawn in the elements of a texture
#[derive(Args)]
#[command(
    override_usage = "vtex stylize [OPTIONS] <PICTURE> --with <FILE>",
    after_help = "\
Examples:
  vtex stylize portrait.jpg --with leaves.lib.json -o portrait.svg
  vtex stylize portrait.jpg --with pebbles.lib.json --keep lightness

Elements follow the edges of the picture, and are small where it has detail."
)]
pub(crate) struct StylizeArgs {
    /// The picture: PNG, JPEG, TIFF, WebP, BMP, GIF, PNM or SVG; - reads stdin
    #[arg(value_name = "PICTURE", required = true)]
    pub(crate) picture: Option<PathBuf>,
    /// The texture whose elements are used: a library or a scene, plain or gzip, a photograph or a drawing
    #[arg(long, value_name = "FILE", required = true)]
    pub(crate) with: Option<PathBuf>,
    /// Whether elements take the picture's lightness, its colours, or keep their own, the nearest being
    /// used [lightness, color or none, default: color]
    #[arg(long, value_name = "WORD", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["lightness", "color", "none"], named::<Keep>))]
    pub(crate) keep: Option<Keep>,
    /// Longer side of the canvas [32 to 16384 px, default: 1000]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(32..=16_384))]
    pub(crate) longer_side: Option<u32>,
    /// Distance of the largest elements [2 to 1000 px, default: a 28th of the longer side]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = between(2.0, 1000.0))]
    pub(crate) element_size: Option<f64>,
    /// Sizes of elements, each half the one before, for finer and finer detail [1 to 6, default: 4]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=6))]
    pub(crate) levels: Option<u32>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout; several -o write several files [default: ./PICTURE.stylized.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// A picture, a texture, and how one is redrawn in the other.
struct Stylizing {
    picture: Input,
    with: Analysis,
    params: StylizeParams,
    svg: SvgParameters,
    render: RenderParameters,
    targets: Targets,
}

impl Arguments for StylizeArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let job = Stylizing::new(*self, &resolved)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &job)))
    }
}

impl Stylizing {
    fn new(a: StylizeArgs, resolved: &Resolved) -> Result<Self, Failure> {
        let (picture, with) = (required(a.picture)?, required(a.with)?);
        check_files(&[("the picture", &picture), ("--with", &with)], &outputs(&a.output))?;
        let targets = targets(a.output, &a.force, &picture, MAKES)?;
        let usual = StylizeParams::default();
        let params = StylizeParams {
            size: a.longer_side.unwrap_or(usual.size),
            element: a.element_size,
            levels: a.levels.unwrap_or(usual.levels),
            keep: a.keep.unwrap_or_default(),
            seed: resolved.seed.0,
        };
        let parameters = &resolved.parameters;
        let with = Analysis::plain(with, a.engine, parameters)?;
        let (svg, render) = (parameters.svg, parameters.render);
        Ok(Self { picture, with, params, svg, render, targets })
    }
}

fn run(common: &Common, reporter: &Reporter, job: &Stylizing) -> anyhow::Result<()> {
    let Stylizing { picture, with, params, svg, render, targets } = job;
    targets.probe()?;
    if let Some(warning) = render.warning(targets.has(Format::Png)) {
        reporter.warn(warning);
    }
    reporter.stage("reading")?;
    let bytes = picture.read()?;
    let kind = InputKind::expect(&bytes, picture, &[InputKind::Image, InputKind::Svg, InputKind::Unknown])
        .map_err(|failure| failure.hint("give a picture, such as a photograph"))?;
    let image = match kind {
        InputKind::Svg => drawn(&bytes, &picture.name(), params.size, reporter)?,
        _ => Exemplar::from_bytes(&bytes, &picture.name(), &Limits::default())?.image,
    };
    let elements = texture(common, with, reporter)?;
    reporter.stage("redrawing")?;
    let scene = stylize(&image, &elements, params)?;
    reporter.stage("writing")?;
    let drawing = DrawingOptions { svg: *svg, render: *render, recipe: None };
    let written = targets.write_scene(&scene, None, drawing)?;
    let inputs = vec![picture.name(), with.input.name()];
    let summary = Summary {
        seed: Some(params.seed),
        size: drawing.size_of(&scene, targets.first.kind.format),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("stylize", inputs, targets.path(), written, reporter)
    };
    summary.tell(common, targets.piped())
}

/// An SVG drawn over white; its longer side has as many pixels as the canvas.
fn drawn(bytes: &[u8], name: &str, side: u32, reporter: &Reporter) -> anyhow::Result<RgbImage> {
    let page = render_svg(bytes, 1.0, name, reporter)?;
    let scale = f64::from(side) / f64::from(page.width().max(page.height()));
    let page = if scale == 1.0 { page } else { render_svg(bytes, scale, name, reporter)? };
    // Transparent pixels become white.
    let over_white = |v: u8, alpha: u8| v.saturating_add(255 - alpha);
    Ok(RgbImage::from_fn(page.width(), page.height(), |x, y| {
        let p = page.pixels()[(y * page.width() + x) as usize];
        Rgb([p.red(), p.green(), p.blue()].map(|v| over_white(v, p.alpha())))
    }))
}
