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
    /// Numbers are pixels of the photograph or units of the drawing. Lengths in mm, cm, m, in or pt set the
    /// size of the page. SVG, PDF and PNG contain it exactly; see --dpi. auto: 1000, or 3 x 3 pages of a
    /// drawing, shown at 900 px
    #[arg(long, value_name = "SIZE")]
    #[arg(takes = format!("{}, default: auto", Size::canvas(SynthParams::SIDE)))]
    pub(crate) size: Option<Size>,
    /// How to place elements. correspondence: copy the arrangement in patches, which keeps structure larger
    /// than a few elements; descriptor: one by one, by their neighbours; period: repeat a drawing whose
    /// borders join; clustered: rearrange the elements of a drawing; curves: make new lines like those of a
    /// drawing, or rearrange its cells; auto: choose by the library [auto, correspondence, descriptor,
    /// period, clustered or curves, default: auto]
    #[arg(long, value_name = "METHOD", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["auto", "correspondence", "descriptor", "period", "clustered", "curves"], named::<Method>))]
    pub(crate) method: Option<Method>,
    /// How freely to rearrange a drawing: by period, the share of movable elements that move; 0 repeats it
    /// exactly
    #[arg(long, number_or(SynthParams::VARIATION, "1; by period 0 for most regular drawings"))]
    #[arg(value_name = "SHARE")]
    pub(crate) variation: Option<f64>,
    /// Rows or lattice that the texture follows: as found in the exemplar, none, or one or two steps in its
    /// pixels [auto, off, or AX,AY or AX,AY,BX,BY, default: auto]
    #[arg(long, value_name = "VECTORS", allow_hyphen_values = true)]
    pub(crate) lattice: Option<LatticeChoice>,
    /// Elements compared for each position (descriptor), or half as many for each gap that is filled
    /// (descriptor and correspondence)
    #[arg(long, number = SynthParams::CANDIDATES)]
    pub(crate) candidates: Option<u32>,
    /// Maximum moves to a better position, for each element (descriptor and correspondence)
    #[arg(long, number = SynthParams::MOVES)]
    pub(crate) moves: Option<u32>,
    /// Weights in the score of a placement, for target, uncovered, empty, mismatched and same-overlap areas;
    /// or the name of weights from 'vtex tune'
    #[arg(long, value_name = "T,U,E,M,S|NAME", allow_hyphen_values = true)]
    #[arg(takes = format!("{}, default: 0.5,-0.4,-0.2,-0.5,-0.5", Weights::EACH))]
    pub(crate) weights: Option<WeightsFrom>,
    /// Make the texture repeat without a seam, along x, y or both axes [none, both, x or y; alone: both;
    /// default: none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    #[arg(value_parser = one_of(&Axes::NAMES, str::parse::<Axes>), hide_possible_values = true)]
    pub(crate) tile: Option<Axes>,
    /// Turn each element at random, by at most this angle either way. Default: 0, but vtex turns and mirrors
    /// elements of small photographs without a direction
    #[arg(long, number_or(SynthParams::ROTATE, "see above"))]
    pub(crate) rotate: Option<f64>,
    /// Mirror a random half of the elements [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) mirror: Option<bool>,
    /// Change the size of each element at random, by at most this much either way
    #[arg(long, number = SynthParams::SCALE_JITTER)]
    pub(crate) scale_jitter: Option<f64>,
    /// Elements at the edge of a domain: keep them whole, clip them, or avoid the edge [keep, clip or avoid,
    /// default: clip]
    #[arg(long, value_name = "HOW", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["keep", "clip", "avoid"], named::<Edge>))]
    pub(crate) edge: Option<Edge>,
    /// Leave out the elements of these categories, with names as in 'vtex inspect'; background replaces them
    /// [default: none]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) exclude: Option<Vec<String>>,
    /// Leave out parts of the method, to see their effect: secondary, overlap, density, decay, improve,
    /// growth, removal, copies, seeds, neighbourhoods, matching; for clustered also shape-context, link,
    /// shape, switch, merge, split, depth; for curves also edge, robust, orientation, existence, patches,
    /// mend [default: none]
    #[arg(long, value_name = "PART,...", value_parser = one_of(&PARTS, named::<Ablation>), value_delimiter = ',')]
    #[arg(hide_possible_values = true)]
    pub(crate) ablate: Option<Vec<Ablation>>,
}

/// Further flags of section `[synth]`; `texture` has this option from the analysis.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Synthesis (lengths in pixels of the canvas)")]
pub(crate) struct SynthBackgroundFlags {
    /// Distance between colour samples of the background
    #[arg(long, number_or(SynthParams::BACKGROUND_SPACING, "as in the library"))]
    pub(crate) background_spacing: Option<f64>,
}
