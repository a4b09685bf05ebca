//! Options of every command.

use crate::cli::values::Seed;
use clap::{Args, ColorChoice, ValueEnum};
use std::path::PathBuf;

/// Options of every command.
#[derive(Args)]
#[command(next_help_heading = "Global options")]
pub(crate) struct Global {
    /// Seed of all random choices [0 to 18446744073709551615, default: one chosen, printed and stored]
    #[arg(long, global = true, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(help_heading = None::<&'static str>)]
    pub(crate) seed: Option<Seed>,
    /// Threads, of all but ONNX Runtime; results do not depend on it [1 to 1024, default:
    /// $VTEX_THREADS, else all cores]
    #[arg(short, long, global = true, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Print nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say more: -v seconds by stage, -vv also all parameters
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Print a summary in JSON on stdout (on stderr if stdout carries data)
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// When to use colours; see also NO_COLOR [auto, always or never, default: auto]
    #[arg(long, global = true, value_name = "WHEN", value_enum, hide_possible_values = true)]
    pub(crate) color: Option<When>,
    /// Read parameters from a TOML file; options given here win over it
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Print all parameters as a file for --config and do nothing else
    #[arg(long, global = true)]
    pub(crate) dump_config: bool,
    /// Write a numbered PNG of every stage into a folder, made if need be
    #[arg(long, global = true, value_name = "DIR")]
    pub(crate) debug_dir: Option<PathBuf>,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum When {
    #[default]
    Auto,
    Always,
    Never,
}

impl When {
    /// The choice as a type of anstream.
    pub(crate) fn as_choice(self) -> anstream::ColorChoice {
        match self {
            Self::Auto => anstream::ColorChoice::Auto,
            Self::Always => anstream::ColorChoice::Always,
            Self::Never => anstream::ColorChoice::Never,
        }
    }

    /// The choice as a type of clap.
    pub(crate) fn as_clap(self) -> ColorChoice {
        match self {
            Self::Auto => ColorChoice::Auto,
            Self::Always => ColorChoice::Always,
            Self::Never => ColorChoice::Never,
        }
    }
}
