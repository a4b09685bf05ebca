//! Draws the page as pixels.

use super::pieces::DrawingPiece;
use super::read::DrawingPage;
use super::shapes::shapes;
use crate::svg_tree::{self, SvgFault};
use image::{Rgb, RgbImage};
use resvg::usvg::Transform;
use vtex_base::geometry::{Affine, ConvexPolygon, Rect};
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::pixels;

/// Samples along each side of a pixel when the picture is drawn from pieces.
const SAMPLES: u32 = 2;

/// The drawing over white, drawn by resvg. If parts were left out, it is drawn from the remaining pieces,
/// with gradients in their mean colour.
///
/// # Errors
/// As [`svg_tree::draw`].
pub(super) fn picture(
    page: &DrawingPage,
    (colour, pieces): (Colour, &[DrawingPiece]),
    size: [u32; 2],
) -> Result<RgbImage, SvgFault> {
    if page.is_incomplete { Ok(drawn(page, colour, pieces.iter(), size)) } else { by_resvg(page, size) }
}

fn by_resvg(page: &DrawingPage, [width, height]: [u32; 2]) -> Result<RgbImage, SvgFault> {
    let Some(mut pixmap) = tiny_skia::Pixmap::new(width, height) else {
        return Ok(RgbImage::from_pixel(width, height, Rgb([255; 3])));
    };
    pixmap.fill(tiny_skia::Color::WHITE);
    let [sx, sy] = [0, 1].map(|k| ([width, height][k] as f64 / page.size[k]) as f32);
    svg_tree::draw(&page.tree, Transform::from_scale(sx, sy), &mut pixmap, 1.0)?;
    Ok(RgbImage::from_fn(width, height, |x, y| {
        let p = pixmap.pixels()[(y * width + x) as usize];
        Rgb([p.red(), p.green(), p.blue()])
    }))
}

/// Pieces over a colour, with gradients in their mean colour.
pub(super) fn drawn<'a>(
    page: &DrawingPage,
    colour: Colour,
    pieces: impl Iterator<Item = &'a DrawingPiece>,
    [width, height]: [u32; 2],
) -> RgbImage {
    let fine = [width, height].map(|v| v * SAMPLES);
    let mut picture = RgbImage::from_pixel(fine[0], fine[1], Rgb(colour.0));
    let [sx, sy] = [0, 1].map(|k| f64::from(fine[k]) / page.size[k]);
    let map = Affine::scale_non_uniform(sx, sy);
    pieces.for_each(|piece| draw(&mut picture, piece, map));
    let count = SAMPLES * SAMPLES;
    RgbImage::from_fn(width, height, |x, y| {
        let samples = (0..count).map(|k| (SAMPLES * x + k % SAMPLES, SAMPLES * y + k / SAMPLES));
        let sum = samples.fold([0u32; 3], |sum, (x, y)| {
            let p = picture.get_pixel(x, y).0;
            [0, 1, 2].map(|c| sum[c] + u32::from(p[c]))
        });
        Rgb(sum.map(|v| ((v + count / 2) / count) as u8))
    })
}

fn draw(picture: &mut RgbImage, piece: &DrawingPiece, map: Affine) {
    let seen = Rect::new(0.0, 0.0, f64::from(picture.width()), f64::from(picture.height()));
    let seen = ConvexPolygon::rect(seen);
    for shape in shapes(piece, map) {
        // What leaves the page may cover many times as many pixels.
        let Some(outline) = seen.part_of(&shape.outline) else { continue };
        let (new, opacity) = (shape.colour.to_f64(), shape.opacity);
        for (x, y) in pixels::mask(&outline).pixels() {
            let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { continue };
            let Some(pixel) = picture.get_pixel_mut_checked(x, y) else { continue };
            let mixed = |k: usize| (f64::from(pixel.0[k]) * (1.0 - opacity) + new[k] * opacity + 0.5) as u8;
            *pixel = if opacity >= 1.0 { Rgb(shape.colour.0) } else { Rgb([mixed(0), mixed(1), mixed(2)]) };
        }
    }
}
