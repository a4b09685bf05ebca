//! The cells of a lattice as lines, for showing it over a picture.

use super::{Lattice, cross, dot, fit, length};

/// Most lines.
const MOST: usize = 20_000;

impl Lattice {
    /// The borders of its cells in a picture of `size` pixels: lines between rows and, for a lattice, across each
    /// row, so that a bond looks like a wall. A lattice has no position of its own: the lines run half-way between
    /// the `centres` of elements, on average. Ends of lines, in pixels; those outside of the picture are left out,
    /// and all of them where there are more than 20,000.
    pub fn cells(&self, centres: &[[f64; 2]], size: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
        let (along, next) = self.row_vectors();
        let unit = along.map(|c| c / length(along));
        let normal = [-unit[1], unit[0]];
        let (period, apart) = (length(along), dot(next, normal));
        let shift = dot(next, unit);
        // Place of a point in rows: along them, and across in rows.
        let within = |p: [f64; 2]| [dot(p, unit), dot(p, normal) / apart];
        let first_row = mean_phase(centres.iter().map(|&c| within(c)[1])) + 0.5;
        let row_of = |across: f64| libm::floor(across - first_row);
        let is_lattice = self.vectors.len() == 2;
        let first = mean_phase(centres.iter().map(|&c| {
            let [t, across] = within(c);
            (t - shift * row_of(across)) / period
        })) + 0.5;
        let place = |t: f64, row: f64| {
            let across = (row + first_row) * apart;
            [0, 1].map(|k| t * unit[k] + across * normal[k])
        };
        let corners = [[0.0, 0.0], [size[0], 0.0], [0.0, size[1]], size].map(within);
        let range = |k: usize| {
            let all = corners.iter().map(|c| c[k]);
            [all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max)]
        };
        let ([left, right], [top, bottom]) = (range(0), range(1));
        let (from, to) = (row_of(top), row_of(bottom));
        let per_row = if is_lattice { (right - left) / period + 2.0 } else { 1.0 };
        if (to - from + 1.0) * per_row > MOST as f64 {
            return Vec::new();
        }
        let mut lines = Vec::new();
        let mut add = |ends: [[f64; 2]; 2]| {
            let inside = |k: usize| {
                let [a, b] = ends.map(|end| end[k]);
                a.max(b) >= 0.0 && a.min(b) <= size[k]
            };
            if inside(0) && inside(1) {
                lines.push(ends);
            }
        };
        for row in (from as i64..=to as i64).map(|row| row as f64) {
            add([place(left, row), place(right, row)]);
            if !is_lattice {
                continue;
            }
            let start = first * period + shift * row;
            let begin = libm::floor((left - start) / period) as i64;
            let end = libm::ceil((right - start) / period) as i64;
            for t in (begin..=end).map(|n| start + n as f64 * period) {
                add([place(t, row), place(t, row + 1.0)]);
            }
        }
        lines
    }

    /// A vector along the rows, and one to the next row. Rows alone have no period: theirs is as long as they are
    /// apart.
    fn row_vectors(&self) -> ([f64; 2], [f64; 2]) {
        match self.vectors[..] {
            [a, b] => {
                // The vector that is nearest to level, or to upright, with the others of the same lattice beside it.
                let sums = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|by| fit::sum([a, b], by));
                let slope = |v: &[f64; 2]| v[0].abs().min(v[1].abs()) / length(*v);
                let along = sums.into_iter().min_by(|v, w| slope(v).total_cmp(&slope(w))).unwrap_or(a);
                let next = if cross(along, a).abs() > 0.5 * cross(a, b).abs() { a } else { b };
                (along, next)
            }
            [a] => ([-a[1], a[0]], a),
            _ => ([1.0, 0.0], [0.0, 1.0]),
        }
    }
}

/// The mean of phases, each of which counts without its whole part.
fn mean_phase(phases: impl Iterator<Item = f64>) -> f64 {
    let mut sum = [0.0; 2];
    for phase in phases {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * phase);
        sum = [sum[0] + cosine, sum[1] + sine];
    }
    libm::atan2(sum[1], sum[0]) / std::f64::consts::TAU
}
