//! Commands: from arguments to a job.

use super::common::Common;
use super::config::{CommandLineValues, ConfigLayer, Parameters};
use super::failure::Failure;
use super::progress::Reporter;
use super::values::Seed;

/// The work of a command after all options are checked.
pub(crate) type Job = Box<dyn FnOnce(&Common, &Reporter) -> anyhow::Result<()> + Send>;

/// The arguments of a command.
pub(crate) trait Arguments {
    /// Adds the options that are parameters, by section.
    fn collect(&self, values: &mut CommandLineValues) {
        let _ = values;
    }

    /// Reads the parameters stored in an input. Parameters of the command line take precedence.
    ///
    /// # Errors
    /// An input that cannot be read.
    fn layer(&mut self) -> anyhow::Result<Option<&ConfigLayer>> {
        Ok(None)
    }

    /// The chosen preset.
    ///
    /// # Errors
    /// None of its own.
    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        Ok(None)
    }

    /// Checks everything that can be checked without reading more inputs, and returns the job.
    ///
    /// # Errors
    /// Usage errors.
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job>;
}

/// The sources of a job besides the arguments of its command.
pub(crate) struct Resolved {
    /// All parameters; those of analysis and synthesis have the seed below.
    pub(crate) parameters: Parameters,
    /// The seed, which is chosen at random unless it is given.
    pub(crate) seed: Seed,
    /// The file of `--config`.
    pub(crate) config: Option<ConfigLayer>,
    /// The parameters of the command line.
    pub(crate) values: CommandLineValues,
    /// The whole command line, from which completions and man pages are made.
    pub(crate) program: fn() -> clap::Command,
}
