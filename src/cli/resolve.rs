//! From the command line to a job. Defaults, `--config` and options are merged, and all options are checked
//! before anything is read except the configuration, weights, palettes and a file of jobs.

use super::arguments::{Cli, command};
use super::command::{Job, Merged};
use super::common::Common;
use super::failure::Failure;

/// The request of a command line.
pub(crate) enum Task {
    /// Print the parameters.
    DumpConfig(String),
    /// Run a command.
    Job(Common, Job),
}

impl Task {
    /// Checks a command line.
    ///
    /// # Errors
    /// Usage errors, and a configuration that cannot be read.
    pub(crate) fn resolve(cli: Cli) -> anyhow::Result<Self> {
        let Cli { global, command: asked } = cli;
        let mut asked = asked.map(super::commands::Command::arguments);
        let merged = match &mut asked {
            Some(arguments) => Merged::new(&global, Some(&mut **arguments))?,
            None => Merged::new(&global, None)?,
        };
        if global.dump_config {
            return Ok(Self::DumpConfig(merged.parameters.dump()));
        }
        let asked = asked.ok_or_else(|| Failure::usage("no command is given"))?;
        let (common, resolved) = merged.resolved(global, command);
        Ok(Self::Job(common, asked.job(resolved)?))
    }
}
