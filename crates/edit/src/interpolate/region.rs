//! Interpolation of regions and domains.

use super::motion::{Brush, MovingShape};
use super::patch::TOLERANCE;
use super::progression::Progression;
use super::ring::{Ring, alignment, even, moments, perimeter};
use vtex_base::geometry::{BezPath, Outline, Point, Rect};
use vtex_scene::scene::{Domain, Edge, Scene};

/// Distance between points along the outline, in pixels, and their largest number.
const STEP: f64 = 3.0;
const MOST: f64 = 2000.0;
/// Margin around the canvas, in pixels, of the outline that stands for a scene without domain. The
/// corners that sampling cuts off lie outside the canvas.
const AROUND: f64 = 8.0;

/// The part of the canvas that a layer or scene fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Extent<'a> {
    /// All of it.
    Whole,
    /// The inside of an outline.
    Of(&'a Outline),
    /// None of it.
    Nothing,
}

/// A region that changes into another.
pub(super) struct RegionTween {
    rings: Vec<[Ring; 2]>,
}

impl RegionTween {
    /// The tween between two extents on a canvas of the given size, in pixels; `None` if both fill it.
    pub(super) fn new(canvas: [f64; 2], ends: [Extent<'_>; 2]) -> Option<Self> {
        if ends == [Extent::Whole; 2] {
            return None;
        }
        let sheet = Rect::new(0.0, 0.0, canvas[0], canvas[1]).inflate(AROUND, AROUND);
        let corners =
            [(sheet.x0, sheet.y0), (sheet.x1, sheet.y0), (sheet.x1, sheet.y1), (sheet.x0, sheet.y1)];
        let sheet: Ring = corners.map(|(x, y)| Point::new(x, y)).into();
        let [a, b] = ends.map(|end| {
            let mut rings = match end {
                Extent::Whole => vec![sheet.clone()],
                Extent::Of(outline) => outline.polygons(0.1),
                Extent::Nothing => Vec::new(),
            };
            rings.sort_by(|a, b| moments(b).0.abs().total_cmp(&moments(a).0.abs()));
            // Outer rings are matched with outer rings and holes with holes, in order of size.
            let (outer, holes): (Vec<Ring>, Vec<Ring>) = rings.into_iter().partition(|r| moments(r).0 > 0.0);
            [outer, holes]
        });
        Some(Self { rings: a.into_iter().zip(b).flat_map(|(a, b)| matched(&a, &b)).collect() })
    }

    /// The region at a time. An empty region is replaced by one beside the canvas, because a layer without a
    /// region fills the canvas.
    pub(super) fn at(&self, when: &Progression) -> Outline {
        let rings: Vec<Ring> = self.rings_at(when).filter(|r| moments(r).0.abs() > 0.5).collect();
        Outline::along(&rings, TOLERANCE).filter(|o| !o.is_empty()).unwrap_or_else(outside_canvas)
    }

    fn rings_at(&self, when: &Progression) -> impl Iterator<Item = Ring> {
        self.rings.iter().map(|[from, to]| {
            let point = |(a, b): (&Point, &Point)| a.lerp(*b, when.at(a.midpoint(*b)));
            from.iter().zip(to).map(point).collect::<Ring>()
        })
    }

    /// The middle of its largest ring at a time.
    fn centre(&self, when: &Progression) -> Point {
        self.rings_at(when).next().map_or(Point::ORIGIN, |ring| moments(&ring).1)
    }

    /// The whole motion.
    pub(super) fn moving(&self) -> MovingShape {
        let rings = self.rings.iter().map(|[from, to]| {
            let half = from.iter().zip(to).map(|(a, b)| a.midpoint(*b)).collect();
            [from.clone(), half, to.clone()]
        });
        MovingShape { rings: rings.collect(), brush: Brush::Fill(Default::default()) }
    }
}

/// A domain that changes into another.
pub(super) struct DomainTween {
    region: RegionTween,
    edges: [Edge; 2],
}

impl DomainTween {
    /// The tween between the domains of two scenes of one size; `None` if both fill the canvas.
    pub(super) fn new(scenes: [&Scene; 2]) -> Option<Self> {
        let domains = scenes.map(|s| s.domain.as_ref());
        let canvas = [scenes[0].width, scenes[0].height].map(f64::from);
        let ends = domains.map(|d| d.map_or(Extent::Whole, |d| Extent::Of(&d.outline)));
        let region = RegionTween::new(canvas, ends)?;
        let [from, to] = domains.map(|d| d.map(|d| d.edge));
        Some(Self { region, edges: [from.or(to).unwrap_or_default(), to.or(from).unwrap_or_default()] })
    }

    /// The domain at a time.
    pub(super) fn at(&self, when: &Progression) -> Domain {
        let edge = self.edges[usize::from(when.at(self.region.centre(when)) >= 0.5)];
        Domain { outline: self.region.at(when), edge }
    }

    /// The whole motion, and what happens to individual elements at the edge.
    pub(super) fn motion(&self) -> (MovingShape, Edge) {
        (self.region.moving(), self.edges[0])
    }
}

/// An outline outside the canvas, which shows nothing.
fn outside_canvas() -> Outline {
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
