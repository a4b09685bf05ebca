//! Arcs as sampled points: midpoints of pixel edges, smoothed to remove pixel stairs, then refined to
//! the image's sub-pixel edges.
//!
//! Smoothing is Taubin's two-step filter, which does not shrink. Corners of outlines stay in place. Corners
//! between details are pixel artefacts and are rounded. A junction moves with the two arcs that pass through
//! it smoothly, if there are any. No point moves farther than half a pixel, and junctions stay within the
//! hull of the midpoints around them.

use super::trace::{Arc, HalfArc, OUTSIDE, PlanarMap};
use crate::parallel::{self, for_parts};
use kurbo::{Point, Vec2};
use std::ops::Range;

/// Rounds of the filter, per cell along a pixel.
const ROUNDS: usize = 6;
/// Factors of the filter's two steps (Taubin 1995): shrink, then grow slightly more.
const STEPS: [f64; 2] = [0.5, -0.52];
/// Largest distance of a smoothed point from its midpoint, in pixels of the image.
const REACH: f64 = 0.5;
/// Largest distance from a smoothed point to the image's edge, in pixels of the image.
const FURTHEST: f64 = 0.6;
/// Rounds that average these distances between neighbours.
const EVEN: usize = 4;

/// The points of every arc of a map, in two versions. In both, open arcs begin and end at their junctions'
/// smoothed positions.
pub(super) struct ArcSamples {
    /// The points of each arc, in both versions.
    arcs: Vec<Range<usize>>,
    smoothed: Vec<Point>,
    refined: Vec<Point>,
}

/// The points of every arc in one version.
#[derive(Clone, Copy)]
pub(super) struct Points<'a> {
    arcs: &'a [Range<usize>],
    all: &'a [Point],
}

impl<'a> Points<'a> {
    /// The points of arc `i`.
    pub(super) fn of(self, i: usize) -> &'a [Point] {
        &self.all[self.arcs[i].clone()]
    }

    /// The point `steps` points along a half arc, or its last point.
    fn ahead(self, h: HalfArc, steps: usize) -> Point {
        let p = self.of(h.arc as usize);
        let k = steps.min(p.len() - 1);
        p[if h.reversed { p.len() - 1 - k } else { k }]
    }
}

impl ArcSamples {
    /// Samples the arcs of a map with `cells` cells along a pixel of the image. Corners of arcs for which
    /// `soft` holds are rounded like the rest. `edge(point, normal, left, right)` gives the distance from
    /// a point to the image's edge along `normal`, a unit vector from left to right.
    pub(super) fn new(
        map: &PlanarMap,
        junctions: &Junctions,
        cells: f64,
        soft: impl Fn(&Arc) -> bool + Sync,
        edge: impl Fn(Point, Vec2, u32, u32) -> f64 + Sync,
    ) -> Self {
        let mut end = 0;
        let range = |arc: &Arc| {
            let start = end;
            end += middles_count(arc);
            start..end
        };
        let arcs: Vec<Range<usize>> = map.arcs.iter().map(range).collect();
        let lengths = || arcs.iter().map(|points| points.len());
        let mut midpoints = vec![Point::ZERO; end];
        for_parts(&mut midpoints, lengths(), |i, points| middles(map, &map.arcs[i], points));
        let mut fixed = vec![false; end];
        for_parts(&mut fixed, lengths(), |i, fixed| {
            if !soft(&map.arcs[i]) {
                corners(&midpoints[arcs[i].clone()], map.arcs[i].closed(), cells, fixed);
            }
        });
        let filter = ArcFilter::new(map, &midpoints, fixed, &arcs, junctions);
        let relaxed = |mut points: Vec<Point>, reach: f64| {
            filter.relax(&mut points, reach, 2 * ROUNDS * cells as usize);
            let inner = |arc: &Arc| arc.closed() && !borders_outside(arc);
            for (arc, range) in map.arcs.iter().zip(&arcs).filter(|(arc, _)| inner(arc)) {
                keep_area(&mut points[range.clone()], map.points_of(arc));
            }
            points
        };
        let (mut refined, mut smoothed) = if cells > 1.0 {
            let copy = midpoints.clone();
            parallel::join(|| relaxed(midpoints, REACH * cells), || relaxed(copy, REACH))
        } else {
            let both = relaxed(midpoints, REACH);
            (both.clone(), both)
        };
        drop(filter);
        // Both versions of an arc end where its junction has refined to, so that arcs stay joined.
        for (range, arc) in arcs.iter().zip(&map.arcs) {
            end_alike(&mut smoothed[range.clone()], &refined[range.clone()], arc);
        }
        for_parts(&mut refined, lengths(), |i, points| {
            let arc = &map.arcs[i];
            if !borders_outside(arc) {
                to_edge(points, arc.closed(), cells, |at, normal| edge(at, normal, arc.left, arc.right));
            }
        });
        Self { arcs, smoothed, refined }
    }

    /// Smoothed within one cell, so arcs hardly ever cross.
    pub(super) fn smoothed(&self) -> Points<'_> {
        Points { arcs: &self.arcs, all: &self.smoothed }
    }

    /// Smoothed within one pixel, then refined to the edges of the image.
    pub(super) fn refined(&self) -> Points<'_> {
        Points { arcs: &self.arcs, all: &self.refined }
    }

    /// The midpoints of the pixel edges of arc `i`, with the ends of the other versions.
    pub(super) fn midpoints(&self, map: &PlanarMap, i: usize) -> Vec<Point> {
        let mut points = vec![Point::ZERO; self.arcs[i].len()];
        middles(map, &map.arcs[i], &mut points);
        end_alike(&mut points, self.smoothed().of(i), &map.arcs[i]);
        points
    }
}

/// Gives an open arc the ends of another version of it.
fn end_alike(points: &mut [Point], other: &[Point], arc: &Arc) {
    if !arc.closed() {
        let last = points.len() - 1;
        (points[0], points[last]) = (other[0], other[last]);
    }
}

/// Unit normals of a curve at its points, to the right. At the end of an open curve, the direction is
/// that of its last segment.
fn normals(points: &[Point], closed: bool) -> Vec<Vec2> {
    let normal = |i: usize| {
        let [last, next] = beside(points.len(), closed, i);
        let along = points[next] - points[last];
        // y points down, so turning right is (x, y) → (-y, x).
        Vec2::new(-along.y, along.x) / libm::sqrt(along.hypot2()).max(1e-9)
    };
    (0..points.len()).map(normal).collect()
}

/// Indices of the points before and after point `i` of `n`; `i` itself beyond the end of an open curve.
fn beside(n: usize, closed: bool, i: usize) -> [usize; 2] {
    if closed { [(i + n - 1) % n, (i + 1) % n] } else { [i.saturating_sub(1), (i + 1).min(n - 1)] }
}

/// Moves points along their normals by `distance`, averaged between neighbours. The ends of an open
/// arc stay.
fn to_edge(points: &mut [Point], closed: bool, cells: f64, distance: impl Fn(Point, Vec2) -> f64) {
    let n = points.len();
    let normals = normals(points, closed);
    let moves = |i: usize| closed || (i > 0 && i + 1 < n);
    let furthest = FURTHEST * cells;
    let mut away: Vec<f64> = (0..n)
        .map(|i| if moves(i) { distance(points[i], normals[i]).clamp(-furthest, furthest) } else { 0.0 })
        .collect();
    for _ in 0..EVEN {
        let before = away.clone();
        for i in (0..n).filter(|&i| moves(i)) {
            let [last, next] = beside(n, closed, i);
            away[i] = (before[last] + 2.0 * before[i] + before[next]) / 4.0;
        }
    }
    points
        .iter_mut()
        .zip(normals.iter().zip(away))
        .for_each(|(point, (&normal, away))| *point += normal * away);
}

/// Number of midpoints of an arc's pixel edges, with its ends if it is open.
fn middles_count(arc: &Arc) -> usize {
    if arc.closed() { arc.points.len() - 1 } else { arc.points.len() + 1 }
}

/// The midpoints of an arc's pixel edges, with its ends if it is open.
fn middles(map: &PlanarMap, arc: &Arc, points: &mut [Point]) {
    let steps = map.points_of(arc);
    let mut all = points.iter_mut();
    if let (false, [first, .., last]) = (arc.closed(), steps) {
        all.next().into_iter().for_each(|point| *point = lattice(*first));
        all.next_back().into_iter().for_each(|point| *point = lattice(*last));
    }
    all.zip(steps.windows(2)).for_each(|(point, w)| *point = lattice(w[0]).midpoint(lattice(w[1])));
}

/// Marks points where the curve turns by more than about 50° over five pixels of the image to each
/// side. Such corners belong to the object, not to a pixel.
fn corners(points: &[Point], closed: bool, cells: f64, found: &mut [bool]) {
    let span = (5.0 * cells) as isize;
    const COSINE: f64 = 0.64;
    let n = points.len() as isize;
    if n < 3 * span {
        return;
    }
    let at = |i: isize| points[i.rem_euclid(n) as usize];
    let cosine = |i: isize| -> f64 {
        if !closed && (i < span || i + span >= n) {
            return 1.0;
        }
        let (a, b) = (at(i) - at(i - span), at(i + span) - at(i));
        a.dot(b) / libm::sqrt(a.hypot2() * b.hypot2()).max(1e-9)
    };
    let cosines: Vec<f64> = (0..n).map(cosine).collect();
    let get = |i: isize| if closed || (0..n).contains(&i) { cosines[i.rem_euclid(n) as usize] } else { 1.0 };
    for i in 0..n {
        let sharpest = (1..=span).all(|k| get(i) < get(i - k) && get(i) <= get(i + k));
        found[i as usize] = get(i) < COSINE && sharpest;
    }
}

/// The filter over all arcs and junctions, whose points lie one after the other.
struct ArcFilter {
    /// Multiples of one half, which single precision holds exactly.
    midpoints: Vec<[f32; 2]>,
    /// Points that stay.
    fixed: Vec<bool>,
    arcs: Vec<Strand>,
    joints: Vec<Joint>,
}

/// The points of an arc.
struct Strand {
    points: Range<usize>,
    /// The joints at its ends; `None` for a closed curve.
    ends: Option<[u32; 2]>,
}

/// A junction, as points beside it.
struct Joint {
    /// Its lattice point.
    at: Point,
    /// Any of the points that are this junction's.
    own: usize,
    /// The points whose mean attracts it; empty if it is fixed.
    around: Vec<usize>,
}

impl ArcFilter {
    fn new(
        map: &PlanarMap,
        midpoints: &[Point],
        fixed: Vec<bool>,
        arcs: &[Range<usize>],
        junctions: &Junctions,
    ) -> Self {
        let strand = |(points, arc): (&Range<usize>, &Arc)| Strand { points: points.clone(), ends: arc.ends };
        let arcs: Vec<Strand> = arcs.iter().zip(&map.arcs).map(strand).collect();
        // The point `steps` points along a half arc, or its last point.
        let ahead = |h: &HalfArc, steps: usize| {
            let Range { start, end } = arcs[h.arc as usize].points;
            let k = steps.min(end - start - 1);
            if h.reversed { end - 1 - k } else { start + k }
        };
        let joint = |junction: &Junction| {
            let at_border = |h: &HalfArc| borders_outside(&map.arcs[h.arc as usize]);
            let stays = junction.arms.iter().any(at_border);
            let arms = junction.through.as_ref().map_or(&junction.arms[..], |pair| &pair[..]);
            let around = arms.iter().filter(|_| !stays).map(|h| ahead(h, 1)).collect();
            Joint { at: junction.at, own: ahead(&junction.arms[0], 0), around }
        };
        let joints = junctions.list.iter().map(joint).collect();
        let midpoints = midpoints.iter().map(|p| [p.x as f32, p.y as f32]).collect();
        Self { midpoints, fixed, arcs, joints }
    }

    /// Moves midpoints by some steps, none further than `reach`.
    fn relax(&self, points: &mut [Point], reach: f64, rounds: usize) {
        let mut ends = Vec::with_capacity(self.joints.len());
        for round in 0..rounds {
            self.step(points, &mut ends, reach, STEPS[round % 2]);
        }
    }

    /// One step. `ends` is room for the junctions' places.
    fn step(&self, points: &mut [Point], ends: &mut Vec<Point>, reach: f64, step: f64) {
        // Junctions first, computed from the unmodified points around them.
        ends.clear();
        ends.extend(self.joints.iter().map(|joint| {
            if joint.around.is_empty() {
                return joint.at;
            }
            let here = points[joint.own];
            let sum = joint.around.iter().fold(Vec2::ZERO, |sum, &k| sum + points[k].to_vec2());
            let mean = (sum / joint.around.len() as f64).to_point();
            let away = here + (mean - here) * step - joint.at;
            // Stays within the diamond of the four surrounding midpoints.
            let size = away.x.abs() + away.y.abs();
            joint.at + if size > 0.49 { away * (0.49 / size) } else { away }
        }));
        // Most points are so near that no root is needed.
        let near = reach * reach * (1.0 - 1e-9);
        for arc in &self.arcs {
            let p = &mut points[arc.points.clone()];
            let (midpoints, fixed) = (&self.midpoints[arc.points.clone()], &self.fixed[arc.points.clone()]);
            let n = p.len();
            let first = p[0];
            // The previous point before its modification.
            let closed = arc.ends.is_none();
            let mut before = if closed { p[n - 1] } else { p[0] };
            let range = if closed { 0..n } else { 1..n - 1 };
            for k in range {
                let here = p[k];
                let after = if k + 1 < n { p[k + 1] } else { first };
                if !fixed[k] {
                    let [x, y] = midpoints[k].map(f64::from);
                    let midpoint = Point::new(x, y);
                    let away = here + (before.midpoint(after) - here) * step - midpoint;
                    let squared = away.hypot2();
                    let length = if squared > near { libm::sqrt(squared) } else { 0.0 };
                    p[k] = midpoint + if length > reach { away * (reach / length) } else { away };
                }
                before = here;
            }
            if let Some([a, b]) = arc.ends {
                (p[0], p[n - 1]) = (ends[a as usize], ends[b as usize]);
            }
        }
    }
}

fn borders_outside(arc: &Arc) -> bool {
    arc.left == OUTSIDE || arc.right == OUTSIDE
}

fn lattice(at: [i32; 2]) -> Point {
    Point::new(f64::from(at[0]), f64::from(at[1]))
}

/// Scales a small closed curve about its centre to compensate for the area lost when pixel corners
/// are cut.
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
    // A smooth curve through the points encloses about half of the area that the polygon loses.
    let scale = libm::sqrt((pixels + cut) / 2.0 / cut).min(1.25);
    let centre = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2()) / n as f64;
    for p in points {
        *p = (centre + (p.to_vec2() - centre) * scale).to_point();
    }
}

/// A lattice point where arcs meet.
struct Junction {
    /// Its lattice point.
    at: Point,
    /// The half arcs that leave it.
    arms: Vec<HalfArc>,
    /// The two half arcs that pass through smoothly, if two outrank all others.
    through: Option<[HalfArc; 2]>,
}

/// All junctions of a map.
pub(super) struct Junctions {
    list: Vec<Junction>,
}

impl Junctions {
    /// Collects the junctions of a map. The two borders of highest `rank(left, right)` pass through.
    pub(super) fn new(map: &PlanarMap, rank: impl Fn(u32, u32) -> u8) -> Self {
        let mut places = vec![[0; 2]; map.junctions];
        let mut leaving: Vec<Vec<(HalfArc, u8)>> = vec![Vec::new(); map.junctions];
        for (i, arc) in map.arcs.iter().enumerate() {
            let Some([first, last]) = arc.ends else { continue };
            let p = map.points_of(arc);
            let r = rank(arc.left, arc.right);
            for (junction, point, reversed) in [(first, p[0], false), (last, p[p.len() - 1], true)] {
                places[junction as usize] = point;
                leaving[junction as usize].push((HalfArc { arc: i as u32, reversed }, r));
            }
        }
        let list = places.into_iter().zip(leaving).map(|(point, arms)| {
            let top = arms.iter().map(|a| a.1).max();
            let best: Vec<HalfArc> = arms.iter().filter(|a| Some(a.1) == top).map(|a| a.0).collect();
            let through = <[HalfArc; 2]>::try_from(best).ok().filter(|_| arms.len() > 2);
            let arms = arms.into_iter().map(|a| a.0).collect();
            Junction { at: lattice(point), arms, through }
        });
        Self { list: list.collect() }
    }

    /// Unit tangents at both ends of arc `i`, along the arc, where it passes through a junction smoothly.
    pub(super) fn tangents(&self, arc: &Arc, points: Points<'_>, i: usize) -> [Option<Vec2>; 2] {
        let Some([first, last]) = arc.ends else { return [None; 2] };
        [(first, false), (last, true)].map(|(junction, reversed)| {
            let [a, b] = self.list[junction as usize].through?;
            let own = HalfArc { arc: i as u32, reversed };
            let other = if own == a { b } else { a };
            if own != a && own != b {
                return None;
            }
            let here = points.ahead(own, 0);
            let (out, back) = (points.ahead(own, 3), points.ahead(other, 3));
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
