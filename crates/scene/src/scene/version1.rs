//! Scenes of version 1, whose layers were three fixed lists.

use super::{
    CategoryId, Domain, EditRecord, Element, ElementId, Field, Gradient, Instance, InstanceId, Layer,
    LibraryId, LibraryRef, Role, Scene, Shadow, Stroke, SynthParams, Tile,
};
use crate::element::version1::{Version1Detail, shapes};
use serde::Deserialize;
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;

/// A scene as version 1 stores it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneVersion1 {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u32,
    width: u32,
    height: u32,
    tile: Tile,
    parameters: Option<SynthParams>,
    program: String,
    libraries: Vec<LibraryRef>,
    textons: Vec<Version1Texton>,
    secondary: Vec<Version1Instance>,
    primary: Vec<Version1Instance>,
    background: Field,
    #[serde(default)]
    domain: Option<Domain>,
    #[serde(default)]
    edits: Vec<EditRecord>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Version1Texton {
    library: u32,
    source: u32,
    #[serde(default)]
    category: Option<u16>,
    #[serde(default)]
    fragment: bool,
    outline: Outline,
    colour: Colour,
    #[serde(default)]
    gradient: Option<Box<Gradient>>,
    #[serde(default)]
    details: Vec<Version1Detail>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Version1Instance {
    id: u32,
    texton: u32,
    transform: [f64; 6],
    #[serde(default)]
    colour: Option<Colour>,
    #[serde(default)]
    shadow: Option<Shadow>,
    #[serde(default)]
    stroke: Option<Stroke>,
}

impl From<SceneVersion1> for Scene {
    fn from(old: SceneVersion1) -> Self {
        let layer = |role, placed: Vec<Version1Instance>| {
            let instances = placed.into_iter().map(Instance::from).collect();
            Layer { instances, ..Layer::new(role) }
        };
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            width: old.width,
            height: old.height,
            page: None,
            tile: old.tile,
            parameters: old.parameters,
            program: old.program,
            libraries: old.libraries,
            elements: old.textons.into_iter().map(Element::from).collect(),
            layers: vec![
                Layer { field: Some(old.background), ..Layer::new(Role::Background) },
                layer(Role::Secondary, old.secondary),
                layer(Role::Primary, old.primary),
            ],
            domain: old.domain,
            edits: old.edits,
        }
    }
}

impl From<Version1Texton> for Element {
    fn from(old: Version1Texton) -> Self {
        Self {
            library: LibraryId(old.library),
            // Primaries come first among a library's elements. Their number is not known here, so the index
            // of a secondary is unknown too.
            source: old.category.map(|_| ElementId(old.source)),
            category: old.category.map(CategoryId),
            fused: old.fragment,
            silhouette: None,
            shapes: shapes(old.outline, old.colour, old.gradient, old.details),
        }
    }
}

impl From<Version1Instance> for Instance {
    fn from(old: Version1Instance) -> Self {
        let Version1Instance { id, texton, transform, colour, shadow, stroke } = old;
        Self { transform, colour, shadow, stroke, ..Self::new(InstanceId(id), ElementId(texton)) }
    }
}
