//! `vtex texture`: photograph → texture.

use super::synth;
use crate::cli::options::{Analysis, Common, Synthesis};
use crate::cli::progress::Reporter;
use crate::cli::stages;

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    synthesis.probe()?;
    analysis.probe()?;
    // What is wrong with them shows before the long work.
    let controls = stages::controls(&synthesis.steering, &synthesis.parameters, 1)?;
    let library = stages::analyze(common, analysis, reporter)?;
    let inputs = vec![analysis.photo.name()];
    synth::finish(common, reporter, "texture", inputs, &[library], &controls, synthesis)
}
