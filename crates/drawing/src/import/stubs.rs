//! Stubs of lines that other lines of the same paint cover. Drawing programs leave them where lines were cut, and they are
//! not seen until they stand elsewhere.

use super::pieces::{DrawingPiece, PieceShape};
use kurbo::{BezPath, ParamCurve, ParamCurveNearest, Point, Shape as _};
use resvg::usvg::LineCap;

/// Largest length of a stub, in widths of its stroke.
const SHORT: f64 = 0.5;
/// How far a stub may reach beyond what covers it, in widths of its stroke.
const BEYOND: f64 = 0.1;
/// A drawing with more stubs is made of them.
const MOST: usize = 1000;
/// Error of lengths and distances, in widths of the stroke.
const ERROR: f64 = 0.01;

/// Removes the stubs that other pieces cover.
pub(super) fn remove_covered(pieces: &mut Vec<DrawingPiece>) {
    let stubs: Vec<Option<[Point; 4]>> = pieces.iter().map(corners).collect();
    if stubs.iter().flatten().count() > MOST {
        return;
    }
    let covered: Vec<bool> = (stubs.iter().zip(&*pieces))
        .map(|(stub, piece)| {
            let Some(corners) = stub else { return false };
            let lines = pieces.iter().zip(&stubs).filter(|(_, stub)| stub.is_none());
            lines.flat_map(|(piece, _)| &piece.parts).any(|part| covers(part, &piece.parts[0], corners))
        })
        .collect();
    let mut covered = covered.into_iter();
    pieces.retain(|_| covered.next() != Some(true));
}

/// The corners of a piece that is a stub with flat ends; `None` for others.
fn corners(piece: &DrawingPiece) -> Option<[Point; 4]> {
    let [part] = piece.parts.as_slice() else { return None };
    let stroke = part.stroke.as_ref().filter(|s| s.cap == LineCap::Butt && s.dashes.is_empty())?;
    let (first, last) = (part.path.segments().next()?, part.path.segments().last()?);
    let length = part.path.perimeter(ERROR * stroke.width);
    let [start, end] = [first.start(), last.end()];
    let along = end - start;
    if length > SHORT * stroke.width || along.hypot() == 0.0 {
        return None;
    }
    let across = kurbo::Vec2::new(-along.y, along.x) * (stroke.width / (2.0 * along.hypot()));
    Some([start - across, start + across, end - across, end + across])
}

/// Whether a part of the same paint covers a stub.
fn covers(part: &PieceShape, stub: &PieceShape, corners: &[Point; 4]) -> bool {
    let width = stub.stroke.as_ref().map_or(0.0, |s| s.width);
    let bounds = part.bounds().inflate(BEYOND * width, BEYOND * width);
    if part.paint != stub.paint || !corners.iter().all(|p| bounds.contains(*p)) {
        return false;
    }
    match &part.stroke {
        None => corners.iter().all(|p| part.path.contains(*p)),
        Some(stroke) => {
            let reach = stroke.width / 2.0 + BEYOND * width;
            stroke.dashes.is_empty()
                && corners.iter().all(|p| distance(&part.path, *p, ERROR * width) <= reach)
        }
    }
}

fn distance(path: &BezPath, p: Point, error: f64) -> f64 {
    let nearest = path.segments().map(|s| s.nearest(p, error).distance_sq);
    libm::sqrt(nearest.fold(f64::INFINITY, f64::min))
}
