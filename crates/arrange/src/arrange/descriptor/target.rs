//! The target map: the placed elements, and the elements that descriptors request in undefined cells.
//!
//! The region of a request needs no search, because each cell stores its owner. Where libraries share a canvas, a
//! descriptor writes only where its library has a part.

use crate::arrange::grid::Grid;
use crate::arrange::model::{EMPTY, PlaceableId, PlacementModel, UNDEFINED, VariantId};
use crate::arrange::occupancy::{Occupancy, Owner, PlacedId, RequestId};
use std::ops::Range;
use vtex_base::raster::Span;
use vtex_base::sampling::{Stream, WeightTree};

/// An element that a descriptor requests.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementRequest {
    /// The variant at this place in the exemplar.
    pub(super) variant: VariantId,
    /// Place of its origin on the grid, in pixels.
    pub(super) at: [i32; 2],
    /// Number of cells of the request when it was made.
    pub(super) cells: u32,
}

/// The target map.
pub(super) struct TargetMap<'a> {
    /// The placed elements.
    pub(super) cells: Occupancy<'a>,
    pub(super) requests: Vec<ElementRequest>,
    /// Weight of each request in the draw.
    pub(super) weights: WeightTree,
    /// Rows whose requests are answered here, if not all; the others are deferred.
    pub(super) core: Option<Range<i32>>,
    pub(super) deferred: Vec<RequestId>,
    /// The last placed element, plus one, in whose descriptor each element was met.
    met: Vec<u32>,
    scratch: Vec<u16>,
}

impl<'a> TargetMap<'a> {
    /// A map without requests.
    pub(super) fn new(cells: Occupancy<'a>) -> Self {
        Self {
            met: vec![0; cells.model().elements.len()],
            cells,
            requests: Vec::new(),
            weights: WeightTree::default(),
            core: None,
            deferred: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// The model that elements are taken from.
    pub(super) fn model(&self) -> &'a PlacementModel {
        self.cells.model()
    }

    /// The cells.
    pub(super) fn grid(&self) -> &Grid {
        &self.cells.grid
    }

    /// Places a variant and its descriptor (paper, algorithm 2).
    pub(super) fn place(&mut self, variant: VariantId, at: [i32; 2], score: f32) {
        let mut met = Vec::new();
        let id = self.cells.stand(variant, at, score, |request| {
            if met.last() != Some(&request) {
                met.push(request);
            }
        });
        met.sort_unstable();
        met.dedup();
        met.into_iter().for_each(|request| self.weigh(request));
        self.write_descriptor(id);
    }

    /// Writes the exemplar's surroundings of a placed element into undefined cells.
    pub(super) fn write_descriptor(&mut self, id: PlacedId) {
        let model = self.model();
        let (variant, at) = (self.cells.get(id).variant, self.cells.get(id).at);
        let own = model.element_of(variant);
        let source = &model.sources[model[own].library];
        let first = source.elements.start;
        // On a small torus a window would overlap itself.
        let half = |wrap: bool, size: i32| if wrap { source.half.min((size - 1) / 2) } else { source.half };
        let grid = self.grid();
        let half = [half(grid.tile.x, grid.width), half(grid.tile.y, grid.height)];
        let mut neighbours = Vec::new();
        let stamp = id.0 + 1;
        model.window(variant, |y, x0, x1, label| {
            let (x0, x1) = (x0.max(-half[0]), x1.min(half[0] + 1));
            if y.abs() > half[1] || x0 >= x1 {
            } else if label == 0 {
                self.clear_undefined(Span { y, x0, x1 }, at, variant);
            } else if self.met[(first + label - 1) as usize] != stamp {
                self.met[(first + label - 1) as usize] = stamp;
                neighbours.push(PlaceableId(first + label - 1));
            }
        });
        let origin = model[own].origin;
        for neighbour in neighbours {
            if neighbour == own {
                continue;
            }
            let element = &model[neighbour];
            let offset = [element.origin[0] - origin[0], element.origin[1] - origin[1]];
            let offset = model.variation(variant).mapped_pixel(offset);
            let place = [at[0] + offset[0], at[1] + offset[1]];
            let neighbour = model.varied(neighbour, variant);
            if element.code == EMPTY {
                for &span in model.shape(neighbour).mask.spans() {
                    self.clear_undefined(span, place, variant);
                }
            } else if element.placeable {
                self.request(neighbour, place);
            }
            // Elements cut by the border are incomplete, so their cells stay undefined.
        }
    }

    /// Makes undefined cells of a span empty, where the library of a variant has a part.
    fn clear_undefined(&mut self, span: Span, at: [i32; 2], variant: VariantId) {
        let library = self.model().element(variant).library;
        let Occupancy { grid, region, state, .. } = &mut self.cells;
        for cells in grid.cells(span, at) {
            if region.is_shared() {
                for i in cells {
                    if state[i] == UNDEFINED && region.admits(i, library) {
                        state[i] = EMPTY;
                    }
                }
            } else {
                for state in &mut state[cells] {
                    if *state == UNDEFINED {
                        *state = EMPTY;
                    }
                }
            }
        }
    }

    /// Requests an element like `variant`, unless half of its cells or more are defined already: then the
    /// rest is left to other descriptors.
    fn request(&mut self, variant: VariantId, at: [i32; 2]) {
        let model = self.model();
        let (shape, element) = (model.shape(variant), model.element(variant));
        let free = |map: &Self, i: usize| {
            map.cells.state[i] == UNDEFINED && map.cells.region.admits(i, element.library)
        };
        let mut cells = 0;
        for &span in shape.mask.spans() {
            for run in self.grid().cells(span, at) {
                cells += run.filter(|&i| free(self, i)).count() as u32;
            }
        }
        if cells * 2 <= shape.area {
            return;
        }
        let id = RequestId(self.requests.len() as u32);
        for &span in shape.mask.spans() {
            for i in self.grid().cells(span, at).flatten() {
                if free(self, i) {
                    (self.cells.state[i], self.cells.owner[i]) = (element.code, Owner::request(id));
                }
            }
        }
        self.requests.push(ElementRequest { variant, at, cells });
        self.weights.push(0);
        self.weigh(id);
    }

    /// Whether a request is to be answered here.
    pub(super) fn in_core(&self, request: RequestId) -> bool {
        self.core.as_ref().is_none_or(|core| core.contains(&self.get(request).at[1]))
    }

    /// Sets the weight of a request: the sum of distances to its border, zero if none of it is to be filled.
    /// A request with less than half of its cells left is dropped.
    pub(super) fn weigh(&mut self, request: RequestId) {
        if !self.in_core(request) {
            self.weights.set(request.0 as usize, 0);
            self.deferred.push(request);
            return;
        }
        let cells = self.cells_of(request);
        let requested = self.get(request).cells as usize;
        if cells.len() * 2 < requested || cells.is_empty() {
            self.drop_request(request);
            return;
        }
        let to_be_filled = cells.iter().any(|&(cell, _)| self.cells.inside(cell));
        let weight = if to_be_filled { cells.iter().map(|c| u64::from(c.1)).sum() } else { 0 };
        self.weights.set(request.0 as usize, weight);
    }

    /// Makes the remaining cells of a request empty.
    pub(super) fn drop_request(&mut self, request: RequestId) {
        let ElementRequest { variant, at, .. } = *self.get(request);
        self.weights.set(request.0 as usize, 0);
        for &span in self.model().shape(variant).mask.spans() {
            for i in self.grid().cells(span, at).flatten() {
                if self.cells.owner[i] == Owner::request(request) {
                    (self.cells.owner[i], self.cells.state[i]) = (Owner::NONE, EMPTY);
                }
            }
        }
    }

    /// A request drawn by weight; `None` once there are no more.
    pub(super) fn draw_request(&self, random: &mut Stream) -> Option<RequestId> {
        self.weights.draw(random).map(|i| RequestId(i as u32))
    }

    /// A request.
    pub(super) fn get(&self, request: RequestId) -> &ElementRequest {
        &self.requests[request.0 as usize]
    }

    /// The remaining cells of a request, each with its city-block distance to the border of these cells, 1 at
    /// the border.
    pub(super) fn cells_of(&mut self, request: RequestId) -> Vec<([i32; 2], u16)> {
        let ElementRequest { variant, at, .. } = *self.get(request);
        let shape = self.model().shape(variant);
        let [x0, y0, x1, y1] = shape.bounds;
        // Two passes over the box, with a frame of zeros around it.
        let (w, h) = ((x1 - x0 + 2) as usize, (y1 - y0 + 2) as usize);
        let mut distance = std::mem::take(&mut self.scratch);
        distance.clear();
        distance.resize(w * h, 0);
        let mut cells = Vec::new();
        for &span in shape.mask.spans() {
            for run in self.grid().runs(span, at) {
                let [mut x, y] = run.at;
                for i in run.cells {
                    if self.cells.owner[i] == Owner::request(request) {
                        let local = (y - at[1] - y0 + 1) as usize * w + (x - at[0] - x0 + 1) as usize;
                        distance[local] = distance[local - 1].min(distance[local - w]).saturating_add(1);
                        cells.push(([x, y], local));
                    }
                    x += 1;
                }
            }
        }
        let mut found = Vec::with_capacity(cells.len());
        for &(cell, local) in cells.iter().rev() {
            let d = distance[local + 1].min(distance[local + w]).saturating_add(1);
            distance[local] = distance[local].min(d);
            found.push((cell, distance[local]));
        }
        self.scratch = distance;
        found
    }
}
