//! Replaces textons by those of another library whose shapes fit best.
//!
//! Shapes are compared at the same place, size and direction of the longer axis. Candidates are sorted by
//! elongation. The nearest in elongation, area and compactness are found by a search outwards from the
//! texton's elongation, which ends when all others must be further away. Of these few, the one that overlaps
//! most is taken, turned by 180° if that fits better.

use super::selection::Chosen;
use super::textons::{measured, size};
use super::{place, style};
use std::collections::BTreeMap;
use std::ops::Range;
use vtex_base::geometry::{Affine, Outline, SecondMoments, edges};
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::Library;
use vtex_scene::reconstruct::element;
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Element, ElementId, Instance, LibraryId, Scene};

/// Number of candidates whose overlap with a texton is measured.
const CANDIDATES: usize = 16;
/// Side of the raster on which overlap is counted.
const SIDE: usize = 32;
/// Side of a square of the shape's area, as a share of the raster's side. The ends of shapes more than six
/// times as long as wide lie outside the raster and do not count.
const SPAN: f64 = 0.4;

/// Largest distance of polygons from outlines, in pixels of the raster on which overlap is measured.
const TOLERANCE: f64 = 0.1;

/// A shape brought to the origin, unit area and the longer axis along x, on a raster of bits.
#[derive(Clone)]
struct Stencil {
    rows: [u32; SIDE],
}

impl Stencil {
    /// Both fill rules give the same result for an outline, so a pixel is inside if an odd number of edges
    /// lies to its left.
    fn new(outline: &Outline, moments: &SecondMoments) -> Self {
        let middle = SIDE as f64 / 2.0;
        let onto = Affine::translate((middle, middle)) * Affine::scale(SPAN * SIDE as f64);
        let path = onto * standing(moments).inverse() * outline.path();
        let mut rows = [0u32; SIDE];
        for [a, b] in edges(path, TOLERANCE) {
            let (top, bottom) = (a.y.min(b.y), a.y.max(b.y));
            let row = |y: f64| libm::ceil(y - 0.5).clamp(0.0, SIDE as f64) as usize;
            for (y, bits) in rows.iter_mut().enumerate().take(row(bottom)).skip(row(top)) {
                let x = a.x + (b.x - a.x) * (y as f64 + 0.5 - a.y) / (b.y - a.y);
                *bits ^= u32::MAX.checked_shl(row(x) as u32).unwrap_or(0);
            }
        }
        Self { rows }
    }

    fn turned(&self) -> Self {
        Self { rows: std::array::from_fn(|y| self.rows[SIDE - 1 - y].reverse_bits()) }
    }

    /// Area of the intersection as a share of the area of the union.
    fn overlap(&self, other: &Self) -> f64 {
        let pairs = || self.rows.iter().zip(&other.rows);
        let both: u32 = pairs().map(|(a, b)| (a & b).count_ones()).sum();
        let any: u32 = pairs().map(|(a, b)| (a | b).count_ones()).sum();
        f64::from(both) / f64::from(any.max(1))
    }
}

/// The map from unit area at the origin, longer axis along x, to the place, size and direction of a shape.
fn standing(moments: &SecondMoments) -> Affine {
    let angle = moments.angle();
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let size = libm::sqrt(moments.area);
    let linear = [cosine, sine, -sine, cosine].map(|v| v * size);
    Affine::new([linear[0], linear[1], linear[2], linear[3], moments.centroid.x, moments.centroid.y])
}

/// An element that may replace others.
struct ReplacementCandidate {
    element: Element,
    moments: SecondMoments,
    key: [f64; 3],
    stencil: Stencil,
}

/// Features by which shapes are compared first: logarithms of elongation and area, the latter of less weight
/// because size is adapted, and compactness.
fn key(outline: &Outline, moments: &SecondMoments) -> [f64; 3] {
    [libm::log(moments.elongation()), 0.15 * libm::log(moments.area), outline.compactness()]
}

/// Candidates by rising elongation.
struct Index(Vec<ReplacementCandidate>);

impl Index {
    fn new(elements: Vec<Element>) -> Self {
        let candidates = parallel::map(&elements, |element| {
            let moments = SecondMoments::new(element.outline());
            let sound = moments.area > 0.0;
            sound.then(|| ReplacementCandidate {
                key: key(element.outline(), &moments),
                stencil: Stencil::new(element.outline(), &moments),
                element: element.clone(),
                moments,
            })
        });
        let mut candidates: Vec<ReplacementCandidate> = candidates.into_iter().flatten().collect();
        candidates.sort_by(|a, b| a.key[0].total_cmp(&b.key[0]));
        Self(candidates)
    }

    /// The nearest candidates, nearest first.
    fn near(&self, key: [f64; 3]) -> Vec<usize> {
        let mut found: Vec<(f64, usize)> = Vec::with_capacity(CANDIDATES + 1);
        let middle = self.0.partition_point(|c| c.key[0] < key[0]);
        let (mut down, mut up) = (middle, middle);
        loop {
            let gap = |i: Option<usize>| {
                i.and_then(|i| self.0.get(i)).map_or(f64::INFINITY, |c| (c.key[0] - key[0]).abs())
            };
            let (below, above) = (gap(down.checked_sub(1)), gap(Some(up)));
            let worst = if found.len() < CANDIDATES { f64::INFINITY } else { found[CANDIDATES - 1].0 };
            let least = below.min(above);
            // All later candidates are further away.
            if least == f64::INFINITY || least * least > worst {
                return found.into_iter().map(|(_, i)| i).collect();
            }
            let next = if below <= above {
                down -= 1;
                down
            } else {
                up += 1;
                up - 1
            };
            let far: f64 = (0..3).map(|k| self.0[next].key[k] - key[k]).map(|d| d * d).sum();
            let place = found.partition_point(|(d, i)| (*d, *i) < (far, next));
            found.insert(place, (far, next));
            found.truncate(CANDIDATES);
        }
    }

    /// The best fitting candidate, and whether it is turned by 180°; `None` without candidates.
    fn best(&self, element: &Element, moments: &SecondMoments) -> Option<(usize, bool)> {
        // An outline without area has no shape.
        if moments.area <= 0.0 {
            return None;
        }
        let stencil = Stencil::new(element.outline(), moments);
        let turned = stencil.turned();
        let near = self.near(key(element.outline(), moments)).into_iter();
        let fits = near.flat_map(|i| {
            let of = |s: &Stencil| s.overlap(&self.0[i].stencil);
            [(of(&stencil), i, false), (of(&turned), i, true)]
        });
        // Ties go to the first.
        let best = fits.reduce(|best, next| if next.0 > best.0 { next } else { best });
        best.map(|(_, i, turned)| (i, turned))
    }
}

/// Replaces elements by the library's: individual ones by whole primaries, others by secondaries, which keep
/// their exemplar's colour difference to the field underneath. Returns the number of replaced elements: 0 if
/// the library has none of their kind.
pub(super) fn replace(scene: &mut Scene, chosen: &Chosen, library: &Library) -> usize {
    let libraries = scene.libraries.len();
    let number = number_of(scene, library);
    let first = library.primaries().len();
    let index = |range: Range<usize>| {
        let whole = range.filter(|&i| !library.elements[i].clipped);
        Index::new(whole.map(|i| element(number, library, ElementId::after(i))).collect())
    };
    let (primaries, secondaries) = (index(0..first), index(first..library.elements.len()));
    let moments = measured(scene);
    let periods = scene.periods();
    let mut numbers: BTreeMap<ElementId, ElementId> = BTreeMap::new();
    let mut replaced = 0;
    for k in 0..scene.layers.len() {
        let index = if scene.layers[k].role.is_individual() { &primaries } else { &secondaries };
        let field = scene.field_under(k).map(|f| Interpolant::new(f, scene.width, scene.height, scene.tile));
        let Scene { elements, layers, .. } = &mut *scene;
        let chosen = &chosen.layers[k].instances;
        let pairs = layers[k].instances.iter_mut().zip(chosen).filter(|(_, chosen)| **chosen);
        let selected: Vec<&mut Instance> = pairs.map(|(instance, _)| instance).collect();
        let mut concerned: Vec<ElementId> = selected.iter().map(|i| i.element).collect();
        concerned.sort_unstable();
        concerned.dedup();
        let best = parallel::map(&concerned, |e| index.best(&elements[e.index()], &moments[e.index()]));
        let best: BTreeMap<ElementId, Option<(usize, bool)>> = concerned.into_iter().zip(best).collect();
        for instance in selected {
            let old = instance.element;
            let Some((candidate, turned)) = best.get(&old).copied().flatten() else { continue };
            let Some(source) = index.0[candidate].element.source else { continue };
            let (new, own) = (&index.0[candidate], &moments[old.index()]);
            let (before, at) = (size(instance), instance.affine() * own.centroid);
            place::set(instance, standing_in(instance, new, own, turned), periods);
            style::keep_widths(instance, before);
            replaced += 1;
            instance.element = *numbers.entry(source).or_insert_with(|| {
                elements.push(new.element.clone());
                ElementId::after(elements.len() - 1)
            });
            let difference = library.elements[source.index()].difference;
            instance.colour = field.as_ref().zip(difference).map(|(field, difference)| {
                let beneath = field.at(at.x, at.y);
                Colour::from_f64(std::array::from_fn(|c| beneath[c] + f64::from(difference[c])))
            });
        }
    }
    if replaced == 0 {
        scene.libraries.truncate(libraries);
    }
    replaced
}

/// The map that brings a candidate to the place of an instance, given the moments of the instance's element.
fn standing_in(
    instance: &Instance,
    new: &ReplacementCandidate,
    own: &SecondMoments,
    turned: bool,
) -> [f64; 6] {
    let turn = Affine::scale(if turned { -1.0 } else { 1.0 });
    (instance.affine() * standing(own) * turn * standing(&new.moments).inverse()).as_coeffs()
}

/// The index of a library among those of the scene; adds it to the list if it is missing.
fn number_of(scene: &mut Scene, library: &Library) -> LibraryId {
    let wanted = library.reference();
    let known = scene.libraries.iter().position(|l| *l == wanted);
    let index = known.unwrap_or_else(|| {
        scene.libraries.push(wanted);
        scene.libraries.len() - 1
    });
    LibraryId(index as u32)
}
