//! The target map: what every cell of the canvas and a margin around it should hold or holds.
//!
//! Cells are canvas pixels. Besides its state every cell knows its owner, the request or the
//! placed texton that it belongs to, so the region of a request needs no search and textons can be
//! taken away again. What one placement costs depends on the size of its descriptor alone.
//!
//! Where libraries share a canvas a descriptor writes only on land in which its library has a part.

use super::grid::{Grid, Part};
use super::ground::Ground;
use super::model::{EMPTY, Model, UNDEFINED};
use super::sums::Sums;
use crate::raster::Span;
use crate::scene::Edge;
use std::ops::Range;

/// Owners from here on are requests, smaller ones placed textons; see [`NOBODY`].
pub(super) const REQUESTS: u32 = 1 << 31;
/// Owner of a cell of no request and no texton.
pub(super) const NOBODY: u32 = u32::MAX;
/// Side of the bins in which placed textons are found, in pixels.
const BIN: i32 = 64;
/// Widest margin, in pixels.
const WIDEST_MARGIN: i32 = 256;

/// A placed texton.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Which form.
    pub(super) form: u32,
    /// Place of its origin on the map, in pixels.
    pub(super) at: [i32; 2],
    /// Its score when it was placed, per pixel of its area.
    pub(super) score: f32,
    /// Cells of it that no other texton covers.
    pub(super) visible: u32,
    /// Cells of it on the map.
    pub(super) cells: u32,
    /// Taken away again.
    pub(super) removed: bool,
}

/// A texton asked for by a descriptor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Request {
    /// The form that stands there in the exemplar.
    pub(super) form: u32,
    /// Place of its origin on the map, in pixels.
    pub(super) at: [i32; 2],
    /// Cells it asked for at first.
    pub(super) cells: u32,
}

/// The target map.
pub(super) struct TargetMap<'a> {
    model: &'a Model,
    /// What is wanted where.
    pub(super) ground: Ground<'a>,
    /// The cells.
    pub(super) grid: Grid,
    /// [`UNDEFINED`], [`EMPTY`], or category + 1, of requests and placed textons alike.
    pub(super) state: Vec<u16>,
    /// Index of a placed texton, [`REQUESTS`] + index of a request, or [`NOBODY`].
    pub(super) owner: Vec<u32>,
    /// All textons ever placed.
    pub(super) placed: Vec<Placed>,
    pub(super) requests: Vec<Request>,
    /// Weight of each request in the draw.
    pub(super) weights: Sums,
    /// Visible cells to be filled, by zone and category.
    pub(super) covered: Vec<Vec<u64>>,
    bins: Vec<Vec<u32>>,
    seen: Vec<u32>,
    scratch: Vec<u16>,
    /// Whether all that is wanted in zones of the exemplar's density stands already.
    pub(super) settled: bool,
    /// Rows whose requests are answered here, if not all; the others are put off.
    pub(super) core: Option<Range<i32>>,
    pub(super) put_off: Vec<u32>,
}

/// A region of cells and its distances to its border.
pub(super) struct Region {
    /// Cells and their distance to the border of the region, 1 at the border.
    pub(super) cells: Vec<([i32; 2], u16)>,
}

impl<'a> TargetMap<'a> {
    /// A map of undefined cells.
    pub(super) fn new(model: &'a Model, ground: Ground<'a>, grid: Grid) -> Self {
        let bins = columns(grid.width) as usize * columns(grid.height) as usize;
        Self {
            model,
            state: vec![UNDEFINED; grid.len()],
            owner: vec![NOBODY; grid.len()],
            placed: Vec::new(),
            requests: Vec::new(),
            weights: Sums::default(),
            covered: vec![vec![0; model.members.len()]; ground.zone_count()],
            ground,
            settled: false,
            core: None,
            put_off: Vec::new(),
            bins: vec![Vec::new(); bins],
            seen: vec![0; model.primaries.len()],
            scratch: Vec::new(),
            grid,
        }
    }

    /// The grid for a canvas: margins wide enough for textons that reach in from outside.
    pub(super) fn grid(model: &Model, width: u32, height: u32, tile: crate::scene::Tile) -> Grid {
        Grid::new([width, height], tile, (model.reach + 2).min(WIDEST_MARGIN))
    }

    /// The model that textons are taken from.
    pub(super) fn model(&self) -> &'a Model {
        self.model
    }

    /// The zone of a cell of `canvas`; none if it is elsewhere or not to be filled.
    fn zone(&self, i: usize, canvas: &Range<usize>) -> Option<usize> {
        if canvas.contains(&i) { self.ground.zone(i) } else { None }
    }

    /// Whether a place lies on the canvas and is to be filled.
    pub(super) fn inside(&self, at: [i32; 2]) -> bool {
        self.grid.canvas_cell(at).is_some_and(|i| self.ground.zone(i).is_some())
    }

    /// Whether nothing is to be added to or taken from a zone.
    pub(super) fn is_settled(&self, zone: usize) -> bool {
        self.settled && self.ground.level(zone) == 1.0
    }

    /// Visible cells to be filled of a category, in all zones.
    pub(super) fn covered_by(&self, category: usize) -> u64 {
        self.covered.iter().map(|zone| zone[category]).sum()
    }

    /// Whether texton `a` is painted over texton `b`: small over large, later over earlier, so
    /// that as little as possible is hidden.
    fn above(&self, a: u32, b: u32) -> bool {
        let depth = |i: u32| self.model.depth(self.placed[i as usize].form);
        (depth(b), a) > (depth(a), b)
    }

    /// Places a texton and its descriptor (paper, algorithm 2). Gives its index.
    pub(super) fn place(&mut self, form: u32, at: [i32; 2], score: f32) -> u32 {
        let id = self.stand(form, at, score);
        self.write_descriptor(id);
        id
    }

    /// Places a texton without its descriptor. Gives its index.
    pub(super) fn stand(&mut self, form: u32, at: [i32; 2], score: f32) -> u32 {
        let model = self.model;
        let shape = model.shape(form);
        let at = self.grid.canonical(at);
        let id = self.placed.len() as u32;
        self.placed.push(Placed { form, at, score, visible: 0, cells: 0, removed: false });
        let mut touched = Vec::new();
        for &span in shape.mask.spans() {
            for Part { cells, canvas, .. } in self.grid.parts(span, at) {
                self.placed[id as usize].cells += cells.len() as u32;
                for i in cells {
                    let owner = self.owner[i];
                    if owner >= REQUESTS {
                        if owner != NOBODY && touched.last() != Some(&owner) {
                            touched.push(owner);
                        }
                    } else if self.above(owner, id) {
                        continue;
                    } else {
                        self.disown(i, &canvas);
                    }
                    self.own(i, id, &canvas);
                }
            }
        }
        self.find(id);
        touched.sort_unstable();
        touched.dedup();
        for request in touched {
            self.weigh(request - REQUESTS);
        }
        id
    }

    /// Notes where a placed texton is found.
    pub(super) fn find(&mut self, id: u32) {
        let Placed { form, at, .. } = self.placed[id as usize];
        for bin in self.bins_at(self.model.shape(form).bounds, at) {
            self.bins[bin].push(id);
        }
    }

    /// Notes where all textons are found that reach into the map.
    pub(super) fn find_placed(&mut self) {
        for id in 0..self.placed.len() as u32 {
            let Placed { form, at, removed, .. } = self.placed[id as usize];
            let bounds = self.model.shape(form).bounds;
            let whole = [0, 0, self.grid.width, self.grid.height];
            if !removed && self.grid.boxes_meet(bounds, at, whole, [0, 0]) {
                self.find(id);
            }
        }
    }

    /// Makes a cell a visible one of a placed texton.
    fn own(&mut self, i: usize, id: u32, canvas: &Range<usize>) {
        let texton = &mut self.placed[id as usize];
        texton.visible += 1;
        let primary = self.model.primary(texton.form);
        self.owner[i] = id;
        self.state[i] = primary.code;
        if let Some(zone) = self.zone(i, canvas) {
            self.covered[zone][primary.category] += 1;
        }
    }

    /// Makes a cell of a placed texton one that cannot be seen.
    fn disown(&mut self, i: usize, canvas: &Range<usize>) {
        let below = &mut self.placed[self.owner[i] as usize];
        below.visible -= 1;
        let category = self.model.primary(below.form).category;
        if let Some(zone) = self.zone(i, canvas) {
            self.covered[zone][category] -= 1;
        }
    }

    /// Takes a texton away; what it hid comes to light, the rest of its cells become empty.
    pub(super) fn remove(&mut self, id: u32) {
        let model = self.model;
        let Placed { form, at, .. } = self.placed[id as usize];
        let shape = model.shape(form);
        for &span in shape.mask.spans() {
            for Part { cells, canvas, .. } in self.grid.parts(span, at) {
                for i in cells.filter(|&i| self.owner[i] == id).collect::<Vec<_>>() {
                    self.disown(i, &canvas);
                    (self.owner[i], self.state[i]) = (NOBODY, EMPTY);
                }
            }
        }
        let mut near = Vec::new();
        for bin in self.bins_at(shape.bounds, at) {
            self.bins[bin].retain(|&other| other != id);
            near.extend_from_slice(&self.bins[bin]);
        }
        near.sort_unstable();
        near.dedup();
        // From the top down, each takes what is still free.
        near.sort_by(
            |&a, &b| if self.above(a, b) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater },
        );
        for other in near {
            let Placed { form, at: place, .. } = self.placed[other as usize];
            let other_shape = model.shape(form);
            if !self.grid.boxes_meet(shape.bounds, at, other_shape.bounds, place) {
                continue;
            }
            for &span in other_shape.mask.spans() {
                for Part { cells, canvas, .. } in self.grid.parts(span, place) {
                    for i in cells {
                        if self.owner[i] == NOBODY {
                            self.own(i, other, &canvas);
                        }
                    }
                }
            }
        }
        self.placed[id as usize].removed = true;
    }

    /// Writes what the exemplar holds around a placed texton wherever nothing is known yet.
    pub(super) fn write_descriptor(&mut self, id: u32) {
        let model = self.model;
        let Placed { form, at, .. } = self.placed[id as usize];
        let own = model.primary_of(form);
        let source = &model.sources[model.primaries[own as usize].library];
        let first = source.primaries.start;
        // On a small torus a window would come around to itself.
        let half = |wrap: bool, size: i32| if wrap { source.half.min((size - 1) / 2) } else { source.half };
        let half = [half(self.grid.tile.x, self.grid.width), half(self.grid.tile.y, self.grid.height)];
        let mut neighbours = Vec::new();
        let stamp = id + 1;
        model.window(form, |y, x0, x1, label| {
            let (x0, x1) = (x0.max(-half[0]), x1.min(half[0] + 1));
            if y.abs() > half[1] || x0 >= x1 {
            } else if label == 0 {
                self.clear_undefined(Span { y, x0, x1 }, at, form);
            } else if self.seen[(first + label - 1) as usize] != stamp {
                self.seen[(first + label - 1) as usize] = stamp;
                neighbours.push(first + label - 1);
            }
        });
        let origin = model.primaries[own as usize].origin;
        for neighbour in neighbours {
            if neighbour == own {
                continue;
            }
            let primary = &model.primaries[neighbour as usize];
            let away = [primary.origin[0] - origin[0], primary.origin[1] - origin[1]];
            let away = model.variation(form).there(away);
            let place = [at[0] + away[0], at[1] + away[1]];
            let neighbour = model.varied(neighbour, form);
            if primary.code == EMPTY {
                for &span in model.shape(neighbour).mask.spans() {
                    self.clear_undefined(span, place, form);
                }
            } else if primary.placeable {
                self.request(neighbour, place);
            }
            // Of a texton cut by the border nobody knows what it looks like: left undefined.
        }
    }

    /// Makes undefined cells of a span empty, on the land of a form's library.
    fn clear_undefined(&mut self, span: Span, at: [i32; 2], form: u32) {
        let library = self.model.primary(form).library;
        for cells in self.grid.cells(span, at) {
            if self.ground.is_shared() {
                for i in cells {
                    if self.state[i] == UNDEFINED && self.ground.admits(i, library) {
                        self.state[i] = EMPTY;
                    }
                }
            } else {
                for state in &mut self.state[cells] {
                    if *state == UNDEFINED {
                        *state = EMPTY;
                    }
                }
            }
        }
    }

    /// Asks for a texton like `form`, unless half of it or more is known already: then the rest is
    /// left for other descriptors to define.
    fn request(&mut self, form: u32, at: [i32; 2]) {
        let model = self.model;
        let (shape, primary) = (model.shape(form), model.primary(form));
        let free = |map: &Self, i: usize| map.state[i] == UNDEFINED && map.ground.admits(i, primary.library);
        let mut cells = 0;
        for &span in shape.mask.spans() {
            for run in self.grid.cells(span, at) {
                cells += run.filter(|&i| free(self, i)).count() as u32;
            }
        }
        if cells * 2 <= shape.area {
            return;
        }
        let id = self.requests.len() as u32;
        for &span in shape.mask.spans() {
            for i in self.grid.cells(span, at).flatten() {
                if free(self, i) {
                    (self.state[i], self.owner[i]) = (primary.code, REQUESTS + id);
                }
            }
        }
        self.requests.push(Request { form, at, cells });
        self.weights.push(0);
        self.weigh(id);
    }

    /// Sets the weight of a request: the sum of distances to its border, zero if none of it is to be
    /// filled. A request of which less than half is left is dropped.
    pub(super) fn weigh(&mut self, request: u32) {
        if self.core.as_ref().is_some_and(|core| !core.contains(&self.requests[request as usize].at[1])) {
            self.weights.set(request as usize, 0);
            self.put_off.push(request);
            return;
        }
        let region = self.region(request);
        let asked = self.requests[request as usize].cells as usize;
        if region.cells.len() * 2 < asked || region.cells.is_empty() {
            self.drop_request(request);
            return;
        }
        let seen = region.cells.iter().any(|&(cell, _)| self.inside(cell));
        let weight = if seen { region.cells.iter().map(|c| u64::from(c.1)).sum() } else { 0 };
        self.weights.set(request as usize, weight);
    }

    /// Makes what is left of a request empty.
    pub(super) fn drop_request(&mut self, request: u32) {
        let Request { form, at, .. } = self.requests[request as usize];
        self.weights.set(request as usize, 0);
        let model = self.model;
        for &span in model.shape(form).mask.spans() {
            for i in self.grid.cells(span, at).flatten() {
                if self.owner[i] == REQUESTS + request {
                    (self.owner[i], self.state[i]) = (NOBODY, EMPTY);
                }
            }
        }
    }

    /// A request drawn by weight; `None` once there are no more.
    pub(super) fn draw_request(&self, random: &mut crate::sampling::Stream) -> Option<u32> {
        self.weights.draw(random).map(|i| i as u32)
    }

    /// A request.
    pub(super) fn request_of(&self, request: u32) -> Request {
        self.requests[request as usize]
    }

    /// The owner of the cells of a request.
    pub(super) fn request_owner(request: u32) -> u32 {
        REQUESTS + request
    }

    /// The cells of a request that are still asked for.
    pub(super) fn region(&mut self, request: u32) -> Region {
        let Request { form, at, .. } = self.requests[request as usize];
        let shape = self.model.shape(form);
        let [x0, y0, x1, y1] = shape.bounds;
        // City-block distances in two passes over the box, with a frame of zeros around it.
        let (w, h) = ((x1 - x0 + 2) as usize, (y1 - y0 + 2) as usize);
        let mut distance = std::mem::take(&mut self.scratch);
        distance.clear();
        distance.resize(w * h, 0);
        let mut cells = Vec::new();
        for &span in shape.mask.spans() {
            for part in self.grid.parts(span, at) {
                let [mut x, y] = part.at;
                for i in part.cells {
                    if self.owner[i] == REQUESTS + request {
                        let local = (y - at[1] - y0 + 1) as usize * w + (x - at[0] - x0 + 1) as usize;
                        distance[local] = distance[local - 1].min(distance[local - w]).saturating_add(1);
                        cells.push(([x, y], local));
                    }
                    x += 1;
                }
            }
        }
        let mut region = Region { cells: Vec::with_capacity(cells.len()) };
        for &(cell, local) in cells.iter().rev() {
            let d = distance[local + 1].min(distance[local + w]).saturating_add(1);
            distance[local] = distance[local].min(d);
            region.cells.push((cell, distance[local]));
        }
        self.scratch = distance;
        region
    }

    /// Distance from a place to the nearest other copy of a primary, if within `reach` pixels.
    pub(super) fn nearest_copy(&self, primary: u32, at: [i32; 2], reach: i32) -> Option<f64> {
        let mut nearest = i64::from(reach) * i64::from(reach);
        let mut found = false;
        for bin in self.bins_at([-reach, -reach, reach + 1, reach + 1], at) {
            for &id in &self.bins[bin] {
                let other = &self.placed[id as usize];
                if self.model.primary_of(other.form) == primary {
                    let [dx, dy] = self.grid.way(at, other.at).map(i64::from);
                    if dx * dx + dy * dy <= nearest {
                        (nearest, found) = (dx * dx + dy * dy, true);
                    }
                }
            }
        }
        found.then(|| libm::sqrt(nearest as f64))
    }

    /// The bins that a box around a place touches, each once.
    fn bins_at(&self, bounds: [i32; 4], at: [i32; 2]) -> impl Iterator<Item = usize> + use<> {
        let axis = |low: i32, high: i32, size: i32, wrap: bool| {
            let count = columns(size);
            if !wrap {
                let (first, last) = (low.clamp(0, size - 1) / BIN, (high - 1).clamp(0, size - 1) / BIN);
                return (first, last - first + 1, count);
            }
            let first = low.rem_euclid(size) / BIN;
            let last = (high - 1).rem_euclid(size) / BIN;
            let whole = high - low >= size || (first == last && high - low > BIN);
            (first, if whole { count } else { (last - first).rem_euclid(count) + 1 }, count)
        };
        let (x, w, columns) = axis(at[0] + bounds[0], at[0] + bounds[2], self.grid.width, self.grid.tile.x);
        let (y, h, rows) = axis(at[1] + bounds[1], at[1] + bounds[3], self.grid.height, self.grid.tile.y);
        let cell = move |j: i32, i: i32| ((y + j) % rows * columns + (x + i) % columns) as usize;
        (0..h).flat_map(move |j| (0..w).map(move |i| cell(j, i)))
    }

    /// Indices of the textons that stand, in painting order.
    pub(super) fn painting_order(&self) -> Vec<u32> {
        let mut order: Vec<u32> =
            (0..self.placed.len() as u32).filter(|&i| !self.placed[i as usize].removed).collect();
        let depth = |i: u32| self.model.depth(self.placed[i as usize].form);
        order.sort_by_key(|&i| (std::cmp::Reverse(depth(i)), i));
        order
    }

    /// Whether a texton stands on a cell.
    pub(super) fn taken(&self, i: usize) -> bool {
        self.owner[i] < REQUESTS
    }

    /// How many cells of a form at a place are to be filled.
    pub(super) fn cells_inside(&self, form: u32, at: [i32; 2]) -> u32 {
        let parts = self.model.shape(form).mask.spans().iter().flat_map(|&s| self.grid.parts(s, at));
        parts
            .map(|Part { canvas, .. }| {
                if self.ground.is_plain() {
                    canvas.len() as u32
                } else {
                    canvas.filter(|&i| self.ground.zone(i).is_some()).count() as u32
                }
            })
            .sum()
    }

    /// Whether the edge allows a form at a place.
    pub(super) fn allows(&self, form: u32, at: [i32; 2]) -> bool {
        match self.ground.edge {
            Edge::Clip => true,
            Edge::Keep => self.inside(at),
            Edge::Avoid => self.inside(at) && self.cells_inside(form, at) == self.model.shape(form).area,
        }
    }
}

/// Number of bins along a side.
fn columns(size: i32) -> i32 {
    (size - 1) / BIN + 1
}
