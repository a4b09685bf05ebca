//! Which primaries arrived where, and which of them stand.
//!
//! Every pixel that comes from a primary is a vote for that primary at the place where it would then
//! stand. Within an island all votes for a primary agree to the pixel; where two islands bring parts
//! of it from nearly the same place, the larger part says where. Those that arrived best stand first,
//! and none stands on others or on background by more than a little.

use super::Correspondence;
use crate::arrange::grid::Grid;
use crate::arrange::model::{Model, PlaceableId, VariantId};
use crate::library::{Library, SourceKind};
use crate::parallel;
use crate::raster::{LabelMap, Mask};
use std::collections::BTreeMap;

/// Cells by which places of one primary may differ and mean the same.
const SAME_PLACE: i32 = 2;

/// A round of acceptance.
struct Round {
    /// Least share of a primary that has arrived.
    arrived: f64,
    /// Most of it that may lie on others.
    on_others: f64,
    /// Most of it that may lie where no primary is wanted.
    on_background: f64,
}

/// From what arrived nearly whole to what arrived in part where there is room.
const ROUNDS: [Round; 3] = [
    Round { arrived: 0.5, on_others: 0.15, on_background: 0.35 },
    Round { arrived: 0.35, on_others: 0.12, on_background: 0.5 },
    Round { arrived: 0.2, on_others: 0.12, on_background: 0.5 },
];
/// An exemplar is packed if this share of the borders of primaries lies on others,
const CONTACT: f64 = 0.15;
/// or if primaries cover the second share of it (at the first it is not packed at all),
const COVERED: [f64; 2] = [0.45, 0.6];
/// or if secondaries cover such a share of its background, so that bare background is seen at once.
const TILED: [f64; 2] = [0.4, 0.6];
/// How much less may lie on others where none does in the exemplar.
const LOOSEST: f64 = 0.2;
/// Least share of a primary cut by the border of its exemplar.
const CLIPPED: f64 = 0.9;

/// A primary that arrived somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    /// Which variant.
    pub(super) variant: VariantId,
    /// Place of its origin on the map.
    pub(super) at: [i32; 2],
    /// Pixels that voted for it.
    pub(super) votes: u32,
}

/// A primary that stands.
pub(super) struct Standing {
    pub(super) variant: VariantId,
    pub(super) at: [i32; 2],
    /// At least half of it arrived.
    pub(super) whole: bool,
}

/// A pixel wants a primary.
const WANTED: u8 = 1;
/// A primary stands on a pixel.
const TAKEN: u8 = 2;

/// What is wanted and what stands, pixel by pixel of the map.
pub(super) struct Plan<'g> {
    pub(super) grid: &'g Grid,
    pixels: Vec<u8>,
    /// All that arrived; places that mean the same are one.
    pub(super) arrivals: Vec<Arrival>,
    /// Index of the arrival that each run of pixels of a row voted for: first column, end, index.
    pub(super) rows: Vec<Vec<(i32, i32, u32)>>,
    /// How packed each exemplar is, 0 to 1.
    packings: Vec<f64>,
    /// Whether elements of each exemplar may lie on others: not where it is a drawing in which none touch.
    apart: Vec<bool>,
}

/// A run of pixels of a row that come from one primary: first column, end, its variant and place.
type Vote = (i32, i32, VariantId, [i32; 2]);

impl<'g> Plan<'g> {
    /// Counts the votes of all pixels of a map.
    pub(super) fn new(
        correspondence: &Correspondence,
        libraries: &[Library],
        model: &Model,
        grid: &'g Grid,
    ) -> Self {
        let rows: Vec<i32> = (0..grid.height).collect();
        let votes: Vec<Vec<Vote>> = parallel::map(&rows, |&y| correspondence.votes(model, grid, y));
        let mut counts: Vec<(VariantId, [i32; 2], u32)> = Vec::new();
        for &(x0, x1, variant, at) in votes.iter().flatten() {
            counts.push((variant, at, (x1 - x0) as u32));
        }
        counts.sort_unstable_by_key(|c| (c.0, c.1));
        let mut sums: Vec<(VariantId, [i32; 2], u32)> = Vec::new();
        for (variant, at, count) in counts {
            match sums.last_mut() {
                Some(last) if (last.0, last.1) == (variant, at) => last.2 += count,
                _ => sums.push((variant, at, count)),
            }
        }
        let (arrivals, index) = merged(&sums, grid, SAME_PLACE * correspondence.pages.cell);
        let of = |&(x0, x1, variant, at): &Vote| {
            let k = sums.binary_search_by_key(&(variant, at), |s| (s.0, s.1)).unwrap_or(0);
            (x0, x1, index[k])
        };
        let mut pixels = vec![0; grid.len()];
        for (y, row) in votes.iter().enumerate() {
            for &(x0, x1, ..) in row {
                let start = grid.index(x0, y as i32);
                pixels[start..start + (x1 - x0) as usize].fill(WANTED);
            }
        }
        let rows = votes.iter().map(|row| row.iter().map(of).collect()).collect();
        let exemplars = || libraries.iter().zip(&correspondence.pages.labels);
        let packings = exemplars().map(|(library, labels)| packing(library, labels)).collect();
        let drawn = |library: &Library| library.source.kind == SourceKind::Drawing;
        let apart = exemplars().map(|(library, labels)| drawn(library) && !labels.any_touch()).collect();
        Self { grid, pixels, arrivals, rows, packings, apart }
    }

    /// How packed the exemplar of a variant is, 0 to 1.
    pub(super) fn packing(&self, model: &Model, variant: VariantId) -> f64 {
        self.packings[model.element(variant).library]
    }

    /// Most of a variant that may lie on others, as a share of the most for packed exemplars.
    pub(super) fn closeness(&self, model: &Model, variant: VariantId) -> f64 {
        if self.apart[model.element(variant).library] {
            return 0.0;
        }
        self.packing(model, variant).max(LOOSEST)
    }

    /// Most of a variant in a hole that may lie on others.
    pub(super) fn tolerance(&self, model: &Model, variant: VariantId) -> f64 {
        ROUNDS[1].on_others * self.closeness(model, variant)
    }

    /// Pixels of a mask at a place on which others stand, and on which none is wanted.
    pub(super) fn beneath(&self, mask: &Mask, at: [i32; 2]) -> (u32, u32) {
        let (mut taken, mut background) = (0, 0);
        for cells in mask.spans().iter().flat_map(|&s| self.grid.cells(s, at)) {
            for &p in &self.pixels[cells] {
                taken += u32::from(p & TAKEN != 0);
                background += u32::from(p == 0);
            }
        }
        (taken, background)
    }

    /// Whether a primary is wanted on a pixel.
    pub(super) fn is_wanted(&self, i: usize) -> bool {
        self.pixels[i] & WANTED != 0
    }

    /// Whether a primary is wanted on a pixel and none stands there.
    pub(super) fn is_hole(&self, i: usize) -> bool {
        self.pixels[i] == WANTED
    }

    /// Whether a primary stands on a pixel.
    pub(super) fn is_taken(&self, i: usize) -> bool {
        self.pixels[i] & TAKEN != 0
    }

    /// Number of pixels of the canvas of which something is so.
    pub(super) fn count(&self, is: impl Fn(&Self, usize) -> bool) -> usize {
        let [w, h] = self.grid.canvas().map(|v| v as i32);
        let [mx, my] = self.grid.margin;
        (my..my + h).map(|y| (mx..mx + w).filter(|&x| is(self, self.grid.index(x, y))).count()).sum()
    }

    /// Accepts arrivals round by round; `allowed` says where a variant may stand at all.
    pub(super) fn accept(
        &mut self,
        model: &Model,
        allowed: impl Fn(VariantId, [i32; 2]) -> bool,
    ) -> Vec<Standing> {
        let whole = |a: &Arrival| self.cells(model, a);
        let cells: Vec<u32> = parallel::map(&self.arrivals, whole);
        let share = |k: usize| {
            if cells[k] == 0 {
                0.0
            } else {
                (f64::from(self.arrivals[k].votes) / f64::from(cells[k])).min(1.0)
            }
        };
        let mut order: Vec<(u32, f64)> =
            (0..self.arrivals.len() as u32).map(|k| (k, share(k as usize))).collect();
        let rank = |&(k, share): &(u32, f64)| share * libm::sqrt(f64::from(cells[k as usize]));
        order.sort_by(|a, b| rank(b).total_cmp(&rank(a)).then(a.0.cmp(&b.0)));
        let mut standing = Vec::new();
        for (r, round) in ROUNDS.iter().enumerate() {
            order.retain(|&(k, share)| {
                let a = self.arrivals[k as usize];
                let clipped = model.element(a.variant).clipped;
                if share < if clipped { CLIPPED } else { round.arrived } {
                    return true;
                }
                if !allowed(a.variant, a.at) || !self.has_room(model, &a, cells[k as usize], round) {
                    return true;
                }
                self.stand(model, a.variant, a.at);
                standing.push(Standing { variant: a.variant, at: a.at, whole: r == 0 });
                false
            });
        }
        standing
    }

    /// Pixels of an arrival's variant on the map.
    fn cells(&self, model: &Model, a: &Arrival) -> u32 {
        let spans = model.shape(a.variant).mask.spans().iter();
        spans.flat_map(|&s| self.grid.cells(s, a.at)).map(|c| c.len() as u32).sum()
    }

    fn has_room(&self, model: &Model, a: &Arrival, cells: u32, round: &Round) -> bool {
        let most = |share: f64| (share * f64::from(cells)) as u32;
        let (taken, background) = self.beneath(&model.shape(a.variant).mask, a.at);
        taken <= most(round.on_others * self.closeness(model, a.variant))
            && background <= most(round.on_background)
    }

    /// Takes the pixels of a variant.
    pub(super) fn stand(&mut self, model: &Model, variant: VariantId, at: [i32; 2]) {
        for &span in model.shape(variant).mask.spans() {
            for cells in self.grid.cells(span, at) {
                self.pixels[cells].iter_mut().for_each(|p| *p |= TAKEN);
            }
        }
    }
}

/// How packed an exemplar is, 0 to 1: by how much primaries touch, or how much they cover, or how much
/// of the background secondaries do.
fn packing(library: &Library, labels: &LabelMap) -> f64 {
    let (mut all, mut others) = (0u64, 0u64);
    // Steps from a primary to a pixel that is not its own.
    let mut step = |a: u32, b: u32| {
        if a != b {
            all += u64::from(a > 0) + u64::from(b > 0);
            others += 2 * u64::from(a > 0 && b > 0);
        }
    };
    for y in 0..labels.height {
        let row = labels.row(y);
        row.windows(2).for_each(|w| step(w[0], w[1]));
        if y > 0 {
            labels.row(y - 1).iter().zip(row).for_each(|(&a, &b)| step(a, b));
        }
    }
    let share = |part: u64, of: usize| part as f64 / of.max(1) as f64;
    let covered = share(labels.labels.iter().filter(|l| **l > 0).count() as u64, labels.labels.len());
    let background = (1.0 - covered) * labels.labels.len() as f64;
    let patches: u64 = library.secondaries().iter().map(|s| u64::from(s.area)).sum();
    let tiled = patches as f64 / background.max(1.0);
    let within = |v: f64, [low, high]: [f64; 2]| (v - low) / (high - low);
    let contact = share(others, all as usize) / CONTACT;
    contact.max(within(covered, COVERED)).max(within(tiled, TILED)).clamp(0.0, 1.0)
}

/// Joins places of one variant that differ by no more than `reach` to the one with most votes. Gives the
/// arrivals and for each entry of `sums` its arrival.
fn merged(sums: &[(VariantId, [i32; 2], u32)], grid: &Grid, reach: i32) -> (Vec<Arrival>, Vec<u32>) {
    let mut arrivals: Vec<Arrival> = Vec::new();
    let mut index = vec![0; sums.len()];
    let mut first = 0;
    for one in sums.chunk_by(|a, b| a.0 == b.0) {
        let mut order: Vec<usize> = (first..first + one.len()).collect();
        order.sort_by_key(|&k| (std::cmp::Reverse(sums[k].2), k));
        // Arrivals by buckets as large as the reach.
        let mut buckets: BTreeMap<[i32; 2], Vec<u32>> = BTreeMap::new();
        for k in order {
            let (variant, at, votes) = sums[k];
            let bucket = at.map(|v| v.div_euclid(reach));
            let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [bucket[0] + dx, bucket[1] + dy]));
            let known = near.filter_map(|b| buckets.get(&b)).flatten().copied().find(|&a| {
                let way = grid.offset(arrivals[a as usize].at, at);
                way.iter().all(|d| d.abs() <= reach)
            });
            index[k] = match known {
                Some(a) => {
                    arrivals[a as usize].votes += votes;
                    a
                }
                None => {
                    arrivals.push(Arrival { variant, at, votes });
                    let new = arrivals.len() as u32 - 1;
                    buckets.entry(bucket).or_default().push(new);
                    new
                }
            };
        }
        first += one.len();
    }
    (arrivals, index)
}

impl Correspondence {
    /// The runs of a row of a map that come from primaries.
    fn votes(&self, model: &Model, grid: &Grid, y: i32) -> Vec<Vote> {
        let mut votes: Vec<Vote> = Vec::new();
        for x in 0..grid.width {
            let canvas = [x - grid.margin[0], y - grid.margin[1]];
            if !self.reaches(canvas) {
                continue;
            }
            let (page, there) = self.source(canvas);
            let sheet = &self.pages.sheets[page];
            let Some([ex, ey]) = sheet.exemplar(model, there) else { continue };
            let label = self.pages.labels[sheet.library].get(ex as u32, ey as u32);
            if label == 0 {
                continue;
            }
            let element = PlaceableId(model.sources[sheet.library].elements.start + label - 1);
            let origin = sheet.on_page(model, model[element].origin, there);
            let variant = model.in_variation(element, sheet.variation);
            let at = grid.canonical([0, 1].map(|k| [x, y][k] + origin[k] - there[k]));
            match votes.last_mut() {
                Some(last) if last.1 == x && (last.2, last.3) == (variant, at) => last.1 = x + 1,
                _ => votes.push((x, x + 1, variant, at)),
            }
        }
        votes
    }
}
