//! `vtex metrics`: how alike an exemplar and a result are.

mod arrangement;
mod content;
mod pictures;
mod show;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::progress::Reporter;
use clap::Args;
use content::FileContent;
use std::path::PathBuf;

/// Say in numbers how alike an exemplar and a result are
#[derive(Args)]
#[command(
    override_usage = "vtex metrics [OPTIONS] <EXEMPLAR> <RESULT>",
    after_help = "\
Examples:
  vtex metrics photo.jpg out.svg
  vtex metrics photo.jpg twice-as-large.png --scale 2 --json
  vtex metrics photo.lib.json out.scene.json

Pictures are compared by colours, spectra, grain and structure; a library and a scene made from it
by coverage, repetition and how elements keep together or apart. A library beside a picture counts
as its exemplar, drawn."
)]
pub(crate) struct MetricsArgs {
    /// The exemplar: a picture, SVG, library or scene; - reads stdin
    #[arg(value_name = "EXEMPLAR")]
    pub(crate) exemplar: PathBuf,
    /// The result: a picture, SVG, scene or library; - reads stdin
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// How many times as large the result shows the texture; it is made smaller by as much first
    /// [0.01 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", default_value_t = 1.0, hide_default_value = true)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) scale: f64,
}

impl Arguments for MetricsArgs {
    fn job(self: Box<Self>, _: Resolved) -> anyhow::Result<Job> {
        Ok(Box::new(move |common, reporter| run(common, reporter, &self)))
    }
}

fn run(common: &Common, reporter: &Reporter, arguments: &MetricsArgs) -> anyhow::Result<()> {
    let inputs = [&arguments.exemplar, &arguments.result].map(|path| Input::new(path.clone()));
    if inputs.iter().all(|input| *input == Input::Stdin) {
        let failure = Failure::usage("'-' stands for both files");
        return Err(failure.hint("standard input can be read once").into());
    }
    reporter.stage("reading")?;
    let [exemplar, result] = [FileContent::read(&inputs[0])?, FileContent::read(&inputs[1])?];
    let names = inputs.map(|input| input.name());
    match (&exemplar, &result) {
        (FileContent::Library(library), FileContent::Scene(scene)) => {
            if arguments.scale != 1.0 {
                let failure = Failure::usage("--scale is for pictures; a scene has the scale of its library");
                return Err(failure.hint("leave it away, or give a picture of one of them").into());
            }
            arrangement::run(common, reporter, names, library, scene)
        }
        _ => pictures::run(common, reporter, names, &exemplar, &result, arguments.scale),
    }
}
