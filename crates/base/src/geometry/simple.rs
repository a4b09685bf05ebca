//! Tests whether a path's rings cross themselves or one another.

use kurbo::{BezPath, PathEl, Point, flatten};

/// Whether no two edges of the flattened path properly cross. Rings may touch at points.
pub fn is_simple(path: &BezPath) -> bool {
    crossing(path, |_, _| false)
}

/// Indices of the elements whose flattened edges cross others, each once.
pub(super) fn crossing_elements(path: &BezPath) -> Vec<usize> {
    let mut found = Vec::new();
    crossing(path, |a, b| {
        found.extend([a, b]);
        true
    });
    found.sort_unstable();
    found.dedup();
    found
}

/// Calls `meet` for pairs of crossing elements until it returns `false`. Returns whether it never did.
fn crossing(path: &BezPath, mut meet: impl FnMut(usize, usize) -> bool) -> bool {
    let edges = edges(path);
    // Sweep along x: only edges whose x intervals overlap are compared.
    for (i, (a, own)) in edges.iter().enumerate() {
        let end = right(a);
        for (b, other) in &edges[i + 1..] {
            if left(b) > end {
                break;
            }
            let apart_in_y =
                a[0].y.max(a[1].y) < b[0].y.min(b[1].y) || b[0].y.max(b[1].y) < a[0].y.min(a[1].y);
            if !apart_in_y && cross(a, b) && !meet(*own, *other) {
                return false;
            }
        }
    }
    true
}

/// The edges of the flattened path with the index of their element, from left to right.
fn edges(path: &BezPath) -> Vec<([Point; 2], usize)> {
    let mut edges: Vec<([Point; 2], usize)> = Vec::new();
    let (mut start, mut at) = (Point::ORIGIN, Point::ORIGIN);
    let mut add = |from: &mut Point, to: Point, element: usize| {
        if to != *from {
            edges.push(([*from, to], element));
        }
        *from = to;
    };
    for (i, &element) in path.elements().iter().enumerate() {
        match element {
            PathEl::MoveTo(p) => (start, at) = (p, p),
            PathEl::ClosePath => add(&mut at, start, i),
            PathEl::LineTo(p) => add(&mut at, p, i),
            curve => flatten([PathEl::MoveTo(at), curve], 0.05, |el| {
                if let PathEl::LineTo(p) = el {
                    add(&mut at, p, i);
                }
            }),
        }
    }
    edges.sort_by(|(a, _), (b, _)| left(a).total_cmp(&left(b)));
    edges
}

fn left(e: &[Point; 2]) -> f64 {
    e[0].x.min(e[1].x)
}

fn right(e: &[Point; 2]) -> f64 {
    e[0].x.max(e[1].x)
}

/// Whether two edges cross at an interior point of both.
fn cross(a: &[Point; 2], b: &[Point; 2]) -> bool {
    let side = |e: &[Point; 2], p: Point| (e[1] - e[0]).cross(p - e[0]);
    let (s, t) = (side(a, b[0]), side(a, b[1]));
    let (u, v) = (side(b, a[0]), side(b, a[1]));
    // Tolerance: curves with a common end may touch after rounding.
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
        assert_eq!(crossing_elements(&path("M0 0h10v10h-10zM2 2v16h6v-16z")), [3, 6, 8]);
        assert!(!is_simple(&path("M0 0c20 10-10 10 10 0v-5h-10z")));
    }
}
