//! Ellipses without an edge: shading, and specks.

use super::gaussian::square_root;
use super::{Gradient, GradientKind, Stop};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Affine, Outline, STEP, SecondMoments};
use vtex_base::raster::colour::Colour;

/// A soft ellipse: the disc around the origin, whose opacity falls from its centre to its rim, mapped to a place of
/// the element. It is seen only within the first shape of its element; as the first shape it is the only one, and is
/// seen whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ellipse {
    /// Its centre, in the coordinates of the element.
    pub centre: [f64; 2],
    /// The symmetric matrix xx, xy, yy that maps the unit disc to it, in pixels. Its eigenvalues are the semi-axes.
    pub matrix: [f64; 3],
    /// How its opacity falls from the centre to the rim. Default `soft`.
    #[serde(default, skip_serializing_if = "Profile::is_default")]
    pub profile: Profile,
}

/// How the opacity of an ellipse falls from its centre to its rim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// As a Gaussian does, 0.8 exp(−4 r²): shading.
    #[default]
    Soft,
    /// Opaque up to half of the radius, half at four fifths: a speck in focus.
    Sharp,
}

/// Number of stops.
const STOPS: usize = 7;

impl Profile {
    /// All profiles.
    pub const ALL: [Self; 2] = [Self::Soft, Self::Sharp];

    /// Opacity at a share of the way from the centre to the rim: stops of an SVG gradient, linear between them.
    const fn stops(self) -> [[f64; 2]; STOPS] {
        match self {
            Self::Soft => [
                [0.0, 0.8],
                [0.18, 0.703],
                [0.35, 0.49],
                [0.52, 0.271],
                [0.68, 0.126],
                [0.84, 0.048],
                [1.0, 0.0],
            ],
            Self::Sharp => {
                [[0.0, 1.0], [0.55, 1.0], [0.7, 0.88], [0.8, 0.5], [0.9, 0.12], [0.95, 0.03], [1.0, 0.0]]
            }
        }
    }

    /// Mean opacity over the disc.
    pub const fn mean_opacity(self) -> f64 {
        match self {
            Self::Soft => 0.1969,
            Self::Sharp => 0.6416,
        }
    }

    /// The radius of an opaque disc with the same integral of opacity as the soft unit disc, for formats
    /// without soft paint.
    pub fn opaque_radius(self) -> f64 {
        libm::sqrt(self.mean_opacity())
    }

    /// The opacity at a distance from the centre whose square is `square`, in radii.
    pub fn opacity_at(self, square: f64) -> f64 {
        if square >= 1.0 {
            return 0.0;
        }
        let (r, stops) = (libm::sqrt(square), self.stops());
        let k = stops.iter().position(|[at, _]| *at > r).unwrap_or(STOPS - 1);
        let ([from, a], [to, b]) = (stops[k - 1], stops[k]);
        a + (b - a) * (r - from) / (to - from)
    }

    /// The paint of the unit disc in one colour.
    pub fn brush(self, colour: Colour) -> Gradient {
        let [[_, first], between @ .., [_, last]] = self.stops();
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

    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Ellipse {
    /// Longest and shortest permitted semi-axis, in pixels.
    const AXES: [f64; 2] = [0.05, 1e5];

    /// The ellipse to which a map carries the unit disc around the origin; `None` if it is too flat or too large.
    pub fn new(map: Affine, profile: Profile) -> Option<Self> {
        let [a, b, c, d, x, y] = map.as_coeffs();
        Self::of_square([x, y], [a * a + c * c, a * b + c * d, b * b + d * d], profile)
    }

    /// The ellipse around `centre` whose matrix has the square xx, xy, yy, on the grid of outlines; `None` if it is
    /// too flat or too large.
    pub fn of_square(centre: [f64; 2], square: [f64; 3], profile: Profile) -> Option<Self> {
        let matrix = square_root(square);
        // Divided by a whole number, so that files have two decimals.
        let grid = |v: f64| libm::round(v / STEP) / libm::round(1.0 / STEP);
        let ellipse = Self { centre: centre.map(grid), matrix: matrix.map(grid), profile };
        ellipse.fault().is_none().then_some(ellipse)
    }

    /// The same shape at `factor` times the size, with another profile; `None` if it is too flat or too large.
    pub fn resized(&self, factor: f64, profile: Profile) -> Option<Self> {
        Self::new(self.map() * Affine::scale(factor), profile)
    }

    /// Its shorter and its longer semi-axis, in pixels.
    pub fn semi_axes(&self) -> [f64; 2] {
        let [xx, xy, yy] = self.matrix;
        let (half, rest) = ((xx + yy) / 2.0, libm::hypot((xx - yy) / 2.0, xy));
        [half - rest, half + rest]
    }

    /// The map of the unit disc around the origin to the ellipse.
    pub fn map(&self) -> Affine {
        let ([xx, xy, yy], [x, y]) = (self.matrix, self.centre);
        Affine::new([xx, xy, xy, yy, x, y])
    }

    /// The ellipse with a map applied.
    pub fn moved(&self, affine: Affine) -> Option<Self> {
        Self::new(affine * self.map(), self.profile)
    }

    /// The ellipse with the moments of an outline; `None` if the outline is degenerate.
    pub(super) fn of_outline(outline: &Outline, profile: Profile) -> Option<Self> {
        let SecondMoments { centroid, covariance, .. } = SecondMoments::new(outline);
        // The unit disc has the covariance 1/4.
        Self::of_square([centroid.x, centroid.y], covariance.map(|v| 4.0 * v), profile)
    }

    /// The rim, as four curves.
    pub fn outline(&self) -> Option<Outline> {
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
        let [least, most] = Self::AXES;
        let [short, long] = self.semi_axes();
        let sound = short >= least && long <= most;
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
        let ellipse = Ellipse::new(map, Profile::Sharp).unwrap();
        // A rotation of the disc does not change it.
        let other = Ellipse::new(map * rotation(-0.4), Profile::Sharp).unwrap();
        let outline = ellipse.outline().unwrap();
        assert!((outline.area() - 10.0 * std::f64::consts::PI).abs() < 0.1);
        let found = Ellipse::of_outline(&outline, Profile::Sharp).unwrap();
        for again in [other, found, ellipse.moved(rotation(0.3)).unwrap().moved(rotation(-0.3)).unwrap()] {
            let off = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02);
            assert_eq!(again.profile, Profile::Sharp);
            assert!(off(&again.matrix, &ellipse.matrix) && off(&again.centre, &ellipse.centre), "{again:?}");
        }
        assert_eq!(Ellipse::new(Affine::scale_non_uniform(9.0, 0.0), Profile::Soft), None);
        assert!(Ellipse { matrix: [f64::NAN, 0.0, 1.0], ..ellipse }.fault().is_some());
    }

    #[test]
    fn the_mean_opacity_is_that_of_the_stops() {
        let steps = 2000;
        for profile in Profile::ALL {
            let of = |i: i32| {
                let r = (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * r / f64::from(steps) * profile.opacity_at(r * r)
            };
            let mean: f64 = (0..steps).map(of).sum();
            assert!((mean - profile.mean_opacity()).abs() < 5e-4, "{profile:?}: {mean}");
            assert_eq!(profile.opacity_at(1.0), 0.0);
        }
        assert_eq!(Profile::ALL.map(|p| p.opacity_at(0.0)), [0.8, 1.0]);
    }
}
