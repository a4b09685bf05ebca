//! Pictures of lines, such as scanned hatching, as drawings: each line a stroke along its middle (Tu's dissertation,
//! §2.3; `spec/curves.md`, row C14).
//!
//! The paper is measured in blocks, since scans are lit unevenly. What differs from it is ink, whose centre lines run on
//! through junctions as strokes. Each stroke has one width and one colour.
//!
//! Works badly for areas of ink as wide as long, for lines of which the faintest have less than half the contrast of the
//! darkest, and for lines nearer to one another than a pixel.

mod ink;
mod recognise;
mod strokes;
#[cfg(test)]
mod tests;

pub use recognise::shows_lines;

use image::RgbImage;
use ink::ink;
use std::fmt::Write;
use strokes::{PictureStroke, strokes};
use vtex_base::error::{Error, Result};
use vtex_base::geometry::{PathText, Point, fitted_curve, write_path};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::{Colour, median};
use vtex_base::raster::{Limits, decode_over_white};

/// Least width and height of a picture, in pixels.
const SMALLEST_SIDE: u32 = 32;
/// Tolerance of paths, in widths of the line, and its bounds in pixels.
const TOLERANCE: f64 = 0.12;
const TOLERANCES: [f64; 2] = [0.1, 1.0];
/// Digits after the decimal point of coordinates and of widths.
const PRECISION: u8 = 2;

/// A picture of lines as an SVG of strokes, of the picture's size.
pub(crate) struct LineArt {
    pub(crate) svg: String,
    /// Whether its borders join.
    pub(crate) wrap: bool,
    /// What was left out.
    pub(crate) warnings: Vec<String>,
}

/// Reads a picture of lines. `name` appears in errors. `wrap`: whether its borders join; `None` to find out.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Unusable`] below 32 × 32 pixels and where no lines stand out from
/// the paper; those of `progress`.
pub(crate) fn read(bytes: &[u8], name: &str, wrap: Option<bool>, progress: &dyn Progress) -> Result<LineArt> {
    let go_on = || advance(progress, "drawing", 0, 4);
    let unusable = |reason: String, advice| Error::Unusable { name: name.into(), reason, advice };
    let no_lines =
        |reason: &str| unusable(reason.into(), "read it as a photograph, not as a picture of lines");
    let mut warnings = Vec::new();
    let image = decode_over_white(bytes, name, &Limits::default(), &mut warnings)?;
    let (width, height) = image.dimensions();
    if width.min(height) < SMALLEST_SIDE {
        let least = SMALLEST_SIDE;
        let reason = format!("it has {width} x {height} pixels, at least {least} x {least} are needed");
        return Err(unusable(reason, "use a larger picture"));
    }
    let found = ink(&image, wrap, &go_on)?.ok_or_else(|| no_lines("no lines stand out from its paper"))?;
    let strokes = strokes(&image, &found, &go_on)?;
    if strokes.is_empty() {
        return Err(no_lines("it contains areas and specks, but no lines"));
    }
    if found.specks > 0 {
        warnings.push(format!("specks and dots left out ({})", found.specks));
    }
    let wrap = found.cells.wraps[0];
    let svg = svg(&strokes, paper(&image, &found.difference), wrap, [width, height]);
    Ok(LineArt { svg, wrap, warnings })
}

/// The median colour of the half of the pixels with the least ink.
fn paper(image: &RgbImage, difference: &[f32]) -> Colour {
    let mut sorted = difference.to_vec();
    let middle = sorted.len() / 2;
    let most = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    let bare = image.pixels().zip(difference).filter(|p| *p.1 <= most).map(|p| p.0.0);
    median(bare).unwrap_or(Colour([255; 3]))
}

/// The strokes as an SVG.
fn svg(strokes: &[PictureStroke], paper: Colour, wrap: bool, [width, height]: [u32; 2]) -> String {
    // No group: strokes of one would be one element.
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"><rect width=\"{width}\" \
         height=\"{height}\" fill=\"{paper}\"/>"
    );
    // What crosses a border that joins the opposite one is drawn at both.
    let page = [width, height].map(f64::from);
    for (stroke, shift) in
        strokes.iter().flat_map(|s| copies(s, page, wrap).into_iter().map(move |by| (s, by)))
    {
        let place = |p: &[f64; 2]| Point::new(p[0] + shift[0], p[1] + shift[1]);
        let mut points: Vec<Point> = stroke.points.iter().map(place).collect();
        if stroke.closed && points.first() != points.last() {
            points.extend(points.first().copied());
        }
        let tolerance = (TOLERANCE * stroke.width).clamp(TOLERANCES[0], TOLERANCES[1]);
        let path = write_path(&fitted_curve(&points, tolerance, true), PathText { precision: PRECISION });
        let (colour, wide) = (stroke.colour, stroke.width);
        // Writing to a text cannot fail.
        let _ = write!(text, "<path stroke=\"{colour}\" stroke-width=\"{wide:.2}\" d=\"{path}\"/>");
    }
    text.push_str("</svg>");
    text
}

/// The shifts of the copies of a stroke that are seen on a page: one, unless opposite borders join.
fn copies(stroke: &PictureStroke, page: [f64; 2], wrap: bool) -> Vec<[f64; 2]> {
    if !wrap {
        return vec![[0.0; 2]];
    }
    let reach = 0.5 * stroke.width;
    let shifts = [0, 1].map(|k| {
        let low = stroke.points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min) - reach;
        let high = stroke.points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) + reach;
        let first = libm::floor(low / page[k]) as i64;
        let last = libm::ceil(high / page[k]) as i64 - 1;
        (-last..=-first).map(move |n| n as f64 * page[k]).collect::<Vec<f64>>()
    });
    shifts[1].iter().flat_map(|y| shifts[0].iter().map(move |x| [*x, *y])).collect()
}
