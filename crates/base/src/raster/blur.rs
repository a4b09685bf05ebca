//! Gaussian blur of planes, and pictures made smaller.

use super::colour::{Colour, linear};
use super::continued;
use crate::parallel;
use image::RgbImage;
use std::borrow::Cow;
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

/// The half of a symmetric kernel that gives the same as `half` where values repeat after `period`, reaching no
/// further than the period does.
fn folded(half: &[f32], period: usize) -> Cow<'_, [f32]> {
    if 2 * (half.len() - 1) < period {
        return Cow::Borrowed(half);
    }
    let mut folded = vec![0.0; period / 2 + 1];
    for (i, weight) in half.iter().enumerate() {
        let i = i % period;
        folded[i.min(period - i)] += weight;
    }
    // The two sides meet at the centre.
    folded[0] += folded[0] - half[0];
    Cow::Owned(folded)
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
    // After how many columns and rows the image, mirrored or not, begins again.
    let sides = [width, height];
    let period: [usize; 2] =
        std::array::from_fn(|axis| if wrap[axis] { sides[axis] } else { 2 * sides[axis] });
    let half = period.map(|period| folded(half, period));
    let radius = half.each_ref().map(|half| half.len() - 1);
    // The column or row that is `i` steps after the one a radius before the first.
    let source = |axis: usize, i: usize| {
        let first = [columns, rows][axis].start;
        continued((first + i) as i64 - radius[axis] as i64, sides[axis], wrap[axis])
    };
    let wide = columns.len();
    let mut across = vec![[0.0; N]; wide * (rows.len() + 2 * radius[1])];
    parallel::for_chunks(&mut across, wide, |j, row| {
        let y = source(1, j);
        let padded: Vec<[f32; N]> = (0..wide + 2 * radius[0]).map(|i| at(source(0, i), y)).collect();
        for (x, value) in row.iter_mut().enumerate() {
            let centre = x + radius[0];
            *value = padded[centre].map(|v| v * half[0][0]);
            for (k, w) in half[0].iter().enumerate().skip(1) {
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
        for (value, p) in row.iter_mut().zip(line(y + radius[1])) {
            *value = p.map(|v| v * half[1][0]);
        }
        for (k, w) in half[1].iter().enumerate().skip(1) {
            let (above, below) = (line(y + radius[1] - k), line(y + radius[1] + k));
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

    #[test]
    fn a_blur_wider_than_the_picture_is_that_of_its_repetitions() {
        let value = |x: usize, y: usize| ((x * 7 + y * 13) % 11) as f32;
        for (size, wrap) in [([5, 3], [true, true]), ([4, 6], [true, false]), ([1, 2], [false, false])] {
            let plane = |size: [usize; 2]| {
                let values = (0..size[0] * size[1]).map(|i| value(i % size[0], i / size[0]));
                Plane { size, values: values.collect() }
            };
            let small = plane(size);
            // The same picture, repeated so often that the kernel is shorter than it.
            let sides: [usize; 2] = std::array::from_fn(|axis| size[axis] * 24);
            let mirrored = |i: usize, axis: usize| match i % (2 * size[axis]) {
                i if wrap[axis] => i % size[axis],
                i => i.min(2 * size[axis] - 1 - i),
            };
            let at = |i: usize| small.at(mirrored(i % sides[0], 0), mirrored(i / sides[0], 1));
            let large = Plane { size: sides, values: (0..sides[0] * sides[1]).map(at).collect() };
            for sigma in [0.4, 1.5, 4.0] {
                let (soft, expected) = (small.blurred(sigma, wrap), large.blurred(sigma, [true; 2]));
                for i in 0..size[0] * size[1] {
                    let (x, y) = (i % size[0], i / size[0]);
                    assert!((soft.at(x, y) - expected.at(x, y)).abs() < 1e-4, "{size:?} {wrap:?} {sigma}");
                }
            }
        }
    }
}
