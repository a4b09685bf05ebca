//! From the command line to a job. Defaults, `--config` and options are merged, and all options are checked
//! before anything is read except the configuration, weights, palettes and a file of jobs.

use super::arguments::{Cli, command};
use super::command::{Job, Resolved};
use super::common::Common;
use super::config::{CommandLineValues, ConfigLayer, Parameters, Top};
use super::failure::Failure;
use super::number::within;
use super::options::global::THREADS;
use super::values::Seed;
use vtex::library::AnalyzeParams;
use vtex::scene::SynthParams;

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
        let mut values = CommandLineValues::default();
        values.add("", &Top { seed: global.seed, threads: global.threads });
        if let Some(arguments) = &asked {
            arguments.collect(&mut values);
        }
        let config = global.config.as_deref().map(ConfigLayer::read).transpose()?;
        let preset = asked.as_ref().map(|arguments| arguments.preset()).transpose()?.flatten();
        let layer = asked.as_mut().map(|arguments| arguments.layer()).transpose()?.flatten();
        let parameters = Parameters::resolve(config.iter().chain(layer).chain(&preset), &values)?;
        let threads = parameters.threads.or(threads_of_environment()?);
        if global.dump_config {
            return Ok(Self::DumpConfig(parameters.dump()));
        }
        let asked = asked.ok_or_else(|| Failure::usage("no command is given"))?;
        let seed = parameters.seed.unwrap_or_else(Seed::chosen);
        let common = Common {
            threads,
            seed_chosen: parameters.seed.is_none(),
            quiet: global.quiet,
            verbosity: global.verbose,
            json: global.json,
            debug_folder: global.debug_dir,
        };
        let parameters = Parameters {
            analyze: AnalyzeParams { seed: seed.0, ..parameters.analyze },
            synth: SynthParams { seed: seed.0, ..parameters.synth },
            threads,
            ..parameters
        };
        let resolved = Resolved { parameters, seed, config, values, program: command };
        Ok(Self::Job(common, asked.job(resolved)?))
    }
}

/// The number of threads that `VTEX_THREADS` asks for. It is not a parameter, so it does not appear in
/// configurations.
fn threads_of_environment() -> Result<Option<u16>, Failure> {
    let Some(text) = std::env::var_os("VTEX_THREADS").filter(|text| !text.is_empty()) else {
        return Ok(None);
    };
    let text = text.to_string_lossy();
    let refused = |reason| Failure::usage(format!("VTEX_THREADS = {text}: {reason}"));
    within(THREADS)(&text).map(Some).map_err(refused)
}
