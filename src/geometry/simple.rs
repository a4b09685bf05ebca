//! Whether the rings of a path cross themselves or one another.

use kurbo::{BezPath, PathEl, Point, flatten};

/// Whether no two edges of the flattened path cross properly. Rings may touch at points.
pub fn is_simple(path: &BezPath) -> bool {
    let mut edges: Vec<[Point; 2]> = Vec::new();
    let (mut start, mut at) = (Point::ORIGIN, Point::ORIGIN);
    flatten(path.elements().iter().copied(), 0.05, |el| match el {
        PathEl::MoveTo(p) => (start, at) = (p, p),
        PathEl::LineTo(p) => {
            if p != at {
                edges.push([at, p]);
            }
            at = p;
        }
        _ => {
            if at != start {
                edges.push([at, start]);
            }
            at = start;
        }
    });
    // Sweep along x: only edges whose intervals overlap are compared.
    let left = |e: &[Point; 2]| e[0].x.min(e[1].x);
    let right = |e: &[Point; 2]| e[0].x.max(e[1].x);
    edges.sort_by(|a, b| left(a).total_cmp(&left(b)));
    for (i, a) in edges.iter().enumerate() {
        let end = right(a);
        for b in &edges[i + 1..] {
            if left(b) > end {
                break;
            }
            let apart_in_y =
                a[0].y.max(a[1].y) < b[0].y.min(b[1].y) || b[0].y.max(b[1].y) < a[0].y.min(a[1].y);
            if !apart_in_y && cross(a, b) {
                return false;
            }
        }
    }
    true
}

/// Whether two edges cross at a point inside both.
fn cross(a: &[Point; 2], b: &[Point; 2]) -> bool {
    let side = |e: &[Point; 2], p: Point| (e[1] - e[0]).cross(p - e[0]);
    let (s, t) = (side(a, b[0]), side(a, b[1]));
    let (u, v) = (side(b, a[0]), side(b, a[1]));
    // A hair's breadth of slack: curves that share an end may touch after rounding.
    let slack = 1e-9;
    (s > slack && t < -slack || s < -slack && t > slack)
        && (u > slack && v < -slack || u < -slack && v > slack)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bow_tie_is_not_simple() {
        let path = |text: &str| crate::geometry::parse_path(text).unwrap();
        assert!(is_simple(&path("M0 0h10v10h-10z")));
        assert!(!is_simple(&path("M0 0l10 10h-10l10-10z")));
        assert!(is_simple(&path("M0 0h10v10h-10zM2 2v6h6v-6z")));
        assert!(!is_simple(&path("M0 0h10v10h-10zM2 2v16h6v-16z")));
        assert!(!is_simple(&path("M0 0c20 10-10 10 10 0v-5h-10z")));
    }
}
