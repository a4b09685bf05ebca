//! Properties of a periodic drawing: equal elements, elements that are free to move, and whether the order of
//! elements is regular.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use vtex_base::geometry::{Affine, Rect};
use vtex_base::raster::Mask;
use vtex_base::raster::contact::ContactPage;
use vtex_scene::element::bounds;
use vtex_scene::library::{ExemplarElement, Library};
use vtex_scene::reconstruct::equal;
use vtex_scene::scene::pixels;

/// Least share of elements in a regular drawing that have an element of similar size at the same offset.
const REGULAR: f64 = 0.75;
/// Drawings with fewer elements count as regular.
const FEW: usize = 5;
/// Largest difference of sizes and places in a regular order, as a share of the period.
const ALIKE: f64 = 0.02;
/// Largest distance at which elements are seen to have neighbours, in pixels.
const REACH: u16 = 60;

pub(super) struct ElementRelations {
    /// For each element the first that it is equal to, and the map from that one.
    pub(super) equal: Vec<(usize, Affine)>,
    /// The first element equal to each, and the first element similar to each.
    pub(super) same: Vec<usize>,
    pub(super) alike: Vec<usize>,
    /// Bounds of each, in the exemplar.
    pub(super) bounds: Vec<Rect>,
    /// Pixels of each element in the exemplar; empty for endless elements.
    pub(super) masks: Vec<Arc<Mask>>,
    /// Whether each element touches no other and is not endless.
    pub(super) free: Vec<bool>,
    /// Angles by which equal elements are turned, in radians; by the first element.
    pub(super) angles: BTreeMap<usize, Vec<f64>>,
    /// Distance that elements keep, in pixels.
    pub(super) clearance: i32,
    /// Mean distance between elements, in pixels.
    pub(super) spacing: f64,
    /// Height of the flattest element, in pixels.
    pub(super) lowest: f64,
    /// Distance beyond the canvas up to which elements are placed, in pixels.
    pub(super) margin: f64,
    pub(super) regular: bool,
}

impl ElementRelations {
    pub(super) fn new(library: &Library) -> Self {
        let elements = library.primaries();
        let size = [library.source.width as i32, library.source.height as i32];
        let bounds: Vec<Rect> = elements.iter().map(|e| bounds(&e.shapes)).collect();
        let masks: Vec<Mask> = vtex_base::parallel::map(elements, of_element);
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
        let mut nearest: Vec<u16> =
            (0..free.len()).filter(|&k| free[k]).map(|k| gaps[k].min(REACH)).collect();
        nearest.sort_unstable();
        let usual = nearest.get(nearest.len() / 5).copied().unwrap_or(1);
        let area = f64::from(size[0]) * f64::from(size[1]);
        let spacing = libm::sqrt(area / elements.len().max(1) as f64);
        let equal = equal(elements);
        let angles = angles(&equal);
        let largest = elements.iter().zip(&bounds).filter(|(e, _)| !e.clipped).map(|(_, b)| b);
        let largest = largest.map(|b| b.width().max(b.height())).fold(0.0, f64::max);
        let flat =
            bounds.iter().zip(&free).filter(|(_, free)| **free).map(|(b, _)| b.width().min(b.height()));
        let lowest = flat.fold(f64::INFINITY, f64::min);
        let few = free.iter().filter(|f| **f).count() < FEW;
        let area = |e: &&ExemplarElement| f64::from(e.area);
        let endless: f64 = elements.iter().filter(|e| e.clipped).map(|e| area(&e)).sum();
        // Between endless lines there is no room to move.
        let ruled = 4.0 * endless > elements.iter().map(|e| area(&e)).sum::<f64>();
        let regular = few || ruled || is_regular(elements, &bounds, size);
        let same: Vec<usize> = equal.iter().map(|e| e.0).collect();
        Self {
            alike: alike(elements, &same),
            same,
            equal,
            bounds,
            masks: masks.into_iter().map(Arc::new).collect(),
            free,
            angles,
            clearance: i32::from(usual).clamp(2, 40) * 3 / 4,
            spacing,
            lowest,
            margin: largest.min(0.5 * spacing) + spacing,
            regular,
        }
    }
}

fn of_element(element: &ExemplarElement) -> Mask {
    if element.clipped { Mask::default() } else { pixels::of_shapes(&element.shapes) }
}

/// Largest difference of similar elements: of the logarithms of their areas, and of compactness.
const AREA: f64 = 0.2;
const ROUNDNESS: f64 = 0.12;

/// For each element, the first with about the same colours, shape and size.
fn alike(elements: &[ExemplarElement], same: &[usize]) -> Vec<usize> {
    let colours = |e: &ExemplarElement| e.shapes.iter().map(|s| s.colour.0).collect::<Vec<_>>();
    let mut firsts: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let mut found: Vec<usize> = Vec::with_capacity(elements.len());
    for (k, element) in elements.iter().enumerate() {
        if same[k] != k {
            found.push(found[same[k]]);
            continue;
        }
        let known = firsts.entry((element.category, colours(element))).or_default();
        let near = |&&first: &&usize| {
            let other = &elements[first];
            let area = libm::log(f64::from(element.area.max(1)) / f64::from(other.area.max(1)));
            let round = element.compactness.unwrap_or(0.0) - other.compactness.unwrap_or(0.0);
            area.abs() <= AREA && round.abs() <= ROUNDNESS
        };
        let like = known.iter().take(64).find(near).copied();
        if like.is_none() {
            known.push(k);
        }
        found.push(like.unwrap_or(k));
    }
    found
}

/// Angles that differ by less are one, in radians.
const SAME_ANGLE: f64 = 0.05;

/// The angles by which the members of each class of equal elements are turned.
fn angles(equal: &[(usize, Affine)]) -> BTreeMap<usize, Vec<f64>> {
    let mut all: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (first, map) in equal {
        let [a, b, ..] = map.as_coeffs();
        // Only rotations are used: mirrored or enlarged elements stay so.
        if map.determinant() > 0.0 {
            let turn = libm::atan2(b, a);
            // Half a turn either way is one angle.
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

/// Whether most elements have an element of similar size at one constant offset.
fn is_regular(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    let size = size.map(f64::from);
    let side = libm::sqrt(size[0] * size[1]);
    let like = |a: usize, b: usize| {
        let near = |x: f64, y: f64| (x - y).abs() <= ALIKE * side;
        near(bounds[a].width(), bounds[b].width()) && near(bounds[a].height(), bounds[b].height())
    };
    let wrap = |v: f64, size: f64| v - size * libm::round(v / size);
    let apart = |a: usize, b: usize| {
        let d = bounds[b].center() - bounds[a].center();
        [wrap(d.x, size[0]), wrap(d.y, size[1])]
    };
    let n = elements.len().min(400);
    // The offsets of one element of the commonest size.
    let count = |a: usize| (0..n).filter(|&b| like(a, b)).count();
    let Some(first) = (0..n).max_by_key(|&a| (count(a), n - a)) else { return true };
    let offsets = (0..n).filter(|&b| b != first && like(first, b)).map(|b| apart(first, b)).take(60);
    let kept = |offset: [f64; 2]| {
        let goes_on = |a: usize| {
            (0..n).any(|b| {
                let d = apart(a, b);
                let off = [wrap(d[0] - offset[0], size[0]), wrap(d[1] - offset[1], size[1])];
                like(a, b) && off.iter().all(|v| v.abs() <= ALIKE * side)
            })
        };
        (0..n).filter(|&a| goes_on(a)).count() as f64 / n as f64
    };
    let moves = |o: &[f64; 2]| o[0].abs().max(o[1].abs()) > 0.05 * side;
    offsets.filter(moves).any(|offset| kept(offset) >= REGULAR)
}
