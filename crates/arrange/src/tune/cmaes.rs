//! Minimisation without derivatives: covariance matrix adaptation (Hansen, "The CMA Evolution
//! Strategy: A Tutorial", 2016, figure 6), for a handful of dimensions.
//!
//! Points are drawn from a normal distribution whose mean, step size and covariance follow the
//! better half of what was drawn. Crates that do the same bring a linear algebra library and
//! random numbers of their own, with which neither seeds nor bytes are the same everywhere.

use vtex_base::sampling::Stream;
use vtex_base::symmetric::Symmetric;

/// A search; [`CmaEs::ask`] and [`CmaEs::tell`] take turns.
pub(super) struct CmaEs<const N: usize> {
    /// Where the distribution is centred: under noise a better answer than the best point drawn.
    pub(super) mean: [f64; N],
    step: f64,
    covariance: [[f64; N]; N],
    /// Evolution paths of the step size and of the covariance.
    step_path: [f64; N],
    path: [f64; N],
    generation: u32,
    /// Points of a generation.
    population: usize,
    /// Weights of the better half, which add up to 1.
    weights: Vec<f64>,
    rates: Rates,
}

/// Learning rates (tutorial, table 1).
struct Rates {
    effective: f64,
    step_path: f64,
    damping: f64,
    path: f64,
    one: f64,
    many: f64,
}

impl<const N: usize> CmaEs<N> {
    /// Around a point, with a first step size.
    pub(super) fn new(mean: [f64; N], step: f64) -> Self {
        let n = N as f64;
        let population = 4 + (3.0 * libm::log(n)) as usize;
        let half = population / 2;
        let raw = |i: usize| libm::log((population as f64 + 1.0) / 2.0) - libm::log(i as f64 + 1.0);
        let sum: f64 = (0..half).map(raw).sum();
        let weights: Vec<f64> = (0..half).map(|i| raw(i) / sum).collect();
        let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let step_path = (effective + 2.0) / (n + effective + 5.0);
        let one = 2.0 / ((n + 1.3) * (n + 1.3) + effective);
        let many = 2.0 * (effective - 2.0 + 1.0 / effective) / ((n + 2.0) * (n + 2.0) + effective);
        let rates = Rates {
            effective,
            step_path,
            damping: 1.0 + 2.0 * (libm::sqrt((effective - 1.0) / (n + 1.0)) - 1.0).max(0.0) + step_path,
            path: (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n),
            one,
            many: many.min(1.0 - one),
        };
        let mut covariance = [[0.0; N]; N];
        (0..N).for_each(|i| covariance[i][i] = 1.0);
        Self {
            mean,
            step,
            covariance,
            step_path: [0.0; N],
            path: [0.0; N],
            generation: 0,
            population,
            weights,
            rates,
        }
    }

    /// The points of the next generation.
    pub(super) fn ask(&self, random: &mut Stream) -> Vec<[f64; N]> {
        let (axes, lengths) = axes(&self.covariance);
        let point = |_| {
            let z: [f64; N] = std::array::from_fn(|k| lengths[k] * random.normal());
            std::array::from_fn(|i| {
                self.mean[i] + self.step * (0..N).map(|k| axes.at(i, k) * z[k]).sum::<f64>()
            })
        };
        (0..self.population).map(point).collect()
    }

    /// Takes the values of the points that [`CmaEs::ask`] returned; less is better. Ties go to the first, and
    /// NaN is the worst.
    pub(super) fn tell(&mut self, points: &[[f64; N]], values: &[f64]) {
        let mut order: Vec<usize> = (0..points.len().min(values.len())).collect();
        let value = |i: usize| if values[i].is_nan() { f64::INFINITY } else { values[i] };
        order.sort_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
        let n = N as f64;
        let Rates { effective, step_path: cs, damping, path: cc, one: c1, many: cm } = self.rates;
        // Steps of the better half, in units of the step size.
        let steps: Vec<[f64; N]> = order
            .iter()
            .take(self.weights.len())
            .map(|&i| std::array::from_fn(|k| (points[i][k] - self.mean[k]) / self.step))
            .collect();
        let mean_step: [f64; N] =
            std::array::from_fn(|k| self.weights.iter().zip(&steps).map(|(w, s)| w * s[k]).sum());
        for k in 0..N {
            self.mean[k] += self.step * mean_step[k];
        }
        self.generation += 1;

        let white = self.whitened(mean_step);
        let keep = libm::sqrt(cs * (2.0 - cs) * effective);
        for k in 0..N {
            self.step_path[k] = (1.0 - cs) * self.step_path[k] + keep * white[k];
        }
        let length = libm::sqrt(self.step_path.iter().map(|v| v * v).sum());
        // Length of the path if the mean only wandered about.
        let expected = libm::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
        let settled = libm::sqrt(1.0 - libm::pow(1.0 - cs, 2.0 * f64::from(self.generation)));
        // While the step size grows fast the path of the covariance waits.
        let moves = length / settled < (1.4 + 2.0 / (n + 1.0)) * expected;
        let push = if moves { libm::sqrt(cc * (2.0 - cc) * effective) } else { 0.0 };
        for k in 0..N {
            self.path[k] = (1.0 - cc) * self.path[k] + push * mean_step[k];
        }
        let lost = if moves { 0.0 } else { c1 * cc * (2.0 - cc) };
        for i in 0..N {
            for j in 0..N {
                let many: f64 = self.weights.iter().zip(&steps).map(|(w, s)| w * s[i] * s[j]).sum();
                self.covariance[i][j] = (1.0 - c1 - cm + lost) * self.covariance[i][j]
                    + c1 * self.path[i] * self.path[j]
                    + cm * many;
            }
        }
        let growth = (cs / damping * (length / expected - 1.0)).min(1.0);
        self.step = (self.step * libm::exp(growth)).clamp(1e-12, 1e12);
    }

    /// A vector times the inverse root of the covariance.
    fn whitened(&self, v: [f64; N]) -> [f64; N] {
        let (axes, lengths) = axes(&self.covariance);
        let along: [f64; N] =
            std::array::from_fn(|k| (0..N).map(|i| axes.at(i, k) * v[i]).sum::<f64>() / lengths[k]);
        std::array::from_fn(|i| (0..N).map(|k| axes.at(i, k) * along[k]).sum())
    }
}

/// Eigenvectors, in columns, and square roots of the eigenvalues of a covariance, which are kept from
/// vanishing.
fn axes<const N: usize>(covariance: &[[f64; N]; N]) -> (Symmetric, [f64; N]) {
    let (values, axes) = Symmetric::new(N, |i, j| covariance[i][j]).eigen();
    let floor = (values.iter().copied().fold(0.0, f64::max) * 1e-14).max(1e-300);
    (axes, std::array::from_fn(|k| libm::sqrt(values[k].max(floor))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    fn minimum<const N: usize>(start: [f64; N], generations: usize, f: impl Fn([f64; N]) -> f64) -> CmaEs<N> {
        let mut random = stream(1, "cmaes test", 0);
        let mut search = CmaEs::new(start, 0.5);
        for _ in 0..generations {
            let points = search.ask(&mut random);
            let values: Vec<f64> = points.iter().map(|p| f(*p)).collect();
            search.tell(&points, &values);
        }
        search
    }

    #[test]
    fn known_minima_are_found() {
        let sphere = |x: [f64; 4]| x.iter().map(|v| (v - 3.0) * (v - 3.0)).sum();
        let found = minimum([0.0; 4], 150, sphere);
        assert!(found.mean.iter().all(|v| (v - 3.0).abs() < 1e-6), "{:?}", found.mean);
        // Axes of a hundred different lengths, turned: the covariance has to be learnt.
        let turned = |x: [f64; 4]| {
            let y = [x[0] + x[1], x[0] - x[1], x[2] + x[3], x[2] - x[3]];
            (0..4).map(|k| libm::pow(100.0, k as f64) * y[k] * y[k]).sum()
        };
        let found = minimum([1.0, 2.0, -1.0, 0.5], 300, turned);
        assert!(found.mean.iter().all(|v| v.abs() < 1e-5), "{:?}", found.mean);
        let rosenbrock = |x: [f64; 2]| {
            let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
            a * a + 100.0 * b * b
        };
        let found = minimum([-1.0, 1.0], 200, rosenbrock);
        assert!(found.mean.iter().all(|v| (v - 1.0).abs() < 1e-5), "{:?}", found.mean);
    }

    #[test]
    fn noise_and_nonsense_are_survived() {
        let mut noise = stream(2, "cmaes test", 0);
        let values: Vec<f64> = (0..10_000).map(|_| 0.3 * noise.normal()).collect();
        let next = std::cell::Cell::new(0);
        let noisy = |x: [f64; 4]| {
            next.set(next.get() + 1);
            x.iter().map(|v| (v - 1.0) * (v - 1.0)).sum::<f64>() + values[next.get()]
        };
        let found = minimum([0.0; 4], 100, noisy);
        assert!(found.mean.iter().all(|v| (v - 1.0).abs() < 0.6), "{:?}", found.mean);
        for value in [f64::NAN, f64::INFINITY, 0.0] {
            let found = minimum([0.0; 4], 400, |_| value);
            assert!(found.mean.iter().all(|v| v.is_finite()) && found.step.is_finite());
        }
    }
}
