//! Scene → pixels and PNG, drawn directly.
//!
//! Outside a domain the picture is transparent. It agrees with a rendered SVG of the scene: the grid of
//! background colours, the paths and their order are the same. The picture is drawn in parallel, in bands of
//! fixed height that do not depend on each other.

use super::background::PreparedBackground;
use super::paths::{ClipRegion, band_transform, path_of};
use super::picture_size;
use super::shadow::{self, Shadows};
use image::RgbImage;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use tiny_skia::{
    Color, FillRule, GradientStop, LineJoin, LinearGradient, Mask, Paint, PathBuilder, Pixmap, PixmapMut,
    PixmapPaint, RadialGradient, Shader, SpreadMode, Transform,
};
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::{Affine, Rect, Vec2};
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Ellipse, GradientKind, SoftRim, Stop};
use vtex_scene::scene::{Gradient, Instance, Layer, Length, LengthUnit, Scene, Shape};

/// Height of the bands drawn at a time, in pixels.
const BAND: usize = 256;

/// Draws a scene, `scale` pixels of the picture to a pixel of the canvas; the size is rounded.
///
/// # Errors
/// A scale that is not above 0; a scene that breaks its invariants; [`Error::TooLarge`] beyond 2³⁰
/// pixels.
pub fn render(scene: &Scene, scale: f64) -> Result<Pixmap> {
    let canvas = [scene.width, scene.height].map(f64::from);
    drawn(scene, picture_size(canvas[0], canvas[1], scale, "scene")?, &())
}

/// Draws a scene at the size of [`Scene::picture_size`], `scale` times as large: as [`render`], but a page in pixels
/// counts instead of the canvas. Reports the bands drawn, as stage `drawing`, and can be stopped after each.
///
/// # Errors
/// Those of [`render`]; [`Error::Interrupted`].
pub fn render_page(scene: &Scene, scale: f64, progress: &dyn Progress) -> Result<Pixmap> {
    let [width, height] = scene.picture_size(1.0).map(f64::from);
    drawn(scene, picture_size(width, height, scale, "scene")?, progress)
}

/// Draws a scene as a picture of a width and a height.
fn drawn(scene: &Scene, (width, height): (u32, u32), progress: &dyn Progress) -> Result<Pixmap> {
    scene.check()?;
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| Error::TooLarge {
        what: Large::Drawn,
        name: "scene".into(),
        found: format!("a picture of {width} x {height} pixels"),
        limit: "what one picture in memory can hold".into(),
    })?;
    let scale = [f64::from(width) / f64::from(scene.width), f64::from(height) / f64::from(scene.height)];
    let picture = PreparedScene::new(scene, scale);
    let row = width as usize * 4;
    let (bands, done) = (u64::from(height).div_ceil(BAND as u64), AtomicU64::new(0));
    parallel::for_chunks(pixmap.data_mut(), row * BAND, |i, data| {
        if !progress.advance("drawing", done.load(Ordering::Relaxed), bands) {
            return;
        }
        done.fetch_add(1, Ordering::Relaxed);
        let rows = data.len() / row;
        if let Some(mut band) = PixmapMut::from_bytes(data, width, rows as u32) {
            picture.draw(&mut band, i * BAND);
        }
    });
    advance(progress, "drawing", done.into_inner(), bands)?;
    Ok(pixmap)
}

/// A picture over white.
pub fn over_white(pixmap: &Pixmap) -> RgbImage {
    // Components are multiplied by the opacity already.
    RgbImage::from_fn(pixmap.width(), pixmap.height(), |x, y| {
        let pixel = pixmap.pixel(x, y).expect("within the picture");
        let white = 255 - pixel.alpha();
        image::Rgb([pixel.red(), pixel.green(), pixel.blue()].map(|v| v.saturating_add(white)))
    })
}

/// Paints a band of the background, which begins at row `top`, by bilinear interpolation.
fn paint_background(background: &PreparedBackground, scale: [f64; 2], top: usize, band: &mut PixmapMut<'_>) {
    let (width, data) = (band.width() as usize, band.data_mut());
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

/// The paths of an element. Details have their paint; that of the base may depend on the instance.
struct ElementPaths {
    base: Option<tiny_skia::Path>,
    details: Vec<Detail>,
    /// The strokes of its soft rim.
    rim: Vec<(tiny_skia::Stroke, Paint<'static>)>,
    /// The outline of the whole element, if it differs from that of the base.
    silhouette: Option<tiny_skia::Path>,
    bounds: Rect,
}

/// A shape that is painted on the base.
struct Detail {
    path: tiny_skia::Path,
    paint: Paint<'static>,
    /// For a soft ellipse, the map from the unit disc to it; `path` and `paint` are those of the disc.
    soft: Option<Affine>,
}

impl Detail {
    fn new(shape: &Shape) -> Option<Self> {
        let Some(ellipse) = &shape.ellipse else {
            let (path, paint) =
                (path_of(&shape.outline)?, paint(shape, shape.colour, shape.gradient.as_deref()));
            return Some(Self { path, paint, soft: None });
        };
        Self::soft(shape, ellipse, shape.colour)
    }

    /// A soft ellipse in one colour.
    fn soft(shape: &Shape, ellipse: &Ellipse, colour: Colour) -> Option<Self> {
        let path = PathBuilder::from_circle(0.0, 0.0, 1.0)?;
        let paint = paint(shape, colour, Some(&ellipse.profile.brush(colour)));
        Some(Self { path, paint, soft: Some(ellipse.map()) })
    }
}

/// A scene made ready to be drawn.
struct PreparedScene<'a> {
    scene: &'a Scene,
    scale: [f64; 2],
    drawings: Vec<ElementPaths>,
    layers: Vec<DrawnLayer<'a>>,
    domain: ClipRegion,
    shadows: BTreeMap<shadow::Key, Vec<(tiny_skia::Path, Paint<'static>)>>,
}

struct DrawnLayer<'a> {
    background: Option<PreparedBackground>,
    region: Option<ClipRegion>,
    /// Whether the domain clips it.
    clipped: bool,
    /// Instances and copies in painting order.
    instances: Vec<DrawnInstance<'a>>,
}

/// An instance or a copy of it.
struct DrawnInstance<'a> {
    instance: &'a Instance,
    height: i64,
    /// The map to the picture.
    affine: Affine,
    /// The map of its shadow to the picture.
    shadow: Affine,
    /// First and last row of the picture that it may touch.
    rows: [f64; 2],
}

impl<'a> PreparedScene<'a> {
    fn new(scene: &'a Scene, scale: [f64; 2]) -> Self {
        let drawings = parallel::map(&scene.elements, |element| ElementPaths {
            base: path_of(&element.base().outline),
            details: element.details().iter().filter_map(Detail::new).collect(),
            rim: element.base().rim.iter().flat_map(|rim| rim_strokes(rim)).collect(),
            silhouette: element.silhouette.as_ref().and_then(path_of),
            bounds: element.bounds(),
        });
        let to_picture = Affine::scale_non_uniform(scale[0], scale[1]);
        let copies_of = |instance: &'a Instance| {
            let affine = instance.affine();
            let bounds = instance.reach(drawings[instance.element.index()].bounds);
            scene.copies(bounds).map(move |shift| {
                let height = scene.height(instance, shift);
                let reach = to_picture.transform_rect_bbox(bounds + shift);
                let shadow_shift = shift + instance.shadow.map_or(Vec2::ZERO, |s| s.shift());
                DrawnInstance {
                    instance,
                    height,
                    affine: to_picture * affine.then_translate(shift),
                    shadow: to_picture * affine.then_translate(shadow_shift),
                    rows: [reach.y0, reach.y1],
                }
            })
        };
        let in_order = |layer: &'a Layer| {
            let mut instances: Vec<DrawnInstance<'_>> = layer.instances.iter().flat_map(&copies_of).collect();
            if scene.is_stacked() {
                instances.sort_by_key(|drawn| drawn.height);
            }
            instances
        };
        let layers = scene.layers.iter().map(|layer| DrawnLayer {
            background: layer.field.as_ref().map(|field| PreparedBackground::new(scene, field)),
            region: layer.region.as_ref().map(|outline| ClipRegion::new(scene, outline, scale)),
            clipped: scene.is_clipped(layer),
            instances: in_order(layer),
        });
        let layers = layers.collect();
        let painted = |l: &shadow::ShadowOutline| {
            let mut paint = Paint::default();
            paint.set_color(Color::from_rgba(0.0, 0.0, 0.0, l.opacity as f32).unwrap_or(Color::TRANSPARENT));
            path_of(&l.outline).map(|path| (path, paint))
        };
        let shadows = Shadows::new(scene);
        let shadows = shadows.all().map(|(key, layers)| (key, layers.iter().filter_map(painted).collect()));
        let (shadows, domain) = (shadows.collect(), ClipRegion::of_domain(scene, scale));
        Self { scene, scale, drawings, layers, domain, shadows }
    }

    /// Draws a band of the picture, which begins at row `top` and is transparent at first.
    fn draw(&self, band: &mut PixmapMut<'_>, top: usize) {
        for (k, run) in self.layers.chunk_by(|a, b| a.clipped == b.clipped).enumerate() {
            let clip = run[0].clipped.then_some(&self.domain);
            if k == 0 {
                // No unclipped layer lies underneath, so the band itself is clipped.
                run.iter().for_each(|layer| self.draw_layer(layer, band, top));
                clip.inspect(|domain| domain.clip(band, top as f64));
            } else {
                draw_clipped(band, clip, top, |band| {
                    run.iter().for_each(|layer| self.draw_layer(layer, band, top));
                });
            }
        }
    }

    fn draw_layer(&self, layer: &DrawnLayer<'_>, band: &mut PixmapMut<'_>, top: usize) {
        draw_clipped(band, layer.region.as_ref(), top, |band| {
            if let Some(background) = &layer.background {
                paint_background(background, self.scale, top, band);
            }
            let (top, rows) = (top as f64, f64::from(band.height()));
            for placed in &layer.instances {
                // A pixel more on each side, for antialiasing.
                if placed.rows[1] >= top - 1.0 && placed.rows[0] <= top + rows + 1.0 {
                    self.draw_instance(placed, band, top);
                }
            }
        });
    }

    fn draw_instance(&self, placed: &DrawnInstance<'_>, band: &mut PixmapMut<'_>, top: f64) {
        let instance = placed.instance;
        let drawing = &self.drawings[instance.element.index()];
        if let Some(layers) = instance.shadow.and_then(|s| self.shadows.get(&shadow::key(instance, &s))) {
            for (path, paint) in layers {
                band.fill_path(path, paint, FillRule::Winding, band_transform(placed.shadow, top), None);
            }
        }
        let transform = band_transform(placed.affine, top);
        let element = self.scene.element(instance);
        if let Some((ellipse, colour)) = element.spot(instance.colour) {
            if let Some(spot) = Detail::soft(element.base(), ellipse, colour) {
                let transform = band_transform(placed.affine * ellipse.map(), top);
                band.fill_path(&spot.path, &spot.paint, FillRule::Winding, transform, None);
            }
        } else if let Some(path) = &drawing.base {
            let (colour, gradient) = element.paint(instance.colour);
            band.fill_path(
                path,
                &paint(element.base(), colour, gradient),
                FillRule::Winding,
                transform,
                None,
            );
        }
        for run in drawing.details.chunk_by(|a, b| a.soft.is_some() == b.soft.is_some()) {
            if run[0].soft.is_some() {
                draw_soft(run, drawing, placed.affine, band, top);
                continue;
            }
            for detail in run {
                band.fill_path(&detail.path, &detail.paint, FillRule::Winding, transform, None);
            }
        }
        if let Some(path) = &drawing.base {
            for (line, paint) in &drawing.rim {
                band.stroke_path(path, paint, line, transform, None);
            }
        }
        let outline = drawing.silhouette.as_ref().or(drawing.base.as_ref());
        if let (Some(path), Some(stroke)) = (outline, instance.stroke) {
            band.stroke_path(path, &opaque(stroke.colour), &round_line(stroke.width), transform, None);
        }
    }
}

/// Draws successive soft ellipses, clipped to the base of their element; `None` if nothing is visible.
fn draw_soft(
    ellipses: &[Detail],
    drawing: &ElementPaths,
    to_picture: Affine,
    band: &mut PixmapMut<'_>,
    top: f64,
) -> Option<()> {
    let base = drawing.base.as_ref()?;
    let reach = to_picture.transform_rect_bbox(drawing.bounds) - Vec2::new(0.0, top);
    let visible = reach.inflate(1.0, 1.0).expand();
    let visible = visible.intersect(Rect::new(0.0, 0.0, band.width().into(), band.height().into()));
    let (x, y) = (visible.x0, visible.y0);
    let mut own = Pixmap::new(visible.width() as u32, visible.height() as u32)?;
    let to_own = |map: Affine| band_transform(map.then_translate(Vec2::new(-x, 0.0)), top + y);
    for detail in ellipses {
        let transform = to_own(to_picture * detail.soft?);
        own.fill_path(&detail.path, &detail.paint, FillRule::Winding, transform, None);
    }
    let mut mask = Mask::new(own.width(), own.height())?;
    mask.fill_path(base, FillRule::Winding, true, to_own(to_picture));
    own.apply_mask(&mask);
    band.draw_pixmap(x as i32, y as i32, own.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    Some(())
}

/// Draws on a picture of its own, clips that to a region and paints it on a band; without a region, draws on the
/// band itself.
fn draw_clipped(
    band: &mut PixmapMut<'_>,
    region: Option<&ClipRegion>,
    top: usize,
    draw: impl FnOnce(&mut PixmapMut<'_>),
) {
    let Some(region) = region else { return draw(band) };
    let Some(mut own) = Pixmap::new(band.width(), band.height()) else { return };
    draw(&mut own.as_mut());
    region.clip(&mut own.as_mut(), top as f64);
    band.draw_pixmap(0, 0, own.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
}

/// A line with round joins.
fn round_line(width: f64) -> tiny_skia::Stroke {
    tiny_skia::Stroke { width: width as f32, line_join: LineJoin::Round, ..tiny_skia::Stroke::default() }
}

/// The strokes of a soft rim and their paint.
fn rim_strokes(rim: &SoftRim) -> impl Iterator<Item = (tiny_skia::Stroke, Paint<'static>)> {
    let Colour([r, g, b]) = rim.colour;
    rim.strokes().into_iter().map(move |[width, opacity]| {
        let colour = Color::from_rgba8(r, g, b, libm::round(255.0 * opacity) as u8);
        (round_line(width), Paint { shader: Shader::SolidColor(colour), ..Paint::default() })
    })
}

fn opaque(colour: Colour) -> Paint<'static> {
    let Colour([r, g, b]) = colour;
    Paint { shader: Shader::SolidColor(Color::from_rgba8(r, g, b, 255)), ..Paint::default() }
}

/// The paint of a shape: its gradient or its colour, with its opacity.
fn paint(shape: &Shape, colour: Colour, gradient: Option<&Gradient>) -> Paint<'static> {
    let solid = |Colour([r, g, b]): Colour, opacity: f64| {
        Color::from_rgba8(r, g, b, libm::round(255.0 * shape.opacity * opacity) as u8)
    };
    let shader = gradient.and_then(|g| {
        let point = |[x, y]: [f64; 2]| tiny_skia::Point::from_xy(x as f32, y as f32);
        let stop = |s: Stop| GradientStop::new(s.offset as f32, solid(s.colour, s.opacity));
        let stops = g.stops().map(stop).collect();
        let (pad, identity) = (SpreadMode::Pad, Transform::identity());
        let [from, to] = [g.from, g.to].map(point);
        match g.kind {
            GradientKind::Linear => LinearGradient::new(from, to, stops, pad, identity),
            GradientKind::Radial => {
                RadialGradient::new(from, 0.0, from, from.distance(to), stops, pad, identity)
            }
        }
    });
    Paint { shader: shader.unwrap_or(Shader::SolidColor(solid(colour, 1.0))), ..Paint::default() }
}

/// Writes a picture as PNG, 8-bit sRGB, with alpha only if the picture is not opaque. The text chunks name
/// the program and, where there is one, the seed. With a page that is not in pixels, the file has the density at which
/// the picture fills it, in whole pixels per metre.
///
/// # Errors
/// A failing writer.
pub fn encode(
    pixmap: &Pixmap,
    seed: Option<u64>,
    page: Option<[Length; 2]>,
    out: impl Write,
) -> io::Result<()> {
    let opaque = pixmap.pixels().iter().all(|p| p.alpha() == 255);
    let channels = if opaque { 3 } else { 4 };
    let data = straight(pixmap, channels);
    let (width, height) = (pixmap.width(), pixmap.height());
    let page = page.filter(|page| page.iter().any(|side| side.unit() != LengthUnit::Pixel));
    let density = page.map(|[x, y]| {
        let per_metre = |pixels: u32, side: Length| libm::round(f64::from(pixels) / side.inches() / 0.0254);
        let [xppu, yppu] = [per_metre(width, x), per_metre(height, y)].map(|v| (v as u32).max(1));
        png::PixelDimensions { xppu, yppu, unit: png::Unit::Meter }
    });
    encode_data((width, height), opaque, &data, (seed, density), out).map_err(failed)
}

/// The components of all pixels, 8-bit sRGB, not multiplied by alpha; `channels` is 3, or 4 to include alpha.
pub fn straight(pixmap: &Pixmap, channels: usize) -> Vec<u8> {
    let mut data = Vec::with_capacity(pixmap.pixels().len() * channels);
    for pixel in pixmap.pixels() {
        let c = pixel.demultiply();
        data.extend_from_slice(&[c.red(), c.green(), c.blue(), c.alpha()][..channels]);
    }
    data
}

/// Writes an opaque picture as PNG, 8-bit sRGB.
///
/// # Errors
/// As [`encode`].
pub fn encode_rgb(image: &RgbImage, out: impl Write) -> io::Result<()> {
    encode_data(image.dimensions(), true, image.as_raw(), (None, None), out).map_err(failed)
}

pub(super) fn failed(e: png::EncodingError) -> io::Error {
    match e {
        png::EncodingError::IoError(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

fn encode_data(
    (width, height): (u32, u32),
    opaque: bool,
    data: &[u8],
    (seed, density): (Option<u64>, Option<png::PixelDimensions>),
    out: impl Write,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_pixel_dims(density);
    encoder.add_text_chunk("Software".into(), vtex_base::PROGRAM.into())?;
    if let Some(seed) = seed {
        encoder.add_text_chunk("Seed".into(), seed.to_string())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster_svg::render_svg;
    use crate::svg::{self, SvgOptions};
    use crate::testing;

    /// Mean and largest difference of two pictures, in 8-bit steps.
    fn difference(a: &Pixmap, b: &Pixmap) -> (f64, u8) {
        assert_eq!((a.width(), a.height()), (b.width(), b.height()));
        let pairs = || a.data().iter().zip(b.data());
        let sum: u64 = pairs().map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let most = pairs().map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
        (sum as f64 / a.data().len() as f64, most)
    }

    fn by_svg(scene: &Scene, options: SvgOptions, scale: f64) -> Pixmap {
        let mut bytes = Vec::new();
        svg::write(scene, &options, &mut bytes).unwrap();
        render_svg(&bytes, scale, "test", &()).unwrap()
    }

    #[test]
    fn agrees_with_resvg_at_any_scale() {
        let scene = testing::scene(560, 320, 1);
        for scale in [0.5, 1.0, 2.3] {
            let direct = render(&scene, scale).unwrap();
            for expand in [false, true] {
                let options = SvgOptions { expand, ..SvgOptions::default() };
                let (mean, most) = difference(&direct, &by_svg(&scene, options, scale));
                assert!(mean < 0.5, "scale {scale}, expand {expand}: mean {mean}");
                assert!(most <= 40, "scale {scale}, expand {expand}: {most} somewhere");
            }
        }
    }

    #[test]
    fn textons_are_really_drawn() {
        let mut scene = testing::scene(300, 300, 2);
        let full = render(&scene, 1.0).unwrap();
        scene.primary_mut().clear();
        scene.secondary_mut().clear();
        let (mean, _) = difference(&full, &render(&scene, 1.0).unwrap());
        assert!(mean > 5.0, "{mean}");
    }

    #[test]
    fn bands_of_the_background_leave_no_seam() {
        let mut scene = testing::scene(1200, 120, 3);
        scene.primary_mut().clear();
        scene.secondary_mut().clear();
        for scale in [1.0, 1.37, 4.0] {
            let svg = by_svg(&scene, SvgOptions::default(), scale);
            let (mean, most) = difference(&render(&scene, scale).unwrap(), &svg);
            assert!(mean < 0.6 && most <= 3, "scale {scale}: mean {mean}, largest {most}");
        }
    }

    #[test]
    fn background_follows_the_field() {
        let mut scene = testing::scene(200, 200, 4);
        scene.primary_mut().clear();
        scene.secondary_mut().clear();
        let picture = render(&scene, 1.0).unwrap();
        let field = vtex_scene::scene::field::Interpolant::new(scene.field(), 200, 200, scene.tile);
        let mut sum = 0.0;
        for (i, pixel) in picture.pixels().iter().enumerate() {
            let at = field.at((i % 200) as f64 + 0.5, (i / 200) as f64 + 0.5);
            let got = [pixel.red(), pixel.green(), pixel.blue()];
            sum += (0..3).map(|c| (at[c].clamp(0.0, 255.0) - f64::from(got[c])).abs()).sum::<f64>();
        }
        let mean = sum / (3.0 * 200.0 * 200.0);
        assert!(mean < 1.0, "{mean}");
    }

    #[test]
    fn tiny_and_huge_pictures() {
        let scene = testing::scene(1, 1, 5);
        assert_eq!(render(&scene, 1.0).unwrap().width(), 1);
        assert_eq!(render(&scene, 1e-9).unwrap().width(), 1);
        let error = render(&scene, 1e5).unwrap_err().to_string();
        assert!(error.contains("100000 x 100000"), "{error}");
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(render(&scene, scale), Err(Error::Parameter { name: "scale", .. })), "{scale}");
        }
    }

    #[test]
    fn png_comes_back_and_names_program_and_seed() {
        let picture = render(&testing::scene(90, 60, 6), 1.0).unwrap();
        let mut bytes = Vec::new();
        encode(&picture, Some(77), None, &mut bytes).unwrap();
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        let drawn: Vec<u8> = picture.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
        assert_eq!(data, drawn);
        let texts: Vec<(&str, &str)> = reader
            .info()
            .uncompressed_latin1_text
            .iter()
            .map(|t| (t.keyword.as_str(), t.text.as_str()))
            .collect();
        assert_eq!(texts, [("Software", vtex_base::PROGRAM), ("Seed", "77")]);
    }

    #[test]
    fn unsound_scenes_are_refused() {
        let mut scene = testing::scene(20, 20, 7);
        scene.primary_mut()[0].element = vtex_scene::scene::ElementId(1000);
        assert!(matches!(render(&scene, 1.0), Err(Error::Format { .. })));
    }
}
