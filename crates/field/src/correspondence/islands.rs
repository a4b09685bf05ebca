//! Islands: adjacent cells that come from one place.

use super::atlas::Atlas;
use super::canvas::LevelCanvas;
use super::search::Best;
use super::{CellSource, CorrespondenceField};
use vtex_base::disjoint_sets::DisjointSets;

/// The island of each cell.
pub struct Islands {
    /// Number of the island of each cell, row by row.
    pub of: Vec<u32>,
    /// Number of cells of each island.
    pub sizes: Vec<u32>,
}

impl Islands {
    /// The islands of a field.
    pub fn new(field: &CorrespondenceField) -> Self {
        let continues = |a: CellSource, b: CellSource, d: [i32; 2]| {
            a.page == b.page && (0..2).all(|k| i32::from(b.at[k]) - i32::from(a.at[k]) == d[k])
        };
        let s = &field.sources;
        Self::connected(field.size, field.wrap, |i, j, d| continues(s[i], s[j], d))
    }

    /// Joins each cell to the next one to the right and below where `joined(cell, next, offset)` holds.
    fn connected(size: [usize; 2], wrap: [bool; 2], joined: impl Fn(usize, usize, [i32; 2]) -> bool) -> Self {
        let [w, h] = size;
        let mut sets = DisjointSets::new(w * h);
        for y in 0..h {
            for x in 0..w {
                let i = y * w + x;
                let right = if x + 1 < w { Some(i + 1) } else { wrap[0].then_some(y * w) };
                let below = if y + 1 < h { Some(i + w) } else { wrap[1].then_some(x) };
                for (next, offset) in [(right, [1, 0]), (below, [0, 1])] {
                    if let Some(j) = next.filter(|&j| joined(i, j, offset)) {
                        sets.join(i, j);
                    }
                }
            }
        }
        let (of, count) = sets.indices();
        let mut sizes = vec![0; count];
        of.iter().for_each(|&island| sizes[island as usize] += 1);
        Self { of, sizes }
    }
}

impl LevelCanvas {
    /// Gives the cells of islands with fewer than `least` cells to the adjacent islands that fit best.
    pub(super) fn absorb_small_islands(&mut self, atlas: &Atlas, least: u32) {
        self.copy_sources(atlas);
        let islands = Islands::connected(self.size, self.wrap, |i, j, [dx, dy]| {
            atlas.moved(self.sources[i], dx as isize, dy as isize) == Some(self.sources[j])
        });
        let none = vec![0; atlas.inside.len()];
        let mut settled: Vec<bool> = islands.of.iter().map(|&k| islands.sizes[k as usize] >= least).collect();
        let mut open: Vec<usize> = (0..settled.len()).filter(|&i| !settled[i]).collect();
        while !open.is_empty() {
            let mut changes = Vec::new();
            for &i in &open {
                let at = [i % self.size[0], i / self.size[0]];
                let mut best = Best::new(self, atlas, at, &none);
                for d in [[-1, 0], [1, 0], [0, -1], [0, 1]] {
                    if self.neighbour(at, d).is_some_and(|q| settled[q])
                        && let Some(source) = self.continued(atlas, at, d)
                    {
                        best.consider(source, 8);
                    }
                }
                if best.cost < i32::MAX {
                    changes.push((i, best.source));
                }
            }
            if changes.is_empty() {
                break;
            }
            for &(i, source) in &changes {
                self.show(atlas, [i % self.size[0], i / self.size[0]], source);
                settled[i] = true;
            }
            self.frame();
            open.retain(|&i| !settled[i]);
        }
    }
}
