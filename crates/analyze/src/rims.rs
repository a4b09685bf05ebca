//! Soft rims: the borders of elements that the photograph shows out of focus.
//!
//! Across an outline, colours change over a pixel or two where the photograph is in focus, and over more where it is
//! not. The width of the border is that between 10 % and 90 % of the change, in the median of places along the outline.
//! Where it is clearly over that of an edge in focus, a translucent line of that width ([`SoftRim`]) stands for the
//! transition, in the colour and with the opacity that take most from the squared error of a crisp edge there.

use super::edges::sample;
use image::RgbImage;
use vtex_base::geometry::{Outline, Point, Vec2};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::SoftRim;

/// Bytes of a rim as [`RateDistortion`](super::rate_distortion::RateDistortion) counts them: as packed, 3.5 times
/// those of a soft ellipse.
pub(super) const RIM_BYTES: f64 = 95.0;
/// Width of a border from which it is out of focus, in pixels from 10 % to 90 % of the change. Those of photographs in
/// focus have 1.4 to 1.6 in the mean.
const SOFT: f64 = 2.0;
/// Share of a linear ramp that lies between 10 % and 90 % of its change.
const RISE: f64 = 0.8;
/// Widest rim, in pixels.
const WIDEST: f64 = 12.0;
/// Opacities tried.
const OPACITIES: [f64; 4] = [0.4, 0.6, 0.8, 1.0];
/// Distance between places along an outline, in pixels.
const SPACING: f64 = 1.0;
/// Fewest places along an outline whose border is measured.
const PLACES: usize = 24;
/// Share of the places along an outline at which there must be a border.
const BORDERED: f64 = 0.25;
/// Least contrast of a border, over 3 px, in steps of 8 bits.
const CONTRAST: f64 = 15.0;
/// Distance between samples across an outline, in pixels.
const STEP: f64 = 0.5;
/// Samples to each side of an outline.
const REACH: usize = 17;
/// A border ends where its slope is less than this share of the steepest.
const END: f64 = 0.08;

/// The soft rim of an element with an outline, if its border is out of focus and the rim takes more from the squared
/// error than `least`.
pub(super) fn rim(image: &RgbImage, outline: &Outline, least: f64) -> Option<SoftRim> {
    let profiles: Vec<Profile> =
        places(outline).into_iter().map(|(at, normal)| Profile::new(image, at, normal)).collect();
    if profiles.len() < PLACES {
        return None;
    }
    let mut widths: Vec<f64> = profiles.iter().filter_map(Profile::width).collect();
    if (widths.len() as f64) < BORDERED * profiles.len() as f64 {
        return None;
    }
    widths.sort_by(f64::total_cmp);
    let median = widths[widths.len() / 2];
    if median < SOFT {
        return None;
    }
    // Rounded, so that numbers repeat in files.
    let width = libm::round(4.0 * (median / RISE).min(WIDEST)) / 4.0;
    let fits = OPACITIES.into_iter().filter_map(|opacity| RimFit::new(&profiles, width, opacity));
    // Of equals the first.
    let best = fits.reduce(|best, fit| if fit.gain > best.gain { fit } else { best })?;
    (best.gain > least).then_some(best.rim)
}

/// Places along an outline, [`SPACING`] apart, with the unit normal at each.
fn places(outline: &Outline) -> Vec<(Point, Vec2)> {
    let mut places = Vec::new();
    for ring in outline.polygons(0.05) {
        let mut ahead = SPACING / 2.0;
        for (i, &from) in ring.iter().enumerate() {
            let along = ring[(i + 1) % ring.len()] - from;
            let length = along.hypot();
            while ahead < length {
                places.push((from + along * (ahead / length), Vec2::new(-along.y, along.x) / length));
                ahead += SPACING;
            }
            ahead -= length;
        }
    }
    places
}

/// Colours across an outline, [`STEP`] apart, half of them on either side.
struct Profile([[f64; 3]; 2 * REACH]);

impl Profile {
    fn new(image: &RgbImage, at: Point, normal: Vec2) -> Self {
        Self(std::array::from_fn(|k| sample(image, at + normal * Self::distance(k))))
    }

    /// Signed distance of a sample from the outline, in pixels.
    fn distance(k: usize) -> f64 {
        (k as f64 + 0.5 - REACH as f64) * STEP
    }

    /// The width of the border, in pixels; `None` if there is none.
    fn width(&self) -> Option<f64> {
        const NEAR: usize = 3;
        let (low, high) = (self.0[REACH - NEAR], self.0[REACH - 1 + NEAR]);
        let apart = [0, 1, 2].map(|c| high[c] - low[c]);
        let contrast = libm::sqrt(apart.iter().map(|v| v * v).sum());
        if contrast < CONTRAST {
            return None;
        }
        let along = self.0.map(|colour| (0..3).map(|c| colour[c] * apart[c]).sum::<f64>() / contrast);
        let slope = |k: usize| along[k + 1] - along[k];
        let near = REACH - NEAR..REACH - 1 + NEAR;
        let steepest = near.reduce(|best, k| if slope(k) > slope(best) { k } else { best })?;
        let least = END * slope(steepest);
        if least <= 0.0 {
            return None;
        }
        let last = 2 * REACH - 1;
        let end = (steepest..last).find(|&k| slope(k) < least).unwrap_or(last);
        let start = (0..steepest).rev().find(|&k| slope(k) < least).map_or(0, |k| k + 1);
        let [from, to] = [(1.0 - RISE) / 2.0, (1.0 + RISE) / 2.0].map(|share| {
            let level = along[start] + share * (along[end] - along[start]);
            let k = (start..end).find(|&k| along[k + 1] >= level).unwrap_or(end - 1);
            k as f64 + (level - along[k]) / slope(k)
        });
        Some((to - from) * STEP)
    }
}

/// A rim in the colour in which it takes most from the squared error.
struct RimFit {
    rim: SoftRim,
    /// What it takes from the squared error of crisp edges with the colours at its own edges on both sides.
    gain: f64,
}

impl RimFit {
    fn new(profiles: &[Profile], width: f64, opacity: f64) -> Option<Self> {
        let rim = SoftRim { width, colour: Colour::default(), opacity };
        let inside = (0..2 * REACH).filter(|&k| Profile::distance(k).abs() < width / 2.0);
        let opacities: Vec<(usize, f64)> =
            inside.map(|k| (k, rim.opacity_at(Profile::distance(k).abs()))).collect();
        let (first, last) = (opacities.first()?.0.checked_sub(1)?, opacities.last()?.0 + 1);
        let (mut squares, mut wanted, mut before, mut black) = (0.0, [0.0; 3], 0.0, 0.0);
        for Profile(colours) in profiles {
            let sides = [colours[first], *colours.get(last)?];
            for &(k, opacity) in &opacities {
                let crisp = sides[usize::from(k >= REACH)];
                squares += opacity * opacity;
                for c in 0..3 {
                    let rest = colours[k][c] - crisp[c] * (1.0 - opacity);
                    wanted[c] += opacity * rest;
                    black += rest * rest;
                    before += (colours[k][c] - crisp[c]) * (colours[k][c] - crisp[c]);
                }
            }
        }
        let colour = Colour::from_f64(wanted.map(|v| v / squares));
        let own = colour.to_f64();
        let after = black + (0..3).map(|c| squares * own[c] * own[c] - 2.0 * own[c] * wanted[c]).sum::<f64>();
        Some(Self { rim: SoftRim { colour, ..rim }, gain: (before - after) * STEP * SPACING })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::geometry::parse_path;

    /// A picture of 80 × 80 with a disc of radius 20 whose border is a ramp of a width.
    fn disc(width: f64) -> RgbImage {
        RgbImage::from_fn(80, 80, |x, y| {
            let from = libm::hypot(f64::from(x) - 39.5, f64::from(y) - 39.5) - 20.0;
            let share = (0.5 - from / width).clamp(0.0, 1.0);
            Rgb([60.0, 80.0, 50.0].map(|v| libm::round(v + share * 100.0) as u8))
        })
    }

    fn circle() -> Outline {
        let path = "M60 40C60 51 51 60 40 60C29 60 20 51 20 40C20 29 29 20 40 20C51 20 60 29 60 40z";
        Outline::new(&parse_path(path).unwrap()).unwrap()
    }

    #[test]
    fn the_width_of_a_rim_is_that_of_the_border() {
        for width in [4.0, 6.0, 9.0] {
            let found = rim(&disc(width), &circle(), 1000.0).unwrap();
            assert!((found.width / width - 1.0).abs() < 0.35, "{width} {found:?}");
            assert!(found.opacity >= 0.8, "{found:?}");
            let middle = [110.0, 130.0, 100.0];
            let off =
                found.colour.to_f64().iter().zip(middle).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 8.0, "{found:?}");
        }
    }

    #[test]
    fn borders_in_focus_and_even_ones_have_no_rim() {
        assert_eq!(rim(&disc(1.0), &circle(), 1000.0), None);
        assert_eq!(rim(&RgbImage::from_pixel(80, 80, Rgb([90; 3])), &circle(), 1000.0), None);
        // Not worth its bytes.
        assert_eq!(rim(&disc(6.0), &circle(), 1e9), None);
        // A speck.
        let speck = Outline::new(&parse_path("M38 38h4v4h-4z").unwrap()).unwrap();
        assert_eq!(rim(&disc(6.0), &speck, 0.0), None);
    }

    #[test]
    fn gains_are_errors_that_are_taken_away() {
        let (image, outline) = (disc(8.0), circle());
        let profiles: Vec<Profile> =
            places(&outline).into_iter().map(|(at, normal)| Profile::new(&image, at, normal)).collect();
        assert!((profiles.len() as f64 / (std::f64::consts::TAU * 20.0) - 1.0).abs() < 0.05);
        let fit = RimFit::new(&profiles, 8.0, 1.0).unwrap();
        // Of a ramp of contrast c and width w, a crisp edge is off by c² w / 12 for each pixel and component.
        let crisp = 3.0 * 100.0 * 100.0 * 8.0 / 12.0 * profiles.len() as f64;
        assert!(fit.gain > 0.7 * crisp && fit.gain < crisp, "{} of {crisp}", fit.gain);
    }
}
