//! The scene: one synthesised texture, that is, placed textons over a background field
//! (`*.scene.json`).

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

/// One texture: a background field, secondary textons over it, primary textons on top. Coordinates
/// are canvas pixels, x right, y down. A scene contains the textons that it uses, so it needs no
/// library.
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
    /// The axes along which the scene repeats seamlessly. Along these, every instance, control point and
    /// domain is listed once and stands for all its copies, shifted by whole widths or heights of the
    /// canvas (see [`Scene::copies`]).
    pub tile: Tile,
    /// The parameters of synthesis, including the seed; `None` for a reconstruction.
    pub parameters: Option<SynthParams>,
    /// Name and version of the program that made the scene.
    pub program: String,
    /// The libraries that the textons come from.
    pub libraries: Vec<LibraryRef>,
    /// The textons that instances refer to.
    pub textons: Vec<Texton>,
    /// Secondary textons, in painting order.
    pub secondary: Vec<Instance>,
    /// Primary textons, in painting order, each with its own details.
    pub primary: Vec<Instance>,
    /// The background field.
    pub background: Field,
    /// The shape that the texture fills; `None` for the whole canvas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Domain>,
    /// Operations applied after synthesis, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<EditRecord>,
}

/// A shape that the texture is limited to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Outline of the shape, on the canvas. Background and secondaries are clipped to it.
    pub outline: Outline,
    /// Treatment of primaries at its edge.
    pub edge: Edge,
}

/// Treatment of primary textons at the edge of a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// Primaries whose centre lies inside are kept whole and may extend beyond the edge; others are
    /// removed.
    Keep,
    /// Primaries are clipped at the edge, as at the border of the canvas.
    #[default]
    Clip,
    /// No primary crosses the edge.
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

/// The shape of a texton, in its own coordinates: the exemplar's, shifted so that its centroid,
/// rounded to whole pixels, is at (0, 0).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Texton {
    /// Index of its library in [`Scene::libraries`].
    pub library: u32,
    /// Index among the library's primaries or secondaries.
    pub source: u32,
    /// Category in the library, for primaries.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub category: Option<u16>,
    /// Whether it is only a part of the library's texton.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fragment: bool,
    /// Its outline.
    pub outline: Outline,
    /// Fill colour of the outline; details are painted on top.
    pub colour: Colour,
    /// Gradient that replaces the colour, unless an instance has a colour of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
    /// Patches painted on the texton, in painting order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Patch>,
}

/// A detail of a texton: a filled shape on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Its outline, in the coordinates of the texton.
    pub outline: Outline,
    /// Fill colour; if there is a gradient, its mean colour.
    pub colour: Colour,
    /// Gradient that replaces the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
}

impl Texton {
    /// The fill of the outline for an instance with the colour `own`, if it has one: a colour, and the
    /// gradient that replaces it, if any.
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

/// A texton placed on the canvas. In a scene that tiles it stands for all its copies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Instance {
    /// Identifier, unique within the scene; operations keep it.
    pub id: u32,
    /// Index in [`Scene::textons`].
    pub texton: u32,
    /// Coefficients a b c d e f of the affine map from texton to canvas: x' = ax + cy + e,
    /// y' = bx + dy + f.
    pub transform: [f64; 6],
    /// Colour that replaces the texton's. Only for textons without details.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
    /// Shadow underneath the texton.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow: Option<Shadow>,
    /// Stroke along the outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke: Option<Stroke>,
}

impl Instance {
    /// An instance with the identity transform, without colour, shadow and stroke.
    pub fn new(id: u32, texton: u32) -> Self {
        let transform = Affine::IDENTITY.as_coeffs();
        Self { id, texton, transform, colour: None, shadow: None, stroke: None }
    }

    /// The transform.
    pub fn affine(&self) -> Affine {
        Affine::new(self.transform)
    }
}

/// The background: a smooth colour field through control points (see [`field`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// Typical distance between control points, in pixels.
    pub spacing: f64,
    /// Colour of the field if it has no control points.
    pub fallback: Colour,
    /// The control points; some may lie outside the canvas. In a scene that tiles, each stands for all its
    /// copies.
    pub points: Vec<ControlPoint>,
}

/// A control point of the background field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlPoint {
    /// Distance from the left border, in pixels.
    pub x: f64,
    /// Distance from the top border, in pixels.
    pub y: f64,
    /// Colour of the field at this point.
    pub colour: Colour,
}

impl Scene {
    /// Value of [`Scene::format`].
    pub const FORMAT: &'static str = "vtex-scene";
    /// Value of [`Scene::version`].
    pub const VERSION: u32 = 1;

    /// Reads and validates a scene. Gzip is detected by content.
    ///
    /// # Errors
    /// [`crate::Error::Read`] for an unreadable file; [`crate::Error::Format`] for anything but a valid
    /// scene of this version.
    pub fn read(path: &Path) -> Result<Self> {
        document::read(path)
    }

    /// Reads and validates a scene from bytes, plain or gzip. `name` appears in errors.
    ///
    /// # Errors
    /// [`crate::Error::Format`] for anything but a valid scene of this version.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        document::from_bytes(bytes, name)
    }

    /// Serialises the scene as JSON, ending in a newline.
    pub fn to_json(&self) -> Vec<u8> {
        document::to_json(self)
    }

    /// Drops textons that no instance shows.
    pub(crate) fn drop_unused(&mut self) {
        let mut used = vec![false; self.textons.len()];
        for instance in self.secondary.iter().chain(&self.primary) {
            used[instance.texton as usize] = true;
        }
        if used.iter().all(|u| *u) {
            return;
        }
        let mut next = 0;
        let numbers: Vec<u32> = used
            .iter()
            .map(|used| {
                next += u32::from(*used);
                next.saturating_sub(1)
            })
            .collect();
        let mut place = 0;
        self.textons.retain(|_| {
            place += 1;
            used[place - 1]
        });
        for instance in self.secondary.iter_mut().chain(&mut self.primary) {
            instance.texton = numbers[instance.texton as usize];
        }
    }
}

impl Document for Scene {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> std::result::Result<(), String> {
        validate::validate(self)
    }
}
