//! Outlines as pixels.

use crate::geometry::{Outline, Point, Region};
use crate::raster::{Mask, Span};

/// The pixels whose middles lie inside an outline.
pub(super) fn mask(outline: &Outline) -> Mask {
    if outline.is_empty() {
        return Mask::default();
    }
    let (region, b) = (Region::new(outline), outline.bounds());
    let [x0, y0] = [b.x0, b.y0].map(|v| libm::floor(v) as i32);
    let [x1, y1] = [b.x1, b.y1].map(|v| libm::ceil(v) as i32);
    let inside = |x: i32, y: i32| region.contains(Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
    let row = |y: i32| (x0..x1).filter(move |&x| inside(x, y)).map(move |x| Span { y, x0: x, x1: x + 1 });
    Mask::from_spans((y0..y1).flat_map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    #[test]
    fn pixels_are_those_whose_middles_are_inside() {
        let outline = Outline::new(&parse_path("M-2.6 1H4.4V5H-2.6ZM0 2V4H2V2Z").unwrap()).unwrap();
        let mask = mask(&outline);
        assert_eq!(mask.bounds(), Some((-3, 1, 4, 5)));
        assert_eq!(mask.area(), 7 * 4 - 4);
        assert!(!mask.contains(1, 3) && mask.contains(2, 3));
    }
}
