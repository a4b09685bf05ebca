//! Distances between neighbouring centres, from a Delaunay triangulation.

use spade::{DelaunayTriangulation, Point2, Triangulation};

/// Lengths of the Delaunay edges between points, in a deterministic order. Edges on the convex hull
/// and those for which `crosses(a, b)` holds are left out. Empty for fewer than four points.
pub(super) fn edge_lengths(points: &[[f64; 2]], crosses: impl Fn([f64; 2], [f64; 2]) -> bool) -> Vec<f64> {
    let vertices = points.iter().map(|p| Point2::new(p[0], p[1])).collect();
    let Ok(triangulation) = DelaunayTriangulation::<Point2<f64>>::bulk_load(vertices) else {
        return Vec::new();
    };
    let mut lengths = Vec::new();
    for edge in triangulation.undirected_edges() {
        let [a, b] = edge.positions().map(|p| [p.x, p.y]);
        if !edge.is_part_of_convex_hull() && !crosses(a, b) {
            lengths.push(libm::hypot(a[0] - b[0], a[1] - b[1]));
        }
    }
    lengths
}

/// The `q` quantile (0 to 1) of the values; `None` if there are none.
pub(super) fn quantile(mut values: Vec<f64>, q: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let at = libm::round(q * values.len().saturating_sub(1) as f64) as usize;
    values.get(at).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_grid() {
        let points: Vec<[f64; 2]> =
            (0..25).map(|i| [f64::from(i % 5) * 3.0, f64::from(i / 5) * 3.0]).collect();
        let lengths = edge_lengths(&points, |_, _| false);
        assert_eq!(quantile(lengths.clone(), 0.0), Some(3.0));
        assert!(lengths.iter().all(|&l| l < 4.3));
        assert!(edge_lengths(&points, |_, _| true).is_empty());
        assert!(edge_lengths(&points[..2], |_, _| false).is_empty());
        assert_eq!(quantile(Vec::new(), 0.4), None);
    }
}
