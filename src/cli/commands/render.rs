//! `vtex render`: library, scene or SVG → picture.

use crate::cli::failure::Failure;
use crate::cli::input::{Input, Kind};
use crate::cli::options::{Common, RenderOptions};
use crate::cli::output::{Place, Written};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Summary};
use vtex::Progress;
use vtex::library::Library;
use vtex::output::file::Format;
use vtex::output::{png, raster_svg};
use vtex::scene::Scene;

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    input: &Input,
    options: &RenderOptions,
) -> anyhow::Result<()> {
    let RenderOptions { scale: parameters, svg, target, pattern } = options;
    let scale = parameters.scale;
    let drawn = target.kind.format == Format::Png;
    target.place.probe()?;
    if let Some(pattern) = pattern {
        pattern.place.probe()?;
    }
    if let Some(warning) = parameters.warning(drawn) {
        reporter.warn(warning);
    }
    reporter.stage("reading")?;
    let bytes = input.read()?;
    let name = input.name();
    let scene = match Kind::expect(&bytes, input, &[Kind::Library, Kind::Scene, Kind::Svg])? {
        Kind::Library => Some(stages::reconstruct(&Library::from_bytes(&bytes, &name)?)),
        Kind::Scene => Some(Scene::from_bytes(&bytes, &name)?),
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
    let (written, size) = match &scene {
        Some(scene) => (target.write_scene(scene, *svg, scale)?, parameters.size_of(scene, drawn)),
        None if drawn => {
            let picture = raster_svg::render_svg(&bytes, scale, &name, reporter)?;
            let (_, bytes) = target.place.write(|out| png::encode(&picture, None, out))?;
            (Written { bytes, ..Written::default() }, [picture.width(), picture.height()])
        }
        None => {
            let message = format!("'{name}' is an SVG already; it can be drawn as .png only");
            return Err(Failure::usage(message).hint("to write an SVG, give a library or a scene").into());
        }
    };
    if let (Some(pattern), Some(scene)) = (pattern, &scene) {
        pattern.write_pattern(scene, *svg)?;
    }
    let summary = Summary {
        pattern: pattern.as_ref().map(|p| p.place.path().display().to_string()),
        size,
        counts: scene.as_ref().map(Counts::of_scene),
        ..Summary::new("render", vec![name], target.place.path(), written, reporter)
    };
    summary.tell(common, target.place == Place::Stdout)
}
