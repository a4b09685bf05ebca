//! Gaussian blur of planes, and pictures made smaller.

use super::colour::{Colour, linear};
use crate::parallel;
use image::RgbImage;
use std::ops::Range;

/// A plane of values, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The values.
    pub values: Vec<f32>,
}

impl Plane {
    /// The value nearest to a place.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.size[0] + x]
    }

    /// The plane under a Gaussian of deviation `sigma` pixels, mirrored at its borders or continued where
    /// it repeats.
    pub fn blurred(&self, sigma: f32, wrap: [bool; 2]) -> Self {
        let at = |x: usize, y: usize| [self.at(x, y)];
        let part = self.size.map(|length| 0..length);
        let values = convolve(at, self.size, &part, &gaussian(f64::from(sigma)), wrap);
        Self { size: self.size, values: values.into_flattened() }
    }
}

/// Half-open ranges of columns and rows.
pub type Part = [Range<usize>; 2];

/// One half of a normalised Gaussian kernel, centre first, truncated at four standard deviations. `sigma` in
/// pixels; 0 gives a kernel that changes nothing.
pub fn gaussian(sigma: f64) -> Vec<f32> {
    let radius = libm::round(4.0 * sigma.max(0.0)) as usize;
    let weight = |i: usize| if i == 0 { 1.0 } else { libm::exp(-0.5 * (i * i) as f64 / (sigma * sigma)) };
    let total: f64 = (0..=radius).map(|i| weight(i) * if i == 0 { 1.0 } else { 2.0 }).sum();
    (0..=radius).map(|i| (weight(i) / total) as f32).collect()
}

/// Separable convolution of part of an image, of the colours `at(x, y)`, with half a symmetric kernel. Borders of
/// the image are mirrored at the pixel edges, or the image repeats along the axes of `wrap`.
pub fn convolve<const N: usize>(
    at: impl Fn(usize, usize) -> [f32; N] + Sync,
    [width, height]: [usize; 2],
    [columns, rows]: &Part,
    half: &[f32],
    wrap: [bool; 2],
) -> Vec<[f32; N]> {
    if columns.is_empty() || rows.is_empty() {
        return Vec::new();
    }
    let radius = half.len() - 1;
    // The column or row that is `i` steps after the one `radius` before the first.
    let source = |first: usize, i: usize, n: usize, wrap: bool| -> usize {
        let period = if wrap { n } else { 2 * n } as isize;
        let i = (first as isize + i as isize - radius as isize).rem_euclid(period);
        (if i < n as isize { i } else { period - 1 - i }) as usize
    };
    let wide = columns.len();
    let mut across = vec![[0.0; N]; wide * (rows.len() + 2 * radius)];
    parallel::for_chunks(&mut across, wide, |j, row| {
        let y = source(rows.start, j, height, wrap[1]);
        let padded: Vec<[f32; N]> =
            (0..wide + 2 * radius).map(|i| at(source(columns.start, i, width, wrap[0]), y)).collect();
        for (x, value) in row.iter_mut().enumerate() {
            let centre = x + radius;
            *value = padded[centre].map(|v| v * half[0]);
            for (k, w) in half.iter().enumerate().skip(1) {
                let (a, b) = (padded[centre - k], padded[centre + k]);
                for c in 0..N {
                    value[c] += w * (a[c] + b[c]);
                }
            }
        }
    });
    let mut out = vec![[0.0; N]; wide * rows.len()];
    parallel::for_chunks(&mut out, wide, |y, row| {
        let line = |j: usize| &across[j * wide..][..wide];
        for (value, p) in row.iter_mut().zip(line(y + radius)) {
            *value = p.map(|v| v * half[0]);
        }
        for (k, w) in half.iter().enumerate().skip(1) {
            let (above, below) = (line(y + radius - k), line(y + radius + k));
            for ((value, a), b) in row.iter_mut().zip(above).zip(below) {
                for c in 0..N {
                    value[c] += w * (a[c] + b[c]);
                }
            }
        }
    });
    out
}

/// Oklab of a picture, one plane for each component, in blocks of `factor` pixels whose linear light
/// is averaged. Blocks that do not fit are left out.
pub fn oklab_planes(image: &RgbImage, factor: usize) -> [Plane; 3] {
    let size = [image.width() as usize / factor, image.height() as usize / factor];
    let mut colours = vec![[0f32; 3]; size[0] * size[1]];
    parallel::for_chunks(&mut colours, size[0], |y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            if factor == 1 {
                *out = super::colour::oklab(image.get_pixel(x as u32, y as u32).0);
                continue;
            }
            let mut sum = [0f32; 3];
            for v in 0..factor {
                for u in 0..factor {
                    let at = [(x * factor + u) as u32, (y * factor + v) as u32];
                    let rgb = image.get_pixel(at[0], at[1]).0;
                    (0..3).for_each(|c| sum[c] += linear(rgb[c]));
                }
            }
            let mean = sum.map(|v| super::colour::encoded(v / (factor * factor) as f32));
            *out = Colour(mean).to_oklab();
        }
    });
    std::array::from_fn(|c| Plane { size, values: colours.iter().map(|v| v[c]).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_the_mean_and_repeats() {
        let mut plane = Plane { size: [16, 10], values: vec![0.0; 160] };
        plane.values[0] = 1.0;
        for wrap in [[false; 2], [true; 2]] {
            let soft = plane.blurred(1.5, wrap);
            assert!((soft.values.iter().sum::<f32>() - 1.0).abs() < 1e-4);
            assert_eq!(soft.at(15, 9) > 0.01, wrap[0]);
            assert!(soft.at(1, 0) > soft.at(3, 0));
        }
    }
}
