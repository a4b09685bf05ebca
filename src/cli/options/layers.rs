//! Files of a photograph's layers.

use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::layer_maps::MapTarget;
use clap::Args;
use std::path::{Path, PathBuf};

/// Files of a photograph's layers.
#[derive(Args, Default)]
#[command(next_help_heading = "Layers of the photograph")]
pub(crate) struct LayerFilesArgs {
    /// Use a painted map in place of the layers found: a picture in 2 to 6 flat colours, as large as the
    /// photograph
    #[arg(long, value_name = "FILE", conflicts_with = "layers")]
    pub(crate) layer_map: Option<PathBuf>,
    /// Also write the layers of the photograph as a map of the same size: .png, .svg or .json
    #[arg(long, value_name = "FILE")]
    pub(crate) save_layers: Option<PathBuf>,
}

/// Files of a photograph's layers.
#[derive(Default)]
pub(crate) struct LayerFiles {
    /// A painted map in place of layers found.
    pub(crate) painted: Option<Input>,
    /// Where the layers are saved.
    pub(crate) save: Option<MapTarget>,
}

impl LayerFilesArgs {
    /// The file that is written, with its flag.
    pub(crate) fn written(&self) -> (&'static str, Option<&Path>) {
        ("--save-layers", self.save_layers.as_deref())
    }

    /// The file that is read, with its flag.
    pub(crate) fn read(&self) -> (&'static str, Option<&Path>) {
        ("--layer-map", self.layer_map.as_deref())
    }

    /// The files, their names checked.
    pub(crate) fn files(self, force: bool) -> Result<LayerFiles, Failure> {
        let save = self.save_layers.map(|path| MapTarget::file("--save-layers", path, force));
        Ok(LayerFiles { painted: self.layer_map.map(Input::new), save: save.transpose()? })
    }
}
