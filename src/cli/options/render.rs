//! How a picture is drawn.

use crate::cli::number::Takes;
use crate::cli::values::Resolution;
use clap::Args;
use serde::Serialize;
use vtex::Parameter;
use vtex::output::DPI;
use vtex::output::file::BackgroundChoice;
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
    /// Draw all elements in this colour, if they have one colour. Shapes in the colour of the background follow
    /// --paper [#rrggbb, #rgb or a name of CSS, default: the exemplar's]
    #[arg(long, value_name = "COLOUR", value_parser = ink)]
    pub(crate) ink: Option<Colour>,
    /// Use one colour as the background, or none to leave it transparent [#rrggbb, #rgb, a name of CSS or
    /// none, default: the exemplar's]
    #[arg(long, visible_alias = "paper", value_name = "COLOUR")]
    pub(crate) background: Option<BackgroundChoice>,
}

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct RenderParameters {
    /// Pixels for each pixel of the canvas, or of a page in pixels.
    pub(crate) scale: f64,
    /// Pixels of the canvas per inch of its page.
    pub(crate) dpi: Resolution,
    /// Colour of the elements, if not the exemplar's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ink: Option<Colour>,
    /// Background between the elements, if not the exemplar's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) background: Option<BackgroundChoice>,
}

impl Default for RenderParameters {
    fn default() -> Self {
        Self { scale: Self::SCALE.default(), dpi: Resolution::default(), ink: None, background: None }
    }
}

/// The colour of `--ink`.
pub(crate) fn ink(text: &str) -> Result<Colour, String> {
    css::colour(text).ok_or_else(|| "expected #rrggbb, #rgb or a name such as red".into())
}

impl RenderParameters {
    const SCALE: Parameter<f64> = Parameter::new("scale", [0.01, 100.0], "").or(1.0);

    /// A warning if a scale was given but no PNG is `drawn`.
    pub(crate) fn warning(&self, drawn: bool) -> Option<&'static str> {
        let idle = !drawn && self.scale != 1.0;
        idle.then_some("--scale has no effect here: only pictures made of pixels have a resolution")
    }
}
