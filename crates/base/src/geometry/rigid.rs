//! Rigid maps between corresponding points.

use super::{Affine, Point, Vec2};

/// The map that keeps distances, mirrored or not, and carries the points `from` nearest to the corresponding
/// points `to` in the sense of least squares (the orthogonal Procrustes problem in the plane). The shorter
/// list counts. The identity for no points.
pub fn rigid_map(from: &[Point], to: &[Point], mirrored: bool) -> Affine {
    let n = from.len().min(to.len());
    if n == 0 {
        return Affine::IDENTITY;
    }
    let mean = |all: &[Point]| all[..n].iter().fold(Vec2::ZERO, |sum, p| sum + p.to_vec2()) / n as f64;
    let (own, other) = (mean(from), mean(to));
    let sign = if mirrored { -1.0 } else { 1.0 };
    let (mut re, mut im) = (0.0, 0.0);
    for (p, q) in from.iter().zip(to) {
        let (u, v) = (p.to_vec2() - own, q.to_vec2() - other);
        re += v.x * u.x + v.y * sign * u.y;
        im += v.y * u.x - v.x * sign * u.y;
    }
    let length = libm::hypot(re, im);
    let (c, s) = if length > 0.0 { (re / length, im / length) } else { (1.0, 0.0) };
    let turn = Affine::new([c, s, -sign * s, sign * c, 0.0, 0.0]);
    Affine::translate(other) * turn * Affine::translate(-own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rotation;

    #[test]
    fn turned_and_mirrored_points_come_back() {
        let points = [(0.0, 0.0), (10.0, 1.0), (3.0, 7.0), (-4.0, 2.0)].map(Point::from);
        let turned = Affine::translate((30.0, -8.0)) * rotation(2.1);
        for (map, mirrored) in [(turned, false), (turned * Affine::FLIP_X, true)] {
            let moved: Vec<Point> = points.iter().map(|p| map * *p).collect();
            let found = rigid_map(&points, &moved, mirrored);
            assert!(points.iter().zip(&moved).all(|(p, q)| (found * *p).distance(*q) < 1e-9));
            let wrong = rigid_map(&points, &moved, !mirrored);
            assert!(points.iter().zip(&moved).any(|(p, q)| (wrong * *p).distance(*q) > 1.0));
            assert!((wrong.determinant().abs() - 1.0).abs() < 1e-9);
        }
        assert_eq!(rigid_map(&[], &points, false), Affine::IDENTITY);
        let single = rigid_map(&points[..1], &[Point::new(5.0, 6.0)], false);
        assert!((single * points[0]).distance(Point::new(5.0, 6.0)) < 1e-12);
    }
}
