//! Options that take numbers: their ranges, read and explained.

use clap::Arg;
use std::fmt::Display;
use std::str::FromStr;
use vtex::Parameter;

/// A number that is read from text.
pub(crate) trait Number: FromStr + Copy + PartialOrd + Display + Send + Sync + 'static {}

impl<T: FromStr + Copy + PartialOrd + Display + Send + Sync + 'static> Number for T {}

/// Adds to an option its parser and the description of its values.
pub(crate) trait Takes: Sized {
    /// Appends a description of the option's values, in brackets, to its help.
    fn takes(self, what: impl Display) -> Self;

    /// Takes a number in the range of a parameter. The help ends in range and default.
    fn number<T: Number>(self, parameter: Parameter<T>) -> Self;

    /// As [`Takes::number`], with the default in words.
    fn number_or<T: Number>(self, parameter: Parameter<T>, default: impl Display) -> Self;
}

impl Takes for Arg {
    fn takes(self, what: impl Display) -> Self {
        let told = self.get_help().map(ToString::to_string).unwrap_or_default();
        let ended = format!("{told} [{what}]");
        // A long help begins with the short one.
        let long = self.get_long_help().map(|long| long.to_string().replacen(&told, &ended, 1));
        let argument = self.help(ended).allow_negative_numbers(true);
        match long {
            Some(long) => argument.long_help(long),
            None => argument,
        }
    }

    fn number<T: Number>(self, parameter: Parameter<T>) -> Self {
        let default = parameter.default.map(|default| format!(", default: {default}")).unwrap_or_default();
        reads(self.takes(format_args!("{parameter}{default}")), parameter)
    }

    fn number_or<T: Number>(self, parameter: Parameter<T>, default: impl Display) -> Self {
        reads(self.takes(format_args!("{parameter}, default: {default}")), parameter)
    }
}

/// An option that reads a number in the range of a parameter.
fn reads<T: Number>(argument: Arg, parameter: Parameter<T>) -> Arg {
    let name = if parameter.unit.starts_with("px") { "PX" } else { "NUMBER" };
    argument.value_name(name).value_parser(within(parameter)).hide_default_value(true)
}

/// The parser of a number in the range of a parameter.
pub(crate) fn within<T: Number>(parameter: Parameter<T>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let value = text.parse().ok().filter(|value| parameter.allows(*value));
        value.ok_or_else(|| format!("expected {parameter}"))
    }
}

/// The range at the beginning of what an option takes, as [`Takes::number`] writes it.
#[cfg(feature = "studio")]
pub(crate) fn range_of(takes: &str) -> Option<[f64; 2]> {
    let (least, rest) = takes.split_once(" to ")?;
    let most = rest.split([' ', ',']).next()?;
    Some([least.parse().ok()?, most.parse().ok()?])
}
