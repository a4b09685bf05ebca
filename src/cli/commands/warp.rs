//! `vtex warp`: scene → scene of another shape.

use super::synth::Made;
use crate::cli::input::Input;
use crate::cli::options::{Common, How, Warping};
use crate::cli::progress::Reporter;
use crate::cli::stages;

pub(super) fn run(common: &Common, reporter: &Reporter, warping: &Warping) -> anyhow::Result<()> {
    let Warping { scene, libraries, how, parameters, svg, target } = warping;
    target.place.probe()?;
    reporter.stage("reading")?;
    let before = stages::scene(scene)?;
    let bend = stages::bend(&before, how)?;
    let known = stages::libraries(libraries)?;
    let mut inputs = vec![scene.name()];
    inputs.extend(libraries.iter().map(Input::name));
    if let How::Cage(cages) = how {
        inputs.extend(cages.iter().map(Input::name));
    }
    let (result, report) = vtex::warp::warp(&before, known, &bend, *parameters, reporter)?;
    Made { command: "warp", inputs, scene: result, report }.write(common, reporter, *svg, target, None)
}
