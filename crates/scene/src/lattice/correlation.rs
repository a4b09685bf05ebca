//! Autocorrelation of planes.

use rustfft::FftDirection;
use rustfft::num_complex::Complex;
use vtex_base::fourier::Spectrum;
use vtex_base::raster::blur::Plane;

/// Longest lag, as a share of the side.
const FARTHEST: f64 = 0.75;
/// Longest lag of which means are taken, as a share of the side.
const NEAR: f64 = 0.6;

/// Correlation of a picture with itself, by lag.
pub(super) struct Autocorrelation {
    /// Longest lag along each axis, in pixels.
    reach: [i32; 2],
    /// Longest lag along each axis at which enough of the picture overlaps for means, in pixels.
    pub(super) near: [f64; 2],
    /// Longest lag along each axis of peaks, in pixels.
    farthest_peak: [i32; 2],
    /// Rows from lag 0 down, columns from the longest lag to the left on.
    values: Vec<f32>,
}

impl Autocorrelation {
    /// Correlates one or two planes with themselves; the values of two are added.
    pub(super) fn new(one: &Plane, other: Option<&Plane>) -> Self {
        let size = one.size;
        let reach = size.map(|v| (v as f64 * FARTHEST) as i32);
        let near = size.map(|v| NEAR * v as f64);
        let overlap = |d: i32, k: usize| f64::from(size[k] as i32 - d.abs());
        let padded = [0, 1].map(|k| fast_size(size[k] + reach[k] as usize));
        let found = Circular::new(one, other, padded);
        let row = |y: i32| {
            let sums = found.row(y, -reach[0]).zip(-reach[0]..=reach[0]);
            sums.map(move |(sum, x)| sum / (overlap(x, 0) * overlap(y, 1)))
        };
        let means: Vec<f64> = (0..=reach[1]).flat_map(row).collect();
        Self { reach, near, farthest_peak: near.map(|v| v as i32), values: as_shares(&means, reach) }
    }

    /// Correlates planes of one period, as if each were repeated `copies` times along both axes. Peaks are sought up to
    /// half a period: farther ones are the same again.
    pub(super) fn of_period(one: &Plane, other: Option<&Plane>, copies: f64) -> Self {
        let reach = one.size.map(|v| (copies * v as f64 * FARTHEST) as i32);
        let near = one.size.map(|v| copies * v as f64 * NEAR);
        let found = Circular::new(one, other, one.size);
        let row = |y: i32| found.row(y, -reach[0]).take(2 * reach[0] as usize + 1);
        let sums: Vec<f64> = (0..=reach[1]).flat_map(row).collect();
        Self { reach, near, farthest_peak: one.size.map(|v| v as i32 / 2), values: as_shares(&sums, reach) }
    }

    /// Correlation at a lag; `None` out of reach.
    pub(super) fn at(&self, [x, y]: [i32; 2]) -> Option<f64> {
        let [x, y] = if y < 0 { [-x, -y] } else { [x, y] };
        let inside = x.abs() <= self.reach[0] && y <= self.reach[1];
        let row = 2 * self.reach[0] + 1;
        inside.then(|| f64::from(self.values[(y * row + x + self.reach[0]) as usize]))
    }

    /// Lags and heights of the peaks in a half plane, those longer than `least`: no value within three pixels is higher.
    pub(super) fn peaks(&self, least: f64) -> Vec<([f64; 2], f64)> {
        let [rx, ry] = self.farthest_peak;
        let lags = (0..=ry).flat_map(|y| (-rx..=rx).map(move |x| [x, y]));
        let is_long =
            |&[x, y]: &[i32; 2]| (y > 0 || x > 0) && libm::hypot(f64::from(x), f64::from(y)) >= least;
        let peak = |[x, y]: [i32; 2]| {
            let height = self.at([x, y]).filter(|&height| height > 0.0)?;
            let mut around = (-3..=3).flat_map(|v| (-3..=3).map(move |u| [x + u, y + v]));
            let is_highest = around.all(|at| self.at(at).is_none_or(|value| value <= height));
            is_highest.then(|| self.peak_near([x, y].map(f64::from), 1)).flatten()
        };
        lags.filter(is_long).filter_map(peak).collect()
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

/// For each lag the sum of the products of the pixels that are so far apart, in planes that repeat.
struct Circular {
    size: [usize; 2],
    sums: Vec<f64>,
}

impl Circular {
    /// Correlates one or two planes, which are empty up to `size` and repeat from there.
    fn new(one: &Plane, other: Option<&Plane>, size: [usize; 2]) -> Self {
        let mut spectrum = Spectrum::new(size[0], size[1], |_, _| 0.0);
        for y in 0..one.size[1] {
            for x in 0..one.size[0] {
                // Two real planes in one complex one: the real part of its correlation is the sum of theirs.
                let value =
                    Complex::new(f64::from(one.at(x, y)), other.map_or(0.0, |o| f64::from(o.at(x, y))));
                spectrum.data[y * size[0] + x] = value;
            }
        }
        let mut spectrum = spectrum.transformed(FftDirection::Forward);
        spectrum.data.iter_mut().for_each(|v| *v = Complex::new(v.norm_sqr(), 0.0));
        let found = spectrum.transformed(FftDirection::Inverse);
        Self { size, sums: found.data.iter().map(|v| v.re).collect() }
    }

    /// Sums at the lags `y` and, one after another, from `first`, endlessly.
    fn row(&self, y: i32, first: i32) -> impl Iterator<Item = f64> {
        let [y, first] = [(y, 1), (first, 0)].map(|(v, k)| v.rem_euclid(self.size[k] as i32) as usize);
        self.sums[y * self.size[0]..][..self.size[0]].iter().copied().cycle().skip(first)
    }
}

/// Values by lag, from the longest to the left on, as shares of that at lag 0.
fn as_shares(values: &[f64], reach: [i32; 2]) -> Vec<f32> {
    let unit = values[reach[0] as usize].max(f64::MIN_POSITIVE);
    values.iter().map(|value| (value / unit) as f32).collect()
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
