//! Sub-pixel positions of the image's edges.
//!
//! A pixel that an edge crosses shows a mixture of both sides. The share of one side's colour,
//! integrated along the normal across the edge, gives the edge's position. No threshold and no
//! gradient is needed, and an outline drawn there covers the same area.

use image::RgbImage;
use vtex_base::geometry::{Point, Vec2};
use vtex_base::raster::colour::Colour;

/// Distance to each side over which the image is sampled, in pixels.
const REACH: f64 = 1.5;
/// Samples on each side.
const SAMPLES: i32 = 3;
/// Distance from the edge at which a side shows its own colour, in pixels.
const PLATEAU: f64 = 2.0;
/// Contrast between both sides (8-bit steps) at which an edge begins to count, and at which it
/// counts fully.
const CONTRAST: [f64; 2] = [12.0, 30.0];

/// An image whose edges between labelled pieces can be located.
pub(super) struct Edges<'a> {
    image: &'a RgbImage,
    /// The colour of each label; `None` for background, whose colour varies.
    colours: Vec<Option<Colour>>,
}

impl<'a> Edges<'a> {
    pub(super) fn new(image: &'a RgbImage, colours: Vec<Option<Colour>>) -> Self {
        Self { image, colours }
    }

    /// Signed distance from `at` to the edge between two labels, in pixels along `normal`, a unit
    /// vector from the left side to the right. 0 where the contrast is too low.
    pub(super) fn distance(&self, at: Point, normal: Vec2, left: u32, right: u32) -> f64 {
        let side = |label: u32, away: Vec2| {
            let here = sample(self.image, at + away);
            match self.colours.get(label as usize).copied().flatten() {
                Some(colour) => {
                    let own = colour.to_f64();
                    [0, 1, 2].map(|c| between(here[c], own[c], 0.5))
                }
                None => here,
            }
        };
        let (l, r) = (side(left, normal * -PLATEAU), side(right, normal * PLATEAU));
        let apart = [0, 1, 2].map(|c| l[c] - r[c]);
        let contrast2 = apart.iter().map(|v| v * v).sum::<f64>();
        let contrast = libm::sqrt(contrast2);
        let weight = ((contrast - CONTRAST[0]) / (CONTRAST[1] - CONTRAST[0])).clamp(0.0, 1.0);
        if weight == 0.0 {
            return 0.0;
        }
        let step = REACH / f64::from(SAMPLES);
        let mut amount = 0.0;
        for k in -SAMPLES..=SAMPLES {
            let here = sample(self.image, at + normal * (f64::from(k) * step));
            let share = (0..3).map(|c| (here[c] - r[c]) * apart[c]).sum::<f64>() / contrast2;
            let ends = if k.abs() == SAMPLES { 0.5 } else { 1.0 };
            amount += share.clamp(0.0, 1.0) * ends * step;
        }
        weight * (amount - REACH)
    }
}

/// Bilinear sample of an image; beyond the border the nearest pixel.
#[inline]
pub(super) fn sample(image: &RgbImage, at: Point) -> [f64; 3] {
    let (width, height) = (image.width() as i32, image.height() as i32);
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    let (x0, y0) = (floor(x), floor(y));
    let (column, line) = (x0 as i32, y0 as i32);
    let [left, right] = [column, column.saturating_add(1)].map(|x| 3 * x.clamp(0, width - 1) as usize);
    let row = |y: i32| &image.as_raw()[3 * (y.clamp(0, height - 1) * width) as usize..];
    let (above, below) = (row(line), row(line.saturating_add(1)));
    let (tx, ty) = (x - x0, y - y0);
    // A loop: `map` of arrays is not always compiled into its caller, which doubles what sampling costs.
    let mut colour = [0.0; 3];
    for (c, value) in colour.iter_mut().enumerate() {
        let across = |row: &[u8]| between(f64::from(row[left + c]), f64::from(row[right + c]), tx);
        *value = between(across(above), across(below), ty);
    }
    colour
}

/// The largest whole number up to `v`, for places in an image.
#[inline]
fn floor(v: f64) -> f64 {
    let whole = f64::from(v as i32);
    if whole > v { whole - 1.0 } else { whole }
}

#[inline]
fn between(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// A vertical edge at `x`, drawn with exact coverage.
    fn picture(x: f64) -> RgbImage {
        RgbImage::from_fn(16, 8, |i, _| {
            let share = (x - f64::from(i)).clamp(0.0, 1.0);
            Rgb([200.0, 90.0, 20.0].map(|v: f64| libm::round(40.0 + (v - 40.0) * share) as u8))
        })
    }

    #[test]
    fn an_edge_is_found_between_pixels() {
        for tenth in 0..10 {
            let x = 7.5 + f64::from(tenth) / 10.0;
            let image = picture(x);
            let colours = vec![None, Some(Colour([200, 90, 20])), Some(Colour([40, 40, 40]))];
            let edges = Edges::new(&image, colours);
            for (label, other) in [(1, 2), (0, 0)] {
                let there = edges.distance(Point::new(8.0, 4.0), Vec2::new(1.0, 0.0), label, other);
                assert!((8.0 + there - x).abs() < 0.06, "{x}: {there}");
                let back = edges.distance(Point::new(8.0, 4.0), Vec2::new(-1.0, 0.0), other, label);
                assert!((8.0 - back - x).abs() < 0.06, "{x}: {back}");
            }
        }
    }

    #[test]
    fn what_hardly_differs_has_no_edge() {
        let image = RgbImage::from_fn(9, 9, |x, y| Rgb([100 + ((x + y) % 3) as u8; 3]));
        let edges = Edges::new(&image, Vec::new());
        assert_eq!(edges.distance(Point::new(4.0, 4.0), Vec2::new(0.0, 1.0), 1, 2), 0.0);
        assert_eq!(edges.distance(Point::new(0.0, 9.0), Vec2::new(0.0, 1.0), 1, 2), 0.0);
    }
}
