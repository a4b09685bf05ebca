//! Parameters of analysis, as stored in the library.

use super::categories::Categories;
use super::contrast::Contrast;
use super::{layer_count, pixel_limit};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::Parameter;
use vtex_base::error::{Result, check};

/// Parameters of analysis. Lengths are in pixels of the exemplar as it is analysed, after a reduction to
/// `max_pixels`; areas in square pixels. Ranges and defaults of numbers are constants, such as
/// [`AnalyzeParams::FIDELITY`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct AnalyzeParams {
    /// What a picture shows. Default a photograph, which is not stored.
    #[serde(skip_serializing_if = "PictureKind::is_default")]
    pub kind: PictureKind,
    /// Seed of all random choices. Default 0.
    pub seed: u64,
    /// Area of the smallest primary.
    #[cfg_attr(feature = "schema", schemars(transform = Self::MINIMUM_AREA.limits()))]
    pub minimum_area: u32,
    /// Scale of the detail segmentation: a larger scale gives fewer details.
    #[cfg_attr(feature = "schema", schemars(transform = Self::DETAIL_SCALE.limits()))]
    pub detail_scale: f64,
    /// Standard deviation of the smoothing before the detail segmentation.
    #[cfg_attr(feature = "schema", schemars(transform = Self::DETAIL_SIGMA.limits()))]
    pub detail_sigma: f64,
    /// Area of the smallest detail.
    #[cfg_attr(feature = "schema", schemars(transform = Self::DETAIL_MINIMUM.limits()))]
    pub detail_minimum: u32,
    /// Largest RGB distance of a secondary's pixels to its seed, as a share of the range. The
    /// paper's program uses 0.1, which loses the finest grain.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SECONDARY_TOLERANCE.limits()))]
    pub secondary_tolerance: f64,
    /// Area of the smallest secondary.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SECONDARY_MINIMUM.limits()))]
    pub secondary_minimum: u32,
    /// Area of the largest secondary.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SECONDARY_MAXIMUM.limits()))]
    pub secondary_maximum: u32,
    /// Number of categories of primaries. Default auto.
    pub categories: Categories,
    /// Half the side of descriptors, in mean distances between neighbours.
    #[cfg_attr(feature = "schema", schemars(transform = Self::DESCRIPTOR_REACH.limits()))]
    pub descriptor_reach: f64,
    /// Distance between background sites.
    #[cfg_attr(feature = "schema", schemars(transform = Self::BACKGROUND_SPACING.limits()))]
    pub background_spacing: f64,
    /// Width of the strip around textons that is excluded from the background.
    #[cfg_attr(feature = "schema", schemars(transform = Self::BACKGROUND_MARGIN.limits()))]
    pub background_margin: f64,
    /// Fit tolerance: the largest distance between a fitted outline and the traced border. A larger one
    /// also allows more colour error per byte.
    #[cfg_attr(feature = "schema", schemars(transform = Self::FIDELITY.limits()))]
    pub fidelity: f64,
    /// Fills of details and primaries. Default soft.
    pub shading: Shading,
    /// Largest number of colours of primaries, details and secondaries, which then have flat fills. 0
    /// for no limit.
    #[cfg_attr(feature = "schema", schemars(transform = Self::COLORS.limits()))]
    pub colors: u32,
    /// Largest number of primaries, details and secondaries together. The least visible ones are joined
    /// or left out. 0 for no limit.
    #[cfg_attr(feature = "schema", schemars(transform = Self::MAX_PATHS.limits()))]
    pub max_paths: u32,
    /// Cells along each side of a pixel, for separating details and secondaries and for tracing. 0 for
    /// 2 up to 2.5 million pixels and 1 above.
    #[cfg_attr(feature = "schema", schemars(transform = Self::CELLS.limits()))]
    pub cells: u32,
    /// Number of pixels above which a photograph is reduced before it is analysed, to this number or to where
    /// its elements are some 20 to 80 pixels across. 0 for no limit, written as `off`.
    #[serde(with = "pixel_limit")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "pixel_limit::schema"))]
    pub max_pixels: u32,
    /// Factor by which the contrast of a photograph is stretched before it is analysed; its colours come back
    /// afterwards. Default auto, which is not stored.
    #[serde(skip_serializing_if = "Contrast::is_default")]
    pub contrast: Contrast,
    /// Whether a slow change of light over a photograph is taken out before it is analysed; it does not come back. Default
    /// auto (where it is seen and the photograph does not wrap), which is not stored.
    #[serde(skip_serializing_if = "EvenLight::is_default")]
    pub even_light: EvenLight,
    /// Whether the exemplar tiles, that is, its opposite borders join. The parts of an element that a border
    /// cuts are then one element. Default false; `vtex::analyze::borders_join` tests it.
    pub wrap: bool,
    /// Number of nested layers, such as rust on paint. 0 (the default) for one to three, by the photograph,
    /// written as `auto`.
    #[serde(with = "layer_count")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "layer_count::schema"))]
    pub layers: u32,
    /// The layers found, counted from 0 at the bottom, listed from the new bottom to the new top. Empty
    /// (the default) for the order in which layers that are not next to each other touch least.
    pub layer_order: Vec<u32>,
    /// Which shapes of a drawing are one element. Default auto.
    pub elements: Grouping,
    /// Which elements of a drawing are one motif. Default auto, which is not stored.
    #[serde(skip_serializing_if = "MotifGrouping::is_default")]
    pub group: MotifGrouping,
    /// Whether parts of a drawing that cannot be read are left out, rather than refused. Default false.
    pub lenient: bool,
}

/// Whether a slow change of light is taken out of a photograph.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EvenLight {
    /// Where light explains most of the large differences of lightness.
    #[default]
    Auto,
    /// In any case.
    On,
    /// Never.
    Off,
}

impl EvenLight {
    /// Whether it is the default.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PictureKind {
    /// A photograph of a texture.
    #[default]
    Photo,
    /// Lines on paper, such as a scan of hatching: a drawing, each of whose lines is a stroke.
    Curves,
}

impl PictureKind {
    /// Whether it is the default.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
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

/// Which elements of a drawing are one motif.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MotifGrouping {
    /// Those whose relative places recur, those much nearer to each other than to all others, and those that
    /// touch or contain one another.
    #[default]
    Auto,
    /// Those that touch or contain one another.
    Contact,
    /// None.
    None,
}

impl MotifGrouping {
    /// Whether it is the default.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
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

/// Ranges, units and defaults of the fields of the same names.
#[allow(missing_docs)]
impl AnalyzeParams {
    pub const MINIMUM_AREA: Parameter<u32> =
        Parameter::new("minimum-area", [1, 1_000_000], "px of area").or(5);
    pub const DETAIL_SCALE: Parameter<f64> = Parameter::new("detail-scale", [0.0, 10_000.0], "").or(10.0);
    pub const DETAIL_SIGMA: Parameter<f64> = Parameter::new("detail-sigma", [0.0, 10.0], "px").or(0.7);
    pub const DETAIL_MINIMUM: Parameter<u32> =
        Parameter::new("detail-minimum", [1, 10_000], "px of area").or(3);
    pub const SECONDARY_TOLERANCE: Parameter<f64> =
        Parameter::new("secondary-tolerance", [0.0, 1.0], "").or(0.055);
    pub const SECONDARY_MINIMUM: Parameter<u32> =
        Parameter::new("secondary-minimum", [1, 10_000], "px of area").or(3);
    pub const SECONDARY_MAXIMUM: Parameter<u32> =
        Parameter::new("secondary-maximum", [1, 100_000], "px of area").or(300);
    pub const CATEGORIES: Parameter<u32> = Parameter::new("categories", [1, 1000], "");
    pub const DESCRIPTOR_REACH: Parameter<f64> = Parameter::new("descriptor-reach", [0.5, 10.0], "").or(2.25);
    pub const BACKGROUND_SPACING: Parameter<f64> =
        Parameter::new("background-spacing", [4.0, 1000.0], "px").or(25.0);
    pub const BACKGROUND_MARGIN: Parameter<f64> =
        Parameter::new("background-margin", [0.0, 100.0], "px").or(5.0);
    pub const FIDELITY: Parameter<f64> = Parameter::new("fidelity", [0.05, 5.0], "px").or(0.5);
    pub const COLORS: Parameter<u32> = Parameter::new("colors", [0, 4096], "").or(0);
    pub const MAX_PATHS: Parameter<u32> = Parameter::new("max-paths", [0, 10_000_000], "").or(0);
    pub const CELLS: Parameter<u32> = Parameter::new("cells", [0, 4], "").or(0);
    pub const MAX_PIXELS: Parameter<u32> =
        Parameter::new("max-pixels", [4096, 4_000_000_000], "pixels").or(1_200_000);
    pub const CONTRAST: Parameter<f64> = Parameter::new("contrast", [1.0, 10.0], "");
    pub const LAYERS: Parameter<u32> = Parameter::new("layers", [1, 6], "");
}

impl Default for AnalyzeParams {
    fn default() -> Self {
        Self {
            kind: PictureKind::Photo,
            seed: 0,
            minimum_area: Self::MINIMUM_AREA.default(),
            detail_scale: Self::DETAIL_SCALE.default(),
            detail_sigma: Self::DETAIL_SIGMA.default(),
            detail_minimum: Self::DETAIL_MINIMUM.default(),
            secondary_tolerance: Self::SECONDARY_TOLERANCE.default(),
            secondary_minimum: Self::SECONDARY_MINIMUM.default(),
            secondary_maximum: Self::SECONDARY_MAXIMUM.default(),
            categories: Categories::default(),
            descriptor_reach: Self::DESCRIPTOR_REACH.default(),
            background_spacing: Self::BACKGROUND_SPACING.default(),
            background_margin: Self::BACKGROUND_MARGIN.default(),
            fidelity: Self::FIDELITY.default(),
            shading: Shading::Soft,
            colors: Self::COLORS.default(),
            max_paths: Self::MAX_PATHS.default(),
            cells: Self::CELLS.default(),
            max_pixels: Self::MAX_PIXELS.default(),
            contrast: Contrast::Auto,
            even_light: EvenLight::Auto,
            wrap: false,
            layers: 0,
            layer_order: Vec::new(),
            elements: Grouping::Auto,
            group: MotifGrouping::Auto,
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
        Self::MINIMUM_AREA.check(self.minimum_area)?;
        Self::DETAIL_SCALE.check(self.detail_scale)?;
        Self::DETAIL_SIGMA.check(self.detail_sigma)?;
        Self::DETAIL_MINIMUM.check(self.detail_minimum)?;
        Self::SECONDARY_TOLERANCE.check(self.secondary_tolerance)?;
        Self::SECONDARY_MINIMUM.check(self.secondary_minimum)?;
        Self::SECONDARY_MAXIMUM.check(self.secondary_maximum)?;
        if let Categories::AtMost(number) = self.categories {
            Self::CATEGORIES.check(number)?;
        }
        Self::DESCRIPTOR_REACH.check(self.descriptor_reach)?;
        Self::BACKGROUND_SPACING.check(self.background_spacing)?;
        Self::BACKGROUND_MARGIN.check(self.background_margin)?;
        Self::FIDELITY.check(self.fidelity)?;
        Self::COLORS.check(self.colors)?;
        Self::MAX_PATHS.check(self.max_paths)?;
        Self::CELLS.check(self.cells)?;
        if self.max_pixels > 0 {
            Self::MAX_PIXELS.check(self.max_pixels)?;
        }
        if let Contrast::Gain(gain) = self.contrast {
            Self::CONTRAST.check(gain)?;
        }
        if self.layers > 0 {
            Self::LAYERS.check(self.layers)?;
        }
        check(
            self.secondary_minimum <= self.secondary_maximum,
            "secondary-minimum",
            self.secondary_minimum,
            "at most secondary-maximum",
        )
    }
}
