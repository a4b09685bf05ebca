//! The texture as a pattern, beside the result.

use super::files::{ForceArgs, check_distinct};
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::output::{Destination, Target, Targets};
use clap::Args;
use std::path::PathBuf;

/// The texture as a pattern, beside the result.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct PatternArgs {
    /// Also write an SVG of any size, filled with the texture as a <pattern>: {formats}. The texture
    /// must repeat along both axes (--tile)
    #[arg(long, value_name = "FILE", lists = format::OF_PATTERN)]
    pub(crate) pattern: Option<PathBuf>,
}

/// Where a pattern goes: a file of its own.
pub(crate) fn pattern(
    args: PatternArgs,
    force: &ForceArgs,
    outputs: &Targets,
) -> Result<Option<Target>, Failure> {
    let Some(path) = args.pattern else { return Ok(None) };
    let kind = format::kind_of("--pattern", &path, format::OF_PATTERN)?;
    for output in outputs.all() {
        check_distinct(&[("the output", Some(output.place.path())), ("--pattern", Some(&path))])?;
    }
    Ok(Some(Target { place: Destination::File { path, force: force.force }, kind }))
}
