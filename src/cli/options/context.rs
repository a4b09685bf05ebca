//! A drawing that stays, and the region beside it that is filled.

use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::progress::Reporter;
use clap::Args;
use std::path::PathBuf;
use vtex::geometry::Outline;
use vtex::library::Library;
use vtex::scene::SynthParams;
use vtex::synth::DrawnContext;
use vtex::{Error, control, import};

/// Options that others of `synth` do not go with.
const ALONE: [&str; 6] = ["domain", "mask", "density", "control", "guide", "map"];

/// Files of a context.
#[derive(Args)]
#[command(next_help_heading = "Fill a region of a drawing")]
pub(crate) struct ContextArgs {
    /// Keep this SVG drawing as it is, and fill the region with lines or elements that fit it
    ///
    /// Its units must be those of the library's drawing. The canvas is its page, unless you give --size
    #[arg(long, value_name = "FILE", requires = "region", conflicts_with_all = ALONE)]
    pub(crate) context: Option<PathBuf>,
    /// Region to fill: all filled shapes of an SVG together; vtex fits its page to the canvas
    #[arg(long, value_name = "FILE", requires = "context")]
    pub(crate) region: Option<PathBuf>,
    /// Empty the region first: cut strokes at its border, and remove elements whose middle is in it
    #[arg(long, requires = "context")]
    pub(crate) anew: bool,
    /// Copy this part of the library's drawing to the region, and fit it to its surroundings. The part is all
    /// filled shapes of an SVG, whose page is fitted to the library's. Its middle moves to the middle of the
    /// region
    #[arg(long, value_name = "FILE", requires = "context")]
    pub(crate) source: Option<PathBuf>,
}

/// The files of a context.
#[derive(Debug)]
pub(crate) struct ContextFiles {
    drawing: Input,
    region: Input,
    anew: bool,
    source: Option<Input>,
}

impl ContextArgs {
    /// The files, if they are given.
    pub(crate) fn files(self) -> Option<ContextFiles> {
        let (drawing, region) = self.context.zip(self.region)?;
        let (drawing, region, source) =
            (Input::new(drawing), Input::new(region), self.source.map(Input::new));
        Some(ContextFiles { drawing, region, anew: self.anew, source })
    }
}

impl ContextFiles {
    /// The files with their flags.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&'static str, &Input)> {
        let both = [("--context", &self.drawing), ("--region", &self.region)];
        both.into_iter().chain(self.source.iter().map(|source| ("--source", source)))
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

    /// Reads the other files: the region on a canvas beside the drawing, and the part of a library that is copied to it.
    pub(crate) fn beside(
        &self,
        drawing: Library,
        canvas: &SynthParams,
        library: &Library,
    ) -> anyhow::Result<DrawnContext> {
        let region = shape(&self.region, "a region", [canvas.width, canvas.height])?;
        let page = [library.source.width, library.source.height];
        let source = self.source.as_ref().map(|file| shape(file, "a source", page)).transpose()?;
        Ok(DrawnContext { drawing, region, source, anew: self.anew })
    }
}

/// Reads a shape that is fitted to a page.
fn shape(file: &Input, role: &str, page: [u32; 2]) -> anyhow::Result<Outline> {
    let bytes = file.read()?;
    InputKind::expect(&bytes, file, &[InputKind::Svg, InputKind::Unknown])
        .map_err(|failure| failure.hint(format!("{role} is an SVG")))?;
    Ok(control::shape(&bytes, &file.name(), page)?)
}
