//! Fréchet distance between distributions of dense filter responses: like FID, but with
//! hand-designed filters in place of a network.

use super::patches::Channels;
use super::plane::{Plane, dot};
use crate::parallel;
use std::f64::consts::FRAC_PI_4;

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
    let (a, b) = (responses(a), responses(b));
    let units: Vec<f64> = a.iter().map(|p| FLOOR + libm::sqrt(moments(p).1)).collect();
    let (a, b) = (Gaussian::fit(&a, &units), Gaussian::fit(&b, &units));
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
fn responses(lab: &Channels) -> Vec<Plane> {
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
    let inner = |p: Plane| p.crop(BORDER, BORDER, p.width - 2 * BORDER, p.height - 2 * BORDER);
    all.into_iter().map(inner).collect()
}

/// Mean and variance.
fn moments(plane: &Plane) -> (f64, f64) {
    let count = plane.data.len() as f64;
    let values = || plane.data.iter().map(|v| f64::from(*v));
    let mean = values().sum::<f64>() / count;
    (mean, values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count)
}

struct Gaussian {
    mean: Vec<f64>,
    covariance: Symmetric,
}

impl Gaussian {
    /// Fits a Gaussian to responses, each divided by its unit.
    fn fit(responses: &[Plane], units: &[f64]) -> Self {
        let mean: Vec<f64> = responses.iter().map(|p| moments(p).0).collect();
        let centred: Vec<Vec<f32>> = responses
            .iter()
            .zip(mean.iter().zip(units))
            .map(|(p, (m, u))| p.data.iter().map(|v| ((f64::from(*v) - m) / u) as f32).collect())
            .collect();
        // Summing in short pieces limits rounding errors.
        let product = |a: &[f32], b: &[f32]| -> f64 {
            a.chunks(1024).zip(b.chunks(1024)).map(|(a, b)| f64::from(dot(a, b))).sum()
        };
        let count = (responses[0].data.len() as f64 - 1.0).max(1.0);
        let size = responses.len();
        let rows: Vec<usize> = (0..size).collect();
        let half = parallel::map(&rows, |&i| -> Vec<f64> {
            (0..=i).map(|j| product(&centred[i], &centred[j]) / count).collect()
        });
        let ridge = |i: usize, j: usize| if i == j { RIDGE } else { 0.0 };
        let covariance = Symmetric::new(size, |i, j| half[i.max(j)][i.min(j)] + ridge(i, j));
        Self { mean: mean.iter().zip(units).map(|(m, u)| m / u).collect(), covariance }
    }
}

/// A small square matrix, mostly symmetric.
#[derive(Clone, Debug)]
struct Symmetric {
    size: usize,
    data: Vec<f64>,
}

impl Symmetric {
    fn new(size: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        Self { size, data: (0..size * size).map(|k| value(k / size, k % size)).collect() }
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.data[i * self.size + j]
    }

    fn trace(&self) -> f64 {
        (0..self.size).map(|i| self.at(i, i)).sum()
    }

    fn product(&self, other: &Self) -> Self {
        Self::new(self.size, |i, j| (0..self.size).map(|k| self.at(i, k) * other.at(k, j)).sum())
    }

    /// Square root of a symmetric positive semidefinite matrix. Negative eigenvalues from rounding count
    /// as 0.
    fn square_root(&self) -> Self {
        let (values, vectors) = self.eigen();
        let roots: Vec<f64> = values.iter().map(|v| libm::sqrt(v.max(0.0))).collect();
        Self::new(self.size, |i, j| {
            (0..self.size).map(|k| vectors.at(i, k) * roots[k] * vectors.at(j, k)).sum()
        })
    }

    /// Eigenvalues, and eigenvectors as columns, by Jacobi rotations (Jacobi 1846).
    fn eigen(&self) -> (Vec<f64>, Self) {
        const SWEEPS: usize = 60;
        let size = self.size;
        let mut a = self.clone();
        let mut vectors = Self::new(size, |i, j| f64::from(u8::from(i == j)));
        let enough = 1e-28 * self.data.iter().map(|v| v * v).sum::<f64>();
        for _ in 0..SWEEPS {
            let off: f64 = (0..size)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| a.at(i, j) * a.at(i, j))
                .sum();
            if off <= enough {
                break;
            }
            for p in 0..size {
                for q in p + 1..size {
                    a.rotate(p, q, &mut vectors);
                }
            }
        }
        ((0..size).map(|i| a.at(i, i)).collect(), vectors)
    }

    /// Rotates axes `p` and `q` so that their off-diagonal element vanishes.
    fn rotate(&mut self, p: usize, q: usize, vectors: &mut Self) {
        let between = self.at(p, q);
        if between == 0.0 {
            return;
        }
        let theta = (self.at(q, q) - self.at(p, p)) / (2.0 * between);
        let t = theta.signum() / (theta.abs() + libm::sqrt(theta * theta + 1.0));
        let cos = 1.0 / libm::sqrt(t * t + 1.0);
        let sin = t * cos;
        let n = self.size;
        for k in 0..n {
            let (x, y) = (self.at(k, p), self.at(k, q));
            (self.data[k * n + p], self.data[k * n + q]) = (cos * x - sin * y, sin * x + cos * y);
        }
        for k in 0..n {
            let (x, y) = (self.at(p, k), self.at(q, k));
            (self.data[p * n + k], self.data[q * n + k]) = (cos * x - sin * y, sin * x + cos * y);
            let (x, y) = (vectors.at(k, p), vectors.at(k, q));
            (vectors.data[k * n + p], vectors.data[k * n + q]) = (cos * x - sin * y, sin * x + cos * y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    #[test]
    fn roots_squared_are_the_matrix() {
        let mut random = stream(1, "filter bank test", 0);
        let any: Vec<f64> = (0..24 * 24).map(|_| random.normal()).collect();
        let matrix = Symmetric::new(24, |i, j| (0..24).map(|k| any[i * 24 + k] * any[j * 24 + k]).sum());
        let root = matrix.square_root();
        let again = root.product(&root);
        assert!(again.data.iter().zip(&matrix.data).all(|(a, b)| (a - b).abs() < 1e-9));
        let flat = Symmetric::new(3, |_, _| 2.0);
        assert!((flat.square_root().trace() - libm::sqrt(6.0)).abs() < 1e-9);
    }

    #[test]
    fn alike_is_near_and_brighter_is_further() {
        let mut random = stream(2, "filter bank test", 0);
        let noise: Vec<f32> = (0..80 * 70).map(|_| random.unit() as f32).collect();
        let lab = |by: f32| {
            let plane = Plane { width: 80, height: 70, data: noise.iter().map(|v| v * 0.2 + by).collect() };
            [plane.clone(), plane.clone(), plane]
        };
        assert!(frechet(&lab(0.3), &lab(0.3)) < 1e-9);
        assert!(frechet(&lab(0.3), &lab(0.35)) > 0.01);
        assert!(frechet(&lab(0.3), &lab(0.5)) > frechet(&lab(0.3), &lab(0.35)));
    }
}
