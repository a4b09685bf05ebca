//! Ellipses with a soft rim.

use super::gaussian::square_root;
use super::{Gradient, GradientKind, Stop};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Affine, Outline, STEP, SecondMoments};
use vtex_base::raster::colour::Colour;

/// A soft ellipse: the disc around the origin, whose opacity falls from its centre to its rim as a Gaussian
/// does, mapped to a place of the element. It is seen only within the first shape of its element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ellipse {
    /// Its centre, in the coordinates of the element.
    pub centre: [f64; 2],
    /// The symmetric matrix xx, xy, yy that maps the unit disc to it, in pixels. Its eigenvalues are the semi-axes.
    pub matrix: [f64; 3],
}

/// Opacity of a soft ellipse at a share of the way from its centre to its rim: stops of an SVG gradient, linear
/// between them. They follow 0.8 exp(−4 r²).
const FALL_OFF: [[f64; 2]; 7] =
    [[0.0, 0.8], [0.18, 0.703], [0.35, 0.49], [0.52, 0.271], [0.68, 0.126], [0.84, 0.048], [1.0, 0.0]];

impl Ellipse {
    /// Mean opacity over the disc.
    pub const MEAN_OPACITY: f64 = 0.1969;
    /// Longest and shortest permitted semi-axis, in pixels.
    const AXES: [f64; 2] = [0.05, 1e5];

    /// The opacity at a distance from the centre whose square is `square`, in radii.
    pub fn opacity_at(square: f64) -> f64 {
        if square >= 1.0 {
            return 0.0;
        }
        let r = libm::sqrt(square);
        let k = FALL_OFF.iter().position(|[at, _]| *at > r).unwrap_or(FALL_OFF.len() - 1);
        let ([from, a], [to, b]) = (FALL_OFF[k - 1], FALL_OFF[k]);
        a + (b - a) * (r - from) / (to - from)
    }

    /// The paint of the unit disc in one colour.
    pub fn brush(colour: Colour) -> Gradient {
        let [[_, first], between @ .., [_, last]] = FALL_OFF;
        let stop = |[offset, opacity]: [f64; 2]| Stop { offset, colour, opacity };
        Gradient {
            kind: GradientKind::Radial,
            from: [0.0; 2],
            to: [1.0, 0.0],
            start: colour,
            end: colour,
            between: between.map(stop).to_vec(),
            opacities: [first, last],
        }
    }

    /// The ellipse to which a map carries the unit disc around the origin; `None` if it is too flat or too large.
    pub fn new(map: Affine) -> Option<Self> {
        let [a, b, c, d, x, y] = map.as_coeffs();
        Self::of_square([x, y], [a * a + c * c, a * b + c * d, b * b + d * d])
    }

    /// The ellipse around `centre` whose matrix has the square xx, xy, yy, on the grid of outlines; `None` if it is
    /// too flat or too large.
    pub fn of_square(centre: [f64; 2], square: [f64; 3]) -> Option<Self> {
        let matrix = square_root(square);
        // Divided, so that it has two decimals in a file.
        let grid = |v: f64| libm::round(v / STEP) / libm::round(1.0 / STEP);
        let ellipse = Self { centre: centre.map(grid), matrix: matrix.map(grid) };
        ellipse.fault().is_none().then_some(ellipse)
    }

    /// The map of the unit disc around the origin to the ellipse.
    pub fn map(&self) -> Affine {
        let ([xx, xy, yy], [x, y]) = (self.matrix, self.centre);
        Affine::new([xx, xy, xy, yy, x, y])
    }

    /// The ellipse with a map applied.
    pub(super) fn moved(&self, affine: Affine) -> Option<Self> {
        Self::new(affine * self.map())
    }

    /// The ellipse that covers what an outline covers, by its moments; `None` if the outline is degenerate.
    pub(super) fn of_outline(outline: &Outline) -> Option<Self> {
        let SecondMoments { centroid, covariance, .. } = SecondMoments::new(outline);
        // The unit disc has the covariance 1/4.
        Self::of_square([centroid.x, centroid.y], covariance.map(|v| 4.0 * v))
    }

    /// The rim, as four curves.
    pub(super) fn outline(&self) -> Option<Outline> {
        const HANDLE: f64 = 0.552_284_749_8;
        let mut path = kurbo::BezPath::new();
        path.move_to((1.0, 0.0));
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)];
        for pair in corners.windows(2) {
            let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
            let (leave, arrive) =
                ((x0 + HANDLE * x1, y0 + HANDLE * y1), (x1 + HANDLE * x0, y1 + HANDLE * y0));
            path.curve_to(leave, arrive, (x1, y1));
        }
        path.close_path();
        Outline::new(&(self.map() * path))
    }

    /// Why the ellipse is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        let [xx, xy, yy] = self.matrix;
        let (half, rest) = ((xx + yy) / 2.0, libm::hypot((xx - yy) / 2.0, xy));
        let [least, most] = Self::AXES;
        let sound = half - rest >= least && half + rest <= most;
        let near = self.centre.iter().all(|v| v.abs() < 1e7);
        (!sound || !near)
            .then(|| format!("an ellipse at {:?} has semi-axes beyond {least} to {most} pixels", self.centre))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::rotation;

    #[test]
    fn an_ellipse_is_where_its_outline_is() {
        let map = Affine::translate((7.0, -3.0))
            * rotation(0.6)
            * Affine::scale_non_uniform(5.0, 2.0)
            * rotation(1.1);
        let ellipse = Ellipse::new(map).unwrap();
        // The disc turned within itself leaves it as it is.
        let other = Ellipse::new(map * rotation(-0.4)).unwrap();
        let outline = ellipse.outline().unwrap();
        assert!((outline.area() - 10.0 * std::f64::consts::PI).abs() < 0.1);
        let found = Ellipse::of_outline(&outline).unwrap();
        for again in [other, found, ellipse.moved(rotation(0.3)).unwrap().moved(rotation(-0.3)).unwrap()] {
            let off = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02);
            assert!(off(&again.matrix, &ellipse.matrix) && off(&again.centre, &ellipse.centre), "{again:?}");
        }
        assert_eq!(Ellipse::new(Affine::scale_non_uniform(9.0, 0.0)), None);
        assert!(Ellipse { matrix: [f64::NAN, 0.0, 1.0], ..ellipse }.fault().is_some());
    }

    #[test]
    fn the_mean_opacity_is_that_of_the_stops() {
        let steps = 2000;
        let of = |i: i32| {
            let r = (f64::from(i) + 0.5) / f64::from(steps);
            2.0 * r / f64::from(steps) * Ellipse::opacity_at(r * r)
        };
        let mean: f64 = (0..steps).map(of).sum();
        assert!((mean - Ellipse::MEAN_OPACITY).abs() < 5e-4, "{mean}");
        assert_eq!((Ellipse::opacity_at(0.0), Ellipse::opacity_at(1.0)), (0.8, 0.0));
    }
}
