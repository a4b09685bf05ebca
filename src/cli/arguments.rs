//! The whole command line as clap sees it.

use super::commands::Command;
use super::options::global::Global;
use super::short_help;
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

/// Commands that belong together. Others are hidden.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Make", &["texture", "vectorize", "batch", "raster"]),
    ("Take apart", &["analyze", "synth", "render", "layers", "inspect"]),
    ("Change", &["edit", "transfer", "stylize", "warp", "interp", "animate"]),
    ("Judge", &["metrics", "check", "tune", "doctor", "models"]),
];

/// The commands of each group, with what they do.
fn groups(command: &clap::Command) -> String {
    let width = GROUPS.iter().flat_map(|(_, names)| *names).map(|name| name.len()).max().unwrap_or(0);
    let line = |name: &&str| {
        let about = command.find_subcommand(name).and_then(clap::Command::get_about);
        format!("  {name:width$}  {}\n", about.map(ToString::to_string).unwrap_or_default())
    };
    let group = |(title, names): &(&str, &[&str])| {
        format!("{title}:\n{}", names.iter().map(line).collect::<String>())
    };
    GROUPS.iter().map(group).collect::<Vec<_>>().join("\n").trim_end().to_owned()
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

/// The whole command, from which parser, completions and man pages are made.
pub(crate) fn command() -> clap::Command {
    const WORK: [&str; 2] = ["seed", "debug_dir"];
    const PARAMETERS: [&str; 3] = ["threads", "config", "dump_config"];
    const TELLING: [&str; 3] = ["quiet", "verbose", "json"];
    let command = Cli::command();
    let global: Vec<Arg> = command.get_arguments().cloned().collect();
    // Every command takes the options of all, but does not show those that mean nothing to it.
    let hide = |command: clap::Command, name: &str, hidden: &[&str]| {
        let args = global.iter().filter(|a| hidden.contains(&a.get_id().as_str()));
        let args: Vec<Arg> = args.map(|a| a.clone().hide(true)).collect();
        command.mut_subcommand(name, |sub| sub.args(args))
    };
    // Categories and descriptors serve placement, and nothing is placed.
    let command = command.mut_subcommand("vectorize", |sub| {
        sub.mut_arg("categories", |a| a.hide(true)).mut_arg("descriptor_reach", |a| a.hide(true))
    });
    let command = hide(command, "tune", &WORK[1..]);
    let command = hide(command, "edit", &WORK[1..]);
    let command = hide(command, "transfer", &WORK[1..]);
    let command = hide(command, "stylize", &WORK[1..]);
    let command = hide(command, "render", &WORK);
    let command = hide(command, "metrics", &[&WORK[..], &PARAMETERS[1..]].concat());
    let command = hide(command, "inspect", &[&WORK[..], &PARAMETERS].concat());
    let command = hide(command, "interp", &WORK);
    let command = hide(command, "animate", &WORK[1..]);
    let command = hide(command, "check", &WORK);
    let command = hide(command, "layers", &WORK[1..]);
    let command = hide(command, "raster", &WORK[1..]);
    let command = hide(command, "doctor", &[&WORK[..], &PARAMETERS[1..], &TELLING[..2]].concat());
    let command = hide(command, "models", &[&WORK[..], &PARAMETERS, &TELLING[..2]].concat());
    let all = [&WORK[..], &PARAMETERS, &TELLING, &["color"]].concat();
    let command = hide(hide(command, "completions", &all), "man", &all);
    let text = groups(&command);
    command.before_help(text)
}

/// [`command`], in which nothing else is needed beside `--dump-config`.
pub(crate) fn command_for(arguments: &[OsString]) -> clap::Command {
    let mut command = command();
    if !std::io::stdout().is_terminal() && std::env::var_os("COLUMNS").is_none() {
        command = command.term_width(80);
    }
    if short_help::asked(arguments) {
        command = short_help::shortened(command);
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
    fn every_command_is_in_one_group_or_hidden() {
        let command = command();
        let shown = command.get_subcommands().filter(|sub| !sub.is_hide_set()).map(clap::Command::get_name);
        let mut shown: Vec<&str> = shown.collect();
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| *names).copied().collect();
        shown.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(shown, grouped);
    }
}
