//! Bands of the target map that are filled independently and put together again.
//!
//! Rows are divided into bands. Every second band is taken out, together with the rows around it that an
//! element and its descriptor can reach. These windows have no cell in common, so they are filled at the same
//! time and put back in a fixed order. Then the other bands are filled, which see the elements placed around
//! them. The result depends on the bands, not on which thread fills them when. Canvases of fewer than four
//! bands are filled in one go.

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

/// How the rows of a map are divided.
pub(in crate::arrange) struct Bands {
    /// Rows around each band that its window holds too.
    halo: i32,
    /// The rows of each band.
    pub(super) cores: Vec<Range<i32>>,
}

impl Bands {
    /// Bands for a map; `None` if it is too small.
    pub(in crate::arrange) fn new(model: &PlacementModel, grid: &Grid) -> Option<Self> {
        // A texton at the edge of a band, and its descriptor.
        let halo = model.half + model.reach + 2;
        let mut count = grid.height / LEAST_ROWS.max(2 * halo);
        if grid.tile.y {
            count -= count % 2; // The last is the first one's neighbour.
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

/// A window of a map, a map of its own.
pub(super) struct Window<'a> {
    pub(super) map: TargetMap<'a>,
    rows: Range<i32>,
    /// Numbers of elements and requests of the whole map.
    placed: usize,
    requests: usize,
}

/// The changes made in a window.
pub(super) struct Filled {
    rows: Range<i32>,
    /// Numbers of elements and requests of the whole map when the window was made.
    known: (u32, u32),
    state: Vec<u16>,
    owner: Vec<Owner>,
    placed: Vec<Standing>,
    /// Cells that became hidden, by index of the earlier element.
    hidden: Vec<(usize, u32)>,
    requests: Vec<ElementRequest>,
    /// Requests of the band, all of them answered or refused.
    done: Vec<RequestId>,
    deferred: Vec<RequestId>,
    /// Change of the cells covered, by zone and category.
    covered: Vec<Vec<i64>>,
}

impl<'a> Window<'a> {
    fn new(whole: &TargetMap<'a>, rows: Range<i32>, core: &Range<i32>) -> Self {
        let grid = whole.grid();
        // Across a seam, the rows nearest to the window.
        let beside = (grid.height - rows.len() as i32) / 2;
        let place = |[x, y]: [i32; 2]| {
            let local = y - rows.start;
            [x, if grid.tile.y { (local + beside).rem_euclid(grid.height) - beside } else { local }]
        };
        let mut map = TargetMap::new(whole.cells.band(&rows, place));
        map.core = Some(core.start - rows.start..core.end - rows.start);
        map.requests = whole.requests.iter().map(|r| ElementRequest { at: place(r.at), ..*r }).collect();
        map.weights = WeightTree::zeros(map.requests.len());
        for i in 0..map.requests.len() {
            if map.in_core(RequestId(i as u32)) {
                map.weights.set(i, whole.weights.get(i));
            }
        }
        let (placed, requests) = (whole.cells.placed.len(), whole.requests.len());
        Self { map, rows, placed, requests }
    }

    /// The changes to apply to the whole map.
    pub(super) fn filled(self, whole: &TargetMap<'_>) -> Filled {
        let Self { mut map, rows, placed, requests } = self;
        let place = |at: [i32; 2]| whole.grid().canonical([at[0], at[1] + rows.start]);
        let before = |(i, p): (usize, &Standing)| (i, whole.cells.placed[i].visible - p.visible);
        let hidden = map.cells.placed[..placed].iter().enumerate().map(before).filter(|h| h.1 > 0).collect();
        let change = |(new, old): (&Vec<u64>, &Vec<u64>)| {
            new.iter().zip(old).map(|(n, o)| *n as i64 - *o as i64).collect()
        };
        let new = map.cells.placed[placed..].iter();
        Filled {
            hidden,
            placed: new.map(|p| Standing { at: place(p.at), ..*p }).collect(),
            requests: map.requests[requests..]
                .iter()
                .map(|r| ElementRequest { at: place(r.at), ..*r })
                .collect(),
            done: (0..requests as u32).map(RequestId).filter(|&id| map.in_core(id)).collect(),
            deferred: std::mem::take(&mut map.deferred),
            covered: map.cells.covered.iter().zip(&whole.cells.covered).map(change).collect(),
            state: map.cells.state,
            owner: map.cells.owner,
            known: (placed as u32, requests as u32),
            rows,
        }
    }
}

impl Filled {
    /// A request as the whole map numbers it, which has `more` requests than when the window was made.
    fn request(&self, id: RequestId, more: u32) -> RequestId {
        if id.0 >= self.known.1 { RequestId(id.0 + more) } else { id }
    }

    /// An owner as the whole map numbers it, which has `more` elements and requests.
    fn owner(&self, owner: Owner, more: (u32, u32)) -> Owner {
        if let Some(request) = owner.as_request() {
            return Owner::request(self.request(request, more.1));
        }
        match owner.as_placed() {
            Some(id) if id.0 >= self.known.0 => Owner::placed(PlacedId(id.0 + more.0)),
            _ => owner,
        }
    }
}

impl TargetMap<'_> {
    /// Applies the changes of the windows of one batch, in their order.
    pub(super) fn absorb(&mut self, windows: Vec<Filled>, choice: &mut MemberWeights) {
        let mut again = Vec::new();
        for filled in windows {
            // Each window numbered its new elements as if it were the only one.
            let more = (
                self.cells.placed.len() as u32 - filled.known.0,
                self.requests.len() as u32 - filled.known.1,
            );
            let width = self.grid().width as usize;
            let lines = filled.state.chunks_exact(width).zip(filled.owner.chunks_exact(width));
            for (row, (state, owners)) in filled.rows.clone().zip(lines) {
                let start = self.grid().index(0, row.rem_euclid(self.grid().height));
                self.cells.state[start..start + width].copy_from_slice(state);
                for (to, &from) in self.cells.owner[start..start + width].iter_mut().zip(owners) {
                    *to = filled.owner(from, more);
                }
            }
            for &(i, cells) in &filled.hidden {
                self.cells.placed[i].visible -= cells;
            }
            for &placed in &filled.placed {
                choice.used(self.model(), placed.variant);
                self.cells.adopt(placed);
            }
            for done in &filled.done {
                self.weights.set(done.0 as usize, 0);
            }
            for &new in &filled.requests {
                self.requests.push(new);
                self.weights.push(0);
            }
            again.extend(filled.deferred.iter().map(|&id| filled.request(id, more.1)));
            let totals = self.cells.covered.iter_mut().flatten();
            for (total, change) in totals.zip(filled.covered.iter().flatten()) {
                *total = total.wrapping_add_signed(*change);
            }
        }
        again.sort_unstable();
        again.dedup();
        again.into_iter().for_each(|request| self.weigh(request));
    }
}
