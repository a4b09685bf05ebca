//! Poisson-disk point sets (Bridson 2007) on rectangles and tori.

use super::Stream;

/// A rectangular domain of points. Opposite sides may be joined, which makes it a cylinder or torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Width, in pixels.
    pub width: f64,
    /// Height, in pixels.
    pub height: f64,
    /// Whether the left and right sides are joined.
    pub wrap_x: bool,
    /// Whether the top and bottom sides are joined.
    pub wrap_y: bool,
}

impl Area {
    /// A rectangle whose sides are not joined.
    pub fn plane(width: f64, height: f64) -> Self {
        Self { width, height, wrap_x: false, wrap_y: false }
    }
}

/// A nearly maximal Poisson-disk set: no two points are closer than `radius` pixels, and 30 attempts
/// around each point found no place for another. Points lie in `0..width` × `0..height`. Sampling
/// restarts in every part of the domain that growth did not reach.
pub fn poisson_disk(domain: Area, radius: f64, random: &mut Stream) -> Vec<[f64; 2]> {
    const ATTEMPTS: usize = 30;
    if !(radius > 0.0 && domain.width > 0.0 && domain.height > 0.0) {
        return Vec::new();
    }
    let mut grid = PointGrid::new(domain, radius);
    let mut active: Vec<u32> = Vec::new();
    let cells = grid.columns * grid.rows;
    for start in 0..cells {
        // One attempt in every empty cell fills parts that growth did not reach.
        if grid.cell[start] != EMPTY {
            continue;
        }
        let p = grid.point_in(start, random);
        if !grid.admits(p) {
            continue;
        }
        active.push(grid.insert(p));
        while !active.is_empty() {
            let k = random.index(active.len());
            let centre = grid.points[active[k] as usize];
            let grown = (0..ATTEMPTS).find_map(|_| {
                let angle = random.range(0.0, std::f64::consts::TAU);
                // Uniform over the annulus of radii 1 to 2.
                let r = radius * libm::sqrt(random.range(1.0, 4.0));
                let (s, c) = libm::sincos(angle);
                grid.place([centre[0] + r * c, centre[1] + r * s]).filter(|&p| grid.admits(p))
            });
            match grown {
                Some(p) => active.push(grid.insert(p)),
                None => {
                    active.swap_remove(k);
                }
            }
        }
    }
    grid.points
}

const EMPTY: u32 = u32::MAX;

/// Cells with sides of at most radius / √2, so each holds at most one point.
struct PointGrid {
    domain: Area,
    radius: f64,
    columns: usize,
    rows: usize,
    cell: Vec<u32>,
    points: Vec<[f64; 2]>,
}

impl PointGrid {
    fn new(domain: Area, radius: f64) -> Self {
        let side = radius / std::f64::consts::SQRT_2;
        let columns = (libm::ceil(domain.width / side) as usize).max(1);
        let rows = (libm::ceil(domain.height / side) as usize).max(1);
        Self { domain, radius, columns, rows, cell: vec![EMPTY; columns * rows], points: Vec::new() }
    }

    /// A random point in a cell.
    fn point_in(&self, cell: usize, random: &mut Stream) -> [f64; 2] {
        let (c, r) = ((cell % self.columns) as f64, (cell / self.columns) as f64);
        [
            (c + random.unit()) * self.domain.width / self.columns as f64,
            (r + random.unit()) * self.domain.height / self.rows as f64,
        ]
    }

    /// The point wrapped into the domain; `None` if it lies outside.
    fn place(&self, p: [f64; 2]) -> Option<[f64; 2]> {
        let axis = |v: f64, size: f64, wrap: bool| {
            let v = if wrap { v - size * libm::floor(v / size) } else { v };
            (v >= 0.0 && v < size).then_some(v)
        };
        let d = self.domain;
        Some([axis(p[0], d.width, d.wrap_x)?, axis(p[1], d.height, d.wrap_y)?])
    }

    fn column_row(&self, p: [f64; 2]) -> (usize, usize) {
        let c = (p[0] / self.domain.width * self.columns as f64) as usize;
        let r = (p[1] / self.domain.height * self.rows as f64) as usize;
        (c.min(self.columns - 1), r.min(self.rows - 1))
    }

    fn admits(&self, p: [f64; 2]) -> bool {
        let d = self.domain;
        let (c, r) = self.column_row(p);
        // Cells may be narrower than radius / √2, so the search covers the whole radius.
        let reach_x = libm::ceil(self.radius / (d.width / self.columns as f64)) as i64;
        let reach_y = libm::ceil(self.radius / (d.height / self.rows as f64)) as i64;
        let nearest = |a: f64, b: f64, size: f64, wrap: bool| {
            let gap = (a - b).abs();
            if wrap { gap.min(size - gap) } else { gap }
        };
        let cells = |centre: usize, reach: i64, count: usize, wrap: bool| {
            let (centre, count) = (centre as i64, count as i64);
            let whole = wrap && 2 * reach + 1 >= count;
            let range = if whole { 0..count } else { centre - reach..centre + reach + 1 };
            range.filter_map(move |k| {
                if wrap {
                    Some(k.rem_euclid(count) as usize)
                } else {
                    (0..count).contains(&k).then_some(k as usize)
                }
            })
        };
        for row in cells(r, reach_y, self.rows, d.wrap_y) {
            for column in cells(c, reach_x, self.columns, d.wrap_x) {
                let i = self.cell[row * self.columns + column];
                if i != EMPTY {
                    let q = self.points[i as usize];
                    let dx = nearest(p[0], q[0], d.width, d.wrap_x);
                    let dy = nearest(p[1], q[1], d.height, d.wrap_y);
                    if dx * dx + dy * dy < self.radius * self.radius {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn insert(&mut self, p: [f64; 2]) -> u32 {
        let (c, r) = self.column_row(p);
        let i = self.points.len() as u32;
        self.cell[r * self.columns + c] = i;
        self.points.push(p);
        i
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn apart_and_full(w in 5.0..120.0f64, h in 5.0..90.0f64, r in 2.0..30.0f64,
                          wrap_x: bool, wrap_y: bool, seed: u64) {
            let domain = Area { width: w, height: h, wrap_x, wrap_y };
            let points = poisson_disk(domain, r, &mut stream(seed, "poisson test", 0));
            let distance = |a: [f64; 2], b: [f64; 2]| {
                let gap = |d: f64, size: f64, wrap: bool| if wrap { d.abs().min(size - d.abs()) } else { d.abs() };
                libm::hypot(gap(a[0] - b[0], w, wrap_x), gap(a[1] - b[1], h, wrap_y))
            };
            for (i, &p) in points.iter().enumerate() {
                prop_assert!(p[0] >= 0.0 && p[0] < w && p[1] >= 0.0 && p[1] < h);
                for &q in &points[..i] {
                    prop_assert!(distance(p, q) >= r * (1.0 - 1e-9));
                }
            }
            // Nearly every position is within two radii of a point, most within one.
            let mut random = stream(seed, "poisson probe", 0);
            for _ in 0..200 {
                let probe = [random.range(0.0, w), random.range(0.0, h)];
                prop_assert!(points.iter().any(|&p| distance(p, probe) < 2.0 * r));
            }
        }
    }
}
