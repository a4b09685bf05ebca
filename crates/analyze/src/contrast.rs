//! The stretch of contrast before the analysis of a subtle picture.
//!
//! Masks, patches and shading have thresholds in steps of colour, below which nothing is seen. A tile in grey on grey
//! has 6 to 60 steps of lightness in all. Its colours are therefore stretched first, all components alike, about the
//! middle of each, and the colours of the library are brought back by the inverse map. Solid paints, gradients and
//! translucent ones are mixtures of colours, which an affine map keeps.
//!
//! Only structure is stretched. Noise, such as that of a dark photograph, is not alike a few pixels away, and its mean
//! along a line falls with the root of the length. Structure is alike some pixels away, or runs in lines.
//!
//! Works badly where noise itself is correlated, as after a strong compression.

use super::AnalyzeParams;
use image::{Rgb, RgbImage};
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::{Contrast, Library, Stretch};

/// Range of lightness that a subtle picture is stretched to, in 8-bit steps.
const RANGE: f64 = 170.0;
/// Range of lightness from which a picture is ordinary: between the quantiles of [`TAILS`], in 8-bit steps.
const ORDINARY: [f64; 2] = [60.0, 100.0];
/// Share of the darkest and of the lightest pixels that ranges leave out. The first is that of the stretch.
const TAILS: [f64; 2] = [0.005, 0.001];
/// Half the side of the square whose mean is taken off before structure is measured, in pixels: a slow change of
/// light is no structure.
const SLOW: usize = 24;
/// Distances at which the correlation is measured, in pixels: beyond noise that neighbouring pixels share.
const LAGS: [i32; 2] = [3, 8];
/// Least correlation of structure with itself, of either sign.
const ALIKE: f64 = 0.2;
/// Length of the lines along which means are taken, in pixels.
const LINE: usize = 9;
/// Least range of these means, in ranges that noise would have.
const LINES: f64 = 1.75;
/// Range of Gaussian noise between the quantiles of [`TAILS`], in standard deviations.
const RANGE_OF_NOISE: f64 = 5.15;

/// The stretch of a photograph; `None` where there is none. The photograph is `repeated` if it is made of copies of
/// a tile, whose structure recurs.
pub(super) fn stretch(image: &RgbImage, repeated: bool, params: &AnalyzeParams) -> Option<Stretch> {
    let gain = match params.contrast {
        Contrast::Auto => measured(image, repeated),
        Contrast::Gain(gain) => gain,
    };
    let range = |c: usize| ends(&histogram(image.pixels().map(|p| p.0[c])), TAILS[0]);
    (gain > 1.0).then(|| Stretch::new([0, 1, 2].map(range), gain))
}

/// A stretched photograph. Components beyond 0 to 255 are clamped.
pub(super) fn stretched(image: &RgbImage, stretch: &Stretch) -> RgbImage {
    let table: Vec<[u8; 3]> =
        (0..=255).map(|v| Colour::from_f64(stretch.applied([f64::from(v); 3])).0).collect();
    let mut stretched = image.clone();
    for pixel in stretched.pixels_mut() {
        *pixel = Rgb([0, 1, 2].map(|c| table[usize::from(pixel.0[c])][c]));
    }
    stretched
}

/// The library of a stretched photograph in the colours of the photograph itself.
pub(super) fn undone(library: Library, stretch: &Stretch) -> Library {
    let mut library = library.recoloured(|c| stretch.undone(c), 1.0 / stretch.gain());
    library.source.contrast = stretch.gain();
    library
}

/// The gain that a picture needs: 1 for an ordinary one.
fn measured(image: &RgbImage, repeated: bool) -> f64 {
    let light = |p: &Rgb<u8>| {
        let [r, g, b] = p.0.map(u32::from);
        ((2126 * r + 7152 * g + 722 * b + 5000) / 10_000) as u8
    };
    let histogram = histogram(image.pixels().map(light));
    let range = |tail: f64| {
        let [low, high] = ends(&histogram, tail);
        high - low
    };
    if TAILS.iter().zip(ORDINARY).any(|(&tail, ordinary)| range(tail) >= ordinary) {
        return 1.0;
    }
    let gain = (RANGE / range(TAILS[0]).max(1.0)).min(AnalyzeParams::CONTRAST.range[1]);
    let size = [image.width(), image.height()].map(|side| side as usize);
    let has_structure =
        || Plane { size, values: image.pixels().map(|p| f32::from(light(p))).collect() }.is_structured();
    if repeated || has_structure() { gain } else { 1.0 }
}

fn histogram(values: impl Iterator<Item = u8>) -> [u64; 256] {
    let mut counts = [0; 256];
    values.for_each(|v| counts[usize::from(v)] += 1);
    counts
}

/// The values that a share of all lies below, and above.
fn ends(histogram: &[u64; 256], tail: f64) -> [f64; 2] {
    let least = tail * histogram.iter().sum::<u64>() as f64;
    let mut below = 0;
    let mut reaches = |v: &usize| {
        below += histogram[*v];
        below as f64 > least
    };
    let low = (0..256).find(&mut reaches).unwrap_or(0);
    let mut above = 0;
    let mut reaches = |v: &usize| {
        above += histogram[*v];
        above as f64 > least
    };
    let high = (0..256).rev().find(&mut reaches).unwrap_or(255);
    [low as f64, high as f64]
}

/// A plane of lightness, row by row.
struct Plane {
    size: [usize; 2],
    values: Vec<f32>,
}

impl Plane {
    /// Whether there is more than noise.
    fn is_structured(&self) -> bool {
        let plane = self.without_slow_changes();
        plane.correlation() >= ALIKE || plane.lines() >= LINES
    }

    /// Each value less the mean around it.
    fn without_slow_changes(&self) -> Self {
        let [w, h] = self.size;
        let mut sums = vec![0.0; (w + 1) * (h + 1)];
        for y in 0..h {
            let mut row = 0.0;
            for x in 0..w {
                row += f64::from(self.values[y * w + x]);
                sums[(y + 1) * (w + 1) + x + 1] = sums[y * (w + 1) + x + 1] + row;
            }
        }
        let around = |v: usize, side: usize| [v.saturating_sub(SLOW), (v + SLOW + 1).min(side)];
        let mut values = self.values.clone();
        parallel::for_chunks(&mut values, w, |y, row| {
            let [y0, y1] = around(y, h).map(|y| y * (w + 1));
            for (x, value) in row.iter_mut().enumerate() {
                let [x0, x1] = around(x, w);
                let sum = sums[y1 + x1] - sums[y1 + x0] - sums[y0 + x1] + sums[y0 + x0];
                *value -= (sum / ((y1 - y0) / (w + 1) * (x1 - x0)) as f64) as f32;
            }
        });
        Self { size: self.size, values }
    }

    fn variance(&self) -> f64 {
        let sum: f64 = self.values.iter().map(|v| f64::from(v * v)).sum();
        (sum / self.values.len() as f64).max(1e-9)
    }

    /// Largest correlation with itself a few pixels away, of either sign.
    fn correlation(&self) -> f64 {
        let [least, most] = LAGS;
        let lags = (0..=most).flat_map(|y| (-most..=most).map(move |x| [x, y]));
        let far = |[x, y]: &[i32; 2]| (least * least..=most * most).contains(&(x * x + y * y));
        let lags: Vec<[i32; 2]> = lags.filter(far).filter(|[x, y]| *y > 0 || *x > 0).collect();
        let all = parallel::map(&lags, |&lag| self.covariance(lag).abs());
        all.into_iter().fold(0.0, f64::max) / self.variance()
    }

    fn covariance(&self, [dx, dy]: [i32; 2]) -> f64 {
        let [w, h] = self.size;
        let (shift, dy) = (dx.unsigned_abs() as usize, dy as usize);
        if shift >= w || dy >= h {
            return 0.0;
        }
        let row = |y: usize| &self.values[y * w..(y + 1) * w];
        let product = |y: usize| {
            let (one, other) = if dx < 0 { (row(y + dy), row(y)) } else { (row(y), row(y + dy)) };
            one[..w - shift].iter().zip(&other[shift..]).map(|(a, b)| f64::from(a * b)).sum::<f64>()
        };
        (0..h - dy).map(product).sum::<f64>() / ((w - shift) * (h - dy)) as f64
    }

    /// Largest range of means along lines of one direction, in ranges that noise of the same deviation has.
    fn lines(&self) -> f64 {
        let noise = RANGE_OF_NOISE * libm::sqrt(self.variance() / LINE as f64);
        let ranges = parallel::map(&[[1, 0], [0, 1], [1, 1], [-1, 1]], |&way| self.range_of_means(way));
        ranges.into_iter().fold(0.0, f64::max) / noise
    }

    fn range_of_means(&self, [dx, dy]: [isize; 2]) -> f64 {
        let [w, h] = self.size;
        let [across, down] = [dx, dy].map(|d| if d == 0 { 0 } else { LINE - 1 });
        if across >= w || down >= h {
            return 0.0;
        }
        let first = if dx < 0 { LINE - 1 } else { 0 };
        let step = dy * w as isize + dx;
        let mean = |x: usize, y: usize| {
            let at = (y * w + x + first) as isize;
            (0..LINE as isize).map(|k| self.values[(at + k * step) as usize]).sum::<f32>() / LINE as f32
        };
        let mut means: Vec<f32> = (0..h - down)
            .flat_map(|y| (0..w - across).map(move |x| [x, y]))
            .map(|[x, y]| mean(x, y))
            .collect();
        let tail = (TAILS[0] * means.len() as f64) as usize;
        let last = means.len() - 1 - tail;
        let mut quantile = |k: usize| f64::from(*means.select_nth_unstable_by(k, f32::total_cmp).1);
        quantile(last) - quantile(tail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    /// Values of a structure with noise of a deviation, in steps.
    fn noisy(middle: f64, deviation: f64) -> impl FnMut(f64) -> u8 {
        let mut random = stream(1, "testing/contrast", 0);
        move |structure: f64| libm::round(middle + structure + random.normal() * deviation) as u8
    }

    fn picture(side: u32, mut value: impl FnMut(u32, u32) -> u8) -> RgbImage {
        RgbImage::from_fn(side, side, |x, y| Rgb([value(x, y); 3]))
    }

    /// 1 on bricks, 0 on joints.
    fn bricks(x: u32, y: u32) -> f64 {
        f64::from(u8::from(y % 12 > 1 && (x + y / 12 * 11) % 22 > 1))
    }

    #[test]
    fn only_subtle_structure_is_stretched() {
        let gain = |image: RgbImage| measured(&image, false);
        let with = |middle, deviation, of_bricks: f64| {
            let mut value = noisy(middle, deviation);
            gain(picture(200, |x, y| value(of_bricks * bricks(x, y))))
        };
        assert_eq!(with(120.0, 4.0, 70.0), 1.0, "an ordinary picture");
        assert!(with(230.0, 0.5, 8.0) == 10.0, "subtle bricks");
        assert!((5.0..9.0).contains(&with(30.0, 2.0, 14.0)), "bricks in the dark");
        for deviation in [0.4, 1.0, 4.0, 8.0] {
            assert_eq!(with(30.0, deviation, 0.0), 1.0, "noise of {deviation}");
        }
        // A slow change of light is no structure of the noise on it.
        let mut value = noisy(30.0, 2.0);
        assert_eq!(gain(picture(200, |x, y| value(f64::from(x + y) / 20.0))), 1.0);
        // Thin lines are too few for a correlation.
        let mut value = noisy(40.0, 2.0);
        let lines = picture(300, |x, y| value(if x % 47 == 0 || y % 61 == 0 { 8.0 } else { 0.0 }));
        assert!(gain(lines) > 5.0);
    }

    #[test]
    fn colours_come_back() {
        let image = RgbImage::from_fn(80, 80, |x, y| {
            let on = bricks(x, y);
            Rgb([200.0 + 9.0 * on, 180.0 + 8.0 * on, 250.0 + 4.0 * on].map(|v| v as u8))
        });
        for contrast in [Contrast::Auto, Contrast::Gain(4.0)] {
            let params = AnalyzeParams { contrast, ..AnalyzeParams::default() };
            let stretch = stretch(&image, false, &params).unwrap();
            let whole = stretched(&image, &stretch);
            let range = |c: usize| {
                let values = whole.pixels().map(|p| p.0[c]);
                i32::from(values.clone().max().unwrap()) - i32::from(values.min().unwrap())
            };
            assert_eq!([0, 1, 2].map(range), [9, 8, 4].map(|v| (f64::from(v) * stretch.gain()) as i32));
            for (own, there) in image.pixels().zip(whole.pixels()) {
                let back = stretch.undone(there.0.map(f64::from));
                assert!((0..3).all(|c| (back[c] - f64::from(own.0[c])).abs() < 0.5), "{back:?} {own:?}");
            }
        }
        let off = AnalyzeParams { contrast: Contrast::OFF, ..AnalyzeParams::default() };
        assert!(stretch(&image, false, &off).is_none());
    }
}
