//! Point-in-outline tests for many points.

use super::Outline;
use super::polygon::edges;
use kurbo::{Point, Rect};

/// Largest distance between the curve and the polygon that replaces it, in pixels.
const TOLERANCE: f64 = 0.05;
/// Distance from the border at which places of a canvas are taken, as a share of its sides.
const ON_CANVAS: f64 = 1e-6;
/// Approximate number of edges per row.
const EDGES_IN_A_ROW: usize = 8;

/// Rows that an edge touches, on average at most.
const ROWS_OF_AN_EDGE: f64 = 16.0;

/// The interior of an outline, prepared for many queries. Edges are sorted into rows, so a query tests
/// only a few. Exact to 0.05 px.
#[derive(Clone, Debug, PartialEq)]
pub struct Interior {
    bounds: Rect,
    edges: Vec<[Point; 2]>,
    /// The numbers of the edges that touch each row, from top to bottom.
    rows: Vec<Vec<u32>>,
}

impl Interior {
    /// The interior of an outline by the non-zero rule.
    pub fn new(outline: &Outline) -> Self {
        let mut edges = edges(outline.path().iter(), TOLERANCE);
        let bounds = outline.bounds();
        // Tall edges touch many rows, so the number of rows is limited: on average an edge is stored a few
        // times.
        let tall: f64 = edges.iter().map(|[a, b]| (a.y - b.y).abs()).sum();
        let most = edges.len() as f64 * ROWS_OF_AN_EDGE * bounds.height() / tall.max(1e-9);
        let rows = (edges.len() / EDGES_IN_A_ROW).min(most as usize) + 1;
        edges.retain(|[a, b]| a.y != b.y);
        let mut region = Self { bounds, edges: Vec::new(), rows: vec![Vec::new(); rows] };
        for (number, [a, b]) in (0..).zip(&edges) {
            for row in region.row(a.y.min(b.y))..=region.row(a.y.max(b.y)) {
                region.rows[row].push(number);
            }
        }
        Self { edges, ..region }
    }

    fn row(&self, y: f64) -> usize {
        let share = (y - self.bounds.y0) / self.bounds.height().max(1e-9);
        ((share * self.rows.len() as f64).max(0.0) as usize).min(self.rows.len() - 1)
    }

    /// The edges that may touch the horizontal line at `y`.
    fn edges_at(&self, y: f64) -> impl Iterator<Item = &[Point; 2]> {
        self.rows[self.row(y)].iter().map(|&number| &self.edges[number as usize])
    }

    /// Intervals of the horizontal line at `y` that lie in the interior, from left to right.
    pub fn intervals(&self, y: f64) -> Vec<[f64; 2]> {
        if y < self.bounds.y0 || y > self.bounds.y1 {
            return Vec::new();
        }
        let crosses = |[a, b]: &&[Point; 2]| (a.y <= y) != (b.y <= y);
        let crossing = |[a, b]: &[Point; 2]| {
            (a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x), if b.y > a.y { 1 } else { -1 })
        };
        let mut crossings: Vec<(f64, i32)> = self.edges_at(y).filter(crosses).map(crossing).collect();
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut winding, mut start, mut found) = (0, 0.0, Vec::new());
        for (x, direction) in crossings {
            if winding == 0 {
                start = x;
            }
            winding += direction;
            if winding == 0 {
                found.push([start, x]);
            }
        }
        found
    }

    /// Whether the place of a canvas of a width and height that is nearest to a point lies in the interior.
    pub fn contains_on(&self, canvas: [f64; 2], point: Point) -> bool {
        // Outlines that end with the canvas hold places on it, but not its border.
        let place = |v: f64, side: f64| v.clamp(ON_CANVAS * side, (1.0 - ON_CANVAS) * side);
        self.contains(Point::new(place(point.x, canvas[0]), place(point.y, canvas[1])))
    }

    /// Whether a point lies in the interior.
    pub fn contains(&self, point: Point) -> bool {
        if !self.bounds.contains(point) {
            return false;
        }
        let mut winding = 0;
        for [a, b] in self.edges_at(point.y) {
            let down = a.y <= point.y;
            if down == (b.y <= point.y) {
                continue;
            }
            let right = (*b - *a).cross(point - *a) > 0.0;
            if down == right {
                winding += if down { 1 } else { -1 };
            }
        }
        winding != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;
    use kurbo::Shape;

    #[test]
    fn tall_edges_are_stored_a_bounded_number_of_times() {
        // A zigzag over the whole height: each edge touches all rows.
        let zigzag: String = (0..20_000).map(|i| format!("L{} {}", i % 977, 900 * (i % 2))).collect();
        let outline = Outline::new(&parse_path(&format!("M0 0{zigzag}z")).unwrap()).unwrap();
        let stored: usize = Interior::new(&outline).rows.iter().map(Vec::len).sum();
        assert!((20_000..40 * 20_000).contains(&stored), "{stored}");
    }

    #[test]
    fn agrees_with_the_winding_number() {
        for text in [
            "M0 0h40v40h-40zM10 10v20h20v-20z",
            "M0 0c50 10 80 60 30 70c-60 10-20-40-30-70z",
            "M0 0l20 35l-9-2z M50 50h7v7h-7z",
            "",
        ] {
            let outline = Outline::new(&parse_path(text).unwrap()).unwrap();
            let region = Interior::new(&outline);
            let mut inside = 0;
            for i in 0..90 * 90 {
                let p = Point::new(f64::from(i % 90) - 10.13, f64::from(i / 90) - 10.37);
                let wanted = outline.path().winding(p) != 0;
                inside += u32::from(wanted);
                // Within the tolerance of the polygon, either answer is right.
                let near = [-0.06, 0.06].iter().any(|d| {
                    [(*d, 0.0), (0.0, *d)].iter().any(|d| (outline.path().winding(p + *d) != 0) != wanted)
                });
                assert!(near || region.contains(p) == wanted, "{text}: {p:?}");
                let within = region.intervals(p.y).iter().any(|[a, b]| (*a..*b).contains(&p.x));
                assert!(near || within == wanted, "{text}: {p:?} by intervals");
            }
            assert!(text.is_empty() || inside > 20);
        }
    }
}
