//! Elements where they stand in the exemplar.

use super::ElementId;
use crate::geometry::Affine;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

/// An element where it stands in the exemplar. In JSON an element that stands where its shapes say is
/// its index alone.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(from = "Stored")]
#[schemars(with = "Stored")]
pub struct Instance {
    /// Index in [`Library::elements`](super::Library::elements).
    pub element: ElementId,
    /// Coefficients a b c d e f of the affine map from the element to its place: x' = ax + cy + e,
    /// y' = bx + dy + f. Default: the element is where its shapes say.
    pub transform: [f64; 6],
}

/// An instance as files hold it.
#[derive(Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Instance")]
#[serde(untagged, expecting = "expected the index of an element, or an element and a transform")]
enum Stored {
    /// Index of an element that stands where its shapes say.
    Plain(ElementId),
    /// An element at another place.
    Placed(Placed),
}

#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Placed {
    /// Index of the element.
    element: ElementId,
    /// Coefficients a b c d e f of the affine map from the element to its place: x' = ax + cy + e,
    /// y' = bx + dy + f. Default: the element is where its shapes say.
    #[serde(default = "identity")]
    transform: [f64; 6],
}

fn identity() -> [f64; 6] {
    Affine::IDENTITY.as_coeffs()
}

impl Instance {
    /// An element where its shapes say.
    pub fn of(element: ElementId) -> Self {
        Self { element, transform: identity() }
    }
}

impl From<Stored> for Instance {
    fn from(stored: Stored) -> Self {
        match stored {
            Stored::Plain(element) => Self::of(element),
            Stored::Placed(Placed { element, transform }) => Self { element, transform },
        }
    }
}

impl Serialize for Instance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { element, transform } = *self;
        let plain = transform == identity();
        let stored =
            if plain { Stored::Plain(element) } else { Stored::Placed(Placed { element, transform }) };
        stored.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_in_its_place_is_its_index() {
        let moved = Instance { transform: [1.0, 0.0, 0.0, 1.0, 3.5, 0.0], ..Instance::of(ElementId(2)) };
        let both = vec![Instance::of(ElementId(7)), moved];
        let json = serde_json::to_string(&both).unwrap();
        assert_eq!(json, r#"[7,{"element":2,"transform":[1.0,0.0,0.0,1.0,3.5,0.0]}]"#);
        assert_eq!(serde_json::from_str::<Vec<Instance>>(&json).unwrap(), both);
        let spelled = r#"{"element":7}"#;
        assert_eq!(serde_json::from_str::<Instance>(spelled).unwrap(), both[0]);
        for wrong in ["-1", r#"{"element":1,"turn":3}"#, "[]", r#""7""#] {
            assert!(serde_json::from_str::<Instance>(wrong).is_err(), "{wrong}");
        }
    }
}
