//! The command-line program, for its executable and for the Python package.

use crate::cli::arguments::{self, Cli};
use crate::cli::exit::Exit;
use crate::cli::progress::Reporter;
use crate::cli::resolve::Task;
use crate::cli::{executable, failure, interrupt, on_threads, output, panics, raw_arguments};
use clap::FromArgMatches;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the program and returns its exit code. The first argument is the name of the program.
///
/// `file` is the executable that other programs can start; without it, that of this process.
///
/// Runs once in a process: the handlers of panics and of Ctrl-C remain, and Ctrl-C may end the process.
pub fn run(arguments: Vec<OsString>, file: Option<PathBuf>) -> u8 {
    panics::watch();
    executable::set(file);
    let arguments = raw_arguments::joined(arguments);
    let choice = raw_arguments::colour_choice(&arguments);
    choice.as_choice().write_global();
    let command = arguments::command_for(&arguments).color(choice.as_clap());
    let parsed = command.try_get_matches_from(&arguments);
    let outcome = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => panics::guarded(|| work(cli)),
        Err(e) => return failure::show_usage(&e, &arguments).code(),
    };
    let exit = match outcome {
        Ok(()) => Exit::Success,
        Err(e) => failure::show(&e),
    };
    exit.code()
}

fn work(cli: Cli) -> anyhow::Result<()> {
    match Task::resolve(cli)? {
        Task::DumpConfig(text) => output::print(text.as_bytes()),
        Task::Job(common, job) => {
            interrupt::watch();
            let reporter = Reporter::new(&common)?;
            let outcome = on_threads(common.threads, || job(&common, &reporter));
            // Work also stops if a picture of a stage cannot be written; then that is the reason.
            let outcome = match reporter.failure() {
                Some(reason) => Err(reason.into()),
                None => outcome,
            };
            outcome.inspect_err(|error| {
                if common.json {
                    failure::show_json(error);
                }
            })
        }
    }
}
