//! Scene → PDF: one page of pure vectors, of the size of the scene's page; where it has none, 96 pixels to the inch as in
//! SVG.
//!
//! Everything is a path with a flat colour or a gradient, and the background is mixed by masks of gradients;
//! nothing is a bitmap. Each layer is a form XObject in a group of optional content, so viewers list it by
//! name. A texton is a form XObject if it is drawn more than once and its paths are longer than a reference,
//! or if it has a gradient; other textons are written where they stand.
//!
//! Gradients are drawn in forms of their own because Inkscape 1.2 places a gradient wrongly where the
//! same content stream has changed the coordinates before. So the page changes its coordinates once,
//! outside of all that is saved and restored.
//!
//! Works badly beyond [`LARGEST_PAGE`]: the page then has user units of several points, which some viewers, such as
//! those based on Poppler, take for points, so that they show it smaller.

mod background;
mod content;
mod file;
mod paint;
#[cfg(test)]
pub(crate) mod tests;
mod textons;

use super::background::PreparedBackground;
use content::{ContentStream, rounded};
use file::File;
use pdf_writer::{Finish, Name, Ref, TextStr};
use std::io::{self, Write};
use textons::PdfTextons;
use vtex_base::geometry::{Affine, Outline, Rect, Vec2};
use vtex_scene::scene::{CSS_DPI, Layer, Length, Scene};

/// Points to the inch.
const POINTS: f64 = 72.0;
/// Largest side of a page that readers are known to show, in points.
const LARGEST_PAGE: f64 = 14_400.0;

/// Writes a scene as PDF. Same scene: the same bytes. Gives their number.
///
/// # Errors
/// A scene that breaks its invariants; a failing writer.
pub fn write(scene: &Scene, mut out: impl Write) -> io::Result<u64> {
    scene.check()?;
    let bytes = document(scene);
    out.write_all(&bytes)?;
    out.flush()?;
    Ok(bytes.len() as u64)
}

/// The whole file.
fn document(scene: &Scene) -> Vec<u8> {
    let mut file = File::new();
    let mut page = ContentStream::new();
    let points = match scene.page {
        Some(page) => page.map(Length::points),
        None => scene.css_size().map(|side| side * POINTS / f64::from(CSS_DPI)),
    };
    // Points to the unit: more than one for a page that would have too many units.
    let unit = libm::ceil(points[0].max(points[1]) / LARGEST_PAGE).max(1.0);
    let size = points.map(|side| side / unit);
    let [x, y] = [size[0] / f64::from(scene.width), size[1] / f64::from(scene.height)];
    // Not within `q` and `Q`, because there Inkscape 1.2 ignores it for gradients in forms.
    page.transform(Affine::new([x, 0.0, 0.0, -y, 0.0, size[1]]));
    let groups = draw(scene, &mut page, &mut file);

    let content = page.page(&mut file);
    let [catalog, pages, leaf, information] = std::array::from_fn(|_| file.reserve());
    let mut out = file.pdf.catalog(catalog);
    out.pages(pages);
    let mut layers = out.insert(Name(b"OCProperties")).dict();
    layers.insert(Name(b"OCGs")).array().items(groups.iter().copied());
    // Viewers list the topmost layer first.
    layers.insert(Name(b"D")).dict().insert(Name(b"Order")).array().items(groups.iter().rev().copied());
    layers.finish();
    out.finish();
    file.pdf.pages(pages).kids([leaf]).count(1);
    let [width, height] = rounded(size, 4);
    let mut out = file.pdf.page(leaf);
    out.parent(pages).media_box(pdf_writer::Rect::new(0.0, 0.0, width, height));
    if unit > 1.0 {
        out.user_unit(unit as f32);
    }
    out.contents(content);
    let mut resources = out.resources();
    let mut properties = resources.insert(Name(b"Properties")).dict();
    for (k, group) in groups.iter().enumerate() {
        properties.pair(Name(format!("l{k}").as_bytes()), *group);
    }
    properties.finish();
    page.resources(resources);
    out.finish();
    let mut out = file.pdf.document_info(information);
    out.title(TextStr(&super::title(scene)));
    out.creator(TextStr("vtex")).producer(TextStr(vtex_base::PROGRAM));
    if let Some(parameters) = &scene.parameters {
        out.subject(TextStr(&format!("Seed {}", parameters.seed)));
    }
    out.finish();
    file.finish()
}

/// Draws the layers; those that a domain clips are drawn inside its outline. Returns the group of each drawn
/// layer.
fn draw(scene: &Scene, page: &mut ContentStream, file: &mut File) -> Vec<Ref> {
    let mut textons = PdfTextons::new(scene);
    // Through an empty domain nothing is visible; elements that extend beyond a domain lie outside of it.
    let domain = scene.domain.as_ref().map(|d| &d.outline).filter(|outline| !is_empty(outline));
    let mut groups = Vec::new();
    for run in scene.layers.chunk_by(|a, b| scene.is_clipped(a) == scene.is_clipped(b)) {
        let clipped = scene.is_clipped(&run[0]);
        if clipped && domain.is_none() {
            continue;
        }
        page.within(|page| {
            if let Some(outline) = domain.filter(|_| clipped) {
                clip(scene, outline, page);
            }
            for layer in run {
                let form = form_of(scene, layer, &mut textons, file);
                page.draw_optional(form, groups.len());
                // Layers of one name are groups of their own.
                let group = file.reserve();
                let mut out = file.pdf.indirect(group).dict();
                out.pair(Name(b"Type"), Name(b"OCG"));
                out.pair(Name(b"Name"), TextStr(&super::label(&layer.name)));
                groups.push(group);
            }
        });
    }
    groups
}

/// A layer as a form.
fn form_of(scene: &Scene, layer: &Layer, textons: &mut PdfTextons<'_>, file: &mut File) -> Ref {
    let mut content = ContentStream::new();
    // An empty region shows nothing.
    if layer.region.as_ref().is_none_or(|outline| !is_empty(outline)) {
        if let Some(outline) = &layer.region {
            clip(scene, outline, &mut content);
        }
        if let Some(field) = &layer.field {
            background::draw(&PreparedBackground::new(scene, field), &mut content, file);
        }
        textons.draw(&layer.instances, &mut content, file);
    }
    content.form(file, Rect::new(0.0, 0.0, f64::from(scene.width), f64::from(scene.height)))
}

/// Clips later painting to an outline on the canvas of a scene, with its copies.
fn clip(scene: &Scene, outline: &Outline, content: &mut ContentStream) {
    let shifts: Vec<Vec2> = scene.copies(outline.bounds()).collect();
    content.clip(outline, &shifts);
}

/// Whether an outline encloses no area; some viewers draw a hairline for its fill.
fn is_empty(outline: &Outline) -> bool {
    let bounds = outline.bounds();
    outline.is_empty() || bounds.width() <= 0.0 || bounds.height() <= 0.0
}

/// Whether `bounds` reach the canvas of a scene.
fn is_seen(scene: &Scene, bounds: Rect, shift: Vec2) -> bool {
    let bounds = bounds + shift;
    bounds.x1 > 0.0
        && bounds.y1 > 0.0
        && bounds.x0 < f64::from(scene.width)
        && bounds.y0 < f64::from(scene.height)
}
