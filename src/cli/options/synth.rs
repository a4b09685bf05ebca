//! How a texture is synthesised.

use crate::cli::number::Takes;
use crate::cli::values::{Axes, Size, WeightsFrom, named, one_of};
use clap::Args;
use serde::Serialize;
use vtex::scene::{Ablation, Edge, LatticeChoice, Method, SynthParams, Weights};

const PARTS: [&str; 24] = [
    "secondary",
    "overlap",
    "density",
    "decay",
    "improve",
    "growth",
    "removal",
    "copies",
    "seeds",
    "neighbourhoods",
    "matching",
    "shape-context",
    "link",
    "shape",
    "switch",
    "merge",
    "split",
    "depth",
    "edge",
    "robust",
    "orientation",
    "existence",
    "patches",
    "mend",
];

/// Section `[synth]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Synthesis (lengths in pixels of the canvas)")]
pub(crate) struct SynthFlags {
    /// Canvas size: 1000, 1000x600, 300mm, 12in, 3mx1m
    ///
    /// Numbers are pixels of the photograph or units of the drawing. Lengths in mm, cm, m, in or pt are the size of the
    /// page, which SVG, PDF and PNG state exactly; see --dpi. auto: 1000, or 3 x 3 pages of a drawing, shown at 900 px
    #[arg(long, value_name = "SIZE")]
    #[arg(takes = format!("{}, default: auto", Size::canvas(SynthParams::SIDE)))]
    pub(crate) size: Option<Size>,
    /// How elements are placed: carried from the exemplar along a field of correspondences, which keeps
    /// structure larger than a few elements; one by one by the descriptors of their neighbours; by the
    /// period of a drawing whose borders join; by clusters of samples, for a drawing; as curves, for a
    /// drawing of lines that run on or of cells side by side; or as the library allows [auto, correspondence,
    /// descriptor, period, clustered or curves, default: auto]
    #[arg(long, value_name = "METHOD", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["auto", "correspondence", "descriptor", "period", "clustered", "curves"], named::<Method>))]
    pub(crate) method: Option<Method>,
    /// Share of a periodic drawing's free elements that leave their places: 0 repeats its period exactly
    #[arg(long, number_or(SynthParams::VARIATION, "0 for a regular drawing, else 1"), value_name = "SHARE")]
    pub(crate) variation: Option<f64>,
    /// Rows or lattice that the texture keeps to: as found in the exemplar, none, or one or two vectors in its
    /// pixels [auto, off, or AX,AY or AX,AY,BX,BY, default: auto]
    #[arg(long, value_name = "VECTORS", allow_hyphen_values = true)]
    pub(crate) lattice: Option<LatticeChoice>,
    /// Elements tried for each place, by descriptors
    #[arg(long, number = SynthParams::CANDIDATES)]
    pub(crate) candidates: Option<u32>,
    /// Moves by one cell that may better a placement
    #[arg(long, number = SynthParams::MOVES)]
    pub(crate) moves: Option<u32>,
    /// Weights of target, uncovered, empty, mismatched and same-overlap areas in the score of a
    /// placement, or the name of weights found by 'vtex tune'
    #[arg(long, value_name = "T,U,E,M,S|NAME", allow_hyphen_values = true)]
    #[arg(takes = format!("{}, default: 0.5,-0.4,-0.2,-0.5,-0.5", Weights::EACH))]
    pub(crate) weights: Option<WeightsFrom>,
    /// Make it repeat without a seam, along x, y or both axes [none, both, x or y; alone: both;
    /// default: none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    #[arg(value_parser = one_of(&Axes::NAMES, str::parse::<Axes>), hide_possible_values = true)]
    pub(crate) tile: Option<Axes>,
    /// Turn each element by a random angle, at most this much either way. Default: 0, but small photographs
    /// without a direction are turned and mirrored
    #[arg(long, number_or(SynthParams::ROTATE, "see above"))]
    pub(crate) rotate: Option<f64>,
    /// Mirror half of the elements [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) mirror: Option<bool>,
    /// Change each element's size at random, at most this much either way
    #[arg(long, number = SynthParams::SCALE_JITTER)]
    pub(crate) scale_jitter: Option<f64>,
    /// At the edge of a domain keep elements whole, clip them, or avoid it [keep, clip or avoid,
    /// default: clip]
    #[arg(long, value_name = "HOW", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["keep", "clip", "avoid"], named::<Edge>))]
    pub(crate) edge: Option<Edge>,
    /// Leave out the elements of these categories, named as by 'vtex inspect': their places are background
    /// [default: none]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) exclude: Option<Vec<String>>,
    /// Leave parts of the method out, to see what they do: secondary, overlap, density, decay,
    /// improve, growth, removal, copies, seeds, neighbourhoods, matching; of clusters also
    /// shape-context, link, shape, switch, merge, split, depth; of curves also edge, robust,
    /// orientation, existence, patches, mend [default: none]
    #[arg(long, value_name = "PART,...", value_parser = one_of(&PARTS, named::<Ablation>), value_delimiter = ',')]
    #[arg(hide_possible_values = true)]
    pub(crate) ablate: Option<Vec<Ablation>>,
}

/// Further flags of section `[synth]`; `texture` has this option from the analysis.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Synthesis (lengths in pixels of the canvas)")]
pub(crate) struct SynthBackgroundFlags {
    /// Distance between background colours
    #[arg(long, number_or(SynthParams::BACKGROUND_SPACING, "as in the library"))]
    pub(crate) background_spacing: Option<f64>,
}
