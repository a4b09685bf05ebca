//! `vtex vectorize`: photograph → the same picture in vectors.

use crate::cli::analysis::{Analysis, analyze};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::Given;
use crate::cli::format;
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::files::{ForceArgs, required, target};
use crate::cli::options::masks::MasksArgs;
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{Place, Target, say};
use crate::cli::progress::Reporter;
use crate::cli::summary::{Counts, Summary};
use clap::Args;
use std::path::PathBuf;
use vtex::output::file::Format;
use vtex::synth::reconstruct;

/// The photograph itself, drawn in vectors
#[derive(Args)]
#[command(
    override_usage = "vtex vectorize [OPTIONS] <PHOTO>",
    after_help = "\
Examples:
  vtex vectorize photo.jpg
  vtex vectorize photo.jpg --fidelity 0.25 -o fine.svg
  vtex vectorize photo.jpg --colors 12 --max-paths 2000 -o poster.svg"
)]
pub(crate) struct VectorizeArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result, by extension .svg, .svgz, .png, .scene.json or .scene.json.gz; - writes SVG to stdout
    /// [default: ./PHOTO.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

impl Arguments for VectorizeArgs {
    fn give(&self, given: &mut Given) {
        given.add("analyze", &self.analyze);
        given.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Self { photo, output, force, masks, .. } = *self;
        let photo = required(photo)?;
        let target = target(output.clone(), &force, &photo, format::OF_SCENE, Format::Svg)?;
        let analysis = Analysis::new(photo, masks, &force, output.as_deref(), &resolved.parameters)?;
        let svg = resolved.parameters.svg;
        Ok(Box::new(move |common, reporter| run(common, reporter, &analysis, svg, &target)))
    }
}

fn run(
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
    let library = analyze(common, analysis, reporter)?;
    let scene = reconstruct(&library);
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
