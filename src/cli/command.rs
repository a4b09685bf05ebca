//! Commands: arguments that become a job.

use super::common::Common;
use super::config::{Given, Layer, Parameters};
use super::failure::Failure;
use super::progress::Reporter;
use super::values::Seed;

/// Work that is left when all options are checked.
pub(crate) type Job = Box<dyn FnOnce(&Common, &Reporter) -> anyhow::Result<()> + Send>;

/// The arguments of a command.
pub(crate) trait Arguments {
    /// Adds the options that are parameters, by section.
    fn give(&self, given: &mut Given) {
        let _ = given;
    }

    /// Reads the parameters that an input holds; those of the command line win.
    ///
    /// # Errors
    /// An input that cannot be read.
    fn layer(&mut self) -> anyhow::Result<Option<&Layer>> {
        Ok(None)
    }

    /// The preset that was asked for.
    ///
    /// # Errors
    /// None of its own.
    fn preset(&self) -> Result<Option<Layer>, Failure> {
        Ok(None)
    }

    /// Checks all that can be wrong without reading more inputs.
    ///
    /// # Errors
    /// Usage errors.
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job>;
}

/// The sources of a job besides the arguments of its command.
pub(crate) struct Resolved {
    /// All parameters; those of analysis and synthesis have the seed below.
    pub(crate) parameters: Parameters,
    /// As given, else chosen.
    pub(crate) seed: Seed,
    /// The file of `--config`.
    pub(crate) config: Option<Layer>,
    /// The parameters of the command line.
    pub(crate) given: Given,
    /// The whole command line, from which completions and man pages are made.
    pub(crate) program: fn() -> clap::Command,
}
