//! How a picture is drawn.

use crate::cli::number::Takes;
use crate::cli::values::Resolution;
use clap::Args;
use serde::{Serialize, Serializer};
use std::str::FromStr;
use vtex::Parameter;
use vtex::output::DPI;
use vtex::raster::colour::Colour;
use vtex::raster::css;

/// Section `[render]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct RenderFlags {
    /// PNG pixels per pixel of the canvas, or of a page with a size in pixels
    #[arg(long, number = RenderParameters::SCALE)]
    pub(crate) scale: Option<f64>,
    /// Pixels of the canvas per inch of its page
    ///
    /// auto: a size in pixels sets no resolution. A size in lengths gets as many pixels as the default
    /// canvas, so elements have the same size relative to the page. More pixels give more and smaller
    /// elements; --scale makes a finer PNG of the same elements
    #[arg(long, value_name = "NUMBER", takes = format!("{DPI}, or auto, default: auto"))]
    pub(crate) dpi: Option<Resolution>,
    /// Use one colour as the background, or none to leave it transparent [#rrggbb, #rgb, a name of CSS or
    /// none, default: the exemplar's]
    #[arg(long, value_name = "COLOUR")]
    pub(crate) background: Option<BackgroundChoice>,
}

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct RenderParameters {
    /// Pixels for each pixel of the canvas, or of a page in pixels.
    pub(crate) scale: f64,
    /// Pixels of the canvas per inch of its page.
    pub(crate) dpi: Resolution,
    /// Background between the elements, if not the exemplar's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) background: Option<BackgroundChoice>,
}

impl Default for RenderParameters {
    fn default() -> Self {
        Self { scale: Self::SCALE.default(), dpi: Resolution::default(), background: None }
    }
}

/// The background between the elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BackgroundChoice {
    Colour(Colour),
    None,
}

impl FromStr for BackgroundChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" || text == "transparent" {
            Ok(Self::None)
        } else {
            let expected = || "expected #rrggbb, #rgb or a name such as red, or none".into();
            css::colour(text).map(Self::Colour).ok_or_else(expected)
        }
    }
}

impl Serialize for BackgroundChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Colour(colour) => colour.serialize(serializer),
            Self::None => serializer.serialize_str("none"),
        }
    }
}

impl RenderParameters {
    const SCALE: Parameter<f64> = Parameter::new("scale", [0.01, 100.0], "").or(1.0);

    /// A warning if a scale was given but no PNG is `drawn`.
    pub(crate) fn warning(&self, drawn: bool) -> Option<&'static str> {
        let idle = !drawn && self.scale != 1.0;
        idle.then_some("--scale has no effect here: only pictures made of pixels have a resolution")
    }
}
