//! A number of layers in JSON: `auto`, `off`, or a number.

use super::AnalyzeParams;
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserializer, Serializer};
use std::fmt;

/// Writes 0 as `auto`.
pub(super) fn serialize<S: Serializer>(count: &u32, serializer: S) -> Result<S::Ok, S::Error> {
    if *count == 0 { serializer.serialize_str("auto") } else { serializer.serialize_u32(*count) }
}

/// Reads `auto` as 0 and `off` as 1.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    struct LayerCountVisitor;
    impl Visitor<'_> for LayerCountVisitor {
        type Value = u32;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "auto, off, or {}", AnalyzeParams::LAYERS)
        }

        fn visit_u64<E: Error>(self, number: u64) -> Result<u32, E> {
            u32::try_from(number).map_err(E::custom)
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<u32, E> {
            u32::try_from(number).map_err(E::custom)
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<u32, E> {
            match text {
                "auto" => Ok(0),
                "off" => Ok(1),
                _ => Err(E::invalid_value(Unexpected::Str(text), &self)),
            }
        }
    }
    deserializer.deserialize_any(LayerCountVisitor)
}

/// The schema of such a number.
#[cfg(feature = "schema")]
pub(super) fn schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({
        "anyOf": [
            {"type": "integer", "minimum": 0, "maximum": AnalyzeParams::LAYERS.range[1]},
            {"const": "auto"},
            {"const": "off"}
        ]
    })
}
