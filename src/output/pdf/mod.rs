//! Scene → PDF: one page of pure vectors, 96 pixels to the inch as in SVG.
//!
//! Everything is a path with a flat colour or a gradient, and the background is mixed by masks of
//! gradients; nothing is a bitmap. Each layer is a form XObject in a group of optional content, so
//! viewers list it by name. A texton is a form XObject if it stands more than once and its paths are
//! longer than that, or if it has a gradient; other textons are written where they stand.
//!
//! Gradients are drawn in forms of their own because Inkscape 1.2 places a gradient wrongly where the
//! same content stream has changed the coordinates before (see also `layers.rs`).
//!
//! Works badly beyond [`LARGEST_PAGE`]: viewers then need a page that is scaled down, and its
//! numbers are rounded to more than a hundredth of a pixel.

mod background;
mod layers;
#[cfg(test)]
mod tests;
mod textons;

use super::background::Background;
use crate::element::{self, GradientKind};
use crate::error::{Error, Result};
use crate::geometry::{Outline, PathEl, Point, Rect, Vec2};
use crate::raster::colour::Colour;
use crate::scene::{Gradient, Layer, Scene};
use krilla::geom::{Path as PdfPath, PathBuilder, Transform};
use krilla::graphic::Graphic;
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule, LinearGradient, Paint, RadialGradient, SpreadMethod, Stop};
use krilla::surface::Surface;
use krilla::{Document, SerializeSettings};
use std::io::{self, Write};
use std::path::Path;
use textons::Textons;

/// Points to a pixel: an inch is 72 points, or 96 pixels.
const POINTS: f64 = 0.75;
/// Largest side of a page that readers are known to show, in points.
const LARGEST_PAGE: f64 = 14_400.0;

/// Writes a scene as PDF. Same scene: the same bytes. Gives their number.
///
/// # Errors
/// A scene that breaks its invariants; a failing writer, as [`Error::Write`] with the path `-`.
pub fn write(scene: &Scene, mut out: impl Write) -> Result<u64> {
    scene.check()?;
    let bytes = document(scene).map_err(|e| Error::write(Path::new("-"), io::Error::other(e)))?;
    out.write_all(&bytes).and_then(|()| out.flush()).map_err(|e| Error::write(Path::new("-"), e))?;
    Ok(bytes.len() as u64)
}

/// The whole file.
fn document(scene: &Scene) -> std::result::Result<Vec<u8>, String> {
    let (width, height) = (f64::from(scene.width), f64::from(scene.height));
    let scale = (LARGEST_PAGE / width.max(height)).min(POINTS);
    let mut document = Document::new_with(SerializeSettings { enable_tagging: false, ..Default::default() });
    let settings = PageSettings::from_wh((width * scale) as f32, (height * scale) as f32);
    let mut page = document.start_page_with(settings.ok_or("the page is empty")?);
    let mut surface = page.surface();
    surface.push_transform(&Transform::from_scale(scale as f32, scale as f32));
    let drawn = draw(scene, &mut surface);
    surface.pop();
    surface.finish();
    page.finish();
    let mut metadata =
        Metadata::new().title(super::title(scene)).creator("vtex".into()).producer(crate::PROGRAM.into());
    if let Some(parameters) = &scene.parameters {
        metadata = metadata.description(format!("Seed {}", parameters.seed));
    }
    document.set_metadata(metadata);
    let file = document.finish().map_err(|e| format!("{e:?}"))?;
    layers::named(&file, &drawn).ok_or_else(|| "the layers of the page are not found".into())
}

/// The layers, those that a domain clips inside its outline. Gives the names of those drawn.
fn draw(scene: &Scene, surface: &mut Surface<'_>) -> Vec<String> {
    let mut textons = Textons::new(scene);
    let layers: Vec<(&Layer, Graphic)> = scene
        .layers
        .iter()
        .map(|own| {
            let graphic = layer(surface, |s| {
                let clip = own.region.as_ref().map(|outline| clip_path(scene, outline));
                // A region without any room shows nothing.
                let Some(clip) = clip.map_or(Some(None), |path| path.map(Some)) else { return };
                if let Some(clip) = &clip {
                    s.push_clip_path(clip, &FillRule::NonZero);
                }
                if let Some(field) = &own.field {
                    background::draw(&Background::new(scene, field), s);
                }
                textons.draw(&own.instances, s);
                if clip.is_some() {
                    s.pop();
                }
            });
            (own, graphic)
        })
        .collect();
    // A domain without any room shows nothing; elements that stick out lie outside of it.
    let domain = scene.domain.as_ref().and_then(|d| clip_path(scene, &d.outline));
    let mut names = Vec::new();
    for run in layers.chunk_by(|a, b| scene.is_clipped(a.0) == scene.is_clipped(b.0)) {
        let clipped = scene.is_clipped(run[0].0);
        match &domain {
            Some(clip) if clipped => surface.push_clip_path(clip, &FillRule::NonZero),
            None if clipped => continue,
            _ => {}
        }
        for (layer, graphic) in run {
            surface.draw_graphic(graphic.clone());
            names.push(super::label(&layer.name));
        }
        if clipped {
            surface.pop();
        }
    }
    names
}

/// An outline on the canvas of a scene, with its copies; `None` if nothing can be seen of it.
fn clip_path(scene: &Scene, outline: &Outline) -> Option<PdfPath> {
    let mut clip = PathBuilder::new();
    for shift in scene.copies(outline.bounds()) {
        append(&mut clip, outline, shift);
    }
    clip.finish()
}

/// The drawing of `content` as a graphic of its own.
fn layer(surface: &mut Surface<'_>, content: impl FnOnce(&mut Surface<'_>)) -> Graphic {
    let mut builder = surface.stream_builder();
    let mut inner = builder.surface();
    content(&mut inner);
    inner.finish();
    Graphic::new(builder.finish(), false)
}

/// Fills a path.
fn fill(surface: &mut Surface<'_>, path: &PdfPath, paint: Paint) {
    surface.set_fill(Some(Fill { paint, ..Fill::default() }));
    surface.draw_path(path);
}

/// One colour everywhere.
fn flat(colour: Colour) -> Paint {
    rgb(colour).into()
}

/// A gradient in the coordinates of what it fills.
fn gradual(gradient: &Gradient) -> Paint {
    let share = |v: f64| NormalizedF32::new(v as f32).unwrap_or(NormalizedF32::ONE);
    let stop = |s: element::Stop| Stop {
        offset: share(s.offset),
        color: rgb(s.colour).into(),
        opacity: share(s.opacity),
    };
    let [[x1, y1], [x2, y2]] = [gradient.from, gradient.to].map(|p| p.map(|v| v as f32));
    let stops = gradient.stops().map(stop).collect();
    let (transform, spread_method) = (Transform::identity(), SpreadMethod::Pad);
    match gradient.kind {
        GradientKind::Linear => {
            LinearGradient { x1, y1, x2, y2, transform, spread_method, stops, anti_alias: false }.into()
        }
        GradientKind::Radial => RadialGradient {
            fx: x1,
            fy: y1,
            fr: 0.0,
            cx: x1,
            cy: y1,
            cr: libm::hypotf(x2 - x1, y2 - y1),
            transform,
            spread_method,
            stops,
            anti_alias: false,
        }
        .into(),
    }
}

fn rgb(Colour([r, g, b]): Colour) -> krilla::color::rgb::Color {
    krilla::color::rgb::Color::new(r, g, b)
}

/// The path as PDF knows it; none if there is nothing to fill.
fn path_of(outline: &Outline) -> Option<PdfPath> {
    let mut builder = PathBuilder::new();
    append(&mut builder, outline, Vec2::ZERO);
    builder.finish()
}

/// Adds an outline, moved by `shift`, to a path.
fn append(builder: &mut PathBuilder, outline: &Outline, shift: Vec2) {
    let at = |p: Point| ((p.x + shift.x) as f32, (p.y + shift.y) as f32);
    for element in outline.path().elements() {
        match *element {
            PathEl::MoveTo(p) => {
                let p = at(p);
                builder.move_to(p.0, p.1);
            }
            PathEl::LineTo(p) => {
                let p = at(p);
                builder.line_to(p.0, p.1);
            }
            PathEl::QuadTo(a, p) => {
                let (a, p) = (at(a), at(p));
                builder.quad_to(a.0, a.1, p.0, p.1);
            }
            PathEl::CurveTo(a, b, p) => {
                let (a, b, p) = (at(a), at(b), at(p));
                builder.cubic_to(a.0, a.1, b.0, b.1, p.0, p.1);
            }
            PathEl::ClosePath => builder.close(),
        }
    }
}

/// Whether anything within `bounds` can be seen on the canvas of a scene.
fn is_seen(scene: &Scene, bounds: Rect, shift: Vec2) -> bool {
    let bounds = bounds + shift;
    bounds.x1 > 0.0
        && bounds.y1 > 0.0
        && bounds.x0 < f64::from(scene.width)
        && bounds.y0 < f64::from(scene.height)
}
