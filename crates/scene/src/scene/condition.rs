//! Text → condition, such as `category=3|5`, `category=large white`, `area>200` or `inside=disc.svg`.

use crate::scene::{Comparison, Condition, Identity, Quantity};
use std::str::FromStr;
use vtex_base::document::is_category_name;
use vtex_base::error::clip;

/// The names that a condition begins with.
pub const NAMES: [&str; 10] =
    ["category", "library", "id", "motif", "area", "elongation", "x", "y", "inside", "outside"];

/// The syntax of conditions, for messages.
pub const EXPECTED: &str = "category=3, category!=large white, category=3|5, library=1, id=17, motif=4, area>200, \
                            elongation>1.5, x<500, y>=20, inside=FILE, outside=FILE";

/// A fault in the text of a condition.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct ConditionFault {
    /// The fault, in words.
    pub reason: String,
    /// The name that a condition cannot begin with, if that is the fault.
    pub unknown: Option<String>,
}

impl FromStr for Condition {
    type Err = ConditionFault;

    /// Reads a condition, written as in [`EXPECTED`]. Blanks around its parts do not count.
    fn from_str(text: &str) -> Result<Self, ConditionFault> {
        let wrong = |reason: String| ConditionFault { reason, unknown: None };
        let none = || wrong(format!("'{}' is no condition", clip(text.trim())));
        let text = text.trim();
        let (name, rest) = text.split_at(text.find(['=', '!', '<', '>']).ok_or_else(none)?);
        let signs = ["!=", ">=", "<=", "=", ">", "<"];
        let found = signs.into_iter().find_map(|sign| Some((sign, rest.strip_prefix(sign)?.trim())));
        let (sign, value) = found.ok_or_else(none)?;
        let name = name.trim();
        let unfit = || wrong(format!("'{name}' is not compared by '{sign}'"));
        let among = |identity: Identity| {
            let wanted = match sign {
                "=" => true,
                "!=" => false,
                _ => return Err(unfit()),
            };
            let numbers: Result<Vec<u32>, _> = value.split('|').map(|v| v.trim().parse()).collect();
            let mut numbers = numbers.map_err(|_| wrong(format!("'{}' is no whole number", clip(value))))?;
            // Scenes store indices, from 0.
            let first = identity.first_number();
            for number in &mut numbers {
                let index = number.checked_sub(first);
                *number = index.ok_or_else(|| wrong(format!("'{name}' is numbered from {first}")))?;
            }
            Ok(Self::Among { identity, numbers, wanted })
        };
        let category = || {
            let items: Vec<&str> = value.split('|').map(str::trim).collect();
            if items.iter().all(|item| item.parse::<u32>().is_ok()) {
                return among(Identity::Category);
            }
            if let Some(item) = items.iter().find(|item| !is_category_name(item)) {
                return Err(wrong(format!(
                    "'{}' is neither the name nor the number of a category",
                    clip(item)
                )));
            }
            let categories = items.into_iter().map(str::to_owned).collect();
            match sign {
                "=" | "!=" => Ok(Self::Named { categories, wanted: sign == "=" }),
                _ => Err(unfit()),
            }
        };
        let compare = |quantity| {
            let comparison = match sign {
                ">" => Comparison::More,
                ">=" => Comparison::AtLeast,
                "<" => Comparison::Less,
                "<=" => Comparison::AtMost,
                _ => return Err(unfit()),
            };
            let limit = value.parse::<f64>().ok().filter(|v| v.is_finite());
            let limit = limit.ok_or_else(|| wrong(format!("'{}' is no number", clip(value))))?;
            Ok(Self::Compare { quantity, comparison, limit })
        };
        let place = |inside| match (sign, value) {
            ("=", "") => Err(wrong(format!("'{name}=' names no file"))),
            ("=", shape) => Ok(Self::Place { shape: shape.to_owned(), inside }),
            _ => Err(unfit()),
        };
        match name {
            "category" => category(),
            "library" => among(Identity::Library),
            "id" => among(Identity::Id),
            "motif" => among(Identity::Motif),
            "area" => compare(Quantity::Area),
            "elongation" => compare(Quantity::Elongation),
            "x" => compare(Quantity::X),
            "y" => compare(Quantity::Y),
            "inside" => place(true),
            "outside" => place(false),
            _ => Err(ConditionFault {
                reason: format!("'{}' is nothing that elements have", clip(name)),
                unknown: Some(name.to_owned()),
            }),
        }
    }
}
