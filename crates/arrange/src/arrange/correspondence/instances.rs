//! Instances: the pixels of a canvas that together show one element.
//!
//! Each pixel that is copied from a primary votes for the place of that primary on the canvas. Adjacent
//! pixels whose votes nearly agree are one instance, whichever primaries they come from: a field that
//! continues the left half of one stone with the right half of another shows one stone. In a packed exemplar
//! neighbours stay apart although nothing lies between them, because their votes differ by the width of a
//! stone. Small instances join a neighbour of their colour or vanish. One that is larger than any of the elements that
//! it comes from is several things, and is divided.

use super::Correspondence;
use crate::arrange::grid::Grid;
use crate::arrange::model::{PlaceableId, PlacementModel, VariantId};
use std::collections::BTreeMap;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::parallel;
use vtex_base::raster::colour::squared_distance;
use vtex_base::raster::{Mask, Span};
use vtex_scene::library::Library;

/// Largest distance of votes that agree, as a share of the smaller element's radius, and at least in pixels.
const AGREE: f64 = 0.45;
const LEAST_AGREE: f64 = 2.0;
/// Votes for one primary that differ by no more are one part, in cells along each axis.
const SAME_PLACE: i32 = 2;
/// Small instances: those below this share of their main element, or of the median element if that is
/// smaller.
const SMALL: f64 = 0.35;
/// A small instance joins a neighbour if more than this share of its rim lies on neighbours
const ENCLOSED: f64 = 0.25;
/// and the neighbour's colour is no further away than this (in Oklab), or if it has at most
/// [`ANY_COLOUR`] pixels.
const SAME_COLOUR: f32 = 0.12;
const ANY_COLOUR: u32 = 40;
/// Otherwise it vanishes if it is below this share,
const SPECK: f64 = 0.12;
/// or below this number of pixels.
const LEAST: u32 = 12;
/// An instance is divided among its parts if it is larger than any of their elements by this factor, and at least two
/// parts have this share of their elements.
const LARGE: f64 = 1.4;
const DIVIDED: f64 = 0.3;
/// Rounds in which small instances join others.
const ROUNDS: usize = 3;

/// Pixels that come from one primary at one place.
pub(super) struct PrimaryPixels {
    pub(super) variant: VariantId,
    /// Place of its origin, on the map; on the same side of seams as the pixels.
    pub(super) at: [i32; 2],
    pub(super) mask: Mask,
}

/// Pixels that show one element.
pub(super) struct PixelInstance {
    /// The parts that the pixels are copied from, the largest first.
    pub(super) parts: Vec<PrimaryPixels>,
    /// The pixels, on the map. Coordinates continue across a seam.
    pub(super) mask: Mask,
    /// Whether it reaches the border of the area that the field covers.
    pub(super) cut: bool,
}

impl PixelInstance {
    /// The largest part.
    pub(super) fn main(&self) -> &PrimaryPixels {
        &self.parts[0]
    }
}

impl PixelInstance {
    /// The instance, or, if it is larger than any element that it comes from, one for each of its large parts. The
    /// others go to the large ones that they are nearest to.
    fn divided(self, model: &PlacementModel) -> Vec<Self> {
        let whole = |part: &PrimaryPixels| f64::from(model.plain(model.element_of(part.variant)).area);
        let largest = self.parts.iter().map(whole).fold(0.0, f64::max);
        let is_large = |part: &PrimaryPixels| f64::from(part.mask.area()) >= DIVIDED * whole(part);
        let count = self.parts.iter().filter(|part| is_large(part)).count();
        if f64::from(self.mask.area()) < LARGE * largest || count < 2 {
            return vec![self];
        }
        let (large, small): (Vec<_>, Vec<_>) = self.parts.into_iter().partition(is_large);
        let middle = |part: &PrimaryPixels| part.mask.centroid().unwrap_or_default();
        let middles: Vec<(f64, f64)> = large.iter().map(middle).collect();
        let mut divided: Vec<Vec<PrimaryPixels>> = large.into_iter().map(|part| vec![part]).collect();
        for part in small {
            let (x, y) = middle(&part);
            let far = |k: &usize| libm::hypot(middles[*k].0 - x, middles[*k].1 - y);
            let nearest = (0..middles.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
            divided[nearest.unwrap_or(0)].push(part);
        }
        let one = |parts: Vec<PrimaryPixels>| {
            let spans = parts.iter().flat_map(|part| part.mask.spans()).copied().collect();
            Self { mask: Mask::from_spans(spans), parts, cut: self.cut }
        };
        divided.into_iter().map(one).collect()
    }
}

/// A run of pixels of a row that come from one primary.
struct PrimaryRun {
    x0: i32,
    x1: i32,
    variant: VariantId,
    /// Place of the variant's origin; canonical.
    at: [i32; 2],
}

/// All runs of a map, row by row.
struct PrimaryRuns<'a> {
    model: &'a PlacementModel,
    grid: &'a Grid,
    runs: Vec<PrimaryRun>,
    /// Index of the first run of each row.
    rows: Vec<usize>,
    kinds: &'a Kinds,
}

/// Properties that decide which elements may be joined.
pub(super) struct Kinds {
    /// Stratum of each element of the model.
    pub(super) strata: Vec<u8>,
    /// Colour of each element in Oklab.
    colours: Vec<[f32; 3]>,
    /// Median area of the whole elements of each library, in pixels.
    medians: Vec<u32>,
}

impl Kinds {
    pub(super) fn new(libraries: &[Library], model: &PlacementModel) -> Self {
        let strata = libraries.iter().flat_map(|l| l.strata_of_elements()[..l.primaries().len()].to_vec());
        let colours = libraries.iter().flat_map(|l| l.primaries().iter().map(|p| p.colour.to_oklab()));
        let median = |library: usize| {
            let own = model.elements.iter().filter(|e| e.library == library && e.placeable);
            let mut areas: Vec<u32> =
                own.map(|e| libraries[library].primaries()[e.index as usize].area).collect();
            areas.sort_unstable();
            areas.get(areas.len() / 2).copied().unwrap_or(u32::MAX)
        };
        Self {
            strata: strata.collect(),
            colours: colours.collect(),
            medians: (0..libraries.len()).map(median).collect(),
        }
    }

    /// Distance of the colours of two elements.
    fn colour_distance(&self, a: PlaceableId, b: PlaceableId) -> f32 {
        let [a, b] = [a, b].map(|e| self.colours[e.0 as usize]);
        libm::sqrtf(squared_distance(a, b))
    }
}

/// Two runs side by side, and the length of the border between them, in pixels.
type Contact = (usize, usize, u32);

/// The instances of a field.
pub(super) fn find(
    correspondence: &Correspondence,
    model: &PlacementModel,
    grid: &Grid,
    kinds: &Kinds,
) -> Vec<PixelInstance> {
    let numbers: Vec<i32> = (0..grid.height).collect();
    let of_rows = parallel::map(&numbers, |&y| correspondence.runs(model, grid, y));
    let mut rows = vec![0];
    let mut runs = Vec::with_capacity(of_rows.iter().map(Vec::len).sum());
    for row in of_rows {
        runs.extend(row);
        rows.push(runs.len());
    }
    let runs = PrimaryRuns { model, grid, runs, rows, kinds };
    let contacts = runs.contacts();
    let mut sets = DisjointSets::new(runs.runs.len());
    for &(a, b, _) in &contacts {
        if runs.agree(a, b) {
            sets.join(a, b);
        }
    }
    let known = correspondence.known(grid);
    let mut vanished = vec![false; runs.runs.len()];
    for _ in 0..ROUNDS {
        if !runs.join_small(&contacts, &mut sets, &mut vanished, known) {
            break;
        }
    }
    let (of, count) = sets.indices();
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    of.iter()
        .enumerate()
        .filter(|(run, _)| !vanished[*run])
        .for_each(|(run, &k)| members[k as usize].push(run));
    members.retain(|list| !list.is_empty());
    let instances = parallel::map(&members, |list| {
        runs.instance(list, SAME_PLACE * correspondence.pages.cell, known).divided(model)
    });
    instances.into_iter().flatten().collect()
}

impl PrimaryRuns<'_> {
    /// The row of a run.
    fn row(&self, run: usize) -> i32 {
        self.rows.partition_point(|&first| first <= run) as i32 - 1
    }

    fn length(&self, run: usize) -> u32 {
        (self.runs[run].x1 - self.runs[run].x0) as u32
    }

    /// All pairs of runs that share a border.
    fn contacts(&self) -> Vec<Contact> {
        let rows = self.rows.len() - 1;
        let mut contacts = Vec::new();
        for y in 0..rows {
            let own = self.rows[y]..self.rows[y + 1];
            for a in own.clone().skip(1) {
                if self.runs[a - 1].x1 == self.runs[a].x0 {
                    contacts.push((a - 1, a, 1));
                }
            }
            if self.grid.tile.x && own.len() > 1 {
                let (first, last) = (own.start, own.end - 1);
                if self.runs[first].x0 == 0 && self.runs[last].x1 == self.grid.width {
                    contacts.push((last, first, 1));
                }
            }
            let below = if y + 1 < rows { y + 1 } else { 0 };
            if below == 0 && (!self.grid.tile.y || rows < 2) {
                continue;
            }
            let (mut a, mut b) = (own.start, self.rows[below]);
            while a < own.end && b < self.rows[below + 1] {
                let (up, down) = (&self.runs[a], &self.runs[b]);
                let common = up.x1.min(down.x1) - up.x0.max(down.x0);
                if common > 0 {
                    contacts.push((a, b, common as u32));
                }
                if up.x1 <= down.x1 { a += 1 } else { b += 1 }
            }
        }
        contacts
    }

    /// Whether the pixels of two runs can belong to one element.
    fn may_join(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|run| self.model.element_of(self.runs[run].variant));
        let stratum = |e: PlaceableId| self.kinds.strata[e.0 as usize];
        self.model[a].library == self.model[b].library && stratum(a) == stratum(b)
    }

    /// Whether two runs vote for one place.
    fn agree(&self, a: usize, b: usize) -> bool {
        if !self.may_join(a, b) {
            return false;
        }
        let [p, q] = [&self.runs[a], &self.runs[b]];
        let [dx, dy] = self.grid.offset(p.at, q.at).map(f64::from);
        let radius = self.radius(p.variant).min(self.radius(q.variant));
        libm::hypot(dx, dy) <= (AGREE * radius).max(LEAST_AGREE)
    }

    /// Radius of a disk of a variant's area.
    fn radius(&self, variant: VariantId) -> f64 {
        libm::sqrt(f64::from(self.model.shape(variant).area) / std::f64::consts::PI)
    }

    /// Lets small sets of runs join the neighbour with which they share most border, or removes them. Returns
    /// whether any set changed.
    fn join_small(
        &self,
        contacts: &[Contact],
        sets: &mut DisjointSets,
        vanished: &mut [bool],
        known: [[i32; 2]; 2],
    ) -> bool {
        let roots: Vec<usize> = (0..self.runs.len()).map(|run| sets.root(run)).collect();
        // Area, rim, and area by element of each set, at its root.
        let mut area = vec![0u32; self.runs.len()];
        let mut rim = vec![0u32; self.runs.len()];
        let mut cut = vec![false; self.runs.len()];
        for (run, &root) in roots.iter().enumerate().filter(|(run, _)| !vanished[*run]) {
            area[root] += self.length(run);
            rim[root] += 2 + 2 * self.length(run);
            cut[root] |= self.reaches_end(run, known);
        }
        let mut beside: BTreeMap<(usize, usize), u32> = BTreeMap::new();
        for &(a, b, length) in contacts.iter().filter(|c| !vanished[c.0] && !vanished[c.1]) {
            let [p, q] = [roots[a], roots[b]];
            if p == q {
                rim[p] -= 2 * length;
            } else {
                let length = if self.may_join(a, b) { length } else { 0 };
                *beside.entry((p, q)).or_default() += length;
                *beside.entry((q, p)).or_default() += length;
            }
        }
        let mut main: BTreeMap<(usize, VariantId), u32> = BTreeMap::new();
        for (run, &root) in roots.iter().enumerate().filter(|(_, root)| area[**root] > 0) {
            *main.entry((root, self.runs[run].variant)).or_default() += self.length(run);
        }
        // The main element of each set, and its pixels there.
        let mut most: Vec<(u32, Option<VariantId>)> = vec![(0, None); self.runs.len()];
        for ((root, variant), pixels) in main {
            if pixels > most[root].0 {
                most[root] = (pixels, Some(variant));
            }
        }
        let mut changed = false;
        let mut gone = vec![false; self.runs.len()];
        for root in (0..self.runs.len()).filter(|&root| area[root] > 0) {
            let Some(variant) = most[root].1 else { continue };
            let median = self.kinds.medians[self.model.element(variant).library];
            let usual = self.model.shape(variant).area.min(median).max(1);
            let share = f64::from(area[root]) / f64::from(usual);
            if (share >= SMALL || cut[root]) && area[root] >= LEAST {
                continue;
            }
            let suits = |q: usize| {
                let other = most[q].1.map(|v| self.model.element_of(v));
                let apart =
                    other.map(|other| self.kinds.colour_distance(self.model.element_of(variant), other));
                area[root] <= ANY_COLOUR || apart.is_some_and(|d| d <= SAME_COLOUR)
            };
            let neighbours = || {
                let all = beside.range((root, 0)..(root + 1, 0)).map(|(&(_, q), &length)| (length, q));
                all.filter(|n| suits(n.1))
            };
            let all: u32 = neighbours().map(|n| n.0).sum();
            if f64::from(all) > ENCLOSED * f64::from(rim[root]) {
                if let Some((_, best)) =
                    neighbours().max_by_key(|&(length, q)| (length, std::cmp::Reverse(q)))
                {
                    sets.join(root, best);
                    changed = true;
                }
            } else if area[root] < LEAST || share < SPECK {
                gone[root] = true;
                changed = true;
            }
        }
        roots
            .iter()
            .zip(vanished)
            .filter(|(root, _)| gone[**root])
            .for_each(|(_, vanished)| *vanished = true);
        changed
    }

    /// Whether a run lies at the border of the area that the field covers: a box of the map, its ends
    /// exclusive.
    fn reaches_end(&self, run: usize, [low, high]: [[i32; 2]; 2]) -> bool {
        let (r, y) = (&self.runs[run], self.row(run));
        let across = !self.grid.tile.x && (r.x0 <= low[0] || r.x1 >= high[0]);
        across || (!self.grid.tile.y && (y <= low[1] || y + 1 >= high[1]))
    }

    /// The instance of some runs.
    fn instance(&self, list: &[usize], reach: i32, known: [[i32; 2]; 2]) -> PixelInstance {
        // Places of one primary that differ by at most [`SAME_PLACE`] are one part.
        let mut counts: BTreeMap<(VariantId, [i32; 2]), u32> = BTreeMap::new();
        for &run in list {
            *counts.entry((self.runs[run].variant, self.runs[run].at)).or_default() += self.length(run);
        }
        let mut places: Vec<((VariantId, [i32; 2]), u32)> = counts.into_iter().collect();
        places.sort_by_key(|&(place, count)| (std::cmp::Reverse(count), place));
        let first = places[0].0.1;
        // Moved across seams to the side of the first place.
        let near = |at: [i32; 2]| {
            let way = self.grid.offset(first, at);
            [first[0] + way[0], first[1] + way[1]]
        };
        let mut parts: Vec<(VariantId, [i32; 2], Vec<Span>)> = Vec::new();
        let mut part_of: BTreeMap<(VariantId, [i32; 2]), usize> = BTreeMap::new();
        for &((variant, at), _) in &places {
            let place = near(at);
            let same = |p: &(VariantId, [i32; 2], Vec<Span>)| {
                p.0 == variant && (0..2).all(|k| (p.1[k] - place[k]).abs() <= reach)
            };
            let part = parts.iter().position(same).unwrap_or_else(|| {
                parts.push((variant, place, Vec::new()));
                parts.len() - 1
            });
            part_of.insert((variant, at), part);
        }
        let mut all = Vec::with_capacity(list.len());
        for &run in list {
            let r = &self.runs[run];
            let place = near(r.at);
            let [dx, dy] = self.grid.offset(r.at, [r.x0, self.row(run)]);
            let span = Span { y: place[1] + dy, x0: place[0] + dx, x1: place[0] + dx + r.x1 - r.x0 };
            all.push(span);
            parts[part_of[&(r.variant, r.at)]].2.push(span);
        }
        let cut = list.iter().any(|&run| self.reaches_end(run, known));
        let mut parts: Vec<PrimaryPixels> = parts
            .into_iter()
            .map(|(variant, at, spans)| PrimaryPixels { variant, at, mask: Mask::from_spans(spans) })
            .collect();
        parts.sort_by_key(|part| (std::cmp::Reverse(part.mask.area()), part.variant, part.at));
        PixelInstance { parts, mask: Mask::from_spans(all), cut }
    }
}

impl Correspondence {
    /// The area of a map that the field covers: first and last places, ends exclusive.
    pub(super) fn known(&self, grid: &Grid) -> [[i32; 2]; 2] {
        let cell = self.pages.cell;
        let size = [grid.width, grid.height];
        let low = [0, 1].map(|k| (grid.margin[k] - self.margin[k] * cell).max(0));
        let end = |k: usize| grid.margin[k] + (self.field.size[k] as i32 - self.margin[k]) * cell;
        [low, [0, 1].map(|k| end(k).min(size[k]))]
    }

    /// The runs of a row of a map that come from primaries.
    fn runs(&self, model: &PlacementModel, grid: &Grid, y: i32) -> Vec<PrimaryRun> {
        let mut runs: Vec<PrimaryRun> = Vec::new();
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
            match runs.last_mut() {
                Some(last) if last.x1 == x && (last.variant, last.at) == (variant, at) => last.x1 = x + 1,
                _ => runs.push(PrimaryRun { x0: x, x1: x + 1, variant, at }),
            }
        }
        runs
    }
}
