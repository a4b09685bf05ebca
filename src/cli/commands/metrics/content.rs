//! The content of compared files.

use crate::cli::input::{Input, Kind};
use vtex::library::Library;
use vtex::scene::Scene;

/// The content of a file.
pub(super) enum Content {
    Library(Box<Library>),
    Scene(Box<Scene>),
    Svg(Vec<u8>),
    Image(Vec<u8>),
}

impl Content {
    pub(super) fn read(input: &Input) -> anyhow::Result<Self> {
        let bytes = input.read()?;
        let name = input.name();
        Ok(match Kind::of(&bytes) {
            Kind::Library => Self::Library(Box::new(Library::from_bytes(bytes, &name)?)),
            Kind::Scene => Self::Scene(Box::new(Scene::from_bytes(bytes, &name)?)),
            Kind::Svg => Self::Svg(bytes),
            // An unknown file may still be a damaged picture, and decoding it says so.
            Kind::Image | Kind::Unknown => Self::Image(bytes),
        })
    }
}
