//! `vtex texture`: photograph → texture.

use crate::cli::analysis::{Analysis, analyze};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::Given;
use crate::cli::format;
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::control::{ControlArgs, Steering};
use crate::cli::options::files::{ForceArgs, required, target};
use crate::cli::options::masks::MasksArgs;
use crate::cli::options::pattern::PatternArgs;
use crate::cli::options::svg::SvgFlags;
use crate::cli::options::synth::SynthFlags;
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::synthesis::{Synthesis, finish};
use crate::cli::weights::read_weights;
use clap::Args;
use std::path::PathBuf;
use vtex::output::file::Format;

/// Photograph to vector texture, in one go
#[derive(Args)]
#[command(
    override_usage = "vtex texture [OPTIONS] <PHOTO>",
    after_help = "\
Examples:
  vtex texture photo.jpg -o out.svg --size 1000
  vtex texture photo.jpg -o - --size 400x300 --seed 7 > out.svg"
)]
pub(crate) struct TextureArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout
    /// [default: ./PHOTO.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

impl Arguments for TextureArgs {
    fn give(&self, given: &mut Given) {
        given.add("analyze", &self.analyze);
        given.add("synth", &self.synth);
        given.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let Self { photo, output, force, pattern, control, masks, .. } = *self;
        let Resolved { mut parameters, .. } = resolved;
        let photo = required(photo)?;
        read_weights(parameters.weights.clone(), &photo, &mut parameters.synth)?;
        let target = target(output.clone(), &force, &photo, format::OF_SCENE, Format::Svg)?;
        let steering = Steering::new(control, Vec::new());
        let written = [("-o", output.as_deref()), ("--save-masks", masks.save_masks.as_deref())];
        steering.check(&[("the photograph", &photo)], &written)?;
        let analysis = Analysis::new(photo, masks, &force, output.as_deref(), &parameters)?;
        let synthesis = Synthesis::new(parameters, steering, target, pattern, &force)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &analysis, &synthesis)))
    }
}

fn run(
    common: &Common,
    reporter: &Reporter,
    analysis: &Analysis,
    synthesis: &Synthesis,
) -> anyhow::Result<()> {
    synthesis.probe()?;
    analysis.probe()?;
    // What is wrong with them shows before the long work.
    let controls = reading::controls(&synthesis.steering, &synthesis.parameters, 1)?;
    let library = analyze(common, analysis, reporter)?;
    let inputs = vec![analysis.photo.name()];
    finish(common, reporter, "texture", inputs, &[library], &controls, synthesis)
}
