//! How a picture is drawn.

use clap::Args;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::str::FromStr;
use vtex::output::CSS_DPI;
use vtex::raster::colour::Colour;
use vtex::raster::css;

/// Section `[render]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct RenderFlags {
    /// Pixels of a PNG for each pixel of the canvas [0.01 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) scale: Option<f64>,
    /// Pixels to the inch of an SVG or PDF, and of sizes with units [1 to 9600, default: 96]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) dpi: Option<u32>,
    /// Background of one colour in place of the exemplar's, or none, so that what is between the elements is
    /// transparent [#rrggbb, #rgb, a name of CSS or none, default: the exemplar's]
    #[arg(long, value_name = "COLOUR")]
    pub(crate) background: Option<BackgroundChoice>,
}

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct RenderParameters {
    /// Pixels for each pixel of the canvas. 0.01 to 100.
    pub(crate) scale: f64,
    /// Pixels to the inch. 1 to 9600.
    #[serde(default = "css_dpi")]
    pub(crate) dpi: u32,
    /// Background between the elements, if not the exemplar's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) background: Option<BackgroundChoice>,
}

fn css_dpi() -> u32 {
    CSS_DPI
}

impl Default for RenderParameters {
    fn default() -> Self {
        Self { scale: 1.0, dpi: CSS_DPI, background: None }
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

impl<'de> Deserialize<'de> for BackgroundChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

impl RenderParameters {
    /// A warning if a scale was given but no PNG is `drawn`.
    pub(crate) fn warning(&self, drawn: bool) -> Option<&'static str> {
        let idle = !drawn && self.scale != 1.0;
        idle.then_some("--scale has no effect here: only pictures made of pixels have a resolution")
    }
}
