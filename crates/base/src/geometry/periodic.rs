//! Coordinates on a plane that may repeat: wrapping, shortest offsets, and a spatial index of points.
//!
//! The index is a grid of buckets. On 1000 to 100 000 points a kd-tree (kiddo 5.3) answers queries by radius
//! as fast, takes 4 to 12 times as long to build, and needs copies of all points along seams.

use super::{Point, Vec2};

/// A coordinate wrapped to `0..period`; unchanged if `period` is `None`.
pub fn wrapped(v: f64, period: Option<f64>) -> f64 {
    let Some(period) = period else { return v };
    let v = v.rem_euclid(period);
    // A small negative number may round up to the period itself.
    if v < period { v } else { 0.0 }
}

/// Offset from a point to the nearest copy of another. `periods` are the plane's periods along x and
/// y, `None` where it does not repeat.
pub fn shortest_offset(from: Point, to: Point, periods: [Option<f64>; 2]) -> Vec2 {
    let along = |v: f64, period: Option<f64>| period.map_or(v, |p| v - libm::round(v / p) * p);
    Vec2::new(along(to.x - from.x, periods[0]), along(to.y - from.y, periods[1]))
}

/// A spatial index of points: a uniform grid, periodic where the plane is.
#[derive(Clone, Debug)]
pub struct NearPoints {
    /// Width and height of a cell, and number of columns and rows.
    side: [f64; 2],
    count: [i64; 2],
    origin: [f64; 2],
    periodic: [bool; 2],
    /// Indices of the points sorted by cell, and where each cell begins.
    order: Vec<u32>,
    starts: Vec<u32>,
}

impl NearPoints {
    /// Largest number of cells along an axis.
    const MOST: f64 = 2048.0;

    /// Indexes finite points for queries within `reach` (above 0, in the units of the points). `periods`
    /// are the plane's periods along x and y, `None` where it does not repeat.
    pub fn new(points: &[Point], periods: [Option<f64>; 2], reach: f64) -> Self {
        let axis = |period: Option<f64>, at: &dyn Fn(&Point) -> f64| {
            let low = points.iter().map(at).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
            let (origin, length) = match period {
                Some(period) => (0.0, period),
                None if points.is_empty() => (0.0, reach),
                None => (low, (high - low).max(reach)),
            };
            let count = libm::floor(length / reach).clamp(1.0, Self::MOST);
            (origin, length / count, count as i64)
        };
        let [x, y] = [axis(periods[0], &|p| p.x), axis(periods[1], &|p| p.y)];
        let mut near = Self {
            side: [x.1, y.1],
            count: [x.2, y.2],
            origin: [x.0, y.0],
            periodic: periods.map(|p| p.is_some()),
            order: vec![0; points.len()],
            starts: vec![0; (x.2 * y.2) as usize + 1],
        };
        let cells: Vec<usize> = points.iter().map(|p| near.index(near.cell(*p))).collect();
        cells.iter().for_each(|&cell| near.starts[cell + 1] += 1);
        (1..near.starts.len()).for_each(|c| near.starts[c] += near.starts[c - 1]);
        let mut next = near.starts.clone();
        for (i, cell) in cells.into_iter().enumerate() {
            near.order[next[cell] as usize] = i as u32;
            next[cell] += 1;
        }
        near
    }

    /// Calls `f` with the indices of all points within `reach` of `at`, and of some further away. Each
    /// is given once, in a deterministic order.
    pub fn each(&self, at: Point, mut f: impl FnMut(usize)) {
        self.each_while(at, |i| {
            f(i);
            true
        });
    }

    /// As [`Self::each`], until `f` is false.
    pub fn each_while(&self, at: Point, mut f: impl FnMut(usize) -> bool) {
        let [x, y] = self.cell(at);
        for row in self.around(y, 1) {
            for column in self.around(x, 0) {
                let cell = self.index([column, row]);
                let (first, end) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
                if !self.order[first..end].iter().all(|&i| f(i as usize)) {
                    return;
                }
            }
        }
    }

    /// Column and row of a point, clamped to the grid.
    fn cell(&self, p: Point) -> [i64; 2] {
        let along = |v: f64, k: usize| {
            let cell = libm::floor((v - self.origin[k]) / self.side[k]) as i64;
            if self.periodic[k] { cell.rem_euclid(self.count[k]) } else { cell.clamp(0, self.count[k] - 1) }
        };
        [along(p.x, 0), along(p.y, 1)]
    }

    fn index(&self, [column, row]: [i64; 2]) -> usize {
        (row * self.count[0] + column) as usize
    }

    /// A column or row and its neighbours, each once.
    fn around(&self, cell: i64, axis: usize) -> impl Iterator<Item = i64> {
        let count = self.count[axis];
        let (first, end) = if self.periodic[axis] {
            (cell - 1, cell - 1 + count.min(3))
        } else {
            ((cell - 1).max(0), (cell + 2).min(count))
        };
        (first..end).map(move |c| c.rem_euclid(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wrapped_coordinates_lie_within_the_period() {
        for v in [-1e-20, -0.0, 400.0, -400.0, 799.99, 1e9 + 0.1] {
            let found = wrapped(v, Some(400.0));
            assert!((0.0..400.0).contains(&found), "{v}: {found}");
        }
        assert_eq!((wrapped(-7.5, None), wrapped(-7.5, Some(10.0))), (-7.5, 2.5));
    }

    proptest! {
        #[test]
        fn all_that_is_near_is_found_once(
            at in prop::collection::vec((-30.0..630.0f64, -30.0..290.0f64), 0..60),
            repeats in (any::<bool>(), any::<bool>()),
            reach in 5.0..900.0f64,
        ) {
            let points: Vec<Point> = at.iter().map(|&p| p.into()).collect();
            let periods = [repeats.0.then_some(600.0), repeats.1.then_some(260.0)];
            let near = NearPoints::new(&points, periods, reach);
            for &p in &points {
                let mut found = Vec::new();
                near.each(p, |i| found.push(i));
                let wanted = (0..points.len()).filter(|&i| {
                    let Vec2 { x, y } = shortest_offset(p, points[i], periods);
                    libm::hypot(x, y) < reach
                });
                prop_assert!(wanted.clone().all(|i| found.contains(&i)));
                found.sort_unstable();
                prop_assert!(found.windows(2).all(|w| w[0] < w[1]));
            }
        }
    }
}
