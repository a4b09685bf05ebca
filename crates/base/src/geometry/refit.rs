//! Simplification of outlines: redraws them with fewer segments.
//!
//! Each ring is sampled and fitted in several ways: with its corners kept, smooth all round, and as a
//! polygon. The shortest that does not cross itself and keeps its area is taken.
//!
//! Works badly for outlines that share borders: each is fitted on its own, so the two sides of a
//! border may deviate by the tolerance in opposite directions.

use super::fit::{CurveSegment, fit_closed, fit_open};
use super::{Outline, PathText, is_simple, nearest_between, write_path};
use kurbo::{BezPath, ParamCurve, ParamCurveDeriv, PathEl, PathSeg, Point, Vec2};

/// Distance between samples, in pixels.
const SAMPLE: f64 = 0.4;
/// Largest number of samples on a segment.
const MOST_SAMPLES: f64 = 500.0;
/// Cosine of the smallest turn (40°) at which a joint of segments is a corner.
const CORNER: f64 = 0.77;
/// Upper bound of the tolerance, as a share of the square root of the shape's area. It preserves
/// specks.
const SHARE: f64 = 0.15;
/// Largest permitted change in area, as a share.
const AREA: f64 = 0.2;

impl Outline {
    /// Simplifies the outline within `tolerance` pixels for the shortest path data with `decimals` digits
    /// after the decimal point. Returns it unchanged if no shorter one is found.
    pub fn refitted(&self, tolerance: f64, decimals: u8) -> Self {
        let style = PathText { precision: decimals };
        let length = |path: &BezPath| write_path(path, style).len();
        let area = self.area();
        let rings: Vec<SampledRing> =
            rings(self.path()).into_iter().filter_map(|r| SampledRing::new(&r)).collect();
        let mut tolerance = tolerance.min(SHARE * libm::sqrt(area));
        // Halve the tolerance if no fit is valid: thin blades cross themselves when bent.
        for _ in 0..3 {
            let mut path = BezPath::new();
            for ring in &rings {
                let fits = ring.fits(tolerance).into_iter().filter(is_simple);
                // Ties go to the first fit, which keeps corners.
                if let Some(best) = fits.min_by_key(length) {
                    path.extend(best);
                }
            }
            // Rounding to the grid may change length and area, and make a path cross itself.
            let outline = Self::new(&path).filter(|o| {
                let kept = (o.area() - area).abs() <= AREA * area;
                kept && length(o.path()) < length(self.path()) && is_simple(o.path())
            });
            if let Some(outline) = outline {
                return outline;
            }
            tolerance /= 2.0;
        }
        self.clone()
    }
}

/// The rings of a path, each as its segments.
fn rings(path: &BezPath) -> Vec<Vec<PathSeg>> {
    let mut rings: Vec<Vec<PathSeg>> = Vec::new();
    let mut segments = path.segments();
    // One segment per element except moves; closing adds one only if its length is not 0.
    for element in path.elements() {
        match element {
            PathEl::MoveTo(_) => rings.push(Vec::new()),
            PathEl::ClosePath => {
                if let Some(ring) = rings.last_mut()
                    && let (Some(first), Some(last)) = (ring.first(), ring.last())
                    && first.start() != last.end()
                {
                    ring.extend(segments.next());
                }
            }
            _ => {
                if let Some(ring) = rings.last_mut() {
                    ring.extend(segments.next());
                }
            }
        }
    }
    rings
}

/// A sampled ring.
struct SampledRing {
    /// Samples, the first not repeated at the end.
    points: Vec<Point>,
    /// Indices of the samples that are corners, ascending.
    corners: Vec<usize>,
}

impl SampledRing {
    /// `None` if the ring is degenerate.
    fn new(segments: &[PathSeg]) -> Option<Self> {
        let segments: Vec<&PathSeg> = segments.iter().filter(|s| s.start() != s.end()).collect();
        let n = segments.len();
        let (mut points, mut corners) = (Vec::new(), Vec::new());
        for (i, segment) in segments.iter().enumerate() {
            let before = direction(segments[(i + n - 1) % n], 1.0);
            if before.dot(direction(segment, 0.0)) < CORNER {
                corners.push(points.len());
            }
            let length = chords(segment);
            let steps = libm::ceil(length / SAMPLE).clamp(1.0, MOST_SAMPLES) as usize;
            points.extend((0..steps).map(|k| segment.eval(k as f64 / steps as f64)));
        }
        (points.len() >= 3).then_some(Self { points, corners })
    }

    /// Closed paths within `tolerance` of the ring, the most faithful first.
    fn fits(&self, tolerance: f64) -> Vec<BezPath> {
        let mut fits = vec![self.with_corners(tolerance)];
        if !self.corners.is_empty() {
            let (start, pieces) = fit_closed(&self.points, None, tolerance);
            fits.push(closed(start, &pieces));
        }
        fits.push(self.polygon(tolerance));
        fits
    }

    fn with_corners(&self, tolerance: f64) -> BezPath {
        let n = self.points.len();
        let Some(&first) = self.corners.first() else {
            let (start, pieces) = fit_closed(&self.points, None, tolerance);
            return closed(start, &pieces);
        };
        let mut pieces = Vec::new();
        for (i, &from) in self.corners.iter().enumerate() {
            let to = self.corners.get(i + 1).copied().unwrap_or(first + n);
            let span: Vec<Point> = (from..=to).map(|k| self.points[k % n]).collect();
            pieces.extend(fit_open(&span, None, [None, None], tolerance));
        }
        closed(self.points[first], &pieces)
    }

    /// Polygon through a subset of the samples (Douglas and Peucker 1973).
    fn polygon(&self, tolerance: f64) -> BezPath {
        let n = self.points.len();
        let first = self.corners.first().copied().unwrap_or(0);
        let turned: Vec<Point> = (0..=n).map(|k| self.points[(first + k) % n]).collect();
        let far = |k: &usize| (turned[*k] - turned[0]).hypot2();
        // Of two equally distant samples, the later one.
        let middle = (1..n).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(n / 2);
        let mut kept = vec![0];
        let mut spans = vec![(middle, n), (0, middle)];
        while let Some((from, to)) = spans.pop() {
            let distance = |k: &usize| distance_to_chord(turned[*k], turned[from], turned[to]);
            let worst = (from + 1..to).max_by(|a, b| distance(a).total_cmp(&distance(b)));
            match worst.filter(|k| distance(k) > tolerance) {
                Some(k) => spans.extend([(k, to), (from, k)]),
                None => kept.push(to),
            }
        }
        let mut path = BezPath::new();
        path.move_to(turned[0]);
        // The last sample repeats the first.
        kept[1..kept.len() - 1].iter().for_each(|&k| path.line_to(turned[k]));
        path.close_path();
        path
    }
}

/// A closed path from fitted pieces.
pub(super) fn closed(start: Point, pieces: &[CurveSegment]) -> BezPath {
    let mut path = BezPath::new();
    path.move_to(start);
    for (i, piece) in pieces.iter().enumerate() {
        match *piece {
            // Closing the path draws it.
            CurveSegment::Line(_) if i + 1 == pieces.len() => {}
            CurveSegment::Line(p) => path.line_to(p),
            CurveSegment::Cubic(a, b, p) => path.curve_to(a, b, p),
        }
    }
    path.close_path();
    path
}

/// Unit direction of a segment at one of its ends; zero if degenerate.
fn direction(segment: &PathSeg, t: f64) -> Vec2 {
    let cubic = segment.to_cubic();
    let slope = cubic.deriv().eval(t).to_vec2();
    // With a handle of zero length, the direction is that of the chord.
    let slope = if slope.hypot2() > 1e-12 { slope } else { cubic.p3 - cubic.p0 };
    slope / libm::sqrt(slope.hypot2()).max(1e-12)
}

/// Length of a segment's control polygon, an upper bound of its arc length.
fn chords(segment: &PathSeg) -> f64 {
    let length = |v: Vec2| libm::sqrt(v.hypot2());
    match segment {
        PathSeg::Line(l) => length(l.p1 - l.p0),
        other => {
            let c = other.to_cubic();
            length(c.p1 - c.p0) + length(c.p2 - c.p1) + length(c.p3 - c.p2)
        }
    }
}

fn distance_to_chord(p: Point, a: Point, b: Point) -> f64 {
    libm::sqrt((p - nearest_between([a, b], p)).hypot2())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;
    use proptest::prelude::*;

    fn outline(text: &str) -> Outline {
        Outline::new(&parse_path(text).unwrap()).unwrap()
    }

    /// Largest distance of one outline's samples from another's, in pixels.
    fn distance(a: &Outline, b: &Outline) -> f64 {
        let samples = |o: &Outline| -> Vec<Point> {
            let all = rings(o.path()).into_iter().flatten();
            all.flat_map(|s| (0..40).map(move |k| s.eval(f64::from(k) / 40.0))).collect()
        };
        let (a, b) = (samples(a), samples(b));
        let nearest = |p: &Point| b.iter().map(|q| (*p - *q).hypot2()).fold(f64::INFINITY, f64::min);
        libm::sqrt(a.iter().map(nearest).fold(0.0, f64::max))
    }

    #[test]
    fn stairs_become_a_line_and_corners_stay() {
        let stairs = outline("M0 0h30v30h-2v-1h-4v-1h-4v-1h-4v-1h-4v-1h-4v-1h-4v-1h-4z");
        let plain = stairs.refitted(1.0, 1);
        assert!(plain.path().elements().len() <= 7, "{plain}");
        assert!(distance(&plain, &stairs) < 1.6, "{plain}");
        let square = outline("M0 0h10v10h-10z");
        assert_eq!(square.refitted(1.0, 1), square);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn refitted_outlines_are_simple_near_and_never_longer(
            radii in prop::collection::vec(1.0..20.0f64, 5..40),
            hole in any::<bool>(),
            smooth in any::<bool>(),
            tolerance in 0.05..3.0f64,
        ) {
            let mut path = BezPath::new();
            let n = radii.len();
            for (size, holes) in [(1.0, false), (0.4, true)] {
                if holes && !hole { continue }
                let corner = |i: usize| {
                    let i = if holes { n - i % n } else { i } % n;
                    let angle = i as f64 / n as f64 * std::f64::consts::TAU;
                    Point::new(libm::cos(angle), libm::sin(angle)).to_vec2() * radii[i] * size
                };
                path.move_to(corner(0).to_point());
                for i in 0..n {
                    let (a, b, c, d) = (corner(i + n - 1), corner(i), corner(i + 1), corner(i + 2));
                    let [p, q] = [b + (c - a) / 8.0, c - (d - b) / 8.0].map(Vec2::to_point);
                    if smooth { path.curve_to(p, q, c.to_point()) } else { path.line_to(c.to_point()) }
                }
                path.close_path();
            }
            prop_assume!(is_simple(&path));
            let before = Outline::new(&path).unwrap();
            let after = before.refitted(tolerance, 1);
            prop_assert!(is_simple(after.path()) || after == before);
            let length = |o: &Outline| write_path(o.path(), PathText { precision: 1 }).len();
            prop_assert!(length(&after) <= length(&before));
            prop_assert!((after.area() - before.area()).abs() <= AREA * before.area());
            let most = 1.5 * tolerance + 0.3;
            prop_assert!(distance(&after, &before) <= most, "{} > {most}", distance(&after, &before));
        }
    }
}
