//! The `vtex` program: see [`cli`].

#![forbid(unsafe_code)]

mod cli;

use clap::FromArgMatches;
use cli::arguments::{self, Cli};
use cli::exit::Exit;
use cli::progress::Reporter;
use cli::resolve::Task;
use cli::{failure, interrupt, panics, raw_arguments};
use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    panics::watch();
    let arguments: Vec<OsString> = raw_arguments::joined(std::env::args_os().collect());
    let choice = raw_arguments::colour_choice(&arguments);
    choice.as_choice().write_global();
    let command = arguments::command_for(&arguments).color(choice.as_clap());
    let parsed = command.try_get_matches_from(&arguments);
    let parsed = parsed.and_then(|matches| Cli::from_arg_matches(&matches));
    let outcome = match parsed {
        Ok(cli) => panics::guarded(|| run(cli)),
        Err(e) => return failure::show_usage(&e, &arguments).into(),
    };
    match outcome {
        Ok(()) => Exit::Success,
        Err(e) => failure::show(&e),
    }
    .into()
}

fn run(cli: Cli) -> anyhow::Result<()> {
    match Task::resolve(cli)? {
        Task::DumpConfig(text) => cli::output::print(text.as_bytes()),
        Task::Job(common, job) => {
            interrupt::watch();
            let reporter = Reporter::new(&common)?;
            let outcome = cli::on_threads(common.threads, || job(&common, &reporter));
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
