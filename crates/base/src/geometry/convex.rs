//! Clipping of filled paths to convex polygons.

use super::{Outline, is_simple};
use kurbo::{BezPath, ParamCurve, PathEl, PathSeg, Point, Rect, Shape as _, Vec2};

/// A convex polygon, clockwise on the screen.
#[derive(Clone, Debug)]
pub struct ConvexPolygon(Vec<Point>);

impl ConvexPolygon {
    /// A rectangle.
    pub fn rect(r: Rect) -> Self {
        Self([(r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)].map(Point::from).to_vec())
    }

    /// The polygon that a path draws; `None` unless it is one convex polygon of at most 32 corners.
    pub fn of_path(path: &BezPath) -> Option<Self> {
        let segments: Vec<PathSeg> = path.segments().collect();
        let rings = path.elements().iter().filter(|e| matches!(e, PathEl::MoveTo(_))).count();
        let straight = segments.iter().all(|s| matches!(s, PathSeg::Line(_)));
        let mut points: Vec<Point> = segments.iter().map(|s| s.start()).collect();
        points.dedup();
        if rings != 1 || !straight || points.len() < 3 || points.len() > 32 {
            return None;
        }
        if path.area() < 0.0 {
            points.reverse();
        }
        let n = points.len();
        let turn = |i: usize| {
            let [a, b, c] = [0, 1, 2].map(|k| points[(i + k) % n]);
            (b - a).cross(c - b)
        };
        // A star also turns in one direction at all corners.
        let convex = (0..n).all(|i| turn(i) >= -1e-9) && is_simple(path);
        convex.then_some(Self(points))
    }

    /// Whether all of a rectangle lies inside.
    pub fn holds(&self, r: Rect) -> bool {
        let corners = [(r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)].map(Point::from);
        self.sides().all(|(at, inward)| corners.iter().all(|c| (*c - at).dot(inward) >= -1e-6))
    }

    /// A point on each side, and the direction inward.
    fn sides(&self) -> impl Iterator<Item = (Point, Vec2)> + '_ {
        let n = self.0.len();
        (0..n).map(move |i| {
            let along = self.0[(i + 1) % n] - self.0[i];
            (self.0[i], Vec2::new(-along.y, along.x).normalize())
        })
    }

    /// The part inside of a filled path. Rings are closed along the sides.
    pub fn clipped(&self, path: &BezPath) -> BezPath {
        if self.holds(path.bounding_box()) {
            return path.clone();
        }
        self.sides().fold(path.clone(), |path, (at, inward)| half(&path, at, inward))
    }

    /// The part inside of an outline; `None` if there is none.
    pub fn part_of(&self, outline: &Outline) -> Option<Outline> {
        Outline::new(&self.clipped(outline.path())).filter(|part| !part.is_empty())
    }
}

/// The part of a filled path on one side of a line.
fn half(path: &BezPath, at: Point, inward: Vec2) -> BezPath {
    let depth = |p: Point| (p - at).dot(inward);
    let mut out = BezPath::new();
    for ring in closed_rings(path) {
        let mut kept: Vec<PathSeg> = Vec::new();
        for segment in ring {
            let mut cuts = vec![0.0];
            cuts.extend(crossings(&segment, at, inward));
            cuts.push(1.0);
            let parts = cuts.windows(2).filter(|w| w[1] - w[0] > 1e-9);
            let inside = |part: &PathSeg| depth(part.eval(0.5)) >= 0.0;
            kept.extend(parts.map(|w| segment.subsegment(w[0]..w[1])).filter(inside));
        }
        let Some(first) = kept.first() else { continue };
        let (start, mut end) = (first.start(), first.start());
        out.move_to(start);
        for part in kept {
            if (part.start() - end).hypot2() > 1e-18 {
                out.line_to(part.start());
            }
            end = part.end();
            match part {
                PathSeg::Line(l) => out.line_to(l.p1),
                PathSeg::Quad(q) => out.quad_to(q.p1, q.p2),
                PathSeg::Cubic(c) => out.curve_to(c.p1, c.p2, c.p3),
            }
        }
        out.close_path();
    }
    out
}

/// The rings of a filled path, each closed.
pub fn closed_rings(path: &BezPath) -> Vec<Vec<PathSeg>> {
    let split = path.elements().chunk_by(|_, next| !matches!(next, PathEl::MoveTo(_)));
    let closed = |elements: &[PathEl]| {
        let mut ring: Vec<PathSeg> = BezPath::from_vec(elements.to_vec()).segments().collect();
        if let (Some(first), Some(last)) = (ring.first(), ring.last())
            && first.start() != last.end()
        {
            ring.push(PathSeg::Line(kurbo::Line::new(last.end(), first.start())));
        }
        ring
    };
    split.map(closed).filter(|ring| !ring.is_empty()).collect()
}

/// Where a segment crosses a line, rising.
fn crossings(segment: &PathSeg, at: Point, inward: Vec2) -> Vec<f64> {
    let depth = |p: Point| (p - at).dot(inward);
    let mut found: Vec<f64> = match *segment {
        PathSeg::Line(l) => {
            let (a, b) = (depth(l.p0), depth(l.p1));
            if (a < 0.0) == (b < 0.0) { Vec::new() } else { vec![a / (a - b)] }
        }
        PathSeg::Quad(_) | PathSeg::Cubic(_) => {
            let c = segment.to_cubic();
            let [p, q, r, s] = [c.p0, c.p1, c.p2, c.p3].map(depth);
            kurbo::common::solve_cubic(p, 3.0 * (q - p), 3.0 * (p - 2.0 * q + r), s - p + 3.0 * (q - r))
                .into_iter()
                .collect()
        }
    };
    found.retain(|t| *t > 1e-9 && *t < 1.0 - 1e-9);
    found.sort_by(f64::total_cmp);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    #[test]
    fn areas_inside_are_kept() {
        let clip = ConvexPolygon::rect(Rect::new(0.0, 0.0, 10.0, 10.0));
        for (text, area) in [
            ("M-5 2h10v3h-10z", 15.0),
            ("M2 2h3v3h-3z", 9.0),
            ("M20 2h3v3h-3z", 0.0),
            ("M-5-5h20v20h-20zM2 2v2h2v-2z", 96.0),
            ("M-4 5h8v4h-8z", 16.0),
            // Each half of a curve from x = -4 to 4 with both handles at distance 6 has an area of 28.8.
            ("M-4 5c0-6 8-6 8 0c0 6-8 6-8 0z", 28.8),
        ] {
            let found = clip.clipped(&parse_path(text).unwrap()).area();
            assert!((found - area).abs() < 0.3, "{text}: {found}");
        }
        assert!(ConvexPolygon::of_path(&parse_path("M0 0h9v9h-9zM1 1h2v2z").unwrap()).is_none());
        assert!(ConvexPolygon::of_path(&parse_path("M0 0l9 9h-9l9-9z").unwrap()).is_none());
        assert!(ConvexPolygon::of_path(&parse_path("M0 0v9h9v-9z").unwrap()).is_some());
        // A pentagram, either way round, and a pentagon twice around.
        assert!(ConvexPolygon::of_path(&parse_path("M50 0L79 90L2 35H98L21 90z").unwrap()).is_none());
        assert!(ConvexPolygon::of_path(&parse_path("M21 90L98 35H2L79 90L50 0z").unwrap()).is_none());
    }
}
