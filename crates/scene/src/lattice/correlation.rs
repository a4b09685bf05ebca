//! Autocorrelation of a picture.

use image::RgbImage;
use rustfft::FftDirection;
use rustfft::num_complex::Complex;
use vtex_base::fourier::Spectrum;
use vtex_base::raster::blur::{Plane, oklab_planes};

/// Deviation of the blur that is subtracted, as a share of the shorter side, so that clouds do not count as
/// periods.
const LARGEST: f32 = 1.0 / 8.0;
/// Deviation of the blur that removes structure smaller than an element, in pixels.
const SMALLEST: f32 = 0.8;
/// Longest lag, as a share of the side.
const FARTHEST: f64 = 0.75;

/// Correlation of a picture with itself, by lag.
pub(super) struct Autocorrelation {
    /// Longest lag along each axis, in pixels.
    pub(super) reach: [i32; 2],
    /// Rows from lag 0 down, columns from the longest lag to the left on.
    values: Vec<f32>,
}

impl Autocorrelation {
    /// Correlates a picture's lightness and the main axis of its chroma, in Oklab.
    pub(super) fn new(image: &RgbImage) -> Self {
        let [l, a, b] = oklab_planes(image, 1);
        let size = l.size;
        let chroma = main_component(&a, &b);
        let sigma = LARGEST * size[0].min(size[1]) as f32;
        let [l, c] = [l, chroma].map(|plane| {
            let (fine, coarse) = (plane.blurred(SMALLEST, [false; 2]), plane.blurred(sigma, [false; 2]));
            let values: Vec<f32> = fine.values.iter().zip(&coarse.values).map(|(f, c)| f - c).collect();
            let mean = values.iter().sum::<f32>() / values.len().max(1) as f32;
            Plane { size, values: values.into_iter().map(|v| v - mean).collect() }
        });
        let reach = size.map(|v| (v as f64 * FARTHEST) as i32);
        let padded = [0, 1].map(|k| fast_size(size[k] + reach[k] as usize));
        let mut spectrum = Spectrum::new(padded[0], padded[1], |_, _| 0.0);
        for y in 0..size[1] {
            for x in 0..size[0] {
                // Two real planes in one complex one: the real part of its correlation is the sum of theirs.
                let value = Complex::new(f64::from(l.at(x, y)), f64::from(c.at(x, y)));
                spectrum.data[y * padded[0] + x] = value;
            }
        }
        let mut spectrum = spectrum.transformed(FftDirection::Forward);
        spectrum.data.iter_mut().for_each(|v| *v = Complex::new(v.norm_sqr(), 0.0));
        let found = spectrum.transformed(FftDirection::Inverse);
        let overlap = |d: i32, k: usize| f64::from(size[k] as i32 - d.abs());
        let value = |x: i32, y: i32| {
            let column = x.rem_euclid(padded[0] as i32) as usize;
            found.data[y as usize * padded[0] + column].re / (overlap(x, 0) * overlap(y, 1))
        };
        let unit = value(0, 0).max(f64::MIN_POSITIVE);
        let lags = (0..=reach[1]).flat_map(|y| (-reach[0]..=reach[0]).map(move |x| (x, y)));
        let values = lags.map(|(x, y)| (value(x, y) / unit) as f32).collect();
        Self { reach, values }
    }

    /// Correlation at a lag; `None` out of reach.
    pub(super) fn at(&self, [x, y]: [i32; 2]) -> Option<f64> {
        let [x, y] = if y < 0 { [-x, -y] } else { [x, y] };
        let inside = x.abs() <= self.reach[0] && y <= self.reach[1];
        let row = 2 * self.reach[0] + 1;
        inside.then(|| f64::from(self.values[(y * row + x + self.reach[0]) as usize]))
    }

    /// Correlation at a place between lags; `None` out of reach.
    pub(super) fn between(&self, at: [f64; 2]) -> Option<f64> {
        let low = at.map(libm::floor);
        let [u, v] = [at[0] - low[0], at[1] - low[1]];
        let [x, y] = low.map(|c| c as i32);
        let row = |y: i32| Some(self.at([x, y])? * (1.0 - u) + self.at([x + 1, y])? * u);
        Some(row(y)? * (1.0 - v) + row(y + 1)? * v)
    }

    /// The highest correlation within `radius` of a lag, and its place to a fraction of a pixel; `None` if
    /// it lies at the edge of the window or out of reach.
    pub(super) fn peak_near(&self, at: [f64; 2], radius: i32) -> Option<([f64; 2], f64)> {
        let middle = at.map(|c| libm::round(c) as i32);
        let window = (-radius..=radius).flat_map(|v| (-radius..=radius).map(move |u| [u, v]));
        let best = window
            .filter_map(|[u, v]| {
                Some(([middle[0] + u, middle[1] + v], self.at([middle[0] + u, middle[1] + v])?))
            })
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        let ([x, y], height) = best;
        let around = |d: [i32; 2]| self.at([x + d[0], y + d[1]]);
        // The vertex of a parabola through three neighbours along each axis.
        let vertex = |low: f64, high: f64| {
            let bend = 2.0 * height - low - high;
            if bend > 1e-9 { ((high - low) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
        };
        let (left, right) = (around([-1, 0])?, around([1, 0])?);
        let (above, below) = (around([0, -1])?, around([0, 1])?);
        if [left, right, above, below].iter().any(|&v| v > height) {
            return None;
        }
        Some(([f64::from(x) + vertex(left, right), f64::from(y) + vertex(above, below)], height))
    }
}

/// The component of two planes along their axis of largest variance.
fn main_component(a: &Plane, b: &Plane) -> Plane {
    let count = a.values.len().max(1) as f32;
    let [ma, mb] = [a, b].map(|p| p.values.iter().sum::<f32>() / count);
    let (mut aa, mut ab, mut bb) = (0f32, 0f32, 0f32);
    for (&u, &v) in a.values.iter().zip(&b.values) {
        let (u, v) = (u - ma, v - mb);
        (aa, ab, bb) = (aa + u * u, ab + u * v, bb + v * v);
    }
    let (sine, cosine) = libm::sincosf(0.5 * libm::atan2f(2.0 * ab, aa - bb));
    let values = a.values.iter().zip(&b.values).map(|(u, v)| cosine * u + sine * v).collect();
    Plane { size: a.size, values }
}

/// The smallest size from `least` on whose only prime factors are 2, 3 and 5, so that its transform is fast.
fn fast_size(least: usize) -> usize {
    let fast = |mut v: usize| {
        for p in [2, 3, 5] {
            while v.is_multiple_of(p) {
                v /= p;
            }
        }
        v == 1
    };
    (least.max(1)..).find(|&v| fast(v)).unwrap_or(least)
}
