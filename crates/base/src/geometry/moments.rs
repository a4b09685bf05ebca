//! Exact moments of outlines up to the third, by Green's theorem.
//!
//! A moment ∬ xᵖ yᵠ dA is the boundary integral ∮ xᵖ⁺¹ yᵠ dy / (p + 1). On a line or a cubic Bézier curve
//! its integrand is a polynomial, of degree 14 at most, and Gauss–Legendre quadrature with n points is exact
//! up to degree 2n - 1.

use super::{Outline, SecondMoments};
use kurbo::common::{GAUSS_LEGENDRE_COEFFS_3, GAUSS_LEGENDRE_COEFFS_8};
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, PathSeg, Point};

/// Moments of an outline's interior, without its holes, up to the third.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Area, centroid and covariance.
    pub second: SecondMoments,
    /// Mean of x³, x²y, xy² and y³ about the centroid, in pixels³.
    pub third: [f64; 4],
}

impl Moments {
    /// Moments of an outline. If its area is 0, all are 0 except the centroid, which is the middle of its
    /// bounds.
    pub fn new(outline: &Outline) -> Self {
        let origin = outline.bounds().center();
        let mut sums = [0.0; 10];
        for segment in outline.path().segments() {
            add(&mut sums, segment, origin);
        }
        let area = sums[0];
        if area.abs() < 1e-9 {
            let second = SecondMoments { centroid: origin, ..SecondMoments::default() };
            return Self { second, ..Self::default() };
        }
        let [_, x, y, xx, xy, yy, xxx, xxy, xyy, yyy] = sums.map(|sum| sum / area);
        let second = SecondMoments {
            area: area.abs(),
            centroid: Point::new(origin.x + x, origin.y + y),
            covariance: [xx - x * x, xy - x * y, yy - y * y],
        };
        let third = [
            xxx - 3.0 * x * xx + 2.0 * x * x * x,
            xxy - 2.0 * x * xy - y * xx + 2.0 * x * x * y,
            xyy - 2.0 * y * xy - x * yy + 2.0 * y * y * x,
            yyy - 3.0 * y * yy + 2.0 * y * y * y,
        ];
        Self { second, third }
    }

    /// The third moment along a direction of unit length, in pixels³.
    pub fn skew(&self, [x, y]: [f64; 2]) -> f64 {
        let [xxx, xxy, xyy, yyy] = self.third;
        x * x * x * xxx + 3.0 * x * x * y * xxy + 3.0 * x * y * y * xyy + y * y * y * yyy
    }
}

/// Adds the part of a segment to the moments 00, 10, 01, 20, 11, 02, 30, 21, 12 and 03 about an origin.
fn add(sums: &mut [f64; 10], segment: PathSeg, origin: Point) {
    let mut at = |p: Point, dy: f64| {
        let (x, y) = (p.x - origin.x, p.y - origin.y);
        let (w, half, third) = (x * dy, x * x * dy / 2.0, x * x * x * dy / 3.0);
        let fourth = x * x * x * x * dy / 4.0;
        let parts =
            [w, half, w * y, third, half * y, w * y * y, fourth, third * y, half * y * y, w * y * y * y];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    };
    // Weights are those of an interval of length 2.
    match segment {
        PathSeg::Line(line) => {
            for &(weight, x) in GAUSS_LEGENDRE_COEFFS_3 {
                at(line.eval((x + 1.0) / 2.0), weight / 2.0 * (line.p1.y - line.p0.y));
            }
        }
        PathSeg::Quad(_) | PathSeg::Cubic(_) => {
            let curve: CubicBez = segment.to_cubic();
            let slope = curve.deriv();
            for &(weight, x) in GAUSS_LEGENDRE_COEFFS_8 {
                let t = (x + 1.0) / 2.0;
                at(curve.eval(t), weight / 2.0 * slope.eval(t).y);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    fn outline(text: &str) -> Outline {
        Outline::new(&parse_path(text).unwrap()).unwrap()
    }

    #[test]
    fn moments_are_those_of_calculus() {
        // Of a right triangle with legs 6 and 3: from x = 0 to 6 it is x / 2 high.
        let Moments { second, third } = Moments::new(&outline("M10 20h6v3z"));
        assert!((second.area - 9.0).abs() < 1e-9);
        assert!(second.centroid.distance(Point::new(14.0, 21.0)) < 1e-9);
        let wanted = [2.0, 0.5, 0.5];
        assert!(second.covariance.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{second:?}");
        // Mean of (x - 4)³ with density x / 18 on 0 to 6.
        assert!((third[0] + 1.6).abs() < 1e-9, "{third:?}");
        // A shape and its mirror image have opposite third moments.
        let mirrored = Moments::new(&outline("M10 20h-6v3z")).third;
        assert!((mirrored[0] + third[0]).abs() < 1e-9 && (mirrored[1] - third[1]).abs() < 1e-9);
    }

    #[test]
    fn curves_are_integrated_exactly() {
        let text = "M0 0C30 -20 90 10 70 50C50 90 -20 60 0 0zM20 20L20 30L40 30z";
        let exact = Moments::new(&outline(text));
        // The same shape as a polygon of very many sides.
        let fine: String = outline(text)
            .polygons(1e-5)
            .iter()
            .map(|ring| {
                let points: Vec<String> =
                    ring.iter().map(|p| format!("{} {}", p.x * 100.0, p.y * 100.0)).collect();
                format!("M{}z", points.join("L"))
            })
            .collect();
        let polygon = Moments::new(&outline(&fine));
        assert!((exact.second.area - polygon.second.area / 1e4).abs() < 1e-3 * exact.second.area);
        let near = |a: f64, b: f64, size: f64| (a - b).abs() < 1e-4 * size;
        let [xx, _, yy] = exact.second.covariance;
        for (a, b) in exact.second.covariance.iter().zip(polygon.second.covariance) {
            assert!(near(*a, b / 1e4, xx + yy), "{exact:?} {polygon:?}");
        }
        for (a, b) in exact.third.iter().zip(polygon.third) {
            assert!(near(*a, b / 1e6, libm::pow(xx + yy, 1.5)), "{exact:?} {polygon:?}");
        }
    }

    #[test]
    fn the_skew_turns_with_the_shape() {
        let path = parse_path("M0 0C300 -200 900 100 700 500C500 900 -200 600 0 0z").unwrap();
        let own = Moments::new(&Outline::new(&path).unwrap());
        for angle in [0.3, 1.9, 4.0] {
            let turned =
                Moments::new(&Outline::new(&(crate::geometry::rotation(angle) * path.clone())).unwrap());
            let along = |a: f64| [libm::cos(a), libm::sin(a)];
            for direction in [0.0, 0.7, 2.0] {
                let (a, b) = (own.skew(along(direction)), turned.skew(along(direction + angle)));
                assert!((a - b).abs() < 1e-3 * a.abs().max(1e5), "{a} {b}");
            }
        }
        assert_eq!(Moments::new(&Outline::default()).second.area, 0.0);
    }
}
