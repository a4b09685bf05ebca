//! Elements near a place: ids by the squares that their boxes touch.

use super::grid::Grid;
use super::occupancy::PlacedId;
use vtex_scene::scene::Tile;

/// Side of a square, in pixels.
const SIDE: i32 = 64;

/// Ids by the squares of a grid.
pub(super) struct Bins {
    size: [i32; 2],
    tile: Tile,
    ids: Vec<Vec<PlacedId>>,
}

impl Bins {
    /// For a grid.
    pub(super) fn new(grid: &Grid) -> Self {
        let size = [grid.width, grid.height];
        let count = size.map(squares).iter().product::<i32>();
        Self { size, tile: grid.tile, ids: vec![Vec::new(); count as usize] }
    }

    /// Adds an id to the squares that a box (x0, y0, x1, y1) around a place touches.
    pub(super) fn insert(&mut self, id: PlacedId, bounds: [i32; 4], at: [i32; 2]) {
        for square in self.touched(bounds, at) {
            self.ids[square].push(id);
        }
    }

    /// Removes an id from the squares that its box touches.
    pub(super) fn remove(&mut self, id: PlacedId, bounds: [i32; 4], at: [i32; 2]) {
        for square in self.touched(bounds, at) {
            self.ids[square].retain(|&other| other != id);
        }
    }

    /// The ids in the squares that a box around a place touches. One may come more than once.
    pub(super) fn near(&self, bounds: [i32; 4], at: [i32; 2]) -> impl Iterator<Item = PlacedId> {
        self.touched(bounds, at).flat_map(|square| self.ids[square].iter().copied())
    }

    /// The squares that a box around a place touches, each once.
    fn touched(&self, bounds: [i32; 4], at: [i32; 2]) -> impl Iterator<Item = usize> + use<> {
        let axis = |low: i32, high: i32, size: i32, wrap: bool| {
            let count = squares(size);
            if !wrap {
                let (first, last) = (low.clamp(0, size - 1) / SIDE, (high - 1).clamp(0, size - 1) / SIDE);
                return (first, last - first + 1, count);
            }
            let first = low.rem_euclid(size) / SIDE;
            let last = (high - 1).rem_euclid(size) / SIDE;
            // A box whose last square is its first one goes around the whole torus if it crosses the seam.
            let around = low.rem_euclid(size) + (high - low) > size;
            let whole = high - low >= size || (around && first == last);
            (first, if whole { count } else { (last - first).rem_euclid(count) + 1 }, count)
        };
        let (x, w, columns) = axis(at[0] + bounds[0], at[0] + bounds[2], self.size[0], self.tile.x);
        let (y, h, rows) = axis(at[1] + bounds[1], at[1] + bounds[3], self.size[1], self.tile.y);
        let square = move |j: i32, i: i32| ((y + j) % rows * columns + (x + i) % columns) as usize;
        (0..h).flat_map(move |j| (0..w).map(move |i| square(j, i)))
    }
}

/// Number of squares along a side.
fn squares(size: i32) -> i32 {
    (size - 1) / SIDE + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_box_is_found_from_every_cell_of_it(
            w in 1..200u32, h in 1..200u32, x: bool, y: bool,
            at in (0..200i32, 0..200i32), size in (1..150i32, 1..150i32), within in (0..150i32, 0..150i32),
        ) {
            let grid = Grid::new([w, h], Tile { x, y }, 0);
            let at = [at.0 % w as i32, at.1 % h as i32];
            let size = [size.0, size.1];
            let mut bins = Bins::new(&grid);
            bins.insert(PlacedId(7), [0, 0, size[0], size[1]], at);
            let cell = [at[0] + within.0 % size[0], at[1] + within.1 % size[1]];
            if grid.cell(cell).is_some() {
                prop_assert!(bins.near([0, 0, 1, 1], cell).any(|id| id == PlacedId(7)));
            }
            bins.remove(PlacedId(7), [0, 0, size[0], size[1]], at);
            prop_assert!(bins.ids.iter().all(Vec::is_empty));
        }
    }
}
