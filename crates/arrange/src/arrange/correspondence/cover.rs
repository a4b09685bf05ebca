//! Pixels of a map that want a primary, and pixels that a primary covers.

use super::instances::PixelInstance;
use crate::arrange::grid::Grid;
use std::ops::Range;
use vtex_base::raster::Mask;

/// Steps that an element takes to settle, in pixels.
const STEPS: [i32; 2] = [3, 1];
/// Farthest that it settles, as a share of the side of a square of its area.
const FARTHEST: f64 = 0.25;

/// Wanted and covered pixels of a map.
pub(super) struct Cover<'g> {
    grid: &'g Grid,
    wanted: Vec<bool>,
    /// Number of primaries on each pixel.
    taken: Vec<u8>,
}

impl<'g> Cover<'g> {
    /// A map on which the pixels of `instances` want a primary and none is covered.
    pub(super) fn new(grid: &'g Grid, instances: &[PixelInstance]) -> Self {
        let (mut wanted, taken) = (vec![false; grid.len()], vec![0; grid.len()]);
        for cells in instances.iter().flat_map(|instance| cells(grid, &instance.mask, [0, 0])) {
            wanted[cells].fill(true);
        }
        Self { grid, wanted, taken }
    }

    /// Whether a pixel wants a primary.
    pub(super) fn is_wanted(&self, at: [i32; 2]) -> bool {
        self.grid.cell(at).is_some_and(|i| self.wanted[i])
    }

    /// Covers the pixels of a mask at a place.
    pub(super) fn take(&mut self, mask: &Mask, at: [i32; 2]) {
        for cells in cells(self.grid, mask, at) {
            self.taken[cells].iter_mut().for_each(|count| *count = count.saturating_add(1));
        }
    }

    /// Takes a mask that was put at a place away.
    fn leave(&mut self, mask: &Mask, at: [i32; 2]) {
        for cells in cells(self.grid, mask, at) {
            self.taken[cells].iter_mut().for_each(|count| *count = count.saturating_sub(1));
        }
    }

    /// Moves a mask that was put at a place to where it covers most of what no other covers, a few pixels away at
    /// most, and gives its new place.
    pub(super) fn settle(
        &mut self,
        mask: &Mask,
        at: [i32; 2],
        stands: impl Fn([i32; 2]) -> bool,
    ) -> [i32; 2] {
        self.leave(mask, at);
        let gained = |at: [i32; 2]| -> usize {
            let is_gained = |i: &usize| self.wanted[*i] && self.taken[*i] == 0;
            cells(self.grid, mask, at).map(|cells| cells.filter(is_gained).count()).sum()
        };
        let farthest = (FARTHEST * libm::sqrt(f64::from(mask.area()))) as i32;
        let mut best = (gained(at), at);
        for step in STEPS {
            loop {
                let around = [[-step, 0], [step, 0], [0, -step], [0, step]];
                let there = around.map(|way| [0, 1].map(|k| best.1[k] + way[k]));
                let near = there.into_iter().filter(|to| (0..2).all(|k| (to[k] - at[k]).abs() <= farthest));
                let better = near.filter(|&to| stands(to)).map(|to| (gained(to), to)).max_by_key(|b| b.0);
                match better {
                    Some(better) if better.0 > best.0 => best = better,
                    _ => break,
                }
            }
        }
        self.take(mask, best.1);
        best.1
    }

    /// Share of the canvas that a mask covers at a place.
    pub(super) fn share(&self, mask: &Mask, at: [i32; 2]) -> f64 {
        let runs = mask.spans().iter().flat_map(|&span| self.grid.runs(span, at));
        runs.map(|run| run.canvas.len()).sum::<usize>() as f64 / self.grid.canvas().iter().product::<f64>()
    }

    /// Shares of the canvas: wanted, wanted but not covered, covered but not wanted.
    pub(super) fn shares(&self) -> (f64, f64, f64) {
        let (mut wanted, mut empty, mut unwanted) = (0u64, 0, 0);
        let [w, h] = self.grid.canvas().map(|v| v as usize);
        let [mx, my] = self.grid.margin;
        for y in 0..h {
            let start = self.grid.index(mx, my + y as i32);
            for (is_wanted, taken) in self.wanted[start..start + w].iter().zip(&self.taken[start..]) {
                wanted += u64::from(*is_wanted);
                empty += u64::from(*is_wanted && *taken == 0);
                unwanted += u64::from(!is_wanted && *taken > 0);
            }
        }
        let share = |count: u64| count as f64 / (w * h).max(1) as f64;
        (share(wanted), share(empty), share(unwanted))
    }
}

/// The cells of a mask at a place.
fn cells(grid: &Grid, mask: &Mask, at: [i32; 2]) -> impl Iterator<Item = Range<usize>> {
    mask.spans().iter().flat_map(move |&span| grid.cells(span, at))
}
