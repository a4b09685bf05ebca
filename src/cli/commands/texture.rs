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
    if let Some(place) = &analysis.save_masks {
        place.probe()?;
    }
    let library = stages::analyze(analysis, reporter)?;
    synth::finish(common, reporter, "texture", analysis.photo.name(), library, synthesis)
}
