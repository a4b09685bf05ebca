//! The arguments of `vtex layers`, checked.

use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::Input;
use crate::cli::layer_maps::{MapFormat, MapTarget};
use crate::cli::number::Takes;
use crate::cli::options::analyze::layer;
use crate::cli::options::common;
use crate::cli::options::files::{ForceArgs, check_distinct, check_files};
use crate::cli::output::Destination;
use crate::cli::values::{Axes, Size, named};
use clap::Args;
use serde::Deserialize;
use std::path::PathBuf;
use vtex::Parameter;
use vtex::analyze::Exemplar;
use vtex::layers::{Count, FindParams, MOST_LAYERS};

/// Find the nested layers of a photograph, and make a new map of them
#[derive(Args)]
#[command(
    override_usage = "vtex layers [OPTIONS] <INPUT>\n       vtex layers [OPTIONS] --heights <FILE>",
    mut_args(common(&["layers", "size", "tile"])),
    after_long_help = "\
Examples:
  vtex layers rust.jpg -o map.png --size 1000 --save-layers layers.png
  vtex layers rust.lib.json -o map.png --size 1000 --seed 3
  vtex layers layers.png -o map.svg --size 1000x600 --tile
  vtex layers rust.jpg -o map.png --sketch strokes.png
  vtex layers rust.jpg -o map.png --keep old.png --hole hole.png
  vtex layers --heights terrain16.png -o new.png --size 2000

The region of a layer contains all layers above it. A layer map is a picture
with one flat colour for each layer. A PNG from vtex lists these colours in its
palette, the bottom layer first."
)]
pub(crate) struct LayersArgs {
    /// A photograph, its library, or a layer map: a picture in 2 to 6 flat colours; - reads stdin
    #[arg(value_name = "INPUT", required_unless_present_any = ["heights", "dump_config"])]
    pub(super) input: Option<PathBuf>,
    /// The new map: .png, .svg or .json; - writes PNG to stdout [default: ./INPUT.layers.png]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Also write the layers of the photograph as a map of the same size: .png, .svg or .json
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) save_layers: Option<PathBuf>,
    /// Write 16-bit grey values that rise within each layer, from the border of the layer below to the border
    /// of the layer above; .png only
    #[arg(long, help_heading = "Output")]
    pub(super) continuous: bool,
    #[command(flatten)]
    pub(super) force: ForceArgs,
    /// Number of layers
    #[arg(long, value_name = "COUNT", value_parser = count, help_heading = "Layers of the photograph")]
    #[arg(takes = format!("auto, or {LAYERS}, default: auto"))]
    pub(super) layers: Option<Count>,
    /// New order of the layers, from bottom to top. The layers found are numbered from 0 at the bottom
    /// [default: the one in which layers that are not next to each other touch least]
    #[arg(long, value_name = "LAYER,...", value_delimiter = ',', help_heading = "Layers of the photograph")]
    #[arg(value_parser = layer::<usize>)]
    pub(super) layer_order: Option<Vec<usize>>,
    /// Use a painted map in place of the layers found, as large as the photograph
    #[arg(long, value_name = "FILE", help_heading = "Layers of the photograph", conflicts_with = "layers")]
    pub(super) layer_map: Option<PathBuf>,
    /// Size of the map: 1000, 1000x600, or at 96 px per inch: 300mm, 12in
    #[arg(long, value_name = "SIZE", help_heading = "The new map")]
    #[arg(takes = format!("1 to {} px each, default: as the input", Exemplar::LARGEST_SIDE))]
    pub(super) size: Option<Size>,
    /// Make the map repeat without a seam, along x, y or both axes [none, both, x or y; alone: both; default:
    /// none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    #[arg(help_heading = "The new map")]
    pub(super) tile: Option<Axes>,
    /// How to make the map: correspondence copies patches of the photograph, boundary makes similar borders
    /// [correspondence or boundary, default: correspondence]
    #[arg(long, value_name = "METHOD", value_parser = named::<MapMethod>, help_heading = "The new map")]
    pub(super) layer_method: Option<MapMethod>,
    /// Keep strokes in the colours of the layers, on a transparent or white background; lower layers appear
    /// around them
    #[arg(long, value_name = "FILE", help_heading = "Given maps (they set the size)")]
    #[arg(conflicts_with_all = ["keep", "control", "layer_method"])]
    pub(super) sketch: Option<PathBuf>,
    /// Keep this map outside --hole; it is in the colours of the layers
    #[arg(long, value_name = "FILE", help_heading = "Given maps (they set the size)", requires = "hole")]
    #[arg(conflicts_with_all = ["control", "layer_method"])]
    pub(super) keep: Option<PathBuf>,
    /// The part of --keep to make again: the white pixels, or the opaque ones if the picture has transparency
    #[arg(long, value_name = "FILE", help_heading = "Given maps (they set the size)", requires = "keep")]
    pub(super) hole: Option<PathBuf>,
    /// Start from a map drawn in the colours of the layers. Where layers touch that do not touch in the
    /// photograph, vtex adds thin strips of those between
    #[arg(long, value_name = "FILE", help_heading = "Given maps (they set the size)")]
    #[arg(conflicts_with = "layer_method")]
    pub(super) control: Option<PathBuf>,
    /// Make new terrain from a grey picture of heights, best with 16 bits, in place of a map; writes a 16-bit
    /// .png
    #[arg(long, value_name = "FILE", help_heading = "Terrain")]
    #[arg(conflicts_with_all = [
        "input", "save_layers", "layers", "layer_order", "layer_map", "layer_method", "sketch", "keep", "control",
    ])]
    pub(super) heights: Option<PathBuf>,
}

/// How a new map is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum MapMethod {
    #[default]
    Correspondence,
    Boundary,
}

/// Number of layers.
const LAYERS: Parameter<usize> = Parameter::new("layers", [1, MOST_LAYERS], "");

fn count(text: &str) -> Result<Count, String> {
    if text == "auto" {
        return Ok(Count::Auto);
    }
    let fixed = text.parse().ok().filter(|n| LAYERS.allows(*n));
    fixed.map(Count::Fixed).ok_or_else(|| format!("expected auto, or {LAYERS}"))
}

/// The source and the result.
pub(super) struct Mapping {
    pub(super) from: From,
    pub(super) size: Option<[usize; 2]>,
    pub(super) wrap: [bool; 2],
    pub(super) seed: u64,
    pub(super) target: MapTarget,
}

/// The source of a layer map.
pub(super) enum From {
    Heights(Input),
    Layers(Box<Layered>),
}

/// The layers of a photograph or map, and the result to be made of them.
pub(super) struct Layered {
    pub(super) input: Input,
    pub(super) parameters: FindParams,
    /// A painted map in place of layers found.
    pub(super) painted: Option<Input>,
    pub(super) save: Option<MapTarget>,
    pub(super) continuous: bool,
    pub(super) wanted: LayersResult,
}

/// The result to be made of layers.
pub(super) enum LayersResult {
    New(MapMethod),
    Sketch(Input),
    Fill { keep: Input, hole: Input },
    Control(Input),
}

impl Mapping {
    /// Checks the options.
    pub(super) fn new(a: LayersArgs, seed: u64) -> Result<Self, Failure> {
        let input = a.heights.clone().or(a.input.clone()).map(Input::new);
        let Some(input) = input else { return Err(Failure::usage("no input is given")) };
        let files: Vec<(&str, Input)> = [
            ("--layer-map", &a.layer_map),
            ("--sketch", &a.sketch),
            ("--keep", &a.keep),
            ("--hole", &a.hole),
            ("--control", &a.control),
        ]
        .into_iter()
        .filter_map(|(name, path)| Some((name, Input::new(path.clone()?))))
        .collect();
        let mut read: Vec<(&str, &Input)> = files.iter().map(|(name, file)| (*name, file)).collect();
        read.push(("the input", &input));
        let written = [("-o", a.output.as_deref()), ("--save-layers", a.save_layers.as_deref())];
        check_files(&read, &written)?;
        check_distinct(&written)?;

        let grey = a.continuous || a.heights.is_some();
        let ending = if a.heights.is_some() { "terrain" } else { "layers" };
        let target = target(a.output, a.force.force, &input, ending)?;
        if grey && target.format != MapFormat::Png {
            return Err(Failure::usage("values of 16 bits can be written as .png only")
                .hint("give -o a name that ends in .png, or leave out --continuous"));
        }
        let size = a.size.and_then(Size::pixels).map(|size| size.map(|side| side as usize));
        let wrap = a.tile.map_or([false; 2], |t| [t.0.x, t.0.y]);
        if a.heights.is_some() {
            return Ok(Self { from: From::Heights(input), size, wrap, seed, target });
        }
        let save = a.save_layers.map(|path| MapTarget::file("--save-layers", path, a.force.force));
        let wanted = match (a.sketch, a.keep, a.hole, a.control) {
            (Some(sketch), ..) => LayersResult::Sketch(Input::new(sketch)),
            (_, Some(keep), Some(hole), _) => {
                LayersResult::Fill { keep: Input::new(keep), hole: Input::new(hole) }
            }
            (.., Some(control)) => LayersResult::Control(Input::new(control)),
            _ => LayersResult::New(a.layer_method.unwrap_or_default()),
        };
        let parameters = FindParams { count: a.layers.unwrap_or_default(), order: a.layer_order, seed };
        let layered = Layered {
            input,
            parameters,
            painted: a.layer_map.map(Input::new),
            save: save.transpose()?,
            continuous: a.continuous,
            wanted,
        };
        Ok(Self { from: From::Layers(Box::new(layered)), size, wrap, seed, target })
    }
}

/// The place of a map: the given one, else stdout if the input is stdin, else a file named after the input.
fn target(output: Option<PathBuf>, force: bool, input: &Input, ending: &str) -> Result<MapTarget, Failure> {
    let path = match (output, input) {
        (Some(path), _) => path,
        (None, Input::Stdin) => "-".into(),
        (None, Input::File(path)) => {
            let mut name = format::stem(path);
            name.push(format!(".{ending}.png"));
            name.into()
        }
    };
    if path.as_os_str() == "-" {
        return Ok(MapTarget { place: Destination::Stdout, format: MapFormat::Png });
    }
    MapTarget::file("--output", path, force)
}
