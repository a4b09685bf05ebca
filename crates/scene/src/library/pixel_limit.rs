//! A limit of pixels in JSON: `off`, or a number.

#[cfg(feature = "schema")]
use super::AnalyzeParams;
use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};
use std::fmt;

/// Writes 0 as `off`.
pub(super) fn serialize<S: Serializer>(limit: &u32, serializer: S) -> Result<S::Ok, S::Error> {
    if *limit == 0 { serializer.serialize_str("off") } else { serializer.serialize_u32(*limit) }
}

/// Reads `off` as 0.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    struct PixelLimitVisitor;
    impl Visitor<'_> for PixelLimitVisitor {
        type Value = u32;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("off, or a number of pixels")
        }

        fn visit_u64<E: Error>(self, number: u64) -> Result<u32, E> {
            u32::try_from(number).map_err(E::custom)
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<u32, E> {
            u32::try_from(number).map_err(E::custom)
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<u32, E> {
            if text == "off" { Ok(0) } else { Err(E::custom("expected off, or a number of pixels")) }
        }
    }
    deserializer.deserialize_any(PixelLimitVisitor)
}

/// The schema of such a limit.
#[cfg(feature = "schema")]
pub(super) fn schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({
        "anyOf": [
            {"type": "integer", "minimum": 0, "maximum": AnalyzeParams::MAX_PIXELS.range[1]},
            {"const": "off"}
        ]
    })
}
