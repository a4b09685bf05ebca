//! Least-squares fitting of cubic Béziers to sampled curves with corners (Schneider 1990).
//!
//! Works badly for few and noisy samples: an arc of three samples is not smoothed.

use kurbo::{BezPath, CubicBez, ParamCurve, ParamCurveDeriv, Point, Vec2};

/// A segment of a fitted curve; it starts at the previous segment's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CurveSegment {
    /// A straight line to a point.
    Line(Point),
    /// A cubic Bézier: two control points and the end.
    Cubic(Point, Point, Point),
}

impl CurveSegment {
    /// The segment's end.
    pub(super) fn end(&self) -> Point {
        match *self {
            Self::Line(p) | Self::Cubic(_, _, p) => p,
        }
    }
}

/// Fits `points` (at least two) within `tolerance`, in the units of the points. The curve passes
/// through the first and the last point. `ends` are unit tangents there, both pointing along the
/// curve; `None` estimates them. With `corners`, turns that are sharp over that many points to each
/// side remain corners.
pub(super) fn fit_open(
    points: &[Point],
    corners: Option<usize>,
    [start, end]: [Option<Vec2>; 2],
    tolerance: f64,
) -> Vec<CurveSegment> {
    let mut out = Vec::new();
    let mut from = 0;
    let corners = corners.map_or(Vec::new(), |reach| self::corners(points, false, reach));
    for &to in corners.iter().chain([&(points.len() - 1)]) {
        if to > from {
            let first = if from == 0 { start } else { None };
            let last = if to == points.len() - 1 { end } else { None };
            fit_span(&points[from..=to], first, last, tolerance, &mut out);
            from = to;
        }
    }
    out
}

/// A smooth curve through `points` (at least two) within `tolerance`, in the units of the points. It passes through the
/// first and the last point; if they are the same, it is closed, and smooth there too where `smooth_seam` says so.
pub fn fitted_curve(points: &[Point], tolerance: f64, smooth_seam: bool) -> BezPath {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return BezPath::new() };
    let closed = points.len() > 3 && first == last;
    let (start, segments) = if closed && smooth_seam {
        fit_closed(&points[..points.len() - 1], None, tolerance)
    } else {
        (*first, fit_open(points, None, [None; 2], tolerance))
    };
    let mut path = BezPath::new();
    path.move_to(start);
    for segment in segments {
        match segment {
            CurveSegment::Line(p) => path.line_to(p),
            CurveSegment::Cubic(a, b, p) => path.curve_to(a, b, p),
        }
    }
    if closed {
        path.close_path();
    }
    path
}

/// Fits a closed curve through `points` (at least three, the first not repeated at the end). Returns
/// the starting point and the segments, the last of which ends there.
pub(super) fn fit_closed(
    points: &[Point],
    corners: Option<usize>,
    tolerance: f64,
) -> (Point, Vec<CurveSegment>) {
    let n = points.len();
    let corners = corners.map_or(Vec::new(), |reach| self::corners(points, true, reach));
    let first = corners.first().copied().unwrap_or(0);
    let mut turned: Vec<Point> = points[first..].iter().chain(&points[..=first]).copied().collect();
    let tangent = if corners.is_empty() {
        // Without a corner, one tangent serves both ends at the seam.
        let reach = (n / 6).clamp(1, 3);
        let chord = turned[reach] - turned[n - reach];
        unit(chord)
    } else {
        None
    };
    turned[n] = turned[0];
    let mut out = Vec::new();
    let mut from = 0;
    for to in corners.iter().skip(1).map(|c| c - first).chain([n]) {
        if to > from {
            fit_span(
                &turned[from..=to],
                tangent.filter(|_| from == 0),
                tangent.filter(|_| to == n),
                tolerance,
                &mut out,
            );
            from = to;
        }
    }
    (turned[0], out)
}

fn unit(v: Vec2) -> Option<Vec2> {
    let length = libm::sqrt(v.hypot2());
    (length > 1e-9).then(|| v / length)
}

/// Indices where the direction turns by more than about 55° within `reach` samples and stays turned.
fn corners(points: &[Point], closed: bool, reach: usize) -> Vec<usize> {
    const COSINE: f64 = 0.57;
    let n = points.len();
    if n < 2 * reach + 1 + if closed { 2 * reach } else { 0 } {
        return Vec::new();
    }
    let at = |i: usize, offset: isize| points[(i as isize + offset).rem_euclid(n as isize) as usize];
    let sharpness = |i: usize| -> f64 {
        let before = at(i, 0) - at(i, -(reach as isize));
        let after = at(i, reach as isize) - at(i, 0);
        match (unit(before), unit(after)) {
            (Some(a), Some(b)) => a.dot(b),
            _ => 1.0,
        }
    };
    let range = if closed { 0..n } else { reach..n - reach };
    let cosines: Vec<f64> = (0..n).map(|i| if range.contains(&i) { sharpness(i) } else { 1.0 }).collect();
    let mut found: Vec<usize> = Vec::new();
    for i in range {
        if cosines[i] >= COSINE {
            continue;
        }
        let sharpest = (1..=reach as isize).all(|k| {
            let get = |o: isize| {
                let j = i as isize + o;
                if closed {
                    cosines[j.rem_euclid(n as isize) as usize]
                } else {
                    cosines[j.clamp(0, n as isize - 1) as usize]
                }
            };
            cosines[i] < get(-k) && cosines[i] <= get(k)
        });
        if sharpest {
            found.push(i);
        }
    }
    found
}

/// Unit tangent at the first of `points`, estimated from the samples within about two steps.
fn end_tangent(points: &[Point]) -> Option<Vec2> {
    let reach = (points.len() - 1).min(3);
    let mut sum = Vec2::ZERO;
    for p in &points[1..=reach] {
        sum += unit(*p - points[0]).unwrap_or(Vec2::ZERO);
    }
    unit(sum).or_else(|| unit(points[points.len() - 1] - points[0]))
}

fn fit_span(
    points: &[Point],
    start: Option<Vec2>,
    end: Option<Vec2>,
    tolerance: f64,
    out: &mut Vec<CurveSegment>,
) {
    let n = points.len();
    let (first, last) = (points[0], points[n - 1]);
    if n == 2 || straight(points, tolerance * 0.7) {
        out.push(CurveSegment::Line(last));
        return;
    }
    let reversed: Vec<Point>;
    let forward = start.or_else(|| end_tangent(points)).unwrap_or(Vec2::new(1.0, 0.0));
    let backward = match end {
        Some(t) => -t,
        None => {
            reversed = points.iter().rev().copied().collect();
            end_tangent(&reversed).unwrap_or(-forward)
        }
    };
    let mut t = chord_parameters(points);
    let mut worst = (0.0, n / 2);
    for round in 0..4 {
        let curve = least_squares(points, &t, first, last, forward, backward);
        worst = largest_error(points, &t, &curve);
        if worst.0 <= tolerance * tolerance {
            out.push(CurveSegment::Cubic(curve.p1, curve.p2, last));
            return;
        }
        // The error is too large to be fixed by reparametrisation.
        if round == 3 || worst.0 > 16.0 * tolerance * tolerance {
            break;
        }
        reparametrise(points, &mut t, &curve);
    }
    let split = worst.1.clamp(1, n - 2);
    let reach = split.min(n - 1 - split).min(3);
    let centre = unit(points[split + reach] - points[split - reach]);
    fit_span(&points[..=split], start, centre, tolerance, out);
    fit_span(&points[split..], centre, end, tolerance, out);
}

/// Whether all points lie within `tolerance` of the chord and project between its ends.
fn straight(points: &[Point], tolerance: f64) -> bool {
    let (a, b) = (points[0], points[points.len() - 1]);
    let chord = b - a;
    let length2 = chord.hypot2();
    if length2 < 1e-12 {
        return false;
    }
    points.iter().all(|&p| {
        let cross = chord.cross(p - a);
        let along = chord.dot(p - a);
        cross * cross <= tolerance * tolerance * length2
            && along >= -tolerance
            && along <= length2 + tolerance
    })
}

fn chord_parameters(points: &[Point]) -> Vec<f64> {
    let mut t = Vec::with_capacity(points.len());
    let mut sum = 0.0;
    t.push(0.0);
    for w in points.windows(2) {
        sum += libm::sqrt((w[1] - w[0]).hypot2());
        t.push(sum);
    }
    if sum > 0.0 {
        t.iter_mut().for_each(|v| *v /= sum);
    }
    t
}

fn least_squares(
    points: &[Point],
    t: &[f64],
    first: Point,
    last: Point,
    forward: Vec2,
    backward: Vec2,
) -> CubicBez {
    let (mut c00, mut c01, mut c11, mut x0, mut x1) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (&p, &u) in points.iter().zip(t) {
        let v = 1.0 - u;
        let (b0, b1, b2, b3) = (v * v * v, 3.0 * u * v * v, 3.0 * u * u * v, u * u * u);
        let (a0, a1) = (forward * b1, backward * b2);
        c00 += a0.dot(a0);
        c01 += a0.dot(a1);
        c11 += a1.dot(a1);
        let rest = p.to_vec2() - first.to_vec2() * (b0 + b1) - last.to_vec2() * (b2 + b3);
        x0 += a0.dot(rest);
        x1 += a1.dot(rest);
    }
    let chord = libm::sqrt((last - first).hypot2());
    let path: f64 = points.windows(2).map(|w| libm::sqrt((w[1] - w[0]).hypot2())).sum();
    let determinant = c00 * c11 - c01 * c01;
    let third = path.max(chord) / 3.0;
    let (mut a, mut b) = (third, third);
    if determinant.abs() > 1e-12 {
        let (sa, sb) = ((x0 * c11 - x1 * c01) / determinant, (c00 * x1 - c01 * x0) / determinant);
        // Negative or overlong handles make loops; use the heuristic instead.
        let fine = |h: f64| h > 1e-3 * path && h < 1.2 * path;
        if fine(sa) && fine(sb) {
            (a, b) = (sa, sb);
        }
    }
    CubicBez::new(first, first + forward * a, last + backward * b, last)
}

/// Largest squared distance between a sample and the curve at its parameter, and the sample's index.
fn largest_error(points: &[Point], t: &[f64], curve: &CubicBez) -> (f64, usize) {
    let mut worst = (0.0, points.len() / 2);
    for (i, (&p, &u)) in points.iter().zip(t).enumerate() {
        let d = (curve.eval(u) - p).hypot2();
        if d > worst.0 {
            worst = (d, i);
        }
    }
    worst
}

/// Moves every parameter by one Newton step towards the nearest point of the curve.
fn reparametrise(points: &[Point], t: &mut [f64], curve: &CubicBez) {
    let d1 = curve.deriv();
    let d2 = d1.deriv();
    for (&p, u) in points.iter().zip(t.iter_mut()) {
        let d = curve.eval(*u) - p;
        let (v1, v2) = (d1.eval(*u).to_vec2(), d2.eval(*u).to_vec2());
        let slope = v1.hypot2() + d.dot(v2);
        if slope.abs() > 1e-12 {
            *u = (*u - d.dot(v1) / slope).clamp(0.0, 1.0);
        }
    }
    // Parameters must be monotonic.
    for i in 1..t.len() {
        t[i] = t[i].max(t[i - 1]);
    }
}
