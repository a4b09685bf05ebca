//! Gaussian blur of planes, and pictures made smaller.

use super::colour::{Colour, linear};
use crate::parallel;
use image::RgbImage;

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
        if sigma < 0.2 {
            return self.clone();
        }
        let reach = libm::ceilf(3.0 * sigma) as i64;
        let weights: Vec<f32> =
            (-reach..=reach).map(|d| libm::expf(-((d * d) as f32) / (2.0 * sigma * sigma))).collect();
        let sum: f32 = weights.iter().sum();
        let weights: Vec<f32> = weights.iter().map(|w| w / sum).collect();
        let [w, h] = self.size;
        let inside = |v: i64, size: usize, wrap: bool| {
            let size = size as i64;
            if wrap {
                return v.rem_euclid(size) as usize;
            }
            let v = v.rem_euclid(2 * size);
            if v < size { v as usize } else { (2 * size - 1 - v) as usize }
        };
        let columns: Vec<usize> = (-reach..w as i64 + reach).map(|x| inside(x, w, wrap[0])).collect();
        let mut across = vec![0f32; w * h];
        parallel::for_chunks(&mut across, w, |y, out| {
            let row = &self.values[y * w..][..w];
            let long: Vec<f32> = columns.iter().map(|&x| row[x]).collect();
            for (x, out) in out.iter_mut().enumerate() {
                *out = long[x..].iter().zip(&weights).map(|(v, w)| v * w).sum();
            }
        });
        let mut values = vec![0f32; w * h];
        parallel::for_chunks(&mut values, w, |y, out| {
            for (k, weight) in weights.iter().enumerate() {
                let from = inside(y as i64 + k as i64 - reach, h, wrap[1]);
                let row = &across[from * w..][..w];
                out.iter_mut().zip(row).for_each(|(out, v)| *out += weight * v);
            }
        });
        Self { size: self.size, values }
    }
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
