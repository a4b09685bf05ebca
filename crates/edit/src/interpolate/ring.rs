//! Closed polygons: moments, even sampling, and alignment of two polygons.

use std::f64::consts::{PI, TAU};
use vtex_base::geometry::{Affine, Point, Vec2};

/// Distance between points along a ring, in pixels.
const STEP: f64 = 1.2;
/// Smallest and largest number of points of a ring.
const COUNT: (f64, f64) = (10.0, 128.0);
/// Penalty of rotation: a share of the movement, times the squared angle.
const TURN_PENALTY: f64 = 0.15;

/// A closed polygon, the first point not repeated.
pub(super) type Ring = Vec<Point>;

/// Signed area, positive if clockwise on the screen, and centroid. A ring without area has the mean of
/// its points as its centroid.
pub(super) fn moments(ring: &[Point]) -> (f64, Point) {
    let n = ring.len().max(1);
    let mean = (ring.iter().fold(Vec2::ZERO, |sum, p| sum + p.to_vec2()) / n as f64).to_point();
    let (mut twice, mut sum) = (0.0, Vec2::ZERO);
    for (i, p) in ring.iter().enumerate() {
        let (a, b) = (*p - mean, ring[(i + 1) % n] - mean);
        let cross = a.cross(b);
        twice += cross;
        sum += (a + b) * cross;
    }
    let centre = if twice.abs() > 1e-9 { mean + sum / (3.0 * twice) } else { mean };
    (twice / 2.0, centre)
}

pub(super) fn perimeter(ring: &[Point]) -> f64 {
    (0..ring.len()).map(|i| length(ring[(i + 1) % ring.len()] - ring[i])).sum()
}

pub(super) fn length(v: Vec2) -> f64 {
    libm::sqrt(v.hypot2())
}

/// The transformed rings of a shape, the largest first and clockwise on the screen. The other rings
/// keep their direction relative to it.
pub(super) fn transformed(rings: &[Ring], affine: Affine) -> Vec<Ring> {
    let mut rings: Vec<Ring> = rings.iter().map(|r| r.iter().map(|p| affine * *p).collect()).collect();
    let size = |r: &Ring| moments(r).0.abs();
    // Ties go to the first.
    let largest = (0..rings.len()).rev().max_by(|&i, &k| size(&rings[i]).total_cmp(&size(&rings[k])));
    if let Some(largest) = largest {
        rings.swap(0, largest);
        if moments(&rings[0]).0 < 0.0 {
            rings.iter_mut().for_each(|ring| ring.reverse());
        }
    }
    rings
}

/// Number of points for comparing two rings.
pub(super) fn count(a: &[Point], b: &[Point]) -> usize {
    let longest = perimeter(a).max(perimeter(b));
    libm::ceil(longest / STEP).clamp(COUNT.0, COUNT.1) as usize
}

/// `n` points at equal distances along a ring, starting at its first point.
pub(super) fn even(ring: &[Point], n: usize) -> Ring {
    let step = perimeter(ring) / n as f64;
    let mut out = Vec::with_capacity(n);
    let (mut i, mut before) = (0, 0.0);
    let side = |i: usize| ring[(i + 1) % ring.len()] - ring[i % ring.len()];
    let mut here = length(side(0));
    for k in 0..n {
        let wanted = k as f64 * step;
        while before + here < wanted && i + 1 < ring.len() {
            before += here;
            i += 1;
            here = length(side(i));
        }
        let share = if here > 0.0 { ((wanted - before) / here).clamp(0.0, 1.0) } else { 0.0 };
        out.push(ring[i] + side(i) * share);
    }
    out
}

/// Index shift of `to` and rotation of `from` that minimise the movement of the points. Pair rings
/// must have the same number of points and be centred at the origin. Without `turn` the angle is 0.
pub(super) fn alignment(from: &[Point], to: &[Point], turn: bool) -> (usize, f64) {
    let n = from.len();
    let mut best = (f64::NEG_INFINITY, 0, 0.0);
    for shift in 0..n {
        let (mut dot, mut cross) = (0.0, 0.0);
        let (head, tail) = to.split_at(shift);
        for (a, b) in from.iter().zip(tail.iter().chain(head)) {
            dot += a.x * b.x + a.y * b.y;
            cross += a.x * b.y - a.y * b.x;
        }
        let (value, angle) = if turn {
            let angle = libm::atan2(cross, dot);
            (libm::sqrt(dot * dot + cross * cross) * (1.0 - TURN_PENALTY * angle * angle), angle)
        } else {
            (dot, 0.0)
        };
        if value > best.0 {
            best = (value, shift, angle);
        }
    }
    (best.1, best.2)
}

/// A point rotated about the origin.
pub(super) fn turned(p: Point, [sine, cosine]: [f64; 2]) -> Point {
    Point::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y)
}

/// Sine and cosine of an angle.
pub(super) fn sine_cosine(angle: f64) -> [f64; 2] {
    [libm::sin(angle), libm::cos(angle)]
}

/// A disc of the ring's area, with one point for each of the ring's, as close to it as possible.
pub(super) fn disc(ring: &[Point]) -> Ring {
    let n = ring.len();
    let (area, centre) = moments(ring);
    let (mut x, mut y) = (0.0, 0.0);
    for (i, p) in ring.iter().enumerate() {
        let [s, c] = sine_cosine(TAU * i as f64 / n as f64);
        let v = *p - centre;
        x += v.x * c + v.y * s;
        y += v.y * c - v.x * s;
    }
    let first = libm::atan2(y, x);
    let radius = libm::sqrt(area.abs() / PI);
    let point = |i: usize| {
        let [s, c] = sine_cosine(first + TAU * i as f64 / n as f64);
        centre + Vec2::new(c, s) * radius
    };
    (0..n).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(a: f64, b: f64, n: usize, first: f64) -> Ring {
        (0..n)
            .map(|i| {
                let [s, c] = sine_cosine(first + TAU * i as f64 / n as f64);
                Point::new(a * c, b * s)
            })
            .collect()
    }

    #[test]
    fn points_lie_evenly() {
        let ring =
            even(&[Point::ORIGIN, Point::new(8.0, 0.0), Point::new(8.0, 2.0), Point::new(0.0, 2.0)], 20);
        assert_eq!(ring.len(), 20);
        assert!((0..20).all(|i| (length(ring[(i + 1) % 20] - ring[i]) - 1.0).abs() < 1e-9));
        assert_eq!(moments(&ring), (16.0, Point::new(4.0, 1.0)));
    }

    #[test]
    fn a_shifted_and_turned_ring_is_recognised() {
        let from = ellipse(9.0, 3.0, 40, 0.0);
        let to: Ring = from.iter().map(|p| turned(*p, sine_cosine(0.7))).collect();
        let to = [&to[33..], &to[..33]].concat();
        let (shift, angle) = alignment(&from, &to, true);
        let far = (0..40).map(|i| length(turned(from[i], sine_cosine(angle)) - to[(i + shift) % 40]));
        let far = far.fold(0.0, f64::max);
        // For smaller turns, points may be off by a step of the ring.
        assert!(shift.abs_diff(7) <= 1 && (angle - 0.7).abs() < 0.12 && far < 1.3, "{shift} {angle} {far}");
        // Content is nearly round is not turned.
        let (_, angle) = alignment(&ellipse(5.0, 4.0, 40, 0.0), &ellipse(4.0, 5.0, 40, 1.0), true);
        assert!(angle.abs() < 0.2, "{angle}");
    }

    #[test]
    fn the_disc_of_a_disc_is_itself() {
        let ring = ellipse(5.0, 5.0, 64, 0.3);
        let far = ring.iter().zip(disc(&ring)).map(|(a, b)| length(*a - b)).fold(0.0, f64::max);
        assert!(far < 0.01, "{far}");
    }
}
