//! The cells that partition a field's canvas, periodic where it tiles.

use super::{Site, Tile};
use vtex_base::geometry::wrapped;

/// Intended number of points per cell. A patch covers four cells.
const PER_CELL: f64 = 12.0;
/// Cells over the domain, approximately square.
pub(super) struct DomainGrid {
    pub(super) x: CellAxis,
    pub(super) y: CellAxis,
}

/// The cells along one axis.
#[derive(Clone, Copy)]
pub(super) struct CellAxis {
    /// Where the first cell begins.
    pub(super) start: f64,
    /// Length of a cell.
    pub(super) side: f64,
    pub(super) count: usize,
    /// The period along this axis; `None` if it does not tile.
    period: Option<f64>,
}

impl CellAxis {
    /// A coordinate wrapped into the period, if there is one.
    pub(super) fn canonical(&self, v: f64) -> f64 {
        wrapped(v, self.period)
    }

    /// The cell of a coordinate, and the position within it, 0 to 1. Coordinates outside belong to the
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

    /// The index of a corner's patch, and the offset of that patch's corner from this one.
    pub(super) fn corner(&self, corner: usize) -> (usize, f64) {
        match self.period {
            Some(period) if corner == self.count => (0, period),
            _ => (corner, 0.0),
        }
    }

    /// Ranges of cells within `reach` of a corner, each with the shift (in periods) that moves them there.
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

    /// The shift (in periods) that moves a coordinate nearest to a corner.
    pub(super) fn nearest(&self, corner: usize, v: f64) -> i32 {
        let at = self.start + corner as f64 * self.side;
        self.period.map_or(0, |period| libm::round((at - v) / period) as i32)
    }

    /// A coordinate shifted by a number of periods.
    pub(super) fn shifted(&self, v: f64, turns: i32) -> f64 {
        self.period.map_or(v, |period| v + f64::from(turns) * period)
    }
}

/// Cells over the canvas and nearby points, with [`PER_CELL`] points each on average. Along the axes
/// of `tile` a whole number of cells fills the canvas.
pub(super) fn cells(points: &[Site], spacing: f64, width: u32, height: u32, tile: Tile) -> DomainGrid {
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
            CellAxis { start, side: length / count, count: count as usize, period: Some(length) }
        } else {
            CellAxis { start, side, count: (libm::ceil(length / side) as usize).max(1), period: None }
        }
    };
    DomainGrid { x: axis(x0, w, tile.x), y: axis(y0, h, tile.y) }
}
