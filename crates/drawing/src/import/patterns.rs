//! Patterns that fill shapes: their copies, and the page of a drawing that is nothing but a pattern.

use super::read::bezier;
use crate::svg_tree::{affine, within};
use kurbo::Shape as _;
use resvg::usvg;
use vtex_base::geometry::{Affine, ConvexPolygon, Rect};

/// Most copies of a pattern in a shape.
const MOST_COPIES: f64 = 10_000.0;

/// From the contents of a pattern to the page, for the copy at its origin. `place` is the map of the filled shape.
pub(super) fn map(pattern: &usvg::Pattern, place: Affine) -> Affine {
    let [x, y] = [pattern.rect().x(), pattern.rect().y()].map(f64::from);
    place * affine(pattern.transform()) * Affine::translate((x, y))
}

/// The part of a pattern that repeats, in the coordinates of its contents.
fn tile(pattern: &usvg::Pattern) -> Rect {
    Rect::new(0.0, 0.0, f64::from(pattern.rect().width()), f64::from(pattern.rect().height()))
}

/// The maps of all copies of a pattern that reach a convex shape, each with the polygon that clips it; `None` for too many.
pub(super) fn copies(
    pattern: &usvg::Pattern,
    place: Affine,
    shape: Rect,
) -> Option<Vec<(Affine, ConvexPolygon)>> {
    let (map, tile) = (map(pattern, place), tile(pattern));
    let reach = map.inverse().transform_rect_bbox(shape);
    let range = |low: f64, high: f64, side: f64| {
        // Borders that only touch do not count.
        let [first, end] = [libm::floor(low / side + 1e-6), libm::ceil(high / side - 1e-6)];
        (first.is_finite() && end - first <= MOST_COPIES).then_some(first as i64..end as i64)
    };
    let columns = range(reach.x0, reach.x1, tile.width())?;
    let rows = range(reach.y0, reach.y1, tile.height())?;
    if (columns.end - columns.start) as f64 * (rows.end - rows.start) as f64 > MOST_COPIES {
        return None;
    }
    let copy = |(i, j): (i64, i64)| {
        let map = map * Affine::translate((i as f64 * tile.width(), j as f64 * tile.height()));
        Some((map, ConvexPolygon::of_path(&(map * tile.to_path(0.1)))?))
    };
    rows.flat_map(|j| columns.clone().map(move |i| (i, j))).map(copy).collect()
}

/// One copy of the pattern that fills a page.
pub(super) struct RepeatedPart {
    /// From the page to the copy, which it turns upright.
    pub(super) map: Affine,
    pub(super) size: [f64; 2],
    /// Whether the pattern is turned, mirrored or skewed on the page.
    pub(super) is_turned: bool,
}

/// The part of the page that repeats, if the drawing is a pattern that fills the page, over plain areas that do. `None` for
/// any other drawing.
pub(super) fn repeated_part(tree: &usvg::Tree) -> Option<RepeatedPart> {
    let page = Rect::new(0.0, 0.0, f64::from(tree.size().width()), f64::from(tree.size().height()));
    let mut found = Vec::new();
    let is_plain = look(tree.root(), Affine::IDENTITY, page, &mut found);
    let [(own, tile)] = found[..] else { return None };
    let [a, b, c, d, ..] = own.as_coeffs();
    let is_turned = b.abs().max(c.abs()) > 1e-6 * a.abs() || a < 0.0 || d < 0.0;
    let scale = if is_turned { [libm::sqrt(own.determinant().abs()); 2] } else { [a, d] };
    let size = [scale[0] * tile.width(), scale[1] * tile.height()];
    let is_part = is_plain && size[0] < page.width() && size[1] < page.height();
    // The copy in the middle of the page: plain areas lie behind all of it.
    let middle = own.inverse() * page.center();
    let first = |at: f64, side: f64| libm::floor(at / side) * side;
    let origin = (first(middle.x, tile.width()), first(middle.y, tile.height()));
    let copy = own * Affine::translate(origin);
    let map = Affine::scale_non_uniform(scale[0], scale[1]) * copy.inverse();
    is_part.then_some(RepeatedPart { map, size, is_turned })
}

/// Collects the patterns that fill the page, their maps to it and the parts of them that repeat; false for a group of
/// anything but these and plain areas.
fn look(group: &usvg::Group, place: Affine, page: Rect, found: &mut Vec<(Affine, Rect)>) -> bool {
    let map = within(place, group);
    let is_plain = group.mask().is_none()
        && group.clip_path().is_none()
        && group.filters().is_empty()
        && group.blend_mode() == usvg::BlendMode::Normal;
    is_plain
        && group.children().iter().all(|child| match child {
            usvg::Node::Group(inner) => look(inner, map, page, found),
            usvg::Node::Path(path) if path.is_visible() => {
                let covers = ConvexPolygon::of_path(&(map * bezier(path.data())))
                    .is_some_and(|shape| shape.holds(page.inflate(-1e-3, -1e-3)));
                let fill = path.fill().filter(|_| covers && path.stroke().is_none());
                if let Some(usvg::Paint::Pattern(pattern)) = fill.map(usvg::Fill::paint) {
                    found.push((self::map(pattern, map), tile(pattern)));
                }
                fill.is_some()
            }
            usvg::Node::Path(_) => true,
            _ => false,
        })
}
