//! The whole command line as clap sees it.

use super::commands::Command;
use super::options::global::Global;
use clap::builder::styling::{AnsiColor, Styles};
use clap::{Arg, CommandFactory, Parser};
use std::ffi::OsString;
use std::io::IsTerminal;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Yellow.on_default().bold())
    .usage(AnsiColor::Yellow.on_default().bold())
    .literal(AnsiColor::Green.on_default())
    .placeholder(AnsiColor::Cyan.on_default());

const EXAMPLES: &str = "\
Examples:
  vtex texture photo.jpg -o out.svg --size 1000   photograph to vector texture
  vtex analyze photo.jpg                          photograph to photo.lib.json
  vtex synth photo.lib.json --size 1000x600       library to photo.svg

Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.";

/// The commands precede the options, in groups.
const TEMPLATE: &str = "{about}\n\n{usage-heading} {usage}\n\n{before-help}Options:\n{options}{after-help}";

/// Groups of commands, each from its first command on.
const GROUPS: [(&str, &str); 4] =
    [("texture", "Make"), ("analyze", "Take apart"), ("edit", "Change"), ("metrics", "Judge")];

/// The commands of each group, with what they do.
fn groups(command: &clap::Command) -> String {
    let shown: Vec<_> = command.get_subcommands().filter(|sub| !sub.is_hide_set()).collect();
    let width = shown.iter().map(|sub| sub.get_name().len()).max().unwrap_or(0);
    let line = |sub: &&clap::Command| {
        let name = sub.get_name();
        let title = GROUPS.iter().find(|(first, _)| *first == name).map(|(_, title)| format!("\n{title}:\n"));
        let about = sub.get_about().map(ToString::to_string).unwrap_or_default();
        format!("{}  {name:width$}  {about}\n", title.unwrap_or_default())
    };
    shown.iter().map(line).collect::<String>().trim().to_owned()
}

/// Turn a photograph of a texture into an editable vector texture of any size
#[derive(Parser)]
#[command(name = "vtex", version, styles = STYLES, max_term_width = 100, after_help = EXAMPLES)]
#[command(subcommand_required = true, arg_required_else_help = true, help_template = TEMPLATE)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

const WORK: [&str; 2] = ["seed", "debug_dir"];
const PARAMETERS: [&str; 3] = ["threads", "config", "dump_config"];
const TELLING: [&str; 3] = ["quiet", "verbose", "json"];

/// Options of all commands that mean nothing to one: it takes them, and its help does not show them.
fn idle(command: &str) -> Vec<&'static str> {
    match command {
        "completions" | "man" => [&WORK[..], &PARAMETERS, &TELLING, &["color"]].concat(),
        "models" | "integrate" => [&WORK[..], &PARAMETERS, &TELLING[..2]].concat(),
        "doctor" => [&WORK[..], &PARAMETERS[1..], &TELLING[..2]].concat(),
        "inspect" => [&WORK[..], &PARAMETERS].concat(),
        "render" | "metrics" => WORK.to_vec(),
        "tune" | "edit" | "transfer" | "animate" | "layers" | "raster" => WORK[1..].to_vec(),
        _ => Vec::new(),
    }
}

/// The whole command, from which parser, completions and man pages are made.
pub(crate) fn command() -> clap::Command {
    // `-h` lists what has no heading of its own, `--help` everything.
    let rare = |arg: Arg| {
        let rare = arg.get_help_heading().is_some();
        if rare { arg.hide_short_help(true) } else { arg }
    };
    let command = Cli::command().mut_args(rare);
    let global: Vec<Arg> = command.get_arguments().cloned().collect();
    let command = command.mut_subcommands(|sub| {
        let idle = idle(sub.get_name());
        let hidden = global.iter().filter(|a| idle.contains(&a.get_id().as_str()));
        let hidden: Vec<Arg> = hidden.map(|a| a.clone().hide(true)).collect();
        let sub = sub.args(hidden).mut_args(rare);
        if sub.get_name() != "vectorize" {
            return sub;
        }
        // Categories and descriptors serve placement, and nothing is placed.
        sub.mut_arg("categories", |a| a.hide(true)).mut_arg("descriptor_reach", |a| a.hide(true))
    });
    let text = groups(&command);
    command.before_help(text)
}

/// [`command`], in which nothing else is needed beside `--dump-config`.
pub(crate) fn command_for(arguments: &[OsString]) -> clap::Command {
    let mut command = command();
    if !std::io::stdout().is_terminal() && std::env::var_os("COLUMNS").is_none() {
        command = command.term_width(80);
    }
    if arguments.iter().any(|a| a == "--dump-config") {
        command = command.subcommand_required(false);
        // What a command works on is not needed for its parameters.
        command = command.mut_subcommands(|sub| {
            let has_none = sub.get_arguments().any(|a| a.get_id() == "dump_config" && a.is_hide_set());
            if has_none {
                sub
            } else {
                sub.mut_args(|a| if a.is_positional() { a.required(false) } else { a })
            }
        });
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_begin_with_commands() {
        let text = groups(&command());
        let titles: Vec<&str> = text.lines().filter_map(|line| line.strip_suffix(':')).collect();
        assert_eq!(titles, GROUPS.map(|(_, title)| title));
    }
}
