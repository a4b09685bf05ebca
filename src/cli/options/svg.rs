//! How an SVG is written.

use crate::cli::format::{Lists, OF_MAX_BYTES, titles};
use crate::cli::number::Takes;
use crate::cli::values::{Bytes, Resolution, named, one_of};
use clap::Args;
use serde::{Deserialize, Serialize};
use vtex::library::Library;
use vtex::output::svg::SvgOptions;
use vtex::scene::SynthParams;
use vtex::synth::CanvasSize;

/// Section `[svg]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct SvgFlags {
    /// Write an SVG as a picture, or as a small tile for fills of maps, layouts and web pages: plain shapes,
    /// also as a <pattern>. A pattern implies --tile; its default size is one page of the drawing [picture or
    /// pattern, default: picture]
    #[arg(long = "as", value_name = "FORM", hide_possible_values = true)]
    #[arg(value_parser = one_of(&SvgForm::NAMES, named::<SvgForm>))]
    #[serde(rename = "as")]
    pub(crate) form: Option<SvgForm>,
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
    /// Maximum file size of an {titles}, such as 5MB, 800kB or a number of bytes: drops decimals and names,
    /// then outline detail, then the least visible shapes
    #[arg(long, value_name = "SIZE", takes = format!("{}, default: no limit", Bytes::RANGE))]
    #[arg(fills("{titles}", &titles(OF_MAX_BYTES)))]
    pub(crate) max_bytes: Option<Bytes>,
}

/// What an SVG is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SvgForm {
    /// To be seen and edited.
    #[default]
    Picture,
    /// To be repeated by the fills of other programs.
    Pattern,
}

impl SvgForm {
    const NAMES: [&str; 2] = ["picture", "pattern"];

    /// Sets the canvas of a texture; that of a pattern has one page of a drawing.
    pub(crate) fn set_canvas(
        self,
        size: CanvasSize,
        params: &mut SynthParams,
        libraries: &[Library],
        Resolution(dpi): Resolution,
    ) {
        match self {
            Self::Picture => size.set(params, libraries, dpi),
            Self::Pattern => size.set_one_page(params, libraries, dpi),
        }
    }

    fn is_picture(&self) -> bool {
        *self == Self::Picture
    }
}

/// How an SVG is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct SvgParameters {
    /// A picture, or a tile for fills.
    #[serde(rename = "as", skip_serializing_if = "SvgForm::is_picture")]
    pub(crate) form: SvgForm,
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

impl From<SvgParameters> for SvgOptions {
    fn from(SvgParameters { form, precision, expand, css, .. }: SvgParameters) -> Self {
        Self { precision, expand, css, names: true, fills: form == SvgForm::Pattern }
    }
}
