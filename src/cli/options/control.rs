//! Files that steer synthesis.

use super::files::check_files;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use clap::Args;
use std::path::{Path, PathBuf};
use vtex::synth::Controls;

/// Files that steer synthesis.
#[derive(Args)]
#[command(next_help_heading = "Control (pictures are stretched over the canvas)")]
pub(crate) struct ControlArgs {
    /// Fill a shape: all filled shapes of an SVG together; vtex fits its page into the canvas
    #[arg(long, value_name = "FILE", conflicts_with = "mask")]
    pub(crate) domain: Option<PathBuf>,
    /// Fill the white pixels of a picture, or the opaque ones if it has transparency
    #[arg(long = "domain-mask", value_name = "FILE")]
    pub(crate) mask: Option<PathBuf>,
    /// Set the density relative to the photograph, by a grey picture: black 0, middle grey 1, white 2
    #[arg(long, value_name = "FILE")]
    pub(crate) density: Option<PathBuf>,
    /// Place layers as in a map, which has the colours of the library's layers (see 'vtex layers')
    #[arg(long, value_name = "FILE")]
    pub(crate) control: Option<PathBuf>,
    /// Make the texture light and dark where another picture is
    #[arg(long, value_name = "FILE", conflicts_with = "control")]
    pub(crate) guide: Option<PathBuf>,
}

/// Files that steer synthesis.
#[derive(Debug, Default)]
pub(crate) struct Steering {
    pub(crate) domain: Option<DomainFrom>,
    pub(crate) density: Option<Input>,
    pub(crate) structure: Option<StructureFrom>,
    pub(crate) maps: Vec<Input>,
}

/// The source of the shape to fill.
#[derive(Debug)]
pub(crate) enum DomainFrom {
    Shape(Input),
    Mask(Input),
}

/// The file that the large structure follows.
#[derive(Debug)]
pub(crate) enum StructureFrom {
    Layers(Input),
    Lightness(Input),
}

impl Steering {
    pub(crate) fn new(control: ControlArgs, maps: Vec<PathBuf>) -> Self {
        let layers = control.control.map(|path| StructureFrom::Layers(Input::new(path)));
        let shape = control.domain.map(|path| DomainFrom::Shape(Input::new(path)));
        Self {
            domain: shape.or(control.mask.map(|path| DomainFrom::Mask(Input::new(path)))),
            density: control.density.map(Input::new),
            structure: layers.or(control.guide.map(|path| StructureFrom::Lightness(Input::new(path)))),
            maps: maps.into_iter().map(Input::new).collect(),
        }
    }

    /// The files with their flags.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&'static str, &Input)> {
        let domain = self.domain.iter().map(|d| match d {
            DomainFrom::Shape(file) => ("--domain", file),
            DomainFrom::Mask(file) => ("--domain-mask", file),
        });
        let density = self.density.iter().map(|file| ("--density", file));
        let structure = self.structure.iter().map(|guide| match guide {
            StructureFrom::Layers(file) => ("--control", file),
            StructureFrom::Lightness(file) => ("--guide", file),
        });
        domain.chain(density).chain(structure).chain(self.maps.iter().map(|file| ("--map", file)))
    }

    /// Fails if a file would be read and written, or standard input read twice.
    pub(crate) fn check(
        &self,
        inputs: &[(&'static str, &Input)],
        written: &[(&str, Option<&Path>)],
    ) -> Result<(), Failure> {
        check_files(&inputs.iter().copied().chain(self.files()).collect::<Vec<_>>(), written)
    }

    /// Refuses a number of maps that does not fit the libraries.
    pub(crate) fn check_counts(&self, libraries: usize) -> Result<(), Failure> {
        if let (Some(guide), 2..) = (&self.structure, libraries) {
            let flag = if matches!(guide, StructureFrom::Layers(_)) { "--control" } else { "--guide" };
            return Err(Failure::usage(format!("{flag} is for a single library, {libraries} are given"))
                .hint("make a texture of each library, or say by --map which is where"));
        }
        let most = Controls::MOST_LIBRARIES;
        let maps = self.maps.len();
        let message = match (libraries, maps) {
            (1, 0) => return Ok(()),
            (1, _) => "--map is for several libraries, one is given".to_owned(),
            (n, _) if n > most => format!("{n} libraries are given, at most {most} make a scene"),
            (_, 1) => return Ok(()),
            (n, 0) => format!("{n} libraries are given, and nothing that says which is where"),
            (n, maps) if n == maps => return Ok(()),
            (n, maps) => format!("{maps} times --map is given for {n} libraries"),
        };
        Err(Failure::usage(message).hint("give one --map for all libraries, or one for each"))
    }
}
