//! The number of categories of primaries.

use super::AnalyzeParams;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The number of categories of primaries. In JSON and on the command line a number, or `auto`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Categories {
    /// As few as the eye tells apart by colour, size and shape, at most [`Categories::MOST_FOUND`]. The default.
    #[default]
    Auto,
    /// This number; fewer where there are fewer different primaries.
    AtMost(u32),
}

fn expected() -> String {
    format!("auto or {}", AnalyzeParams::CATEGORIES)
}

impl Categories {
    /// Most categories that [`Categories::Auto`] makes.
    pub const MOST_FOUND: u32 = 15;

    /// Most categories there may be.
    pub fn most(self) -> usize {
        match self {
            Self::Auto => Self::MOST_FOUND as usize,
            Self::AtMost(number) => number as usize,
        }
    }

    fn checked(number: Option<u32>) -> Result<Self, String> {
        let known = number.filter(|number| AnalyzeParams::CATEGORIES.allows(*number));
        known.map(Self::AtMost).ok_or_else(|| format!("expected {}", expected()))
    }
}

impl FromStr for Categories {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            _ => Self::checked(text.parse().ok()),
        }
    }
}

impl fmt::Display for Categories {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::AtMost(number) => number.fmt(f),
        }
    }
}

impl Serialize for Categories {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::AtMost(number) => serializer.serialize_u32(*number),
        }
    }
}

impl<'de> Deserialize<'de> for Categories {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CategoriesVisitor;
        impl Visitor<'_> for CategoriesVisitor {
            type Value = Categories;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&expected())
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Categories, E> {
                Categories::checked(number.try_into().ok()).map_err(E::custom)
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Categories, E> {
                Categories::checked(number.try_into().ok()).map_err(E::custom)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Categories, E> {
                text.parse().map_err(E::custom)
            }
        }
        deserializer.deserialize_any(CategoriesVisitor)
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Categories {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Categories".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let [low, high] = AnalyzeParams::CATEGORIES.range;
        schemars::json_schema!({
            "description": "How many categories primaries are divided into: a number, or `auto`.",
            "anyOf": [{"type": "integer", "minimum": low, "maximum": high}, {"const": "auto"}]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_or_auto_in_json_and_text() {
        for (value, json) in [(Categories::Auto, "\"auto\""), (Categories::AtMost(15), "15")] {
            assert_eq!(serde_json::to_string(&value).unwrap(), json);
            assert_eq!(serde_json::from_str::<Categories>(json).unwrap(), value);
            assert_eq!(value.to_string().parse(), Ok(value));
        }
        for wrong in ["0", "1001", "-1", "2.5", "\"many\"", "null"] {
            let message = serde_json::from_str::<Categories>(wrong).unwrap_err().to_string();
            assert!(message.contains("auto or 1 to 1000"), "{message}");
        }
    }
}
