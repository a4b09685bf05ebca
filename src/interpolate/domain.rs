//! Interpolation of domains.

use super::motion::{Brush, Moving};
use super::patch::TOLERANCE;
use super::progression::Progression;
use super::ring::{Ring, alignment, even, moments, perimeter};
use crate::geometry::{BezPath, Outline, Point, Rect};
use crate::scene::{Domain, Edge, Scene};

/// Distance between points along the outline, in pixels, and their largest number.
const STEP: f64 = 3.0;
const MOST: f64 = 2000.0;
/// Margin around the canvas, in pixels, of the outline that stands for a scene without domain. The
/// corners that sampling cuts off lie outside the canvas.
const AROUND: f64 = 8.0;

/// A domain that changes into another.
pub(super) struct DomainTween {
    rings: Vec<[Ring; 2]>,
    edges: [Edge; 2],
}

impl DomainTween {
    /// The tween between the domains of two scenes of one size; `None` if both fill the canvas.
    pub(super) fn new(scenes: [&Scene; 2]) -> Option<Self> {
        if scenes.iter().all(|s| s.domain.is_none()) {
            return None;
        }
        let canvas = Rect::new(0.0, 0.0, f64::from(scenes[0].width), f64::from(scenes[0].height));
        let sheet = canvas.inflate(AROUND, AROUND);
        let corners =
            [(sheet.x0, sheet.y0), (sheet.x1, sheet.y0), (sheet.x1, sheet.y1), (sheet.x0, sheet.y1)];
        let sheet: Ring = corners.map(|(x, y)| Point::new(x, y)).into();
        let [a, b] = scenes.map(|s| {
            let mut rings =
                s.domain.as_ref().map_or_else(|| vec![sheet.clone()], |d| d.outline.polygons(0.1));
            rings.sort_by(|a, b| moments(b).0.abs().total_cmp(&moments(a).0.abs()));
            // Outer rings are matched with outer rings and holes with holes, in order of size.
            let (outer, holes): (Vec<Ring>, Vec<Ring>) = rings.into_iter().partition(|r| moments(r).0 > 0.0);
            [outer, holes]
        });
        let rings = a.into_iter().zip(b).flat_map(|(a, b)| matched(&a, &b)).collect();
        let edge = |k: usize| scenes[k].domain.as_ref().map(|d| d.edge);
        let edges = [edge(0).or(edge(1)).unwrap_or_default(), edge(1).or(edge(0)).unwrap_or_default()];
        Some(Self { rings, edges })
    }

    /// The domain at a time. If nothing is left of it, it lies beside the canvas, because a scene without
    /// domain fills the canvas.
    pub(super) fn at(&self, when: &Progression) -> Domain {
        let between = |[from, to]: &[Ring; 2]| {
            let point = |(a, b): (&Point, &Point)| a.lerp(*b, when.at(a.midpoint(*b)));
            from.iter().zip(to).map(point).collect::<Ring>()
        };
        let rings: Vec<Ring> = self.rings.iter().map(between).filter(|r| moments(r).0.abs() > 0.5).collect();
        let outline = Outline::along(&rings, TOLERANCE).filter(|o| !o.is_empty()).unwrap_or_else(beside);
        let centre = rings.first().map_or(Point::ORIGIN, |r| moments(r).1);
        Domain { outline, edge: self.edges[usize::from(when.at(centre) >= 0.5)] }
    }
}

impl DomainTween {
    /// The whole motion, and what happens to primaries at the edge.
    pub(super) fn motion(&self) -> (Moving, Edge) {
        let rings = self.rings.iter().map(|[from, to]| {
            let half = from.iter().zip(to).map(|(a, b)| a.midpoint(*b)).collect();
            [from.clone(), half, to.clone()]
        });
        (Moving { rings: rings.collect(), brush: Brush::Fill(Default::default()) }, self.edges[0])
    }
}

/// An outline outside the canvas.
fn beside() -> Outline {
    let mut path = BezPath::new();
    path.move_to((-2.0, -2.0));
    path.line_to((-1.0, -2.0));
    path.line_to((-1.0, -1.0));
    path.close_path();
    Outline::new(&path).unwrap_or_default()
}

/// Pairs of rings; an unmatched ring is paired with its centre.
fn matched(a: &[Ring], b: &[Ring]) -> Vec<[Ring; 2]> {
    let count = |length: f64| libm::ceil(length / STEP).clamp(12.0, MOST) as usize;
    let alone = |ring: &Ring| {
        let ring = even(ring, count(perimeter(ring)));
        let point = vec![moments(&ring).1; ring.len()];
        (ring, point)
    };
    let pair = |i: usize| match (a.get(i), b.get(i)) {
        (Some(a), Some(b)) => {
            let n = count(perimeter(a).max(perimeter(b)));
            let (a, mut b) = (even(a, n), even(b, n));
            let around = |ring: &Ring| -> Ring {
                let centre = moments(ring).1;
                ring.iter().map(|p| (*p - centre).to_point()).collect()
            };
            let (shift, _) = alignment(&around(&a), &around(&b), false);
            b.rotate_left(shift);
            [a, b]
        }
        (Some(a), None) => <[Ring; 2]>::from(alone(a)),
        (None, Some(b)) => {
            let (ring, point) = alone(b);
            [point, ring]
        }
        (None, None) => [Vec::new(), Vec::new()],
    };
    (0..a.len().max(b.len())).map(pair).collect()
}
