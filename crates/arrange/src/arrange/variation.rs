//! Random variations of textons: rotation, reflection and scaling within the ranges of the parameters.

use super::turned::Turned;
use vtex_base::raster::{Mask, Span};
use vtex_base::sampling::stream;
use vtex_scene::scene::SynthParams;

/// Number of variations of each texton: more than a viewer can distinguish. Their shapes are cached.
const COUNT: usize = 32;

/// A variation of a texton: a linear map around its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variation {
    /// Coefficients a b c d: x' = ax + cy, y' = bx + dy.
    pub(crate) matrix: [f64; 4],
    inverse: [f64; 4],
    /// Factor of all lengths.
    pub(crate) scale: f64,
}

const NONE: Variation = Variation { matrix: [1.0, 0.0, 0.0, 1.0], inverse: [1.0, 0.0, 0.0, 1.0], scale: 1.0 };

impl Default for Variation {
    fn default() -> Self {
        NONE
    }
}

impl Variation {
    /// The variations that the parameters allow, and how exemplars are turned by default; the first is the identity.
    /// Angles are spread evenly, every second variation is mirrored.
    pub(crate) fn all(params: &SynthParams, turned: Option<Turned>) -> Vec<Self> {
        let angle = params.rotate.or(turned.map(Turned::angle)).unwrap_or(0.0);
        let mirror = params.mirror || turned.is_some();
        if angle == 0.0 && params.scale_jitter == 0.0 {
            let mirrored = Self::new(0.0, true, 1.0);
            return if mirror { vec![NONE, mirrored] } else { vec![NONE] };
        }
        let mut random = stream(params.seed, "synth/variations", 0);
        let jitter = params.scale_jitter / 100.0;
        let one = |k: usize| {
            // Two variants, one of them mirrored, for each angle.
            let (step, pairs) = if mirror { (k / 2, COUNT / 2) } else { (k, COUNT) };
            let share = (step as f64 + random.unit()) / pairs as f64;
            let turn = (2.0 * share - 1.0) * angle;
            // Reductions and enlargements by the same factor are equally likely.
            let scale = libm::exp(random.range(-1.0, 1.0) * libm::log(1.0 + jitter));
            Self::new(turn.to_radians(), mirror && k % 2 == 1, scale)
        };
        std::iter::once(NONE).chain((1..COUNT).map(one)).collect()
    }

    fn new(angle: f64, mirror: bool, scale: f64) -> Self {
        let (s, c) = libm::sincos(angle);
        let flip = if mirror { -1.0 } else { 1.0 };
        Self::of([scale * c * flip, scale * s * flip, -scale * s, scale * c])
    }

    fn of(matrix: [f64; 4]) -> Self {
        // Adding 0 makes 0 of -0, which documents do not keep.
        let matrix = matrix.map(|v| v + 0.0);
        let [a, b, c, d] = matrix;
        let det = a * d - b * c;
        let scale = libm::sqrt(det.abs());
        Self { matrix, inverse: [d / det, -b / det, -c / det, a / det], scale }
    }

    /// The variation followed by a symmetric map with the coefficients xx, xy, yy.
    pub(crate) fn then(&self, [xx, xy, yy]: [f64; 3]) -> Self {
        let [a, b, c, d] = self.matrix;
        Self::of([xx * a + xy * b, xy * a + yy * b, xx * c + xy * d, xy * c + yy * d])
    }

    /// Whether it is the identity.
    pub(crate) fn is_none(&self) -> bool {
        self.matrix == NONE.matrix
    }

    /// Largest factor of a length along an axis, including the room that a rotated box needs.
    pub(crate) fn growth(&self) -> f64 {
        if self.is_none() { 1.0 } else { self.scale * std::f64::consts::SQRT_2 }
    }

    /// Maps a place, relative to the origin, to whole pixels.
    pub(crate) fn mapped_pixel(&self, place: [i32; 2]) -> [i32; 2] {
        apply(&self.matrix, place.map(f64::from)).map(|v| libm::round(v) as i32)
    }

    /// Maps a point, relative to the origin.
    pub(crate) fn of_point(&self, point: [f64; 2]) -> [f64; 2] {
        apply(&self.matrix, point)
    }

    /// The source pixel of a pixel, both relative to the origin.
    pub(crate) fn source_pixel(&self, pixel: [i32; 2]) -> [i32; 2] {
        apply(&self.inverse, pixel.map(|v| f64::from(v) + 0.5)).map(|v| libm::floor(v) as i32)
    }

    /// Applies the variation to a mask around the origin: every pixel whose centre is mapped from within the mask.
    pub(crate) fn of_mask(&self, mask: &Mask) -> Mask {
        let Some((x0, y0, x1, y1)) = mask.bounds() else { return mask.clone() };
        if self.is_none() {
            return mask.clone();
        }
        let corners = [[x0, y0], [x1, y0], [x0, y1], [x1, y1]].map(|p| apply(&self.matrix, p.map(f64::from)));
        let low = |k: usize| libm::floor(corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min)) as i32;
        let high =
            |k: usize| libm::ceil(corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max)) as i32;
        let mut spans = Vec::new();
        for y in low(1)..high(1) {
            let inside = |x: i32| {
                let [u, v] = self.source_pixel([x, y]);
                mask.contains(u, v)
            };
            spans.extend((low(0)..high(0)).filter(|&x| inside(x)).map(|x| Span { y, x0: x, x1: x + 1 }));
        }
        let varied = Mask::from_spans(spans);
        // A reduced speck may contain no pixel centre.
        if varied.is_empty() { mask.clone() } else { varied }
    }
}

fn apply([a, b, c, d]: &[f64; 4], [x, y]: [f64; 2]) -> [f64; 2] {
    [a * x + c * y, b * x + d * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(rotate: f64, mirror: bool, scale_jitter: f64) -> SynthParams {
        SynthParams { rotate: Some(rotate), mirror, scale_jitter, ..SynthParams::default() }
    }

    #[test]
    fn within_what_is_allowed() {
        assert_eq!(Variation::all(&params(0.0, false, 0.0), None), [NONE]);
        assert_eq!(Variation::all(&params(0.0, true, 0.0), None)[1].matrix, [-1.0, -0.0, -0.0, 1.0]);
        for (rotate, mirror, jitter) in [(30.0, false, 0.0), (180.0, true, 20.0), (0.0, true, 50.0)] {
            let all = Variation::all(&params(rotate, mirror, jitter), None);
            assert!(all[0].is_none() && all.len() == COUNT);
            let (mut left, mut right, mut mirrored) = (false, false, 0);
            for v in &all {
                let [a, b, c, d] = v.matrix;
                let scale = libm::sqrt((a * d - b * c).abs());
                let most = 1.0 + jitter / 100.0;
                assert!(scale <= most + 1e-9 && scale >= 1.0 / most - 1e-9, "{scale}");
                let angle = libm::atan2(-c, d).to_degrees();
                assert!(angle.abs() <= rotate + 1e-9, "{angle}");
                left |= angle < -0.4 * rotate;
                right |= angle > 0.4 * rotate;
                mirrored += usize::from(a * d - b * c < 0.0);
            }
            assert!(rotate == 0.0 || (left && right));
            assert_eq!(mirrored, if mirror { COUNT / 2 } else { 0 });
        }
    }

    #[test]
    fn masks_keep_their_area_and_turn_about_the_origin() {
        let bar = Mask::from_spans((-3..3).map(|y| Span { y, x0: -20, x1: 30 }).collect());
        let quarter = Variation::new(std::f64::consts::FRAC_PI_2, false, 1.0);
        assert_eq!(quarter.of_mask(&bar).bounds(), Some((-3, -20, 3, 30)));
        for v in Variation::all(&params(180.0, true, 30.0), None) {
            let varied = v.of_mask(&bar);
            let wanted = f64::from(bar.area()) * v.scale * v.scale;
            assert!((f64::from(varied.area()) / wanted - 1.0).abs() < 0.06, "{} {wanted}", varied.area());
            let (x, y) = varied.centroid().unwrap();
            let [wx, wy] = apply(&v.matrix, [5.0, 0.0]);
            assert!(libm::hypot(x - wx, y - wy) < 0.5);
        }
    }
}
