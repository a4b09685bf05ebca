//! The element on each pixel of the canvas, and a test of distances.

use super::relations::ElementRelations;
use super::size_of;
use crate::arrange::motifs::DrawnElement;
use crate::arrange::taken::TakenPixels;
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Point, Rect};
use vtex_base::raster::Mask;
use vtex_scene::element::Shape;
use vtex_scene::library::Library;
use vtex_scene::scene::{SynthParams, pixels};

/// Largest canvas with its margins, in pixels, on which elements change places.
pub(super) const MOST_PIXELS: u64 = 600_000_000;

/// The canvas with the element on each pixel.
pub(super) struct OccupiedCanvas<'a> {
    pub(super) library: &'a Library,
    pub(super) relations: &'a ElementRelations,
    pub(super) canvas: [i32; 2],
    /// Number of the placed element on each pixel of the canvas and its margins, from 1.
    cells: Vec<u32>,
    /// The pixels that hold one.
    pub(super) taken: TakenPixels,
    /// Whether the holes of elements are theirs.
    solid: bool,
    /// Pixels of elements turned about the origin, by element and map. Coefficients are in units of [`STEP`].
    turned: BTreeMap<(usize, [i64; 4]), Arc<Mask>>,
}

/// Unit of the coefficients of maps; maps that are equal in it share their pixels.
const STEP: f64 = 1e-4;

impl<'a> OccupiedCanvas<'a> {
    /// An empty canvas; `None` if it would take more than `most` pixels.
    pub(super) fn new(
        library: &'a Library,
        params: &SynthParams,
        relations: &'a ElementRelations,
        most: u64,
    ) -> Option<Self> {
        let wrap = [params.tile.x, params.tile.y];
        let canvas = [params.width as i32, params.height as i32];
        let period = size_of(library);
        let beyond = |k: usize| (relations.margin + 0.5 * period[k]) as i32;
        let first = [0, 1].map(|k| if wrap[k] { 0 } else { -beyond(k) });
        let size = [0, 1].map(|k| if wrap[k] { canvas[k] } else { canvas[k] + 2 * beyond(k) });
        let pixels = size[0] as u64 * size[1] as u64;
        let cells = vec![0; if pixels <= most { pixels as usize } else { return None }];
        let (taken, turned) = (TakenPixels::none(first, size, wrap), BTreeMap::new());
        Some(Self { library, relations, canvas, cells, taken, solid: true, turned })
    }

    /// The pixels of an element in a map, and the whole pixels by which they are moved.
    fn mask(&mut self, p: &DrawnElement) -> (Arc<Mask>, [i32; 2]) {
        let [a, b, c, d, e, f] = p.map.as_coeffs();
        let shift = [e, f].map(|v| libm::round(v).clamp(-1e9, 1e9) as i32);
        let is_solid = self.solid && self.relations.solid[p.element].is_some();
        // An endless element, which runs on from period to period, is in the map of the exemplar and has no
        // pixels of its own.
        if [a, b, c, d] == [1.0, 0.0, 0.0, 1.0] || self.library.elements[p.element].clipped {
            let solid = self.relations.solid[p.element].as_ref().filter(|_| is_solid);
            return (Arc::clone(solid.unwrap_or(&self.relations.masks[p.element])), shift);
        }
        let key = (p.element, [a, b, c, d].map(|v| libm::round(v / STEP) as i64));
        let own = &self.library.elements[p.element];
        let mask = self.turned.entry(key).or_insert_with(|| {
            let turn = Affine::new([a, b, c, d, 0.0, 0.0]);
            let shapes: Vec<Shape> = own.shapes.iter().map(|s| s.moved(turn)).collect();
            let mask = pixels::of_shapes(&shapes);
            Arc::new(if is_solid { pixels::with_holes(&shapes, &mask) } else { mask })
        });
        (Arc::clone(mask), shift)
    }

    /// Writes all elements, in painting order. Calls `go_on` before each.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn write_all(
        &mut self,
        placed: &[DrawnElement],
        go_on: impl Fn() -> Result<()>,
    ) -> Result<()> {
        let mut order: Vec<usize> = (0..placed.len()).collect();
        order.sort_by_key(|&i| placed[i].order);
        for i in order {
            go_on()?;
            self.write(&placed[i], i as u32 + 1, 0);
        }
        self.write_endless();
        Ok(())
    }

    /// Writes the endless elements, which are in every period at the place that the arrangement gives.
    fn write_endless(&mut self) {
        let is_endless: Vec<bool> = self.library.primaries().iter().map(|e| e.clipped).collect();
        if !is_endless.contains(&true) {
            return;
        }
        let labels = self.library.arrangement.to_labels();
        let width = self.taken.size[0] as usize;
        let period = [labels.width, labels.height].map(|size| size as i32);
        let first = [0, 1].map(|k| self.taken.first[k].rem_euclid(period[k]) as usize);
        let rows = labels.labels.chunks_exact(labels.width as usize).cycle().skip(first[1]);
        for ((cells, row), y) in self.cells.chunks_exact_mut(width).zip(rows).zip(0..) {
            let seen = row.iter().cycle().skip(first[0]);
            for ((cell, &label), x) in cells.iter_mut().zip(seen).zip(0..) {
                if label > 0 && is_endless[label as usize - 1] {
                    *cell = u32::MAX - label;
                    self.taken.set_one(y * width + x, true);
                }
            }
        }
    }

    /// Takes or frees the pixels of an element that lies on no other, whatever is written there.
    pub(super) fn set_taken(&mut self, p: &DrawnElement, taken: bool) {
        let (mask, shift) = self.mask(p);
        self.taken.set_mask(&mask, shift, taken);
    }

    /// Writes `new` on the pixels of an element that hold `old`, or on all if `old` is 0.
    pub(super) fn write(&mut self, p: &DrawnElement, new: u32, old: u32) {
        let (mask, shift) = self.mask(p);
        for s in mask.spans() {
            for part in self.taken.row(*s, shift, 0) {
                let cells = &mut self.cells[part.clone()];
                if old == 0 || cells.iter().all(|cell| *cell == old) {
                    cells.fill(new);
                    self.taken.set(part, new != 0);
                    continue;
                }
                for (i, cell) in part.zip(cells).filter(|(_, cell)| **cell == old) {
                    *cell = new;
                    self.taken.set_one(i, new != 0);
                }
            }
        }
    }

    /// Whether an element would be at a distance from all others; `clearance` is in units of that in the
    /// exemplar.
    pub(super) fn fits(&mut self, p: &DrawnElement, clearance: f64) -> bool {
        let (mask, shift) = self.mask(p);
        let distance = libm::ceil(clearance * f64::from(self.relations.clearance)) as i32;
        self.taken.is_free(&mask, shift, distance, self.relations.shortest_side)
    }

    /// Size of the canvas along the axes that repeat.
    pub(super) fn periods(&self) -> [Option<f64>; 2] {
        [0, 1].map(|k| self.taken.wraps[k].then_some(f64::from(self.canvas[k])))
    }

    /// 0 for an element on the canvas, 1 for one on its border, 2 for one outside. Elements change places within
    /// one zone only, so that the coverage of each category stays.
    pub(super) fn zone(&self, p: &DrawnElement) -> u8 {
        let b = p.map.transform_rect_bbox(self.relations.bounds[p.element]);
        let axis = |wrap: bool, low: f64, high: f64, size: i32| match (low >= 0.0, high <= f64::from(size)) {
            _ if wrap => 0,
            (true, true) => 0,
            _ if high <= 0.0 || low >= f64::from(size) => 2,
            _ => 1,
        };
        let ([along, across], [width, height]) = (self.taken.wraps, self.canvas);
        axis(along, b.x0, b.x1, width).max(axis(across, b.y0, b.y1, height))
    }

    /// Centre of an element's bounds.
    pub(super) fn centre(&self, p: &DrawnElement) -> Point {
        p.map * self.relations.bounds[p.element].center()
    }

    /// Share of the canvas that each category covers. Calls `go_on` before each element and each row.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn covered(
        mut self,
        placed: &[DrawnElement],
        go_on: impl Fn() -> Result<()>,
    ) -> Result<Vec<f64>> {
        // What is seen through holes is not covered.
        self.solid = false;
        let solid = &self.relations.solid;
        self.turned.retain(|(element, _), _| solid[*element].is_none());
        self.cells.fill(0);
        self.taken.clear();
        self.write_all(placed, &go_on)?;
        let elements = &self.library.elements;
        let mut counts = vec![0u64; self.library.categories.len()];
        let canvas = Rect::new(0.0, 0.0, f64::from(self.canvas[0]), f64::from(self.canvas[1]));
        let [left, top] = self.taken.first.map(|v| -v as usize);
        let [width, height] = self.canvas.map(|v| v as usize);
        for row in self.cells.chunks_exact(self.taken.size[0] as usize).skip(top).take(height) {
            go_on()?;
            for run in row[left..][..width].chunk_by(|a, b| a == b) {
                let element = match run[0] {
                    0 => continue,
                    own if own as usize <= placed.len() => placed[own as usize - 1].element,
                    label => (u32::MAX - label) as usize - 1,
                };
                if let Some(category) = elements[element].category {
                    counts[category.index()] += run.len() as u64;
                }
            }
        }
        Ok(counts.iter().map(|&n| n as f64 / canvas.area()).collect())
    }
}
