//! Rows: the lines of a lattice of one vector, in an exemplar and on a canvas.

use vtex_scene::lattice::Lattice;

/// The rows of an exemplar.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    /// Distance between two of them.
    pub(super) period: f64,
    /// Unit vectors along and across them.
    pub(super) along: [f64; 2],
    pub(super) across: [f64; 2],
    /// Periods for a unit of length, by axis.
    pub(super) wave: [f64; 2],
}

impl Rows {
    /// The rows of a lattice, with lengths in units of `unit` pixels; `None` if the lattice has two vectors.
    pub(super) fn of(lattice: &Lattice, unit: f64) -> Option<Self> {
        let [vector] = lattice.vectors[..] else { return None };
        let period = libm::hypot(vector[0], vector[1]) / unit;
        let across = vector.map(|c| c / (period * unit));
        Some(Self { period, along: [-across[1], across[0]], across, wave: across.map(|c| c / period) })
    }

    /// Place along the rows, and phase.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.along[0] + y * self.along[1], x * self.wave[0] + y * self.wave[1]]
    }
}

/// Where the rows of a canvas end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// Number of rows, where the last one is followed by the first.
    count: Option<i64>,
    /// Length of a row whose last element is beside its first.
    pub(super) around: Option<f64>,
}

impl Ends {
    /// The ends of rows with a wave, of a canvas of a size that repeats along some axes; `None` if it repeats across
    /// them along both.
    pub(super) fn of(rows: &Rows, wave: [f64; 2], size: [f64; 2], repeats: [bool; 2]) -> Option<Self> {
        let turns = [0, 1].map(|k| if repeats[k] { (wave[k] * size[k]).abs() } else { 0.0 });
        let count = turns.iter().map(|turn| libm::round(*turn) as i64).find(|&count| count > 0);
        let closes = (0..2).find(|&k| repeats[k] && rows.along[k].abs() > 0.5);
        let around = closes.map(|k| size[k] / rows.along[k].abs());
        (!turns.iter().all(|turn| *turn > 0.5)).then_some(Self { count, around })
    }

    /// The number of a row: that of the first one for the one after the last.
    pub(super) fn row(&self, row: f64) -> i64 {
        self.count.map_or(row as i64, |count| (row as i64).rem_euclid(count))
    }
}
