//! Joints of lines that go on at the opposite border of a periodic page.
//!
//! Authors draw such lines up to the border, or nearly so. A gap stays between lines that end short of it, and a notch
//! between slanted ones, whose ends are cut across the line. Lines that meet are made longer until both are closed.

use super::pieces::{DrawingPiece, PieceShape};
use super::torus::PageBorder;
use kurbo::{ParamCurve, PathSeg};
use vtex_base::geometry::{BezPath, PathEl, Point, Vec2};

/// Largest distance of an end from the border, and of the places where two lines meet it, in widths of the lines.
const SHORT: f64 = 1.0;
const APART: f64 = 0.5;
/// Least cosine of the angle between a line and the direction across the border, and between two lines that meet.
const OUTWARD: f64 = 0.3;
const STRAIGHT: f64 = 0.9;
/// Least gap or notch that is closed, in widths.
const LEAST: f64 = 0.02;
/// Most lines that are looked at.
const MOST: usize = 4_000;

/// An end of a line near a border.
struct LineEnd {
    piece: usize,
    /// Whether it is the last point of the line.
    is_last: bool,
    border: PageBorder,
    /// Where the line meets the border, along it.
    place: f64,
    /// Unit vector that leads away from the line.
    outward: Vec2,
    /// How much longer the line becomes.
    extension: f64,
    width: f64,
}

/// Makes lines that meet at opposite borders longer.
pub(super) fn close(pieces: &mut [DrawingPiece], size: [f64; 2]) {
    let ends: Vec<LineEnd> = (0..pieces.len()).flat_map(|k| ends(k, &pieces[k], size)).collect();
    if ends.len() > MOST {
        return;
    }
    let meet = |a: &LineEnd, b: &LineEnd| {
        let [one, other] = [a, b].map(|end| &pieces[end.piece].parts[0]);
        let opposite = a.border.axis == b.border.axis && a.border.far != b.border.far;
        let alike = one.paint.colour == other.paint.colour && pieces[a.piece].layer == pieces[b.piece].layer;
        let straight = a.outward.dot(b.outward) <= -STRAIGHT;
        opposite && alike && straight && (a.place - b.place).abs() <= APART * a.width
    };
    let is_met = |a: &&LineEnd| ends.iter().any(|b| meet(a, b));
    let seen = ends.iter().filter(|end| end.extension > LEAST * end.width);
    let met: Vec<&LineEnd> = seen.filter(is_met).collect();
    for end in met {
        let path = &mut pieces[end.piece].parts[0].path;
        *path = extended(path, end);
    }
}

/// The ends near a border of a piece that is one open, opaque line.
fn ends(number: usize, piece: &DrawingPiece, size: [f64; 2]) -> Vec<LineEnd> {
    let [PieceShape { path, paint, stroke: Some(stroke) }] = &piece.parts[..] else { return Vec::new() };
    let is_open = path.elements().iter().skip(1).all(|e| !matches!(e, PathEl::MoveTo(_) | PathEl::ClosePath));
    let segments: Vec<PathSeg> = path.segments().collect();
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return Vec::new() };
    if !is_open || paint.opacity < 1.0 || !stroke.dashes.is_empty() {
        return Vec::new();
    }
    let width = stroke.width;
    let end = |(at, inner, is_last): (Point, Point, bool)| {
        let outward = at - inner;
        let outward = outward / outward.hypot();
        let of_border = |border: PageBorder| {
            let PageBorder { axis, far } = border;
            let (at_axis, along_axis) = ([at.x, at.y][axis], [outward.x, outward.y][axis]);
            let (gap, cosine) = if far { (size[axis] - at_axis, along_axis) } else { (at_axis, -along_axis) };
            if !(-SHORT * width..=SHORT * width).contains(&gap) || cosine < OUTWARD {
                return None;
            }
            let notch = 0.5 * width * libm::sqrt((1.0 - cosine * cosine).max(0.0)) / cosine;
            let to_border = gap / cosine;
            let meets = at + to_border * outward;
            let extension = to_border + notch;
            let place = [meets.y, meets.x][axis];
            Some(LineEnd { piece: number, is_last, border, place, outward, extension, width })
        };
        let mut borders =
            [0, 1].into_iter().flat_map(|axis| [false, true].map(|far| PageBorder { axis, far }));
        borders.find_map(of_border)
    };
    let near = 1e-4;
    let both = [(first.eval(0.0), first.eval(near), false), (last.eval(1.0), last.eval(1.0 - near), true)];
    both.into_iter().filter(|(at, inner, _)| at != inner).filter_map(end).collect()
}

/// A path with a longer first or last line.
fn extended(path: &BezPath, end: &LineEnd) -> BezPath {
    let mut elements = path.elements().to_vec();
    let by = end.extension * end.outward;
    if end.is_last {
        match elements.last_mut() {
            Some(PathEl::LineTo(p)) => *p += by,
            Some(element) => {
                let to = element.end_point().map(|p| p + by);
                elements.extend(to.map(PathEl::LineTo));
            }
            None => {}
        }
    } else if let Some(PathEl::MoveTo(start)) = elements.first().copied() {
        elements[0] = PathEl::MoveTo(start + by);
        if !matches!(elements.get(1), Some(PathEl::LineTo(_))) {
            elements.insert(1, PathEl::LineTo(start));
        }
    }
    BezPath::from_vec(elements)
}

#[cfg(test)]
mod tests {
    use super::super::paint::DrawnPaint;
    use super::super::read::DrawnStroke;
    use super::*;
    use resvg::usvg::{LineCap, LineJoin};
    use vtex_base::raster::colour::Colour;

    fn drawn(path: &str) -> DrawingPiece {
        let path = BezPath::from_svg(path).unwrap();
        let paint = DrawnPaint { colour: Colour([0; 3]), gradient: None, opacity: 1.0 };
        let stroke = DrawnStroke {
            paint: paint.clone(),
            width: 2.0,
            cap: LineCap::Butt,
            join: LineJoin::Miter,
            miter_limit: 4.0,
            dashes: Vec::new(),
            dash_offset: 0.0,
        };
        let part = PieceShape { path, paint, stroke: Some(stroke) };
        DrawingPiece { parts: vec![part], item: 0, group: None, layer: 0 }
    }

    fn closed(paths: &[&str]) -> Vec<[f64; 4]> {
        let mut pieces: Vec<DrawingPiece> = paths.iter().map(|path| drawn(path)).collect();
        close(&mut pieces, [100.0, 50.0]);
        let ends = |piece: &DrawingPiece| {
            let segments: Vec<PathSeg> = piece.parts[0].path.segments().collect();
            let (a, b) = (segments[0].eval(0.0), segments[segments.len() - 1].eval(1.0));
            [a.x, a.y, b.x, b.y].map(|v| libm::round(v * 100.0) / 100.0)
        };
        pieces.iter().map(ends).collect()
    }

    #[test]
    fn gaps_are_closed_where_lines_meet() {
        assert_eq!(closed(&["M0.5 20L99 20"]), [[0.0, 20.0, 100.0, 20.0]]);
        assert_eq!(
            closed(&["M0.5 20L30 20", "M70 20.5L100 20.5"]),
            [[0.0, 20.0, 30.0, 20.0], [70.0, 20.5, 100.0, 20.5]]
        );
        // Nothing meets it, or it is too far away.
        assert_eq!(
            closed(&["M0.5 20L30 20", "M70 30L99 30"]),
            [[0.5, 20.0, 30.0, 20.0], [70.0, 30.0, 99.0, 30.0]]
        );
        assert_eq!(closed(&["M3 20L97 20"]), [[3.0, 20.0, 97.0, 20.0]]);
    }

    #[test]
    fn notches_between_slanted_lines_are_filled() {
        // At 45 degrees, the ends of a line as wide as two go on by one.
        let more = libm::round(100.0 * libm::sqrt(0.5)) / 100.0;
        let found = closed(&["M20 0L30 10", "M10 40L20 50"]);
        assert_eq!(found, [[20.0 - more, -more, 30.0, 10.0], [10.0, 40.0, 20.0 + more, 50.0 + more]]);
        // A curve goes on straight.
        let found = closed(&["M20 0C25 5 40 5 40 20", "M10 40L20 50"]);
        assert_eq!(found[0], [20.0 - more, -more, 40.0, 20.0]);
    }
}
