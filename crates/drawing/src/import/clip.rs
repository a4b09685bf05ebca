//! Clip paths, and the page as one.

use super::read::bezier;
use crate::svg_tree::affine;
use resvg::usvg;
use vtex_base::geometry::{Affine, ConvexPolygon, Rect};

/// The page as a rectangle.
pub(super) fn page([width, height]: [f64; 2]) -> Rect {
    Rect::new(0.0, 0.0, width, height)
}

/// The polygon of a clip path on the page; `None` unless it is one convex polygon.
pub(super) fn polygon(clip: &usvg::ClipPath, map: Affine) -> Option<ConvexPolygon> {
    if clip.clip_path().is_some() {
        return None;
    }
    let map = map * affine(clip.transform());
    let mut group = clip.root();
    let path = loop {
        match group.children() {
            [usvg::Node::Group(inner)] if inner.clip_path().is_none() => group = inner,
            [usvg::Node::Path(path)] => break path,
            _ => return None,
        }
    };
    ConvexPolygon::of_path(&(map * affine(path.abs_transform()) * bezier(path.data())))
}
