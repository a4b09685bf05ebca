//! A planar map with smooth arcs: the outlines of all its faces, borders shared.
//!
//! Each arc is sampled at the middles of its cracks, fitted once, and used by both sides, so that
//! neighbours meet without a gap. A face whose outline would cross itself has its arcs fitted more
//! tightly, in the end as the polyline through the samples, which cannot cross itself.

use super::arc_samples::{Junctions, sample_all};
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
    /// Kept to fit variants of arcs.
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
        let (rough, samples) = sample_all(&map, &junctions);
        let indices: Vec<usize> = (0..map.arcs.len()).collect();
        let fit = |i: usize, level: usize| {
            let arc = &map.arcs[i];
            if level + 1 == TIGHTNESS.len() {
                return polyline(&rough[i], arc.closed);
            }
            let ends = if arc.closed { [None, None] } else { junctions.tangents(&map, &samples, i) };
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

/// A point on the grid of outlines, so that both sides of an arc round alike.
fn grid(p: Point) -> Point {
    Point::new(libm::round(p.x / STEP) * STEP, libm::round(p.y / STEP) * STEP)
}

fn fit_arc(points: &[Point], closed: bool, ends: [Option<Vec2>; 2], tolerance: f64) -> Curve {
    let (start, pieces) = if closed {
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

fn polyline(points: &[Point], closed: bool) -> Curve {
    let rest = points[1..].iter().chain(closed.then_some(&points[0]));
    Curve { start: grid(points[0]), pieces: rest.map(|&p| Piece::Line(grid(p))).collect() }
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
