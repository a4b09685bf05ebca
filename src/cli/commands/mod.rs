//! One file for each command.

mod analyze;
mod batch;
mod completions;
mod doctor;
mod edit;
mod inspect;
mod interp;
mod man;
mod metrics;
mod models;
mod render;
mod report;
mod synth;
mod texture;
mod tune;
mod vectorize;
mod warp;

use super::options::{Common, Job};
use super::progress::Reporter;

/// Runs a command.
pub(crate) fn run(common: &Common, job: &Job) -> anyhow::Result<()> {
    let reporter = Reporter::new(common)?;
    let outcome = match job {
        Job::Texture(analysis, synthesis) => texture::run(common, &reporter, analysis, synthesis),
        Job::Vectorize(analysis, svg, target) => vectorize::run(common, &reporter, analysis, *svg, target),
        Job::Analyze(analysis, target) => analyze::run(common, &reporter, analysis, target),
        Job::Synth(library, synthesis) => synth::run(common, &reporter, library, synthesis),
        Job::Batch(jobs) => batch::run(common, jobs),
        Job::Warp(warping) => warp::run(common, &reporter, warping),
        Job::Edit(editing) => edit::run(common, &reporter, editing),
        Job::Tune(library, tuning) => tune::run(common, &reporter, library, tuning),
        Job::Render(file, options) => render::run(common, &reporter, file, options),
        Job::Metrics(arguments) => metrics::run(common, &reporter, arguments),
        Job::Inspect(files, Some(page)) => report::run(common, &reporter, files, page),
        Job::Inspect(files, None) => files.iter().try_for_each(|file| inspect::run(common, file)),
        Job::Interp(job) => interp::run(common, &reporter, job),
        Job::Doctor(engine) => doctor::run(common, engine),
        Job::Models(job) => models::run(common, job),
        Job::Completions(shell) => completions::run(*shell),
        Job::Man(folder) => man::run(folder),
    };
    // Work is also stopped when a picture of a stage cannot be written: that is then the reason.
    match reporter.failure() {
        Some(reason) => Err(reason.into()),
        None => outcome,
    }
}
