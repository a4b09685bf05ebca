//! Parameters of analysis, as stored in the library.

use super::categories::Categories;
use super::{layer_count, pixel_limit};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::error::{Result, check};

/// Parameters of analysis. Lengths are in pixels of the exemplar as it is analysed, after a reduction to
/// `max_pixels`; areas in square pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct AnalyzeParams {
    /// Seed of all random choices. Default 0.
    pub seed: u64,
    /// Area of the smallest primary. 1 to 1 000 000, default 5.
    pub minimum_area: u32,
    /// Scale of the detail segmentation: a larger scale gives fewer details. 0 to 10 000, default 10.
    pub detail_scale: f64,
    /// Standard deviation of the smoothing before the detail segmentation. 0 to 10, default 0.7.
    pub detail_sigma: f64,
    /// Area of the smallest detail. 1 to 10 000, default 3.
    pub detail_minimum: u32,
    /// Largest RGB distance of a secondary's pixels to its seed, as a share of the range. 0 to 1, default
    /// 0.055. The paper's program uses 0.1, which loses the finest grain.
    pub secondary_tolerance: f64,
    /// Area of the smallest secondary. 1 to 10 000, default 3.
    pub secondary_minimum: u32,
    /// Area of the largest secondary. 1 to 100 000, default 300.
    pub secondary_maximum: u32,
    /// Number of categories of primaries. 1 to 1000, default 15.
    pub categories: Categories,
    /// Half the side of descriptors, in mean distances between neighbours. 0.5 to 10, default 2.25.
    pub descriptor_reach: f64,
    /// Distance between background sites. 4 to 1000, default 25.
    pub background_spacing: f64,
    /// Width of the strip around textons that is excluded from the background. 0 to 100, default 5.
    pub background_margin: f64,
    /// Fit tolerance: the largest distance between a fitted outline and the traced border. A larger one
    /// also allows more colour error per byte. 0.05 to 5, default 0.5.
    pub fidelity: f64,
    /// Fills of details and primaries. Default gradients.
    pub shading: Shading,
    /// Largest number of colours of primaries, details and secondaries, which then have flat fills. 0
    /// (the default) for no limit, up to 4096.
    pub colors: u32,
    /// Largest number of primaries, details and secondaries together. The least visible ones are joined
    /// or left out. 0 (the default) for no limit, up to 10 000 000.
    pub max_paths: u32,
    /// Cells along each side of a pixel, for separating details and secondaries and for tracing. 1 to 4,
    /// or 0 (the default) for 2 up to 2.5 million pixels and 1 above.
    pub cells: u32,
    /// Number of pixels above which a photograph is reduced before it is analysed, to this number or to where
    /// its elements are some 20 to 80 pixels across. 4096 to 4 000 000 000, or 0 for no limit, written as
    /// `off`. Default 1 200 000.
    #[serde(with = "pixel_limit")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "pixel_limit::schema"))]
    pub max_pixels: u32,
    /// Whether the exemplar tiles, that is, its opposite borders join. The parts of an element that a border
    /// cuts are then one element. Default false; `vtex::analyze::borders_join` tests it.
    pub wrap: bool,
    /// Number of nested layers, such as rust on paint. 1 to 6, or 0 (the default) for one to three, by the
    /// photograph, written as `auto`.
    #[serde(with = "layer_count")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "layer_count::schema"))]
    pub layers: u32,
    /// The layers found, counted from 0 at the bottom, listed from the new bottom to the new top. Empty
    /// (the default) for the order in which layers that are not next to each other touch least.
    pub layer_order: Vec<u32>,
    /// Which shapes of a drawing are one element. Default auto.
    pub elements: Grouping,
    /// Whether parts of a drawing that cannot be read are left out, rather than refused. Default false.
    pub lenient: bool,
}

/// Which shapes of a drawing are one element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Grouping {
    /// Small groups; otherwise the connected pieces of paths that lie within one another, touch, or are much
    /// nearer to each other than to all other pieces.
    #[default]
    Auto,
    /// Each outermost group that does not hold the whole drawing; other shapes by their pieces.
    Group,
    /// Each path, with all its pieces.
    Path,
    /// Each connected piece of a path: an outer ring with what lies inside.
    Piece,
}

/// Fills of details and primaries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// A single colour each.
    Flat,
    /// A linear gradient wherever it fits the photograph better than flat pieces of the same number of
    /// bytes.
    Gradient,
    /// Soft ellipses on few pieces, which may have gradients; as with `gradient` where colours or paths are limited.
    #[default]
    Soft,
}

impl Default for AnalyzeParams {
    fn default() -> Self {
        Self {
            seed: 0,
            minimum_area: 5,
            detail_scale: 10.0,
            detail_sigma: 0.7,
            detail_minimum: 3,
            secondary_tolerance: 0.055,
            secondary_minimum: 3,
            secondary_maximum: 300,
            categories: Categories::AtMost(15),
            descriptor_reach: 2.25,
            background_spacing: 25.0,
            background_margin: 5.0,
            fidelity: 0.5,
            shading: Shading::Soft,
            colors: 0,
            max_paths: 0,
            cells: 0,
            max_pixels: 1_200_000,
            wrap: false,
            layers: 0,
            layer_order: Vec::new(),
            elements: Grouping::Auto,
            lenient: false,
        }
    }
}

impl AnalyzeParams {
    /// Checks every range.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] naming the first parameter out of range.
    pub fn validate(&self) -> Result<()> {
        let integer = |name, value: u32, range: std::ops::RangeInclusive<u32>, allowed| {
            check(range.contains(&value), name, value, allowed)
        };
        let real = |name, value: f64, range: std::ops::RangeInclusive<f64>, allowed| {
            check(range.contains(&value), name, value, allowed)
        };
        integer("minimum-area", self.minimum_area, 1..=1_000_000, "1 to 1000000 px")?;
        real("detail-scale", self.detail_scale, 0.0..=10_000.0, "0 to 10000")?;
        real("detail-sigma", self.detail_sigma, 0.0..=10.0, "0 to 10 px")?;
        integer("detail-minimum", self.detail_minimum, 1..=10_000, "1 to 10000 px")?;
        real("secondary-tolerance", self.secondary_tolerance, 0.0..=1.0, "0 to 1")?;
        integer("secondary-minimum", self.secondary_minimum, 1..=10_000, "1 to 10000 px")?;
        integer("secondary-maximum", self.secondary_maximum, 1..=100_000, "1 to 100000 px")?;
        if let Categories::AtMost(number) = self.categories {
            integer("categories", number, 1..=1000, "auto or 1 to 1000")?;
        }
        real("descriptor-reach", self.descriptor_reach, 0.5..=10.0, "0.5 to 10")?;
        real("background-spacing", self.background_spacing, 4.0..=1000.0, "4 to 1000 px")?;
        real("background-margin", self.background_margin, 0.0..=100.0, "0 to 100 px")?;
        integer("colors", self.colors, 0..=4096, "0 to 4096")?;
        integer("max-paths", self.max_paths, 0..=10_000_000, "0 to 10000000")?;
        let limit = self.max_pixels;
        let known = limit == 0 || (4096..=4_000_000_000).contains(&limit);
        check(known, "max-pixels", limit, "4096 to 4000000000, or off")?;
        integer("cells", self.cells, 0..=4, "0 to 4")?;
        integer("layers", self.layers, 0..=6, "auto, off, or 1 to 6")?;
        real("fidelity", self.fidelity, 0.05..=5.0, "0.05 to 5 px")?;
        check(
            self.secondary_minimum <= self.secondary_maximum,
            "secondary-minimum",
            self.secondary_minimum,
            "at most secondary-maximum",
        )
    }
}
