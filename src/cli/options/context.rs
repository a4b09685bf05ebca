//! A drawing that stays, and the region beside it that is filled.

use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::progress::Reporter;
use clap::Args;
use std::path::PathBuf;
use vtex::library::Library;
use vtex::scene::SynthParams;
use vtex::synth::DrawnContext;
use vtex::{Error, control, import};

/// Options that others of `synth` do not go with.
const ALONE: [&str; 6] = ["domain", "mask", "density", "control", "guide", "map"];

/// Files of a context.
#[derive(Args)]
#[command(next_help_heading = "Filling in")]
pub(crate) struct ContextArgs {
    /// A drawing, SVG, that stays as it is: the lines made in the region go on from its own
    ///
    /// Its units are those of the library's drawing. The canvas is its page, unless --size is given
    #[arg(long, value_name = "FILE", requires = "region", conflicts_with_all = ALONE)]
    pub(crate) context: Option<PathBuf>,
    /// The region beside it that is filled: all filled shapes of an SVG together, fitted to the canvas as a
    /// whole
    #[arg(long, value_name = "FILE", requires = "context")]
    pub(crate) region: Option<PathBuf>,
}

/// The files of a context.
#[derive(Debug)]
pub(crate) struct ContextFiles {
    drawing: Input,
    region: Input,
}

impl ContextArgs {
    /// The files, if they are given.
    pub(crate) fn files(self) -> Option<ContextFiles> {
        let (drawing, region) = self.context.zip(self.region)?;
        Some(ContextFiles { drawing: Input::new(drawing), region: Input::new(region) })
    }
}

impl ContextFiles {
    /// The files with their flags.
    pub(crate) fn named(&self) -> [(&'static str, &Input); 2] {
        [("--context", &self.drawing), ("--region", &self.region)]
    }

    /// Reads the drawing.
    pub(crate) fn drawing(&self, reporter: &Reporter) -> anyhow::Result<Library> {
        let bytes = self.drawing.read()?;
        InputKind::expect(&bytes, &self.drawing, &[InputKind::Svg, InputKind::Unknown])
            .map_err(|failure| failure.hint("a context is an SVG"))?;
        match import::as_drawn(&bytes, &self.drawing.name(), reporter) {
            // Nothing of a context may be left out.
            Err(error @ Error::Undrawable { .. }) => {
                Err(Failure::failed(error.to_string()).hint(error.hint().unwrap_or_default()).into())
            }
            read => Ok(read?),
        }
    }

    /// Reads the region for a canvas, beside a drawing.
    pub(crate) fn beside(&self, drawing: Library, canvas: &SynthParams) -> anyhow::Result<DrawnContext> {
        let bytes = self.region.read()?;
        InputKind::expect(&bytes, &self.region, &[InputKind::Svg, InputKind::Unknown])
            .map_err(|failure| failure.hint("a region is an SVG"))?;
        let region = control::shape(&bytes, &self.region.name(), [canvas.width, canvas.height])?;
        Ok(DrawnContext { drawing, region })
    }
}
