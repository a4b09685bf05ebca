//! The scene: one synthesised texture, that is, layers of placed elements and colour fields
//! (`*.scene.json`).

pub mod condition;
mod edits;
mod effects;
pub mod field;
mod gaussians;
mod ink;
mod joined;
mod operation;
mod page;
mod parameters;
pub mod pixels;
mod repaint;
pub(crate) mod scaling;
mod splat;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
mod tile;
mod validate;

pub use crate::element::{CategoryId, ElementId, Gradient, Role, Shape};
pub use edits::{Axis, Between, EditRecord, Place, Recorded, Transfer, TransferMode};
pub use effects::{Shadow, Stroke};
pub use ink::Ink;
pub use joined::joined;
pub use operation::{
    About, Action, ColourOrMap, Comparison, Condition, Direction, Distribution, Identity, Jitter, Keep,
    NumberOrMap, Operation, OrderBy, Quantity, ThinOrder, Within,
};
pub use page::{CSS_DPI, Length, LengthUnit, page_at};
pub use parameters::{Ablation, LatticeChoice, Method, SynthParams, Weights};
pub use repaint::Repaint;
pub use splat::splat;
pub use tile::Tile;
pub(crate) use validate::{check_layer, check_spacing};

use crate::element::{self, Ellipse};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::document;
use vtex_base::document::Document;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Outline, Rect};
use vtex_base::raster::colour::Colour;

/// One texture: layers one over the other, each with a colour field, placed elements, or both. The
/// texture of a homogeneous photograph has three: background, secondary and primary elements.
/// Coordinates are canvas pixels, x right, y down. A scene contains the elements that it uses, so it
/// needs no library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Always `vtex-scene`.
    pub format: String,
    /// Version of the format; this is 2.
    pub version: u32,
    /// Width of the canvas, in pixels.
    pub width: u32,
    /// Height of the canvas, in pixels.
    pub height: u32,
    /// Width and height at which the canvas is printed or shown, which files state: lengths such as `300mm`, or `900px`
    /// on a screen. `None` for a pixel of CSS for each pixel of the canvas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<[Length; 2]>,
    /// The axes along which the scene repeats seamlessly. Along these, every instance, control point and
    /// domain is listed once and stands for all its copies, shifted by whole widths or heights of the
    /// canvas (see [`Scene::copies`]).
    pub tile: Tile,
    /// How the copies of a scene that repeats overlap, along x and y: what the height of those one canvas further along is
    /// more than that of their original. Default 0 and 0: copies are painted directly after their original.
    #[serde(default, skip_serializing_if = "crate::element::is_default")]
    pub stacking: [i32; 2],
    /// The parameters of synthesis, including the seed; `None` for a reconstruction.
    pub parameters: Option<SynthParams>,
    /// Name and version of the program that made the scene.
    pub program: String,
    /// The libraries that the elements come from.
    pub libraries: Vec<LibraryRef>,
    /// The elements that instances refer to.
    pub elements: Vec<Element>,
    /// The layers, in painting order.
    pub layers: Vec<Layer>,
    /// The shape that the texture fills; `None` for the whole canvas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Domain>,
    /// Operations applied after synthesis, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<EditRecord>,
}

/// A shape that the texture is limited to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Outline of the shape, on the canvas. Layers are clipped to it, except those of individual elements
    /// ([`Role::is_individual`]), which follow `edge`.
    pub outline: Outline,
    /// Treatment of individual elements at its edge.
    pub edge: Edge,
}

impl Domain {
    /// Whether a domain of the given edge clips layers of a role.
    pub fn clips(edge: Edge, role: Role) -> bool {
        edge != Edge::Keep || !role.is_individual()
    }
}

/// Treatment of individual elements at the edge of a domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// Elements whose centre lies inside are kept whole and may extend beyond the edge; others are
    /// removed.
    Keep,
    /// Elements are clipped at the edge, as at the border of the canvas.
    #[default]
    Clip,
    /// No element crosses the edge.
    Avoid,
}

/// A layer of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Its name, unique within the scene, which operations and writers use. Not empty.
    pub name: String,
    /// The function of its elements in the texture.
    pub role: Role,
    /// The part of the canvas that it fills; `None` for all of it. Field and elements are clipped to it.
    /// In a scene that tiles it stands for all its copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Outline>,
    /// Colour field underneath the elements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<Field>,
    /// Whether its elements were made beside a drawing that stands, to be accepted or taken away.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub predicted: bool,
    /// The elements, in painting order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instances: Vec<Instance>,
}

impl Layer {
    /// Name of the layer of a drawing beside which a scene was made, and of the layer that was made.
    pub const DRAWN: &'static str = "drawn";
    /// See [`Layer::DRAWN`].
    pub const PREDICTED: &'static str = "predicted";

    /// A layer named after its role, without region, field and elements.
    pub fn new(role: Role) -> Self {
        let name = role.name().into();
        Self { name, role, region: None, field: None, predicted: false, instances: Vec::new() }
    }
}

/// A library that a scene was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LibraryRef {
    /// File name of the library's exemplar.
    pub exemplar: String,
    /// SHA-256 of the exemplar's file.
    pub sha256: String,
    /// Names of the library's categories, in its order; empty if they are not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub categories: Vec<String>,
    /// Whether its exemplar is a drawing on a small page, where a tenth of a unit is visible.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fine: bool,
}

impl LibraryRef {
    /// The reference to the exemplar alone, without facts about the library.
    pub fn exemplar(&self) -> Self {
        Self { categories: Vec::new(), fine: false, ..self.clone() }
    }
}

/// An element that instances show, in its own coordinates. For elements of photographs these are the
/// exemplar's, shifted so that the centroid, rounded to whole pixels, is at (0, 0).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Element {
    /// Its library, by index in [`Scene::libraries`].
    pub library: LibraryId,
    /// Its index in that library; `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<ElementId>,
    /// Its category in that library, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub category: Option<CategoryId>,
    /// Whether it has shapes of its own instead of those of an element of the library: it was bent to its place, or
    /// fused of parts of several, or of a part of one. Then `source` is the one that all or most of it comes from.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fused: bool,
    /// The outline of the whole, if that is not the outline of the first shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub silhouette: Option<Outline>,
    /// Its shapes, in painting order; at least one.
    #[serde(deserialize_with = "element::deserialize_shapes")]
    pub shapes: Vec<Shape>,
}

impl Element {
    /// The outline of the whole: its silhouette, or the outline of its first shape.
    pub fn outline(&self) -> &Outline {
        element::outline(self.silhouette.as_ref(), &self.shapes)
    }

    /// The shape that is painted first.
    pub fn base(&self) -> &Shape {
        &self.shapes[0]
    }

    /// The shapes that are painted on the first.
    pub fn details(&self) -> &[Shape] {
        &self.shapes[1..]
    }

    /// The paint of the first shape for an instance with the colour `own`, if it has one: a colour, and
    /// the gradient that replaces it, if any.
    pub fn paint(&self, own: Option<Colour>) -> (Colour, Option<&Gradient>) {
        match own {
            Some(colour) => (colour, None),
            None => (self.base().colour, self.base().gradient.as_deref()),
        }
    }

    /// The soft ellipse that the element is, and its colour in an instance with the colour `own`; `None` if the element
    /// has an outline.
    pub fn spot(&self, own: Option<Colour>) -> Option<(&Ellipse, Colour)> {
        Some((self.base().ellipse.as_deref()?, own.unwrap_or(self.base().colour)))
    }

    /// Bounding box of its shapes, in its own coordinates.
    pub fn bounds(&self) -> Rect {
        element::bounds(&self.shapes)
    }

    /// The same element with other shapes.
    pub fn with_shapes(&self, shapes: Vec<Shape>) -> Self {
        Self { silhouette: self.silhouette.clone(), shapes, ..*self }
    }
}

/// Index of a library in [`Scene::libraries`], or in another list of libraries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(transparent)]
pub struct LibraryId(pub u32);

impl LibraryId {
    /// The index in its list.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The number shown to people, counted from 1.
    pub fn number(self) -> u64 {
        u64::from(self.0) + 1
    }
}

/// Its number.
impl std::fmt::Display for LibraryId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.number().fmt(f)
    }
}

/// Identifier of an instance, unique within its scene; operations keep it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(transparent)]
pub struct InstanceId(pub u32);

impl std::fmt::Display for InstanceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// An element placed on the canvas. In a scene that tiles it stands for all its copies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Instance {
    /// Identifier, unique within the scene; operations keep it.
    pub id: InstanceId,
    /// Index in [`Scene::elements`].
    pub element: ElementId,
    /// Coefficients a b c d e f of the affine map from element to canvas: x' = ax + cy + e,
    /// y' = bx + dy + f.
    pub transform: [f64; 6],
    /// Number of the motif of which it is a part: elements of a drawing that belong together. Those of one motif that are
    /// painted one after another are a group in an SVG.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motif: Option<u32>,
    /// Colour that replaces the paint of the element's first shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
    /// Shadow underneath the element.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow: Option<Shadow>,
    /// Stroke along the outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke: Option<Stroke>,
    /// What of a layer is higher is painted later, where copies are stacked ([`Scene::stacking`]). Default 0.
    #[serde(default, skip_serializing_if = "crate::element::is_default")]
    pub height: i32,
}

impl Instance {
    /// An instance with the identity transform, of no motif, without colour, shadow and stroke.
    pub fn new(id: InstanceId, element: ElementId) -> Self {
        let transform = Affine::IDENTITY.as_coeffs();
        Self { id, element, transform, motif: None, colour: None, shadow: None, stroke: None, height: 0 }
    }

    /// The transform.
    pub fn affine(&self) -> Affine {
        Affine::new(self.transform)
    }
}

/// A smooth colour field through control points (see [`field`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
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
    /// A scene of the given size in pixels, without page, elements, parameters, domain and edits. It does not
    /// tile.
    pub fn new([width, height]: [u32; 2], libraries: Vec<LibraryRef>, layers: Vec<Layer>) -> Self {
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            width,
            height,
            page: None,
            stacking: [0; 2],
            tile: Tile::default(),
            parameters: None,
            program: vtex_base::PROGRAM.into(),
            libraries,
            elements: Vec::new(),
            layers,
            domain: None,
            edits: Vec::new(),
        }
    }

    /// The three layers of a homogeneous texture: a background with the given field, secondary and
    /// primary elements, the latter two empty.
    pub fn three_layers(field: Field) -> Vec<Layer> {
        let background = Layer { field: Some(field), ..Layer::new(Role::Background) };
        vec![background, Layer::new(Role::Secondary), Layer::new(Role::Primary)]
    }

    /// Refuses a scene made in memory that breaks its invariants.
    ///
    /// # Errors
    /// [`Error::Format`](vtex_base::Error::Format) that says what is wrong.
    pub fn check(&self) -> Result<()> {
        let refused =
            |reason| vtex_base::Error::Format { name: "scene".into(), format: Self::FORMAT, reason };
        self.validate().map_err(refused)
    }

    /// The scene with a background of one colour, or with none, so that it is transparent between the
    /// elements.
    pub fn with_background(mut self, colour: Option<Colour>) -> Self {
        let plain = |field: Field| Some(Field { points: Vec::new(), fallback: colour?, ..field });
        for layer in &mut self.layers {
            layer.field = layer.field.take().and_then(plain);
        }
        self
    }

    /// All instances, in painting order.
    pub fn instances(&self) -> impl DoubleEndedIterator<Item = &Instance> {
        self.layers.iter().flat_map(|layer| &layer.instances)
    }

    /// All instances, in painting order, to change them.
    pub fn instances_mut(&mut self) -> impl Iterator<Item = &mut Instance> {
        self.layers.iter_mut().flat_map(|layer| &mut layer.instances)
    }

    /// The instances of all layers of a role, in painting order.
    pub fn of_role(&self, role: Role) -> impl DoubleEndedIterator<Item = &Instance> {
        let layers = self.layers.iter().filter(move |layer| layer.role == role);
        layers.flat_map(|layer| &layer.instances)
    }

    /// The instances of all layers of individual elements, in painting order.
    pub fn individuals(&self) -> impl DoubleEndedIterator<Item = &Instance> {
        let layers = self.layers.iter().filter(|layer| layer.role.is_individual());
        layers.flat_map(|layer| &layer.instances)
    }

    /// The role of each instance, in painting order.
    pub fn roles(&self) -> impl Iterator<Item = Role> {
        self.layers.iter().flat_map(|layer| std::iter::repeat_n(layer.role, layer.instances.len()))
    }

    /// Number of instances in all layers.
    pub fn count(&self) -> usize {
        self.layers.iter().map(|layer| layer.instances.len()).sum()
    }

    /// The field that lies under the elements of the layer with the given index: its own, or that of the
    /// next layer below that has one.
    pub fn field_under(&self, layer: usize) -> Option<&Field> {
        self.layers[..=layer].iter().rev().find_map(|layer| layer.field.as_ref())
    }

    /// Whether a layer is clipped at the edge of the domain.
    pub fn is_clipped(&self, layer: &Layer) -> bool {
        self.domain.as_ref().is_some_and(|d| Domain::clips(d.edge, layer.role))
    }

    /// The element that an instance shows.
    ///
    /// # Panics
    /// If the scene lists no such element, which [`Scene::read`] excludes.
    pub fn element(&self, instance: &Instance) -> &Element {
        &self.elements[instance.element.index()]
    }

    /// Adds an element. Returns its index.
    pub fn add(&mut self, element: Element) -> ElementId {
        self.elements.push(element);
        ElementId::after(self.elements.len() - 1)
    }

    /// Drops elements that no instance shows.
    pub fn drop_unused(&mut self) {
        let mut used = vec![false; self.elements.len()];
        self.instances().for_each(|instance| used[instance.element.index()] = true);
        if used.iter().all(|u| *u) {
            return;
        }
        let mut next = 0;
        let numbers: Vec<ElementId> = used
            .iter()
            .map(|used| {
                let number = ElementId(next);
                next += u32::from(*used);
                number
            })
            .collect();
        let mut marks = used.iter();
        self.elements.retain(|_| marks.next().is_some_and(|used| *used));
        self.instances_mut().for_each(|i| i.element = numbers[i.element.index()]);
    }
}

document!(Scene, "vtex-scene", 2);

impl Document for Scene {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> std::result::Result<(), String> {
        validate::validate(self)
    }
}
