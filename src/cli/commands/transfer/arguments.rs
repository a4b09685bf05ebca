//! The arguments of `vtex transfer`.

use crate::cli::format::{self, Lists};
use crate::cli::number::Takes;
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::files::ForceArgs;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::values::{named, one_of};
use clap::Args;
use std::path::PathBuf;
use vtex::scene::TransferMode;
use vtex::transfer::{Keep, StylizeParams, TransferParams};

/// Redraw a texture or a picture with the elements of another texture
#[derive(Args)]
#[command(
    override_usage = "vtex transfer [OPTIONS] --structure <FILE> --appearance <FILE>...\n       \
        vtex transfer [OPTIONS] --onto <PICTURE> --appearance <FILE>",
    after_long_help = "\
Examples:
  vtex transfer --structure a.scene.json --appearance b.lib.json -o out.svg
  vtex transfer --structure a.lib.json --appearance b.lib.json --mode mean
  vtex transfer --structure a.json --appearance b.json c.json --map m.png
  vtex transfer --onto portrait.jpg --appearance leaves.lib.json

A library gives the arrangement of its exemplar. Photographs and drawings are
analysed first, as with 'vtex analyze'. Every element of a structure keeps its
position, size and direction. Very thin elements keep their shape, and their
number is reported. Elements on a picture follow its edges, and are small where
it has detail."
)]
pub(crate) struct TransferArgs {
    /// Texture whose arrangement to keep: a scene or a library, plain or gzip, a photograph or a drawing; -
    /// reads stdin
    #[arg(long, value_name = "FILE", required_unless_present_any = ["onto", "dump_config"])]
    pub(super) structure: Option<PathBuf>,
    /// Picture to redraw, in place of a structure: PNG, JPEG, TIFF, WebP, BMP, GIF, PNM or SVG; - reads stdin
    #[arg(long, value_name = "PICTURE", conflicts_with_all = ["structure", "map", "mode", "element_scale"])]
    pub(super) onto: Option<PathBuf>,
    /// Texture that gives the look: a scene or a library, plain or gzip, a photograph or a drawing; several
    /// with --map
    #[arg(long, value_name = "FILE", num_args = 1.., required_unless_present = "dump_config")]
    pub(super) appearance: Vec<PathBuf>,
    /// Where to use which appearance: a picture with one colour for each, in the order of its palette, else
    /// from dark to light. For two, a grey picture is enough
    #[arg(long, value_name = "FILE")]
    pub(super) map: Option<PathBuf>,
    /// Take only the mean colours, or replace each element by a random one [mean or replace, default:
    /// replace]
    #[arg(long, value_name = "WORD", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["mean", "replace"], named::<TransferMode>))]
    pub(super) mode: Option<TransferMode>,
    /// Scale all elements by this factor
    #[arg(long, number = TransferParams::SCALE, default_value_t = TransferParams::SCALE.default())]
    #[arg(hide_short_help = true)]
    pub(super) element_scale: f64,
    /// Give elements the lightness or the colours of the picture; none: keep their own, and choose the
    /// nearest [lightness, color or none, default: color]
    #[arg(long, value_name = "WORD", hide_possible_values = true, help_heading = ONTO)]
    #[arg(value_parser = one_of(&["lightness", "color", "none"], named::<Keep>), conflicts_with = "structure")]
    pub(super) keep: Option<Keep>,
    /// Longer side of the canvas
    #[arg(long, number = StylizeParams::SIZE, default_value_t = StylizeParams::SIZE.default())]
    #[arg(help_heading = ONTO, conflicts_with = "structure")]
    pub(super) longer_side: u32,
    /// Distance between the largest elements
    #[arg(long, number_or(StylizeParams::ELEMENT, "a 28th of the longer side"))]
    #[arg(help_heading = ONTO, conflicts_with = "structure")]
    pub(super) element_size: Option<f64>,
    /// Number of element sizes, each half of the one before; more give finer detail
    #[arg(long, number = StylizeParams::LEVELS, default_value_t = StylizeParams::LEVELS.default())]
    #[arg(help_heading = ONTO, conflicts_with = "structure")]
    pub(super) levels: u32,
    /// Result: {formats} [default: ./STRUCTURE.transfer.svg or ./PICTURE.stylized.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = format::OF_SCENE)]
    pub(super) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
    #[command(flatten)]
    pub(super) force: ForceArgs,
    #[command(flatten)]
    pub(super) render: RenderFlags,
    #[command(flatten)]
    pub(super) svg: SvgFlags,
}

/// The heading of options for a picture.
const ONTO: &str = "Redrawing (with --onto)";
