//! Messages of the argument parser, in the words of the help.

use super::foreign::styled;
use super::hints::allowed;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error as _;
use std::ffi::OsString;

/// An error of the parser as text. Where a value cannot be read it says what is allowed: of numbers the
/// parser knows their type alone, not their range.
pub(crate) fn text(error: &clap::Error, command: &clap::Command, arguments: &[OsString]) -> String {
    let rendered = error.render().ansi().to_string();
    let own = |context: Option<&ContextValue>| match context {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let foreign = arguments.iter().any(|a| a.to_string_lossy().chars().any(char::is_control));
    // Colours of ours cannot be told from colours of theirs.
    let plain = if foreign { styled(&error.render().to_string()) } else { styled(&rendered) };
    if error.kind() != ErrorKind::ValueValidation {
        return plain;
    }
    let option = own(error.get(ContextKind::InvalidArg));
    let value = own(error.get(ContextKind::InvalidValue));
    let reason = error.source().map(ToString::to_string).unwrap_or_default();
    let (Some(option), Some(_), false) = (option, value, reason.starts_with("expected")) else {
        return plain;
    };
    let name = option.split_whitespace().next().unwrap_or_default().trim_start_matches("--");
    let named = arguments.iter().skip(1).filter_map(|a| command.find_subcommand(a)).next();
    let commands = named.into_iter().chain(command.get_subcommands()).chain([command]);
    let mut options = commands.flat_map(clap::Command::get_arguments);
    let found = options.find(|a| a.get_long() == Some(name)).and_then(|a| a.get_help());
    let Some(range) = found.and_then(|help| allowed(&help.to_string())) else { return plain };
    plain.replacen(&reason, &format!("expected {range}"), 1)
}
