//! The page of a drawing as a grid of cells, on which shapes are painted.

use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, Outline};
use vtex_scene::scene::pixels;

/// A grid of cells over a page.
pub(super) struct PageRaster {
    page: PeriodicPlane,
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Cells to the unit of the page, along x and y.
    by: [f64; 2],
}

impl PageRaster {
    /// A grid of about `fine` cells to the unit, `most` cells at most. A page that repeats has whole cells.
    pub(super) fn new(page: PeriodicPlane, fine: f64, most: f64) -> Self {
        let fine = fine.min(libm::sqrt(most / page.area()));
        let count = page.size.map(|s| libm::round(s * fine).max(3.0));
        let by = [count[0] / page.size[0], count[1] / page.size[1]];
        Self { page, size: count.map(|v| v as usize), by }
    }

    /// The cells in which an outline lies, all copies of it on a page that repeats.
    pub(super) fn each(&self, outline: &Outline, mut f: impl FnMut(usize)) {
        let place = |v: i32, k: usize| match self.page.wraps[k] {
            true => Some(v.rem_euclid(self.size[k] as i32) as usize),
            false => (0..self.size[k] as i32).contains(&v).then_some(v as usize),
        };
        let scaled = outline.moved(Affine::scale_non_uniform(self.by[0], self.by[1]));
        for span in pixels::mask(&scaled).spans() {
            if let Some(row) = place(span.y, 1) {
                (span.x0..span.x1).filter_map(|x| place(x, 0)).for_each(|x| f(row * self.size[0] + x));
            }
        }
    }

    /// The page.
    pub(super) fn page(&self) -> PeriodicPlane {
        self.page
    }

    /// The middle of a cell, in the unit of the page.
    pub(super) fn middle(&self, cell: usize) -> [f64; 2] {
        let [x, y] = [cell % self.size[0], cell / self.size[0]];
        [(x as f64 + 0.5) / self.by[0], (y as f64 + 0.5) / self.by[1]]
    }

    /// A point of the grid, in the unit of the page.
    pub(super) fn unscaled(&self, p: [f64; 2]) -> [f64; 2] {
        [p[0] / self.by[0], p[1] / self.by[1]]
    }

    /// Length of a side of a cell, in the unit of the page.
    pub(super) fn unit(&self) -> f64 {
        1.0 / libm::sqrt(self.by[0] * self.by[1])
    }
}
