//! Bands of the target map that are filled apart from each other, and put together again.
//!
//! Rows are divided into bands. Every second band is taken out, with so many rows around it that
//! nothing placed for a request within the band can matter beyond; these windows have no cell in
//! common, so they may be filled at the same time. Then the other bands follow, which see what now
//! stands around them. What comes of it depends on the bands, not on who fills them when.

use super::choice::Choice;
use super::grid::Grid;
use super::model::Model;
use super::target::{NOBODY, Placed, REQUESTS, Request, TargetMap};
use std::ops::Range;

/// Fewest rows of a band.
const LEAST_ROWS: i32 = 192;
/// With fewer bands nothing is gained.
const FEWEST: i32 = 4;

/// How the rows of a map are divided.
pub(super) struct Bands {
    /// Rows around each band that its window holds too.
    halo: i32,
    /// The rows of each band.
    pub(super) cores: Vec<Range<i32>>,
}

impl Bands {
    /// Bands for a map; none if it is too small.
    pub(super) fn new(model: &Model, grid: &Grid) -> Option<Self> {
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
        if !map.grid.tile.y {
            rows = rows.start.max(0)..rows.end.min(map.grid.height);
        }
        Window::new(map, rows, core)
    }
}

/// A window of a map, a map of its own.
pub(super) struct Window<'a> {
    pub(super) map: TargetMap<'a>,
    rows: Range<i32>,
    /// Textons and requests that the whole map had.
    placed: usize,
    requests: usize,
}

/// What was done in a window.
pub(super) struct Harvest {
    rows: Range<i32>,
    /// Textons and requests that the whole map had when the window was made.
    known: (usize, usize),
    state: Vec<u16>,
    owner: Vec<u32>,
    placed: Vec<Placed>,
    /// Cells by which what stood before became less visible.
    hidden: Vec<(u32, u32)>,
    requests: Vec<Request>,
    /// Requests of the band, all of them dealt with.
    done: Vec<u32>,
    put_off: Vec<u32>,
    /// Change of the cells covered, by zone and category.
    covered: Vec<Vec<i64>>,
}

impl<'a> Window<'a> {
    fn new(whole: &TargetMap<'a>, rows: Range<i32>, core: &Range<i32>) -> Self {
        let grid = whole.grid.band(&rows);
        let ground = whole.ground.band(&whole.grid, &rows);
        let mut map = TargetMap::new(whole.model(), ground, grid);
        map.state = whole.grid.rows_of(&whole.state, &rows);
        map.owner = whole.grid.rows_of(&whole.owner, &rows);
        map.covered = whole.covered.clone();
        map.core = Some(core.start - rows.start..core.end - rows.start);
        // Across a seam, what is nearest to the window.
        let beside = (whole.grid.height - rows.len() as i32) / 2;
        let row = |y: i32| {
            let local = y - rows.start;
            if whole.grid.tile.y { (local + beside).rem_euclid(whole.grid.height) - beside } else { local }
        };
        map.placed = whole.placed.iter().map(|p| Placed { at: [p.at[0], row(p.at[1])], ..*p }).collect();
        map.requests = whole.requests.iter().map(|r| Request { at: [r.at[0], row(r.at[1])], ..*r }).collect();
        map.find_placed();
        map.weights = super::sums::Sums::zeros(map.requests.len());
        for i in 0..map.requests.len() {
            if map.in_core(i) {
                map.weights.set(i, whole.weights.get(i));
            }
        }
        let (placed, requests) = (whole.placed.len(), whole.requests.len());
        Self { map, rows, placed, requests }
    }

    /// What the whole map has to know.
    pub(super) fn harvest(self, whole: &TargetMap<'_>) -> Harvest {
        let Self { mut map, rows, placed, requests } = self;
        let place = |at: [i32; 2]| whole.grid.canonical([at[0], at[1] + rows.start]);
        let before = |(i, p): (usize, &Placed)| (i as u32, whole.placed[i].visible - p.visible);
        let hidden = map.placed[..placed].iter().enumerate().map(before).filter(|h| h.1 > 0).collect();
        let change = |(new, old): (&Vec<u64>, &Vec<u64>)| {
            new.iter().zip(old).map(|(n, o)| *n as i64 - *o as i64).collect()
        };
        Harvest {
            hidden,
            placed: map.placed[placed..].iter().map(|p| Placed { at: place(p.at), ..*p }).collect(),
            requests: map.requests[requests..].iter().map(|r| Request { at: place(r.at), ..*r }).collect(),
            done: (0..requests as u32).filter(|&i| map.in_core(i as usize)).collect(),
            put_off: std::mem::take(&mut map.put_off),
            covered: map.covered.iter().zip(&whole.covered).map(change).collect(),
            state: map.state,
            owner: map.owner,
            known: (placed, requests),
            rows,
        }
    }
}

impl TargetMap<'_> {
    /// Whether a request is to be answered here.
    fn in_core(&self, request: usize) -> bool {
        self.core.as_ref().is_none_or(|core| core.contains(&self.requests[request].at[1]))
    }

    /// Takes over what was done in the windows of one turn, in their order.
    pub(super) fn absorb(&mut self, harvests: Vec<Harvest>, choice: &mut Choice) {
        let mut again = Vec::new();
        for harvest in harvests {
            let (known, asked) = harvest.known;
            // Windows numbered what is new as if they were alone.
            let textons = (self.placed.len() - known) as u32;
            let requests = (self.requests.len() - asked) as u32;
            let (known, asked) = (known as u32, asked as u32);
            let request = |r: u32| if r >= asked { r + requests } else { r };
            let owner = |o: u32| match o {
                NOBODY => o,
                REQUESTS.. => REQUESTS + request(o - REQUESTS),
                _ => {
                    if o >= known {
                        o + textons
                    } else {
                        o
                    }
                }
            };
            let width = self.grid.width as usize;
            for (row, (state, owners)) in harvest
                .rows
                .clone()
                .zip(harvest.state.chunks_exact(width).zip(harvest.owner.chunks_exact(width)))
            {
                let start = self.grid.index(0, row.rem_euclid(self.grid.height));
                self.state[start..start + width].copy_from_slice(state);
                for (to, &from) in self.owner[start..start + width].iter_mut().zip(owners) {
                    *to = owner(from);
                }
            }
            for (id, cells) in harvest.hidden {
                self.placed[id as usize].visible -= cells;
            }
            for placed in harvest.placed {
                choice.used(self.model(), placed.form);
                self.placed.push(placed);
                self.find(self.placed.len() as u32 - 1);
            }
            for done in harvest.done {
                self.weights.set(done as usize, 0);
            }
            for new in harvest.requests {
                self.requests.push(new);
                self.weights.push(0);
            }
            again.extend(harvest.put_off.into_iter().map(request));
            for (total, change) in self.covered.iter_mut().flatten().zip(harvest.covered.iter().flatten()) {
                *total = total.wrapping_add_signed(*change);
            }
        }
        again.sort_unstable();
        again.dedup();
        again.into_iter().for_each(|request| self.weigh(request));
    }
}
