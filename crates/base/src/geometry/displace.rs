//! Displacements of points by least squares, so that the ways between pairs of them become those wanted.
//!
//! The unknowns are displacements, so a plane that repeats needs no care. The normal equations are solved by conjugate
//! gradients with the diagonal as preconditioner.

use super::plane::PeriodicPlane;
use crate::error::Result;

/// Most steps of the solver, and the residual that ends it, as a share of the first.
const STEPS: usize = 40;
const RESIDUAL: f64 = 1e-3;
/// Weight of staying, as a share of a point's own equations: without it the whole may drift.
const STAY: f64 = 1e-3;

/// Pairs of points, and by how much the way from the first to the second is to change, listed by the first point.
#[derive(Debug)]
pub struct WantedWays {
    /// The pairs of point i are `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    others: Vec<u32>,
    right: Vec<[f64; 2]>,
    degree: Vec<f64>,
    /// Number of points, the first ones, that stay.
    fixed: usize,
}

impl WantedWays {
    /// No pair of `count` points yet.
    pub fn new(count: usize) -> Self {
        let starts = Vec::with_capacity(count + 1);
        Self { starts, others: Vec::new(), right: vec![[0.0; 2]; count], degree: vec![0.0; count], fixed: 0 }
    }

    /// The same pairs, with the first `count` points fixed in their places.
    pub fn with_fixed(self, count: usize) -> Self {
        Self { fixed: count, ..self }
    }

    /// Begins the list of the next point.
    pub fn next_point(&mut self) {
        self.starts.push(self.others.len());
    }

    /// Adds a pair of the point begun last. `change` is the way wanted minus the way there is.
    pub fn add(&mut self, other: u32, change: [f64; 2]) {
        let (point, to) = (self.starts.len() - 1, other as usize);
        self.others.push(other);
        self.degree[point] += 1.0;
        self.degree[to] += 1.0;
        for i in 0..2 {
            self.right[to][i] += change[i];
            self.right[point][i] -= change[i];
        }
    }

    /// Moves the points of a plane by [`Self::displacements`], but for those that are fixed.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub fn move_points(
        self,
        points: &mut [[f64; 2]],
        plane: PeriodicPlane,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        let fixed = self.fixed;
        for (p, by) in points.iter_mut().zip(self.displacements(go_on)?).skip(fixed) {
            *p = plane.wrapped([p[0] + by[0], p[1] + by[1]]);
        }
        Ok(())
    }

    fn others(&self, point: usize) -> &[u32] {
        let end = self.starts.get(point + 1).copied().unwrap_or(self.others.len());
        &self.others[self.starts[point]..end]
    }

    /// The displacements with the least sum of squared misses. Every point must have been begun.
    ///
    /// # Errors
    /// Those of `go_on`, which is asked before each step.
    fn displacements(self, go_on: &dyn Fn() -> Result<()>) -> Result<Vec<[f64; 2]>> {
        let count = self.degree.len();
        let diagonal: Vec<f64> = self.degree.iter().map(|d| d * (1.0 + STAY) + STAY).collect();
        let product = |of: &[[f64; 2]], to: &mut Vec<[f64; 2]>| {
            for s in 0..count {
                to[s] = [diagonal[s] * of[s][0], diagonal[s] * of[s][1]];
            }
            for s in 0..count {
                let mut own = [0.0; 2];
                for &other in self.others(s) {
                    let other = other as usize;
                    for i in 0..2 {
                        own[i] += of[other][i];
                        to[other][i] -= of[s][i];
                    }
                }
                (0..2).for_each(|i| to[s][i] -= own[i]);
            }
            to[..self.fixed].fill([0.0; 2]);
        };
        let dot = |a: &[[f64; 2]], b: &[[f64; 2]]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum()
        };
        let scaled = |v: &[[f64; 2]]| -> Vec<[f64; 2]> {
            v.iter().zip(&diagonal).map(|(v, d)| [v[0] / d, v[1] / d]).collect()
        };
        let mut moved = vec![[0.0; 2]; count];
        let mut rest = self.right.clone();
        rest[..self.fixed].fill([0.0; 2]);
        let mut direction = scaled(&rest);
        let mut size = dot(&rest, &direction);
        let enough = size * RESIDUAL * RESIDUAL;
        let mut image = vec![[0.0; 2]; count];
        for _ in 0..STEPS {
            if size <= enough || size <= 1e-12 {
                break;
            }
            go_on()?;
            product(&direction, &mut image);
            let step = size / dot(&direction, &image).max(1e-300);
            for s in 0..count {
                for i in 0..2 {
                    moved[s][i] += step * direction[s][i];
                    rest[s][i] -= step * image[s][i];
                }
            }
            let next = scaled(&rest);
            let now = dot(&rest, &next);
            let turn = now / size;
            for s in 0..count {
                (0..2).for_each(|i| direction[s][i] = next[s][i] + turn * direction[s][i]);
            }
            size = now;
        }
        Ok(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_takes_the_ways_wanted_and_stays_in_the_middle() {
        let mut ways = WantedWays::new(5);
        for s in 0..5u32 {
            ways.next_point();
            if s < 4 {
                ways.add(s + 1, [2.0, -1.0]);
            }
        }
        let moved = ways.displacements(&|| Ok(())).unwrap();
        for s in 0..4 {
            let way = [moved[s + 1][0] - moved[s][0], moved[s + 1][1] - moved[s][1]];
            assert!((way[0] - 2.0).abs() < 0.02 && (way[1] + 1.0).abs() < 0.02, "{way:?}");
        }
        let middle: f64 = moved.iter().map(|m| m[0]).sum();
        assert!(middle.abs() < 0.05, "{middle}");
    }

    #[test]
    fn fixed_points_stay_and_others_follow_them() {
        let mut ways = WantedWays::new(4);
        for s in 0..4u32 {
            ways.next_point();
            if s < 3 {
                ways.add(s + 1, [1.0, 0.5]);
            }
        }
        let plane = PeriodicPlane { size: [100.0; 2], wraps: [false; 2] };
        let mut points = [[10.0, 10.0], [20.0, 10.0], [30.0, 10.0], [40.0, 10.0]];
        ways.with_fixed(2).move_points(&mut points, plane, &|| Ok(())).unwrap();
        assert_eq!(points[..2], [[10.0, 10.0], [20.0, 10.0]]);
        for (s, p) in points.iter().enumerate().skip(2) {
            let wanted = [10.0 * (s as f64 + 1.0) + (s as f64 - 1.0), 10.0 + 0.5 * (s as f64 - 1.0)];
            assert!((p[0] - wanted[0]).abs() < 0.02 && (p[1] - wanted[1]).abs() < 0.02, "{p:?} {wanted:?}");
        }
    }
}
