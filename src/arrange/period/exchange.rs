//! Elements that change places, shift and turn, none nearer to another than in the exemplar.

use super::known::{Known, of_shapes};
use super::{Placed, size_of};
use crate::geometry::{Affine, NearPoints, Point, Rect, Vec2, shortest_offset};
use crate::library::Library;
use crate::raster::Mask;
use crate::sampling::{Stream, stream};
use crate::scene::SynthParams;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Elements with which each may change places: so many where none alike stands near, then so many where none
/// equal does.
const PARTNERS: [usize; 2] = [16, 8];
/// Largest ratio of the sizes of elements that change places.
const RATIO: f64 = 1.4;
/// Distance, in mean distances between elements, within which no two that are alike come to stand, if there
/// are partners enough.
const COPIES: f64 = 1.4;
/// How often elements wander before they settle, and places tried each time.
const WALKS: usize = 12;
const STEPS: usize = 3;
/// Lengths of their ways at once, in units of [`FARTHEST`].
const STRIDES: [f64; 3] = [1.0, 2.0, 4.0];
/// Places tried for each element that shifts.
const SHIFTS: usize = 10;
/// Largest shift at once, as a share of the mean distance between elements.
const FARTHEST: f64 = 0.22;
/// Clearances that shifted elements are given, the first that fits, in units of that of the exemplar.
const CLEARANCES: [f64; 3] = [2.0, 1.5, 1.0];
/// Angles of elements that may be turned at will.
const TURNS: usize = 24;
/// Largest canvas with its margins, in pixels, on which elements change places.
pub(super) const MOST_PIXELS: u64 = 600_000_000;

/// The canvas, and who stands where.
pub(super) struct Exchange<'a> {
    library: &'a Library,
    known: &'a Known,
    seed: u64,
    /// Canvas and margins: the first pixel, and the size.
    first: [i32; 2],
    size: [i32; 2],
    canvas: [i32; 2],
    wrap: [bool; 2],
    /// Number of the placed element on each pixel, from 1.
    cells: Vec<u32>,
    /// Pixels of elements, turned about the origin, by the map in steps of [`STEP`].
    turned: BTreeMap<(usize, [i64; 4]), Arc<Mask>>,
}

/// Maps that differ by less have the same pixels.
const STEP: f64 = 1e-4;

/// Places at which elements stand that change them.
struct Sites {
    near: NearPoints,
    places: Vec<Point>,
    /// Who stands at each.
    occupants: Vec<usize>,
    reach: f64,
}

impl Sites {
    /// Whether one for which something holds stands near a site, but at two.
    fn any_near(
        &self,
        site: usize,
        but: [usize; 2],
        periods: [Option<f64>; 2],
        holds: impl Fn(usize) -> bool,
    ) -> bool {
        let mut any = false;
        self.near.each(self.places[site], |k| {
            any = any
                || !but.contains(&k)
                    && holds(self.occupants[k])
                    && shortest_offset(self.places[site], self.places[k], periods).hypot() < self.reach;
        });
        any
    }
}

impl<'a> Exchange<'a> {
    /// An empty canvas; `None` if it would take more than `most` pixels.
    pub(super) fn new(
        library: &'a Library,
        params: &SynthParams,
        known: &'a Known,
        most: u64,
    ) -> Option<Self> {
        let wrap = [params.tile.x, params.tile.y];
        let canvas = [params.width as i32, params.height as i32];
        let period = size_of(library);
        let beyond = |k: usize| (known.margin + 0.5 * period[k]) as i32;
        let first = [0, 1].map(|k| if wrap[k] { 0 } else { -beyond(k) });
        let size = [0, 1].map(|k| if wrap[k] { canvas[k] } else { canvas[k] + 2 * beyond(k) });
        let pixels = size[0] as u64 * size[1] as u64;
        let cells = vec![0; if pixels <= most { pixels as usize } else { return None }];
        let turned = BTreeMap::new();
        Some(Self { library, known, seed: params.seed, first, size, canvas, wrap, cells, turned })
    }

    /// The cell of a pixel of the canvas.
    fn cell(&self, at: [i32; 2]) -> Option<usize> {
        let mut v = [at[0] - self.first[0], at[1] - self.first[1]];
        for k in 0..2 {
            if self.wrap[k] {
                v[k] = v[k].rem_euclid(self.size[k]);
            } else if !(0..self.size[k]).contains(&v[k]) {
                return None;
            }
        }
        let i = v[1] as usize * self.size[0] as usize + v[0] as usize;
        (i < self.cells.len()).then_some(i)
    }

    /// The pixels of an element in a map, and the whole pixels by which they are moved.
    fn mask(&mut self, p: &Placed) -> (Arc<Mask>, [i32; 2]) {
        let [a, b, c, d, e, f] = p.map.as_coeffs();
        let shift = [e, f].map(|v| libm::round(v) as i32);
        if [a, b, c, d] == [1.0, 0.0, 0.0, 1.0] {
            return (Arc::clone(&self.known.masks[p.element]), shift);
        }
        let key = (p.element, [a, b, c, d].map(|v| libm::round(v / STEP) as i64));
        let own = &self.library.elements[p.element];
        let mask = self.turned.entry(key).or_insert_with(|| {
            let turn = Affine::new([a, b, c, d, 0.0, 0.0]);
            Arc::new(of_shapes(&own.shapes.iter().map(|s| s.moved(turn)).collect::<Vec<_>>()))
        });
        (Arc::clone(mask), shift)
    }

    /// Lets all elements stand, in painting order.
    pub(super) fn stand_all(&mut self, placed: &[Placed]) {
        let mut order: Vec<usize> = (0..placed.len()).collect();
        order.sort_by_key(|&i| placed[i].order);
        for i in order {
            self.write(&placed[i], i as u32 + 1, 0);
        }
        self.stand_endless();
    }

    /// Marks what runs on: it stands in every period, as the map of the exemplar says.
    fn stand_endless(&mut self) {
        let labels = self.library.arrangement.to_labels();
        let ends: Vec<bool> = self.library.primaries().iter().map(|e| e.clipped).collect();
        if !ends.contains(&true) {
            return;
        }
        for y in 0..self.size[1] {
            for x in 0..self.size[0] {
                let [u, v] = [(x + self.first[0], labels.width), (y + self.first[1], labels.height)]
                    .map(|(v, size)| v.rem_euclid(size as i32) as u32);
                let label = labels.get(u, v);
                if label > 0 && ends[label as usize - 1] {
                    let i = y as usize * self.size[0] as usize + x as usize;
                    if let Some(cell) = self.cells.get_mut(i) {
                        *cell = u32::MAX - label;
                    }
                }
            }
        }
    }

    /// Writes `new` on the pixels of an element; over nothing but `old`, unless that is 0.
    fn write(&mut self, p: &Placed, new: u32, old: u32) {
        let (mask, shift) = self.mask(p);
        for (x, y) in mask.pixels() {
            if let Some(i) = self.cell([x + shift[0], y + shift[1]])
                && (old == 0 || self.cells[i] == old)
            {
                self.cells[i] = new;
            }
        }
    }

    /// Whether an element would keep a distance from all others, in units of that in the exemplar.
    fn fits(&mut self, p: &Placed, clearance: f64) -> bool {
        let (mask, shift) = self.mask(p);
        let reach = libm::ceil(clearance * f64::from(self.known.clearance)) as i32;
        let near = libm::round(0.7 * f64::from(reach)) as i32;
        // The mask itself first, for there it is most likely to fail.
        let rows = [(0, reach), (-near, near), (near, near), (-reach, 0), (reach, 0)];
        rows.iter().all(|&(dy, beside)| {
            let spans = mask.spans().iter();
            spans.into_iter().all(|s| {
                self.is_free(s.x0 + shift[0] - beside, s.x1 + shift[0] + beside, s.y + shift[1] + dy)
            })
        })
    }

    /// Whether nothing stands in a stretch of a row.
    fn is_free(&self, x0: i32, x1: i32, y: i32) -> bool {
        let (low, high) = (x0 - self.first[0], x1 - self.first[0]);
        if low >= 0
            && high <= self.size[0]
            && let Some(i) = self.cell([x0, y])
            && let Some(row) = self.cells.get(i..i + (high - low) as usize)
        {
            return row.iter().all(|cell| *cell == 0);
        }
        (x0..x1).all(|x| self.cell([x, y]).is_none_or(|i| self.cells[i] == 0))
    }

    /// Changes places, shifts and turns elements; `share` of those that are free take part.
    pub(super) fn run(&mut self, placed: &mut [Placed], share: f64) {
        let mut random = stream(self.seed, "synth/period", 0);
        let mut all: Vec<usize> = (0..placed.len()).filter(|&i| self.known.free[placed[i].element]).collect();
        all.retain(|_| random.unit() < share);
        random.shuffle(&mut all);
        let mut sites = self.sites(placed, &all);
        for n in 0..all.len() {
            self.exchange(placed, &mut sites, n, &mut random);
        }
        for _ in 0..WALKS {
            for &i in &all {
                self.walk(placed, i, share, &mut random);
            }
        }
        for &i in &all {
            self.shift(placed, i, share, &mut random);
        }
    }

    /// Where elements stand that change places.
    fn sites(&self, placed: &[Placed], all: &[usize]) -> Sites {
        let places: Vec<Point> = all.iter().map(|&i| self.middle(&placed[i])).collect();
        let reach = COPIES * self.known.spacing;
        let near = NearPoints::new(&places, self.periods(), reach);
        Sites { near, places, occupants: all.to_vec(), reach }
    }

    fn periods(&self) -> [Option<f64>; 2] {
        [0, 1].map(|k| self.wrap[k].then_some(f64::from(self.canvas[k])))
    }

    /// Lets the element of a site change places with another of like size.
    fn exchange(&mut self, placed: &mut [Placed], sites: &mut Sites, n: usize, random: &mut Stream) {
        let known = self.known;
        let extent = |p: &Placed| {
            let b = known.bounds[p.element];
            libm::hypot(b.width(), b.height())
        };
        let a = sites.occupants[n];
        let own = extent(&placed[a]);
        for attempt in 0..PARTNERS[0] + PARTNERS[1] {
            let m = random.index(sites.occupants.len());
            let b = sites.occupants[m];
            let other = extent(&placed[b]);
            let kinds = if attempt < PARTNERS[0] { &known.alike } else { &known.same };
            let [kind_a, kind_b] = [a, b].map(|i| kinds[placed[i].element]);
            let zones = [a, b].map(|i| self.zone(&placed[i]));
            if kind_a == kind_b || zones[0] != zones[1] || own.max(other) > RATIO * own.min(other) {
                continue;
            }
            let has = |site: usize, kind: usize| {
                let periods = self.periods();
                sites.any_near(site, [n, m], periods, |i| kinds[placed[i].element] == kind)
            };
            if !has(m, kind_a) && !has(n, kind_b) && self.swapped(placed, [a, b], random) {
                sites.occupants.swap(n, m);
                return;
            }
        }
    }

    /// Lets two elements change places, if both fit there.
    fn swapped(&mut self, placed: &mut [Placed], [a, b]: [usize; 2], random: &mut Stream) -> bool {
        let (old_a, old_b) = (placed[a], placed[b]);
        self.write(&old_a, 0, a as u32 + 1);
        self.write(&old_b, 0, b as u32 + 1);
        let new_a = self.at(&old_a, self.middle(&old_b), random);
        if self.fits(&new_a, 1.0) {
            self.write(&new_a, a as u32 + 1, 0);
            let new_b = self.at(&old_b, self.middle(&old_a), random);
            if self.fits(&new_b, 1.0) {
                self.write(&new_b, b as u32 + 1, 0);
                (placed[a], placed[b]) = (new_a, new_b);
                return true;
            }
            self.write(&new_a, 0, a as u32 + 1);
        }
        self.write(&old_a, a as u32 + 1, 0);
        self.write(&old_b, b as u32 + 1, 0);
        false
    }

    /// Lets an element that lies on the canvas wander, so that large ones too leave the places that
    /// repeat. Others would change how much of each kind is seen.
    fn walk(&mut self, placed: &mut [Placed], i: usize, share: f64, random: &mut Stream) {
        let old = placed[i];
        if self.zone(&old) != 0 {
            return;
        }
        self.write(&old, 0, i as u32 + 1);
        let middle = self.middle(&old);
        for _ in 0..STEPS {
            let stride = STRIDES[random.index(STRIDES.len())];
            let reach = stride * share * FARTHEST * self.known.spacing;
            let by = Vec2::new(random.range(-reach, reach), random.range(-reach, reach));
            let new = self.at(&old, middle + by, random);
            if self.zone(&new) == 0 && self.fits(&new, 1.0) {
                placed[i] = new;
                break;
            }
        }
        self.write(&placed[i].clone(), i as u32 + 1, 0);
    }

    /// Moves an element a little, and turns it if others of its kind are turned.
    fn shift(&mut self, placed: &mut [Placed], i: usize, share: f64, random: &mut Stream) {
        let old = placed[i];
        self.write(&old, 0, i as u32 + 1);
        let middle = self.middle(&old);
        let reach = share * FARTHEST * self.known.spacing;
        let mut tried = Vec::new();
        for _ in 0..SHIFTS {
            let by = Vec2::new(random.range(-reach, reach), random.range(-reach, reach));
            tried.push(self.at(&old, middle + by, random));
        }
        let found = CLEARANCES.iter().find_map(|&c| tried.iter().find(|new| self.fits(new, c)).copied());
        placed[i] = found.unwrap_or(old);
        self.write(&placed[i].clone(), i as u32 + 1, 0);
    }

    /// Whether an element lies on the canvas, on its border, or beyond: elements change places within one
    /// of these, so that the canvas keeps its share of each.
    fn zone(&self, p: &Placed) -> u8 {
        let b = p.map.transform_rect_bbox(self.known.bounds[p.element]);
        let axis = |wrap: bool, low: f64, high: f64, size: i32| match (low >= 0.0, high <= f64::from(size)) {
            _ if wrap => 0,
            (true, true) => 0,
            _ if high <= 0.0 || low >= f64::from(size) => 2,
            _ => 1,
        };
        axis(self.wrap[0], b.x0, b.x1, self.canvas[0]).max(axis(self.wrap[1], b.y0, b.y1, self.canvas[1]))
    }

    fn middle(&self, p: &Placed) -> Point {
        p.map * self.known.bounds[p.element].center()
    }

    /// An element with its middle at a place, turned as others of its kind are. Along axes that repeat it
    /// stays on the canvas.
    fn at(&self, p: &Placed, mut place: Point, random: &mut Stream) -> Placed {
        let class = self.known.equal[p.element];
        let angles = self.known.angles.get(&class.0).map_or(&[][..], Vec::as_slice);
        // The angle of the element itself in its class.
        let [a, b, ..] = class.1.as_coeffs();
        let own = libm::atan2(b, a);
        let turn = match angles.len() {
            0 | 1 => 0.0,
            2 => angles[random.index(2)] - own,
            _ => random.index(TURNS) as f64 / TURNS as f64 * std::f64::consts::TAU,
        };
        if self.wrap[0] {
            place.x -= f64::from(self.canvas[0]) * libm::floor(place.x / f64::from(self.canvas[0]));
        }
        if self.wrap[1] {
            place.y -= f64::from(self.canvas[1]) * libm::floor(place.y / f64::from(self.canvas[1]));
        }
        let centre = self.known.bounds[p.element].center();
        let [a, b, c, d, ..] = self.library.layers[p.order.0].instances[p.order.1].transform;
        let given = Affine::new([a, b, c, d, 0.0, 0.0]);
        let linear = if turn.abs() < 1e-3 {
            given
        } else {
            let (sin, cos) = (libm::sin(turn), libm::cos(turn));
            Affine::new([cos, sin, -sin, cos, 0.0, 0.0]) * given
        };
        let at = place - linear * centre;
        // On whole pixels, where it was looked at.
        let map = Affine::translate(Vec2::new(libm::round(at.x), libm::round(at.y))) * linear;
        Placed { map, ..*p }
    }

    /// Share of the canvas that each category covers.
    pub(super) fn covered(&self, placed: &[Placed]) -> Vec<f64> {
        let elements = &self.library.elements;
        let mut counts = vec![0u64; self.library.categories.len()];
        let canvas = Rect::new(0.0, 0.0, f64::from(self.canvas[0]), f64::from(self.canvas[1]));
        for y in 0..self.canvas[1] {
            for x in 0..self.canvas[0] {
                let Some(&cell) = self.cell([x, y]).and_then(|i| self.cells.get(i)) else { continue };
                let element = match cell {
                    0 => continue,
                    own if own as usize <= placed.len() => placed[own as usize - 1].element,
                    label => (u32::MAX - label) as usize - 1,
                };
                if let Some(category) = elements[element].category {
                    counts[category.index()] += 1;
                }
            }
        }
        counts.iter().map(|&n| n as f64 / canvas.area()).collect()
    }
}
