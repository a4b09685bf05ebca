//! The stretch of contrast before an analysis.

use super::AnalyzeParams;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The factor by which the contrast of a photograph is stretched before it is analysed. In JSON and on the command
/// line `auto`, `off` (a factor of 1) or a number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Contrast {
    /// Measured: 1, except for a picture of few steps of lightness whose structure stands out from its noise. The
    /// default.
    #[default]
    Auto,
    /// This factor, within [`AnalyzeParams::CONTRAST`].
    Gain(f64),
}

fn expected() -> String {
    format!("auto, off, or {}", AnalyzeParams::CONTRAST)
}

impl Contrast {
    /// No stretch.
    pub const OFF: Self = Self::Gain(1.0);

    /// Whether it is the default.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    fn checked(gain: Option<f64>) -> Result<Self, String> {
        let known = gain.filter(|gain| AnalyzeParams::CONTRAST.allows(*gain));
        known.map(Self::Gain).ok_or_else(|| format!("expected {}", expected()))
    }
}

impl FromStr for Contrast {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::OFF),
            _ => Self::checked(text.parse().ok()),
        }
    }
}

impl fmt::Display for Contrast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            &Self::OFF => f.write_str("off"),
            Self::Gain(gain) => gain.fmt(f),
        }
    }
}

impl Serialize for Contrast {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            &Self::OFF => serializer.serialize_str("off"),
            Self::Gain(gain) => serializer.serialize_f64(*gain),
        }
    }
}

impl<'de> Deserialize<'de> for Contrast {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ContrastVisitor;
        impl Visitor<'_> for ContrastVisitor {
            type Value = Contrast;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&expected())
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Contrast, E> {
                Contrast::checked(Some(number)).map_err(E::custom)
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Contrast, E> {
                self.visit_f64(number as f64)
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Contrast, E> {
                self.visit_f64(number as f64)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Contrast, E> {
                text.parse().map_err(E::custom)
            }
        }
        deserializer.deserialize_any(ContrastVisitor)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Contrast {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Contrast".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let [least, most] = AnalyzeParams::CONTRAST.range;
        schemars::json_schema!({
            "anyOf": [
                {"type": "number", "minimum": least, "maximum": most},
                {"const": "auto"},
                {"const": "off"}
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_as_it_is_written() {
        for (text, json) in [("auto", "\"auto\""), ("off", "\"off\""), ("2.5", "2.5")] {
            let contrast: Contrast = text.parse().unwrap();
            assert_eq!(
                (contrast.to_string(), serde_json::to_string(&contrast).unwrap()),
                (text.into(), json.into())
            );
            assert_eq!(serde_json::from_str::<Contrast>(json).unwrap(), contrast);
        }
        assert_eq!(serde_json::from_str::<Contrast>("3").unwrap(), Contrast::Gain(3.0));
        for text in ["", "on", "0.5", "11", "NaN", "-2"] {
            assert!(text.parse::<Contrast>().is_err(), "{text}");
        }
    }
}
