//! Curves: paths that may be open, such as those of strokes.

use super::{Affine, BezPath, PathEl, parse_path, path_text, write_path};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Largest coordinate of a curve, in pixels.
const FAR: f64 = 1e7;

/// A path of open and closed pieces, in pixels. It is serialised as SVG path data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve(BezPath);

impl Curve {
    /// A curve along a path; `None` if a coordinate is not finite or beyond ±10⁷ pixels.
    pub fn new(path: BezPath) -> Option<Self> {
        let fine = |p: &kurbo::Point| p.x.abs() < FAR && p.y.abs() < FAR; // false for NaN
        let sound = path.elements().iter().all(|element| match element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => fine(p),
            PathEl::QuadTo(a, p) => fine(a) && fine(p),
            PathEl::CurveTo(a, b, p) => fine(a) && fine(b) && fine(p),
            PathEl::ClosePath => true,
        });
        sound.then_some(Self(path))
    }

    /// The curve as a `kurbo` path.
    pub fn path(&self) -> &BezPath {
        &self.0
    }

    /// The curve with a map applied; `None` if it leads beyond ±10⁷ pixels.
    pub fn moved(&self, affine: Affine) -> Option<Self> {
        Self::new(affine * &self.0)
    }
}

impl Serialize for Curve {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&write_path(&self.0, path_text::STORED))
    }
}

impl<'de> Deserialize<'de> for Curve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<'_, str>>::deserialize(deserializer)?;
        let path = parse_path(&text).map_err(serde::de::Error::custom)?;
        Self::new(path).ok_or_else(|| serde::de::Error::custom("a coordinate of a curve is out of range"))
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Curve {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Curve".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": "string",
            "description": "SVG path data: open and closed pieces of M, L, H, V, C and Z, in pixels",
            "pattern": "^[MmLlHhVvCcZz0-9eE+., -]*$",
        })
    }
}
