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
    let mut first: Vec<Look> = Vec::new();
    let label = |(mut own, look): (MotifElement, Look)| {
        let alike = |other: &Look| {
            let near = |k: usize, most: f64| (look.1[k] - other.1[k]).abs() <= most;
            // What a border cuts may have other shapes than what it does not.
            let same_border = look.0 != other.0 || near(2, COMPACTNESS);
            near(0, AREA) && near(1, ELONGATION) && same_border
        };
        let known = first.iter().take(MOST_LABELS).position(alike);
        own.label = known.unwrap_or_else(|| {
            first.push(look);
            first.len() - 1
        });
        own
    };
    looked.into_iter().map(label).collect()
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
