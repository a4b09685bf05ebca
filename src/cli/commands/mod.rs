//! One file for each command.

mod analyze;
mod completions;
mod doctor;
mod inspect;
mod interp;
mod man;
mod models;
mod render;
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
        Job::Warp(warping) => warp::run(common, &reporter, warping),
        Job::Tune(library, tuning) => tune::run(common, &reporter, library, tuning),
        Job::Render(file, options) => render::run(common, &reporter, file, options),
        Job::Interp(job) => interp::run(common, &reporter, job),
        Job::Inspect(file) => inspect::run(common, file),
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
