//! One file for each command.

mod analyze;
mod completions;
mod inspect;
mod man;
mod render;
mod synth;
mod texture;

use super::options::{Common, Job};

/// Runs a command.
pub(crate) fn run(common: &Common, job: &Job) -> anyhow::Result<()> {
    match job {
        Job::Texture(analysis, synthesis) => texture::run(common, analysis, synthesis),
        Job::Analyze(analysis, target) => analyze::run(common, analysis, target),
        Job::Synth(library, synthesis) => synth::run(common, library, synthesis),
        Job::Render { file, scale, svg, target } => render::run(common, file, scale.scale, *svg, target),
        Job::Inspect(file) => inspect::run(common, file),
        Job::Completions(shell) => completions::run(*shell),
        Job::Man(folder) => man::run(folder),
    }
}
