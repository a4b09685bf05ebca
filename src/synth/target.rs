//! The target map: what every cell of the canvas and a margin around it should hold or holds.
//!
//! Cells are canvas pixels. Besides its state every cell knows its owner, the request or the
//! placed texton that it belongs to, so the region of a request needs no search and textons can be
//! taken away again. What one placement costs depends on the size of its descriptor alone.

use super::model::{EMPTY, Model, UNDEFINED};
use super::sums::Sums;
use crate::raster::Span;
use std::ops::Range;

/// Owners from here on are requests, smaller ones placed textons; see [`NOBODY`].
const REQUESTS: u32 = 1 << 31;
/// Owner of a cell of no request and no texton.
pub(super) const NOBODY: u32 = u32::MAX;
/// Side of the bins in which placed textons are found, in pixels.
const BIN: i32 = 64;
/// Widest margin, in pixels.
const WIDEST_MARGIN: i32 = 256;

/// A placed texton.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index of the primary.
    pub(super) primary: u32,
    /// Place of its origin on the map, in pixels.
    pub(super) at: [i32; 2],
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
    /// The primary that stands there in the exemplar.
    pub(super) primary: u32,
    /// Place of its origin on the map, in pixels.
    pub(super) at: [i32; 2],
    /// Cells it asked for at first.
    cells: u32,
}

/// The target map.
pub(super) struct TargetMap<'a> {
    model: &'a Model,
    /// Width of the map, in cells.
    pub(super) width: i32,
    /// Height of the map, in cells.
    pub(super) height: i32,
    /// Cells around the canvas on each side.
    pub(super) margin: i32,
    /// [`UNDEFINED`], [`EMPTY`], or category + 1, of requests and placed textons alike.
    pub(super) state: Vec<u16>,
    /// Index of a placed texton, [`REQUESTS`] + index of a request, or [`NOBODY`].
    pub(super) owner: Vec<u32>,
    /// All textons ever placed.
    pub(super) placed: Vec<Placed>,
    requests: Vec<Request>,
    /// Weight of each request in the draw.
    weights: Sums,
    /// Visible cells on the canvas, by category.
    pub(super) covered: Vec<u64>,
    bins: Vec<Vec<u32>>,
    seen: Vec<u32>,
    scratch: Vec<u16>,
}

/// A region of cells and its distances to its border.
pub(super) struct Region {
    /// Cells and their distance to the border of the region, 1 at the border.
    pub(super) cells: Vec<([i32; 2], u16)>,
}

impl<'a> TargetMap<'a> {
    /// A map of undefined cells for a canvas.
    pub(super) fn new(model: &'a Model, width: u32, height: u32) -> Self {
        let margin = (model.reach + 2).min(WIDEST_MARGIN);
        let (width, height) = (width as i32 + 2 * margin, height as i32 + 2 * margin);
        let count = width as usize * height as usize;
        let bins = (width / BIN + 1) as usize * (height / BIN + 1) as usize;
        Self {
            model,
            width,
            height,
            margin,
            state: vec![UNDEFINED; count],
            owner: vec![NOBODY; count],
            placed: Vec::new(),
            requests: Vec::new(),
            weights: Sums::default(),
            covered: vec![0; model.members.len()],
            bins: vec![Vec::new(); bins],
            seen: vec![0; model.shapes.len()],
            scratch: Vec::new(),
        }
    }

    /// The model that textons are taken from.
    pub(super) fn model(&self) -> &'a Model {
        self.model
    }

    /// Index of a cell.
    pub(super) fn index(&self, x: i32, y: i32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// Whether a cell lies on the canvas.
    pub(super) fn on_canvas(&self, x: i32, y: i32) -> bool {
        let inside = |v: i32, size: i32| (self.margin..size - self.margin).contains(&v);
        inside(x, self.width) && inside(y, self.height)
    }

    /// The cells of a span moved to a place, as far as they are on the map.
    pub(super) fn cells(&self, span: Span, at: [i32; 2]) -> Range<usize> {
        let y = span.y + at[1];
        let (x0, x1) = ((span.x0 + at[0]).max(0), (span.x1 + at[0]).min(self.width));
        if !(0..self.height).contains(&y) || x0 >= x1 {
            return 0..0;
        }
        let first = self.index(x0, y);
        first..first + (x1 - x0) as usize
    }

    /// The part of a range of cells, all in one row, that is on the canvas.
    pub(super) fn canvas_part(&self, cells: &Range<usize>) -> Range<usize> {
        let (y, x) = ((cells.start / self.width as usize) as i32, (cells.start % self.width as usize) as i32);
        if !(self.margin..self.height - self.margin).contains(&y) {
            return 0..0;
        }
        let shift = cells.start as i64 - i64::from(x);
        let (low, high) = (shift + i64::from(self.margin), shift + i64::from(self.width - self.margin));
        let (first, last) = ((low as usize).max(cells.start), (high as usize).min(cells.end));
        first..last.max(first)
    }

    /// Whether texton `a` is painted over texton `b`: small over large, later over earlier, so
    /// that as little as possible is hidden.
    fn above(&self, a: u32, b: u32) -> bool {
        let area = |i: u32| self.model.shapes[self.placed[i as usize].primary as usize].area;
        (area(b), a) > (area(a), b)
    }

    /// Places a texton and its descriptor (paper, algorithm 2). Gives its index.
    pub(super) fn place(&mut self, primary: u32, at: [i32; 2]) -> u32 {
        let id = self.stand(primary, at);
        self.write_descriptor(primary, at);
        id
    }

    /// Places a texton without its descriptor. Gives its index.
    pub(super) fn stand(&mut self, primary: u32, at: [i32; 2]) -> u32 {
        let model = self.model;
        let shape = &model.shapes[primary as usize];
        let id = self.placed.len() as u32;
        self.placed.push(Placed { primary, at, visible: 0, cells: 0, removed: false });
        let mut touched = Vec::new();
        for &span in shape.mask.spans() {
            let cells = self.cells(span, at);
            let canvas = self.canvas_part(&cells);
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
                    let below = &mut self.placed[owner as usize];
                    below.visible -= 1;
                    if canvas.contains(&i) {
                        self.covered[model.shapes[below.primary as usize].category] -= 1;
                    }
                }
                self.own(i, id, &canvas);
            }
        }
        let bins = self.bins_at(shape.bounds, at);
        for bin in bins {
            self.bins[bin].push(id);
        }
        touched.sort_unstable();
        touched.dedup();
        for request in touched {
            self.weigh(request - REQUESTS);
        }
        id
    }

    /// Makes a cell a visible one of a placed texton.
    fn own(&mut self, i: usize, id: u32, canvas: &Range<usize>) {
        let texton = &mut self.placed[id as usize];
        texton.visible += 1;
        let shape = &self.model.shapes[texton.primary as usize];
        self.owner[i] = id;
        self.state[i] = shape.code;
        if canvas.contains(&i) {
            self.covered[shape.category] += 1;
        }
    }

    /// Takes a texton away; what it hid comes to light, the rest of its cells become empty.
    pub(super) fn remove(&mut self, id: u32) {
        let model = self.model;
        let Placed { primary, at, .. } = self.placed[id as usize];
        let shape = &model.shapes[primary as usize];
        for &span in shape.mask.spans() {
            let cells = self.cells(span, at);
            let canvas = self.canvas_part(&cells);
            for i in cells.filter(|&i| self.owner[i] == id).collect::<Vec<_>>() {
                (self.owner[i], self.state[i]) = (NOBODY, EMPTY);
                if canvas.contains(&i) {
                    self.covered[shape.category] -= 1;
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
            let Placed { primary, at: place, .. } = self.placed[other as usize];
            let other_shape = &model.shapes[primary as usize];
            if !overlap(shape.bounds, at, other_shape.bounds, place) {
                continue;
            }
            for &span in other_shape.mask.spans() {
                let cells = self.cells(span, place);
                let canvas = self.canvas_part(&cells);
                for i in cells {
                    if self.owner[i] == NOBODY {
                        self.own(i, other, &canvas);
                    }
                }
            }
        }
        let texton = &mut self.placed[id as usize];
        (texton.visible, texton.removed) = (0, true);
    }

    /// Writes what the exemplar holds around a primary wherever nothing is known yet.
    fn write_descriptor(&mut self, primary: u32, at: [i32; 2]) {
        let model = self.model;
        let mut neighbours = Vec::new();
        let stamp = self.placed.len() as u32;
        model.window(primary, |y, x0, x1, label| {
            if label == 0 {
                self.clear_undefined(self.cells(Span { y, x0, x1 }, at));
            } else if self.seen[label as usize - 1] != stamp {
                self.seen[label as usize - 1] = stamp;
                neighbours.push(label - 1);
            }
        });
        let [ox, oy] = model.shapes[primary as usize].origin;
        for neighbour in neighbours {
            if neighbour == primary {
                continue;
            }
            let shape = &model.shapes[neighbour as usize];
            let place = [at[0] + shape.origin[0] - ox, at[1] + shape.origin[1] - oy];
            if shape.code == EMPTY {
                for &span in shape.mask.spans() {
                    self.clear_undefined(self.cells(span, place));
                }
            } else if shape.placeable {
                self.request(neighbour, place);
            }
            // Of a texton cut by the border nobody knows what it looks like: left undefined.
        }
    }

    fn clear_undefined(&mut self, cells: Range<usize>) {
        for state in &mut self.state[cells] {
            if *state == UNDEFINED {
                *state = EMPTY;
            }
        }
    }

    /// Asks for a texton like `primary`, unless half of it or more is known already: then the
    /// rest is left for other descriptors to define.
    fn request(&mut self, primary: u32, at: [i32; 2]) {
        let shape = &self.model.shapes[primary as usize];
        let free = |cells: Range<usize>| self.state[cells].iter().filter(|&&s| s == UNDEFINED).count() as u32;
        let cells: u32 = shape.mask.spans().iter().map(|&s| free(self.cells(s, at))).sum();
        if cells * 2 <= shape.area {
            return;
        }
        let id = self.requests.len() as u32;
        for &span in shape.mask.spans() {
            for i in self.cells(span, at) {
                if self.state[i] == UNDEFINED {
                    (self.state[i], self.owner[i]) = (shape.code, REQUESTS + id);
                }
            }
        }
        self.requests.push(Request { primary, at, cells });
        self.weights.push(0);
        self.weigh(id);
    }

    /// Sets the weight of a request: the sum of distances to its border, zero if none of it is on
    /// the canvas. A request of which less than half is left is dropped.
    fn weigh(&mut self, request: u32) {
        let region = self.region(request);
        let asked = self.requests[request as usize].cells as usize;
        if region.cells.len() * 2 < asked || region.cells.is_empty() {
            self.drop_request(request);
            return;
        }
        let seen = region.cells.iter().any(|&([x, y], _)| self.on_canvas(x, y));
        let weight = if seen { region.cells.iter().map(|c| u64::from(c.1)).sum() } else { 0 };
        self.weights.set(request as usize, weight);
    }

    /// Makes what is left of a request empty.
    pub(super) fn drop_request(&mut self, request: u32) {
        let Request { primary, at, .. } = self.requests[request as usize];
        self.weights.set(request as usize, 0);
        for &span in self.model.shapes[primary as usize].mask.spans() {
            for i in self.cells(span, at) {
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
        let Request { primary, at, .. } = self.requests[request as usize];
        let shape = &self.model.shapes[primary as usize];
        let [x0, y0, x1, y1] = shape.bounds;
        // City-block distances in two passes over the box, with a frame of zeros around it.
        let (w, h) = ((x1 - x0 + 2) as usize, (y1 - y0 + 2) as usize);
        let mut distance = std::mem::take(&mut self.scratch);
        distance.clear();
        distance.resize(w * h, 0);
        let mut cells = Vec::new();
        for &span in shape.mask.spans() {
            for i in self.cells(span, at) {
                if self.owner[i] == REQUESTS + request {
                    let (x, y) = ((i % self.width as usize) as i32, (i / self.width as usize) as i32);
                    let local = (y - at[1] - y0 + 1) as usize * w + (x - at[0] - x0 + 1) as usize;
                    distance[local] = distance[local - 1].min(distance[local - w]).saturating_add(1);
                    cells.push(([x, y], local));
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
                if other.primary == primary {
                    let [dx, dy] = [0, 1].map(|k| i64::from(other.at[k] - at[k]));
                    if dx * dx + dy * dy <= nearest {
                        (nearest, found) = (dx * dx + dy * dy, true);
                    }
                }
            }
        }
        found.then(|| libm::sqrt(nearest as f64))
    }

    /// The bins that a box around a place touches.
    fn bins_at(&self, bounds: [i32; 4], at: [i32; 2]) -> impl Iterator<Item = usize> + use<> {
        let clamp = |v: i32, size: i32| v.clamp(0, size - 1) / BIN;
        let (x0, x1) = (clamp(at[0] + bounds[0], self.width), clamp(at[0] + bounds[2] - 1, self.width));
        let (y0, y1) = (clamp(at[1] + bounds[1], self.height), clamp(at[1] + bounds[3] - 1, self.height));
        let columns = self.width / BIN + 1;
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| (y * columns + x) as usize))
    }

    /// Indices of the textons that stand, in painting order.
    pub(super) fn painting_order(&self) -> Vec<u32> {
        let mut order: Vec<u32> =
            (0..self.placed.len() as u32).filter(|&i| !self.placed[i as usize].removed).collect();
        let area = |i: u32| self.model.shapes[self.placed[i as usize].primary as usize].area;
        order.sort_by_key(|&i| (std::cmp::Reverse(area(i)), i));
        order
    }

    /// Whether a texton stands on a cell.
    pub(super) fn taken(&self, i: usize) -> bool {
        self.owner[i] < REQUESTS
    }
}

/// Whether two boxes, each around its place, have a cell in common.
fn overlap(a: [i32; 4], at: [i32; 2], b: [i32; 4], place: [i32; 2]) -> bool {
    (0..2).all(|k| a[k] + at[k] < b[k + 2] + place[k] && b[k] + place[k] < a[k + 2] + at[k])
}
