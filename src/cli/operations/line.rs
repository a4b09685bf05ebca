//! Parses the text of an operation.

use super::fault::{self, Fault};
use super::verb::Verb;
use super::words::words;
use crate::cli::failure::Failure;
use crate::cli::nearest::nearest;
use clap::{CommandFactory, Parser};
use vtex::edit::condition::{EXPECTED, NAMES};
use vtex::edit::{Condition, Operation, validate};

/// An operation and its text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ParsedOperation {
    pub(crate) text: String,
    pub(crate) operation: Operation,
}

/// An operation as clap sees it.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true, disable_help_subcommand = true)]
pub(super) struct Line {
    #[command(subcommand)]
    verb: Verb,
    /// only this layer, by its name or role: primary, secondary, background (for colours only); all is every
    /// layer of elements [a name, default: all]
    #[arg(long, global = true, value_name = "NAME", default_value = "all")]
    layer: String,
    /// only elements that meet all conditions: category=3 (or 3|5, !=3, or a name; secondaries have none),
    /// library=1, id=17, motif=4, area>200, elongation>1.5, x<500, y>=20 (with >, <, >= or <=), inside=FILE,
    /// outside=FILE [conditions, with commas between]
    #[arg(long = "where", global = true, value_name = "CONDITIONS", value_delimiter = ',')]
    #[arg(value_parser = condition)]
    conditions: Vec<Condition>,
}

/// A condition of `--where`.
fn condition(text: &str) -> Result<Condition, Fault> {
    text.parse().map_err(|fault: vtex::edit::condition::ConditionFault| {
        let expected = format!("conditions are {EXPECTED}, with commas between");
        let meant = fault.unknown.as_ref().map(|name| format!("did you mean '{}'? ", nearest(name, &NAMES)));
        Fault::new(fault.reason, meant.unwrap_or_default() + &expected)
    })
}

/// All operations as clap sees them.
#[cfg(feature = "studio")]
pub(crate) fn verbs() -> clap::Command {
    Line::command()
}

/// Reads an operation and checks it. `read` gives the bytes of a file by its name; only palettes are
/// read, because the operation holds their colours.
///
/// # Errors A usage error with a correction; errors of `read`.
pub(crate) fn parse(
    text: &str,
    read: impl FnOnce(&str) -> vtex::Result<Vec<u8>>,
) -> anyhow::Result<ParsedOperation> {
    let text = text.trim();
    let refused = |Fault { reason, advice }: Fault| {
        let shown: String = text.chars().take(60).collect();
        Failure::usage(format!("cannot do '{shown}': {reason}")).hint(advice)
    };
    let words = words(text).map_err(refused)?;
    let mut command = Line::command();
    command.build();
    let verb = fault::known_verb(&command, words.first().map_or("", String::as_str)).map_err(refused)?;
    let Line { verb: asked, layer, conditions } =
        Line::try_parse_from(&words).map_err(|e| refused(fault::of_parser(&e, verb)))?;
    asked.check(verb).map_err(refused)?;
    let operation =
        Operation { action: asked.action(read)?, layer: (layer != "all").then_some(layer), conditions };
    validate(&operation).map_err(|e| refused(fault::of_operation(&e, verb)))?;
    Ok(ParsedOperation { text: text.to_owned(), operation })
}
