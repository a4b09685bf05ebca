//! Exemplar cells with similar neighbourhoods.

use super::atlas::{Atlas, distance};
use super::{LANES, PATCH, RowProgress};
use vtex_base::parallel;

/// Similar cells kept for each cell.
const KEPT: usize = 4;
/// Marks a missing cell.
const NONE: u32 = u32::MAX;

/// For each cell of an atlas the most similar cells of the same group, except those close to it.
pub(super) struct Similar {
    cells: Vec<[u32; KEPT]>,
}

impl Similar {
    /// Compares all cells with all.
    pub(super) fn coarsest(atlas: &Atlas, watch: &RowProgress<'_>) -> Self {
        let all: Vec<Vec<u32>> = (0..=atlas.last_group()).map(|g| atlas.compared(g)).collect();
        Self::best(atlas, watch, |cell| all[usize::from(atlas.group(cell))].iter().copied())
    }

    /// Compares each cell with those in and around the cells that are similar on the coarser level.
    pub(super) fn finer(&self, coarse: &Atlas, fine: &Atlas, watch: &RowProgress<'_>) -> Self {
        Self::best(fine, watch, |cell| {
            let source = fine.source(cell);
            let page = usize::from(source.page);
            let parent = coarse.cell(page, source.at.map(|v| i64::from(v) / 2));
            let inner = source.at.map(|v| i64::from(v) % 2);
            let like = self.cells[parent as usize].into_iter().filter(|&c| c != NONE);
            like.flat_map(move |c| {
                let like = coarse.source(c);
                (-1..=1).flat_map(move |dy| {
                    (-1..=1).map(move |dx| {
                        let at = [0, 1].map(|k| 2 * i64::from(like.at[k]) + inner[k] + [dx, dy][k]);
                        fine.cell(usize::from(like.page), at)
                    })
                })
            })
        })
    }

    /// Keeps the best candidates of each cell.
    fn best<I: Iterator<Item = u32>>(
        atlas: &Atlas,
        watch: &RowProgress<'_>,
        candidates: impl Fn(u32) -> I + Sync,
    ) -> Self {
        let mut cells = vec![[NONE; KEPT]; atlas.inside.len()];
        let row = atlas.stride * LANES;
        parallel::for_chunks(&mut cells, atlas.stride, |y, cells| {
            if !watch.keep_going(0) {
                return;
            }
            for (x, kept) in cells.iter_mut().enumerate() {
                let cell = y * atlas.stride + x;
                if !atlas.inside[cell] {
                    continue;
                }
                let own = &atlas.features[atlas.patch(cell as u32)..];
                let mut costs = [i32::MAX; KEPT];
                for other in candidates(cell as u32) {
                    let (ox, oy) = (other as usize % atlas.stride, other as usize / atlas.stride);
                    let near = ox.abs_diff(x) < PATCH && oy.abs_diff(y) < PATCH;
                    if near || !atlas.inside[other as usize] || kept.contains(&other) {
                        continue;
                    }
                    let there = &atlas.features[atlas.patch(other)..];
                    let cost = distance(own, row, there, row, costs[KEPT - 1]);
                    let Some(place) = costs.iter().position(|&c| cost < c) else { continue };
                    costs.copy_within(place..KEPT - 1, place + 1);
                    kept.copy_within(place..KEPT - 1, place + 1);
                    (costs[place], kept[place]) = (cost, other);
                }
            }
        });
        Self { cells }
    }

    /// The cells most similar to a cell, the best first.
    #[inline]
    pub(super) fn of(&self, cell: u32) -> impl Iterator<Item = u32> + '_ {
        self.cells[cell as usize].iter().copied().take_while(|&c| c != NONE)
    }
}
