//! Converts outlines to pixels.

use crate::element::Shape;
use vtex_base::geometry::{Interior, Outline, ring_path};
use vtex_base::raster::{Mask, Span, holes};

/// The pixels whose middles lie inside an outline.
pub fn mask(outline: &Outline) -> Mask {
    if outline.is_empty() {
        return Mask::default();
    }
    let (region, b) = (Interior::new(outline), outline.bounds());
    let (y0, y1) = (libm::floor(b.y0) as i32, libm::ceil(b.y1) as i32);
    // The first pixel whose middle is not before a place.
    let first = |x: f64| libm::ceil(x - 0.5) as i32;
    let row = |y: i32| {
        let within = region.intervals(f64::from(y) + 0.5).into_iter();
        within.map(move |[a, b]| Span { y, x0: first(a), x1: first(b) }).filter(|s| s.x0 < s.x1)
    };
    Mask::from_spans((y0..y1).flat_map(row).collect())
}

/// The pixels of shapes.
pub fn of_shapes(shapes: &[Shape]) -> Mask {
    Mask::from_spans(shapes.iter().flat_map(|shape| mask(&shape.outline).spans().to_vec()).collect())
}

/// The pixels of shapes and of their holes, also of those that several shapes enclose together. `mask` is that of the
/// shapes.
pub fn with_holes(shapes: &[Shape], mask: &Mask) -> Mask {
    let between = holes(mask);
    let rings = shapes.iter().flat_map(|shape| shape.outline.polygons(0.25));
    let filled = rings.filter_map(|ring| Outline::new(&ring_path(&ring)));
    // Rings are polygons, which may lack pixels at the border of a curve.
    let all = filled.map(|outline| self::mask(&outline)).chain(between).chain([mask.clone()]);
    Mask::from_spans(all.flat_map(|mask| mask.spans().to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;

    #[test]
    fn pixels_are_those_whose_middles_are_inside() {
        let outline = Outline::new(&parse_path("M-2.6 1H4.4V5H-2.6ZM0 2V4H2V2Z").unwrap()).unwrap();
        let mask = mask(&outline);
        assert_eq!(mask.bounds(), Some((-3, 1, 4, 5)));
        assert_eq!(mask.area(), 7 * 4 - 4);
        assert!(!mask.contains(1, 3) && mask.contains(2, 3));
    }
}
