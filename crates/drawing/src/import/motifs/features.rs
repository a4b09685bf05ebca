//! What grouping knows of an element: its place, direction, size and outline, and which others it is like.

use vtex_base::geometry::{Point, Rect, SecondMoments};
use vtex_scene::element;
use vtex_scene::library::ExemplarElement;

/// Most points of the polygons of an element.
const MOST_POINTS: usize = 32;
/// Tolerance of the polygons, as a share of the element's diagonal.
const FLATNESS: f64 = 0.015;
/// Least elongation of an element that has a direction.
const DIRECTED: f64 = 1.3;
/// Largest differences of like elements: of the logarithms of area and elongation, and of compactness.
const AREA: f64 = 0.35;
const ELONGATION: f64 = 0.35;
const COMPACTNESS: f64 = 0.13;
/// Most labels that an element is compared with.
const MOST_LABELS: usize = 512;

/// An element as grouping sees it. Lengths are pixels.
#[derive(Clone)]
pub(super) struct MotifElement {
    pub(super) centre: Point,
    /// Direction of the longer axis, in radians modulo π; `None` for an element about as wide as long.
    pub(super) axis: Option<f64>,
    pub(super) bounds: Rect,
    /// Polygons of all its outlines.
    pub(super) rings: Vec<Vec<Point>>,
    pub(super) layer: usize,
    /// Number of its label: elements of one label are alike in shape and size, whatever their colours.
    pub(super) label: usize,
    /// Whether it can be a part of a motif: it is neither endless nor most of the page.
    pub(super) is_free: bool,
}

impl MotifElement {
    /// Half the diagonal of its bounds.
    pub(super) fn radius(&self) -> f64 {
        libm::hypot(self.bounds.width(), self.bounds.height()) / 2.0
    }
}

/// Properties by which elements are alike: number of shapes, logarithm of area, logarithm of elongation,
/// compactness.
type Look = (usize, [f64; 3]);

/// The elements, given the layer of each; those with a side above `largest` are not free.
pub(super) fn features(
    elements: &[ExemplarElement],
    layers: &[usize],
    is_endless: &[bool],
    largest: [f64; 2],
) -> Vec<MotifElement> {
    let numbered: Vec<usize> = (0..elements.len()).collect();
    let looked = vtex_base::parallel::map(&numbered, |&k| {
        let element = &elements[k];
        let bounds = element::bounds(&element.shapes);
        let moments = SecondMoments::new(element.outline());
        let elongation = moments.elongation();
        let own = MotifElement {
            centre: if moments.area > 0.0 { moments.centroid } else { bounds.center() },
            axis: (elongation >= DIRECTED).then(|| moments.angle()),
            bounds,
            rings: rings(element, bounds),
            layer: layers[k],
            label: 0,
            is_free: !is_endless[k] && bounds.width() <= largest[0] && bounds.height() <= largest[1],
        };
        let area = libm::log(f64::from(element.area.max(1)));
        // Of very long elements the elongation says little beyond their area.
        let elongation = libm::log(elongation.min(30.0));
        let look = (element.shapes.len(), [area, elongation, element.compactness.unwrap_or(0.0)]);
        (own, look)
    });
    let (mut made, looks): (Vec<MotifElement>, Vec<Look>) = looked.into_iter().unzip();
    for (element, label) in made.iter_mut().zip(labels(&looks)) {
        element.label = label;
    }
    made
}

/// How unlike two looks are: more than 1 for elements that are not alike.
fn difference(a: &Look, b: &Look) -> f64 {
    let part = |k: usize, most: f64| (a.1[k] - b.1[k]).abs() / most;
    // What a border cuts may have other shapes than what it does not.
    let border = if a.0 == b.0 { part(2, COMPACTNESS) } else { 0.0 };
    part(0, AREA).max(part(1, ELONGATION)).max(border)
}

/// The label of each look: that of the nearest of the first looks that are unlike each other.
fn labels(looks: &[Look]) -> Vec<usize> {
    let mut first: Vec<Look> = Vec::new();
    for look in looks {
        if first.len() < MOST_LABELS && !first.iter().any(|other| difference(look, other) <= 1.0) {
            first.push(*look);
        }
    }
    let nearest = |look: &Look| {
        let far = |k: usize| difference(look, &first[k]);
        (0..first.len()).min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(0)
    };
    looks.iter().map(nearest).collect()
}

/// Polygons of all outlines of an element, thinned to a bounded number of points.
fn rings(element: &ExemplarElement, bounds: Rect) -> Vec<Vec<Point>> {
    let tolerance = FLATNESS * libm::hypot(bounds.width(), bounds.height());
    let hard = element.shapes.iter().filter(|s| !s.is_soft());
    let mut rings: Vec<Vec<Point>> = hard.flat_map(|s| s.outline.polygons(tolerance)).collect();
    let count: usize = rings.iter().map(Vec::len).sum();
    if count > MOST_POINTS {
        // The longest rings say where the element ends.
        rings.sort_by_key(|ring| std::cmp::Reverse(ring.len()));
        rings.truncate(MOST_POINTS / 8);
        let left: usize = rings.iter().map(Vec::len).sum();
        let step = left.div_ceil(MOST_POINTS).max(1);
        for ring in &mut rings {
            let thinned: Vec<Point> = ring.iter().step_by(step).copied().collect();
            if thinned.len() >= 3 {
                *ring = thinned;
            }
        }
    }
    if rings.is_empty() {
        let Rect { x0, y0, x1, y1 } = bounds;
        rings.push([(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(Point::from).to_vec());
    }
    rings
}
