//! The canvas and a margin around it, cell by cell.
//!
//! Cells are canvas pixels. Besides its state every cell knows its owner, a placed element or a request, so
//! elements can be removed again. The cost of placing or removing one depends on its size, never on the
//! canvas.

use super::bins::Bins;
use super::grid::{CellRun, Grid};
use super::model::{EMPTY, PlaceableId, PlacementModel, UNDEFINED, VariantId};
use super::region::PlacementRegion;
use std::ops::Range;
use vtex_scene::scene::Edge;

/// Index of a placed element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PlacedId(pub(crate) u32);

/// Index of a request of the target map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RequestId(pub(super) u32);

/// The owner of a cell: a placed element, a request, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Owner(u32);

impl Owner {
    /// Nothing.
    pub(super) const NONE: Self = Self(u32::MAX);
    /// The first of the requests; smaller numbers are placed elements.
    const REQUESTS: u32 = 1 << 31;

    /// A placed element.
    pub(super) fn placed(id: PlacedId) -> Self {
        Self(id.0)
    }

    /// A request.
    pub(super) fn request(id: RequestId) -> Self {
        Self(Self::REQUESTS + id.0)
    }

    /// The placed element that a cell belongs to, if one.
    pub(super) fn as_placed(self) -> Option<PlacedId> {
        (self.0 < Self::REQUESTS).then_some(PlacedId(self.0))
    }

    /// The request that a cell belongs to, if one.
    pub(super) fn as_request(self) -> Option<RequestId> {
        (self.0 >= Self::REQUESTS && self != Self::NONE).then(|| RequestId(self.0 - Self::REQUESTS))
    }
}

/// An element that was placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    /// Which variant of which element.
    pub(crate) variant: VariantId,
    /// Place of its origin on the grid, in pixels.
    pub(crate) at: [i32; 2],
    /// Its score when it was placed, per pixel of its area.
    pub(super) score: f32,
    /// Cells of it that no other element covers.
    pub(super) visible: u32,
    /// Cells of it on the grid.
    pub(super) cells: u32,
    /// Taken away again.
    pub(super) removed: bool,
}

/// A canvas and the elements placed on it.
pub(crate) struct Occupancy<'a> {
    model: &'a PlacementModel,
    /// Where elements are wanted.
    pub(crate) region: PlacementRegion<'a>,
    /// The cells.
    pub(crate) grid: Grid,
    /// [`UNDEFINED`], [`EMPTY`], or category + 1, of requests and placed elements alike.
    pub(super) state: Vec<u16>,
    /// The owner of each cell.
    pub(super) owner: Vec<Owner>,
    /// All elements ever placed.
    pub(super) placed: Vec<Standing>,
    /// Number of visible cells in the area to fill, by zone and category.
    pub(super) covered: Vec<Vec<u64>>,
    /// Whether cells of zones without wanted elements count to the zone of the element that covers them.
    counts_overhang: bool,
    bins: Bins,
}

impl<'a> Occupancy<'a> {
    /// A canvas of undefined cells.
    pub(super) fn new(model: &'a PlacementModel, region: PlacementRegion<'a>, grid: Grid) -> Self {
        Self {
            model,
            state: vec![UNDEFINED; grid.len()],
            owner: vec![Owner::NONE; grid.len()],
            placed: Vec::new(),
            covered: vec![vec![0; model.members.len()]; region.zone_count()],
            counts_overhang: false,
            bins: Bins::new(&grid),
            region,
            grid,
        }
    }

    /// Some rows of the canvas, which may reach across a seam, as an occupancy of its own. Its
    /// elements keep their indices.
    pub(super) fn band(&self, rows: &Range<i32>, place: impl Fn([i32; 2]) -> [i32; 2]) -> Self {
        let grid = self.grid.band(rows);
        let mut band = Self {
            model: self.model,
            state: self.grid.rows_of(&self.state, rows),
            owner: self.grid.rows_of(&self.owner, rows),
            placed: self.placed.iter().map(|p| Standing { at: place(p.at), ..*p }).collect(),
            covered: self.covered.clone(),
            counts_overhang: self.counts_overhang,
            bins: Bins::new(&grid),
            region: self.region.band(&self.grid, rows),
            grid,
        };
        let whole = [0, 0, band.grid.width, band.grid.height];
        for (i, p) in band.placed.iter().enumerate().filter(|(_, p)| !p.removed) {
            let bounds = band.model.shape(p.variant).bounds;
            if band.grid.boxes_meet(bounds, p.at, whole, [0, 0]) {
                band.bins.insert(PlacedId(i as u32), bounds, p.at);
            }
        }
        band
    }

    /// The model that elements are taken from.
    pub(crate) fn model(&self) -> &'a PlacementModel {
        self.model
    }

    /// A placed element.
    pub(super) fn get(&self, id: PlacedId) -> &Standing {
        &self.placed[id.0 as usize]
    }

    /// The zone to which a visible cell of an element counts; `None` if the cell is not on `canvas` or not to
    /// be filled.
    fn zone_of_cell(&self, i: usize, canvas: &Range<usize>, element: [i32; 2]) -> Option<usize> {
        let zone = if canvas.contains(&i) { self.region.zone(i)? } else { return None };
        if !self.counts_overhang || self.region.level(zone) > 0.0 {
            return Some(zone);
        }
        let home = self.grid.canvas_cell(element).and_then(|i| self.region.zone(i));
        Some(home.filter(|&home| home == zone + 1).unwrap_or(zone))
    }

    /// From now on, cells of zones without wanted elements count to the sparsest zone with wanted elements,
    /// if an element of that zone covers them. The overhang of this zone is not balanced otherwise: between
    /// any other two zones equally many elements reach over from both sides.
    pub(super) fn count_overhang(&mut self) {
        self.counts_overhang = true;
        self.covered.iter_mut().flatten().for_each(|cells| *cells = 0);
        let [width, height] = self.grid.canvas().map(|v| v as i32);
        let margin = self.grid.margin;
        for [x, y] in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            let i = self.grid.index(x + margin[0], y + margin[1]);
            let Some(id) = self.owner[i].as_placed() else { continue };
            let Standing { variant, at, .. } = *self.get(id);
            if let Some(zone) = self.zone_of_cell(i, &(i..i + 1), at) {
                self.covered[zone][self.model.element(variant).category] += 1;
            }
        }
    }

    /// Whether a place lies on the canvas and is to be filled.
    pub(crate) fn inside(&self, at: [i32; 2]) -> bool {
        self.grid.canvas_cell(at).is_some_and(|i| self.region.zone(i).is_some())
    }

    /// Number of visible cells of a category in the area to fill, in all zones.
    pub(crate) fn covered_by(&self, category: usize) -> u64 {
        self.covered.iter().map(|zone| zone[category]).sum()
    }

    /// Number of visible cells of some categories in the area to fill, in one zone.
    pub(crate) fn covered_in(&self, zone: usize, categories: Range<usize>) -> u64 {
        self.covered[zone][categories].iter().sum()
    }

    /// Whether element `a` is painted over element `b`: small over large, later over earlier, so
    /// that as little as possible is hidden.
    fn above(&self, a: PlacedId, b: PlacedId) -> bool {
        let depth = |id: PlacedId| self.model.depth(self.get(id).variant);
        (depth(b), a) > (depth(a), b)
    }

    /// Places a variant. Gives its index; `met` is called with the requests whose cells it takes,
    /// perhaps more than once.
    pub(super) fn stand(
        &mut self,
        variant: VariantId,
        at: [i32; 2],
        score: f32,
        mut met: impl FnMut(RequestId),
    ) -> PlacedId {
        let shape = self.model.shape(variant);
        let at = self.grid.canonical(at);
        let id = PlacedId(self.placed.len() as u32);
        self.placed.push(Standing { variant, at, score, visible: 0, cells: 0, removed: false });
        for &span in shape.mask.spans() {
            for CellRun { cells, canvas, .. } in self.grid.runs(span, at) {
                self.placed[id.0 as usize].cells += cells.len() as u32;
                for i in cells {
                    match self.owner[i].as_placed() {
                        Some(other) if self.above(other, id) => continue,
                        Some(other) => self.release(i, other, &canvas),
                        None => self.owner[i].as_request().into_iter().for_each(&mut met),
                    }
                    self.own(i, id, &canvas);
                }
            }
        }
        self.bins.insert(id, shape.bounds, at);
        id
    }

    /// Takes over an element whose cells are already set.
    pub(super) fn adopt(&mut self, placed: Standing) {
        let id = PlacedId(self.placed.len() as u32);
        self.bins.insert(id, self.model.shape(placed.variant).bounds, placed.at);
        self.placed.push(placed);
    }

    /// Makes a cell a visible one of a placed element.
    fn own(&mut self, i: usize, id: PlacedId, canvas: &Range<usize>) {
        let placed = &mut self.placed[id.0 as usize];
        placed.visible += 1;
        let (element, at) = (self.model.element(placed.variant), placed.at);
        self.owner[i] = Owner::placed(id);
        self.state[i] = element.code;
        if let Some(zone) = self.zone_of_cell(i, canvas, at) {
            self.covered[zone][element.category] += 1;
        }
    }

    /// Makes a cell of a placed element one that cannot be seen.
    fn release(&mut self, i: usize, id: PlacedId, canvas: &Range<usize>) {
        let below = &mut self.placed[id.0 as usize];
        below.visible -= 1;
        let (category, at) = (self.model.element(below.variant).category, below.at);
        if let Some(zone) = self.zone_of_cell(i, canvas, at) {
            self.covered[zone][category] -= 1;
        }
    }

    /// Removes an element. Elements beneath it become visible; its other cells become empty.
    pub(super) fn remove(&mut self, id: PlacedId) {
        let model = self.model;
        let Standing { variant, at, .. } = *self.get(id);
        let shape = model.shape(variant);
        let own = Owner::placed(id);
        for &span in shape.mask.spans() {
            for CellRun { cells, canvas, .. } in self.grid.runs(span, at) {
                for i in cells.filter(|&i| self.owner[i] == own).collect::<Vec<_>>() {
                    self.release(i, id, &canvas);
                    (self.owner[i], self.state[i]) = (Owner::NONE, EMPTY);
                }
            }
        }
        self.bins.remove(id, shape.bounds, at);
        let mut near: Vec<PlacedId> = self.bins.near(shape.bounds, at).collect();
        near.sort_unstable();
        near.dedup();
        // From the top down, each element takes the cells that are still free.
        near.sort_by(
            |&a, &b| if self.above(a, b) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater },
        );
        for other in near {
            let Standing { variant, at: place, .. } = *self.get(other);
            let other_shape = model.shape(variant);
            if !self.grid.boxes_meet(shape.bounds, at, other_shape.bounds, place) {
                continue;
            }
            for &span in other_shape.mask.spans() {
                for CellRun { cells, canvas, .. } in self.grid.runs(span, place) {
                    for i in cells {
                        if self.owner[i] == Owner::NONE {
                            self.own(i, other, &canvas);
                        }
                    }
                }
            }
        }
        self.placed[id.0 as usize].removed = true;
    }

    /// Proximity of the nearest copy of an element: 1 at the same place, 0 out of reach of descriptors.
    pub(super) fn copy_nearness(&self, element: PlaceableId, at: [i32; 2]) -> f64 {
        let reach = self.model.half.clamp(1, 512);
        self.nearest_copy(element, at, reach).map_or(0.0, |d| 1.0 - d / f64::from(reach))
    }

    /// Distance from a place to the nearest other copy of an element, if within `reach` pixels.
    fn nearest_copy(&self, element: PlaceableId, at: [i32; 2], reach: i32) -> Option<f64> {
        let mut nearest = i64::from(reach) * i64::from(reach);
        let mut found = false;
        for id in self.bins.near([-reach, -reach, reach + 1, reach + 1], at) {
            let other = self.get(id);
            if self.model.element_of(other.variant) == element {
                let [dx, dy] = self.grid.offset(at, other.at).map(i64::from);
                if dx * dx + dy * dy <= nearest {
                    (nearest, found) = (dx * dx + dy * dy, true);
                }
            }
        }
        found.then(|| libm::sqrt(nearest as f64))
    }

    /// The placed elements, in painting order.
    pub(super) fn painting_order(&self) -> Vec<PlacedId> {
        let ids = (0..self.placed.len() as u32).map(PlacedId);
        let mut order: Vec<PlacedId> = ids.filter(|&id| !self.get(id).removed).collect();
        order.sort_by_key(|&id| (std::cmp::Reverse(self.model.depth(self.get(id).variant)), id));
        order
    }

    /// Whether any cell to be filled shows an element.
    pub(super) fn is_seen(&self, id: PlacedId) -> bool {
        let p = self.get(id);
        let spans = self.model.shape(p.variant).mask.spans().iter();
        let canvas = spans.flat_map(|&s| self.grid.runs(s, p.at)).flat_map(|run| run.canvas);
        let mut filled = canvas.filter(|&i| self.region.zone(i).is_some());
        filled.any(|i| self.owner[i] == Owner::placed(id))
    }

    /// The topmost element at a place of the canvas, if there is one.
    pub(crate) fn top(&self, [x, y]: [i32; 2]) -> Option<PlaceableId> {
        let cell = self.grid.cell([x + self.grid.margin[0], y + self.grid.margin[1]])?;
        let id = self.owner[cell].as_placed()?;
        Some(self.model.element_of(self.get(id).variant))
    }

    /// Whether an element covers a cell.
    pub(crate) fn taken(&self, i: usize) -> bool {
        self.owner[i].as_placed().is_some()
    }

    /// Number of cells under a variant at a place that are to be filled.
    pub(super) fn cells_inside(&self, variant: VariantId, at: [i32; 2]) -> u32 {
        let runs = self.model.shape(variant).mask.spans().iter().flat_map(|&s| self.grid.runs(s, at));
        runs.map(|CellRun { canvas, .. }| {
            if self.region.is_plain() {
                canvas.len() as u32
            } else {
                canvas.filter(|&i| self.region.zone(i).is_some()).count() as u32
            }
        })
        .sum()
    }

    /// Whether the edge allows a variant at a place.
    pub(super) fn allows(&self, variant: VariantId, at: [i32; 2]) -> bool {
        match self.region.edge {
            Edge::Clip => true,
            Edge::Keep => self.inside(at),
            Edge::Avoid => {
                self.inside(at) && self.cells_inside(variant, at) == self.model.shape(variant).area
            }
        }
    }
}
