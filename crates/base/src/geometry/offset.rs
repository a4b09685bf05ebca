//! Rings moved inwards or outwards by a distance.

use super::{inside, nearest_between};
use kurbo::{Point, Vec2};

/// Most parts in which a step of a ring is moved, each at least a distance long.
const PARTS: f64 = 8.0;
/// Largest turn between two points of an arc round a corner, in radians: 15°.
const TURN: f64 = 0.27;
/// Share of the distance by which a moved point may be too near to the ring.
const NEAR: f64 = 1e-6;
/// Least square of the sum of the directions to the sides of a corner that stays: 4 for none, 0 for a turn back.
const SHARPEST: f64 = 0.03;
/// Longest way round a new corner, as a multiple of the straight way.
const MITRE: f64 = 4.0;

/// A ring moved inwards by a distance, or outwards where that is below 0: the points that are so far from the ring. The
/// ring is closed, without its first point at the end, its area positive where y runs upwards. Corners that the ring turns
/// round become arcs, those that it shrinks into stay sharp. Empty where nothing is left. Where a ring is narrower than
/// twice the distance in its middle, its parts stay joined by a line.
pub fn moved_inwards(ring: &[Point], by: f64) -> Vec<Point> {
    if by == 0.0 || ring.len() < 3 {
        return ring.to_vec();
    }
    let far = by.abs();
    let steps = steps(ring, far);
    let n = steps.len();
    let ways: Vec<Vec2> = steps.iter().map(|[from, to]| direction(*from, *to)).collect();
    let mut all: Vec<MovedPoint> = Vec::with_capacity(2 * n);
    for k in 0..n {
        let (at, before, after) = (steps[k][0], ways[(k + n - 1) % n], ways[k]);
        let turn = libm::atan2(before.cross(after), before.dot(after));
        if turn * by >= 0.0 {
            // Where the sides meet.
            let sum = left(before) + left(after);
            if sum.hypot2() > SHARPEST {
                all.push(MovedPoint { at: at + 2.0 * by / sum.hypot2() * sum, before, after });
            }
            continue;
        }
        // Where the ring turns away from the side that it moves to, the corner is turned round.
        let count = libm::ceil(turn.abs() / TURN);
        for step in 0..=count as usize {
            let (sine, cosine) = libm::sincos(turn * step as f64 / count);
            let way = Vec2::new(cosine * before.x - sine * before.y, sine * before.x + cosine * before.y);
            all.push(MovedPoint { at: at + by * left(way), before: way, after: way });
        }
    }
    let least = far * (1.0 - NEAR);
    let is_far = |p: Point| steps.iter().all(|s| nearest_between(*s, p).distance_squared(p) >= least * least);
    let is_free = |p: Point| inside(ring, p) == (by > 0.0) && is_far(p);
    let free: Vec<bool> = all.iter().map(|c| is_free(c.at)).collect();
    let count = all.len();
    // From the beginning of a run of free points, so that no gap lies across the end of the list.
    let Some(first) = (0..count).find(|k| free[*k] && !free[(k + count - 1) % count]) else {
        return if free.contains(&true) { distinct(all.into_iter().map(|c| c.at)) } else { Vec::new() };
    };
    let mut moved: Vec<Point> = Vec::with_capacity(count);
    let mut last = all[first];
    for k in (first..=first + count).map(|k| k % count).filter(|k| free[*k]) {
        if !moved.is_empty() && !free[(k + count - 1) % count] {
            moved.extend(last.corner(&all[k]).filter(|p| is_free(*p)));
        }
        moved.push(all[k].at);
        last = all[k];
    }
    let moved = distinct(moved);
    if moved.len() < 3 { Vec::new() } else { moved }
}

/// A ring without the narrow parts and corners that a disc of a radius does not reach from within.
pub fn opened(ring: &[Point], radius: f64) -> Vec<Point> {
    moved_inwards(&moved_inwards(ring, radius), -radius)
}

/// Area of a ring, positive where it runs as its points turn from x to y.
pub fn signed_area(ring: &[Point]) -> f64 {
    let n = ring.len();
    (0..n).map(|k| 0.5 * ring[k].to_vec2().cross(ring[(k + 1) % n].to_vec2())).sum()
}

/// The steps of a ring, in parts at least `least` long where they are longer.
fn steps(ring: &[Point], least: f64) -> Vec<[Point; 2]> {
    let n = ring.len();
    let mut steps = Vec::with_capacity(n);
    for k in 0..n {
        let [from, to] = [ring[k], ring[(k + 1) % n]];
        let count = libm::ceil(from.distance(to) / least).min(PARTS) as usize;
        let at = |i: usize| if i == count { to } else { from.lerp(to, i as f64 / count as f64) };
        steps.extend((0..count).map(|i| [at(i), at(i + 1)]));
    }
    steps
}

/// A point of a moved ring, and the directions in which the ring reaches and leaves it.
#[derive(Clone, Copy)]
struct MovedPoint {
    at: Point,
    before: Vec2,
    after: Vec2,
}

impl MovedPoint {
    /// Where the line that leaves this point meets the one that reaches another.
    fn corner(&self, next: &Self) -> Option<Point> {
        let across = self.after.cross(next.before);
        if across.abs() < 1e-6 {
            return None;
        }
        let way = next.at - self.at;
        let (forth, back) = (way.cross(next.before) / across, self.after.cross(way) / across);
        let is_near = forth + back <= MITRE * libm::sqrt(way.hypot2());
        (forth >= 0.0 && back >= 0.0 && is_near).then(|| self.at + forth * self.after)
    }
}

/// Points without those that repeat the one before.
fn distinct(points: impl IntoIterator<Item = Point>) -> Vec<Point> {
    let mut all: Vec<Point> = Vec::new();
    for p in points {
        if all.last().is_none_or(|last| last.distance_squared(p) > 1e-12) {
            all.push(p);
        }
    }
    while all.len() > 1 && all[0].distance_squared(all[all.len() - 1]) <= 1e-12 {
        all.pop();
    }
    all
}

fn direction(from: Point, to: Point) -> Vec2 {
    let way = to - from;
    way / libm::sqrt(way.hypot2())
}

/// A direction turned from x to y by a right angle.
fn left(way: Vec2) -> Vec2 {
    Vec2::new(-way.y, way.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[[f64; 2]]) -> Vec<Point> {
        points.iter().map(|p| Point::new(p[0], p[1])).collect()
    }

    fn bounds(ring: &[Point]) -> [f64; 4] {
        let of = |f: fn(f64, f64) -> f64, at: fn(&Point) -> f64, from: f64| ring.iter().map(at).fold(from, f);
        [
            of(f64::min, |p| p.x, f64::INFINITY),
            of(f64::min, |p| p.y, f64::INFINITY),
            of(f64::max, |p| p.x, f64::NEG_INFINITY),
            of(f64::max, |p| p.y, f64::NEG_INFINITY),
        ]
    }

    #[test]
    fn corners_stay_sharp_inside_and_are_turned_round_outside() {
        let square = ring(&[[0.0, 0.0], [40.0, 0.0], [40.0, 20.0], [0.0, 20.0]]);
        let inner = moved_inwards(&square, 3.0);
        assert!((signed_area(&inner) - 34.0 * 14.0).abs() < 1e-6, "{inner:?}");
        let outer = moved_inwards(&square, -3.0);
        let wanted = 40.0 * 20.0 + 3.0 * 120.0 + 9.0 * std::f64::consts::PI;
        assert!((signed_area(&outer) - wanted).abs() < 0.01 * wanted, "{}", signed_area(&outer));
        assert_eq!(bounds(&outer).map(|v| libm::round(v * 1e6) / 1e6), [-3.0, -3.0, 43.0, 23.0]);
        // What is left of the corners are quarters of a circle.
        let round = signed_area(&opened(&square, 5.0));
        assert!((round - (800.0 - 25.0 * (4.0 - std::f64::consts::PI))).abs() < 1.5, "{round}");
    }

    #[test]
    fn a_bend_of_many_points_has_no_loops() {
        // A quarter of a circle of radius 5 at each corner, in steps of 3 degrees.
        let mut bent = Vec::new();
        for k in 0..4 {
            let middle = [[35.0, 25.0], [5.0, 25.0], [5.0, 5.0], [35.0, 5.0]][k];
            for step in 0..=30 {
                let angle = (90.0 * k as f64 + 3.0 * f64::from(step)) / 180.0 * std::f64::consts::PI;
                bent.push(Point::new(middle[0] + 5.0 * libm::cos(angle), middle[1] + 5.0 * libm::sin(angle)));
            }
        }
        for by in [1.0, 3.0, 8.0, -3.0] {
            let moved = moved_inwards(&bent, by);
            let radius = (5.0 - by).max(0.0);
            let wanted =
                (40.0 - 2.0 * by) * (30.0 - 2.0 * by) - radius * radius * (4.0 - std::f64::consts::PI);
            assert!((signed_area(&moved) - wanted).abs() < 0.01 * wanted, "{by}: {}", signed_area(&moved));
            let length: f64 = (0..moved.len()).map(|k| moved[k].distance(moved[(k + 1) % moved.len()])).sum();
            let wanted = 140.0 - 8.0 * by - radius * (8.0 - 2.0 * std::f64::consts::PI);
            assert!((length - wanted).abs() < 0.02 * wanted, "{by}: {length} of {wanted}");
        }
    }

    #[test]
    fn nothing_is_left_of_what_is_too_narrow() {
        let narrow = ring(&[[0.0, 0.0], [40.0, 0.0], [40.0, 5.0], [0.0, 5.0]]);
        assert!(moved_inwards(&narrow, 3.0).is_empty());
        // A finger is taken off, the rest stays.
        let finger = ring(&[
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 30.0],
            [22.0, 30.0],
            [22.0, 50.0],
            [18.0, 50.0],
            [18.0, 30.0],
            [0.0, 30.0],
        ]);
        let inner = moved_inwards(&finger, 3.0);
        assert!((signed_area(&inner) - 34.0 * 24.0).abs() < 3.0, "{}", signed_area(&inner));
        assert!(bounds(&inner)[3] < 29.0, "{inner:?}");
    }

    #[test]
    fn a_dent_is_turned_round() {
        let dent = ring(&[[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [30.0, 20.0], [0.0, 40.0]]);
        let inner = moved_inwards(&dent, 4.0);
        let nearest = inner.iter().map(|p| p.distance(Point::new(30.0, 20.0))).fold(f64::INFINITY, f64::min);
        assert!((nearest - 4.0).abs() < 0.05, "{nearest}");
        assert!(signed_area(&inner) > 0.5 * signed_area(&dent));
    }
}
