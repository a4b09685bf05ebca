//! Whole elements, each mapped gently onto the pixels of an instance.
//!
//! The map is the least deforming one that gives an element the spread of the instance: the symmetric matrix that
//! takes one covariance of pixels to the other (the optimal transport between two normal distributions; Dowson and
//! Landau, "The Fréchet Distance between Multivariate Normal Distributions", 1982). Its stretch is kept small, so that
//! nobody sees it. A mapped element is one thing with one surface, unlike one that is fused of the parts of others.

use crate::arrange::variation::Variation;
use vtex_base::geometry::Affine;
use vtex_base::raster::Mask;
use vtex_scene::library::ExemplarElement;

/// Least and greatest stretch along an axis.
pub(super) const STRETCH: [f64; 2] = [0.88, 1.14];

/// Coefficients of a symmetric matrix: xx, xy, yy.
type Symmetric = [f64; 3];

/// Where the pixels of a mask lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    pub(super) middle: [f64; 2],
    covariance: Symmetric,
}

impl Moments {
    /// `None` for a mask without pixels.
    pub(super) fn of(mask: &Mask) -> Option<Self> {
        let (x, y) = mask.centroid()?;
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        for span in mask.spans() {
            let n = f64::from(span.len());
            // A run of pixels from its middle; the variance of n pixels in a row is (n² - 1) / 12, of each 1 / 12.
            let [u, v] = [(f64::from(span.x0) + f64::from(span.x1)) / 2.0 - x, f64::from(span.y) + 0.5 - y];
            xx += n * (u * u + n * n / 12.0);
            xy += n * u * v;
            yy += n * (v * v + 1.0 / 12.0);
        }
        let area = f64::from(mask.area());
        Some(Self { middle: [x, y], covariance: [xx, xy, yy].map(|sum| sum / area) })
    }

    /// The moments after a variation about the origin.
    pub(super) fn varied(&self, variation: &Variation) -> Self {
        let [a, b, c, d] = variation.matrix;
        let [xx, xy, yy] = self.covariance;
        // M C Mᵀ with M = (a c, b d).
        let covariance = [
            a * a * xx + 2.0 * a * c * xy + c * c * yy,
            a * b * xx + (a * d + b * c) * xy + c * d * yy,
            b * b * xx + 2.0 * b * d * xy + d * d * yy,
        ];
        Self { middle: variation.of_point(self.middle), covariance }
    }

    /// The variance along a direction of length 1.
    pub(super) fn variance(&self, [x, y]: [f64; 2]) -> f64 {
        let [xx, xy, yy] = self.covariance;
        x * x * xx + 2.0 * x * y * xy + y * y * yy
    }

    /// How many times as long as wide the pixels lie, at least 1.
    pub(super) fn elongation(&self) -> f64 {
        let ([along, across], _) = stretches(self.covariance);
        libm::sqrt(along / across.max(1e-6))
    }

    /// The gentle map that brings these moments nearest to others, and its strain: the sum of the logarithms of its
    /// stretches. The stretch that would be needed counts in the strain beyond what is allowed, too.
    pub(super) fn onto(&self, other: &Self) -> (Symmetric, f64) {
        let root = root(self.covariance);
        let wanted = sandwiched(inverse(root), self::root(sandwiched(root, other.covariance)));
        let strain =
            |s: Symmetric| stretches(s).0.iter().map(|v| libm::fabs(libm::log(v.max(1e-6)))).sum::<f64>();
        (gentle(wanted), strain(wanted))
    }
}

/// The map from an exemplar to a place of one of its primaries, relative to which it lies at `at`, varied.
pub(super) fn to_place(primary: &ExemplarElement, variation: &Variation, at: [i32; 2]) -> Affine {
    let [a, b, c, d] = variation.matrix;
    let ([x, y], [u, v]) = (primary.origin().map(f64::from), at.map(f64::from));
    Affine::new([a, b, c, d, u, v]) * Affine::translate((-x, -y))
}

/// The root of a positive matrix.
fn root([a, b, c]: Symmetric) -> Symmetric {
    let s = libm::sqrt((a * c - b * b).max(1e-12));
    let t = libm::sqrt((a + c + 2.0 * s).max(1e-12));
    [(a + s) / t, b / t, (c + s) / t]
}

fn inverse([a, b, c]: Symmetric) -> Symmetric {
    let d = (a * c - b * b).max(1e-12);
    [c / d, -b / d, a / d]
}

/// P Q P.
fn sandwiched(p: Symmetric, q: Symmetric) -> Symmetric {
    let (m, n) = (p[0] * q[0] + p[1] * q[1], p[0] * q[1] + p[1] * q[2]);
    let (k, l) = (p[1] * q[0] + p[2] * q[1], p[1] * q[1] + p[2] * q[2]);
    [m * p[0] + n * p[1], m * p[1] + n * p[2], k * p[1] + l * p[2]]
}

/// The stretches of a symmetric map, the greater first, and cosine and sine of twice the angle of that one.
fn stretches([a, b, c]: Symmetric) -> ([f64; 2], [f64; 2]) {
    let (half, d) = ((a + c) / 2.0, (a - c) / 2.0);
    let r = libm::hypot(d, b);
    let turned = if r > 1e-9 { [d / r, b / r] } else { [1.0, 0.0] };
    ([half + r, half - r], turned)
}

/// A map whose stretches are within the limits.
fn gentle(map: Symmetric) -> Symmetric {
    let ([more, less], [cosine, sine]) = stretches(map);
    let [more, less] = [more, less].map(|v| v.clamp(STRETCH[0], STRETCH[1]));
    let (half, d) = ((more + less) / 2.0, (more - less) / 2.0);
    [half + d * cosine, d * sine, half - d * cosine]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::Span;

    fn ellipse(a: f64, b: f64, turn: f64) -> Mask {
        let (s, c) = libm::sincos(turn);
        let inside = |x: i32, y: i32| {
            let [x, y] = [x, y].map(|v| f64::from(v) + 0.5);
            let (u, v) = ((c * x + s * y) / a, (c * y - s * x) / b);
            u * u + v * v <= 1.0
        };
        let rows = (-60..60).flat_map(|y| (-60..60).map(move |x| (x, y)));
        let spans = rows.filter(|&(x, y)| inside(x, y)).map(|(x, y)| Span { y, x0: x, x1: x + 1 });
        Mask::from_spans(spans.collect())
    }

    #[test]
    fn an_ellipse_is_mapped_onto_another() {
        let (one, other) = (ellipse(30.0, 20.0, 0.3), ellipse(32.0, 18.5, 0.4));
        let (map, strain) = Moments::of(&one).unwrap().onto(&Moments::of(&other).unwrap());
        assert!(strain > 0.05 && strain < 0.3, "{strain}");
        let variation = Variation::default().then(map);
        let there = variation.of_mask(&one);
        let both = f64::from(there.overlap(&other));
        assert!(both / (f64::from(there.area() + other.area()) - both) > 0.96);
        let moments = Moments::of(&one).unwrap().varied(&variation).covariance;
        let wanted = Moments::of(&other).unwrap().covariance;
        assert!((0..3).all(|k| (moments[k] - wanted[k]).abs() < 0.01 * wanted[0]), "{moments:?} {wanted:?}");
    }

    #[test]
    fn no_map_stretches_by_much() {
        for (a, b, turn) in [(50.0, 8.0, 1.0), (12.0, 11.0, 0.0), (55.0, 50.0, 2.0)] {
            let [one, other] =
                [ellipse(30.0, 20.0, 0.3), ellipse(a, b, turn)].map(|mask| Moments::of(&mask).unwrap());
            let (map, strain) = one.onto(&other);
            assert!(stretches(map).0.iter().all(|v| (0.879..1.141).contains(v)), "{map:?}");
            assert!(strain > 0.3, "{strain}");
        }
    }
}
