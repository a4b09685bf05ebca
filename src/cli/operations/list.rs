//! All operations explained, for people.

use super::fault::{usage, value_name};
use super::line::Line;
use clap::{Arg, CommandFactory};
use std::fmt::Write;

/// Names, parameters and examples of all operations.
pub(crate) fn list() -> String {
    let mut text = String::from(
        "Operations of 'vtex edit'. Write each in quotes after --op, and quote words with spaces again.\n\
         Lengths are in pixels of the canvas.\n",
    );
    let line = Line::command();
    for verb in line.get_subcommands() {
        let _ = writeln!(text, "\n{}", usage(verb));
        // The parser takes the last full stop away.
        let does = verb.get_about().map(ToString::to_string).unwrap_or_default();
        wrap(&mut text, &format!("{}.", does.trim_end_matches('.')), 4);
        verb.get_arguments().for_each(|a| describe(&mut text, a));
        let example = verb.get_after_help().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(text, "    Example: --op \"{example}\"");
    }
    text.push_str("\nEvery operation also takes\n");
    line.get_arguments().for_each(|a| describe(&mut text, a));
    text
}

fn describe(text: &mut String, argument: &Arg) {
    let flag = argument.get_long().map(|long| format!("--{long} ")).unwrap_or_default();
    let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
    wrap(text, &format!("{flag}{}  {help}", value_name(argument)), 6);
}

/// Adds a paragraph, indented and wrapped at 100 columns.
fn wrap(text: &mut String, paragraph: &str, indent: usize) {
    let mut column = 0;
    for word in paragraph.split(' ') {
        if column == 0 || column + 1 + word.len() > 100 {
            if column > 0 {
                text.push('\n');
            }
            let margin = if column == 0 { indent } else { indent + 4 };
            let _ = write!(text, "{:margin$}{word}", "");
            column = margin + word.len();
        } else {
            let _ = write!(text, " {word}");
            column += 1 + word.len();
        }
    }
    text.push('\n');
}
