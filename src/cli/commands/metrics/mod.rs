//! `vtex metrics`: how alike an exemplar and a result are, and how well elements are found again.

mod arrangement;
mod content;
mod cycle;
mod pictures;
mod show;

use crate::cli::analysis::Analysis;
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::number::Takes;
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::files::{check_files, required};
use crate::cli::progress::Reporter;
use clap::Args;
use content::FileContent;
use std::path::PathBuf;
use vtex::metrics::SCALE;

/// Measure how similar a result is to its exemplar
#[derive(Args)]
#[command(
    override_usage = "vtex metrics [OPTIONS] <EXEMPLAR> <RESULT>\n       vtex metrics [OPTIONS] <RESULT> --library <LIBRARY>",
    mut_arg("engine", |arg| arg.requires("library")),
    mut_arg("onnxruntime", |arg| arg.requires("library")),
    after_long_help = "\
Examples:
  vtex metrics photo.jpg out.svg
  vtex metrics photo.jpg twice-as-large.png --scale 2 --json
  vtex metrics photo.lib.json out.scene.json
  vtex metrics out.scene.json --library photo.lib.json

Pictures are compared by colours, spectra, grain and structure. A library and a
scene made from it are compared by coverage, repetition and clustering. If one
of the files is a picture, a library is drawn as its exemplar.

With --library, the result is drawn, and its picture analysed. Large elements
that are found again are counted, if they are whole on the canvas and mostly
visible. Compare the numbers with those of the library itself, given in place of
the scene. An SVG is read as a drawing."
)]
pub(crate) struct MetricsArgs {
    /// The exemplar: a picture, SVG, library or scene; - reads stdin
    #[arg(value_name = "EXEMPLAR", required = true)]
    pub(crate) exemplar: Option<PathBuf>,
    /// The result: a picture, SVG, scene or library; - reads stdin
    #[arg(value_name = "RESULT", required_unless_present_any = ["library", "dump_config"])]
    pub(crate) result: Option<PathBuf>,
    /// How much larger the result shows the texture; vtex first reduces the result by this factor
    #[arg(long, number = SCALE, default_value_t = SCALE.default())]
    pub(crate) scale: f64,
    /// Find the elements of a scene, SVG or library again in its picture; vtex analyses it with the
    /// parameters of this library
    #[arg(long, value_name = "LIBRARY", conflicts_with_all = ["result", "scale"])]
    pub(crate) library: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

impl Arguments for MetricsArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let first = required(self.exemplar)?;
        if let Some(library) = self.library.map(Input::new) {
            // The same file may be both.
            if first == Input::Stdin {
                check_files(&[("the scene", &first), ("--library", &library)], &[])?;
            }
            let analysis = Analysis::plain(first, self.engine, &resolved.parameters)?;
            return Ok(Box::new(move |common, reporter| cycle::run(common, reporter, &library, analysis)));
        }
        let inputs = [first, required(self.result)?];
        check_files(&[("the exemplar", &inputs[0]), ("the result", &inputs[1])], &[])?;
        let scale = self.scale;
        Ok(Box::new(move |common, reporter| run(common, reporter, inputs, scale)))
    }
}

fn run(common: &Common, reporter: &Reporter, inputs: [Input; 2], scale: f64) -> anyhow::Result<()> {
    reporter.stage("reading")?;
    let [exemplar, result] = [FileContent::read(&inputs[0])?, FileContent::read(&inputs[1])?];
    let names = inputs.map(|input| input.name());
    match (&exemplar, &result) {
        (FileContent::Library(library), FileContent::Scene(scene)) => {
            if scale != 1.0 {
                let failure = Failure::usage("--scale is for pictures; a scene has the scale of its library");
                return Err(failure.hint("leave it away, or give a picture of one of them").into());
            }
            arrangement::run(common, reporter, names, library, scene)
        }
        _ => pictures::run(common, reporter, names, &exemplar, &result, scale),
    }
}
