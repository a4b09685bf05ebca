//! Options of every command.

use crate::cli::number::Takes;
use crate::cli::values::Seed;
use clap::{Args, ColorChoice, ValueEnum};
use std::path::PathBuf;
use vtex::Parameter;

/// Number of threads.
pub(crate) const THREADS: Parameter<u16> = Parameter::new("threads", [1, 1024], "");

/// Options of every command.
#[derive(Args)]
#[command(next_help_heading = "Global options")]
pub(crate) struct Global {
    /// Seed of all random choices
    #[arg(long, global = true, value_name = "NUMBER", help_heading = None::<&'static str>)]
    #[arg(takes = format!("0 to {}, default: one chosen, printed and stored", u64::MAX))]
    pub(crate) seed: Option<Seed>,
    /// Number of threads, except in ONNX Runtime; the result does not depend on it
    #[arg(short, long, global = true, number_or(THREADS, "$VTEX_THREADS, else all cores"))]
    pub(crate) threads: Option<u16>,
    /// Print only errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Print more: -v seconds per stage, -vv also all parameters
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Print a JSON summary to stdout (to stderr if stdout contains data)
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// When to use colours; see also NO_COLOR [auto, always or never, default: auto]
    #[arg(long, global = true, value_name = "WHEN", value_enum, hide_possible_values = true)]
    pub(crate) color: Option<When>,
    /// Read parameters from a TOML file; options on the command line override it
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Print all parameters as a file for --config, and stop
    #[arg(long, global = true)]
    pub(crate) dump_config: bool,
    /// Write a numbered PNG of every stage to a folder; vtex creates it if needed
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
