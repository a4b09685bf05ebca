//! `vtex vectorize`: photograph → the same picture in vectors.

use crate::cli::config::SvgParameters;
use crate::cli::options::{Analysis, Common};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Summary};

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    svg: SvgParameters,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    let library = stages::analyze(common, analysis, reporter)?;
    let scene = stages::reconstruct(&library);
    reporter.stage("writing")?;
    let written = target.write_scene(&scene, svg, 1.0)?;
    let summary = Summary {
        seed: Some(library.source.parameters.seed),
        size: [scene.width, scene.height],
        counts: Some(Counts::of_scene(&scene)),
        ..Summary::new("vectorize", vec![analysis.photo.name()], target.place.path(), written, reporter)
    };
    summary.tell(common, target.place == Place::Stdout)
}
