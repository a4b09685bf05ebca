//! The cells into which the canvas of a field is divided, and how they join at a seam.

use super::{Site, Tile};
use crate::geometry::wrapped;

/// Points per cell aimed at; a patch covers four cells.
const PER_CELL: f64 = 12.0;
/// Cells over the domain, square but for rounding.
pub(super) struct Grid {
    pub(super) x: Axis,
    pub(super) y: Axis,
}

/// The cells along one axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    /// Where the first cell begins.
    pub(super) start: f64,
    /// Length of a cell.
    pub(super) side: f64,
    pub(super) count: usize,
    /// The length after which everything comes again.
    period: Option<f64>,
}

impl Axis {
    /// A coordinate moved into the period, if there is one.
    pub(super) fn canonical(&self, v: f64) -> f64 {
        wrapped(v, self.period)
    }

    /// The cell of a coordinate and the place within it, 0 to 1; what lies outside belongs to the
    /// outermost cells.
    pub(super) fn cell(&self, v: f64) -> (usize, f64) {
        let v = ((v - self.start) / self.side).clamp(0.0, self.count as f64);
        let cell = (v as usize).min(self.count - 1);
        (cell, v - cell as f64)
    }

    /// Number of corners between the cells.
    pub(super) fn corners(&self) -> usize {
        if self.period.is_some() { self.count } else { self.count + 1 }
    }

    /// A corner's patch, and how far from the corner that patch lies.
    pub(super) fn corner(&self, corner: usize) -> (usize, f64) {
        match self.period {
            Some(period) if corner == self.count => (0, period),
            _ => (corner, 0.0),
        }
    }

    /// Runs of cells within `reach` of a corner, each with the shift that brings them there.
    pub(super) fn near(&self, corner: usize, reach: usize) -> Vec<(std::ops::Range<usize>, i32)> {
        if self.period.is_none() {
            return vec![(corner.saturating_sub(reach)..(corner + reach).min(self.count), 0)];
        }
        let (count, mut from) = (self.count as i64, corner as i64 - reach as i64);
        let end = (corner + reach) as i64;
        let mut runs = Vec::new();
        while from < end {
            let turn = from.div_euclid(count);
            let to = end.min((turn + 1) * count);
            runs.push(((from - turn * count) as usize..(to - turn * count) as usize, turn as i32));
            from = to;
        }
        runs
    }

    /// The shift that brings a coordinate nearest to a corner.
    pub(super) fn nearest(&self, corner: usize, v: f64) -> i32 {
        let at = self.start + corner as f64 * self.side;
        self.period.map_or(0, |period| libm::round((at - v) / period) as i32)
    }

    /// A coordinate moved by a number of periods.
    pub(super) fn shifted(&self, v: f64, turns: i32) -> f64 {
        self.period.map_or(v, |period| v + f64::from(turns) * period)
    }
}

/// Cells over the canvas and the points not far from it, each with [`PER_CELL`] points on average.
/// Along the axes of `tile` a whole number of cells fills the canvas.
pub(super) fn cells(points: &[Site], spacing: f64, width: u32, height: u32, tile: Tile) -> Grid {
    let margin = 4.0 * spacing;
    let extent = |coordinate: &dyn Fn(&Site) -> f64, size: u32, repeats: bool| {
        let (mut low, mut high) = (0.0, f64::from(size.max(1)));
        if !repeats {
            for p in points {
                let v = coordinate(p).clamp(-margin, f64::from(size) + margin);
                (low, high) = (v.min(low), v.max(high));
            }
        }
        (low, high - low)
    };
    let (x0, w) = extent(&|p| p.x, width, tile.x);
    let (y0, h) = extent(&|p| p.y, height, tile.y);
    let side = libm::sqrt(w * h * PER_CELL / points.len().max(1) as f64);
    let axis = |start: f64, length: f64, repeats: bool| {
        if repeats {
            let count = libm::round(length / side).max(1.0);
            Axis { start, side: length / count, count: count as usize, period: Some(length) }
        } else {
            Axis { start, side, count: (libm::ceil(length / side) as usize).max(1), period: None }
        }
    };
    Grid { x: axis(x0, w, tile.x), y: axis(y0, h, tile.y) }
}
