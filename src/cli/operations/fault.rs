//! Faults in the text of an operation, and their corrections.

use crate::cli::nearest::nearest;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command};
use std::error::Error;
use vtex::error::EditFault;

/// A fault and a hint.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{reason}")]
pub(super) struct Fault {
    pub(super) reason: String,
    pub(super) advice: String,
}

impl Fault {
    pub(super) fn new(reason: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { reason: reason.into(), advice: advice.into() }
    }
}

/// The first characters of a hostile text.
pub(super) fn clip(text: &str) -> String {
    text.chars().take(24).collect()
}

/// The operation of a name.
pub(super) fn known_verb<'a>(line: &'a Command, name: &str) -> Result<&'a Command, Fault> {
    let names: Vec<&str> = line.get_subcommands().map(Command::get_name).collect();
    let list = names.join(", ");
    line.get_subcommands().find(|verb| verb.get_name() == name).ok_or_else(|| match name {
        "" => Fault::new("it is empty", format!("the operations are {list}")),
        _ => Fault::new(
            format!("there is no operation '{}'", clip(name)),
            format!("did you mean '{}'? the operations are {list}", nearest(name, &names)),
        ),
    })
}

/// The name of a flag with its hyphens, or that of a positional argument in capitals.
pub(super) fn name(argument: &Arg) -> String {
    argument.get_long().map_or_else(|| value_name(argument), |long| format!("--{long}"))
}

/// The value of a flag.
pub(super) fn value_name(argument: &Arg) -> String {
    argument.get_value_names().into_iter().flatten().map(ToString::to_string).collect()
}

/// How an operation is written, such as `tint COLOUR [--amount NUMBER] [--share NUMBER]`.
pub(super) fn usage(verb: &Command) -> String {
    let own = verb.get_arguments().filter(|a| !a.is_global_set());
    let words = own.map(|a| {
        let flag = a.get_long().map(|long| format!("--{long} ")).unwrap_or_default();
        let word = format!("{flag}{}", value_name(a));
        if a.is_required_set() { word } else { format!("[{word}]") }
    });
    std::iter::once(verb.get_name().to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// The usage of an operation, for messages.
pub(super) fn example(verb: &Command) -> String {
    verb.get_after_help().map(|example| format!("such as: {example}")).unwrap_or_default()
}

/// The fault that the parser finds in an operation.
pub(super) fn of_parser(error: &clap::Error, verb: &Command) -> Fault {
    let context = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(all)) => all.first().cloned().unwrap_or_default(),
        _ => String::new(),
    };
    let given = context(ContextKind::InvalidArg);
    let plain = given.split(' ').next().unwrap_or_default().trim_matches(['<', '>', '[', ']', '.']);
    let value = clip(&context(ContextKind::InvalidValue));
    let written = format!("write it as: {}", usage(verb));
    match error.kind() {
        ErrorKind::UnknownArgument if plain.starts_with("--") => {
            let flags: Vec<String> =
                verb.get_arguments().filter(|a| a.get_long().is_some()).map(name).collect();
            let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
            Fault::new(
                format!("'{}' has no flag '{}'", verb.get_name(), clip(plain)),
                format!("did you mean '{}'? there are {}", nearest(plain, &flags), flags.join(", ")),
            )
        }
        ErrorKind::UnknownArgument => Fault::new(format!("'{}' is one word too many", clip(&given)), written),
        ErrorKind::InvalidValue if value.is_empty() => Fault::new(format!("{plain} needs a value"), written),
        ErrorKind::InvalidValue => {
            let known = match error.get(ContextKind::ValidValue) {
                Some(ContextValue::Strings(known)) => known.iter().map(String::as_str).collect(),
                _ => Vec::new(),
            };
            Fault::new(
                format!("{plain} = {value} is none of {}", known.join(", ")),
                format!("did you mean '{}'?", nearest(&value, &known)),
            )
        }
        ErrorKind::ValueValidation => match error.source() {
            Some(source) => source
                .downcast_ref::<Fault>()
                .cloned()
                .unwrap_or_else(|| Fault::new(format!("{plain} = {value}: {source}"), example(verb))),
            None => Fault::new(format!("{plain} = {value} cannot be"), written),
        },
        ErrorKind::MissingRequiredArgument if plain.contains('|') => {
            // One of several alternatives, which clap separates by bars.
            Fault::new(format!("one of {} is missing", plain.replace('|', ", ")), written)
        }
        ErrorKind::MissingRequiredArgument => Fault::new(format!("{plain} is missing"), written),
        ErrorKind::ArgumentConflict => Fault::new(format!("{plain} is given twice"), "give it once"),
        _ => Fault::new("it cannot be understood", written),
    }
}

/// The fault that the library finds in an operation.
pub(super) fn of_operation(fault: &EditFault, verb: &Command) -> Fault {
    let advice = match fault {
        EditFault::NotForBackground => {
            return Fault::new(
                format!("'{}' cannot be done to the background", verb.get_name()),
                "the background is for tint, recolor, palette",
            );
        }
        EditFault::LikeNothing => "give a drawing or --of, which the others are like".into(),
        EditFault::BackgroundCondition => "its points are told apart by x, y, inside and outside".into(),
        _ => example(verb),
    };
    Fault::new(fault.to_string(), advice)
}
