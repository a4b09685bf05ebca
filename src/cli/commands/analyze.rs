//! `vtex analyze`: photograph → library.

use crate::cli::options::{Analysis, Common};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Coverage, Summary};

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    let library = stages::analyze(common, analysis, reporter)?;
    reporter.stage("writing")?;
    let written = target.write_bytes(&library.to_json())?;
    let summary = Summary {
        seed: Some(library.source.parameters.seed),
        size: [library.source.width, library.source.height],
        counts: Some(Counts::of_library(&library)),
        coverage: Some(Coverage { wanted: Some(library.coverage), got: None, categories: Vec::new() }),
        ..Summary::new("analyze", vec![analysis.photo.name()], target.place.path(), written, reporter)
    };
    summary.tell(common, target.place == Place::Stdout)
}
