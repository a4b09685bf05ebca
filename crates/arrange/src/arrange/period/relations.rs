//! Properties of a periodic drawing: equal elements, elements that are free to move, and whether the order of
//! elements is regular.

use crate::arrange::motifs::MotifUnits;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use vtex_base::geometry::Rect;
use vtex_base::raster::Mask;
use vtex_base::raster::contact::ContactPage;
use vtex_scene::element::{SimilarTo, bounds};
use vtex_scene::library::{ExemplarElement, Library};
use vtex_scene::reconstruct::equal;
use vtex_scene::scene::pixels;

/// Least share of the elements of a regular drawing that have an element of similar size at one common offset.
const REGULAR: f64 = 0.75;
/// Drawings with fewer elements count as regular.
const FEWEST: usize = 5;
/// Largest difference of sizes and places in a regular order, as a share of the period.
const TOLERANCE: f64 = 0.02;
/// Largest distance of neighbours, in pixels.
const REACH: u16 = 60;

/// The relations between the elements of a drawing.
pub(super) struct ElementRelations {
    /// The class of equal elements that each belongs to.
    pub(super) equal: Vec<SimilarTo>,
    /// For each element, the first equal to it.
    pub(super) first_equal: Vec<usize>,
    /// For each element, the first with about the same colours, shape and size.
    pub(super) first_like: Vec<usize>,
    /// Bounds of each, in the exemplar.
    pub(super) bounds: Vec<Rect>,
    /// Pixels of each element in the exemplar; empty for endless elements.
    pub(super) masks: Vec<Arc<Mask>>,
    /// Whether each element touches no other and is not endless.
    pub(super) free: Vec<bool>,
    /// Angles by which equal elements are turned, in radians; by the first element.
    pub(super) angles: BTreeMap<usize, Vec<f64>>,
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
    pub(super) fn new(library: &Library) -> Self {
        let elements = library.primaries();
        let size = [library.source.width as i32, library.source.height as i32];
        let bounds: Vec<Rect> = elements.iter().map(|e| bounds(&e.shapes)).collect();
        let masks: Vec<Mask> = vtex_base::parallel::map(elements, mask_of);
        // The margin is at most one page width on each side.
        let [w, h] = size;
        let on_page: Vec<Mask> = masks.iter().map(|m| m.within([-w, -h], [2 * w, 2 * h])).collect();
        let (page, mut contacts) = ContactPage::new(size, true, &on_page);
        page.near(REACH, &mut contacts);
        let mut free: Vec<bool> = elements.iter().map(|e| !e.clipped).collect();
        let mut gaps = vec![u16::MAX; elements.len()];
        for (&(a, b, _), contact) in &contacts {
            for k in [a as usize, b as usize] {
                gaps[k] = gaps[k].min(contact.gap);
                free[k] &= contact.gap > 0 && contact.hidden == 0;
            }
        }
        let page_area = f64::from(size[0]) * f64::from(size[1]);
        let spacing = libm::sqrt(page_area / elements.len().max(1) as f64);
        let equal = equal(elements);
        let angles = angles(&equal);
        let largest = elements.iter().zip(&bounds).filter(|(e, _)| !e.clipped).map(|(_, b)| b);
        let largest = largest.map(|b| b.width().max(b.height())).fold(0.0, f64::max);
        let free_bounds = bounds.iter().zip(&free).filter(|(_, free)| **free).map(|(b, _)| b);
        let shortest_side = free_bounds.map(|b| b.width().min(b.height())).fold(f64::INFINITY, f64::min);
        let too_few = free.iter().filter(|f| **f).count() < FEWEST;
        let regular = too_few
            || is_ruled(elements)
            || is_regular(elements, &bounds, size)
            || is_in_rows(elements, &bounds, size);
        let first_equal: Vec<usize> = equal.iter().map(|e| e.first).collect();
        Self {
            first_like: first_like(elements, &first_equal),
            first_equal,
            equal,
            bounds,
            masks: masks.into_iter().map(Arc::new).collect(),
            clearance: clearance(&free, &gaps),
            free,
            angles,
            spacing,
            shortest_side,
            margin: largest.min(0.5 * spacing) + spacing,
            regular,
        }
    }

    /// Turns motifs by the angles at which their copies occur, although these may differ a little.
    pub(super) fn follow(&mut self, units: &MotifUnits) {
        self.equal = units.similar(&self.equal);
        self.angles = angles(&self.equal);
    }
}

/// The pixels of an element; none of an endless one.
fn mask_of(element: &ExemplarElement) -> Mask {
    if element.clipped { Mask::default() } else { pixels::of_shapes(&element.shapes) }
}

/// Three quarters of the lower fifth percentile of the gaps around free elements, in pixels.
fn clearance(free: &[bool], gaps: &[u16]) -> i32 {
    let mut gaps: Vec<u16> = (0..free.len()).filter(|&k| free[k]).map(|k| gaps[k].min(REACH)).collect();
    gaps.sort_unstable();
    let usual = gaps.get(gaps.len() / 5).copied().unwrap_or(1);
    i32::from(usual).clamp(2, 40) * 3 / 4
}

/// Whether endless elements, which leave no room to move between them, make up more than a quarter of the area.
fn is_ruled(elements: &[ExemplarElement]) -> bool {
    let area = |e: &ExemplarElement| f64::from(e.area);
    let endless: f64 = elements.iter().filter(|e| e.clipped).map(area).sum();
    4.0 * endless > elements.iter().map(area).sum::<f64>()
}

/// Largest difference between the logarithms of the areas of like elements.
const AREA: f64 = 0.2;
/// Largest difference between their compactness.
const COMPACTNESS: f64 = 0.12;

/// For each element, the first with about the same colours, shape and size.
fn first_like(elements: &[ExemplarElement], first_equal: &[usize]) -> Vec<usize> {
    let colours = |e: &ExemplarElement| e.shapes.iter().map(|s| s.colour.0).collect::<Vec<_>>();
    let mut firsts: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let mut found: Vec<usize> = Vec::with_capacity(elements.len());
    for (k, element) in elements.iter().enumerate() {
        if first_equal[k] != k {
            found.push(found[first_equal[k]]);
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

/// Angles that differ by less count as equal, in radians.
const SAME_ANGLE: f64 = 0.05;

/// The angles by which the members of each class of equal elements are turned.
fn angles(equal: &[SimilarTo]) -> BTreeMap<usize, Vec<f64>> {
    let mut all: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for SimilarTo { first, map } in equal {
        let [a, b, ..] = map.as_coeffs();
        // Mirrored elements are not turned.
        if map.determinant() > 0.0 {
            let turn = libm::atan2(b, a);
            // -π and π are one angle.
            let turn = if turn < SAME_ANGLE / 2.0 - PI { turn + TAU } else { turn };
            all.entry(*first).or_default().push(turn);
        }
    }
    for angles in all.values_mut() {
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|a, b| (*a - *b).abs() < SAME_ANGLE);
    }
    all
}

/// Whether most elements have an element of similar size at one common offset.
fn is_regular(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    let size = size.map(f64::from);
    let side = libm::sqrt(size[0] * size[1]);
    let same_size = |a: usize, b: usize| have_same_size(&bounds[a], &bounds[b], side) == [true; 2];
    let offset_of = |a: usize, b: usize| offset(&bounds[a], &bounds[b], size);
    let n = elements.len().min(400);
    // An offset that is common to most elements is also one between elements of the commonest size.
    let count = |a: usize| (0..n).filter(|&b| same_size(a, b)).count();
    let Some(first) = (0..n).max_by_key(|&a| (count(a), n - a)) else { return true };
    let offsets = (0..n).filter(|&b| b != first && same_size(first, b)).map(|b| offset_of(first, b)).take(60);
    let share_with_partner = |common: [f64; 2]| {
        let has_partner = |a: usize| {
            (0..n).any(|b| {
                let d = offset_of(a, b);
                let difference = [wrapped(d[0] - common[0], size[0]), wrapped(d[1] - common[1], size[1])];
                same_size(a, b) && difference.iter().all(|v| v.abs() <= TOLERANCE * side)
            })
        };
        (0..n).filter(|&a| has_partner(a)).count() as f64 / n as f64
    };
    let is_far = |o: &[f64; 2]| o[0].abs().max(o[1].abs()) > 0.05 * side;
    offsets.filter(is_far).any(|offset| share_with_partner(offset) >= REGULAR)
}

/// Elements of equal size across a row whose centres differ there by at most this share of the period lie in one row.
const IN_ROW: f64 = 0.005;
/// Least number of pairs of elements in rows, in numbers that chance makes, and how many of its deviations it is beyond.
const BEYOND_CHANCE: [f64; 2] = [2.0, 3.0];
/// Least share of elements that lie in a row with another.
const ROWED: f64 = 0.35;
/// Largest number of elements that are compared.
const COMPARED: usize = 1000;

/// Whether elements of equal height lie in rows, or those of equal width in columns, much more often than by chance,
/// whatever their places within these.
fn is_in_rows(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    let size = size.map(f64::from);
    let side = libm::sqrt(size[0] * size[1]);
    let whole = elements.iter().zip(bounds).filter(|(e, _)| !e.clipped).map(|(_, bounds)| bounds);
    let bounds: Vec<&Rect> = whole.take(COMPARED).collect();
    let mut pairs = [0.0; 2];
    let mut seen = [0.0; 2];
    let mut in_row = vec![[false; 2]; bounds.len()];
    for (a, one) in bounds.iter().enumerate() {
        for (b, other) in bounds[..a].iter().enumerate() {
            let near = offset(one, other, size).map(|d| d.abs() <= IN_ROW * side);
            // Those at one place are parts of one thing.
            if near == [true; 2] {
                continue;
            }
            let same = have_same_size(one, other, side);
            for k in (0..2).filter(|k| same[*k]) {
                pairs[k] += 1.0;
                if near[k] {
                    seen[k] += 1.0;
                    (in_row[a][k], in_row[b][k]) = (true, true);
                }
            }
        }
    }
    (0..2).any(|k| {
        let by_chance = pairs[k] * 2.0 * IN_ROW * side / size[k];
        let [times, deviations] = BEYOND_CHANCE;
        let rowed = in_row.iter().filter(|row| row[k]).count();
        seen[k] > 0.0
            && seen[k] >= times * by_chance
            && seen[k] >= by_chance + deviations * libm::sqrt(by_chance)
            && rowed as f64 >= ROWED * bounds.len() as f64
    })
}

/// Whether two bounds have the same width, and the same height.
fn have_same_size(a: &Rect, b: &Rect, side: f64) -> [bool; 2] {
    [a.width() - b.width(), a.height() - b.height()].map(|d| d.abs() <= TOLERANCE * side)
}

/// The way from the centre of bounds to that of others, on a page that repeats.
fn offset(a: &Rect, b: &Rect, size: [f64; 2]) -> [f64; 2] {
    let d = b.center() - a.center();
    [wrapped(d.x, size[0]), wrapped(d.y, size[1])]
}

fn wrapped(v: f64, size: f64) -> f64 {
    v - size * libm::round(v / size)
}
