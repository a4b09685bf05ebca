//! Area, centroid, orientation and elongation of a shape from its moments up to the second.

use super::{Moments, Outline};
use kurbo::{Affine, Point};

/// Moments of an outline's interior, without its holes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondMoments {
    /// Area, in pixels².
    pub area: f64,
    /// Centroid, in pixels.
    pub centroid: Point,
    /// Mean of x², xy and y² about the centroid, in pixels².
    pub covariance: [f64; 3],
}

impl SecondMoments {
    /// Moments of an outline. If its area is 0, all are 0 except the centroid, which is the middle of its
    /// bounds.
    pub fn new(outline: &Outline) -> Self {
        Moments::new(outline).second
    }

    /// Moments of the transformed shape.
    pub fn moved(&self, affine: Affine) -> Self {
        let [a, b, c, d, ..] = affine.as_coeffs();
        let [xx, xy, yy] = self.covariance;
        Self {
            area: self.area * affine.determinant().abs(),
            centroid: affine * self.centroid,
            covariance: [
                a * a * xx + 2.0 * a * c * xy + c * c * yy,
                a * b * xx + (a * d + b * c) * xy + c * d * yy,
                b * b * xx + 2.0 * b * d * xy + d * d * yy,
            ],
        }
    }

    /// Direction of the major axis, in radians from x towards y, above -π/2 and at most π/2.
    pub fn angle(&self) -> f64 {
        let [xx, xy, yy] = self.covariance;
        libm::atan2(2.0 * xy, xx - yy) / 2.0
    }

    /// Ratio of the major to the minor axis: 1 for a disc or a square.
    pub fn elongation(&self) -> f64 {
        let [xx, xy, yy] = self.covariance;
        let (half, difference) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let root = libm::sqrt(difference * difference + xy * xy);
        let (long, short) = (half + root, half - root);
        if long > 0.0 { libm::sqrt(long / short.max(1e-6 * long)) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    fn of(text: &str) -> SecondMoments {
        SecondMoments::new(&Outline::new(&parse_path(text).unwrap()).unwrap())
    }

    #[test]
    fn moments_of_a_rectangle_with_a_hole() {
        let plain = of("M10 20h6v2h-6z");
        assert!((plain.area - 12.0).abs() < 1e-9 && (plain.elongation() - 3.0).abs() < 1e-9);
        assert!(plain.centroid.distance(Point::new(13.0, 21.0)) < 1e-9 && plain.angle().abs() < 1e-9);
        let [xx, xy, yy] = plain.covariance;
        assert!((xx - 3.0).abs() < 1e-9 && xy.abs() < 1e-9 && (yy - 1.0 / 3.0).abs() < 1e-9);
        let holed = of("M0 0h6v6h-6zM1 1v2h2v-2z");
        assert!((holed.area - 32.0).abs() < 1e-9);
        assert!(holed.centroid.x > 3.0 && (holed.centroid.x - holed.centroid.y).abs() < 1e-9);
        assert_eq!(SecondMoments::new(&Outline::default()).area, 0.0);
    }

    #[test]
    fn moving_the_moments_is_measuring_the_moved() {
        let text = "M0 0c5 1 12 2 9 6c-4 5-11 3-9-6z";
        for affine in [crate::geometry::rotation(0.7), Affine::new([1.5, 0.3, -0.4, -0.8, 40.0, -7.0])] {
            let path = affine * parse_path(text).unwrap();
            let (moved, measured) =
                (of(text).moved(affine), SecondMoments::new(&Outline::new(&path).unwrap()));
            assert!((moved.area - measured.area).abs() < 0.02 * moved.area);
            assert!(moved.centroid.distance(measured.centroid) < 0.05);
            assert!((moved.angle() - measured.angle()).abs() < 0.02);
            assert!((moved.elongation() - measured.elongation()).abs() < 0.02);
        }
    }
}
