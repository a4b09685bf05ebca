//! The background field: linear radial basis functions through coloured points.
//!
//! The field is the interpolant Σ cᵢ |x - xᵢ| + c₀ (paper §3.2.3). Solving it for all points at
//! once costs the cube of their number, so it is solved in overlapping square patches of some
//! fifty points and the patches are blended by smooth weights that add up to one (partition of
//! unity). Every patch passes through all points that it weighs in on, so the blend does too, and
//! cost and memory grow with the number of points alone.
//!
//! Components are 8-bit sRGB values as floats (0 to 255), because that is the space in which SVG
//! gradients interpolate: what is evaluated here is what is painted.
//!
//! When this works badly: where points are some ten times denser than on average, a patch keeps
//! only a part of them and the field no longer passes through each.

mod dense;

use super::Field;
use crate::parallel;
use std::sync::OnceLock;

/// Points per cell aimed at; a patch covers four cells.
const PER_CELL: f64 = 12.0;
/// Up to this many points one patch holds the whole field.
const WHOLE: usize = 64;
/// Most points solved for in a patch.
const LARGEST_PATCH: usize = 144;
/// A patch of fewer points takes in some from further away.
const SMALLEST_PATCH: usize = 8;
/// Points nearer to each other than this, in pixels, become one.
const MERGE: f64 = 1.0 / 64.0;

/// A field made ready for evaluation.
pub struct Interpolant {
    points: Vec<Site>,
    fallback: [f64; 3],
    grid: Grid,
    /// Points of each cell, sorted by cell; `starts[c]..starts[c + 1]` are those of cell c.
    order: Vec<u32>,
    starts: Vec<u32>,
    /// One patch around each corner of the cells, made when first needed.
    patches: Vec<OnceLock<Patch>>,
}

/// A point and its colour.
#[derive(Clone, Copy)]
struct Site {
    x: f64,
    y: f64,
    colour: [f64; 3],
}

/// Square cells over the domain.
struct Grid {
    x0: f64,
    y0: f64,
    side: f64,
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Column or row of a coordinate and the place within the cell, 0 to 1; what lies outside
    /// belongs to the outermost cells.
    fn axis(&self, offset: f64, count: usize) -> (usize, f64) {
        let v = (offset / self.side).clamp(0.0, count as f64);
        let cell = (v as usize).min(count - 1);
        (cell, v - cell as f64)
    }
}

/// The interpolant of a few points.
struct Patch {
    /// x, y and the coefficients of the three components.
    terms: Vec<[f64; 5]>,
    constant: [f64; 3],
}

impl Patch {
    fn new(sites: &[Site]) -> Self {
        let mean = |k: usize| sites.iter().map(|s| s.colour[k]).sum::<f64>() / sites.len() as f64;
        let mean = [mean(0), mean(1), mean(2)];
        // Unknowns: one coefficient per point and the constant, which makes them add up to zero.
        let n = sites.len() + 1;
        let mut matrix = vec![0.0; n * n];
        let mut right = vec![[0.0; 3]; n];
        for (i, a) in sites.iter().enumerate() {
            for (j, b) in sites.iter().enumerate() {
                matrix[i * n + j] = libm::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
            }
            (matrix[i * n + n - 1], matrix[(n - 1) * n + i]) = (1.0, 1.0);
            right[i] = [0, 1, 2].map(|k| a.colour[k] - mean[k]);
        }
        if sites.len() < 2 || !dense::solve(&mut matrix, &mut right) {
            return Self { terms: Vec::new(), constant: mean };
        }
        let terms = sites.iter().zip(&right).map(|(s, c)| [s.x, s.y, c[0], c[1], c[2]]).collect();
        Self { terms, constant: [0, 1, 2].map(|k| mean[k] + right[n - 1][k]) }
    }

    fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let mut sum = self.constant;
        for t in &self.terms {
            let (dx, dy) = (x - t[0], y - t[1]);
            let r = libm::sqrt(dx * dx + dy * dy);
            for k in 0..3 {
                sum[k] += r * t[2 + k];
            }
        }
        sum
    }
}

impl Interpolant {
    /// Prepares a field for a canvas of the given size, in pixels.
    pub fn new(field: &Field, width: u32, height: u32) -> Self {
        let points = merged(field);
        let grid = cells(&points, field.spacing, width, height);
        // Counting sort into cells.
        let cell = |p: &Site| {
            let (column, _) = grid.axis(p.x - grid.x0, grid.columns);
            let (row, _) = grid.axis(p.y - grid.y0, grid.rows);
            row * grid.columns + column
        };
        let mut starts = vec![0u32; grid.columns * grid.rows + 1];
        for p in &points {
            starts[cell(p) + 1] += 1;
        }
        for c in 1..starts.len() {
            starts[c] += starts[c - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0u32; points.len()];
        for (i, p) in points.iter().enumerate() {
            let slot = &mut next[cell(p)];
            order[*slot as usize] = i as u32;
            *slot += 1;
        }
        let corners = if points.len() <= WHOLE { 1 } else { (grid.columns + 1) * (grid.rows + 1) };
        let patches = (0..corners).map(|_| OnceLock::new()).collect();
        Self { points, fallback: field.fallback.to_f64(), grid, order, starts, patches }
    }

    /// sRGB components (0 to 255, not rounded) at a point of the canvas, in pixels.
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let clamp = |c: [f64; 3]| c.map(|v| v.clamp(0.0, 255.0));
        if self.points.is_empty() {
            return self.fallback;
        }
        if let [whole] = &self.patches[..] {
            return clamp(whole.get_or_init(|| Patch::new(&self.points)).at(x, y));
        }
        let g = &self.grid;
        let (column, u) = g.axis(x - g.x0, g.columns);
        let (row, v) = g.axis(y - g.y0, g.rows);
        // Smooth steps: weights and their slopes are continuous from cell to cell.
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (smooth(u), smooth(v));
        let mut sum = [0.0; 3];
        for (dx, dy, w) in
            [(0, 0, (1.0 - u) * (1.0 - v)), (1, 0, u * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 1, u * v)]
        {
            if w > 0.0 {
                let c = self.patch(column + dx, row + dy).at(x, y);
                for k in 0..3 {
                    sum[k] += w * c[k];
                }
            }
        }
        clamp(sum)
    }

    /// The field at `columns` × `rows` points, row by row: point (i, j) is
    /// (`x0 + i * step`, `y0 + j * step`).
    pub fn grid(&self, x0: f64, y0: f64, step: f64, columns: usize, rows: usize) -> Vec<[f32; 3]> {
        let mut out = vec![[0.0; 3]; columns * rows];
        parallel::for_chunks(&mut out, columns.max(1), |j, row| {
            for (i, value) in row.iter_mut().enumerate() {
                *value = self.at(x0 + i as f64 * step, y0 + j as f64 * step).map(|v| v as f32);
            }
        });
        out
    }

    /// The patch around a corner of the cells.
    fn patch(&self, column: usize, row: usize) -> &Patch {
        self.patches[row * (self.grid.columns + 1) + column].get_or_init(|| {
            // The four cells at the corner, or more where points are few.
            let mut chosen = Vec::new();
            for reach in [1, 2, 4] {
                chosen = self.near(column, row, reach);
                if chosen.len() >= SMALLEST_PATCH {
                    break;
                }
            }
            if chosen.len() < SMALLEST_PATCH {
                // A desert: a coarse selection of all points shows where the field goes.
                chosen.extend(thinned(&self.order, SMALLEST_PATCH * 4));
                chosen.sort_unstable();
                chosen.dedup();
            }
            let sites: Vec<Site> = thinned(&chosen, LARGEST_PATCH).map(|i| self.points[i as usize]).collect();
            Patch::new(&sites)
        })
    }

    /// Points of the cells within `reach` of a corner.
    fn near(&self, column: usize, row: usize, reach: usize) -> Vec<u32> {
        let columns = column.saturating_sub(reach)..(column + reach).min(self.grid.columns);
        let rows = row.saturating_sub(reach)..(row + reach).min(self.grid.rows);
        let mut found = Vec::new();
        for r in rows {
            let first = self.starts[r * self.grid.columns + columns.start] as usize;
            let last = self.starts[r * self.grid.columns + columns.end] as usize;
            found.extend_from_slice(&self.order[first..last]);
        }
        found
    }
}

/// At most `most` of the items, evenly from all of them.
fn thinned(items: &[u32], most: usize) -> impl Iterator<Item = u32> {
    let count = items.len().min(most);
    (0..count).map(move |k| items[k * items.len() / count])
}

/// The points in order of place, those at one place made one of their mean colour.
fn merged(field: &Field) -> Vec<Site> {
    let key = |v: f64| libm::floor(v / MERGE) as i64;
    let mut sites: Vec<((i64, i64), Site)> = field
        .points
        .iter()
        .filter(|p| p.x.abs() < 1e9 && p.y.abs() < 1e9)
        .map(|p| ((key(p.y), key(p.x)), Site { x: p.x, y: p.y, colour: p.colour.to_f64() }))
        .collect();
    sites.sort_by_key(|s| s.0);
    let one = |group: &[((i64, i64), Site)]| {
        let mean = |k: usize| group.iter().map(|s| s.1.colour[k]).sum::<f64>() / group.len() as f64;
        Site { colour: [mean(0), mean(1), mean(2)], ..group[0].1 }
    };
    sites.chunk_by(|a, b| a.0 == b.0).map(one).collect()
}

/// Cells over the canvas and the points not far from it, each with [`PER_CELL`] points on average.
fn cells(points: &[Site], spacing: f64, width: u32, height: u32) -> Grid {
    let margin = 4.0 * if spacing > 0.0 { spacing.min(1e6) } else { 0.0 };
    let axis = |coordinate: &dyn Fn(&Site) -> f64, size: u32| {
        let (mut low, mut high) = (0.0, f64::from(size.max(1)));
        for p in points {
            let v = coordinate(p).clamp(-margin, f64::from(size) + margin);
            (low, high) = (v.min(low), v.max(high));
        }
        (low, high - low)
    };
    let (x0, w) = axis(&|p| p.x, width);
    let (y0, h) = axis(&|p| p.y, height);
    let side = libm::sqrt(w * h * PER_CELL / points.len().max(1) as f64);
    let count = |size: f64| (libm::ceil(size / side) as usize).max(1);
    Grid { x0, y0, side, columns: count(w), rows: count(h) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::colour::Colour;
    use crate::sampling::{Area, poisson_disk, stream};
    use crate::scene::ControlPoint;

    fn field(width: f64, height: f64, spacing: f64, seed: u64) -> Field {
        let mut random = stream(seed, "field test", 0);
        let places = poisson_disk(Area::plane(width, height), spacing, &mut random);
        let mut colour = || Colour([0; 3].map(|_| random.below(256) as u8));
        let points = places.iter().map(|p| ControlPoint { x: p[0], y: p[1], colour: colour() }).collect();
        Field { spacing, fallback: Colour([9, 8, 7]), points }
    }

    #[test]
    fn passes_through_every_point() {
        for (w, h) in [(500, 400), (3, 2000), (60, 60)] {
            let f = field(f64::from(w), f64::from(h), 12.0, 1);
            let i = Interpolant::new(&f, w, h);
            for p in &f.points {
                let (got, want) = (i.at(p.x, p.y), p.colour.to_f64());
                assert!((0..3).all(|k| (got[k] - want[k]).abs() < 1e-6), "{got:?} {want:?}");
            }
        }
    }

    #[test]
    fn a_constant_field_is_constant() {
        let mut f = field(400.0, 300.0, 10.0, 2);
        f.points.iter_mut().for_each(|p| p.colour = Colour([10, 200, 77]));
        let i = Interpolant::new(&f, 400, 300);
        for value in i.grid(-20.0, -20.0, 7.3, 60, 50) {
            assert_eq!(value, [10.0, 200.0, 77.0]);
        }
    }

    #[test]
    fn close_to_the_solution_for_all_points_at_once() {
        let f = field(300.0, 300.0, 14.0, 3);
        let sites = merged(&f);
        assert!(sites.len() > 3 * WHOLE);
        let (whole, blend) = (Patch::new(&sites), Interpolant::new(&f, 300, 300));
        let (mut sum, mut count) = (0.0, 0.0);
        for k in 0..2500 {
            let (x, y) = (25.0 + 5.0 * f64::from(k % 50), 25.0 + 5.0 * f64::from(k / 50));
            let (a, b) = (whole.at(x, y), blend.at(x, y));
            for c in 0..3 {
                let difference = (a[c].clamp(0.0, 255.0) - b[c]).abs();
                assert!(difference < 12.0, "{x} {y}: {difference}");
                sum += difference;
                count += 1.0;
            }
        }
        assert!(sum / count < 1.0, "{}", sum / count);
    }

    #[test]
    fn smooth_from_patch_to_patch() {
        let f = field(400.0, 400.0, 15.0, 4);
        let i = Interpolant::new(&f, 400, 400);
        let g = &i.grid;
        for border in 1..g.columns {
            let x = g.x0 + border as f64 * g.side;
            for k in 0..80 {
                let y = 5.0 * f64::from(k);
                let at = |dx: f64| i.at(x + dx, y)[0];
                assert!((at(1e-6) - at(-1e-6)).abs() < 1e-3);
                let (left, right) = ((at(-1e-4) - at(-2e-4)) / 1e-4, (at(2e-4) - at(1e-4)) / 1e-4);
                let near = f.points.iter().any(|p| libm::hypot(p.x - x, p.y - y) < 0.5);
                assert!(near || (left - right).abs() < 0.1, "{left} {right}");
            }
        }
    }

    #[test]
    fn few_and_hostile_points() {
        let none = Field { spacing: 25.0, fallback: Colour([9, 8, 7]), points: Vec::new() };
        assert_eq!(Interpolant::new(&none, 10, 10).at(5.0, 5.0), [9.0, 8.0, 7.0]);
        let one = |x: f64, y: f64, v: u8| ControlPoint { x, y, colour: Colour([v; 3]) };
        let at = |points: Vec<ControlPoint>, x: f64, y: f64| {
            Interpolant::new(&Field { points, ..none.clone() }, 100_000, 100_000).at(x, y)
        };
        assert_eq!(at(vec![one(3.0, 4.0, 50)], 1.0, 1.0), [50.0; 3]);
        assert_eq!(at(vec![one(3.0, 4.0, 50), one(3.0, 4.0, 70)], 1.0, 1.0), [60.0; 3]);
        assert_eq!(at(vec![one(3.0, 4.0, 50); 1_000_000], 99_999.0, 1.0), [50.0; 3]);
        let mut crowd: Vec<_> = (0..200_000u32)
            .map(|k| one(f64::from(k % 400) * 0.1, f64::from(k / 400) * 0.1, (k % 251) as u8))
            .collect();
        crowd.push(one(9e6, -9e6, 0));
        for (x, y) in [(20.0, 20.0), (70_000.0, 100.0), (99_000.0, 99_000.0)] {
            assert!(at(crowd.clone(), x, y).iter().all(|v| (0.0..=255.0).contains(v)));
        }
    }

    #[cfg(feature = "parallel")]
    #[test]
    fn same_on_any_number_of_threads() {
        let f = field(300.0, 300.0, 9.0, 5);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Interpolant::new(&f, 300, 300).grid(0.0, 0.0, 3.0, 100, 100))
        };
        assert_eq!(run(1), run(4));
    }
}
