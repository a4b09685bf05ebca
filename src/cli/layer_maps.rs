//! Reading and writing of layer maps; the file name gives the format.

use super::failure::Failure;
use super::format;
use super::input::{Input, InputKind};
use super::output::Destination;
use std::path::{Path, PathBuf};
use vtex::analyze::Limits;
use vtex::layers::{LayerMap, LayerPicture};
use vtex::output::layer_map::{write_json, write_png, write_svg};

/// Formats of a layer map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapFormat {
    Png,
    Svg,
    Json,
}

/// A file and its format.
pub(crate) struct MapTarget {
    pub(crate) place: Destination,
    pub(crate) format: MapFormat,
}

impl MapTarget {
    /// A file in the format of its name; `flag` names it in errors.
    pub(crate) fn file(flag: &str, path: PathBuf, force: bool) -> Result<Self, Failure> {
        let format = format_of(flag, &path)?;
        Ok(Self { place: Destination::File { path, force }, format })
    }

    /// Writes a map. Returns the number of bytes.
    pub(crate) fn write(&self, map: &LayerMap, wrap: [bool; 2], seed: Option<u64>) -> vtex::Result<u64> {
        let written = self.place.write(|out| match self.format {
            MapFormat::Png => write_png(map, seed, out),
            MapFormat::Svg => write_svg(map, wrap, out),
            MapFormat::Json => write_json(map, wrap, seed, out),
        })?;
        Ok(written.1)
    }
}

/// The format that a file name stands for.
pub(crate) fn format_of(flag: &str, path: &Path) -> Result<MapFormat, Failure> {
    format::check_map_name(flag, path)?;
    let name = path.to_string_lossy().to_ascii_lowercase();
    Ok(if name.ends_with(".png") {
        MapFormat::Png
    } else if name.ends_with(".svg") {
        MapFormat::Svg
    } else {
        MapFormat::Json
    })
}

/// Reads a picture that may be a layer map.
pub(crate) fn read(input: &Input) -> anyhow::Result<LayerPicture> {
    let bytes = input.read()?;
    InputKind::expect(&bytes, input, &[InputKind::Image, InputKind::Unknown])
        .map_err(|failure| failure.hint("a layer map is a picture, such as a PNG"))?;
    Ok(LayerPicture::from_bytes(&bytes, &input.name(), &Limits::default())?)
}
