//! `vtex metrics` as clap sees it.

use clap::Args;
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
