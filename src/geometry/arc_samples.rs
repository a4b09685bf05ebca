//! Arcs as points: the middles of their cracks, relaxed so that pixel stairs vanish.
//!
//! Points move by Taubin's two-step filter, which does not shrink; corners stay where they are;
//! where two arcs pass through a junction, the junction moves with them. No point moves further
//! than half a pixel, and junctions stay within the hull of the crack middles around them.

use super::trace::{HalfArc, PlanarMap};
use kurbo::{Point, Vec2};
use std::collections::BTreeMap;

/// Rounds of the filter.
const ROUNDS: usize = 6;
/// Steps of the filter (Taubin 1995): shrink, then grow a little more.
const STEPS: [f64; 2] = [0.5, -0.52];
/// Furthest way of a point from its crack middle, in pixels.
const REACH: f64 = 0.5;

/// Points of every arc before and after relaxing. Open arcs begin and end at their junctions.
pub(super) fn sample_all(map: &PlanarMap, junctions: &Junctions) -> (Vec<Vec<Point>>, Vec<Vec<Point>>) {
    let rough: Vec<Vec<Point>> = map.arcs.iter().map(|arc| middles(map, arc, junctions)).collect();
    let fixed: Vec<Vec<bool>> = rough.iter().zip(&map.arcs).map(|(p, a)| corners(p, a.closed)).collect();
    let mut smooth = rough.clone();
    for round in 0..2 * ROUNDS {
        relax(map, &mut smooth, &rough, &fixed, junctions, STEPS[round % 2]);
    }
    for ((points, rough), arc) in smooth.iter_mut().zip(&rough).zip(&map.arcs) {
        if arc.closed {
            keep_area(points, map.points_of(arc));
        }
        debug_assert_eq!(points.len(), rough.len());
    }
    (rough, smooth)
}

fn middles(map: &PlanarMap, arc: &super::trace::Arc, junctions: &Junctions) -> Vec<Point> {
    let lattice = map.points_of(arc);
    let middle =
        |w: &[[i32; 2]]| Point::new(f64::from(w[0][0] + w[1][0]) / 2.0, f64::from(w[0][1] + w[1][1]) / 2.0);
    let mut points = Vec::with_capacity(lattice.len() + 1);
    if !arc.closed {
        points.push(junctions.position(lattice[0]));
    }
    points.extend(lattice.windows(2).map(middle));
    if !arc.closed {
        points.push(junctions.position(lattice[lattice.len() - 1]));
    }
    points
}

/// Points where the curve turns by more than about 50° over five points each way: a corner of the
/// thing, not of a pixel.
fn corners(points: &[Point], closed: bool) -> Vec<bool> {
    const SPAN: isize = 5;
    const COSINE: f64 = 0.64;
    let n = points.len() as isize;
    let mut found = vec![false; points.len()];
    if n < 3 * SPAN {
        return found;
    }
    let at = |i: isize| points[i.rem_euclid(n) as usize];
    let cosine = |i: isize| -> f64 {
        if !closed && (i < SPAN || i + SPAN >= n) {
            return 1.0;
        }
        let (a, b) = (at(i) - at(i - SPAN), at(i + SPAN) - at(i));
        a.dot(b) / libm::sqrt(a.hypot2() * b.hypot2()).max(1e-9)
    };
    let cosines: Vec<f64> = (0..n).map(cosine).collect();
    let get = |i: isize| if closed || (0..n).contains(&i) { cosines[i.rem_euclid(n) as usize] } else { 1.0 };
    for i in 0..n {
        let sharpest = (1..=SPAN).all(|k| get(i) < get(i - k) && get(i) <= get(i + k));
        found[i as usize] = get(i) < COSINE && sharpest;
    }
    found
}

/// One step of the filter over all arcs and junctions at once.
fn relax(
    map: &PlanarMap,
    points: &mut [Vec<Point>],
    rough: &[Vec<Point>],
    fixed: &[Vec<bool>],
    junctions: &Junctions,
    step: f64,
) {
    let moved = |p: Point, a: Point, b: Point| p + (a.midpoint(b) - p) * step;
    // Junctions first, from the points around them as they are.
    let ends: BTreeMap<[i32; 2], Point> = junctions
        .leaving
        .keys()
        .map(|&at| {
            let here = junction_point(map, points, junctions, at);
            let Some(pair) = junctions.through(at) else { return (at, here) };
            let [a, b] = pair.map(|h| second(points, h));
            let target = moved(here, a, b).to_vec2() - lattice(at).to_vec2();
            // Within the diamond of the four crack middles.
            let size = target.x.abs() + target.y.abs();
            let inside = if size > 0.49 { target * (0.49 / size) } else { target };
            (at, lattice(at) + inside)
        })
        .collect();
    for (i, arc) in map.arcs.iter().enumerate() {
        let (old, n) = (points[i].clone(), points[i].len());
        let p = &mut points[i];
        let range = if arc.closed { 0..n } else { 1..n - 1 };
        for k in range {
            if !fixed[i][k] {
                let (a, b) = (old[(k + n - 1) % n], old[(k + 1) % n]);
                let away = moved(old[k], a, b) - rough[i][k];
                let length = libm::sqrt(away.hypot2());
                p[k] = rough[i][k] + if length > REACH { away * (REACH / length) } else { away };
            }
        }
        if !arc.closed {
            let lattice = map.points_of(arc);
            (p[0], p[n - 1]) = (ends[&lattice[0]], ends[&lattice[lattice.len() - 1]]);
        }
    }
}

fn lattice(at: [i32; 2]) -> Point {
    Point::new(f64::from(at[0]), f64::from(at[1]))
}

fn junction_point(map: &PlanarMap, points: &[Vec<Point>], junctions: &Junctions, at: [i32; 2]) -> Point {
    match junctions.leaving[&at].first() {
        Some(&(h, _)) => {
            let p = &points[h.arc as usize];
            debug_assert!(!map.arcs[h.arc as usize].closed);
            if h.reversed { p[p.len() - 1] } else { p[0] }
        }
        None => lattice(at),
    }
}

/// The point next to the junction that a half arc leaves.
fn second(points: &[Vec<Point>], h: HalfArc) -> Point {
    ahead(points, h, 1)
}

/// The point `steps` points along a half arc, or its last.
fn ahead(points: &[Vec<Point>], h: HalfArc, steps: usize) -> Point {
    let p = &points[h.arc as usize];
    let k = steps.min(p.len() - 1);
    p[if h.reversed { p.len() - 1 - k } else { k }]
}

/// Small closed curves lose area when their pixel corners are cut: scales about the centre until
/// the polygon has nearly the area of the pixels again.
fn keep_area(points: &mut [Point], lattice: &[[i32; 2]]) {
    const SMALL: usize = 40;
    let n = points.len();
    if n >= SMALL {
        return;
    }
    let polygon = |count: usize, at: &dyn Fn(usize) -> (f64, f64)| -> f64 {
        let cross = |i: usize| {
            let (a, b) = (at(i), at((i + 1) % count));
            a.0 * b.1 - b.0 * a.1
        };
        (0..count).map(cross).sum::<f64>().abs() / 2.0
    };
    let pixels = polygon(lattice.len() - 1, &|i| (f64::from(lattice[i][0]), f64::from(lattice[i][1])));
    let cut = polygon(n, &|i| (points[i].x, points[i].y));
    if cut < 1e-6 {
        return;
    }
    // A smooth curve bulges beyond the polygon through its points by about half of what it cut.
    let scale = libm::sqrt((pixels + cut) / 2.0 / cut).min(1.25);
    let centre = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2()) / n as f64;
    for p in points {
        *p = (centre + (p.to_vec2() - centre) * scale).to_point();
    }
}

/// Where arcs meet.
pub(super) struct Junctions {
    /// Half arcs that leave each junction, with their rank.
    leaving: BTreeMap<[i32; 2], Vec<(HalfArc, u8)>>,
}

impl Junctions {
    /// Gathers the junctions of a map; `rank(left, right)` says which borders pass through.
    pub(super) fn new(map: &PlanarMap, rank: impl Fn(u32, u32) -> u8) -> Self {
        let mut leaving: BTreeMap<[i32; 2], Vec<(HalfArc, u8)>> = BTreeMap::new();
        for (i, arc) in map.arcs.iter().enumerate().filter(|(_, a)| !a.closed) {
            let p = map.points_of(arc);
            let r = rank(arc.left, arc.right);
            for (point, reversed) in [(p[0], false), (p[p.len() - 1], true)] {
                leaving.entry(point).or_default().push((HalfArc { arc: i as u32, reversed }, r));
            }
        }
        Self { leaving }
    }

    /// Where a junction begins: on its lattice point.
    fn position(&self, point: [i32; 2]) -> Point {
        lattice(point)
    }

    /// The two arcs that pass through a junction, if two outrank all others.
    fn through(&self, point: [i32; 2]) -> Option<[HalfArc; 2]> {
        let arms = &self.leaving[&point];
        let top = arms.iter().map(|a| a.1).max()?;
        let mut best = arms.iter().filter(|a| a.1 == top).map(|a| a.0);
        let pair = [best.next()?, best.next()?];
        (best.next().is_none() && arms.len() > 2).then_some(pair)
    }

    /// Unit tangents at both ends of an arc, along the arc, where it passes a junction smoothly.
    pub(super) fn tangents(&self, map: &PlanarMap, points: &[Vec<Point>], i: usize) -> [Option<Vec2>; 2] {
        let p = map.points_of(&map.arcs[i]);
        [(p[0], false), (p[p.len() - 1], true)].map(|(point, reversed)| {
            let [a, b] = self.through(point)?;
            let own = HalfArc { arc: i as u32, reversed };
            let other = if own == a {
                b
            } else if own == b {
                a
            } else {
                return None;
            };
            let here = ahead(points, own, 0);
            let (out, back) = (ahead(points, own, 3), ahead(points, other, 3));
            let (u, v) = (out - here, here - back);
            let lengths = libm::sqrt(u.hypot2() * v.hypot2());
            if lengths < 1e-9 || u.dot(v) / lengths < 0.57 {
                return None; // a corner stays a corner
            }
            let along = out - back;
            let t = along / libm::sqrt(along.hypot2()).max(1e-9);
            Some(if reversed { -t } else { t })
        })
    }
}
