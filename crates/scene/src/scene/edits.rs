//! The record of the operations applied to a scene.

use super::operation::{Action, Comparison, Condition, Identity, Operation, Quantity};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::{self, Display, Formatter};

/// A recorded operation on a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EditRecord {
    /// The operation.
    pub operation: Recorded,
    /// The seed of its random choices.
    pub seed: u64,
}

/// An operation that was applied to a scene. As text it reads like `tint amount=0.5 colour=#ff0000 share=1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Recorded {
    /// An operation of `edit`.
    Edit(Operation),
    /// An interpolation between two scenes.
    Interpolation(Between),
    /// A transfer of the appearance of other textures.
    Transfer(Transfer),
}

/// A transfer of appearance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// Exemplars of the other textures.
    pub appearance: Vec<String>,
    /// The mode of the transfer.
    pub mode: TransferMode,
    /// Factor of the size of elements.
    pub scale: f64,
}

/// What elements take over from another texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TransferMode {
    /// The mean colour; shapes and differences between colours stay.
    Mean,
    /// All but place, size and direction: each becomes an element of the other texture.
    #[default]
    Replace,
}

/// A scene between two others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Between {
    /// Exemplars of the first scene.
    pub from: Vec<String>,
    /// Exemplars of the second scene.
    pub to: Vec<String>,
    /// The position between the scenes.
    pub place: Place,
}

/// The position of a scene between two others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// One time for the whole scene, 0 to 1.
    At(f64),
    /// The first scene at one side of the canvas, the second at the other.
    Across(Axis),
    /// The first scene in the middle of the canvas, the second at its sides.
    Radial,
    /// By a map: the first scene where it is black, the second where it is white.
    Map,
}

/// An axis of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// From left to right.
    X,
    /// From top to bottom.
    Y,
}

impl Display for Recorded {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Edit(operation) => operation.fmt(f),
            Self::Transfer(Transfer { appearance, mode, scale }) => {
                write!(f, "transfer appearance={} mode={} scale={scale}", appearance.join("+"), word(mode))
            }
            Self::Interpolation(Between { from, to, place }) => {
                write!(f, "interpolation from={} to={} ", from.join("+"), to.join("+"))?;
                match place {
                    Place::At(share) => write!(f, "at={share}"),
                    Place::Across(axis) => write!(f, "across={}", word(axis)),
                    Place::Radial => f.write_str("morph=radial"),
                    Place::Map => f.write_str("morph=map"),
                }
            }
        }
    }
}

impl Display for Operation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.action.fmt(f)?;
        if let Some(layer) = &self.layer {
            write!(f, " layer={layer}")?;
        }
        for (i, condition) in self.conditions.iter().enumerate() {
            write!(f, "{} {condition}", if i == 0 { " where" } else { "," })?;
        }
        Ok(())
    }
}

impl Display for Action {
    /// The name, then parameters by name.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match serde_json::to_value(self) {
            Ok(Value::Object(named)) => named.iter().try_for_each(|(name, parameters)| {
                f.write_str(name)?;
                let parameters = parameters.as_object().into_iter().flatten();
                parameters.into_iter().try_for_each(|(key, value)| write!(f, " {key}={}", plain(value)))
            }),
            Ok(name) => f.write_str(&plain(&name)),
            Err(_) => Err(fmt::Error),
        }
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Among { identity, numbers, wanted } => {
                let first = u64::from(identity.first_number());
                let numbers: Vec<String> =
                    numbers.iter().map(|n| (u64::from(*n) + first).to_string()).collect();
                let sign = if *wanted { "=" } else { "!=" };
                write!(f, "{}{sign}{}", word::<Identity>(*identity), numbers.join("|"))
            }
            Self::Named { categories, wanted } => {
                let sign = if *wanted { "=" } else { "!=" };
                write!(f, "{}{sign}{}", word(Identity::Category), categories.join("|"))
            }
            Self::Compare { quantity, comparison, limit } => {
                let sign = match comparison {
                    Comparison::Less => "<",
                    Comparison::AtMost => "<=",
                    Comparison::More => ">",
                    Comparison::AtLeast => ">=",
                };
                write!(f, "{}{sign}{limit}", word::<Quantity>(*quantity))
            }
            Self::Place { shape, inside } => {
                write!(f, "{}={shape}", if *inside { "inside" } else { "outside" })
            }
        }
    }
}

/// The name of a unit variant.
fn word<T: Serialize>(value: T) -> String {
    serde_json::to_value(value).map(|v| plain(&v)).unwrap_or_default()
}

/// A JSON value without quotes and brackets; an object as its fields alone.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(","),
        Value::Object(values) => values.values().map(plain).collect::<Vec<_>>().join(","),
        // 1.0 is 1.
        Value::Number(number) => number.as_f64().unwrap_or_default().to_string(),
        Value::Bool(_) | Value::Null => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::colour::Colour;

    #[test]
    fn records_come_back_and_read_plainly() {
        let tint = Action::Tint { colour: Colour([255, 0, 0]).into(), amount: 0.5, share: 1.0 };
        let conditions = vec![
            Condition::Among { identity: Identity::Category, numbers: vec![2, 4], wanted: false },
            Condition::Compare { quantity: Quantity::Area, comparison: Comparison::AtLeast, limit: 20.0 },
            Condition::Place { shape: "a.svg".into(), inside: true },
            Condition::Named { categories: vec!["large white".into(), "3".into()], wanted: false },
        ];
        let tint = Recorded::Edit(Operation { action: tint, layer: Some("primary".into()), conditions });
        let orient =
            Action::Orient { direction: super::super::operation::Direction::Angle(30.0), strength: 1.0 };
        let (from, to) = (vec!["a.png".into(), "b.png".into()], vec!["c.png".into()]);
        let between = Between { from, to, place: Place::Across(Axis::X) };
        for (record, text) in [
            (
                tint,
                "tint amount=0.5 colour=#ff0000 share=1 layer=primary where category!=3|5, area>=20, inside=a.svg, category!=large white|3",
            ),
            (Recorded::Edit(orient.into()), "orient direction=30 strength=1"),
            (Recorded::Edit(Action::Delete.into()), "delete"),
            (Recorded::Interpolation(between), "interpolation from=a.png+b.png to=c.png across=x"),
            (
                Recorded::Transfer(Transfer {
                    appearance: vec!["a.png".into(), "b.png".into()],
                    mode: TransferMode::Mean,
                    scale: 0.5,
                }),
                "transfer appearance=a.png+b.png mode=mean scale=0.5",
            ),
        ] {
            assert_eq!(record.to_string(), text);
            let json = serde_json::to_string(&record).unwrap();
            assert_eq!(serde_json::from_str::<Recorded>(&json).unwrap(), record, "{json}");
        }
    }
}
