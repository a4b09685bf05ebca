//! Fréchet distance between distributions of dense filter responses: like FID, but with
//! hand-designed filters in place of a network.

use super::patches::Channels;
use super::plane::{Channel, dot};
use std::f64::consts::FRAC_PI_4;
use vtex_base::parallel;
use vtex_base::symmetric::Symmetric;

/// Width of the strip along the border that is left out, in pixels.
const BORDER: usize = 8;
/// Lower bound of the standard deviations that responses are divided by, in hundredths of Lab.
const FLOOR: f64 = 0.01;
/// Added to variances to keep covariance matrices well conditioned.
const RIDGE: f64 = 1e-4;

/// Fréchet distance between Gaussians fitted to the filter responses. Responses are divided by the
/// standard deviations of the first picture's, and the result by the number of filters. `a` and `b`
/// are Lab divided by 100.
pub(super) fn frechet(a: &Channels, b: &Channels) -> f64 {
    // One after the other: the responses of a picture take 24 times its memory.
    let first = responses(a);
    let units: Vec<f64> = first.iter().map(|p| FLOOR + libm::sqrt(moments(p).1)).collect();
    let a = ResponseGaussian::fit(first, &units);
    let b = ResponseGaussian::fit(responses(b), &units);
    let size = units.len();
    let between: f64 = (0..size).map(|i| (a.mean[i] - b.mean[i]) * (a.mean[i] - b.mean[i])).sum();
    // tr √(AB) = tr √(√A B √A), whose argument is symmetric.
    let root = a.covariance.square_root();
    let mixed = root.product(&b.covariance).product(&root);
    let trace = a.covariance.trace() + b.covariance.trace() - 2.0 * mixed.square_root().trace();
    (between + trace).max(0.0) / size as f64
}

/// Filter responses at three scales: colours; and of lightness its gradients, blobs, and edge strength
/// by direction.
fn responses(lab: &Channels) -> Vec<Channel> {
    let light = &lab[0];
    let mut all = Vec::new();
    for sigma in [1.0, 2.0, 4.0] {
        all.extend(lab.iter().map(|p| p.smooth(sigma)));
    }
    for sigma in [1.0, 2.0, 4.0] {
        let (x, y) = (light.derivative(sigma, [1, 0]), light.derivative(sigma, [0, 1]));
        all.push(x.zip(&y, |x, y| (x * x + y * y).sqrt() * sigma as f32));
    }
    for sigma in [1.0, 2.0, 4.0, 8.0] {
        let (x, y) = (light.derivative(sigma, [2, 0]), light.derivative(sigma, [0, 2]));
        all.push(x.zip(&y, |x, y| (x + y) * (sigma * sigma) as f32));
    }
    for sigma in [1.5, 3.5] {
        let (x, y) = (light.derivative(sigma, [1, 0]), light.derivative(sigma, [0, 1]));
        for turn in 0..4 {
            let angle = f64::from(turn) * FRAC_PI_4;
            let (cos, sin) = ((libm::cos(angle) * sigma) as f32, (libm::sin(angle) * sigma) as f32);
            all.push(x.zip(&y, |x, y| (x * cos + y * sin).abs()).smooth(2.0 * sigma));
        }
    }
    let inner = |p: Channel| p.crop(BORDER, BORDER, p.width - 2 * BORDER, p.height - 2 * BORDER);
    all.into_iter().map(inner).collect()
}

/// Mean and variance.
fn moments(plane: &Channel) -> (f64, f64) {
    let count = plane.data.len() as f64;
    let values = || plane.data.iter().map(|v| f64::from(*v));
    let mean = values().sum::<f64>() / count;
    (mean, values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count)
}

struct ResponseGaussian {
    mean: Vec<f64>,
    covariance: Symmetric,
}

impl ResponseGaussian {
    /// Fits a Gaussian to responses, each divided by its unit.
    fn fit(responses: Vec<Channel>, units: &[f64]) -> Self {
        let mean: Vec<f64> = responses.iter().map(|p| moments(p).0).collect();
        let mut centred: Vec<Vec<f32>> = responses.into_iter().map(|p| p.data).collect();
        for (data, (m, u)) in centred.iter_mut().zip(mean.iter().zip(units)) {
            data.iter_mut().for_each(|v| *v = ((f64::from(*v) - m) / u) as f32);
        }
        // Summing in short pieces limits rounding errors.
        let product = |a: &[f32], b: &[f32]| -> f64 {
            a.chunks(1024).zip(b.chunks(1024)).map(|(a, b)| f64::from(dot(a, b))).sum()
        };
        let count = (centred[0].len() as f64 - 1.0).max(1.0);
        let size = centred.len();
        let rows: Vec<usize> = (0..size).collect();
        let half = parallel::map(&rows, |&i| -> Vec<f64> {
            (0..=i).map(|j| product(&centred[i], &centred[j]) / count).collect()
        });
        let ridge = |i: usize, j: usize| if i == j { RIDGE } else { 0.0 };
        let covariance = Symmetric::new(size, |i, j| half[i.max(j)][i.min(j)] + ridge(i, j));
        Self { mean: mean.iter().zip(units).map(|(m, u)| m / u).collect(), covariance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    #[test]
    fn alike_is_near_and_brighter_is_further() {
        let mut random = stream(2, "filter bank test", 0);
        let noise: Vec<f32> = (0..80 * 70).map(|_| random.unit() as f32).collect();
        let lab = |by: f32| {
            let plane = Channel { width: 80, height: 70, data: noise.iter().map(|v| v * 0.2 + by).collect() };
            [plane.clone(), plane.clone(), plane]
        };
        assert!(frechet(&lab(0.3), &lab(0.3)) < 1e-9);
        assert!(frechet(&lab(0.3), &lab(0.35)) > 0.01);
        assert!(frechet(&lab(0.3), &lab(0.5)) > frechet(&lab(0.3), &lab(0.35)));
    }
}
