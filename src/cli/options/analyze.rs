//! How a photograph is analyzed.
//!
//! Options that stand in a configuration file too are `Option`s, so that one given on the command
//! line is distinguished from a default. Ranges and defaults of numbers are those of the parameter structs.

use crate::cli::number::{Takes, within};
use crate::cli::values::{Wrap, named, one_of};
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use vtex::Parameter;
use vtex::library::{
    AnalyzeParams, Categories, Contrast, EvenLight, Grouping, MotifGrouping, PictureKind, Shading,
};

/// The segmenter that finds the masks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SegmenterName {
    #[default]
    Auto,
    Texton,
    Regions,
    Felzenszwalb,
    Sam,
}

const MAX_PIXELS: Parameter<u32> = AnalyzeParams::MAX_PIXELS;

/// Section `[analyze]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Analysis (lengths in pixels of the analysed photograph)")]
pub(crate) struct AnalyzeFlags {
    /// Segmenter that finds the elements; auto is sam if you added a model, else texton [auto, texton,
    /// regions, felzenszwalb or sam, default: auto]
    #[arg(long, value_name = "NAME", value_enum, hide_possible_values = true, help_heading = "Segmentation")]
    pub(crate) segmenter: Option<SegmenterName>,
    /// Minimum size of a primary
    #[arg(long, visible_alias = "min-area", number = AnalyzeParams::MINIMUM_AREA)]
    pub(crate) minimum_area: Option<u32>,
    /// Scale of details; a larger number gives fewer details
    #[arg(long, number = AnalyzeParams::DETAIL_SCALE)]
    pub(crate) detail_scale: Option<f64>,
    /// Smoothing before vtex looks for details
    #[arg(long, number = AnalyzeParams::DETAIL_SIGMA)]
    pub(crate) detail_sigma: Option<f64>,
    /// Minimum size of a detail
    #[arg(long, number = AnalyzeParams::DETAIL_MINIMUM)]
    pub(crate) detail_minimum: Option<u32>,
    /// Maximum colour difference within a secondary; 1 is the full range
    #[arg(long, number = AnalyzeParams::SECONDARY_TOLERANCE, value_name = "SHARE")]
    pub(crate) secondary_tolerance: Option<f64>,
    /// Minimum size of a secondary
    #[arg(long, number = AnalyzeParams::SECONDARY_MINIMUM)]
    pub(crate) secondary_minimum: Option<u32>,
    /// Maximum size of a secondary
    #[arg(long, number = AnalyzeParams::SECONDARY_MAXIMUM)]
    pub(crate) secondary_maximum: Option<u32>,
    /// Maximum number of categories of elements; auto makes as many as the eye distinguishes
    #[arg(long, value_name = "NUMBER")]
    #[arg(takes = format!("auto or {}, default: auto", AnalyzeParams::CATEGORIES))]
    pub(crate) categories: Option<Categories>,
    /// Reach of descriptors, in mean distances between elements
    #[arg(long, number = AnalyzeParams::DESCRIPTOR_REACH)]
    pub(crate) descriptor_reach: Option<f64>,
    /// Distance between colour samples of the background
    #[arg(long, number = AnalyzeParams::BACKGROUND_SPACING)]
    pub(crate) background_spacing: Option<f64>,
    /// Margin around elements left out of the background
    #[arg(long, number = AnalyzeParams::BACKGROUND_MARGIN)]
    pub(crate) background_margin: Option<f64>,
    /// Maximum distance of outlines from those in the photograph; a larger number also gives fewer shapes
    #[arg(long, number = AnalyzeParams::FIDELITY)]
    pub(crate) fidelity: Option<f64>,
    /// Fill elements with one colour each, use gradients where they fit better, or shade elements softly
    /// [flat, gradient or soft, default: soft]
    #[arg(long, value_name = "HOW", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["flat", "gradient", "soft"], named::<Shading>))]
    pub(crate) shading: Option<Shading>,
    /// Maximum number of colours, all flat, including the background in vectorize; 0: no limit
    #[arg(long, alias = "colours", number = AnalyzeParams::COLORS)]
    pub(crate) colors: Option<u32>,
    /// Maximum number of elements and details together; 0: no limit
    #[arg(long, number = AnalyzeParams::MAX_PATHS)]
    pub(crate) max_paths: Option<u32>,
    /// Cells per side of a pixel, used to separate small shapes; 0: set by the size of the photograph
    #[arg(long, number = AnalyzeParams::CELLS)]
    pub(crate) cells: Option<u32>,
    /// Reduce a larger photograph first, to at most this many pixels, or until its elements are about 20 to
    /// 80 px across; 1.5M is 1500000. Sizes of results remain pixels of the original photograph
    #[arg(long, value_name = "NUMBER", value_parser = pixel_limit)]
    #[arg(takes = format!("{MAX_PIXELS}, or off, default: {}", MAX_PIXELS.default()))]
    pub(crate) max_pixels: Option<u32>,
    /// Stretch the contrast of a subtle picture, for the analysis only; auto measures the factor
    #[arg(long, value_name = "FACTOR")]
    #[arg(takes = format!("auto, off, or {}, default: auto", AnalyzeParams::CONTRAST))]
    pub(crate) contrast: Option<Contrast>,
    /// Remove slow changes of light before the analysis, such as on a plate lit from one side. auto: if vtex
    /// detects them, but not if the picture tiles, and not in vectorize [auto, on or off; default: auto]
    #[arg(long, value_name = "WHETHER", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["auto", "on", "off"], named::<EvenLight>))]
    pub(crate) even_light: Option<EvenLight>,
    /// Treat the exemplar as a tile: opposite borders join, and so do elements that they cut. auto: if the
    /// borders join, but not in vectorize [auto, on or off; alone: on; default: auto]
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    #[arg(hide_possible_values = true)]
    #[arg(value_parser = one_of(&Wrap::NAMES, str::parse::<Wrap>))]
    pub(crate) wrap: Option<Wrap>,
    /// What the picture shows: a photograph, or lines on paper. Each line becomes a stroke along its middle
    /// [photo or curves, default: photo]
    #[arg(long, value_name = "KIND", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["photo", "curves"], named::<PictureKind>))]
    pub(crate) kind: Option<PictureKind>,
    /// Which shapes of a drawing are one element: each group, each path, or each connected piece of a path.
    /// auto: small groups, and shapes that belong together by their positions [auto, group, path or piece,
    /// default: auto]
    #[arg(long, value_name = "HOW", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["auto", "group", "path", "piece"], named::<Grouping>))]
    pub(crate) elements: Option<Grouping>,
    /// Which elements of a drawing are a motif, which textures keep together. auto: those whose relative
    /// positions recur, or that are much nearer to each other than to all others; contact: those that touch;
    /// none: no motifs [auto, contact or none, default: auto]
    #[arg(long, value_name = "HOW", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["auto", "contact", "none"], named::<MotifGrouping>))]
    pub(crate) group: Option<MotifGrouping>,
    /// Leave out parts of a drawing that vtex cannot read: raster images, filters, masks, some pattern fills
    /// [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true, help_heading = "Drawings")]
    pub(crate) lenient: Option<bool>,
    /// Number of nested layers, such as rust on paint; auto finds them, off finds none
    #[arg(long, value_name = "COUNT", value_parser = layer_count, help_heading = "Layers of the photograph")]
    #[arg(takes = format!("auto, off, or {}, default: auto", AnalyzeParams::LAYERS))]
    pub(crate) layers: Option<u32>,
    /// New order of the layers, from bottom to top. The layers found are numbered from 0 at the bottom. none:
    /// the order in which layers that are not neighbours touch least [default: none]
    #[arg(long, value_name = "LAYER,...", value_delimiter = ',', help_heading = "Layers of the photograph")]
    #[arg(value_parser = layer::<u32>)]
    pub(crate) layer_order: Option<Vec<u32>>,
}

/// The number of a layer.
pub(crate) fn layer<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| "expected numbers of layers, counted from 0, such as 1,0,2".to_owned())
}

/// A number of layers as the parameters have it: 0 stands for auto.
pub(crate) fn layer_count(text: &str) -> Result<u32, String> {
    match text {
        "auto" => Ok(0),
        "off" => Ok(1),
        number => within(AnalyzeParams::LAYERS)(number)
            .map_err(|_| format!("expected auto, off, or {}", AnalyzeParams::LAYERS)),
    }
}

/// A limit of pixels as the parameters have it: 0 stands for off.
pub(crate) fn pixel_limit(text: &str) -> Result<u32, String> {
    let expected = || format!("expected off, or {MAX_PIXELS}, such as 1500000 or 1.5M");
    if text == "off" {
        return Ok(0);
    }
    let (digits, unit) = match text.strip_suffix(['M', 'm']) {
        Some(digits) => (digits, 1e6),
        None => (text, 1.0),
    };
    let value = digits.parse::<f64>().map_err(|_| expected())? * unit;
    let known = value.fract() == 0.0 && MAX_PIXELS.allows(value as u32);
    if known { Ok(value as u32) } else { Err(expected()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_pixels_are_numbers_megapixels_or_off() {
        let read = |text: &str| pixel_limit(text).ok();
        assert_eq!(
            ["off", "4096", "1.5M", "12M"].map(read),
            [Some(0), Some(4096), Some(1_500_000), Some(12_000_000)]
        );
        assert_eq!(
            ["", "M", "4095", "-1", "5000M", "1e5.5", "5000.5", "NaN", "inf", "on"].map(read),
            [None; 10]
        );
    }
}
