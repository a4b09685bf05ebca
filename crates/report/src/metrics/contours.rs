//! Contours that a drawn result shows when enlarged: those that the exemplar lacks, and how wide borders are.
//!
//! Both pictures are looked at [`ENLARGED`] times as large, the exemplar by Catmull and Rom's cubic. The change at a
//! place is that between the colours half a [`BASE`] to each side, in Oklab. Where the result changes and the exemplar
//! changes much less, the contour is spurious: a border with an edge where the photograph is out of focus, a patch
//! where it has a gradient, a blur beside an edge. A border that is a little steeper than the exemplar's is none; how
//! wide borders are is measured by itself.

use image::RgbImage;
use serde::Serialize;
use vtex_base::error::{Error, Result};
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::oklab;
use vtex_base::raster::{Filter, resized};

/// How many times as large as the exemplar the result is drawn.
pub const ENLARGED: u32 = 4;
/// Distance of the two places whose colours are compared, in enlarged pixels: one pixel of the exemplar.
const BASE: usize = ENLARGED as usize;
/// Change from which a place of the result is part of a contour, in Oklab.
const CONTOUR: f32 = 0.05;
/// Largest change of the exemplar at a spurious contour, relative to the result's.
const COUNTERPART: f32 = 1.0 / 3.0;
/// How far away the exemplar's own contour may be, in enlarged pixels: half a pixel of the exemplar.
const AWAY: usize = ENLARGED as usize / 2;
/// Length of the profile across a border to each side, in pixels of the exemplar.
const PROFILE: usize = 6;
/// A border ends where its slope is less than this share of the steepest.
const END: f32 = 0.05;
/// Shares of the change across a border between which its width is measured.
const RISE: [f32; 2] = [0.1, 0.9];
/// Rows of the enlarged pictures that are looked at together.
const ROWS: usize = 64;

/// Half of [`BASE`].
const STEP: usize = BASE / 2;
/// [`PROFILE`] in enlarged pixels.
const LONGEST: usize = PROFILE * ENLARGED as usize;

/// Contours of a result beside those of its exemplar, as [`contours`] returns them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Contours {
    /// Share of the enlarged result that is part of a contour, 0 to 1.
    pub share: f64,
    /// Share of the enlarged result that is part of a contour where the exemplar has none, 0 to 1.
    pub spurious: f64,
    /// Mean width of the exemplar's borders, from 10 % to 90 % of the change across them, in pixels; 0 if there are
    /// none. Borders are those of the result which the exemplar has too.
    pub width_exemplar: f64,
    /// Mean width of the same borders in the result, in pixels.
    pub width_result: f64,
}

/// Whether the contours of a result of a size can be compared with those of an exemplar: the sizes are the same, at
/// least 32 px on each side and at most 1.6 million pixels.
pub fn can_compare_contours(exemplar: &RgbImage, result: [u32; 2]) -> bool {
    super::check_size(exemplar, "exemplar").is_ok() && <[u32; 2]>::from(exemplar.dimensions()) == result
}

/// Compares the contours of a result, drawn [`ENLARGED`] times as large, with those of its exemplar. Only a picture
/// that lies pixel on pixel on its exemplar, such as a photograph drawn in vectors, has contours at the same places.
///
/// # Errors
/// [`Error::Unusable`] if the result is not [`ENLARGED`] times as wide and as high as the exemplar, or the exemplar
/// has a side below 32 px; [`Error::TooLarge`] if it has more than 1.6 million pixels; [`Error::Interrupted`].
///
/// # Example
/// ```
/// # mod vtex { pub use {vtex_base::Error, vtex_report::metrics}; }
/// # use image::{Rgb, RgbImage};
/// // A gradient, drawn as two flat halves.
/// let gradient = RgbImage::from_fn(64, 64, |x, _| Rgb([(60 + 2 * x) as u8; 3]));
/// let halves = RgbImage::from_fn(256, 256, |x, _| Rgb([if x < 128 { 92 } else { 156 }; 3]));
/// let found = vtex::metrics::contours(&gradient, &halves, &())?;
/// assert!(found.spurious > 0.01 && found.spurious == found.share);
/// # Ok::<(), vtex::Error>(())
/// ```
pub fn contours(exemplar: &RgbImage, enlarged: &RgbImage, progress: &dyn Progress) -> Result<Contours> {
    super::check_size(exemplar, "exemplar")?;
    let wanted = [exemplar.width(), exemplar.height()].map(|v| v * ENLARGED);
    if [enlarged.width(), enlarged.height()] != wanted {
        let [width, height] = wanted;
        let reason = format!(
            "it has {} x {} pixels, {ENLARGED} times as many as the exemplar along each side, \
             {width} x {height}, are needed to compare contours",
            enlarged.width(),
            enlarged.height()
        );
        let advice = "draw the result at that size";
        return Err(Error::Unusable { name: "result".into(), reason, advice });
    }
    let [width, height] = wanted;
    let smooth = resized(exemplar, width, height, Filter::CatmullRom);
    let starts: Vec<usize> = (0..height as usize).step_by(ROWS).collect();
    let bands = parallel::map(&starts, |&start| {
        advance(progress, "contours", start as u64, u64::from(height))?;
        Ok(Band::new([&smooth, enlarged], start).counts())
    });
    let mut sum = Counts::default();
    for band in bands {
        sum.add(&band?);
    }
    let pixels = f64::from(width) * f64::from(height);
    let mean = |total: f64| total / sum.borders.max(1) as f64 / f64::from(ENLARGED);
    let [width_exemplar, width_result] = sum.widths.map(mean);
    Ok(Contours {
        share: sum.contours as f64 / pixels,
        spurious: sum.spurious as f64 / pixels,
        width_exemplar,
        width_result,
    })
}

/// What is counted, in enlarged pixels.
#[derive(Default)]
struct Counts {
    contours: u64,
    spurious: u64,
    /// Places whose widths are in `widths`.
    borders: u64,
    /// Sums of the widths of the exemplar's and the result's borders.
    widths: [f64; 2],
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.contours += other.contours;
        self.spurious += other.spurious;
        self.borders += other.borders;
        (0..2).for_each(|k| self.widths[k] += other.widths[k]);
    }
}

/// Rows of a picture in Oklab, continued beyond the picture's borders by the pixels there.
struct OklabRows {
    width: usize,
    /// The row of the picture that is the first here.
    first: usize,
    colours: Vec<[f32; 3]>,
}

impl OklabRows {
    fn new(picture: &RgbImage, first: usize, end: usize) -> Self {
        let width = picture.width() as usize;
        let raw = &picture.as_raw()[3 * width * first..3 * width * end];
        let colours = raw.chunks_exact(3).map(|rgb| oklab([rgb[0], rgb[1], rgb[2]])).collect();
        Self { width, first, colours }
    }

    fn at(&self, x: isize, y: isize) -> [f32; 3] {
        let rows = (self.colours.len() / self.width) as isize;
        let x = x.clamp(0, self.width as isize - 1) as usize;
        let y = (y - self.first as isize).clamp(0, rows - 1) as usize;
        self.colours[y * self.width + x]
    }

    /// Bilinear sample at a place in units of pixels, whose centres are whole numbers.
    fn between(&self, x: f32, y: f32) -> [f32; 3] {
        let whole = [x, y].map(libm::floorf);
        let (tx, ty) = (x - whole[0], y - whole[1]);
        let [u, v] = whole.map(|v| v as isize);
        let (a, b) = (self.at(u, v), self.at(u + 1, v));
        let (c, d) = (self.at(u, v + 1), self.at(u + 1, v + 1));
        std::array::from_fn(|k| {
            let (above, below) = (a[k] + tx * (b[k] - a[k]), c[k] + tx * (d[k] - c[k]));
            above + ty * (below - above)
        })
    }

    /// The changes along x and along y at a pixel.
    fn changes(&self, x: usize, y: usize) -> [[f32; 3]; 2] {
        let (x, y, step) = (x as isize, y as isize, STEP as isize);
        let change = |dx: isize, dy: isize| minus(self.at(x + dx, y + dy), self.at(x - dx, y - dy));
        [change(step, 0), change(0, step)]
    }

    /// The size of the change at a pixel.
    fn change(&self, x: usize, y: usize) -> f32 {
        libm::sqrtf(self.changes(x, y).iter().map(|d| dot(*d, *d)).sum())
    }
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Some rows of both enlarged pictures, the exemplar's first.
struct Band {
    pictures: [OklabRows; 2],
    /// The rows that are counted.
    rows: std::ops::Range<usize>,
}

impl Band {
    fn new(pictures: [&RgbImage; 2], start: usize) -> Self {
        let height = pictures[0].height() as usize;
        let end = (start + ROWS).min(height);
        let margin = LONGEST + 1;
        let (first, last) = (start.saturating_sub(margin), (end + margin).min(height));
        Self { pictures: pictures.map(|picture| OklabRows::new(picture, first, last)), rows: start..end }
    }

    fn counts(&self) -> Counts {
        let [exemplar, result] = &self.pictures;
        let width = result.width;
        let end = exemplar.first + exemplar.colours.len() / width;
        let top = self.rows.start.saturating_sub(AWAY);
        let bottom = (self.rows.end + AWAY).min(end);
        let changes = |rows: &OklabRows| -> Vec<f32> {
            (top..bottom)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(|(x, y)| rows.change(x, y))
                .collect()
        };
        let (of_exemplar, of_result) = (largest_around(&changes(exemplar), width), changes(result));
        let mut counts = Counts::default();
        for y in self.rows.clone() {
            let row = (y - top) * width;
            for x in 0..width {
                let change = of_result[row + x];
                if change < CONTOUR {
                    continue;
                }
                counts.contours += 1;
                if of_exemplar[row + x] < COUNTERPART * change {
                    counts.spurious += 1;
                } else if let Some(widths) = self.widths(x, y, change) {
                    counts.borders += 1;
                    (0..2).for_each(|k| counts.widths[k] += f64::from(widths[k]));
                }
            }
        }
        counts
    }

    /// The widths of the border at a pixel in both pictures, in enlarged pixels, if the pixel is on the border of the
    /// result and both pictures rise there.
    fn widths(&self, x: usize, y: usize, change: f32) -> Option<[f32; 2]> {
        let result = &self.pictures[1];
        let [across, down] = result.changes(x, y);
        let (xx, xy, yy) = (dot(across, across), dot(across, down), dot(down, down));
        let angle = 0.5 * libm::atan2f(2.0 * xy, xx - yy);
        let normal = [libm::cosf(angle), libm::sinf(angle)];
        let along: [f32; 3] = std::array::from_fn(|k| normal[0] * across[k] + normal[1] * down[k]);
        let length = libm::sqrtf(dot(along, along));
        if length < 0.5 * change {
            return None;
        }
        let direction = along.map(|v| v / length);
        let profiles = self.pictures.each_ref().map(|rows| {
            let sample = |k: usize| {
                let t = k as f32 - LONGEST as f32;
                dot(rows.between(x as f32 + t * normal[0], y as f32 + t * normal[1]), direction)
            };
            Profile(std::array::from_fn(sample))
        });
        let steepest = profiles[1].steepest(STEP);
        if steepest.abs_diff(LONGEST) > 1 {
            return None;
        }
        let [(width, rise), (own, whole)] = [profiles[0].border(ENLARGED as usize)?, profiles[1].border(1)?];
        (rise >= COUNTERPART * whole).then_some([width, own])
    }
}

/// Colours along a normal, in the direction of the change; the middle is [`LONGEST`].
struct Profile([f32; 2 * LONGEST + 1]);

impl Profile {
    fn slope(&self, k: usize) -> f32 {
        self.0[k + 1] - self.0[k]
    }

    /// The sample after which the profile rises most, at most `away` from the middle.
    fn steepest(&self, away: usize) -> usize {
        let near = LONGEST - away..LONGEST + away;
        near.fold(LONGEST - away, |best, k| if self.slope(k) > self.slope(best) { k } else { best })
    }

    /// The width of the border whose steepest place is at most `away` from the middle, in samples, and its rise;
    /// `None` if the profile does not rise.
    fn border(&self, away: usize) -> Option<(f32, f32)> {
        let steepest = self.steepest(away);
        let least = END * self.slope(steepest);
        if least <= 0.0 {
            return None;
        }
        let end = (steepest..2 * LONGEST).find(|&k| self.slope(k) < least).unwrap_or(2 * LONGEST);
        let start = (0..steepest).rev().find(|&k| self.slope(k) < least).map_or(0, |k| k + 1);
        let (low, rise) = (self.0[start], self.0[end] - self.0[start]);
        let [from, to] = RISE.map(|share| {
            let level = low + share * rise;
            let k = (start..end).find(|&k| self.0[k + 1] >= level).unwrap_or(end - 1);
            k as f32 + (level - self.0[k]) / self.slope(k)
        });
        Some((to - from, rise))
    }
}

/// The largest value at most [`AWAY`] columns and rows away from each, of rows of `width` values.
fn largest_around(values: &[f32], width: usize) -> Vec<f32> {
    let largest = |near: std::ops::Range<usize>, at: &dyn Fn(usize) -> f32| near.map(at).fold(0.0, f32::max);
    let rows = values.len() / width;
    let around = |k: usize, end: usize| k.saturating_sub(AWAY)..(k + AWAY + 1).min(end);
    let mut across = Vec::with_capacity(values.len());
    for row in values.chunks_exact(width) {
        across.extend((0..width).map(|x| largest(around(x, width), &|u| row[u])));
    }
    let at = |x: usize, y: usize| largest(around(y, rows), &|v| across[v * width + x]);
    (0..rows).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// A disc of radius 20 in the middle of a picture of 64 × 64, whose rim is `width` pixels wide.
    fn disc(scale: u32, width: f64) -> RgbImage {
        let place = |v: u32| (f64::from(v) + 0.5) / f64::from(scale) - 32.0;
        RgbImage::from_fn(64 * scale, 64 * scale, |x, y| {
            let outside = libm::hypot(place(x), place(y)) - 20.0;
            let share = (0.5 - outside / width.max(1.0 / f64::from(scale))).clamp(0.0, 1.0);
            Rgb([50.0, 90.0, 40.0].map(|v| libm::round(v + share * 120.0) as u8))
        })
    }

    #[test]
    fn a_crisp_rim_is_spurious_where_the_exemplar_is_out_of_focus() {
        let of = |exemplar: f64, result: f64| contours(&disc(1, exemplar), &disc(4, result), &()).unwrap();
        let rim = std::f64::consts::TAU * 20.0 / (64.0 * 64.0);
        let crisp = of(14.0, 0.0);
        // A band 1 px wide along the rim, wider where it runs aslant.
        assert!(crisp.spurious > 0.8 * rim && crisp.spurious < 2.0 * rim, "{crisp:?} {rim}");
        // The same rims, soft and crisp, and a rim that is a little steeper.
        for [exemplar, result] in [[5.0, 5.0], [0.0, 0.0], [1.5, 0.0], [5.0, 4.0]] {
            let found = of(exemplar, result);
            assert_eq!(found.spurious, 0.0, "{exemplar} {result} {found:?}");
            assert!(found.share > 0.8 * rim, "{found:?}");
        }
        // What is blurred changes where the exemplar is even.
        assert!(of(0.0, 5.0).spurious > 0.5 * rim);
    }

    #[test]
    fn widths_are_those_of_the_rims() {
        let of = |exemplar: f64, result: f64| contours(&disc(1, exemplar), &disc(4, result), &()).unwrap();
        for width in [3.0, 5.0] {
            let found = of(width, width);
            // Of a ramp, 10 % to 90 % are four fifths.
            assert!((found.width_result / (0.8 * width) - 1.0).abs() < 0.15, "{found:?}");
            assert!((found.width_exemplar / (0.8 * width) - 1.0).abs() < 0.2, "{found:?}");
        }
        let found = of(4.0, 0.0);
        assert!(found.width_result < 0.5 && found.width_exemplar > 2.6, "{found:?}");
    }

    #[test]
    fn an_even_picture_has_no_contours_and_sizes_must_fit() {
        let even = RgbImage::from_pixel(40, 32, Rgb([90, 120, 60]));
        let large = RgbImage::from_pixel(160, 128, Rgb([90, 120, 60]));
        assert_eq!(contours(&even, &large, &()).unwrap(), Contours::default());
        let error = contours(&even, &even, &()).unwrap_err();
        assert!(error.to_string().contains("160 x 128"), "{error}");
    }
}
