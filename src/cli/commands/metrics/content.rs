//! The content of compared files.

use crate::cli::input::{Input, InputKind};
use vtex::library::Library;
use vtex::scene::Scene;

/// The content of a file.
pub(super) enum FileContent {
    Library(Box<Library>),
    Scene(Box<Scene>),
    Svg(Vec<u8>),
    Image(Vec<u8>),
}

impl FileContent {
    pub(super) fn read(input: &Input) -> anyhow::Result<Self> {
        let bytes = input.read()?;
        let name = input.name();
        Ok(match InputKind::of(&bytes) {
            InputKind::Library => Self::Library(Box::new(Library::from_bytes(bytes, &name)?)),
            InputKind::Scene => Self::Scene(Box::new(Scene::from_bytes(bytes, &name)?)),
            InputKind::Svg => Self::Svg(bytes),
            // An unknown file may still be a damaged picture, and decoding it says so.
            InputKind::Image | InputKind::Unknown => Self::Image(bytes),
        })
    }
}
