//! Copies: places on the canvas that show the same part of an exemplar. A source with a copy nearby costs
//! more.

use super::atlas::Atlas;
use super::canvas::LevelCanvas;

/// Side of the blocks of an exemplar that are told apart, in cells.
const BLOCK: i32 = 4;
/// Places of a block that differ by no more are the same copy, in cells of the finest level.
const SAME: i32 = 2;
/// Distance over which copies count, as a share of the shorter side of the smallest page: in exhaustive
/// searches and in others.
const REACH: [f32; 2] = [0.6, 0.25];

/// The places on the canvas of each block of an atlas.
pub(super) struct BlockCopies {
    /// Blocks in a row of the atlas.
    columns: usize,
    /// Index of the first place of each block.
    starts: Vec<u32>,
    /// Places of the first cells of blocks, row before column, in order.
    places: Vec<[i32; 2]>,
    stride: usize,
    size: [i32; 2],
    wrap: [bool; 2],
    /// In cells.
    reach: f32,
    /// Places that differ by no more are one, in cells.
    same: i32,
}

impl BlockCopies {
    pub(super) fn new(canvas: &LevelCanvas, atlas: &Atlas, exhaustive: bool) -> Self {
        let shortest = atlas.pages.iter().flat_map(|p| p.size).min().unwrap_or(1);
        let reach = REACH[usize::from(!exhaustive)] * shortest as f32;
        let columns = atlas.stride.div_ceil(BLOCK as usize);
        let rows = (atlas.inside.len() / atlas.stride).div_ceil(BLOCK as usize);
        let mut this = Self {
            columns,
            starts: vec![0; columns * rows + 1],
            places: Vec::new(),
            stride: atlas.stride,
            size: canvas.size.map(|v| v as i32),
            wrap: canvas.wrap,
            reach,
            same: SAME >> atlas.level,
        };
        let [w, h] = canvas.size;
        let mut found: Vec<(u32, [i32; 2])> = Vec::new();
        // Blocks and places of the row above, because the cells of an island repeat them.
        let mut above: Vec<(u32, [i32; 2])> = vec![(u32::MAX, [0; 2]); w];
        for y in 0..h {
            for x in 0..w {
                let i = y * w + x;
                if !canvas.is_active(i) {
                    continue;
                }
                let key = this.place(canvas.sources[i], [x as i32, y as i32]);
                let known = above[x] == key || (x > 0 && above[x - 1] == key);
                above[x] = key;
                if !known {
                    found.push(key);
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found.iter().for_each(|(block, _)| this.starts[*block as usize + 1] += 1);
        (1..this.starts.len()).for_each(|b| this.starts[b] += this.starts[b - 1]);
        this.places = found.into_iter().map(|(_, place)| place).collect();
        this
    }

    /// The block of a source, and the place of its first cell, row before column, if the source is shown at a
    /// cell.
    fn place(&self, source: u32, cell: [i32; 2]) -> (u32, [i32; 2]) {
        let [x, y] = [source as usize % self.stride, source as usize / self.stride].map(|v| v as i32);
        let block = (y / BLOCK) as usize * self.columns + (x / BLOCK) as usize;
        let at = |v: i32, k: usize| {
            if self.wrap[k] { v.rem_euclid(self.size[k]) } else { v }
        };
        (block as u32, [at(cell[1] - y % BLOCK, 1), at(cell[0] - x % BLOCK, 0)])
    }

    /// Proximity of the nearest earlier copy of a source: 1 at the same place, 0 out of reach. Only earlier
    /// copies count, so that only the later of two copies is moved.
    pub(super) fn nearness(&self, source: u32, cell: usize) -> f32 {
        let width = self.size[0] as usize;
        let cell = [(cell % width) as i32, (cell / width) as i32];
        let (block, own) = self.place(source, cell);
        let list = self.starts[block as usize] as usize..self.starts[block as usize + 1] as usize;
        let places = &self.places[list];
        let earlier = &places[..places.partition_point(|p| *p < own)];
        let rows_above = earlier.iter().rev().map(|place| (place, own[0] - place[0]));
        let across = if self.wrap[1] { earlier } else { &[] };
        let rows_across = across.iter().map(|place| (place, place[0] + self.size[1] - own[0]));
        // Squared. Rows come nearest first, so no place further on is nearer.
        let mut nearest = libm::ceilf(self.reach * self.reach) as i32;
        let mut look = |place: &[i32; 2], rows: i32| {
            let [dy, dx] = [0, 1].map(|k| {
                let (d, axis) = ((place[k] - own[k]).abs(), 1 - k);
                if self.wrap[axis] { d.min(self.size[axis] - d) } else { d }
            });
            if dx.max(dy) > self.same {
                nearest = nearest.min(dx * dx + dy * dy);
            }
            rows * rows < nearest
        };
        for (place, rows) in rows_above {
            if !look(place, rows) {
                break;
            }
        }
        for (place, rows) in rows_across {
            if !look(place, rows) {
                break;
            }
        }
        (1.0 - libm::sqrtf(nearest as f32) / self.reach).max(0.0)
    }
}
