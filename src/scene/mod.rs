//! The scene: one synthesised texture, placed textons over a background field (`*.scene.json`).

mod edits;
mod effects;
pub mod field;
mod gradient;
mod operation;
mod parameters;
pub(crate) mod pixels;
mod tile;
mod validate;

pub use edits::{Axis, Between, EditRecord, Place, Recorded};
pub use effects::{Shadow, Stroke};
pub use gradient::Gradient;
pub use operation::{
    Action, Comparison, Condition, Direction, Identity, Layers, Operation, Quantity, ThinOrder,
};
pub use parameters::{Ablation, Method, SynthParams, Weights};
pub use tile::Tile;

use crate::document::{self, Document};
use crate::error::Result;
use crate::geometry::{Affine, Outline, Rect};
use crate::raster::colour::Colour;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One texture: a background field, secondary textons over it, primaries on top. Coordinates are
/// canvas pixels, x right, y down. A scene needs no library: it holds the textons that it uses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Always `vtex-scene`.
    pub format: String,
    /// Version of the format; this is 1.
    pub version: u32,
    /// Width of the canvas, in pixels.
    pub width: u32,
    /// Height of the canvas, in pixels.
    pub height: u32,
    /// Along which axes the scene repeats without a seam. Along these every instance, control point
    /// and domain is listed once and means all its copies, moved by whole widths or heights of the
    /// canvas (see [`Scene::copies`]).
    pub tile: Tile,
    /// The parameters of synthesis, seed included; none for a reconstruction.
    pub parameters: Option<SynthParams>,
    /// Name and version of the program.
    pub program: String,
    /// The libraries that the textons come from.
    pub libraries: Vec<LibraryRef>,
    /// The textons used, each once.
    pub textons: Vec<Texton>,
    /// Secondary textons, in painting order.
    pub secondary: Vec<Instance>,
    /// Primary textons, in painting order, each with its own details.
    pub primary: Vec<Instance>,
    /// The background.
    pub background: Field,
    /// The shape that the texture fills, where that is not the whole canvas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Domain>,
    /// What was done to it after synthesis, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<EditRecord>,
}

/// The shape that a texture fills.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Its outline, on the canvas. Background and secondaries are cut along it.
    pub outline: Outline,
    /// What becomes of primaries at its edge.
    pub edge: Edge,
}

/// What becomes of primary textons at the edge of a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// Those whose centre lies inside are kept whole and may stick out; no other is shown.
    Keep,
    /// They are cut along the edge, as at the border of the canvas.
    #[default]
    Clip,
    /// None crosses the edge.
    Avoid,
}

/// A library that a scene was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LibraryRef {
    /// File name of the library's exemplar.
    pub exemplar: String,
    /// SHA-256 of the exemplar's file.
    pub sha256: String,
}

/// The shape of a texton, around its own origin (its centroid in the exemplar, in whole pixels,
/// is moved to (0, 0)).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Texton {
    /// Index of its library in [`Scene::libraries`].
    pub library: u32,
    /// Its index among the library's primaries or secondaries.
    pub source: u32,
    /// Category, for primaries.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub category: Option<u16>,
    /// Only a part of the library's texton.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fragment: bool,
    /// Its outline.
    pub outline: Outline,
    /// Colour painted inside the outline, beneath the details.
    pub colour: Colour,
    /// Painted in place of the colour, unless an instance has one of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
    /// What is painted on it, in painting order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Patch>,
}

/// A patch on a texton.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Its outline, in the coordinates of the texton.
    pub outline: Outline,
    /// Its colour; with a gradient, its mean colour.
    pub colour: Colour,
    /// Painted in place of the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
}

impl Texton {
    /// What its outline is painted with, in an instance with a colour of its own or none: a colour,
    /// and the gradient that takes its place.
    pub fn base(&self, own: Option<Colour>) -> (Colour, Option<&Gradient>) {
        match own {
            Some(colour) => (colour, None),
            None => (self.colour, self.gradient.as_ref()),
        }
    }

    /// Bounding box of its outline and details, in its own coordinates.
    pub fn bounds(&self) -> Rect {
        self.details.iter().fold(self.outline.bounds(), |all, p| all.union(p.outline.bounds()))
    }
}

/// A texton placed on the canvas; where the scene tiles, listed once for all its copies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Instance {
    /// Identity that operations on the scene keep; unique within the scene.
    pub id: u32,
    /// Index in [`Scene::textons`].
    pub texton: u32,
    /// Coefficients a b c d e f of the affine map from texton to canvas: x' = ax + cy + e,
    /// y' = bx + dy + f.
    pub transform: [f64; 6],
    /// Colour of its own, in place of the texton's (for textons without details).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
    /// The shadow beneath it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow: Option<Shadow>,
    /// The line along its outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke: Option<Stroke>,
}

impl Instance {
    /// A texton where its coordinates are those of the canvas, with nothing of its own.
    pub fn new(id: u32, texton: u32) -> Self {
        let transform = Affine::IDENTITY.as_coeffs();
        Self { id, texton, transform, colour: None, shadow: None, stroke: None }
    }

    /// The transform.
    pub fn affine(&self) -> Affine {
        Affine::new(self.transform)
    }
}

/// The background: a smooth field through coloured points (see [`field`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// Typical distance between the points, in pixels.
    pub spacing: f64,
    /// Colour of the field if there is no point.
    pub fallback: Colour,
    /// The points; some may lie outside the canvas. In a scene that tiles each means all its copies.
    pub points: Vec<ControlPoint>,
}

/// A point of the background with its colour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlPoint {
    /// Pixels from the left.
    pub x: f64,
    /// Pixels from the top.
    pub y: f64,
    /// The field's colour there.
    pub colour: Colour,
}

impl Scene {
    /// The name in [`Scene::format`].
    pub const FORMAT: &'static str = "vtex-scene";
    /// The version in [`Scene::version`].
    pub const VERSION: u32 = 1;

    /// Reads and validates a scene; `.gz` is unpacked by content.
    ///
    /// # Errors
    /// Unreadable file, not JSON, another format or version, or a broken invariant.
    pub fn read(path: &Path) -> Result<Self> {
        document::read(path)
    }

    /// Reads and validates a scene from bytes; `name` appears in errors.
    ///
    /// # Errors
    /// As [`Scene::read`], without the file.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        document::from_bytes(bytes, name)
    }

    /// The scene as JSON, ending in a newline.
    pub fn to_json(&self) -> Vec<u8> {
        document::to_json(self)
    }
}

impl Document for Scene {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> std::result::Result<(), String> {
        validate::validate(self)
    }
}
