//! `vtex vectorize`: photograph → the same picture in vectors.

use crate::cli::analysis::{Analysis, analyze};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::{CommandLineValues, ConfigLayer};
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::common;
use crate::cli::options::files::{ForceArgs, Makes, required, targets};
use crate::cli::options::layers::LayerFilesArgs;
use crate::cli::options::masks::{MasksArgs, MasksFrom};
use crate::cli::options::preset::PresetArgs;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::output::{DrawingOptions, Targets, say};
use crate::cli::progress::{Plan, Reporter};
use crate::cli::summary::{ElementCounts, PhotographPreparation, PhotographReduction, Summary};
use clap::Args;
use std::path::PathBuf;
use vtex::Progress;
use vtex::library::EvenLight;
use vtex::output::file::Format;
use vtex::synth::reconstruct;

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "vector" };

/// Draw the photograph itself in vectors
#[derive(Args)]
#[command(
    override_usage = "vtex vectorize [OPTIONS] <PHOTO>",
    mut_arg("segmenter", |arg| arg.help(SEGMENTER)),
    mut_args(common(&["fidelity", "colors", "max_paths"])),
    after_long_help = "\
Examples:
  vtex vectorize photo.jpg
  vtex vectorize photo.jpg --fidelity 0.25 -o fine.svg
  vtex vectorize photo.jpg --colors 12 --max-paths 2000 -o poster.svg"
)]
pub(crate) struct VectorizeArgs {
    /// Photograph (PNG, JPEG, TIFF, WebP, BMP, GIF, PNM) or drawing (SVG, SVGZ); - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result: {formats} [default: ./PHOTO.vector.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = MAKES.allowed)]
    pub(crate) output: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) layer_files: LayerFilesArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

/// Help of `--segmenter` here.
const SEGMENTER: &str = "Segmenter that finds the elements; auto is regions, which is faster than \
     texton for an equally good picture [auto, texton, regions, felzenszwalb or sam, default: auto]";

/// The source of masks: a network does not improve the drawing, so the default is without.
fn without_network(masks: MasksFrom) -> MasksFrom {
    if matches!(masks, MasksFrom::Auto) { MasksFrom::OneTree } else { masks }
}

impl Arguments for VectorizeArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("analyze", &self.analyze);
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Self { photo, output, force, masks, layer_files, .. } = *self;
        let photo = required(photo)?;
        let targets = targets(output.clone(), &force, &photo, MAKES)?;
        let analysis = Analysis::new(photo, (masks, layer_files), &force, &output, &resolved.parameters)?;
        // A picture is not tiled, and nothing in it is placed.
        let masks = without_network(analysis.masks);
        let mut analysis = Analysis { looks_at_borders: false, places: false, masks, ..analysis };
        // The picture keeps its light.
        if analysis.parameters.even_light == EvenLight::Auto {
            analysis.parameters.even_light = EvenLight::Off;
        }
        let (svg, render) = (resolved.parameters.svg, resolved.parameters.render);
        let drawing = DrawingOptions { svg, render, recipe: None };
        Ok(Box::new(move |common, reporter| {
            if let Some(warning) = render.warning(targets.any_uses(|uses| uses.scale)) {
                reporter.warn(warning);
            }
            run(common, reporter, &analysis, drawing, &targets)
        }))
    }
}

fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    drawing: DrawingOptions<'_>,
    targets: &Targets,
) -> anyhow::Result<()> {
    targets.probe()?;
    analysis.probe()?;
    if common.verbosity > 1 {
        say(&format!("{:#?}", analysis.parameters));
    }
    reporter.plan(Plan { finder: Some(analysis.finder()), ..Plan::default() });
    let library = analyze(common, analysis, reporter)?;
    let scene = reconstruct(&library);
    reporter.stage("writing")?;
    let written = targets.write_scene(&scene, None, drawing)?;
    let summary = Summary {
        seed: Some(library.source.parameters.seed),
        size: drawing.size_of(&scene, targets.first.kind.format),
        page: drawing.page(&scene),
        reduced: PhotographReduction::of_library(&library),
        prepared: PhotographPreparation::of_library(&library),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("vectorize", vec![analysis.input.name()], targets.path(), written, reporter)
    };
    summary.print(common, targets.piped())
}
