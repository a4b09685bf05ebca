//! Parameters of analysis, as stored in the library.

use crate::error::{Result, check};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of analysis. Lengths in exemplar pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AnalyzeParams {
    /// Seed of the random streams. Default 0.
    pub seed: u64,
    /// Smallest primary, in pixels. 1 to 1 000 000, default 5.
    pub minimum_area: u32,
    /// Scale of the detail segmentation: larger means fewer details. 0 to 10 000, default 10.
    pub detail_scale: f64,
    /// Smoothing before the detail segmentation. 0 to 10, default 0.7.
    pub detail_sigma: f64,
    /// Smallest detail, in pixels. 1 to 10 000, default 3.
    pub detail_minimum: u32,
    /// Largest RGB distance to the seed of a secondary, as a share of the range. 0 to 1, default 0.055
    /// (the paper's program uses 0.1, and loses the finest grain).
    pub secondary_tolerance: f64,
    /// Smallest secondary, in pixels. 1 to 10 000, default 3.
    pub secondary_minimum: u32,
    /// Largest secondary, in pixels. 1 to 100 000, default 300.
    pub secondary_maximum: u32,
    /// Number of categories. 1 to 1000, default 15.
    pub categories: u32,
    /// Half size of descriptors, in mean distances between neighbours. 0.5 to 10, default 2.25.
    pub descriptor_reach: f64,
    /// Distance between background sites. 4 to 1000, default 25.
    pub background_spacing: f64,
    /// Strip around textons that is not background. 0 to 100, default 5.
    pub background_margin: f64,
    /// Largest distance of a fitted outline to the traced one; what error a byte is worth grows with
    /// it. 0.05 to 5, default 0.5.
    pub fidelity: f64,
    /// What details and primaries are filled with. Default gradients.
    pub shading: Shading,
    /// Most colours of primaries, details and secondaries, which are then flat; 0 for as many as
    /// there are. 0 to 4096, default 0.
    pub colors: u32,
    /// Most primaries, details and secondaries together; what is seen least is joined or left out.
    /// 0 for as many as there are. 0 to 10 000 000, default 0.
    pub max_paths: u32,
    /// Cells along each side of a pixel on which details and secondaries are told apart and outlines
    /// traced. 0 to 4, default 0: 2 up to 2.5 million pixels, 1 above.
    pub cells: u32,
    /// The exemplar tiles: opposite borders are neighbours. Default false.
    pub wrap: bool,
}

/// What details and primaries are filled with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// One colour each.
    Flat,
    /// A linear gradient wherever one explains the photograph better, byte for byte, than more
    /// pieces of one colour.
    #[default]
    Gradient,
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
            categories: 15,
            descriptor_reach: 2.25,
            background_spacing: 25.0,
            background_margin: 5.0,
            fidelity: 0.5,
            shading: Shading::Gradient,
            colors: 0,
            max_paths: 0,
            cells: 0,
            wrap: false,
        }
    }
}

impl AnalyzeParams {
    /// Checks every range.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] naming the first parameter out of range.
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
        integer("categories", self.categories, 1..=1000, "1 to 1000")?;
        real("descriptor-reach", self.descriptor_reach, 0.5..=10.0, "0.5 to 10")?;
        real("background-spacing", self.background_spacing, 4.0..=1000.0, "4 to 1000 px")?;
        real("background-margin", self.background_margin, 0.0..=100.0, "0 to 100 px")?;
        integer("colors", self.colors, 0..=4096, "0 to 4096")?;
        integer("max-paths", self.max_paths, 0..=10_000_000, "0 to 10000000")?;
        integer("cells", self.cells, 0..=4, "0 to 4")?;
        real("fidelity", self.fidelity, 0.05..=5.0, "0.05 to 5 px")?;
        check(
            self.secondary_minimum <= self.secondary_maximum,
            "secondary-minimum",
            self.secondary_minimum,
            "at most secondary-maximum",
        )
    }
}
