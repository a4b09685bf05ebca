//! Conversion of outlines to polygons, and of polygons to smooth outlines.

use super::Outline;
use super::fit::fit_closed;
use super::refit::closed;
use kurbo::{BezPath, PathEl, Point, flatten};

/// Points to each side over which a turn counts as a corner.
const CORNER: usize = 4;

impl Outline {
    /// Flattens the rings to closed polygons within `tolerance` pixels, the first point not repeated at
    /// the end. Rings of fewer than three points are dropped.
    pub fn polygons(&self, tolerance: f64) -> Vec<Vec<Point>> {
        polygons(self.path().elements().iter().copied(), tolerance)
    }

    /// Fits smooth closed curves to polygons, within `tolerance` pixels of their points. Points must be
    /// dense: between distant points the curve is unconstrained. Corners stay. Polygons of fewer than
    /// three points are dropped. `None` if a coordinate is out of range.
    pub fn along(polygons: &[Vec<Point>], tolerance: f64) -> Option<Self> {
        let mut path = BezPath::new();
        for polygon in polygons.iter().filter(|p| p.len() >= 3) {
            if !polygon.iter().all(|p| p.is_finite()) {
                return None;
            }
            let (start, pieces) = fit_closed(polygon, Some(CORNER), tolerance);
            path.extend(closed(start, &pieces));
        }
        Self::new(&path)
    }
}

/// The rings of a path as polygons.
fn polygons(path: impl IntoIterator<Item = PathEl>, tolerance: f64) -> Vec<Vec<Point>> {
    let mut rings: Vec<Vec<Point>> = Vec::new();
    flatten(path, tolerance.max(1e-3), |element| match element {
        PathEl::MoveTo(p) => rings.push(vec![p]),
        PathEl::LineTo(p) => {
            if let Some(ring) = rings.last_mut()
                && ring.last() != Some(&p)
            {
                ring.push(p);
            }
        }
        _ => {}
    });
    for ring in &mut rings {
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
    }
    rings.retain(|ring| ring.len() >= 3);
    rings
}

/// The edges of a path flattened within `tolerance`, ring by ring.
pub fn edges(path: impl IntoIterator<Item = PathEl>, tolerance: f64) -> Vec<[Point; 2]> {
    let rings = polygons(path, tolerance);
    rings.iter().flat_map(|r| (0..r.len()).map(|i| [r[i], r[(i + 1) % r.len()]])).collect()
}

/// Whether a point lies inside a ring.
pub fn inside(ring: &[Point], p: Point) -> bool {
    let mut within = false;
    let mut last = ring[ring.len() - 1];
    for &here in ring {
        if (here.y > p.y) != (last.y > p.y) {
            let x = last.x + (p.y - last.y) / (here.y - last.y) * (here.x - last.x);
            within ^= p.x < x;
        }
        last = here;
    }
    within
}

/// A closed path along a ring.
pub fn ring_path(ring: &[Point]) -> BezPath {
    let mut path = BezPath::new();
    if let [first, others @ ..] = ring {
        path.move_to(*first);
        others.iter().for_each(|p| path.line_to(*p));
        path.close_path();
    }
    path
}

/// The point of a line between two points that is nearest to another.
pub fn nearest_between([from, to]: [Point; 2], p: Point) -> Point {
    let side = to - from;
    let share = ((p - from).dot(side) / side.hypot2().max(1e-12)).clamp(0.0, 1.0);
    from + side * share
}

/// The nearest point of a ring.
pub fn nearest(ring: &[Point], p: Point) -> Point {
    let mut best = (f64::INFINITY, p);
    let mut last = ring[ring.len() - 1];
    for &here in ring {
        let q = nearest_between([last, here], p);
        let far = (p - q).hypot2();
        if far < best.0 {
            best = (far, q);
        }
        last = here;
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    /// The polygon with eight points on every edge.
    fn points_between(polygon: &[Point]) -> Vec<Point> {
        let edges = (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
        edges.flat_map(|(a, b)| (0..8).map(move |k| a.lerp(b, f64::from(k) / 8.0))).collect()
    }

    #[test]
    fn a_ring_comes_back_from_its_polygon() {
        for text in [
            "M10 0C16 0 20 4 20 10C20 16 16 20 10 20C4 20 0 16 0 10C0 4 4 0 10 0z",
            "M0 0H40V30H0zM10 10V20H30V10z",
        ] {
            let outline = Outline::new(&parse_path(text).unwrap()).unwrap();
            let polygons = outline.polygons(0.02);
            assert_eq!(polygons.len(), text.matches('M').count());
            let close: Vec<Vec<Point>> = polygons.iter().map(|p| points_between(p)).collect();
            let again = Outline::along(&close, 0.05).unwrap();
            assert!((again.area() - outline.area()).abs() < 0.01 * outline.area(), "{again}");
            assert!((again.bounds().union(outline.bounds()).area() - outline.bounds().area()).abs() < 2.0);
        }
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert!(Outline::default().polygons(0.1).is_empty());
        assert_eq!(Outline::along(&[vec![Point::ORIGIN; 2]], 0.1), Some(Outline::default()));
        assert_eq!(Outline::along(&[vec![Point::new(f64::NAN, 0.0); 3]], 0.1), None);
    }

    #[test]
    fn points_lie_inside_a_ring_or_near_it() {
        let angles = (0..64).map(|i| f64::from(i) * std::f64::consts::TAU / 64.0);
        let ring: Vec<Point> = angles.map(|a| Point::new(5.0 * libm::cos(a), 5.0 * libm::sin(a))).collect();
        assert!(inside(&ring, Point::new(3.0, 3.0)) && !inside(&ring, Point::new(4.0, 4.0)));
        assert!((nearest(&ring, Point::new(20.0, 0.0)).distance(Point::ORIGIN) - 5.0).abs() < 0.02);
    }
}
