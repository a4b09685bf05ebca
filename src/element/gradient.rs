//! Linear gradients.

use crate::geometry::{Affine, Point};
use crate::raster::colour::Colour;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A linear gradient in sRGB components, as in SVG: `start` up to the point `from`, `end` beyond the
/// point `to`, linear in between, constant perpendicular to the line from `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Point where the change begins, in the coordinates of the outline that it fills.
    pub from: [f64; 2],
    /// Point where the change ends.
    pub to: [f64; 2],
    /// The colour at `from`.
    pub start: Colour,
    /// The colour at `to`.
    pub end: Colour,
}

impl Gradient {
    /// The gradient of a transformed shape. Exact for transforms that preserve angles.
    pub fn moved(&self, affine: Affine) -> Self {
        let point = |[x, y]: [f64; 2]| {
            let p = affine * Point::new(x, y);
            [p.x, p.y]
        };
        Self { from: point(self.from), to: point(self.to), ..*self }
    }

    /// Why the gradient is invalid; `None` if it is valid.
    pub(crate) fn fault(&self) -> Option<String> {
        let [from, to] = [self.from, self.to];
        let far = [from, to].iter().flatten().any(|v| v.is_nan() || v.abs() >= 1e7);
        (far || from == to).then(|| format!("from {from:?} to {to:?} is no way within 10 million pixels"))
    }
}
