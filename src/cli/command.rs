//! Commands: from arguments to a job.

use super::common::Common;
use super::config::{CommandLineValues, ConfigLayer, Parameters, Top};
use super::failure::Failure;
use super::number::within;
use super::options::global::{Global, THREADS};
use super::progress::Reporter;
use super::values::Seed;
use vtex::library::AnalyzeParams;
use vtex::scene::SynthParams;

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

/// All parameters of a command line, before a seed is chosen.
pub(crate) struct Merged {
    pub(crate) parameters: Parameters,
    /// Number of threads, also by the environment.
    threads: Option<u16>,
    config: Option<ConfigLayer>,
    values: CommandLineValues,
}

impl Merged {
    /// Merges defaults, the file of `--config`, what inputs and presets hold, and the options.
    ///
    /// # Errors
    /// Usage errors, and a file that cannot be read.
    pub(crate) fn new(global: &Global, mut asked: Option<&mut dyn Arguments>) -> anyhow::Result<Self> {
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
        Ok(Self { parameters, threads, config, values })
    }

    /// What a job is made of; a seed is chosen unless one was given.
    pub(crate) fn resolved(self, global: Global, program: fn() -> clap::Command) -> (Common, Resolved) {
        let Self { parameters, threads, config, values } = self;
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
        (common, Resolved { parameters, seed, config, values, program })
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
