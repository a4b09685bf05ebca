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

/// Turn a photograph of a texture into an editable vector texture of any size
#[derive(Parser)]
#[command(name = "vtex", version, styles = STYLES, max_term_width = 100, after_help = EXAMPLES)]
#[command(subcommand_required = true, arg_required_else_help = true)]
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
    hide(hide(command, "completions", &all), "man", &all)
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
        for (name, argument) in [
            ("texture", "photo"),
            ("vectorize", "photo"),
            ("analyze", "photo"),
            ("synth", "library"),
            ("batch", "input"),
            ("batch", "out_dir"),
            ("warp", "scene"),
            ("warp", "library"),
            ("transfer", "structure"),
            ("transfer", "appearance"),
            ("tune", "library"),
            ("check", "scene"),
            ("check", "library"),
            ("stylize", "picture"),
            ("stylize", "with"),
            ("animate", "scene"),
            ("render", "file"),
            ("raster", "photo"),
            ("interp", "from"),
            ("interp", "to"),
            ("inspect", "file"),
        ] {
            command = command.mut_subcommand(name, |c| c.mut_arg(argument, |a| a.required(false)));
        }
    }
    command
}
