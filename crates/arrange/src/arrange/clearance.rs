//! Distance of every cell to the nearest placed texton, kept up to date while textons are added.

use super::occupancy::{Occupancy, PlacedId};
use vtex_base::raster::Span;
use vtex_base::sampling::{Stream, WeightTree};

/// Steps of the 3-4 chamfer distance (Borgefors 1986), which is in thirds of a pixel.
const STRAIGHT: u8 = 3;
const DIAGONAL: u8 = 4;
/// Side of the blocks whose weights are summed for the draw, in cells.
const BLOCK: i32 = 16;

/// Distances up to a limit, and places drawn in proportion to them.
pub(super) struct Clearance {
    /// Chamfer distances, at most `limit`.
    pub(super) distance: Vec<u8>,
    /// Largest distance that is stored, in thirds of a pixel; larger ones are stored as this.
    pub(super) limit: u8,
    /// Cells within `frame` of the border of the map are not drawn, along each axis.
    frame: [i32; 2],
    blocks: WeightTree,
    columns: i32,
    scratch: Vec<u8>,
}

impl Clearance {
    /// Distances on a map, up to `reach` pixels (at most 85). Centres may be drawn in `outside`
    /// cells beyond the canvas.
    pub(super) fn new(map: &Occupancy<'_>, reach: i32, outside: i32) -> Self {
        let limit = (reach.clamp(1, 85) * i32::from(STRAIGHT)) as u8;
        let grid = &map.grid;
        let distance = (0..grid.len()).map(|i| if map.taken(i) { 0 } else { limit }).collect();
        let blocks_along = |size: i32| (size + BLOCK - 1) / BLOCK;
        let (columns, rows) = (blocks_along(grid.width), blocks_along(grid.height));
        let mut clearance = Self {
            distance,
            limit,
            frame: grid.margin.map(|m| (m - outside).max(0)),
            blocks: WeightTree::zeros((columns * rows) as usize),
            columns,
            scratch: Vec::new(),
        };
        // Where the map repeats, distances reach across the seam.
        let beyond = i32::from(limit / STRAIGHT) + 1;
        let [u, v] = [grid.tile.x, grid.tile.y].map(|wrap| if wrap { beyond } else { 0 });
        clearance.spread(map, [-u, -v, grid.width + u, grid.height + v]);
        clearance
    }

    /// Registers an added texton: its cells have distance 0.
    pub(super) fn add(&mut self, map: &Occupancy<'_>, id: PlacedId) {
        let placed = map.get(id);
        let shape = map.model().shape(placed.variant);
        for &span in shape.mask.spans() {
            map.grid.cells(span, placed.at).for_each(|cells| self.distance[cells].fill(0));
        }
        let reach = i32::from(self.limit / STRAIGHT) + 1;
        let [x0, y0, x1, y1] = shape.bounds;
        let [x, y] = placed.at;
        self.spread(map, [x + x0 - reach, y + y0 - reach, x + x1 + reach, y + y1 + reach]);
    }

    /// Propagates smaller distances within a box (two passes), then sums its blocks. Along an axis that
    /// repeats the box may lie anywhere.
    fn spread(&mut self, map: &Occupancy<'_>, [x0, y0, x1, y1]: [i32; 4]) {
        let grid = &map.grid;
        let clip = |v: i32, size: i32, wrap: bool| if wrap { v } else { v.clamp(0, size) };
        let (x0, x1) = (clip(x0, grid.width, grid.tile.x), clip(x1, grid.width, grid.tile.x));
        let (y0, y1) = (clip(y0, grid.height, grid.tile.y), clip(y1, grid.height, grid.tile.y));
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        // A copy of the box with a frame of one cell, whose distances propagate inwards.
        let (w, h) = ((x1 - x0 + 2) as usize, (y1 - y0 + 2) as usize);
        let mut copy = std::mem::take(&mut self.scratch);
        copy.clear();
        copy.resize(w * h, self.limit);
        let row_span = Span { y: 0, x0: x0 - 1, x1: x1 + 1 };
        for (j, line) in copy.chunks_exact_mut(w).enumerate() {
            let mut span = row_span;
            // A run as long as the period or longer is split at the seam.
            while span.x0 < row_span.x1 {
                span.x1 = row_span.x1.min(span.x0 + grid.width);
                for run in grid.runs(span, [0, y0 - 1 + j as i32]) {
                    let at = (run.at[0] - (x0 - 1)) as usize;
                    line[at..at + run.cells.len()].copy_from_slice(&self.distance[run.cells]);
                }
                span.x0 = span.x1;
            }
        }
        for j in 1..h {
            let (above, rest) = copy.split_at_mut(j * w);
            let row = &mut rest[..w];
            from_row(row, &above[above.len() - w..]);
            for i in 1..w {
                row[i] = row[i].min(row[i - 1].saturating_add(STRAIGHT));
            }
        }
        for j in (0..h - 1).rev() {
            let (before, below) = copy.split_at_mut((j + 1) * w);
            let row = &mut before[j * w..];
            from_row(row, &below[..w]);
            for i in (1..w).rev() {
                row[i - 1] = row[i - 1].min(row[i].saturating_add(STRAIGHT));
            }
        }
        for (j, line) in copy.chunks_exact(w).enumerate().take(h - 1).skip(1) {
            let mut span = Span { y: 0, x0, x1 };
            while span.x0 < x1 {
                span.x1 = x1.min(span.x0 + grid.width);
                for run in grid.runs(span, [0, y0 - 1 + j as i32]) {
                    let at = (run.at[0] - (x0 - 1)) as usize;
                    for (d, new) in self.distance[run.cells].iter_mut().zip(&line[at..]) {
                        *d = (*d).min(*new);
                    }
                }
                span.x0 = span.x1;
            }
        }
        self.scratch = copy;
        self.sum_blocks(map, [x0, y0, x1, y1]);
    }

    /// Sums the blocks that a box touches.
    fn sum_blocks(&mut self, map: &Occupancy<'_>, [x0, y0, x1, y1]: [i32; 4]) {
        // The blocks of an axis that an interval touches, each once.
        let touched = |low: i32, high: i32, size: i32, wrap: bool| {
            let count = (size + BLOCK - 1) / BLOCK;
            if !wrap {
                return (low / BLOCK..(high - 1) / BLOCK + 1).collect::<Vec<_>>();
            }
            let mut blocks: Vec<i32> =
                (low..high.min(low + size)).map(|v| v.rem_euclid(size) / BLOCK).collect();
            blocks.dedup();
            if blocks.len() > 1 && blocks.first() == blocks.last() {
                blocks.pop();
            }
            debug_assert!(blocks.len() <= count as usize);
            blocks
        };
        let columns = touched(x0, x1, map.grid.width, map.grid.tile.x);
        for by in touched(y0, y1, map.grid.height, map.grid.tile.y) {
            for &bx in &columns {
                let block = by * self.columns + bx;
                let mut sum = 0;
                self.visit(map, block, |_, d| {
                    sum += d;
                    false
                });
                self.blocks.set(block as usize, sum);
            }
        }
    }

    /// Calls `visit(cell, distance)` for the cells of a block that may be drawn, until `visit` returns a
    /// result.
    fn visit(&self, map: &Occupancy<'_>, block: i32, mut visit: impl FnMut([i32; 2], u64) -> bool) {
        let (bx, by) = (block % self.columns, block / self.columns);
        let range =
            |b: i32, frame: i32, size: i32| (b * BLOCK).max(frame)..((b + 1) * BLOCK).min(size - frame);
        for y in range(by, self.frame[1], map.grid.height) {
            for x in range(bx, self.frame[0], map.grid.width) {
                let i = map.grid.index(x, y);
                if map.region.zone(i).is_some() && visit([x, y], u64::from(self.distance[i])) {
                    return;
                }
            }
        }
    }

    /// A free cell drawn in proportion to its distance; `None` if there is none.
    pub(super) fn draw(&self, map: &Occupancy<'_>, random: &mut Stream) -> Option<[i32; 2]> {
        let block = self.blocks.draw(random)?;
        let mut left = random.below(self.blocks.get(block));
        let mut drawn = None;
        self.visit(map, block as i32, |cell, d| {
            let hit = left < d;
            if hit {
                drawn = Some(cell);
            } else {
                left -= d;
            }
            hit
        });
        drawn
    }
}

/// Propagates distances from the neighbouring row.
fn from_row(row: &mut [u8], other: &[u8]) {
    for (d, o) in row.iter_mut().zip(other) {
        *d = (*d).min(o.saturating_add(STRAIGHT));
    }
    for (d, o) in row[1..].iter_mut().zip(other) {
        *d = (*d).min(o.saturating_add(DIAGONAL));
    }
    for (d, o) in row.iter_mut().zip(&other[1..]) {
        *d = (*d).min(o.saturating_add(DIAGONAL));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrange::controls::Controls;
    use crate::arrange::grid::Grid;
    use crate::arrange::model::{PlaceableId, PlacementModel};
    use crate::arrange::region::PlacementRegion;
    use vtex_base::sampling::stream;
    use vtex_scene::library::testing::{library, mosaic};
    use vtex_scene::scene::{SynthParams, Tile};

    #[test]
    fn kept_up_to_date_as_if_made_anew() {
        let library = library(&mosaic(100, 14.0, 0.8, 1));
        let controls = Controls::default();
        for (tile, width, height) in [
            (Tile::default(), 90, 70),
            (Tile { x: true, y: true }, 90, 70),
            (Tile { x: true, y: false }, 37, 64),
            (Tile { x: false, y: true }, 90, 25),
        ] {
            let params = SynthParams { width, height, tile, ..SynthParams::default() };
            let model = PlacementModel::new(std::slice::from_ref(&library), &params);
            let grid = Grid::around(&model, &params);
            let region = PlacementRegion::new(&grid, &controls, params.edge, false);
            let placeable: Vec<PlaceableId> = model.members.iter().flatten().copied().collect();
            let mut random = stream(1, "clearance test", 0);
            let mut map = Occupancy::new(&model, region, grid);
            let mut clearance = Clearance::new(&map, 12, 4);
            for _ in 0..8 {
                let at = [map.grid.width, map.grid.height].map(|size| random.index(size as usize) as i32);
                let variant = model.in_variation(placeable[random.index(placeable.len())], 0);
                let id = map.stand(variant, at, 0.0, |_| {});
                clearance.add(&map, id);
                let anew = Clearance::new(&map, 12, 4);
                assert!(clearance.distance == anew.distance, "{tile:?}");
                for block in 0..(clearance.columns * ((map.grid.height + BLOCK - 1) / BLOCK)) as usize {
                    assert_eq!(clearance.blocks.get(block), anew.blocks.get(block));
                }
                for _ in 0..20 {
                    if let Some([x, y]) = clearance.draw(&map, &mut random) {
                        assert!(!map.taken(map.grid.index(x, y)));
                    }
                }
            }
            // Close to the true distance (within the error of the chamfer, 8 %).
            let (w, h) = (map.grid.width, map.grid.height);
            let copies = |wrap: bool, size: i32| if wrap { vec![-size, 0, size] } else { vec![0] };
            let taken: Vec<[i32; 2]> =
                (0..map.grid.len()).filter(|&i| map.taken(i)).map(|i| map.grid.place(i)).collect();
            for i in (0..map.grid.len()).step_by(7) {
                let [x, y] = map.grid.place(i);
                let mut nearest = 12.0f64;
                for [px, py] in &taken {
                    for u in copies(tile.x, w) {
                        for v in copies(tile.y, h) {
                            nearest = nearest.min(libm::hypot(f64::from(px + u - x), f64::from(py + v - y)));
                        }
                    }
                }
                let got = f64::from(clearance.distance[i]) / 3.0;
                assert!((got - nearest).abs() <= 0.09 * nearest + 0.34, "{got} {nearest}");
            }
        }
    }
}
