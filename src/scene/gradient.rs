//! Colours that change along a line.

use crate::geometry::{Affine, Point};
use crate::raster::colour::Colour;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A colour that changes linearly, in sRGB components as viewers of SVG do: `start` up to the point
/// `from`, `end` from the point `to` on, between them along lines at right angles to the way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Where the change begins, in the coordinates of the outline it fills.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// The colour at `from`.
    pub start: Colour,
    /// The colour at `to`.
    pub end: Colour,
}

impl Gradient {
    /// The gradient of a moved shape. Exact for moves that keep angles.
    pub fn moved(&self, affine: Affine) -> Self {
        let point = |[x, y]: [f64; 2]| {
            let p = affine * Point::new(x, y);
            [p.x, p.y]
        };
        Self { from: point(self.from), to: point(self.to), ..*self }
    }

    /// Why it cannot be painted; nothing if it can.
    pub(crate) fn fault(&self) -> Option<String> {
        let [from, to] = [self.from, self.to];
        let far = [from, to].iter().flatten().any(|v| v.is_nan() || v.abs() >= 1e7);
        (far || from == to).then(|| format!("from {from:?} to {to:?} is no way within 10 million pixels"))
    }
}
