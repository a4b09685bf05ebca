//! Bands of the target map, filled independently of each other.
//!
//! Rows are divided into bands. Every second band is taken out, together with the rows around it that an
//! element and its descriptor can reach. These windows have no cell in common, so they are filled at the same
//! time and written back in a fixed order. Then the other bands are filled, around the elements placed
//! before. The result depends on the bands, not on which thread fills them when. Canvases of fewer than four
//! bands are filled as a whole.

use super::target::{ElementRequest, TargetMap};
use crate::arrange::choice::MemberWeights;
use crate::arrange::grid::Grid;
use crate::arrange::model::PlacementModel;
use crate::arrange::occupancy::{Owner, PlacedId, RequestId, Standing};
use std::ops::Range;
use vtex_base::sampling::WeightTree;

/// Fewest rows of a band.
const LEAST_ROWS: i32 = 192;
/// Fewest bands that are worth the division.
const FEWEST: i32 = 4;

/// The division of the rows of a map.
pub(in crate::arrange) struct Bands {
    /// Rows around each band that its window holds too.
    halo: i32,
    /// The rows of each band.
    pub(super) cores: Vec<Range<i32>>,
}

impl Bands {
    /// Bands for a map; `None` if it is too small.
    pub(in crate::arrange) fn new(model: &PlacementModel, grid: &Grid) -> Option<Self> {
        // An element at the edge of a band reaches this far with its descriptor.
        let halo = model.half + model.reach + 2;
        let mut count = grid.height / LEAST_ROWS.max(2 * halo);
        if grid.tile.y {
            count -= count % 2; // The last band is next to the first.
        }
        let start = |k: i32| (i64::from(k) * i64::from(grid.height) / i64::from(count)) as i32;
        (count >= FEWEST).then(|| Self { halo, cores: (0..count).map(|k| start(k)..start(k + 1)).collect() })
    }

    /// A band's window of a map.
    pub(super) fn window<'a>(&self, map: &TargetMap<'a>, band: usize) -> Window<'a> {
        let core = &self.cores[band];
        let mut rows = core.start - self.halo..core.end + self.halo;
        if !map.grid().tile.y {
            rows = rows.start.max(0)..rows.end.min(map.grid().height);
        }
        Window::new(map, rows, core)
    }
}

/// A part of a map as a map of its own.
pub(super) struct Window<'a> {
    pub(super) map: TargetMap<'a>,
    rows: Range<i32>,
    /// Of the whole map.
    counts: MapCounts,
}

/// Numbers of elements and requests of a map.
#[derive(Clone, Copy)]
struct MapCounts {
    placed: u32,
    requests: u32,
}

impl MapCounts {
    fn of(map: &TargetMap<'_>) -> Self {
        Self { placed: map.cells.placed.len() as u32, requests: map.requests.len() as u32 }
    }
}

/// The changes made in a window.
pub(super) struct WindowChanges {
    rows: Range<i32>,
    /// Of the whole map when the window was made.
    before: MapCounts,
    state: Vec<u16>,
    owner: Vec<Owner>,
    placed: Vec<Standing>,
    /// Indices of the elements placed before, with the number of cells of each that became hidden.
    hidden: Vec<(usize, u32)>,
    requests: Vec<ElementRequest>,
    /// Requests of the band: each was answered or refused.
    done: Vec<RequestId>,
    deferred: Vec<RequestId>,
    /// Change of the cells covered, by zone and category.
    covered: Vec<Vec<i64>>,
}

impl<'a> Window<'a> {
    fn new(whole: &TargetMap<'a>, rows: Range<i32>, core: &Range<i32>) -> Self {
        let grid = whole.grid();
        // On a map that repeats, each place has copies a period apart. The copy nearest to the window is used.
        let outside = (grid.height - rows.len() as i32) / 2;
        let to_window = |[x, y]: [i32; 2]| {
            let y = y - rows.start;
            [x, if grid.tile.y { (y + outside).rem_euclid(grid.height) - outside } else { y }]
        };
        let mut map = TargetMap::new(whole.cells.band(&rows, to_window));
        map.core = Some(core.start - rows.start..core.end - rows.start);
        map.requests = whole.requests.iter().map(|r| ElementRequest { at: to_window(r.at), ..*r }).collect();
        map.weights = WeightTree::zeros(map.requests.len());
        for i in 0..map.requests.len() {
            if map.in_core(RequestId(i as u32)) {
                map.weights.set(i, whole.weights.get(i));
            }
        }
        Self { map, rows, counts: MapCounts::of(whole) }
    }

    /// The changes to apply to the whole map.
    pub(super) fn changes(self, whole: &TargetMap<'_>) -> WindowChanges {
        let Self { mut map, rows, counts: before } = self;
        let to_whole = |at: [i32; 2]| whole.grid().canonical([at[0], at[1] + rows.start]);
        let (old, new) = map.cells.placed.split_at(before.placed as usize);
        let hidden = |(i, p): (usize, &Standing)| (i, whole.cells.placed[i].visible - p.visible);
        let hidden = old.iter().enumerate().map(hidden).filter(|&(_, cells)| cells > 0).collect();
        let change = |(new, old): (&Vec<u64>, &Vec<u64>)| {
            new.iter().zip(old).map(|(n, o)| *n as i64 - *o as i64).collect()
        };
        WindowChanges {
            hidden,
            placed: new.iter().map(|p| Standing { at: to_whole(p.at), ..*p }).collect(),
            requests: map.requests[before.requests as usize..]
                .iter()
                .map(|r| ElementRequest { at: to_whole(r.at), ..*r })
                .collect(),
            done: (0..before.requests).map(RequestId).filter(|&id| map.in_core(id)).collect(),
            deferred: std::mem::take(&mut map.deferred),
            covered: map.cells.covered.iter().zip(&whole.cells.covered).map(change).collect(),
            state: map.cells.state,
            owner: map.cells.owner,
            before,
            rows,
        }
    }
}

impl WindowChanges {
    /// A request as the whole map numbers it. `added` counts what was added there since the window was made.
    fn request(&self, id: RequestId, added: MapCounts) -> RequestId {
        if id.0 >= self.before.requests { RequestId(id.0 + added.requests) } else { id }
    }

    /// An owner as the whole map numbers it; `added` as for [`Self::request`].
    fn owner(&self, owner: Owner, added: MapCounts) -> Owner {
        if let Some(request) = owner.as_request() {
            return Owner::request(self.request(request, added));
        }
        match owner.as_placed() {
            Some(id) if id.0 >= self.before.placed => Owner::placed(PlacedId(id.0 + added.placed)),
            _ => owner,
        }
    }
}

impl TargetMap<'_> {
    /// Applies the changes of the windows of one batch, in their order.
    pub(super) fn absorb(&mut self, windows: Vec<WindowChanges>, choice: &mut MemberWeights) {
        let mut deferred = Vec::new();
        for changes in windows {
            // Each window numbered its new elements as if it were the only one.
            let now = MapCounts::of(self);
            let added = MapCounts {
                placed: now.placed - changes.before.placed,
                requests: now.requests - changes.before.requests,
            };
            let width = self.grid().width as usize;
            let lines = changes.state.chunks_exact(width).zip(changes.owner.chunks_exact(width));
            for (row, (state, owners)) in changes.rows.clone().zip(lines) {
                let start = self.grid().index(0, row.rem_euclid(self.grid().height));
                self.cells.state[start..start + width].copy_from_slice(state);
                for (to, &from) in self.cells.owner[start..start + width].iter_mut().zip(owners) {
                    *to = changes.owner(from, added);
                }
            }
            for &(i, cells) in &changes.hidden {
                self.cells.placed[i].visible -= cells;
            }
            for &placed in &changes.placed {
                choice.used(self.model(), placed.variant);
                self.cells.adopt(placed);
            }
            for done in &changes.done {
                self.weights.set(done.0 as usize, 0);
            }
            for &new in &changes.requests {
                self.requests.push(new);
                self.weights.push(0);
            }
            deferred.extend(changes.deferred.iter().map(|&id| changes.request(id, added)));
            let totals = self.cells.covered.iter_mut().flatten();
            for (total, change) in totals.zip(changes.covered.iter().flatten()) {
                *total = total.wrapping_add_signed(*change);
            }
        }
        deferred.sort_unstable();
        deferred.dedup();
        deferred.into_iter().for_each(|request| self.weigh(request));
    }
}
