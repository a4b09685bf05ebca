//! Pixels of a map that want a primary, and pixels that a primary covers.

use super::instances::PixelInstance;
use crate::arrange::grid::Grid;
use vtex_base::raster::Mask;

/// A pixel wants a primary.
const WANTED: u8 = 1;
/// A primary covers a pixel.
const TAKEN: u8 = 2;

/// Wanted and covered pixels of a map.
pub(super) struct Cover<'g> {
    grid: &'g Grid,
    pixels: Vec<u8>,
}

impl<'g> Cover<'g> {
    /// A map on which the pixels of `instances` want a primary and none is covered.
    pub(super) fn new(grid: &'g Grid, instances: &[PixelInstance]) -> Self {
        let mut cover = Self { grid, pixels: vec![0; grid.len()] };
        instances.iter().for_each(|instance| cover.mark(&instance.mask, [0, 0], WANTED));
        cover
    }

    /// Covers the pixels of a mask at a place.
    pub(super) fn take(&mut self, mask: &Mask, at: [i32; 2]) {
        self.mark(mask, at, TAKEN);
    }

    /// Whether a pixel wants a primary.
    pub(super) fn is_wanted(&self, at: [i32; 2]) -> bool {
        self.grid.cell(at).is_some_and(|i| self.pixels[i] & WANTED != 0)
    }

    fn mark(&mut self, mask: &Mask, at: [i32; 2], flag: u8) {
        for cells in mask.spans().iter().flat_map(|&span| self.grid.cells(span, at)) {
            self.pixels[cells].iter_mut().for_each(|pixel| *pixel |= flag);
        }
    }

    /// Share of the canvas that a mask covers at a place.
    pub(super) fn share(&self, mask: &Mask, at: [i32; 2]) -> f64 {
        let runs = mask.spans().iter().flat_map(|&span| self.grid.runs(span, at));
        runs.map(|run| run.canvas.len()).sum::<usize>() as f64 / self.grid.canvas().iter().product::<f64>()
    }

    /// Shares of the canvas: wanted, wanted but not covered, covered but not wanted.
    pub(super) fn shares(&self) -> (f64, f64, f64) {
        let mut counts = [0u64; 4];
        let [w, h] = self.grid.canvas().map(|v| v as usize);
        let [mx, my] = self.grid.margin;
        for y in 0..h {
            let start = self.grid.index(mx, my + y as i32);
            self.pixels[start..start + w].iter().for_each(|&pixel| counts[usize::from(pixel)] += 1);
        }
        let share = |count: u64| count as f64 / (w * h).max(1) as f64;
        let [wanted, taken] = [WANTED, TAKEN].map(usize::from);
        (share(counts[wanted] + counts[wanted | taken]), share(counts[wanted]), share(counts[taken]))
    }
}
