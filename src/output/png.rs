//! Scene → pixels and PNG, drawn directly.
//!
//! The picture agrees with what a renderer makes of the SVG: the same grid of background colours,
//! the same paths in the same order. It is drawn in bands of fixed height, which are independent of
//! each other and of the number of threads.

use super::background::Background;
use super::picture_size;
use crate::error::{Error, Result};
use crate::geometry::{Affine, Outline, PathEl, Rect};
use crate::parallel;
use crate::raster::colour::Colour;
use crate::scene::{Instance, Scene};
use image::RgbImage;
use std::io::Write;
use std::path::Path;
use tiny_skia::{FillRule, Paint, PathBuilder, Pixmap, PixmapMut, Transform};

/// Height of the bands drawn at a time, in pixels.
const BAND: usize = 256;

/// Draws a scene, `scale` pixels of the picture to a pixel of the canvas; the size is rounded.
///
/// # Errors
/// A scale that is not above 0; [`Error::TooLarge`] beyond 2³⁰ pixels.
pub fn render(scene: &Scene, scale: f64) -> Result<Pixmap> {
    let (canvas_width, canvas_height) = (f64::from(scene.width), f64::from(scene.height));
    let (width, height) = picture_size(canvas_width, canvas_height, scale, "scene")?;
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| Error::TooLarge {
        name: "scene".into(),
        found: format!("a picture of {width} x {height} pixels"),
        limit: "what one picture in memory can hold".into(),
    })?;
    let scale = [f64::from(width) / canvas_width, f64::from(height) / canvas_height];
    let shapes = Shapes::new(scene, scale);
    let background = Background::new(scene);
    let row = width as usize * 4;
    parallel::for_chunks(pixmap.data_mut(), row * BAND, |i, data| {
        let (top, rows) = (i * BAND, data.len() / row);
        paint_background(&background, scale, top, width as usize, data);
        if let Some(mut band) = PixmapMut::from_bytes(data, width, rows as u32) {
            shapes.draw(&mut band, top as f64, rows as f64);
        }
    });
    Ok(pixmap)
}

/// Bilinear interpolation of the background's rows.
fn paint_background(background: &Background, scale: [f64; 2], top: usize, width: usize, data: &mut [u8]) {
    let xs: Vec<f64> = (0..width).map(|x| (x as f64 + 0.5) / scale[0]).collect();
    let mut current = None;
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (y, line) in data.chunks_exact_mut(width * 4).enumerate() {
        let v = ((top + y) as f64 + 0.5) / scale[1] / background.row_height;
        let k = (v as usize).min(background.rows.len() - 2);
        if current != Some(k) {
            above = background.row(k, &xs);
            below = background.row(k + 1, &xs);
            current = Some(k);
        }
        let t = (v - k as f64) as f32;
        for ((pixel, a), b) in line.chunks_exact_mut(4).zip(&above).zip(&below) {
            for c in 0..3 {
                pixel[c] = (a[c] + (b[c] - a[c]) * t + 0.5) as u8;
            }
            pixel[3] = 255;
        }
    }
}

/// The paths of a texton with their colours; those of the base come from the instance.
struct Shape {
    base: Option<tiny_skia::Path>,
    details: Vec<(tiny_skia::Path, Colour)>,
    bounds: Rect,
}

/// All that is drawn over the background.
struct Shapes<'a> {
    scene: &'a Scene,
    shapes: Vec<Shape>,
    /// Instances in painting order, each with its map to the picture.
    instances: Vec<(&'a Instance, Affine)>,
}

impl<'a> Shapes<'a> {
    fn new(scene: &'a Scene, scale: [f64; 2]) -> Self {
        let shapes = parallel::map(&scene.textons, |texton| Shape {
            base: path_of(&texton.outline),
            details: texton
                .details
                .iter()
                .filter_map(|p| path_of(&p.outline).map(|path| (path, p.colour)))
                .collect(),
            bounds: texton
                .details
                .iter()
                .fold(texton.outline.bounds(), |all, p| all.union(p.outline.bounds())),
        });
        let scale = Affine::scale_non_uniform(scale[0], scale[1]);
        let placed = scene.secondary.iter().chain(&scene.primary);
        let instances = placed.map(|instance| (instance, scale * instance.affine())).collect();
        Self { scene, shapes, instances }
    }

    /// Draws what touches a band of the picture.
    fn draw(&self, band: &mut PixmapMut<'_>, top: f64, rows: f64) {
        for (instance, affine) in &self.instances {
            let index = instance.texton as usize;
            let shape = &self.shapes[index];
            let bounds = affine.transform_rect_bbox(shape.bounds);
            // A pixel more on each side, for antialiasing.
            if bounds.y1 < top - 1.0 || bounds.y0 > top + rows + 1.0 {
                continue;
            }
            let [a, b, c, d, e, f] = affine.as_coeffs();
            let transform = [a, b, c, d, e, f - top].map(|v| v as f32);
            let colour = instance.colour.unwrap_or(self.scene.textons[index].colour);
            for (path, colour) in shape
                .base
                .iter()
                .map(|p| (p, colour))
                .chain(shape.details.iter().map(|(path, colour)| (path, *colour)))
            {
                fill(band, path, colour, transform);
            }
        }
    }
}

fn fill(band: &mut PixmapMut<'_>, path: &tiny_skia::Path, colour: Colour, transform: [f32; 6]) {
    let [r, g, b] = colour.0;
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    let [a, bb, c, d, e, f] = transform;
    band.fill_path(path, &paint, FillRule::Winding, Transform::from_row(a, bb, c, d, e, f), None);
}

/// The path as tiny-skia knows it; none if there is nothing to fill.
pub(super) fn path_of(outline: &Outline) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for element in outline.path().elements() {
        match *element {
            PathEl::MoveTo(p) => builder.move_to(p.x as f32, p.y as f32),
            PathEl::LineTo(p) => builder.line_to(p.x as f32, p.y as f32),
            PathEl::QuadTo(a, p) => builder.quad_to(a.x as f32, a.y as f32, p.x as f32, p.y as f32),
            PathEl::CurveTo(a, b, p) => {
                builder.cubic_to(a.x as f32, a.y as f32, b.x as f32, b.y as f32, p.x as f32, p.y as f32);
            }
            PathEl::ClosePath => builder.close(),
        }
    }
    builder.finish()
}

/// Writes a picture as PNG, 8-bit sRGB, with alpha only where something shows through. The text
/// chunks name the program and, where there is one, the seed.
///
/// # Errors
/// A failing writer, as [`Error::Write`] with the path `-`.
pub fn encode(pixmap: &Pixmap, seed: Option<u64>, out: impl Write) -> Result<()> {
    let opaque = pixmap.pixels().iter().all(|p| p.alpha() == 255);
    let channels = if opaque { 3 } else { 4 };
    let mut data = Vec::with_capacity(pixmap.pixels().len() * channels);
    for pixel in pixmap.pixels() {
        let c = pixel.demultiply();
        data.extend_from_slice(&[c.red(), c.green(), c.blue(), c.alpha()][..channels]);
    }
    encode_data(pixmap.width(), pixmap.height(), opaque, &data, seed, out).map_err(failed)
}

/// As [`encode`], of plain RGB.
///
/// # Errors
/// As [`encode`].
pub fn encode_rgb(image: &RgbImage, out: impl Write) -> Result<()> {
    encode_data(image.width(), image.height(), true, image.as_raw(), None, out).map_err(failed)
}

fn failed(e: png::EncodingError) -> Error {
    let source = match e {
        png::EncodingError::IoError(e) => e,
        other => std::io::Error::other(other.to_string()),
    };
    Error::write(Path::new("-"), source)
}

fn encode_data(
    width: u32,
    height: u32,
    opaque: bool,
    data: &[u8],
    seed: Option<u64>,
    out: impl Write,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk("Software".into(), crate::PROGRAM.into())?;
    if let Some(seed) = seed {
        encoder.add_text_chunk("Seed".into(), seed.to_string())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()
}
