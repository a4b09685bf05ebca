//! How an SVG is written.

use crate::cli::number::Takes;
use crate::cli::values::Bytes;
use clap::Args;
use serde::Serialize;
use vtex::library::Library;
use vtex::output::svg::SvgOptions;

/// Section `[svg]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct SvgFlags {
    /// Decimals of numbers in an SVG
    #[arg(long, number = SvgOptions::PRECISION)]
    pub(crate) precision: Option<u8>,
    /// Write each element in full, without <symbol> and <use> [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) expand: Option<bool>,
    /// Write CSS rules into the SVG, to recolour categories [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) css: Option<bool>,
    /// Maximum file size of an SVG or PDF, such as 5MB, 800kB or a number of bytes: drops decimals and names,
    /// then outline detail, then the least visible shapes
    #[arg(long, value_name = "SIZE", takes = format!("{}, default: no limit", Bytes::RANGE))]
    pub(crate) max_bytes: Option<Bytes>,
}

/// How an SVG is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct SvgParameters {
    /// Decimals of numbers.
    pub(crate) precision: u8,
    /// Whether every instance is written in full.
    pub(crate) expand: bool,
    /// Whether categories have style rules.
    pub(crate) css: bool,
    /// Most bytes of the file, if there is a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_bytes: Option<Bytes>,
}

/// Pixels of the arrangement per unit of a drawing above which one decimal is too coarse.
const COARSE: f64 = 4.0;

impl SvgParameters {
    /// With two decimals in place of one if elements come from a drawing on a small page, where a tenth of a
    /// unit is visible.
    pub(crate) fn fit(self, libraries: &[Library]) -> Self {
        let coarse = libraries.iter().any(|library| library.pixels_per_unit() > COARSE);
        if coarse && self.precision == 1 { Self { precision: 2, ..self } } else { self }
    }
}

impl From<SvgParameters> for SvgOptions {
    fn from(SvgParameters { precision, expand, css, .. }: SvgParameters) -> Self {
        Self { precision, expand, css, names: true }
    }
}
