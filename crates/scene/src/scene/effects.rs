//! Effects of a placed texton: a shadow underneath it and a stroke along its outline.

use super::Instance;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Rect, Vec2};
use vtex_base::raster::colour::Colour;

/// A black shadow of a texton's outline. It is painted immediately before its texton, so it darkens
/// only what is painted earlier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Shadow {
    /// Offset from the texton along x and y, in pixels of the canvas.
    pub offset: [f64; 2],
    /// Largest opacity, 0 to 1.
    pub opacity: f64,
    /// Width of the soft edge, half inside and half outside, in the texton's own pixels. 0 (sharp) to
    /// 200.
    pub blur: f64,
}

/// A line along a texton's outline, painted over its details.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// Width of the line, half inside and half outside, in the texton's own pixels.
    pub width: f64,
    /// Colour of the line.
    pub colour: Colour,
}

impl Stroke {
    /// Largest permitted width, in pixels.
    pub const WIDEST: f64 = 1e4;
}

impl Shadow {
    /// Largest permitted blur, in pixels.
    pub const WIDEST: f64 = 200.0;

    /// The offset as a vector.
    pub fn shift(&self) -> Vec2 {
        Vec2::new(self.offset[0], self.offset[1])
    }

    fn is_sound(&self) -> bool {
        self.offset.iter().all(|v| v.abs() < 1e7)
            && (0.0..=1.0).contains(&self.opacity)
            && (0.0..=Self::WIDEST).contains(&self.blur)
    }
}

impl Instance {
    /// Bounding box on the canvas of the instance with its shadow and stroke. `texton` is the texton's
    /// bounding box in its own coordinates.
    pub fn reach(&self, texton: Rect) -> Rect {
        let affine = self.affine();
        let around = |margin: f64| affine.transform_rect_bbox(texton.inflate(margin, margin));
        let mut all = around(self.stroke.map_or(0.0, |s| s.width / 2.0));
        if let Some(shadow) = &self.shadow {
            all = all.union(around(shadow.blur) + shadow.shift());
        }
        all
    }

    /// Why the shadow or stroke is invalid; `None` if both are valid.
    pub(super) fn fault(&self) -> Option<&'static str> {
        if self.shadow.is_some_and(|s| !s.is_sound()) {
            return Some("shadow");
        }
        self.stroke.is_some_and(|s| !(s.width > 0.0 && s.width <= Stroke::WIDEST)).then_some("stroke")
    }
}
