//! Items → pieces: the connected parts of compound paths.
//!
//! A piece is an outer ring with what lies inside, turned so that the non-zero rule fills it as the path's
//! own rule does.

use super::paint::DrawnPaint;
use super::read::{DrawnFill, DrawnShape, DrawnStroke};
use kurbo::{ParamCurve, PathSeg, Shape as _};
use vtex_base::geometry::{BezPath, Point, Rect, is_simple};

/// Number of rings above which a path is not divided.
const MOST_RINGS: usize = 5_000;

/// A part of the drawing that is never divided: fill and stroke of one connected path, or the two halves of
/// one that was cut by the border of the page.
#[derive(Clone)]
pub(super) struct DrawingPiece {
    /// The painted shapes, in order. Coordinates are those of the page.
    pub(super) parts: Vec<PieceShape>,
    /// Index of its item.
    pub(super) item: usize,
    /// The innermost group that holds it.
    pub(super) group: Option<usize>,
    pub(super) layer: usize,
}

/// A filled area, or a stroked path.
#[derive(Clone)]
pub(super) struct PieceShape {
    pub(super) path: BezPath,
    pub(super) paint: DrawnPaint,
    /// How it is stroked; `None` for an area, filled by the non-zero rule.
    pub(super) stroke: Option<DrawnStroke>,
}

impl PieceShape {
    /// Bounds, with a stroke's width.
    pub(super) fn bounds(&self) -> Rect {
        let reach = self.stroke.as_ref().map_or(0.0, |s| s.width / 2.0);
        self.path.bounding_box().inflate(reach, reach)
    }
}

impl DrawingPiece {
    /// Upper bound of the area of all parts.
    pub(super) fn reach(&self) -> f64 {
        let lengths = |path: &BezPath| -> f64 { path.segments().map(|s| polygon(&s)).sum() };
        let area = |part: &PieceShape| {
            let stroke = part.stroke.as_ref();
            stroke.map_or(f64::INFINITY, |s| {
                s.width * s.miter_limit.clamp(1.5, 10.0) * (lengths(&part.path) + s.width)
            })
        };
        self.parts.iter().map(area).sum()
    }

    /// Bounds of all parts.
    pub(super) fn bounds(&self) -> Rect {
        let mut all = self.parts.iter().map(PieceShape::bounds);
        let first = all.next().unwrap_or_default();
        all.fold(first, |sum, next| sum.union(next))
    }
}

/// Length of the control polygon of a segment.
fn polygon(segment: &PathSeg) -> f64 {
    let c = segment.to_cubic();
    c.p0.distance(c.p1) + c.p1.distance(c.p2) + c.p2.distance(c.p3)
}

/// The pieces of an item; without `split`, the whole item is one piece.
pub(super) fn pieces(number: usize, item: &DrawnShape, split: bool) -> Vec<DrawingPiece> {
    let paths = match &item.fill {
        Some(fill) => filled(&item.path, fill, split),
        None if split => subpaths(&item.path),
        None => vec![item.path.clone()],
    };
    let piece = |path: BezPath| {
        let area = item.fill.as_ref().filter(|_| path.area() != 0.0);
        let area = area.map(|f| PieceShape { path: path.clone(), paint: f.paint.clone(), stroke: None });
        let line = item.stroke.as_ref();
        let line = line.map(|s| PieceShape { path, paint: s.paint.clone(), stroke: Some(s.clone()) });
        let parts: Vec<PieceShape> = area.into_iter().chain(line).collect();
        DrawingPiece { parts, item: number, group: item.group, layer: item.layer }
    };
    paths.into_iter().map(piece).filter(|p| !p.parts.is_empty()).collect()
}

/// Each ring and open line of a path.
pub(super) fn subpaths(path: &BezPath) -> Vec<BezPath> {
    let split = path.elements().chunk_by(|_, next| !matches!(next, kurbo::PathEl::MoveTo(_)));
    split.map(|elements| BezPath::from_vec(elements.to_vec())).filter(|p| p.elements().len() > 1).collect()
}

/// Sample points of a ring, each with the length that it represents.
fn places(ring: &BezPath) -> Vec<(Point, f64)> {
    let mut all: Vec<(Point, f64)> =
        ring.segments().map(|s| (s.eval(0.5), s.start().distance(s.end()))).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(9);
    all
}

/// A ring of a filled path.
struct PathRing {
    path: BezPath,
    area: f64,
    bounds: Rect,
    /// Number of rings around it.
    depth: usize,
    /// The outermost ring around it, or itself.
    outermost: usize,
}

/// The connected pieces of a filled path: outer rings with what lies inside. Filled by the non-zero rule,
/// they cover the same area as the path by its own rule.
fn filled(path: &BezPath, fill: &DrawnFill, split: bool) -> Vec<BezPath> {
    let mut all: Vec<PathRing> = subpaths(path)
        .into_iter()
        .map(|path| {
            let (area, bounds) = (path.area(), path.bounding_box());
            PathRing { path, area, bounds, depth: 0, outermost: 0 }
        })
        .collect();
    all.sort_by(|a, b| b.area.abs().total_cmp(&a.area.abs()));
    if all.len() > MOST_RINGS {
        return vec![path.clone()];
    }
    for i in 0..all.len() {
        all[i].outermost = i;
        let places = places(&all[i].path);
        for k in 0..i {
            let ring = &all[k];
            let near = ring.bounds.overlaps(all[i].bounds);
            let inside = |p: Point| ring.bounds.contains(p) && ring.path.contains(p);
            // Some samples may lie on the ring itself.
            let sum = |all: bool| {
                let counted = places.iter().filter(|(p, _)| all || inside(*p));
                counted.map(|(_, length)| length).sum::<f64>()
            };
            if near && sum(false) > 0.5 * sum(true) {
                all[i].depth += 1;
                if all[i].depth == 1 {
                    all[i].outermost = all[k].outermost;
                }
            }
        }
    }
    // A self-crossing path covers other areas under another rule, or if it is divided.
    let delicate = (fill.even_odd || fill.paint.opacity < 1.0) && !is_simple(path);
    let turned = |ring: &PathRing, outer: f64| {
        let wanted = if fill.even_odd && !delicate {
            ring.depth.is_multiple_of(2)
        } else {
            (ring.area > 0.0) == (outer > 0.0)
        };
        if wanted == (ring.area > 0.0) { ring.path.clone() } else { ring.path.reverse_subpaths() }
    };
    if delicate || !split {
        let outer = all.first().map_or(1.0, |r| r.area);
        return vec![all.iter().flat_map(|ring| turned(ring, outer)).collect()];
    }
    let roots = (0..all.len()).filter(|&i| all[i].depth == 0);
    roots
        .map(|root| {
            let within = all.iter().filter(|ring| ring.outermost == root);
            within.flat_map(|ring| turned(ring, all[root].area)).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;
    use vtex_base::raster::colour::Colour;

    fn of(text: &str, even_odd: bool) -> Vec<f64> {
        let paint = DrawnPaint { colour: Colour([0; 3]), gradient: None, opacity: 1.0 };
        let path = parse_path(text).unwrap();
        filled(&path, &DrawnFill { paint, even_odd }, true).iter().map(BezPath::area).collect()
    }

    #[test]
    fn outer_rings_take_along_what_lies_inside() {
        let ring = "M0 0h10v10h-10zM2 2h6v6h-6zM4 4h2v2h-2z";
        assert_eq!(of(&format!("{ring}M20 0v4h4v-4z"), true), [100.0 - 36.0 + 4.0, 16.0]);
        // With the non-zero rule, rings of one direction do not form a hole.
        assert_eq!(of("M0 0h10v10h-10zM2 2v6h6v-6z", false), [64.0]);
        assert_eq!(of("M0 0v10h10v-10zM2 2h6v6h-6z", false), [64.0]);
    }
}
