//! The cells that placement works on: a canvas, margins where it ends, and seams where it repeats.
//!
//! A span at a place gives runs of cells, two where it crosses a seam. Code that visits cells gets these runs
//! from the grid, and so need not distinguish a plane from a torus.

use super::WIDEST_MARGIN;
use super::model::PlacementModel;
use std::ops::Range;
use vtex_base::raster::Span;
use vtex_scene::scene::{SynthParams, Tile};

/// Cells in rows. Along an axis that repeats there is no margin and the last cell is followed by the first; a
/// place outside the map then stands for the cell a whole number of periods away.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Width of the map, in cells.
    pub(crate) width: i32,
    /// Height of the map, in cells.
    pub(crate) height: i32,
    /// Cells beside the canvas, left and right, and above and below.
    pub(crate) margin: [i32; 2],
    /// The axes along which the map repeats.
    pub(crate) tile: Tile,
    /// First row of this grid in the whole map, of which it may be a band of rows.
    first_row: i32,
    /// Height of the whole map, in cells.
    whole_height: i32,
}

/// A run of cells of one row of a shape.
#[derive(Clone, Debug)]
pub(crate) struct CellRun {
    /// Place of its first cell, not wrapped.
    pub(crate) at: [i32; 2],
    /// Indices of the cells.
    pub(crate) cells: Range<usize>,
    /// Indices of those cells that are on the canvas.
    pub(crate) canvas: Range<usize>,
}

impl Grid {
    /// The grid of a canvas of `size` pixels with `margin` cells beyond its borders.
    pub(crate) fn new(size: [u32; 2], tile: Tile, margin: i32) -> Self {
        let margin = [tile.x, tile.y].map(|wrap| if wrap { 0 } else { margin });
        let [width, height] = [0, 1].map(|k| size[k] as i32 + 2 * margin[k]);
        Self { width, height, margin, tile, first_row: 0, whole_height: height }
    }

    /// The grid of a synthesis: margins are wide enough for elements that reach in from outside.
    pub(crate) fn around(model: &PlacementModel, params: &SynthParams) -> Self {
        let margin = (model.reach + 2).min(WIDEST_MARGIN);
        Self::new([params.width, params.height], params.tile, margin)
    }

    /// The grid of some rows of this one, which may reach across a seam.
    pub(crate) fn band(&self, rows: &Range<i32>) -> Self {
        let tile = Tile { y: false, ..self.tile };
        Self { height: rows.end - rows.start, first_row: rows.start, tile, ..self.clone() }
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The values of some rows, where `values` has one for each cell.
    pub(crate) fn rows_of<T: Copy>(&self, values: &[T], rows: &Range<i32>) -> Vec<T> {
        let mut copy = Vec::with_capacity(self.width as usize * rows.len());
        for row in rows.clone() {
            let start = self.index(0, row.rem_euclid(self.height));
            copy.extend_from_slice(&values[start..start + self.width as usize]);
        }
        copy
    }

    /// Size of the canvas, in pixels.
    pub(crate) fn canvas(&self) -> [f64; 2] {
        [self.width - 2 * self.margin[0], self.whole_height - 2 * self.margin[1]].map(f64::from)
    }

    /// Index of a cell of the map.
    pub(crate) fn index(&self, x: i32, y: i32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// Column and row of a cell.
    #[cfg(test)]
    pub(crate) fn place(&self, i: usize) -> [i32; 2] {
        [(i % self.width as usize) as i32, (i / self.width as usize) as i32]
    }

    /// A place wrapped onto the map; unchanged along an axis that does not repeat.
    pub(crate) fn canonical(&self, [x, y]: [i32; 2]) -> [i32; 2] {
        let axis = |v: i32, size: i32, wrap: bool| if wrap { v.rem_euclid(size) } else { v };
        [axis(x, self.width, self.tile.x), axis(y, self.height, self.tile.y)]
    }

    /// Index of the cell at a place, after wrapping; `None` beyond the margin.
    pub(crate) fn cell(&self, at: [i32; 2]) -> Option<usize> {
        let [x, y] = self.canonical(at);
        ((0..self.width).contains(&x) && (0..self.height).contains(&y)).then(|| self.index(x, y))
    }

    /// Middle of a cell, in pixels of the canvas.
    pub(crate) fn point(&self, at: [i32; 2]) -> [f64; 2] {
        let row = if self.whole_height == self.height {
            at[1]
        } else {
            (at[1] + self.first_row).rem_euclid(self.whole_height)
        };
        [at[0] - self.margin[0], row - self.margin[1]].map(|v| f64::from(v) + 0.5)
    }

    /// The offset from `a` to `b`; where the map repeats, the shortest one.
    pub(crate) fn offset(&self, a: [i32; 2], b: [i32; 2]) -> [i32; 2] {
        let axis = |d: i32, size: i32, wrap: bool| {
            if wrap { (d + size / 2).rem_euclid(size) - size / 2 } else { d }
        };
        [axis(b[0] - a[0], self.width, self.tile.x), axis(b[1] - a[1], self.height, self.tile.y)]
    }

    /// The cells on the map of a span moved to a place: two runs where it crosses a seam. No cell occurs twice.
    #[inline]
    pub(crate) fn runs(&self, span: Span, at: [i32; 2]) -> impl Iterator<Item = CellRun> + use<> {
        let (x0, x1, y) = (span.x0 + at[0], span.x1 + at[0], span.y + at[1]);
        let row = if self.tile.y { y.rem_euclid(self.height) } else { y };
        let mut runs = [None, None];
        if (0..self.height).contains(&row) {
            if self.tile.x {
                let (first, length) = (x0.rem_euclid(self.width), (x1 - x0).min(self.width));
                // From the first column to the seam, then from the seam on.
                let before = length.min(self.width - first);
                runs[0] = Some(self.run([x0, y], row, first, first + before));
                if length > before {
                    runs[1] = Some(self.run([x0 + before, y], row, 0, length - before));
                }
            } else {
                let (low, high) = (x0.max(0), x1.min(self.width));
                if low < high {
                    runs[0] = Some(self.run([low, y], row, low, high));
                }
            }
        }
        runs.into_iter().flatten()
    }

    /// The run from column `x0` to `x1` of a row of the map.
    #[inline]
    fn run(&self, at: [i32; 2], row: i32, x0: i32, x1: i32) -> CellRun {
        let start = row as usize * self.width as usize;
        let indices = |x0: i32, x1: i32| start + x0 as usize..start + x1.max(x0) as usize;
        let [mx, my] = self.margin;
        // Where the map repeats there is no margin, and every row is one of the canvas.
        let on_canvas = my == 0 || (my..self.whole_height - my).contains(&(row + self.first_row));
        let canvas = if on_canvas { indices(x0.max(mx), x1.min(self.width - mx)) } else { start..start };
        CellRun { at, cells: indices(x0, x1), canvas }
    }

    /// The indices of [`Grid::runs`].
    #[inline]
    pub(crate) fn cells(&self, span: Span, at: [i32; 2]) -> impl Iterator<Item = Range<usize>> + use<> {
        self.runs(span, at).map(|run| run.cells)
    }

    /// Index of the cell at a place, after wrapping, if it is on the canvas.
    #[inline]
    pub(crate) fn canvas_cell(&self, at: [i32; 2]) -> Option<usize> {
        let [x, y] = self.canonical(at);
        let [mx, my] = self.margin;
        let on_canvas = (mx..self.width - mx).contains(&x)
            && (0..self.height).contains(&y)
            && (my == 0 || (my..self.whole_height - my).contains(&(y + self.first_row)));
        on_canvas.then(|| self.index(x, y))
    }
}

/// Whether two half-open intervals (low end, high end) overlap on a circle of length `period`, or on a line.
fn overlap(a: [i32; 2], b: [i32; 2], period: Option<i32>) -> bool {
    match period {
        None => a[0] < b[1] && b[0] < a[1],
        Some(p) => (b[0] - a[0]).rem_euclid(p) < a[1] - a[0] || (a[0] - b[0]).rem_euclid(p) < b[1] - b[0],
    }
}

impl Grid {
    /// Whether box `a` moved to `at` and box `b` moved to `place` have a cell in common; boxes are x0, y0, x1, y1.
    pub(crate) fn boxes_meet(&self, a: [i32; 4], at: [i32; 2], b: [i32; 4], place: [i32; 2]) -> bool {
        let periods = self.tile.periods([self.width, self.height]);
        (0..2).all(|k| {
            overlap([a[k] + at[k], a[k + 2] + at[k]], [b[k] + place[k], b[k + 2] + place[k]], periods[k])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_the_wrapped_cells_of_a_span(
            w in 1..30u32, h in 1..20u32, x: bool, y: bool,
            x0 in -60..60i32, length in 1..40i32, row in -40..40i32,
        ) {
            let grid = Grid::new([w, h], Tile { x, y }, 3);
            let span = Span { y: row, x0, x1: x0 + length };
            let mut wanted = Vec::new();
            for column in x0..x0 + length.min(if x { w as i32 } else { length }) {
                wanted.extend(grid.cell([column + 2, row - 1]));
            }
            let got: Vec<usize> = grid.cells(span, [2, -1]).flatten().collect();
            prop_assert_eq!(&got, &wanted);
            for run in grid.runs(span, [2, -1]) {
                prop_assert_eq!(grid.cell(run.at), Some(run.cells.start));
                for i in run.cells {
                    let [cx, cy] = grid.point(grid.place(i));
                    let inside = cx > 0.0 && cy > 0.0 && cx < f64::from(w) && cy < f64::from(h);
                    prop_assert_eq!(inside, run.canvas.contains(&i));
                    prop_assert_eq!(inside.then_some(i), grid.canvas_cell(grid.place(i)));
                }
            }
        }

        #[test]
        fn boxes_meet_where_a_cell_is_common(
            a in 0..12i32, la in 1..9i32, b in -30..30i32, lb in 1..9i32, wrap: bool,
        ) {
            let grid = Grid::new([12, 12], Tile { x: wrap, y: false }, 0);
            let cells = |low: i32, length: i32| -> Vec<i32> {
                (low..low + length).map(|v| if wrap { v.rem_euclid(12) } else { v }).collect()
            };
            let common = cells(a, la).iter().any(|v| cells(b, lb).contains(v));
            prop_assert_eq!(grid.boxes_meet([0, 0, la, 1], [a, 0], [0, 0, lb, 1], [b, 0]), common);
        }
    }

    #[test]
    fn the_shortest_way_crosses_the_seam() {
        let grid = Grid::new([100, 50], Tile { x: true, y: false }, 4);
        assert_eq!(grid.offset([95, 1], [5, 3]), [10, 2]);
        assert_eq!(grid.offset([5, 3], [95, 1]), [-10, -2]);
        assert_eq!(grid.canonical([-3, -3]), [97, -3]);
    }
}
