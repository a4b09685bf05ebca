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
#[command(next_help_heading = "Analysis (lengths in pixels of the photograph, as it is analysed)")]
pub(crate) struct AnalyzeFlags {
    /// Segmenter that finds the elements: auto is sam if a model was added, else texton [auto, texton, regions,
    /// felzenszwalb or sam, default: auto]
    #[arg(long, value_name = "NAME", value_enum, hide_possible_values = true, help_heading = "Segmentation")]
    pub(crate) segmenter: Option<SegmenterName>,
    /// Smallest primary
    #[arg(long, visible_alias = "min-area", number = AnalyzeParams::MINIMUM_AREA)]
    pub(crate) minimum_area: Option<u32>,
    /// Scale of details: larger means fewer
    #[arg(long, number = AnalyzeParams::DETAIL_SCALE)]
    pub(crate) detail_scale: Option<f64>,
    /// Smoothing before details are sought
    #[arg(long, number = AnalyzeParams::DETAIL_SIGMA)]
    pub(crate) detail_sigma: Option<f64>,
    /// Smallest detail
    #[arg(long, number = AnalyzeParams::DETAIL_MINIMUM)]
    pub(crate) detail_minimum: Option<u32>,
    /// Colour difference within a secondary, a share
    #[arg(long, number = AnalyzeParams::SECONDARY_TOLERANCE, value_name = "SHARE")]
    pub(crate) secondary_tolerance: Option<f64>,
    /// Smallest secondary
    #[arg(long, number = AnalyzeParams::SECONDARY_MINIMUM)]
    pub(crate) secondary_minimum: Option<u32>,
    /// Largest secondary
    #[arg(long, number = AnalyzeParams::SECONDARY_MAXIMUM)]
    pub(crate) secondary_maximum: Option<u32>,
    /// Categories of elements: a number, or as many as the eye tells apart
    #[arg(long, value_name = "NUMBER")]
    #[arg(takes = format!("auto or {}, default: auto", AnalyzeParams::CATEGORIES))]
    pub(crate) categories: Option<Categories>,
    /// How far an element sees, in mean distances between elements
    #[arg(long, number = AnalyzeParams::DESCRIPTOR_REACH)]
    pub(crate) descriptor_reach: Option<f64>,
    /// Distance between background colours
    #[arg(long, number = AnalyzeParams::BACKGROUND_SPACING)]
    pub(crate) background_spacing: Option<f64>,
    /// Strip around elements that is not background
    #[arg(long, number = AnalyzeParams::BACKGROUND_MARGIN)]
    pub(crate) background_margin: Option<f64>,
    /// Distance of smooth outlines from the photograph's; larger also means fewer shapes
    #[arg(long, number = AnalyzeParams::FIDELITY)]
    pub(crate) fidelity: Option<f64>,
    /// Fill elements with one colour each, with gradients where these tell more, or shade them softly
    /// [flat, gradient or soft, default: soft]
    #[arg(long, value_name = "HOW", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["flat", "gradient", "soft"], named::<Shading>))]
    pub(crate) shading: Option<Shading>,
    /// Most colours, all flat, the background of a vectorized photograph included; 0: as many as there are
    #[arg(long, alias = "colours", number = AnalyzeParams::COLORS)]
    pub(crate) colors: Option<u32>,
    /// Most elements and details together; 0: as many as there are
    #[arg(long, number = AnalyzeParams::MAX_PATHS)]
    pub(crate) max_paths: Option<u32>,
    /// Cells along each side of a pixel, on which small shapes are told apart; 0: as fits the photograph
    #[arg(long, number = AnalyzeParams::CELLS)]
    pub(crate) cells: Option<u32>,
    /// Reduce a larger photograph first, to so many pixels, or to where its elements are some 20 to 80 px
    /// across; 1.5M is 1500000. Sizes of results stay in the photograph's own pixels
    #[arg(long, value_name = "NUMBER", value_parser = pixel_limit)]
    #[arg(takes = format!("{MAX_PIXELS}, or off, default: {}", MAX_PIXELS.default()))]
    pub(crate) max_pixels: Option<u32>,
    /// Stretch the contrast of a subtle picture before the analysis: auto measures the factor, and results
    /// have the picture's own colours
    #[arg(long, value_name = "FACTOR")]
    #[arg(takes = format!("auto, off, or {}, default: auto", AnalyzeParams::CONTRAST))]
    pub(crate) contrast: Option<Contrast>,
    /// Take slow changes of light out before the analysis, such as of a plate lit from one side. auto: where
    /// they are seen, but not in a picture that wraps and not for vectorize [auto, on or off; alone: on; default: auto]
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    #[arg(hide_possible_values = true)]
    #[arg(value_parser = one_of(&["auto", "on", "off"], named::<EvenLight>))]
    pub(crate) even_light: Option<EvenLight>,
    /// The exemplar tiles: opposite borders join, and what they cut is one element. auto: where they are
    /// seen to, but for vectorize [auto, on or off; alone: on; default: auto]
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "on")]
    #[arg(hide_possible_values = true)]
    #[arg(value_parser = one_of(&Wrap::NAMES, str::parse::<Wrap>))]
    pub(crate) wrap: Option<Wrap>,
    /// What a picture shows: a photograph, or lines on paper, each of which becomes a stroke along its middle
    /// [photo or curves, default: photo]
    #[arg(long, value_name = "KIND", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["photo", "curves"], named::<PictureKind>))]
    pub(crate) kind: Option<PictureKind>,
    /// Which shapes of a drawing are one element: small groups, and pieces that belong together by
    /// their places; each group; each path; each connected piece [auto, group, path or piece, default:
    /// auto]
    #[arg(long, value_name = "HOW", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["auto", "group", "path", "piece"], named::<Grouping>))]
    pub(crate) elements: Option<Grouping>,
    /// Which elements of a drawing are a motif, which textures keep together: those whose relative places
    /// recur, or that are much nearer to each other than to all others; those that touch; none [auto, contact
    /// or none, default: auto]
    #[arg(long, value_name = "HOW", hide_possible_values = true, help_heading = "Drawings")]
    #[arg(value_parser = one_of(&["auto", "contact", "none"], named::<MotifGrouping>))]
    pub(crate) group: Option<MotifGrouping>,
    /// Leave out what cannot be read of a drawing: raster images, filters, masks, pattern fills
    /// [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true, help_heading = "Drawings")]
    pub(crate) lenient: Option<bool>,
    /// Nested layers, such as rust on paint: found if the photograph has them, none, or a number
    #[arg(long, value_name = "COUNT", value_parser = layer_count, help_heading = "Layers of the photograph")]
    #[arg(takes = format!("auto, off, or {}, default: auto", AnalyzeParams::LAYERS))]
    pub(crate) layers: Option<u32>,
    /// Their order: the layers found, counted from 0 at the bottom, from the new bottom to the new top;
    /// none: that in which layers that are not next to each other touch least [default: none]
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
