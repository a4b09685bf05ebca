//! `vtex analyze`: photograph → library.

use crate::cli::analysis::{Analysis, analyze};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::{CommandLineValues, ConfigLayer, Parameters};
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::common;
use crate::cli::options::files::{ForceArgs, Makes, required, targets};
use crate::cli::options::layers::LayerFilesArgs;
use crate::cli::options::masks::MasksArgs;
use crate::cli::options::preset::PresetArgs;
use crate::cli::output::{Targets, say};
use crate::cli::progress::{Plan, Reporter};
use crate::cli::summary::{
    Coverage, ElementCounts, LayersReport, MotifCount, PhotographPreparation, PhotographReduction, Summary,
};
use clap::Args;
use std::path::PathBuf;
use vtex::output::file::Format;

const MAKES: Makes = Makes { allowed: format::OF_LIBRARY, usual: Format::Library, word: "" };

/// Make a library from a photograph
#[derive(Args)]
#[command(
    override_usage = "vtex analyze [OPTIONS] <PHOTO>",
    mut_args(common(&["segmenter", "masks", "layers"])),
    after_long_help = "\
Examples:
  vtex analyze photo.jpg
  vtex analyze photo.jpg -o photo.lib.json.gz --save-masks photo.masks.png
  vtex analyze photo.jpg --masks corrected.png --debug-dir stages"
)]
pub(crate) struct AnalyzeArgs {
    /// Photograph (PNG, JPEG, TIFF, WebP, BMP, GIF, PNM) or drawing (SVG, SVGZ); - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result: .lib.json or .lib.json.gz; - writes JSON to stdout [default: ./PHOTO.lib.json]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) layer_files: LayerFilesArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

impl Arguments for AnalyzeArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("analyze", &self.analyze);
    }

    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let (analysis, targets) = self.analysis(&resolved.parameters)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &analysis, &targets)))
    }
}

impl AnalyzeArgs {
    /// Checks the options.
    pub(crate) fn analysis(self, parameters: &Parameters) -> Result<(Analysis, Targets), Failure> {
        let Self { photo, output, force, masks, layer_files, .. } = self;
        let photo = required(photo)?;
        let targets = targets(output.clone(), &force, &photo, MAKES)?;
        let analysis = Analysis::new(photo, (masks, layer_files), &force, &output, parameters)?;
        Ok((analysis, targets))
    }
}

fn run(common: &Common, reporter: &Reporter, analysis: &Analysis, targets: &Targets) -> anyhow::Result<()> {
    targets.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    reporter.plan(Plan { finder: Some(analysis.finder()), ..Plan::default() });
    let library = analyze(common, analysis, reporter)?;
    reporter.stage("writing")?;
    let json = library.to_json();
    let written = targets.each(|target| target.write_bytes(&json))?;
    let summary = Summary {
        seed: Some(library.source.parameters.seed),
        size: [library.source.width, library.source.height],
        reduced: PhotographReduction::of_library(&library),
        prepared: PhotographPreparation::of_library(&library),
        counts: Some(ElementCounts::of_library(&library)),
        coverage: Some(Coverage {
            wanted: Some(library.coverage),
            got: None,
            categories: Vec::new(),
            exemplar: "photograph",
            own: None,
        }),
        layers: LayersReport::of_library(&library),
        lattice: library.lattice.clone(),
        motifs: MotifCount::of_library(&library),
        ..Summary::new("analyze", vec![analysis.input.name()], targets.path(), written, reporter)
    };
    summary.print(common, targets.piped())
}
