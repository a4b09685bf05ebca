//! Pieces → shapes of elements.

use super::pieces::{DrawingPiece, PieceShape};
use super::read::DrawnStroke;
use kurbo::Shape as _;
use resvg::usvg::{LineCap, LineJoin};
use vtex_base::geometry::{Affine, BezPath, Curve, Outline, PathEl, Point, STEP};
use vtex_scene::element::{Cap, Join, Line, Shape};

/// The shapes of a piece in pixels of the library; `map` is the map from the page. Parts that vanish are left
/// out.
pub(super) fn shapes(piece: &DrawingPiece, map: Affine) -> Vec<Shape> {
    piece.parts.iter().filter_map(|part| shape(part, map)).collect()
}

fn shape(part: &PieceShape, map: Affine) -> Option<Shape> {
    let path = map * part.path.clone();
    let base = match &part.stroke {
        Some(stroke) => {
            let size = libm::sqrt(map.determinant().abs());
            Shape::stroked(line(&on_grid(&path), stroke, size)?, part.paint.colour)?
        }
        None => Shape::new(Outline::new(&path)?, part.paint.colour),
    };
    let drawn = base.outline.bounds();
    if base.outline.is_empty() || drawn.width() <= 0.0 || drawn.height() <= 0.0 {
        return None;
    }
    let gradient = part.paint.gradient.as_ref().and_then(|g| g.drawn(map));
    Some(Shape { gradient, opacity: part.paint.opacity.clamp(0.0, 1.0), ..base })
}

/// A path on the grid of outlines, as files store it.
fn on_grid(path: &BezPath) -> BezPath {
    let snap = |p: Point| Point::new(libm::round(p.x / STEP) * STEP, libm::round(p.y / STEP) * STEP);
    path.iter()
        .map(|element| match element {
            PathEl::MoveTo(p) => PathEl::MoveTo(snap(p)),
            PathEl::LineTo(p) => PathEl::LineTo(snap(p)),
            PathEl::QuadTo(a, p) => PathEl::QuadTo(snap(a), snap(p)),
            PathEl::CurveTo(a, b, p) => PathEl::CurveTo(snap(a), snap(b), snap(p)),
            PathEl::ClosePath => PathEl::ClosePath,
        })
        .collect()
}

/// A stroke along a path, its lengths `size` times as large.
pub(super) fn line(path: &BezPath, stroke: &DrawnStroke, size: f64) -> Option<Line> {
    let short = |v: f64| libm::round(v * 1e4) / 1e4;
    let width = short(stroke.width * size).clamp(1e-3, Line::WIDEST);
    Some(Line {
        width,
        cap: match stroke.cap {
            LineCap::Butt => Cap::Butt,
            LineCap::Round => Cap::Round,
            LineCap::Square => Cap::Square,
        },
        join: match stroke.join {
            LineJoin::Miter | LineJoin::MiterClip => Join::Miter,
            LineJoin::Round => Join::Round,
            LineJoin::Bevel => Join::Bevel,
        },
        miter_limit: stroke.miter_limit.clamp(1.0, 1e6),
        dashes: stroke.dashes.iter().map(|d| short(d * size)).collect(),
        dash_offset: short(stroke.dash_offset * size),
        ..Line::new(Curve::new(path.clone())?, width)
    })
}

/// Whether a part paints any area of the page.
pub(super) fn is_visible(part: &PieceShape) -> bool {
    let opaque = part.paint.opacity > 0.0;
    opaque && (part.stroke.is_some() || part.path.area() != 0.0 || part.path.bounding_box().area() > 0.0)
}
