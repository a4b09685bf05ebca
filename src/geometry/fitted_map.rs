//! A planar map with smooth arcs: the outlines of all its faces, borders shared.
//!
//! Each arc is sampled at the middles of its cracks, fitted once, and used by both sides, so that
//! neighbours meet without a gap. A face whose outline would cross itself has its arcs fitted more
//! tightly, in the end as the polyline through the samples, which cannot cross itself.

use super::fit::{Piece, fit_closed, fit_open};
use super::simple::is_simple;
use super::trace::{HalfArc, OUTSIDE, PlanarMap, Ring};
use super::{Outline, STEP};
use crate::parallel;
use kurbo::{BezPath, Point, Vec2};
use std::collections::BTreeMap;

/// How far an earlier face reaches beneath a later one, in pixels.
const UNDERLAP: f64 = 0.6;

/// A planar map whose arcs are smooth curves.
pub struct FittedMap {
    map: PlanarMap,
    arcs: Vec<Curve>,
    /// Moved junctions and tangents, kept to fit variants of arcs.
    samples: Vec<Vec<Point>>,
    tolerance: f64,
}

/// A fitted arc.
#[derive(Clone, Debug)]
struct Curve {
    start: Point,
    pieces: Vec<Piece>,
}

/// Fits, from loose to exact.
const TIGHTNESS: [f64; 3] = [1.0, 0.4, 0.0];

impl FittedMap {
    /// Fits every arc of a planar map within `tolerance` pixels. `group` joins labels: where a
    /// border between groups meets a border within one, the former passes smoothly. Outlines of
    /// labels 1 to `count` and of groups 1 to `groups` are checked for crossings.
    pub fn new(
        map: PlanarMap,
        tolerance: f64,
        count: usize,
        groups: usize,
        group: impl Fn(u32) -> u32 + Sync,
    ) -> Self {
        let rank = |left: u32, right: u32| {
            if left == OUTSIDE || right == OUTSIDE { 2u8 } else { u8::from(group(left) != group(right)) }
        };
        let junctions = Junctions::new(&map, rank);
        let indices: Vec<usize> = (0..map.arcs.len()).collect();
        let samples: Vec<Vec<Point>> = parallel::map(&indices, |&i| sample(&map, i, &junctions));
        let fit = |i: usize, level: usize| {
            let arc = &map.arcs[i];
            let ends = if arc.closed { [None, None] } else { junctions.tangents(&map, i) };
            fit_arc(&samples[i], arc.closed, ends, tolerance * TIGHTNESS[level])
        };
        let mut arcs = parallel::map(&indices, |&i| fit(i, 0));
        let mut level = vec![0usize; arcs.len()];
        // Tighten what crosses itself until nothing does; levels only rise, so this ends.
        let mut faces: Vec<Vec<Ring>> = map.rings(count, |l| l);
        faces.extend(map.rings(groups, &group));
        let mut suspects: Vec<usize> = (0..faces.len()).filter(|&f| !faces[f].is_empty()).collect();
        while !suspects.is_empty() {
            let crossing: Vec<bool> = parallel::map(&suspects, |&f| {
                !is_simple(&path_of(&faces[f], |h| (&arcs[h.arc as usize], h.reversed)))
            });
            let mut tighten: Vec<usize> = Vec::new();
            for (&f, _) in suspects.iter().zip(&crossing).filter(|(_, c)| **c) {
                tighten.extend(faces[f].iter().flatten().map(|h| h.arc as usize));
            }
            tighten.sort_unstable();
            tighten.dedup();
            tighten.retain(|&i| level[i] + 1 < TIGHTNESS.len());
            let refitted = parallel::map(&tighten, |&i| fit(i, level[i] + 1));
            let mut changed = vec![false; arcs.len()];
            for (&i, curve) in tighten.iter().zip(refitted) {
                (arcs[i], changed[i]) = (curve, true);
                level[i] += 1;
            }
            suspects = (0..faces.len())
                .filter(|&f| faces[f].iter().flatten().any(|h| changed[h.arc as usize]))
                .collect();
        }
        Self { map, arcs, samples, tolerance }
    }

    /// The outlines of keys 0 to `count` (0 is empty), where `key` joins labels.
    pub fn outlines(&self, count: usize, key: impl Fn(u32) -> u32) -> Vec<Outline> {
        let rings = self.map.rings(count, key);
        parallel::map(&rings, |face| outline(path_of(face, |h| (&self.arcs[h.arc as usize], h.reversed))))
    }

    /// The outlines of labels 0 to `count` (0 is empty) for painting one after the other:
    /// wherever `beneath(own, other)` holds for a neighbour, which must be painted later, the
    /// outline reaches a little beneath it, so that no background shows through the joint.
    pub fn stacked_outlines(&self, count: usize, beneath: impl Fn(u32, u32) -> bool + Sync) -> Vec<Outline> {
        let rings = self.map.rings(count, |l| l);
        let labels: Vec<usize> = (0..rings.len()).collect();
        parallel::map(&labels, |&label| {
            let face = &rings[label];
            let mut widened: BTreeMap<u32, Curve> = BTreeMap::new();
            for h in face.iter().flatten() {
                let arc = &self.map.arcs[h.arc as usize];
                let other = if h.reversed { arc.right } else { arc.left };
                if other != OUTSIDE && other != 0 && beneath(label as u32, other) {
                    let side = if h.reversed { 1.0 } else { -1.0 };
                    let points = offset(&self.samples[h.arc as usize], arc.closed, side * UNDERLAP);
                    widened
                        .insert(h.arc, fit_arc(&points, arc.closed, [None, None], self.tolerance.max(0.3)));
                }
            }
            let exact = |h: &HalfArc| (&self.arcs[h.arc as usize], h.reversed);
            if widened.is_empty() {
                return outline(path_of(face, exact));
            }
            let path =
                path_of(face, |h| (widened.get(&h.arc).unwrap_or(&self.arcs[h.arc as usize]), h.reversed));
            // Reaching beneath a thin neighbour may cross the far side: then the joint stays bare.
            if is_simple(&path) { outline(path) } else { outline(path_of(face, exact)) }
        })
    }
}

fn outline(path: BezPath) -> Outline {
    Outline::new(&path).unwrap_or_default()
}

/// The closed path of a face.
fn path_of<'a>(face: &[Ring], curve: impl Fn(&HalfArc) -> (&'a Curve, bool)) -> BezPath {
    let mut path = BezPath::new();
    for ring in face {
        for (i, h) in ring.iter().enumerate() {
            let (c, reversed) = curve(h);
            if i == 0 {
                path.move_to(if reversed { c.pieces.last().map_or(c.start, Piece::end) } else { c.start });
            }
            if reversed { append_reversed(&mut path, c) } else { append(&mut path, c) }
        }
        path.close_path();
    }
    path
}

fn append(path: &mut BezPath, c: &Curve) {
    for piece in &c.pieces {
        match *piece {
            Piece::Line(p) => path.line_to(p),
            Piece::Cubic(a, b, p) => path.curve_to(a, b, p),
        }
    }
}

fn append_reversed(path: &mut BezPath, c: &Curve) {
    for (i, piece) in c.pieces.iter().enumerate().rev() {
        let to = if i == 0 { c.start } else { c.pieces[i - 1].end() };
        match *piece {
            Piece::Line(_) => path.line_to(to),
            Piece::Cubic(a, b, _) => path.curve_to(b, a, to),
        }
    }
}

fn fit_arc(points: &[Point], closed: bool, ends: [Option<Vec2>; 2], tolerance: f64) -> Curve {
    // Onto the grid of outlines first, so that both sides round alike.
    let grid = |p: Point| Point::new(libm::round(p.x / STEP) * STEP, libm::round(p.y / STEP) * STEP);
    let (start, pieces) = if tolerance <= 0.0 {
        let rest = points[1..].iter().copied().chain(closed.then_some(points[0]));
        (points[0], rest.map(Piece::Line).collect())
    } else if closed {
        fit_closed(points, tolerance)
    } else {
        (points[0], fit_open(points, ends[0], ends[1], tolerance))
    };
    let pieces = pieces.into_iter().map(|piece| match piece {
        Piece::Line(p) => Piece::Line(grid(p)),
        Piece::Cubic(a, b, p) => Piece::Cubic(grid(a), grid(b), grid(p)),
    });
    Curve { start: grid(start), pieces: pieces.collect() }
}

/// Middles of the cracks, between the junctions at the ends.
fn sample(map: &PlanarMap, i: usize, junctions: &Junctions) -> Vec<Point> {
    let arc = &map.arcs[i];
    let lattice = map.points_of(arc);
    let middle =
        |w: &[[i32; 2]]| Point::new(f64::from(w[0][0] + w[1][0]) / 2.0, f64::from(w[0][1] + w[1][1]) / 2.0);
    let middles = lattice.windows(2).map(middle);
    if arc.closed {
        let points: Vec<Point> = middles.collect();
        return keep_area(points, lattice);
    }
    let (first, last) = (lattice[0], lattice[lattice.len() - 1]);
    let mut points = vec![junctions.position(first)];
    points.extend(middles);
    points.push(junctions.position(last));
    points
}

/// Small closed curves lose area when their pixel corners are cut: scale about the centre until
/// the polygon has the area of the pixels again.
fn keep_area(mut points: Vec<Point>, lattice: &[[i32; 2]]) -> Vec<Point> {
    let n = points.len();
    let polygon = |p: &dyn Fn(usize) -> (f64, f64), n: usize| -> f64 {
        (0..n)
            .map(|i| {
                let (a, b) = (p(i), p((i + 1) % n));
                a.0 * b.1 - b.0 * a.1
            })
            .sum::<f64>()
            / 2.0
    };
    let pixels = polygon(&|i| (f64::from(lattice[i][0]), f64::from(lattice[i][1])), lattice.len() - 1);
    let cut = polygon(&|i| (points[i].x, points[i].y), n);
    // A smooth curve through the middles bulges beyond their polygon by about half of what it cut.
    let target = (pixels.abs() + cut.abs()) / 2.0;
    if n >= 40 || cut.abs() < 1e-6 {
        return points;
    }
    let centre = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2()) / n as f64;
    let scale = libm::sqrt(target / cut.abs()).min(1.25);
    for p in &mut points {
        *p = (centre + (p.to_vec2() - centre) * scale).to_point();
    }
    points
}

/// The samples moved sideways (to the right for positive `distance`), the ends kept.
fn offset(points: &[Point], closed: bool, distance: f64) -> Vec<Point> {
    let n = points.len();
    let mut moved = points.to_vec();
    let range = if closed { 0..n } else { 1..n - 1 };
    for i in range {
        let (a, b) = if closed {
            (points[(i + n - 1) % n], points[(i + 1) % n])
        } else {
            (points[i - 1], points[i + 1])
        };
        let along = b - a;
        let length = libm::sqrt(along.hypot2());
        if length > 1e-9 {
            // y points down, so turning right is (x, y) → (-y, x).
            moved[i] += Vec2::new(-along.y, along.x) / length * distance;
        }
    }
    moved
}

/// Where arcs meet.
struct Junctions {
    /// Half arcs that leave each junction, with their rank.
    leaving: BTreeMap<[i32; 2], Vec<(HalfArc, u8)>>,
    positions: BTreeMap<[i32; 2], Point>,
}

impl Junctions {
    fn new(map: &PlanarMap, rank: impl Fn(u32, u32) -> u8) -> Self {
        let mut leaving: BTreeMap<[i32; 2], Vec<(HalfArc, u8)>> = BTreeMap::new();
        for (i, arc) in map.arcs.iter().enumerate().filter(|(_, a)| !a.closed) {
            let p = map.points_of(arc);
            let r = rank(arc.left, arc.right);
            for (point, reversed) in [(p[0], false), (p[p.len() - 1], true)] {
                leaving.entry(point).or_default().push((HalfArc { arc: i as u32, reversed }, r));
            }
        }
        let mut junctions = Self { leaving, positions: BTreeMap::new() };
        let at: Vec<[i32; 2]> = junctions.leaving.keys().copied().collect();
        for point in at {
            let vertex = Point::new(f64::from(point[0]), f64::from(point[1]));
            let arms = match junctions.through(point) {
                Some(pair) => pair.to_vec(),
                None => junctions.leaving[&point].iter().map(|a| a.0).collect(),
            };
            // Within the hull of the nearest crack middles, so that polylines cannot cross.
            let mean =
                arms.iter().fold(Vec2::ZERO, |s, h| s + ahead(map, *h, 1).to_vec2()) / arms.len() as f64;
            junctions.positions.insert(point, vertex.midpoint(mean.to_point()));
        }
        junctions
    }

    fn position(&self, point: [i32; 2]) -> Point {
        self.positions[&point]
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
    fn tangents(&self, map: &PlanarMap, i: usize) -> [Option<Vec2>; 2] {
        let p = map.points_of(&map.arcs[i]);
        let ends = [(p[0], false), (p[p.len() - 1], true)];
        ends.map(|(point, reversed)| {
            let [a, b] = self.through(point)?;
            let own = HalfArc { arc: i as u32, reversed };
            let other = if own == a {
                b
            } else if own == b {
                a
            } else {
                return None;
            };
            let (out, back) = (ahead(map, own, 4), ahead(map, other, 4));
            let here = self.position(point);
            let (u, v) = (out - here, here - back);
            let lengths = libm::sqrt(u.hypot2() * v.hypot2());
            if lengths < 1e-9 || u.dot(v) / lengths < 0.57 {
                return None; // a corner stays a corner
            }
            let along = out - back;
            let t = along / libm::sqrt(along.hypot2());
            Some(if reversed { -t } else { t })
        })
    }
}

/// A point `steps` half-steps along an arc from its junction.
fn ahead(map: &PlanarMap, h: HalfArc, steps: usize) -> Point {
    let p = map.points_of(&map.arcs[h.arc as usize]);
    let n = p.len();
    let at = |k: usize| {
        let q = if h.reversed { p[n - 1 - k] } else { p[k] };
        Point::new(f64::from(q[0]), f64::from(q[1]))
    };
    let k = (steps / 2).min(n - 2);
    at(k).midpoint(at(k + 1))
}
