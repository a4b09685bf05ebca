//! The background field: radial basis functions through coloured points.
//!
//! The field is the interpolant Σ cᵢ √(|x - xᵢ|² + s²) + c₀. In the paper (§3.2.3) s = 0, which makes
//! each point the tip of a cone. A tip shows as a dot of a few pixels if its colour differs much from
//! its surroundings, and gradients cannot reproduce it. A small s rounds the tips.
//!
//! Solving for all points at once takes time cubic in their number. Instead, overlapping square
//! patches of about fifty points are solved and blended by smooth weights that add up to one
//! (partition of unity). Every patch interpolates all points where its weight is above 0, so the
//! blend does too. Time and memory grow linearly with the number of points.
//!
//! Components are 8-bit sRGB values as floats (0 to 255). SVG gradients interpolate in the same
//! space, so writers reproduce the field exactly.
//!
//! Along an axis that tiles, the field is periodic: a whole number of cells fills the period, patches
//! at the seam include points from beyond it, and coordinates are wrapped before evaluation.
//!
//! Works badly where points are some ten times denser than on average: a patch then uses only some of
//! them, and the field no longer passes through each.

mod dense;
mod grid;
#[cfg(test)]
mod tests;

use super::{Field, Tile};
use grid::{DomainGrid, cells};
use std::sync::OnceLock;
use vtex_base::geometry::wrapped;
use vtex_base::parallel;

/// Number of points up to which one patch holds the whole field.
const WHOLE: usize = 64;
/// Largest number of points solved for in a patch.
const LARGEST_PATCH: usize = 144;
/// Number of points below which a patch includes points from further away.
const SMALLEST_PATCH: usize = 8;
/// Rounding of the tips (s), as a share of the distance between control points.
const ROUND: f64 = 0.2;
/// Distance below which points are merged, in pixels.
const MERGE: f64 = 1.0 / 64.0;

/// A field prepared for evaluation.
pub struct Interpolant {
    points: Vec<Site>,
    fallback: [f64; 3],
    /// Whether the first patch holds the whole field.
    whole: bool,
    /// s², in square pixels.
    round: f64,
    grid: DomainGrid,
    /// Indices of the points sorted by cell; those of cell c are `starts[c]..starts[c + 1]`.
    order: Vec<u32>,
    starts: Vec<u32>,
    /// One patch around each corner of the cells, computed when first needed. Joined opposite borders
    /// share theirs.
    patches: Vec<OnceLock<CornerInterpolant>>,
}

/// A point and its colour.
#[derive(Clone, Copy)]
struct Site {
    x: f64,
    y: f64,
    colour: [f64; 3],
}

/// A point, and the number of periods along x and y by which it is shifted.
type Moved = (u32, i32, i32);

/// The interpolant of the points around a corner.
struct CornerInterpolant {
    /// x, y and the coefficients of the three components.
    terms: Vec<[f64; 5]>,
    constant: [f64; 3],
    /// s², in square pixels.
    round: f64,
}

impl CornerInterpolant {
    fn new(sites: &[Site], round: f64) -> Self {
        let mean = |k: usize| sites.iter().map(|s| s.colour[k]).sum::<f64>() / sites.len() as f64;
        let mean = [mean(0), mean(1), mean(2)];
        // Unknowns: one coefficient per point, and the constant, whose equation makes them add up to zero.
        let n = sites.len() + 1;
        let mut matrix = vec![0.0; n * n];
        let mut right = vec![[0.0; 3]; n];
        for (i, a) in sites.iter().enumerate() {
            for (j, b) in sites.iter().enumerate() {
                matrix[i * n + j] = libm::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + round);
            }
            (matrix[i * n + n - 1], matrix[(n - 1) * n + i]) = (1.0, 1.0);
            right[i] = [0, 1, 2].map(|k| a.colour[k] - mean[k]);
        }
        if sites.len() < 2 || !dense::solve(&mut matrix, &mut right) {
            return Self { terms: Vec::new(), constant: mean, round };
        }
        let terms = sites.iter().zip(&right).map(|(s, c)| [s.x, s.y, c[0], c[1], c[2]]).collect();
        Self { terms, constant: [0, 1, 2].map(|k| mean[k] + right[n - 1][k]), round }
    }

    fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let mut sum = self.constant;
        for t in &self.terms {
            let (dx, dy) = (x - t[0], y - t[1]);
            let r = libm::sqrt(dx * dx + dy * dy + self.round);
            for k in 0..3 {
                sum[k] += r * t[2 + k];
            }
        }
        sum
    }
}

impl Interpolant {
    /// Prepares a field for a canvas of the given size in pixels. Along the axes of `tile` the field is
    /// periodic: it is bitwise equal at x and x + `width`, if that sum is exact.
    pub fn new(field: &Field, width: u32, height: u32, tile: Tile) -> Self {
        let points = merged(field, width, height, tile);
        let spacing = if field.spacing > 0.0 { field.spacing.min(1e6) } else { 0.0 };
        let grid = cells(&points, spacing, width, height, tile);
        // Counting sort into cells.
        let cell = |p: &Site| grid.y.cell(p.y).0 * grid.x.count + grid.x.cell(p.x).0;
        let mut starts = vec![0u32; grid.x.count * grid.y.count + 1];
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
        let whole = points.len() <= WHOLE && !tile.any();
        let corners = if whole { 1 } else { grid.x.corners() * grid.y.corners() };
        let patches = (0..corners).map(|_| OnceLock::new()).collect();
        let reach = spacing.min(1000.0);
        let round = ROUND * ROUND * reach * reach;
        Self { points, fallback: field.fallback.to_f64(), whole, round, grid, order, starts, patches }
    }

    /// sRGB components (0 to 255, not rounded) at a point of the canvas, in pixels.
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let clamp = |c: [f64; 3]| c.map(|v| v.clamp(0.0, 255.0));
        if self.points.is_empty() {
            return self.fallback;
        }
        if self.whole {
            return clamp(
                self.patches[0].get_or_init(|| CornerInterpolant::new(&self.points, self.round)).at(x, y),
            );
        }
        let g = &self.grid;
        let (x, y) = (g.x.canonical(x), g.y.canonical(y));
        let ((column, u), (row, v)) = (g.x.cell(x), g.y.cell(y));
        // Smoothstep weights: they and their slopes are continuous across cells.
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (smooth(u), smooth(v));
        let mut sum = [0.0; 3];
        for (dx, dy, w) in
            [(0, 0, (1.0 - u) * (1.0 - v)), (1, 0, u * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 1, u * v)]
        {
            if w > 0.0 {
                let ((column, dx), (row, dy)) = (g.x.corner(column + dx), g.y.corner(row + dy));
                let c = self.patch(column, row).at(x - dx, y - dy);
                for k in 0..3 {
                    sum[k] += w * c[k];
                }
            }
        }
        clamp(sum)
    }

    /// The field at `columns` × `rows` points, row by row. Point (i, j) lies at
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
    fn patch(&self, column: usize, row: usize) -> &CornerInterpolant {
        let (gx, gy) = (&self.grid.x, &self.grid.y);
        self.patches[row * gx.corners() + column].get_or_init(|| {
            // The points of the four cells at the corner, and of more where points are few.
            let mut chosen = Vec::new();
            for reach in [1, 2, 4] {
                chosen = self.near(column, row, reach);
                if chosen.len() >= SMALLEST_PATCH {
                    break;
                }
            }
            if chosen.len() < SMALLEST_PATCH {
                // No points nearby: a coarse selection of all points gives the trend.
                chosen.extend(thinned(&self.order, SMALLEST_PATCH * 4).map(|i| {
                    let p = &self.points[i as usize];
                    (i, gx.nearest(column, p.x), gy.nearest(row, p.y))
                }));
                chosen.sort_unstable();
                chosen.dedup();
            }
            let sites: Vec<Site> = thinned(&chosen, LARGEST_PATCH)
                .map(|(i, turns_x, turns_y)| {
                    let p = self.points[i as usize];
                    Site { x: gx.shifted(p.x, turns_x), y: gy.shifted(p.y, turns_y), ..p }
                })
                .collect();
            CornerInterpolant::new(&sites, self.round)
        })
    }

    /// Points of the cells within `reach` of a corner.
    fn near(&self, column: usize, row: usize, reach: usize) -> Vec<Moved> {
        let columns = self.grid.x.near(column, reach);
        let mut found = Vec::new();
        for (rows, turns_y) in self.grid.y.near(row, reach) {
            for r in rows {
                for (run, turns_x) in &columns {
                    let first = self.starts[r * self.grid.x.count + run.start] as usize;
                    let last = self.starts[r * self.grid.x.count + run.end] as usize;
                    found.extend(self.order[first..last].iter().map(|&i| (i, *turns_x, turns_y)));
                }
            }
        }
        found
    }
}

/// At most `most` of the items, evenly spaced.
fn thinned<T: Copy>(items: &[T], most: usize) -> impl Iterator<Item = T> {
    let count = items.len().min(most);
    (0..count).map(move |k| items[k * items.len() / count])
}

/// The points sorted by position, with coincident ones merged into their mean colour. Along the axes
/// of `tile`, points are wrapped onto the canvas.
fn merged(field: &Field, width: u32, height: u32, tile: Tile) -> Vec<Site> {
    let wrap = |v: f64, size: u32, repeats: bool| wrapped(v, repeats.then_some(f64::from(size.max(1))));
    let key = |v: f64| libm::floor(v / MERGE) as i64;
    let mut sites: Vec<((i64, i64), Site)> = field
        .points
        .iter()
        .filter(|p| p.x.abs() < 1e9 && p.y.abs() < 1e9)
        .map(|p| Site {
            x: wrap(p.x, width, tile.x),
            y: wrap(p.y, height, tile.y),
            colour: p.colour.to_f64(),
        })
        .map(|s| ((key(s.y), key(s.x)), s))
        .collect();
    sites.sort_by_key(|s| s.0);
    let one = |group: &[((i64, i64), Site)]| {
        let mean = |k: usize| group.iter().map(|s| s.1.colour[k]).sum::<f64>() / group.len() as f64;
        Site { colour: [mean(0), mean(1), mean(2)], ..group[0].1 }
    };
    sites.chunk_by(|a, b| a.0 == b.0).map(one).collect()
}
