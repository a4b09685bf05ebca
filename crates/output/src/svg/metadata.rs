//! Metadata of an SVG.

use crate::categories::SceneCategory;
use serde::Serialize;
use vtex_base::document::json_in_order;
use vtex_scene::scene::{EditRecord, LibraryRef, Scene, SynthParams, Tile};

/// The content of `<metadata>`, as JSON: enough to make the same texture again.
#[derive(Serialize)]
struct Metadata<'a> {
    format: &'static str,
    /// Version of the metadata, 2. In version 1 libraries and categories were numbered from 0.
    version: u32,
    program: &'a str,
    /// The seed; `None` for the reconstruction of an exemplar.
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    width: u32,
    height: u32,
    tile: Tile,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<&'a SynthParams>,
    libraries: Vec<LibraryRef>,
    /// The categories of the elements in the file.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    categories: &'a [SceneCategory],
    /// The recipe by which it was made from its inputs, in the form of the program that made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe: Option<&'a serde_json::Value>,
    /// Operations applied after synthesis.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    edits: &'a [EditRecord],
}

/// The metadata of a scene as JSON text.
pub(super) fn json(
    scene: &Scene,
    categories: &[SceneCategory],
    recipe: Option<&serde_json::Value>,
) -> String {
    let metadata = Metadata {
        format: "vtex-svg",
        version: 2,
        program: &scene.program,
        seed: scene.parameters.as_ref().map(|p| p.seed),
        width: scene.width,
        height: scene.height,
        tile: scene.tile,
        parameters: scene.parameters.as_ref(),
        libraries: scene.libraries.iter().map(LibraryRef::exemplar).collect(),
        categories,
        recipe,
        edits: &scene.edits,
    };
    json_in_order(serde_json::to_string(&metadata).expect("metadata hold nothing that JSON cannot"))
}
