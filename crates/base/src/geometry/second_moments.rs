//! Area, centroid, orientation and elongation of a shape from its moments up to the second.

use super::Outline;
use super::polygon::edges;
use kurbo::{Affine, Point};

/// Largest distance between the curve and the polygon that replaces it, in pixels.
const TOLERANCE: f64 = 0.05;

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
    /// Moments of an outline; all zero if its area is.
    pub fn new(outline: &Outline) -> Self {
        // Green's theorem: sums over polygon edges, relative to a nearby origin.
        let origin = outline.bounds().center();
        let mut sums = [0.0; 6];
        for edge in edges(outline.path().iter(), TOLERANCE) {
            let [[x0, y0], [x1, y1]] = edge.map(|p| [p.x - origin.x, p.y - origin.y]);
            let cross = x0 * y1 - x1 * y0;
            let parts = [
                1.0,
                x0 + x1,
                y0 + y1,
                x0 * x0 + x0 * x1 + x1 * x1,
                x0 * y1 + 2.0 * (x0 * y0 + x1 * y1) + x1 * y0,
                y0 * y0 + y0 * y1 + y1 * y1,
            ];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += cross * part);
        }
        let [doubled, x, y, xx, xy, yy] = sums;
        if doubled.abs() < 1e-9 {
            return Self { centroid: origin, ..Self::default() };
        }
        let (cx, cy) = (x / doubled / 3.0, y / doubled / 3.0);
        let covariance =
            [xx / doubled / 6.0 - cx * cx, xy / doubled / 12.0 - cx * cy, yy / doubled / 6.0 - cy * cy];
        Self { area: doubled.abs() / 2.0, centroid: Point::new(origin.x + cx, origin.y + cy), covariance }
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
