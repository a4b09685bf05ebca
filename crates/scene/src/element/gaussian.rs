//! Elements as Gaussians: position, size and direction.
//!
//! Composable textons (Tu, dissertation, chapter 4) describe an element by the mean and the covariance of its
//! pixels (equations 4.3 and 4.4) and a direction. For an outline both are exact. The canonical frame of an
//! element is U^½ · R: its mean at the origin, its covariance the identity and its direction along x. Content
//! drawn in it can be drawn in the frame of any other Gaussian. An instance keeps the direction of its
//! element, so an element has the same frame at every place, even if its shape is symmetric.
//!
//! Degenerate Gaussians, not wider than a pixel or hundreds of times longer than wide, have no frame.
//! Operations leave these elements as they are and count them.

use vtex_base::geometry::{Affine, Moments, Outline, Point, SecondMoments, Vec2};

/// Elongation below which an element has no distinct longer axis.
pub const ROUND: f64 = 1.05;
/// Third moments below this share of the cubed standard deviation define no direction.
const SYMMETRIC: f64 = 1e-3;

/// A Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Its mean, in pixels.
    pub mean: Point,
    /// Its covariance xx, xy, yy, in pixels².
    pub covariance: [f64; 3],
    /// Its direction, of unit length: along the longer axis, towards the longer tail. The direction of a
    /// round shape depends only on its longer tail.
    pub direction: Vec2,
}

impl Gaussian {
    /// Least standard deviation of a Gaussian that is not degenerate, in pixels. That of a strip one pixel
    /// wide is 0.289.
    const THINNEST: f64 = 0.29;
    /// Largest ratio of its axes.
    const LONGEST: f64 = 300.0;

    /// The Gaussian of an outline; `None` if it has no area.
    pub fn new(outline: &Outline) -> Option<Self> {
        let moments = Moments::new(outline);
        let second = moments.second;
        if second.area <= 0.0 {
            return None;
        }
        let [xx, _, yy] = second.covariance;
        let weak = SYMMETRIC * libm::pow(((xx + yy) / 2.0).max(0.0), 1.5);
        let angle = second.angle();
        let axis = Vec2::new(libm::cos(angle), libm::sin(angle));
        let [xxx, xxy, xyy, yyy] = moments.third;
        let tail = Vec2::new(xxx + xyy, xxy + yyy);
        let direction = if second.elongation() >= ROUND {
            if moments.skew([axis.x, axis.y]) < -weak { -axis } else { axis }
        } else if libm::sqrt(tail.hypot2()) > weak {
            tail / libm::sqrt(tail.hypot2())
        } else {
            Vec2::new(1.0, 0.0)
        };
        Some(Self { mean: second.centroid, covariance: second.covariance, direction })
    }

    /// The Gaussian of the shape mapped by `affine`. The direction is mapped too, so that it is the same for
    /// a shape at every place, even if the shape itself defines none.
    pub fn moved(&self, affine: Affine) -> Self {
        let [a, b, c, d, ..] = affine.as_coeffs();
        let Vec2 { x, y } = self.direction;
        let towards = Vec2::new(a * x + c * y, b * x + d * y);
        let moved = self.moments().moved(affine);
        Self { mean: moved.centroid, ..self.with(moved.covariance, towards) }
    }

    /// Its mean and covariance as moments of a shape of no area.
    fn moments(&self) -> SecondMoments {
        SecondMoments { area: 0.0, centroid: self.mean, covariance: self.covariance }
    }

    /// The Gaussian with another covariance, whose direction is the nearest to `towards`.
    pub fn with(&self, covariance: [f64; 3], towards: Vec2) -> Self {
        let of = Self { covariance, ..*self };
        let [long, short] = of.deviations();
        let length = libm::sqrt(towards.hypot2());
        let direction = if long < ROUND * short {
            if length > 0.0 { towards / length } else { self.direction }
        } else {
            let angle = of.angle();
            let axis = Vec2::new(libm::cos(angle), libm::sin(angle));
            if axis.dot(towards) < 0.0 { -axis } else { axis }
        };
        Self { direction, ..of }
    }

    /// Standard deviations along the longer and the shorter axis, in pixels.
    pub fn deviations(&self) -> [f64; 2] {
        let [xx, xy, yy] = self.covariance;
        let (half, difference) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let root = libm::sqrt(difference * difference + xy * xy);
        // The determinant over the larger root has no cancellation.
        let long = half + root;
        let short = if long > 0.0 { (xx * yy - xy * xy) / long } else { 0.0 };
        [long, short].map(|v| libm::sqrt(v.max(0.0)))
    }

    /// Direction of the longer axis, in radians from x towards y, above -π/2 and at most π/2.
    pub fn angle(&self) -> f64 {
        self.moments().angle()
    }

    /// Area of the ellipse of one standard deviation over π, in pixels².
    pub fn size(&self) -> f64 {
        let [long, short] = self.deviations();
        long * short
    }

    /// Whether it is too thin for a frame: not wider than a pixel, or hundreds of times longer than wide.
    pub fn is_degenerate(&self) -> bool {
        let [long, short] = self.deviations();
        let finite = long.is_finite() && self.mean.is_finite();
        !(finite && short > Self::THINNEST && long < Self::LONGEST * short)
    }

    /// The map from the canonical frame to the canvas: mean + U^½ · R, with U the covariance and R the
    /// rotation of the x axis to its direction.
    pub fn frame(&self) -> Affine {
        let [p, q, r] = square_root(self.covariance);
        let Vec2 { x, y } = self.direction;
        let turn = Affine::new([x, y, -y, x, 0.0, 0.0]);
        Affine::new([p, q, q, r, self.mean.x, self.mean.y]) * turn
    }

    /// The map from this Gaussian's frame to that of another.
    pub fn onto(&self, target: &Self) -> Affine {
        target.frame() * self.frame().inverse()
    }

    /// Its value at a point, 1 at the mean: exp(-M²) with M the Mahalanobis distance (equation 4.11).
    pub fn at(&self, point: Point) -> f64 {
        libm::exp(-self.squared_distance(point - self.mean))
    }

    /// The squared Mahalanobis distance of a point from the mean, given its offset.
    pub fn squared_distance(&self, Vec2 { x, y }: Vec2) -> f64 {
        let [xx, xy, yy] = self.covariance;
        (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    }
}

/// The square root of the symmetric matrix xx, xy, yy, by the theorem of Cayley and Hamilton.
pub(super) fn square_root([xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    let determinant = libm::sqrt((xx * yy - xy * xy).max(0.0));
    let trace = libm::sqrt(xx + yy + 2.0 * determinant);
    [(xx + determinant) / trace, xy / trace, (yy + determinant) / trace]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;

    fn outline(text: &str) -> Outline {
        Outline::new(&parse_path(text).unwrap()).unwrap()
    }

    const DROP: &str = "M0 0C30 -20 90 -10 120 10C90 30 30 40 0 20z";

    fn near(a: &Gaussian, b: &Gaussian) -> bool {
        let size = a.covariance[0] + a.covariance[2];
        let alike = a.covariance.iter().zip(b.covariance).all(|(a, b)| (a - b).abs() < 1e-3 * size);
        alike && a.mean.distance(b.mean) < 0.02 && a.direction.dot(b.direction) > 0.999
    }

    #[test]
    fn a_moved_gaussian_is_that_of_the_moved_shape() {
        let own = Gaussian::new(&outline(DROP)).unwrap();
        for affine in [
            vtex_base::geometry::rotation(2.6),
            vtex_base::geometry::rotation(-1.2) * Affine::scale(1.7),
            Affine::translate((40.0, 9.0)) * Affine::FLIP_X,
        ] {
            let moved = Gaussian::new(&Outline::new(&(affine * outline(DROP).path())).unwrap()).unwrap();
            assert!(near(&own.moved(affine), &moved), "{affine:?} {:?} {moved:?}", own.moved(affine));
        }
    }

    #[test]
    fn an_element_stands_in_the_frame_of_any_gaussian() {
        let source = Gaussian::new(&outline(DROP)).unwrap();
        for text in ["M9 9h40v30h-40z", "M0 0C9 -40 30 -40 40 0C30 90 9 70 0 0z", "M5 5l60 30-20 30z"] {
            let target = Gaussian::new(&outline(text)).unwrap();
            let drawn = Outline::new(&(source.onto(&target) * outline(DROP).path())).unwrap();
            let found = Gaussian::new(&drawn).unwrap();
            let size = target.covariance[0] + target.covariance[2];
            let pairs = found.covariance.iter().zip(target.covariance);
            assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-3 * size), "{text}");
            assert!(found.mean.distance(target.mean) < 0.02);
            // The Gaussian mapped by its own inverse frame is the canonical one.
            let unit = source.moved(source.frame().inverse());
            assert!((unit.covariance[0] - 1.0).abs() < 1e-9 && unit.covariance[1].abs() < 1e-9);
            assert!((unit.direction - Vec2::new(1.0, 0.0)).hypot2() < 1e-9 || unit.deviations()[0] < 1.001);
        }
    }

    #[test]
    fn the_direction_follows_a_shape_through_a_whole_turn() {
        for text in [DROP, "M0 0h40v10h-40z", "M0 0h40v40h-40z", "M0 0h40l-20 34z"] {
            let own = Gaussian::new(&outline(text)).unwrap();
            for step in 0..24 {
                let angle = f64::from(step) * std::f64::consts::TAU / 24.0;
                let turned = own.moved(vtex_base::geometry::rotation(angle)).direction;
                let Vec2 { x, y } = own.direction;
                let (s, c) = libm::sincos(angle);
                let wanted = Vec2::new(c * x - s * y, s * x + c * y);
                assert!(turned.dot(wanted) > 0.999, "{text} {angle}");
            }
        }
    }

    #[test]
    fn what_has_no_width_is_degenerate() {
        assert_eq!(Gaussian::new(&Outline::default()), None);
        assert_eq!(Gaussian::new(&outline("M0 0h9z")), None);
        let is = |text: &str| Gaussian::new(&outline(text)).unwrap().is_degenerate();
        assert!(is("M0 0h9v1h-9z") && is("M0 0h9000v2h-9000z") && !is("M0 0h9v2h-9z"));
    }

    #[test]
    fn the_value_falls_with_the_square_of_the_distance() {
        let g = Gaussian::new(&outline("M0 0h12v6h-12z")).unwrap();
        let [long, _] = g.deviations();
        assert_eq!(g.at(g.mean), 1.0);
        let one = g.at(g.mean + Vec2::new(long, 0.0));
        assert!((one - libm::exp(-1.0)).abs() < 1e-12);
    }
}
