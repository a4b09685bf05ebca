//! Numbers that users give: their names, ranges, units and defaults.

use crate::error::{Result, check};
use std::fmt::{self, Display};

/// A number that users give. It is displayed as its range, such as `0 to 10 px`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter<T> {
    /// Its name, with hyphens between words.
    pub name: &'static str,
    /// The smallest and the largest permitted value.
    pub range: [T; 2],
    /// Its unit; empty for plain numbers.
    pub unit: &'static str,
    /// Its default, if that is a number.
    pub default: Option<T>,
}

impl<T: Copy + PartialOrd + Display> Parameter<T> {
    /// A number without a default.
    pub const fn new(name: &'static str, range: [T; 2], unit: &'static str) -> Self {
        Self { name, range, unit, default: None }
    }

    /// The number with a default.
    pub const fn or(self, default: T) -> Self {
        Self { default: Some(default), ..self }
    }

    /// The default.
    ///
    /// # Panics
    /// If it has none.
    pub const fn default(&self) -> T {
        self.default.expect("a parameter with a default")
    }

    /// Whether a value lies in the range.
    pub fn allows(&self, value: T) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// Refuses a value out of the range.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`].
    pub fn check(&self, value: T) -> Result<()> {
        check(self.allows(value), self.name, value, self.to_string())
    }

    /// Writes the range into a schema.
    #[cfg(feature = "schema")]
    pub fn limits(self) -> impl schemars::transform::Transform
    where
        T: serde::Serialize,
    {
        move |schema: &mut schemars::Schema| {
            for (key, limit) in ["minimum", "maximum"].into_iter().zip(self.range) {
                schema.insert(key.into(), serde_json::json!(limit));
            }
        }
    }
}

impl<T: Display> Display for Parameter<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = &self.range;
        write!(f, "{low} to {high}{}{}", if self.unit.is_empty() { "" } else { " " }, self.unit)
    }
}
