//! Curves as paths: chains through opposite directions (§2.4.4), and Béziers fitted to them.

use crate::context::GivenLines;
use crate::graph::{CurveGraph, EdgeChain};
use vtex_base::geometry::plane::{PeriodicPlane, along, length};
use vtex_base::geometry::{BezPath, PathEl, Point, Vec2, fitted_curve, nearest_between, signed_area};
use vtex_base::parallel;

/// Shortest step of a course, as a share of its length.
const FINEST: f64 = 1e-3;
/// Cosine of the turn from which on a place of a course is a corner: 40°.
const CORNER: f64 = 0.766;

/// Points of the ring around a cell, at least.
const RING_POINTS: f64 = 100.0;
/// Steps in which the place is found where a curve passes the border of a region.
const BISECTIONS: usize = 20;

/// A curve of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedCurve {
    /// Its path, in the unit of the exemplar. Where the page repeats it may lead beyond it.
    pub path: BezPath,
    /// The style of the strokes that it comes from.
    pub style: u32,
    /// Length of the part on the canvas. Where the page repeats, of all.
    pub shown_length: f64,
}

/// The part of the plane that is shown.
#[derive(Clone, Copy)]
pub(crate) struct ShownPart {
    pub(crate) size: [f64; 2],
    /// The axes along which the curves stand for all their copies.
    pub(crate) tile: [bool; 2],
    /// How far curves lead beyond it along the other axes.
    pub(crate) margin: f64,
}

/// The curves of a graph beside given lines, as far as they lie in the region. Where one goes on from the end of a line,
/// it reaches that also if the line ends before the region: `ahead` says of the first nodes whether they are such ends.
/// Curves lead up to `margin` beyond the canvas.
pub(crate) fn traced_beside(
    graph: &CurveGraph,
    (lines, ahead): (&GivenLines, &[Option<[f64; 2]>]),
    (margin, tolerance): (f64, f64),
) -> Vec<TracedCurve> {
    let chains = graph.chains(true);
    let of_chain = |chain: &EdgeChain| {
        let course = graph.chain_course(chain).0;
        let style = graph.edge(chain.halves[0]).style;
        let step = (2.0 * tolerance).max(FINEST * along(&course));
        let points = even(&course, step, chain.closed);
        let nodes = [graph.start(chain.halves[0]), graph.end(chain.halves[chain.halves.len() - 1])];
        let leaves_line = nodes.map(|n| ahead.get(n as usize).is_some_and(Option::is_some));
        let parts = lines.parts((points, chain.closed), leaves_line, margin);
        let curve = |(mut points, closed): (Vec<CoursePoint>, bool)| {
            let is_shown = |w: &&[CoursePoint]| {
                let middle = w[0].at.midpoint(w[1].at);
                lines.is_shown([middle.x, middle.y], 0.0)
            };
            let shown = points.windows(2).filter(is_shown);
            let shown_length = shown.map(|w| libm::sqrt((w[1].at - w[0].at).hypot2())).sum();
            points.iter_mut().for_each(|p| p.at += Vec2::new(lines.window.low[0], lines.window.low[1]));
            let points = if closed { from_corner(points) } else { points };
            TracedCurve { path: fitted(&points, closed, tolerance), style, shown_length }
        };
        parts.into_iter().map(curve).collect::<Vec<_>>()
    };
    parallel::map(&chains, of_chain).concat()
}

/// A closed course that begins at a corner, if it has one.
fn from_corner(mut points: Vec<CoursePoint>) -> Vec<CoursePoint> {
    points.pop();
    let turn = points.iter().position(|p| p.corner).unwrap_or(0);
    points.rotate_left(turn);
    points.push(points[0]);
    points
}

impl GivenLines {
    /// The parts of a course in the region, and whether they are closed. `leaves_line` says whether its ends are on given
    /// lines.
    fn parts(
        &self,
        (points, closed): (Vec<CoursePoint>, bool),
        leaves_line: [bool; 2],
        margin: f64,
    ) -> Vec<(Vec<CoursePoint>, bool)> {
        let is_inside = |p: &CoursePoint| self.is_shown([p.at.x, p.at.y], margin);
        let inside: Vec<bool> = points.iter().map(is_inside).collect();
        if inside.iter().all(|i| *i) {
            return vec![(points, closed)];
        }
        let (Some(first), Some(last)) = (inside.iter().position(|i| *i), inside.iter().rposition(|i| *i))
        else {
            return Vec::new();
        };
        let shown = |k: usize| inside[k] || leaves_line[0] && k < first || leaves_line[1] && k > last;
        // Where a course passes the border, from a point that is shown to one that is not.
        let border = |from: usize, to: usize| {
            let (mut on, mut off) = (points[from].at, points[to].at);
            for _ in 0..BISECTIONS {
                let middle = on.midpoint(off);
                let held = self.is_shown([middle.x, middle.y], margin);
                *(if held { &mut on } else { &mut off }) = middle;
            }
            CoursePoint { at: on, corner: false }
        };
        let mut parts: Vec<Vec<CoursePoint>> = Vec::new();
        for k in 0..points.len() {
            match (k > 0 && shown(k - 1), shown(k)) {
                (false, true) => {
                    let begin = if k > 0 { vec![border(k, k - 1), points[k]] } else { vec![points[k]] };
                    parts.push(begin);
                }
                (true, true) => parts.last_mut().map_or((), |part| part.push(points[k])),
                (true, false) => parts.last_mut().map_or((), |part| part.push(border(k - 1, k))),
                (false, false) => {}
            }
        }
        let ring = closed && shown(0) && parts.len() > 1;
        if ring && let Some(mut tail) = parts.pop() {
            tail.pop();
            tail.append(&mut parts[0]);
            parts[0] = tail;
        }
        parts.into_iter().filter(|part| part.len() > 1).map(|part| (part, false)).collect()
    }
}

/// All curves of a graph, as long as they run on smoothly. `tolerance` is the largest deviation of a path.
pub(crate) fn traced(graph: &CurveGraph, shown: ShownPart, tolerance: f64) -> Vec<TracedCurve> {
    let chains = graph.chains(true);
    let of_chain = |chain: &EdgeChain| {
        let course = graph.chain_course(chain).0;
        let style = graph.edge(chain.halves[0]).style;
        let step = (2.0 * tolerance).max(FINEST * along(&course));
        let parts = shown.parts(even(&course, step, chain.closed), graph.plane, chain.closed);
        let curve = |(mut points, closed): (Vec<CoursePoint>, bool)| {
            let (first, last) = (points[0].at, points[points.len() - 1].at);
            let endless = closed && (last - first).hypot2() > step * step;
            if endless {
                // An endless curve overlaps its copy, so that no seam shows.
                points.push(CoursePoint { at: points[1].at + (last - first), ..points[1] });
            } else if closed {
                points = from_corner(points);
            }
            let shown_length = shown.length(&points);
            TracedCurve { path: fitted(&points, closed && !endless, tolerance), style, shown_length }
        };
        parts.into_iter().map(curve).collect::<Vec<_>>()
    };
    parallel::map(&chains, of_chain).concat()
}

impl ShownPart {
    /// Length of the steps of a course whose middles are shown.
    fn length(&self, points: &[CoursePoint]) -> f64 {
        let inside = |v: f64, k: usize| self.tile[k] || (0.0..=self.size[k]).contains(&v);
        let step = |w: &[CoursePoint]| {
            let middle = w[0].at.midpoint(w[1].at);
            let shown = inside(middle.x, 0) && inside(middle.y, 1);
            if shown { libm::sqrt((w[1].at - w[0].at).hypot2()) } else { 0.0 }
        };
        points.windows(2).map(step).sum()
    }

    /// Area of the part of a ring on the canvas.
    pub(crate) fn area(&self, ring: Vec<Point>) -> f64 {
        let at = |p: &Point, k: usize| if k == 0 { p.x } else { p.y };
        let limits = (0..2).filter(|k| !self.tile[*k]).flat_map(|k| [(k, 1.0, 0.0), (k, -1.0, self.size[k])]);
        // Cut along each side (Sutherland and Hodgman).
        let left = limits.fold(ring, |ring, (k, sign, limit)| {
            let beyond = |p: &Point| sign * (at(p, k) - limit);
            let mut cut = Vec::with_capacity(ring.len());
            for (i, p) in ring.iter().enumerate() {
                let before = &ring[(i + ring.len() - 1) % ring.len()];
                let (a, b) = (beyond(before), beyond(p));
                if (a < 0.0) != (b < 0.0) {
                    cut.push(before.lerp(*p, a / (a - b)));
                }
                if b >= 0.0 {
                    cut.push(*p);
                }
            }
            cut
        });
        signed_area(&left).abs()
    }

    /// The places that are shown of a point and its copies on a plane that repeats.
    pub(crate) fn places(&self, at: [f64; 2], plane: PeriodicPlane) -> Vec<[f64; 2]> {
        let along = |k: usize| -> Vec<f64> {
            if self.tile[k] {
                return vec![at[k]];
            }
            let copies = [-1.0, 0.0, 1.0].map(|n| at[k] + n * plane.size[k]);
            copies.into_iter().filter(|v| (-self.margin..=self.size[k] + self.margin).contains(v)).collect()
        };
        let columns = along(0);
        along(1).into_iter().flat_map(|y| columns.iter().map(move |x| [*x, y]).collect::<Vec<_>>()).collect()
    }

    /// The parts of a course that are shown, of all its copies on a plane that repeats, and whether they are closed.
    fn parts(
        &self,
        course: Vec<CoursePoint>,
        plane: PeriodicPlane,
        closed: bool,
    ) -> Vec<(Vec<CoursePoint>, bool)> {
        let bounds = |k: usize| {
            let at = |p: &CoursePoint| if k == 0 { p.at.x } else { p.at.y };
            let low = course.iter().map(at).fold(f64::INFINITY, f64::min);
            (low, course.iter().map(at).fold(f64::NEG_INFINITY, f64::max))
        };
        let shifts = [0, 1].map(|k| {
            if self.tile[k] {
                return 0..=0;
            }
            let (low, high) = bounds(k);
            let period = plane.size[k];
            let first = libm::ceil((-self.margin - high) / period) as i64;
            first..=libm::floor((self.size[k] + self.margin - low) / period) as i64
        });
        let [columns, rows] = shifts;
        let mut parts = Vec::new();
        for j in rows {
            for i in columns.clone() {
                let by = Vec2::new(i as f64 * plane.size[0], j as f64 * plane.size[1]);
                let inside = |p: &CoursePoint| {
                    let within = |v: f64, k: usize| {
                        self.tile[k] || (-self.margin..=self.size[k] + self.margin).contains(&v)
                    };
                    within(p.at.x, 0) && within(p.at.y, 1)
                };
                let moved: Vec<CoursePoint> =
                    course.iter().map(|p| CoursePoint { at: p.at + by, ..*p }).collect();
                if moved.iter().all(inside) {
                    parts.push((moved, closed));
                    continue;
                }
                let runs = moved.chunk_by(|a, b| inside(a) == inside(b));
                parts.extend(runs.filter(|r| r.len() > 1 && inside(&r[0])).map(|r| (r.to_vec(), false)));
            }
        }
        parts
    }
}

/// A ring with fewer points, which the others are at most `tolerance` away from.
pub(crate) fn thinned_ring(ring: &[Point], tolerance: f64) -> Vec<Point> {
    let round: Vec<Point> = ring.iter().chain(ring.first()).copied().collect();
    let mut kept = thinned(&round, tolerance);
    kept.pop();
    kept
}

/// A course with fewer points, which the others are at most `tolerance` away from.
pub(crate) fn thinned(course: &[Point], tolerance: f64) -> Vec<Point> {
    let is_near =
        |from, to, p: Point| nearest_between([from, to], p).distance_squared(p) <= tolerance * tolerance;
    let mut kept = vec![course[0]];
    let mut from = 0;
    for to in 2..course.len() {
        if !course[from + 1..to].iter().all(|p| is_near(course[from], course[to], *p)) {
            from = to - 1;
            kept.push(course[from]);
        }
    }
    kept.extend(course.last().filter(|_| course.len() > 1));
    kept
}

/// A closed path along a ring, smooth but at corners.
pub(crate) fn traced_ring(ring: &[Point], tolerance: f64) -> BezPath {
    let n = ring.len();
    let length: f64 = (0..n).map(|k| ring[k].distance(ring[(k + 1) % n])).sum();
    // Between distant points a fitted path is free.
    let step = (length / RING_POINTS).max(tolerance);
    let mut course: Vec<[f64; 2]> = Vec::new();
    for k in 0..n {
        let [from, to] = [ring[k], ring[(k + 1) % n]];
        let count = libm::ceil(from.distance(to) / step).max(1.0);
        course.extend((0..count as usize).map(|i| from.lerp(to, i as f64 / count)).map(|p| [p.x, p.y]));
    }
    course.push(course[0]);
    fitted(&from_corner(even(&course, tolerance, true)), true, tolerance)
}

/// A path through points, smooth but at corners.
fn fitted(points: &[CoursePoint], closed: bool, tolerance: f64) -> BezPath {
    let n = points.len() - 1;
    let corners: Vec<usize> = (1..n).filter(|k| points[*k].corner).collect();
    let smooth = closed && !points[0].corner;
    if corners.is_empty() || smooth {
        let all: Vec<Point> = points.iter().map(|p| p.at).collect();
        return fitted_curve(&all, tolerance, smooth);
    }
    let mut path = BezPath::new();
    path.move_to(points[0].at);
    let mut from = 0;
    for to in corners.into_iter().chain([n]) {
        let span: Vec<Point> = points[from..=to].iter().map(|p| p.at).collect();
        let piece = fitted_curve(&span, tolerance, false);
        path.extend(piece.elements().iter().skip(1).filter(|e| **e != PathEl::ClosePath).copied());
        from = to;
    }
    if closed {
        path.close_path();
    }
    path
}

/// A point of a course.
#[derive(Clone, Copy)]
struct CoursePoint {
    at: Point,
    /// Whether the course turns sharply there.
    corner: bool,
}

/// Points of a course that are at least `step` apart, but for the last and for corners.
fn even(course: &[[f64; 2]], step: f64, closed: bool) -> Vec<CoursePoint> {
    let n = course.len() - 1;
    let turn = |a: usize, b: usize, c: usize, d: usize| {
        let (p, q) = (way(course[a], course[b]), way(course[c], course[d]));
        p[0] * q[0] + p[1] * q[1] < CORNER * length(p) * length(q)
    };
    let corner = |k: usize| match k {
        _ if k == 0 || k == n => closed && turn(n - 1, n, 0, 1),
        k => turn(k - 1, k, k, k + 1),
    };
    let point = |k: usize| CoursePoint { at: Point::new(course[k][0], course[k][1]), corner: corner(k) };
    let mut points = vec![point(0)];
    for k in 1..n {
        let p = point(k);
        let last = points[points.len() - 1];
        let far = (p.at - last.at).hypot2();
        if far >= step * step || p.corner && far > 0.0 {
            if p.corner && far < 0.25 * step * step && points.len() > 1 && !last.corner {
                points.pop();
            }
            points.push(p);
        }
    }
    let last = points[points.len() - 1];
    let end = point(n);
    if points.len() > 1 && !last.corner && (end.at - last.at).hypot2() < 0.25 * step * step {
        points.pop();
    }
    points.push(end);
    points
}

fn way(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}
