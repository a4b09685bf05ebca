//! Pictures of lines, such as scanned hatching, as drawings: each line a stroke along its middle (Tu's dissertation,
//! §2.3; `spec/curves.md`, row C14).
//!
//! The paper is measured in blocks, since scans are lit unevenly. What differs from it is ink, whose centre lines run on
//! through junctions as strokes. Each stroke has one width and one colour.
//!
//! Works badly for areas of ink as wide as long, for lines of which the faintest have less than half the contrast of the
//! darkest, and for lines nearer to one another than a pixel.

mod ink;
mod strokes;
#[cfg(test)]
mod tests;

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
    /// What was left out.
    pub(crate) warnings: Vec<String>,
}

/// Reads a picture of lines. `name` appears in errors.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Unusable`] below 32 × 32 pixels and where no lines stand out from
/// the paper; those of `progress`.
pub(crate) fn read(bytes: &[u8], name: &str, progress: &dyn Progress) -> Result<LineArt> {
    let go_on = || advance(progress, "drawing", 0, 4);
    let unusable = |reason: String| Error::Unusable { name: name.into(), reason };
    let mut warnings = Vec::new();
    let image = decode_over_white(bytes, name, &Limits::default(), &mut warnings)?;
    let (width, height) = image.dimensions();
    if width.min(height) < SMALLEST_SIDE {
        let least = SMALLEST_SIDE;
        return Err(unusable(format!(
            "it has {width} x {height} pixels, at least {least} x {least} are needed"
        )));
    }
    let found = ink(&image, &go_on)?.ok_or_else(|| unusable("no lines stand out from its paper".into()))?;
    let strokes = strokes(&image, &found, &go_on)?;
    if strokes.is_empty() {
        return Err(unusable("it holds areas and specks, but no lines".into()));
    }
    if found.specks > 0 {
        warnings.push(format!("specks and dots left out ({})", found.specks));
    }
    Ok(LineArt { svg: svg(&strokes, paper(&image, &found.difference), [width, height]), warnings })
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
fn svg(strokes: &[PictureStroke], paper: Colour, [width, height]: [u32; 2]) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\"><rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/><g fill=\"none\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\">"
    );
    for stroke in strokes {
        let mut points: Vec<Point> = stroke.points.iter().map(|p| Point::new(p[0], p[1])).collect();
        if stroke.closed && points.first() != points.last() {
            points.extend(points.first().copied());
        }
        let tolerance = (TOLERANCE * stroke.width).clamp(TOLERANCES[0], TOLERANCES[1]);
        let path = write_path(&fitted_curve(&points, tolerance, true), PathText { precision: PRECISION });
        let (colour, wide) = (stroke.colour, stroke.width);
        // Writing to a text cannot fail.
        let _ = write!(text, "<path stroke=\"{colour}\" stroke-width=\"{wide:.2}\" d=\"{path}\"/>");
    }
    text.push_str("</g></svg>");
    text
}
