//! Any picture redrawn in the elements of a texture.

use super::arguments::TransferArgs;
use crate::cli::analysis::{Analysis, texture};
use crate::cli::command::Resolved;
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{Makes, check_files, outputs, required, targets};
use crate::cli::options::render::RenderParameters;
use crate::cli::options::svg::SvgParameters;
use crate::cli::output::{DrawingOptions, Targets};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use image::{Rgb, RgbImage};
use vtex::Progress;
use vtex::analyze::{Exemplar, Limits};
use vtex::output::file::Format;
use vtex::output::raster_svg::render_svg;
use vtex::transfer::{StylizeParams, stylize};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "stylized" };

/// A picture, a texture, and the parameters of redrawing.
pub(super) struct Redrawing {
    picture: Input,
    with: Analysis,
    params: StylizeParams,
    svg: SvgParameters,
    render: RenderParameters,
    targets: Targets,
}

impl Redrawing {
    pub(super) fn new(a: TransferArgs, resolved: &Resolved) -> Result<Self, Failure> {
        let picture = required(a.onto)?;
        let [with] = <[_; 1]>::try_from(a.appearance)
            .map_err(|_| {
                Failure::usage("a picture is redrawn in one appearance").hint("give --appearance one file")
            })?
            .map(Input::new);
        check_files(&[("--onto", &picture), ("--appearance", &with)], &outputs(&a.output))?;
        let targets = targets(a.output, &a.force, &picture, MAKES)?;
        let params = StylizeParams {
            size: a.longer_side,
            element: a.element_size,
            levels: a.levels,
            keep: a.keep.unwrap_or_default(),
            seed: resolved.seed.0,
        };
        let parameters = &resolved.parameters;
        let with = Analysis::plain(with, a.engine, parameters)?;
        let (svg, render) = (parameters.svg, parameters.render);
        Ok(Self { picture, with, params, svg, render, targets })
    }
}

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Redrawing) -> anyhow::Result<()> {
    let Redrawing { picture, with, params, svg, render, targets } = job;
    targets.probe()?;
    if let Some(warning) = render.warning(targets.any_uses(|uses| uses.scale)) {
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
        page: drawing.page(&scene),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("transfer", inputs, targets.path(), written, reporter)
    };
    summary.print(common, targets.piped())
}

/// An SVG over white, its longer side as many pixels as the canvas has.
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
