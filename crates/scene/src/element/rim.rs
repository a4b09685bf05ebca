//! Soft rims: borders that are out of focus.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::Affine;
use vtex_base::raster::colour::Colour;

/// Number of steps in which the opacity of a rim falls to each side. Two are seen as rings when enlarged.
const STEPS: usize = 3;

/// A border that is out of focus: a line along the outline of an element's first shape, above all of its shapes, in a
/// colour between those of both sides. Its opacity falls evenly from the outline to both of its edges, in three steps:
/// it is drawn as nested strokes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SoftRim {
    /// Its width in pixels of the element, half on either side. Above 0, up to 100.
    pub width: f64,
    /// Its colour.
    pub colour: Colour,
    /// Opacity on the outline, 0 to 1, if it had more steps; in the innermost it is five sixths of this.
    pub opacity: f64,
}

impl SoftRim {
    /// Largest permitted width, in pixels.
    pub const WIDEST: f64 = 100.0;

    /// Width and opacity of the strokes that it is drawn as, the widest first.
    pub fn strokes(&self) -> [[f64; 2]; STEPS] {
        std::array::from_fn(|k| {
            // What a stroke adds to those below it.
            let below = k.checked_sub(1).map_or(0.0, |k| self.level(k));
            let opacity = 1.0 - (1.0 - self.level(k)) / (1.0 - below);
            [self.width * (1.0 - k as f64 / STEPS as f64), opacity]
        })
    }

    /// Its opacity at a distance from the outline, in pixels.
    pub fn opacity_at(&self, distance: f64) -> f64 {
        let steps = (1.0 - 2.0 * distance / self.width) * STEPS as f64;
        if steps > 0.0 { self.level((steps as usize).min(STEPS - 1)) } else { 0.0 }
    }

    /// The opacity in a step, counted from the edge.
    fn level(&self, step: usize) -> f64 {
        self.opacity * (step as f64 + 0.5) / STEPS as f64
    }

    /// The rim on an element to which a map is applied: as wide as areas grow, at most [`Self::WIDEST`].
    pub fn moved(&self, affine: Affine) -> Self {
        let size = libm::sqrt(affine.determinant().abs());
        Self { width: (self.width * size).min(Self::WIDEST), ..*self }
    }

    /// The rim at time `t` (0 to 1) between two, of which one may be missing; `None` where nothing is seen of it. Colours
    /// are mixed in Oklab.
    pub fn mixed(one: Option<&Self>, other: Option<&Self>, t: f64) -> Option<Self> {
        let faded = |rim: Option<&Self>, like: &Self| rim.copied().unwrap_or(Self { opacity: 0.0, ..*like });
        let (a, b) = (faded(one, one.or(other)?), faded(other, other.or(one)?));
        let between = |a: f64, b: f64| a + (b - a) * t;
        let opacity = between(a.opacity, b.opacity);
        let (width, colour) = (between(a.width, b.width), a.colour.mixed(b.colour, t));
        (opacity >= 0.01).then_some(Self { width, colour, opacity })
    }

    /// Why the rim is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        if !(self.width > 0.0 && self.width <= Self::WIDEST) {
            return Some(format!("the width of a rim, {}, is not within 0 to {}", self.width, Self::WIDEST));
        }
        let seen = (0.0..=1.0).contains(&self.opacity);
        (!seen).then(|| format!("the opacity of a rim, {}, is not within 0 to 1", self.opacity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_over_one_another_fall_evenly() {
        for opacity in [0.3, 0.9, 1.0] {
            let rim = SoftRim { width: 6.0, colour: Colour([9; 3]), opacity };
            let mut seen = 0.0;
            for (k, [width, own]) in rim.strokes().into_iter().enumerate() {
                assert!((width - (6.0 - 2.0 * k as f64)).abs() < 1e-12);
                seen += own * (1.0 - seen);
                assert!((seen - opacity * (k as f64 + 0.5) / 3.0).abs() < 1e-12, "{opacity} {k} {seen}");
                assert!((rim.opacity_at(width / 2.0 - 0.1) - seen).abs() < 1e-12);
                assert!(rim.opacity_at(width / 2.0 + 0.1) < seen);
            }
        }
    }

    #[test]
    fn a_rim_appears_by_its_opacity() {
        let rim = SoftRim { width: 4.0, colour: Colour([90; 3]), opacity: 0.8 };
        assert_eq!(SoftRim::mixed(None, None, 0.5), None);
        assert_eq!(
            SoftRim::mixed(Some(&rim), None, 0.25),
            Some(SoftRim { opacity: 0.6000000000000001, ..rim })
        );
        assert_eq!(SoftRim::mixed(None, Some(&rim), 0.0), None);
        let other = SoftRim { width: 2.0, opacity: 0.4, ..rim };
        assert_eq!(SoftRim::mixed(Some(&rim), Some(&other), 0.5).map(|r| r.width), Some(3.0));
        assert!(rim.fault().is_none());
        assert!(SoftRim { width: f64::NAN, ..rim }.fault().is_some_and(|f| f.contains("width of a rim")));
        assert!(SoftRim { opacity: 1.1, ..rim }.fault().is_some_and(|f| f.contains("opacity of a rim")));
    }
}
