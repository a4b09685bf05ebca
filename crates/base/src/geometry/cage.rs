//! Warping the plane by a cage, with mean value coordinates (Floater 2003; for arbitrary simple
//! polygons and points outside, Hormann and Floater 2006).
//!
//! Works badly with cages that change strongly within a short distance. The map is smooth inside and
//! exact on the cage, but it may fold where a non-convex cage is bent strongly.

use super::{Outline, is_simple};
use crate::error::{Error, Result};
use kurbo::{ParamCurve, PathEl, PathSeg, Point, Shape, Vec2};

/// Number of segments that a curve of a cage is cut into.
const PIECES: usize = 16;

/// A map of the plane onto itself, given by a polygon before and after deformation.
#[derive(Clone, Debug, PartialEq)]
pub struct Cage {
    before: Vec<Point>,
    after: Vec<Point>,
}

impl Cage {
    /// The map that takes the cage `before` to the cage `after`. Their elements correspond in drawing
    /// order. An element that is a curve in either cage is cut into the same number of segments in both.
    ///
    /// # Errors
    /// [`Error::Cages`] unless both cages are a single simple ring, with the same number of elements,
    /// drawn in the same direction.
    pub fn new(before: &Outline, after: &Outline) -> Result<Self> {
        let names = ["before", "after"];
        for (outline, name) in [before, after].into_iter().zip(names) {
            let starts = |e: &&PathEl| matches!(e, PathEl::MoveTo(_));
            let rings = outline.path().elements().iter().filter(starts).count();
            if rings != 1 {
                return Err(Error::Cages(format!("the cage {name} has {rings} rings, one is needed")));
            }
        }
        let sides = [before, after].map(|outline| outline.path().segments().collect::<Vec<_>>());
        let counts = sides.each_ref().map(Vec::len);
        if counts[0] != counts[1] {
            let [a, b] = counts;
            return Err(Error::Cages(format!("the cage before has {a} sides, the cage after {b}")));
        }
        let (mut from, mut to) = (Vec::new(), Vec::new());
        for (a, b) in sides[0].iter().zip(&sides[1]) {
            let straight = matches!((a, b), (PathSeg::Line(_), PathSeg::Line(_)));
            let pieces = if straight { 1 } else { PIECES };
            for i in 0..pieces {
                let t = i as f64 / pieces as f64;
                from.push(a.eval(t));
                to.push(b.eval(t));
            }
        }
        let areas = [before, after].map(|outline| outline.path().area());
        for ((outline, name), area) in [before, after].into_iter().zip(names).zip(areas) {
            if area == 0.0 || !is_simple(outline.path()) {
                return Err(Error::Cages(format!("the cage {name} crosses itself or encloses nothing")));
            }
        }
        if areas[0] * areas[1] < 0.0 {
            return Err(Error::Cages("the cages are drawn in opposite directions".into()));
        }
        Ok(Self { before: from, after: to })
    }

    /// The map that takes one polygon to another, point by point. Nothing is checked.
    pub fn of_polygons(before: Vec<Point>, after: Vec<Point>) -> Self {
        Self { before, after }
    }

    /// The image of a point. On the cage's sides the map is linear.
    pub fn map(&self, point: Point) -> Point {
        let count = self.before.len();
        let next = |i: usize| if i + 1 == count { 0 } else { i + 1 };
        let spoke = |i: usize| {
            let s = self.before[i] - point;
            (s, libm::sqrt(s.hypot2()))
        };
        let (mut total, mut sum) = (0.0, Vec2::ZERO);
        for i in 0..count {
            let ((a, ra), (b, rb)) = (spoke(i), spoke(next(i)));
            let along = ra * rb + a.dot(b);
            // A side that subtends half a turn contains the point.
            if along <= 1e-12 * ra * rb {
                let share = if ra > 0.0 { ra / (ra + rb) } else { 0.0 };
                return self.after[i].lerp(self.after[next(i)], share);
            }
            // Tangent of half the angle that the side subtends; both its ends use it.
            let tangent = a.cross(b) / along;
            total += tangent / ra + tangent / rb;
            sum += tangent / ra * self.after[i].to_vec2() + tangent / rb * self.after[next(i)].to_vec2();
        }
        (sum / total).to_point()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Affine, parse_path};
    use proptest::prelude::*;

    fn outline(text: &str) -> Outline {
        Outline::new(&parse_path(text).unwrap()).unwrap()
    }

    fn cage(before: &str, after: &str) -> Cage {
        Cage::new(&outline(before), &outline(after)).unwrap()
    }

    /// An L, a comb and a blob with curved sides.
    const CAGES: [&str; 3] = [
        "M0 0H80V30H30V90H0z",
        "M0 0H100V80H80V20H60V80H40V20H20V80H0z",
        "M10 50C10 0 90 0 90 50C90 80 60 60 50 90C40 60 10 80 10 50z",
    ];

    fn distance(a: Point, b: Point) -> f64 {
        libm::hypot(a.x - b.x, a.y - b.y)
    }

    proptest! {
        #[test]
        fn affine_maps_are_reproduced(
            x in -50.0..150.0f64, y in -50.0..150.0f64, which in 0..3usize,
            scale in 0.2..3.0f64, shear in -0.9..0.9f64, turn in 0..8u8,
        ) {
            let before = outline(CAGES[which]);
            let angle = f64::from(turn) * std::f64::consts::FRAC_PI_4;
            let map = Affine::new([libm::cos(angle), libm::sin(angle), -libm::sin(angle), libm::cos(angle), 7.0, -3.0])
                * Affine::new([scale, 0.0, shear, 1.0, 0.0, 0.0]);
            let cage = Cage::new(&before, &Outline::new(&(map * before.path())).unwrap()).unwrap();
            let point = Point::new(x, y);
            // Cages are rounded to a grid; outside, negative coordinates amplify the error.
            prop_assert!(distance(cage.map(point), map * point) < 0.2);
            let still = Cage::new(&before, &before).unwrap();
            prop_assert!(distance(still.map(point), point) < 1e-6);
        }

        #[test]
        fn the_map_is_continuous_across_the_cage(which in 0..3usize, t in 0.0..1.0f64, angle in 0.0..6.3f64) {
            let before = outline(CAGES[which]);
            let bend = |p: Point| Point::new(p.x + 0.2 * p.y, p.y + 12.0 * libm::sin(p.x / 30.0));
            let bent = outline(CAGES[which]).path().elements().iter().map(|e| match *e {
                PathEl::MoveTo(p) => PathEl::MoveTo(bend(p)),
                PathEl::LineTo(p) => PathEl::LineTo(bend(p)),
                PathEl::QuadTo(a, p) => PathEl::QuadTo(bend(a), bend(p)),
                PathEl::CurveTo(a, b, p) => PathEl::CurveTo(bend(a), bend(b), bend(p)),
                PathEl::ClosePath => PathEl::ClosePath,
            }).collect();
            let cage = Cage::new(&before, &Outline::new(&bent).unwrap()).unwrap();
            let sides = cage.before.len() as f64;
            let (i, share) = ((t * sides) as usize, t * sides % 1.0);
            let j = (i + 1) % cage.before.len();
            let on = cage.before[i].lerp(cage.before[j], share);
            // Linear along each side, and continuous across it.
            let wanted = cage.after[i].lerp(cage.after[j], share);
            prop_assert!(distance(cage.map(on), wanted) < 1e-3);
            for step in [1e-2, 1e-4, 1e-6, 1e-8] {
                let near = on + step * Vec2::new(libm::cos(angle), libm::sin(angle));
                prop_assert!(distance(cage.map(near), wanted) < 20.0 * step + 1e-4, "{step}");
            }
        }
    }

    #[test]
    fn corners_go_to_corners() {
        let cage = cage("M0 0H10V10H0z", "M0 0H20L25 15L0 10z");
        for (from, to) in [((0.0, 0.0), (0.0, 0.0)), ((10.0, 10.0), (25.0, 15.0)), ((10.0, 5.0), (22.5, 7.5))]
        {
            assert!(distance(cage.map(from.into()), to.into()) < 1e-9);
        }
        // At the centre of a square all corners weigh the same.
        assert!(distance(cage.map((5.0, 5.0).into()), (11.25, 6.25).into()) < 1e-9);
    }

    #[test]
    fn the_arm_of_a_bent_cage_goes_along() {
        // The lower arm of an L moves; the far end of the other arm hardly does.
        let bent = "M0 0H80V30H30L60 90H30z";
        let cage = cage(CAGES[0], bent);
        assert!(distance(cage.map((75.0, 15.0).into()), (75.0, 15.0).into()) < 1.0);
        let moved = cage.map((15.0, 85.0).into());
        assert!((moved.x - 43.0).abs() < 4.0 && (moved.y - 85.0).abs() < 4.0, "{moved:?}");
    }

    #[test]
    fn both_directions_do() {
        let one = cage("M0 0H10V10H0z", "M0 0H20L25 15L0 10z");
        let other = cage("M0 0V10H10V0z", "M0 0L0 10L25 15L20 0z");
        for point in [(3.0, 4.0), (12.0, -2.0), (0.0, 7.0)] {
            assert!(distance(one.map(point.into()), other.map(point.into())) < 1e-9);
        }
    }

    #[test]
    fn curves_may_take_the_place_of_lines() {
        let cage = cage("M0 0H10V10H0z", "M0 0C3-4 7-4 10 0V10H0z");
        assert!(cage.map((5.0, 0.0).into()).y < -2.9);
        assert!(distance(cage.map((10.0, 5.0).into()), (10.0, 5.0).into()) < 1e-9);
    }

    #[test]
    fn cages_that_do_not_correspond_are_refused() {
        let square = "M0 0H10V10H0z";
        for (after, message) in [
            ("M0 0H10V10L5 12L0 10z", "the cage before has 4 sides, the cage after 5"),
            ("M0 0V10H10V0z", "opposite directions"),
            ("M0 0L10 10H0L10 0z", "the cage after crosses itself"),
            ("M0 0H10V10H0zM2 2h3v3z", "the cage after has 2 rings"),
            ("", "the cage after has 0 rings"),
        ] {
            let error = Cage::new(&outline(square), &outline(after)).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
            assert!(error.hint().is_some());
        }
        assert!(Cage::new(&outline(square), &outline("M0 0L10 0L20 0L30 0z")).is_err());
    }
}
