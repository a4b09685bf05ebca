//! How a picture is drawn.

use clap::Args;
use serde::{Deserialize, Serialize};

/// Section `[render]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct RenderFlags {
    /// Pixels of a PNG for each pixel of the canvas [0.01 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) scale: Option<f64>,
}

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct RenderParameters {
    /// Pixels for each pixel of the canvas. 0.01 to 100.
    pub(crate) scale: f64,
}

impl RenderParameters {
    /// What to tell of a scale that was asked for where nothing is `drawn`.
    pub(crate) fn warning(&self, drawn: bool) -> Option<&'static str> {
        let idle = !drawn && self.scale != 1.0;
        idle.then_some("--scale has no effect here: only pictures made of pixels have a resolution")
    }
}
