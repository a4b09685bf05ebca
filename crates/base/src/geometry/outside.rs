//! Parts of curves outside a region.

use super::{BezPath, Curve, PathEl, Point};
use kurbo::{ParamCurve, ParamCurveArclen, PathSeg};

/// Distance of the places at which a curve is asked for its side, in pixels, and their least and largest number in a
/// segment.
const STEP: f64 = 0.5;
const LEAST: f64 = 4.0;
const MOST: f64 = 4096.0;
/// Steps in which the place is found where a curve passes the border of a region.
const BISECTIONS: usize = 30;
/// Accuracy of lengths, in pixels.
const EXACT: f64 = 1e-3;

/// A part of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePart {
    /// Its path, one piece.
    pub curve: Curve,
    /// Length along the piece of the whole curve up to its first point, in pixels.
    pub from: f64,
}

impl Curve {
    /// The parts of the curve outside a region, in order. A closed piece all of which is outside stays closed. What lies
    /// inside for less than half a pixel may stay.
    pub fn outside(&self, is_inside: impl Fn(Point) -> bool) -> Vec<CurvePart> {
        let pieces = self.path().elements().chunk_by(|_, next| !matches!(next, PathEl::MoveTo(_)));
        pieces.flat_map(|piece| outside(piece, &is_inside)).collect()
    }
}

/// The parts of one piece.
fn outside(piece: &[PathEl], is_inside: &impl Fn(Point) -> bool) -> Vec<CurvePart> {
    let whole = BezPath::from_vec(piece.to_vec());
    let segments: Vec<PathSeg> = whole.segments().collect();
    // Each part with the length before it.
    let (mut parts, mut length): (Vec<(Vec<PathSeg>, f64)>, f64) = (Vec::new(), 0.0);
    let (mut goes_on, mut is_cut) = (false, false);
    for segment in &segments {
        for (part, side) in sides(segment, is_inside) {
            if side {
                (goes_on, is_cut) = (false, true);
            } else {
                match parts.last_mut() {
                    Some(last) if goes_on => last.0.push(part),
                    _ => parts.push((vec![part], length)),
                }
                goes_on = true;
            }
            length += part.arclen(EXACT);
        }
    }
    if !is_cut {
        return Curve::new(whole).map(|curve| CurvePart { curve, from: 0.0 }).into_iter().collect();
    }
    let is_closed = piece.contains(&PathEl::ClosePath);
    let begins = parts.first().is_some_and(|p| p.1 == 0.0);
    // Where a closed piece begins outside, its last part goes on with the first.
    if is_closed && begins && goes_on && parts.len() > 1 {
        let first = parts.remove(0);
        if let Some(last) = parts.last_mut() {
            last.0.extend(first.0);
        }
    }
    let part = |(segments, from): (Vec<PathSeg>, f64)| {
        Some(CurvePart { curve: Curve::new(BezPath::from_path_segments(segments.into_iter()))?, from })
    };
    parts.into_iter().filter_map(part).collect()
}

/// The parts of a segment on either side of a border, and whether they are inside.
fn sides(segment: &PathSeg, is_inside: &impl Fn(Point) -> bool) -> Vec<(PathSeg, bool)> {
    let is_inside = |t: f64| is_inside(segment.eval(t));
    let steps = libm::ceil(segment.arclen(EXACT) / STEP).clamp(LEAST, MOST);
    let (mut found, mut from, mut side) = (Vec::new(), 0.0, is_inside(0.0));
    for k in 1..=steps as usize {
        let t = k as f64 / steps;
        if is_inside(t) == side {
            continue;
        }
        let (mut on, mut off) = ((k as f64 - 1.0) / steps, t);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (on + off);
            *(if is_inside(middle) == side { &mut on } else { &mut off }) = middle;
        }
        // A segment may begin on the border itself.
        if on > from {
            found.push((segment.subsegment(from..on), side));
        }
        (from, side) = (on, !side);
    }
    found.push((segment.subsegment(from..1.0), side));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Interior, Outline, parse_path};
    use kurbo::Shape;

    fn parts(curve: &str, region: &str) -> Vec<CurvePart> {
        let region = Interior::new(&Outline::new(&parse_path(region).unwrap()).unwrap());
        Curve::new(parse_path(curve).unwrap()).unwrap().outside(|p| region.contains(p))
    }

    #[test]
    fn curves_are_cut_at_the_border() {
        let square = "M10 10h20v20h-20z";
        let found = parts("M0 20H50M0 5h9", square);
        let ends = |part: &CurvePart| {
            let points: Vec<_> = part.curve.path().elements().iter().filter_map(PathEl::end_point).collect();
            [points[0].x, points[points.len() - 1].x]
        };
        let wanted = [([0.0, 10.0], 0.0), ([30.0, 50.0], 30.0), ([0.0, 9.0], 0.0)];
        assert_eq!(found.len(), wanted.len());
        for (part, (x, from)) in found.iter().zip(wanted) {
            assert!((0..2).all(|k| (ends(part)[k] - x[k]).abs() < 1e-6), "{part:?}");
            assert!((part.from - from).abs() < 0.01, "{part:?}");
        }
        assert!(parts("M12 12h9v9h-9z", square).is_empty());
    }

    #[test]
    fn closed_pieces_stay_closed_or_become_one_line() {
        let ring = "M0 20c0 11 9 20 20 20c11 0 20-9 20-20c0-11-9-20-20-20c-11 0-20 9-20 20z";
        let whole = parts(ring, "M15 15h5v5h-5z");
        assert_eq!(whole.len(), 1);
        assert_eq!(whole[0].curve.path(), &parse_path(ring).unwrap());
        // The ring begins outside, at its left end, and is cut at its right.
        let open = parts(ring, "M30-10h40v60h-40z");
        assert_eq!(open.len(), 1);
        let (path, full) = (open[0].curve.path(), parse_path(ring).unwrap());
        assert!(path.elements().iter().all(|e| *e != PathEl::ClosePath));
        let left = path.perimeter(1e-3) / full.perimeter(1e-3);
        assert!((left - 2.0 / 3.0).abs() < 0.01, "{left}");
        let cut = path.elements().iter().filter_map(PathEl::end_point);
        assert!(cut.map(|p| p.x).fold(0.0, f64::max) < 30.0 + 1e-6);
    }
}
