//! One channel of a picture as 32-bit floats, with the linear filters that the measures use.

use image::RgbImage;
use vtex_base::parallel;
use vtex_base::raster::continued;

/// One channel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) data: Vec<f32>,
}

impl Channel {
    /// A plane whose values are `value(x, y)`.
    pub(super) fn from_fn(width: usize, height: usize, value: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        let mut data = vec![0.0; width * height];
        let value = &value;
        parallel::for_chunks(&mut data, width.max(1), |y, row| {
            row.iter_mut().enumerate().for_each(|(x, v)| *v = value(x, y));
        });
        Self { width, height, data }
    }

    /// Luma of an image by BT.601, 0 to 1.
    pub(super) fn grey(image: &RgbImage) -> Self {
        let data = image.pixels().map(|p| {
            let [r, g, b] = p.0.map(|v| f32::from(v) / 255.0);
            0.299 * r + 0.587 * g + 0.114 * b
        });
        Self { width: image.width() as usize, height: image.height() as usize, data: data.collect() }
    }

    /// L, a and b of CIE Lab (D65, 2°), each divided by 100.
    pub(super) fn lab(image: &RgbImage) -> [Self; 3] {
        let to_lab = super::colour::LabTable::new();
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut planes = [0, 1, 2].map(|_| vec![0.0; width * height]);
        for (i, pixel) in image.pixels().enumerate() {
            let lab = to_lab.of(pixel.0);
            (0..3).for_each(|c| planes[c][i] = lab[c] / 100.0);
        }
        planes.map(|data| Self { width, height, data })
    }

    pub(super) fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        self.data[y * self.width + x]
    }

    /// Applies a function to every value.
    pub(super) fn map(mut self, f: impl Fn(f32) -> f32) -> Self {
        self.data.iter_mut().for_each(|v| *v = f(*v));
        self
    }

    /// Combines the values of two planes of the same size.
    pub(super) fn zip(&self, other: &Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let data = self.data.iter().zip(&other.data).map(|(a, b)| f(*a, *b)).collect();
        Self { width: self.width, height: self.height, data }
    }

    /// The rectangle with its upper left corner at (`x`, `y`).
    pub(super) fn crop(&self, x: usize, y: usize, width: usize, height: usize) -> Self {
        let rows = (y..y + height).flat_map(|y| self.row(y)[x..x + width].iter().copied());
        Self { width, height, data: rows.collect() }
    }

    /// Subsamples: every `step`-th column and row, starting at 0.
    pub(super) fn every(&self, step: usize) -> Self {
        let rows = (0..self.height).step_by(step).flat_map(|y| self.row(y).iter().step_by(step).copied());
        let (width, height) = (self.width.div_ceil(step), self.height.div_ceil(step));
        Self { width, height, data: rows.collect() }
    }

    /// Smooths by a Gaussian of standard deviation `sigma` in pixels; unchanged for 0.
    pub(super) fn smooth(&self, sigma: f64) -> Self {
        if sigma == 0.0 { self.clone() } else { self.derivative(sigma, [0, 0]) }
    }

    /// Gaussian derivative of orders `x` and `y` (0 to 2) at standard deviation `sigma` in pixels.
    pub(super) fn derivative(&self, sigma: f64, [x, y]: [u8; 2]) -> Self {
        self.correlate(&gaussian(sigma, x), &gaussian(sigma, y))
    }

    /// Separable correlation with two kernels. The plane is mirrored at its borders.
    pub(super) fn correlate(&self, along_x: &[f32], along_y: &[f32]) -> Self {
        self.vertical(along_y).horizontal(along_x)
    }

    fn vertical(&self, weights: &[f32]) -> Self {
        let mut out = Self { data: vec![0.0; self.data.len()], ..*self };
        parallel::for_chunks(&mut out.data, self.width, |y, row| {
            for (k, weight) in weights.iter().enumerate() {
                let from = mirrored(y as isize + k as isize - (weights.len() / 2) as isize, self.height);
                row.iter_mut().zip(self.row(from)).for_each(|(o, v)| *o += weight * v);
            }
        });
        out
    }

    fn horizontal(&self, weights: &[f32]) -> Self {
        let radius = (weights.len() / 2) as isize;
        let mut out = Self { data: vec![0.0; self.data.len()], ..*self };
        parallel::for_chunks(&mut out.data, self.width, |y, row| {
            let from = self.row(y);
            let extended: Vec<f32> =
                (-radius..self.width as isize + radius).map(|x| from[mirrored(x, self.width)]).collect();
            for (k, weight) in weights.iter().enumerate() {
                row.iter_mut().zip(&extended[k..]).for_each(|(o, v)| *o += weight * v);
            }
        });
        out
    }

    /// Resizes by linear interpolation; the centres of the corner pixels are kept.
    pub(super) fn resized(&self, width: usize, height: usize) -> Self {
        let places = |from: usize, to: usize| -> Vec<(usize, usize, f64)> {
            let step = if to > 1 { (from - 1) as f64 / (to - 1) as f64 } else { 0.0 };
            let place = |i: usize| {
                let at = (step * i as f64).min((from - 1) as f64);
                (at as usize, (at as usize + 1).min(from - 1), at - libm::floor(at))
            };
            (0..to).map(place).collect()
        };
        let (xs, ys) = (places(self.width, width), places(self.height, height));
        Self::from_fn(width, height, |x, y| {
            let ((x0, x1, u), (y0, y1, v)) = (xs[x], ys[y]);
            let line = |y| (1.0 - u) * f64::from(self.at(x0, y)) + u * f64::from(self.at(x1, y));
            ((1.0 - v) * line(y0) + v * line(y1)) as f32
        })
    }
}

/// Index into `0..n` of the sample at `i`, mirrored at the ends with the end samples repeated.
fn mirrored(i: isize, n: usize) -> usize {
    continued(i as i64, n, false)
}

/// A sampled Gaussian, or its first or second derivative, truncated at four standard deviations.
pub(super) fn gaussian(sigma: f64, order: u8) -> Vec<f32> {
    let radius = (4.0 * sigma + 0.5) as i32;
    let square = sigma * sigma;
    let bell = |x: i32| libm::exp(-0.5 * f64::from(x * x) / square);
    let sum: f64 = (-radius..=radius).map(bell).sum();
    let factor = |x: f64| match order {
        0 => 1.0,
        1 => x / square,
        _ => (x * x / square - 1.0) / square,
    };
    (-radius..=radius).map(|x| (factor(f64::from(x)) * bell(x) / sum) as f32).collect()
}

/// Scalar product, summed in the same order on every machine.
#[inline]
pub(super) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0f32; 8];
    let ((left, left_rest), (right, right_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let rest: f32 = left_rest.iter().zip(right_rest).map(|(x, y)| x * y).sum();
    for (x, y) in left.iter().zip(right) {
        (0..8).for_each(|k| lanes[k] += x[k] * y[k]);
    }
    lanes.iter().sum::<f32>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_mirrored() {
        let found: Vec<usize> = (-5..8).map(|i| mirrored(i, 3)).collect();
        assert_eq!(found, [1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
    }

    #[test]
    fn derivatives_of_a_slope_and_of_a_bowl() {
        let slope = Channel::from_fn(60, 50, |x, y| x as f32 * 0.5 - y as f32 * 0.25);
        let middle = |p: Channel| p.at(30, 25);
        assert!((middle(slope.derivative(2.0, [1, 0])) - 0.5).abs() < 1e-3);
        assert!((middle(slope.derivative(2.0, [0, 1])) + 0.25).abs() < 1e-3);
        assert!((middle(slope.smooth(2.0)) - slope.at(30, 25)).abs() < 1e-3);
        let bowl = Channel::from_fn(60, 50, |x, _| (x * x) as f32 * 0.01);
        assert!((middle(bowl.derivative(2.0, [2, 0])) - 0.02).abs() < 1e-3);
    }

    #[test]
    fn resizing_keeps_corners_and_slopes() {
        let slope = Channel::from_fn(9, 7, |x, y| (x + 2 * y) as f32);
        for (w, h) in [(17, 13), (5, 4), (9, 7), (1, 1)] {
            let found = slope.resized(w, h);
            let last = if w > 1 { 8.0 + 12.0 } else { 0.0 };
            assert_eq!((found.at(0, 0), found.at(w - 1, h - 1)), (0.0, last));
        }
        assert_eq!(slope.resized(17, 13).at(8, 6), slope.at(4, 3));
    }

    #[test]
    fn products_are_sums_of_products() {
        let values: Vec<f32> = (0..21).map(|v| v as f32).collect();
        assert_eq!(dot(&values, &values), 2870.0);
    }
}
