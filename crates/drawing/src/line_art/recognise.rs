//! Whether a picture shows lines on paper, rather than things.
//!
//! Two tones, paper without texture, and ink in long thin pieces. Measured on 35 photographs and generated pictures and
//! on drawings of lines: the share of the variance between paper and ink is at most .90 in photographs, .86 to .96 in
//! drawings; the spread of the paper over the contrast at least .13 in photographs, at most .09 in drawings. No picture
//! of things has both.
//!
//! Works badly for pencil, whose lines have less than half the contrast of ink, and for lines with many fills between.

use super::SMALLEST_SIDE;
use super::ink::{differences, mean_width, means};
use image::{RgbImage, imageops};
use vtex_base::raster::{Connectivity, LabelMap, components};

/// Side of the part in the middle of a picture that is looked at, in pixels.
const LOOKED_AT: u32 = 1000;
/// Least contrast of ink and paper, in Oklab; least share of the variance that is between the two; largest standard
/// deviation of the paper, as a share of the contrast; largest share of the picture that is ink.
const CONTRAST: f32 = 0.3;
const TWO_TONES: f64 = 0.84;
const PAPER: f64 = 0.11;
const INK: f64 = 0.4;
/// Largest width of lines, as a share of the shorter side, and least length of the pieces of ink, in widths, weighted by
/// their areas.
const WIDTH: f64 = 0.025;
const LENGTH: f64 = 12.0;

/// Whether a picture shows lines on paper, such as a scan of hatching: two tones, thin strokes.
pub fn shows_lines(image: &RgbImage) -> bool {
    let [width, height] = [image.width(), image.height()].map(|side| side.min(LOOKED_AT));
    if width.min(height) < SMALLEST_SIDE {
        return false;
    }
    let [x, y] = [(image.width() - width) / 2, (image.height() - height) / 2];
    let part = imageops::crop_imm(image, x, y, width, height).to_image();
    let Ok(Some(difference)) = differences(&part, &|| Ok(())) else { return false };
    let Some([of_paper, of_ink]) = means(&difference) else { return false };
    let contrast = of_ink - of_paper;
    let threshold = 0.5 * (of_paper + of_ink);
    let [paper, ink] = [false, true].map(|is_ink| {
        let of = difference.iter().filter(|d| (**d >= threshold) == is_ink).map(|d| f64::from(*d));
        Spread::of(of)
    });
    let share = ink.count / (ink.count + paper.count);
    let between = share * (1.0 - share) * f64::from(contrast) * f64::from(contrast);
    let within = share * ink.variance + (1.0 - share) * paper.variance;
    let line = mean_width(&difference, [width as usize, height as usize], threshold);
    contrast >= CONTRAST
        && share <= INK
        && between >= TWO_TONES * (between + within)
        && libm::sqrt(paper.variance) <= PAPER * f64::from(contrast)
        && line <= WIDTH * f64::from(width.min(height))
        && area_of_pieces(&difference, [width, height], threshold) >= LENGTH * line * line
}

/// The number of some values and their variance.
struct Spread {
    count: f64,
    variance: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let [count, sum, squares] = values.fold([0.0; 3], |[n, s, q], v| [n + 1.0, s + v, q + v * v]);
        let mean = sum / f64::max(count, 1.0);
        Self { count, variance: (squares / f64::max(count, 1.0) - mean * mean).max(0.0) }
    }
}

/// Mean area of the pieces of ink, weighted by area, in pixels.
fn area_of_pieces(difference: &[f32], [width, height]: [u32; 2], threshold: f32) -> f64 {
    let mut map = LabelMap::filled(width, height, 0);
    for (label, d) in map.labels.iter_mut().zip(difference) {
        *label = u32::from(*d >= threshold);
    }
    let (pieces, _) = components(&map, Connectivity::Eight);
    let areas = pieces.areas();
    let [all, squares] = areas.iter().skip(1).fold([0.0; 2], |[all, squares], area| {
        let area = f64::from(*area);
        [all + area, squares + area * area]
    });
    if all > 0.0 { squares / all } else { 0.0 }
}
