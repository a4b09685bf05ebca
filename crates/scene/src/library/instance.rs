//! Elements at their places in the exemplar.

use super::ElementId;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use vtex_base::geometry::Affine;

/// An element at its place in the exemplar. In JSON an element at the place of its shapes is its index alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "StoredInstance"))]
pub struct ExemplarInstance {
    /// Index in [`Library::elements`](super::Library::elements).
    pub element: ElementId,
    /// Coefficients a b c d e f of the affine map from the element to its place: x' = ax + cy + e, y' = bx +
    /// dy + f. Default: the element is at the place of its shapes.
    pub transform: [f64; 6],
}

/// An instance as files hold it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "ExemplarInstance"))]
#[serde(untagged)]
enum StoredInstance {
    /// Index of an element at the place of its shapes.
    Plain(ElementId),
    /// An element at another place.
    Placed(PlacedInstance),
}

#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
struct PlacedInstance {
    /// Index of the element.
    element: ElementId,
    /// Coefficients a b c d e f of the affine map from the element to its place: x' = ax + cy + e, y' = bx +
    /// dy + f. Default: the element is at the place of its shapes.
    #[serde(default = "identity")]
    transform: [f64; 6],
}

fn identity() -> [f64; 6] {
    Affine::IDENTITY.as_coeffs()
}

impl ExemplarInstance {
    /// An element at the place of its shapes.
    pub fn of(element: ElementId) -> Self {
        Self { element, transform: identity() }
    }
}

impl Serialize for ExemplarInstance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { element, transform } = *self;
        let plain = transform == identity();
        let stored = if plain {
            StoredInstance::Plain(element)
        } else {
            StoredInstance::Placed(PlacedInstance { element, transform })
        };
        stored.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ExemplarInstance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(InstanceVisitor)
    }
}

/// Reads either form without intermediate storage, because libraries hold tens of thousands of instances.
struct InstanceVisitor;

impl<'de> Visitor<'de> for InstanceVisitor {
    type Value = ExemplarInstance;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the index of an element, or an element and a transform")
    }

    fn visit_u64<E: Error>(self, index: u64) -> Result<ExemplarInstance, E> {
        let index =
            u32::try_from(index).map_err(|_| E::custom(format_args!("there is no element {index}")))?;
        Ok(ExemplarInstance::of(ElementId(index)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ExemplarInstance, A::Error> {
        let PlacedInstance { element, transform } =
            PlacedInstance::deserialize(MapAccessDeserializer::new(map))?;
        Ok(ExemplarInstance { element, transform })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_in_its_place_is_its_index() {
        let moved = ExemplarInstance {
            transform: [1.0, 0.0, 0.0, 1.0, 3.5, 0.0],
            ..ExemplarInstance::of(ElementId(2))
        };
        let both = vec![ExemplarInstance::of(ElementId(7)), moved];
        let json = serde_json::to_string(&both).unwrap();
        assert_eq!(json, r#"[7,{"element":2,"transform":[1.0,0.0,0.0,1.0,3.5,0.0]}]"#);
        assert_eq!(serde_json::from_str::<Vec<ExemplarInstance>>(&json).unwrap(), both);
        let spelled = r#"{"element":7}"#;
        assert_eq!(serde_json::from_str::<ExemplarInstance>(spelled).unwrap(), both[0]);
        for wrong in ["-1", "4294967296", r#"{"element":1,"turn":3}"#, "[]", r#""7""#] {
            assert!(serde_json::from_str::<ExemplarInstance>(wrong).is_err(), "{wrong}");
        }
    }
}
