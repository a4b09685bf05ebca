//! Properties of a periodic drawing: equal elements, and elements that are free to move.

use super::order;
use crate::arrange::motifs::MotifUnits;
use crate::arrange::taken::{REACH, TakenPixels, usual_clearance};
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex_base::error::Result;
use vtex_base::geometry::{Point, Rect};
use vtex_base::raster::Mask;
use vtex_base::raster::contact::{ContactPage, gaps};
use vtex_scene::element::{SimilarTo, bounds};
use vtex_scene::library::{ExemplarElement, Library};
use vtex_scene::reconstruct::equal;
use vtex_scene::scene::pixels;

/// Drawings with fewer elements count as regular.
const FEWEST: usize = 5;

/// The relations between the elements of a drawing.
pub(super) struct ElementRelations {
    /// The class of equal elements that each belongs to.
    pub(super) equal: Vec<SimilarTo>,
    /// For each element, the first that equals it without being turned or mirrored.
    pub(super) first_upright: Vec<usize>,
    /// For each element, the first with about the same colours, shape and size.
    pub(super) first_like: Vec<usize>,
    /// Bounds of each, in the exemplar.
    pub(super) bounds: Vec<Rect>,
    /// Pixels of each element in the exemplar; empty for endless elements.
    pub(super) masks: Vec<Arc<Mask>>,
    /// Pixels of each element and of its holes, if it has holes and no other element lies in them: none moves in.
    pub(super) solid: Vec<Option<Arc<Mask>>>,
    /// Whether each element touches no other, is not endless, and is in no line of elements.
    pub(super) free: Vec<bool>,
    /// Whether elements may move along x and y: not across bands.
    pub(super) moves_along: [bool; 2],
    /// Least distance between elements, in pixels: three quarters of the usual smallest gap.
    pub(super) clearance: i32,
    /// Mean distance between elements, in pixels.
    pub(super) spacing: f64,
    /// Shortest side of the bounds of a free element, in pixels; infinite without free elements.
    pub(super) shortest_side: f64,
    /// Distance beyond the canvas up to which elements are placed, in pixels.
    pub(super) margin: f64,
    /// Whether the order of elements is regular, so that by default none moves.
    pub(super) regular: bool,
}

impl ElementRelations {
    /// The relations of a drawing. `go_on` is asked while gaps are measured.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn new(library: &Library, go_on: &dyn Fn() -> Result<()>) -> Result<Self> {
        let elements = library.primaries();
        let size = [library.source.width as i32, library.source.height as i32];
        let bounds: Vec<Rect> = elements.iter().map(|e| bounds(&e.shapes)).collect();
        let masks: Vec<Mask> = vtex_base::parallel::map(elements, mask_of);
        // The margin is at most one page width on each side.
        let [w, h] = size;
        let on_page: Vec<Mask> = masks.iter().map(|m| m.within([-w, -h], [2 * w, 2 * h])).collect();
        let (page, mut contacts) = ContactPage::new(size, [true; 2], &on_page);
        page.near(REACH, &mut contacts, go_on)?;
        let gaps = gaps(&contacts, elements.len(), REACH);
        let mut free: Vec<bool> = elements.iter().zip(&gaps).map(|(e, gap)| !e.clipped && *gap > 0).collect();
        let page_area = f64::from(size[0]) * f64::from(size[1]);
        let spacing = libm::sqrt(page_area / elements.len().max(1) as f64);
        let equal = equal(elements);
        let largest = elements.iter().zip(&bounds).filter(|(e, _)| !e.clipped).map(|(_, b)| b);
        let largest = largest.map(|b| b.width().max(b.height())).fold(0.0, f64::max);
        let free_bounds = bounds.iter().zip(&free).filter(|(_, free)| **free).map(|(b, _)| b);
        let shortest_side = free_bounds.map(|b| b.width().min(b.height())).fold(f64::INFINITY, f64::min);
        let too_few = free.iter().filter(|f| **f).count() < FEWEST;
        let regular = too_few || order::is_regular(elements, &bounds, size);
        let centres: Vec<Point> = bounds.iter().map(Rect::center).collect();
        // Elements of a regular drawing move only if they are asked to, and then those of its lines, too.
        if !regular {
            for line in order::lines(elements, &centres, size) {
                line.into_iter().for_each(|k| free[k] = false);
            }
        }
        Ok(Self {
            moves_along: order::is_even(elements, &centres, size),
            solid: solid(elements, &masks, &on_page, size),
            first_like: first_like(elements, &equal),
            first_upright: first_upright(&equal),
            equal,
            bounds,
            masks: masks.into_iter().map(Arc::new).collect(),
            clearance: usual_clearance((0..free.len()).filter(|&k| free[k]).map(|k| gaps[k])),
            free,
            spacing,
            shortest_side,
            margin: largest.min(0.5 * spacing) + spacing,
            regular,
        })
    }

    /// Takes the copies of a motif for equal, although these may differ a little.
    pub(super) fn follow(&mut self, units: &MotifUnits) {
        self.equal = units.similar(&self.equal);
        self.first_upright = first_upright(&self.equal);
    }
}

/// The pixels of an element; none of an endless one.
fn mask_of(element: &ExemplarElement) -> Mask {
    if element.clipped { Mask::default() } else { pixels::of_shapes(&element.shapes) }
}

/// The pixels of each element with holes in which no other lies, and of these. The page repeats; `on_page` has what of
/// each mask is on it or on those around.
fn solid(
    elements: &[ExemplarElement],
    masks: &[Mask],
    on_page: &[Mask],
    size: [i32; 2],
) -> Vec<Option<Arc<Mask>>> {
    let mut taken = TakenPixels::none([0; 2], size, [true; 2]);
    on_page.iter().for_each(|mask| taken.set_mask(mask, [0; 2], true));
    let numbered: Vec<usize> = (0..masks.len()).collect();
    vtex_base::parallel::map(&numbered, |&k| {
        let filled = if elements[k].clipped {
            Mask::default()
        } else {
            pixels::with_holes(&elements[k].shapes, &masks[k])
        };
        let holes = filled.without(&masks[k]);
        let is_solid = !holes.is_empty() && taken.is_free(&holes, [0; 2], 0, 1.0);
        is_solid.then(|| Arc::new(filled))
    })
}

/// Largest difference between the logarithms of the areas of like elements.
const AREA: f64 = 0.2;
/// Largest difference between their compactness.
const COMPACTNESS: f64 = 0.12;

/// For each element, the first with about the same colours, shape and size.
fn first_like(elements: &[ExemplarElement], equal: &[SimilarTo]) -> Vec<usize> {
    let colours = |e: &ExemplarElement| e.shapes.iter().map(|s| s.colour.0).collect::<Vec<_>>();
    let mut firsts: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let mut found: Vec<usize> = Vec::with_capacity(elements.len());
    for (k, element) in elements.iter().enumerate() {
        if equal[k].first != k {
            found.push(found[equal[k].first]);
            continue;
        }
        let known = firsts.entry((element.category, colours(element))).or_default();
        let near = |&&first: &&usize| {
            let other = &elements[first];
            let area = libm::log(f64::from(element.area.max(1)) / f64::from(other.area.max(1)));
            let compactness = element.compactness.unwrap_or(0.0) - other.compactness.unwrap_or(0.0);
            area.abs() <= AREA && compactness.abs() <= COMPACTNESS
        };
        let like = known.iter().take(64).find(near).copied();
        if like.is_none() {
            known.push(k);
        }
        found.push(like.unwrap_or(k));
    }
    found
}

/// Coefficients of maps that differ by less are those of one angle.
const SAME: f64 = 0.05;

/// For each element, the first that equals it without being turned or mirrored.
fn first_upright(equal: &[SimilarTo]) -> Vec<usize> {
    let mut firsts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let linear = |k: usize| equal[k].map.as_coeffs();
    let first = |k: usize| {
        let known = firsts.entry(equal[k].first).or_default();
        let is_same = |&&other: &&usize| (0..4).all(|c| (linear(k)[c] - linear(other)[c]).abs() < SAME);
        known.iter().take(64).find(is_same).copied().unwrap_or_else(|| {
            known.push(k);
            k
        })
    };
    (0..equal.len()).map(first).collect()
}
