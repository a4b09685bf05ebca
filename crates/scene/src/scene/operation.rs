//! Operations on scenes as plain data: an action and the elements that it applies to. Scenes record them, and
//! `edit` applies them.

use super::{InstanceId, Shadow};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::Parameter;
use vtex_base::raster::colour::Colour;

/// An action on a selection of a scene's textons. Files are referred to by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Operation {
    /// The action.
    pub action: Action,
    /// The layers that are selected, by name or role ([`Role::name`](super::Role::name)), with the
    /// points of their fields. Default: the elements of all layers, and no fields.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer: Option<String>,
    /// Conditions that a texton must all fulfil to be selected. Default: none.
    #[serde(default, rename = "where", skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Condition>,
}

impl From<Action> for Operation {
    /// The action applied to all elements.
    fn from(action: Action) -> Self {
        Self { action, layer: None, conditions: Vec::new() }
    }
}

/// An action on elements. Lengths in pixels of the canvas, angles in degrees, clockwise on the screen, shares
/// 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Action {
    /// Textons are removed: a share of each layer is kept, or the ones that are large enough.
    Thin {
        /// Share kept.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schemars(transform = Self::KEEP.limits()))]
        keep: Option<f64>,
        /// The textons that are removed first.
        order: ThinOrder,
        /// Smaller textons are removed, and smaller details of the others, in pixels².
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schemars(transform = Self::MINIMUM_AREA.limits()))]
        minimum_area: Option<f64>,
    },
    /// Each texton is kept with the probability that the map has at its place.
    Density {
        /// File of a grey picture, black 0 to white 1, stretched over the canvas.
        map: String,
    },
    /// Longer axes are turned towards a direction.
    Orient {
        /// The direction.
        direction: Direction,
        /// Share of the way.
        #[cfg_attr(feature = "schema", schemars(transform = Self::STRENGTH.limits()))]
        strength: f64,
    },
    /// Colours are mixed with one, in Oklab.
    Tint {
        /// The colour, or a picture, stretched over the canvas, that has the colour at each texton's place.
        colour: ColourOrMap,
        /// Its share.
        #[cfg_attr(feature = "schema", schemars(transform = Self::AMOUNT.limits()))]
        amount: f64,
        /// Share of the textons that are tinted.
        #[cfg_attr(feature = "schema", schemars(transform = Self::SHARE.limits()))]
        share: f64,
    },
    /// Colours similar to one are shifted towards another, less similar ones by a smaller amount, in Oklab.
    Recolor {
        /// The colour that is replaced.
        from: Colour,
        /// The colour that replaces it.
        to: Colour,
        /// Oklab distance up to which colours are moved.
        #[cfg_attr(feature = "schema", schemars(transform = Self::REACH.limits()))]
        reach: f64,
        /// What stays as it is within elements. Default nothing, which is not stored.
        #[serde(default, skip_serializing_if = "Keep::is_default")]
        keep: Keep,
    },
    /// The main colours that are seen, by the area that they cover, get those of a palette, both from dark to light;
    /// shading stays. Without a layer and conditions that exclude them, backgrounds change, too.
    Palette {
        /// The new colours.
        colours: Vec<Colour>,
        /// The file that they were read from, if any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String>,
    },
    /// A shadow under each texton.
    Shadow {
        /// Where it falls.
        #[cfg_attr(feature = "schema", schemars(transform = Self::SHADOW_ANGLE.limits()))]
        angle: f64,
        /// How far.
        #[cfg_attr(feature = "schema", schemars(transform = Self::SHADOW_LENGTH.limits()))]
        length: f64,
        /// How dark; 0 takes shadows away.
        #[cfg_attr(feature = "schema", schemars(transform = Self::OPACITY.limits()))]
        opacity: f64,
        /// Width of its soft edge.
        #[cfg_attr(feature = "schema", schemars(transform = Self::BLUR.limits()))]
        blur: f64,
    },
    /// Details are dropped; each texton has one colour, the mean.
    Flatten,
    /// Outlines are drawn again with fewer points, and details too small to be seen then go.
    Simplify {
        /// How far an outline may move.
        #[cfg_attr(feature = "schema", schemars(transform = Self::TOLERANCE.limits()))]
        tolerance: f64,
    },
    /// A line along each outline.
    Outline {
        /// Its width; 0 takes lines away.
        #[cfg_attr(feature = "schema", schemars(transform = Self::WIDTH.limits()))]
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// Textons become drawings in ink: an outline on paper, and hatching that is the denser the darker they are.
    Hatch {
        /// Distance of the lines of the lightest tone; darker ones have them closer, then crossed.
        #[cfg_attr(feature = "schema", schemars(transform = Self::HATCH_SPACING.limits()))]
        spacing: f64,
        /// Their direction.
        #[cfg_attr(feature = "schema", schemars(transform = Self::HATCH_ANGLE.limits()))]
        angle: f64,
        /// Their width, and that of outlines.
        #[cfg_attr(feature = "schema", schemars(transform = Self::HATCH_WIDTH.limits()))]
        width: f64,
        /// The colour of the ink.
        colour: Colour,
        /// The colour of the paper, within outlines.
        paper: Colour,
    },
    /// Each texton becomes the one of a library that fits best.
    Replace {
        /// File of the library.
        library: String,
    },
    /// Textons are moved.
    Move {
        /// To the right.
        #[cfg_attr(feature = "schema", schemars(transform = Self::X.limits()))]
        x: f64,
        /// Down.
        #[cfg_attr(feature = "schema", schemars(transform = Self::Y.limits()))]
        y: f64,
    },
    /// Textons grow about their own centres.
    Scale {
        /// The factor; or a map, black 0.01, middle grey 1, white 2.
        factor: NumberOrMap,
    },
    /// Textons turn about their own centres.
    Rotate {
        /// The angle; or a map, black 0 to white 360.
        angle: NumberOrMap,
    },
    /// Textons are moved, turned, scaled and stretched together, about their own centres or the centre of
    /// all.
    Transform {
        /// Shift to the right and down.
        by: [f64; 2],
        /// Factors along x and y.
        scale: [f64; 2],
        /// The angle, applied after scaling.
        #[cfg_attr(feature = "schema", schemars(transform = Self::TURN.limits()))]
        angle: f64,
        /// The fixed point of scaling and rotation, before the shift.
        about: About,
    },
    /// Textons are moved, turned, scaled and recoloured at random, each on its own.
    Jitter(Jitter),
    /// Appearances, that is, colours with details, are exchanged among textons of similar size.
    Shuffle {
        /// The textons among which appearances are exchanged.
        within: Within,
        /// Share of the textons that take part.
        #[cfg_attr(feature = "schema", schemars(transform = Self::SHARE.limits()))]
        share: f64,
        /// Whether outlines are exchanged too, each drawn in the other's frame.
        outlines: bool,
    },
    /// The variation of appearances and shapes about their mean is scaled (Tu, dissertation, equations 4.27
    /// to 4.30). A factor of 0 makes all equal and 1 changes nothing; of a map black is 0, middle grey 1, white
    /// 2.
    Vary {
        /// Factor of the distance of colours from their mean, in Oklab.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        colour: Option<NumberOrMap>,
        /// Factor for size, elongation and direction.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<NumberOrMap>,
        /// The textons that share one mean.
        within: Within,
    },
    /// Textons move apart where they are close, so that distances become even.
    Relax {
        /// Number of rounds.
        #[cfg_attr(feature = "schema", schemars(transform = Self::ROUNDS.limits()))]
        rounds: u32,
        /// Share of the missing distance that is moved in each round.
        #[cfg_attr(feature = "schema", schemars(transform = Self::RELAX_STRENGTH.limits()))]
        strength: f64,
        /// Least distance; default: that of a regular lattice of equally many textons.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schemars(transform = Self::MINIMUM_DISTANCE.limits()))]
        minimum_distance: Option<f64>,
    },
    /// Shapes drawn on one texton are repeated on all similar ones, in their frames. One of `drawing`,
    /// `element` and `fill` is given.
    Propagate {
        /// File of a drawing over the canvas, an SVG fitted to it. The texton beneath it is the one drawn on.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drawing: Option<String>,
        /// File of a drawing by itself, an SVG: its largest shape is brought onto each texton.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        element: Option<String>,
        /// A colour that replaces that of the texton's first shape.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fill: Option<Colour>,
        /// The texton that others are compared with; default: the one beneath `drawing`. Without a drawing,
        /// all selected textons are similar.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        of: Option<InstanceId>,
        /// Largest distance of the median colours of similar textons, in Oklab; default: textons of one
        /// category are similar.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "schema", schemars(transform = Self::SIMILAR.limits()))]
        similar: Option<f64>,
        /// Whether it replaces their shapes instead of being drawn on them.
        replace: bool,
    },
    /// The painting order within each layer.
    Order {
        /// The property by which textons are sorted; the least is painted first.
        by: OrderBy,
        /// Whether the order is reversed.
        reverse: bool,
    },
    /// Textons are removed.
    Delete,
    /// Textons whose centre lies on the wrong side of a shape are removed.
    Mask {
        /// File of the shape: an SVG with one path, fitted to the canvas, or a picture, white inside.
        shape: String,
        /// Whether those inside are kept, else those outside.
        inside: bool,
    },
}

/// Ranges, units and defaults of numbers, by their names in `vtex edit`.
#[allow(missing_docs)]
impl Action {
    pub const KEEP: Parameter<f64> = Parameter::new("keep", [0.0, 1.0], "");
    pub const MINIMUM_AREA: Parameter<f64> = Parameter::new("min-area", [0.0, 1e9], "px of area");
    pub const DEGREES: Parameter<f64> = Parameter::new("degrees", [-360.0, 360.0], "degrees");
    pub const STRENGTH: Parameter<f64> = Parameter::new("strength", [0.0, 1.0], "").or(1.0);
    pub const AMOUNT: Parameter<f64> = Parameter::new("amount", [0.0, 1.0], "").or(0.5);
    pub const SHARE: Parameter<f64> = Parameter::new("share", [0.0, 1.0], "").or(1.0);
    pub const REACH: Parameter<f64> = Parameter::new("reach", [0.01, 2.0], "").or(0.2);
    pub const SHADOW_ANGLE: Parameter<f64> = Parameter::new("angle", [-360.0, 360.0], "degrees").or(45.0);
    pub const SHADOW_LENGTH: Parameter<f64> = Parameter::new("length", [0.0, 1000.0], "px").or(5.0);
    pub const OPACITY: Parameter<f64> = Parameter::new("opacity", [0.0, 1.0], "").or(0.4);
    pub const BLUR: Parameter<f64> = Parameter::new("blur", [0.0, Shadow::WIDEST], "px").or(5.0);
    pub const TOLERANCE: Parameter<f64> = Parameter::new("px", [0.01, 100.0], "px");
    pub const WIDTH: Parameter<f64> = Parameter::new("width", [0.0, 1000.0], "px");
    pub const HATCH_SPACING: Parameter<f64> = Parameter::new("spacing", [0.5, 1000.0], "px").or(4.0);
    pub const HATCH_ANGLE: Parameter<f64> = Parameter::new("angle", [-360.0, 360.0], "degrees").or(-45.0);
    pub const HATCH_WIDTH: Parameter<f64> = Parameter::new("width", [0.01, 1000.0], "px").or(0.7);
    pub const X: Parameter<f64> = Parameter::new("x", [-1e6, 1e6], "px");
    pub const Y: Parameter<f64> = Parameter::new("y", [-1e6, 1e6], "px");
    pub const FACTOR: Parameter<f64> = Parameter::new("factor", [0.01, 100.0], "");
    /// Of each coordinate.
    pub const WAY: Parameter<f64> = Parameter::new("move", [-1e6, 1e6], "px each");
    /// Of each axis.
    pub const FACTORS: Parameter<f64> = Parameter::new("scale", [0.01, 100.0], "each");
    pub const TURN: Parameter<f64> = Parameter::new("rotate", [-360.0, 360.0], "degrees").or(0.0);
    pub const COLOUR: Parameter<f64> = Parameter::new("color", [0.0, 4.0], "");
    pub const SHAPE: Parameter<f64> = Parameter::new("shape", [0.0, 4.0], "");
    pub const ROUNDS: Parameter<u32> = Parameter::new("rounds", [1, 1000], "").or(20);
    pub const RELAX_STRENGTH: Parameter<f64> = Parameter::new("strength", [0.0, 1.0], "").or(0.5);
    pub const MINIMUM_DISTANCE: Parameter<f64> = Parameter::new("min-distance", [0.0, 1000.0], "px");
    pub const SIMILAR: Parameter<f64> = Parameter::new("similar", [0.0, 2.0], "");
}

impl Action {
    /// Whether it changes no scene: such an operation is not recorded.
    pub fn is_nothing(&self) -> bool {
        let one =
            |number: &Option<NumberOrMap>| number.as_ref().is_none_or(|n| *n == NumberOrMap::Number(1.0));
        match self {
            Self::Vary { colour, shape, .. } => one(colour) && one(shape),
            Self::Transform { by, scale, angle, .. } => {
                *by == [0.0; 2] && *scale == [1.0; 2] && *angle == 0.0
            }
            _ => false,
        }
    }
}

/// A number, or a map of numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum NumberOrMap {
    /// Constant over the canvas.
    Number(f64),
    /// The file of a grey picture, stretched over the canvas.
    Map(String),
}

impl From<f64> for NumberOrMap {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// A colour, or a picture of colours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub enum ColourOrMap {
    /// Constant over the canvas.
    Colour(Colour),
    /// The file of a picture, stretched over the canvas. Where it is transparent, nothing changes.
    Map(String),
}

impl From<Colour> for ColourOrMap {
    fn from(colour: Colour) -> Self {
        Self::Colour(colour)
    }
}

/// The random changes of [`Action::Jitter`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Jitter {
    /// Largest distance.
    #[cfg_attr(feature = "schema", schemars(transform = Self::DISTANCE.limits()))]
    pub distance: f64,
    /// Largest angle either way.
    #[cfg_attr(feature = "schema", schemars(transform = Self::ANGLE.limits()))]
    pub angle: f64,
    /// Largest change of size either way, in per cent.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SCALE.limits()))]
    pub scale: f64,
    /// Largest change of the ratio of length to width either way, in per cent; areas stay.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::STRETCH.limits()))]
    pub stretch: f64,
    /// Share of the textons that are mirrored, left to right.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::FLIP.limits()))]
    pub flip: f64,
    /// Largest turn of hues either way, in degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::HUE.limits()))]
    pub hue: f64,
    /// Largest change of chroma either way, in per cent.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::CHROMA.limits()))]
    pub chroma: f64,
    /// Largest change of lightness either way, in per cent of that of white.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::LIGHTNESS.limits()))]
    pub lightness: f64,
    /// How changes are distributed.
    #[serde(default, skip_serializing_if = "Distribution::is_uniform")]
    pub distribution: Distribution,
    /// Number of equal steps from 0 to each bound; changes are multiples of a step. 0 for continuous changes.
    #[serde(default, skip_serializing_if = "is_none")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::STEPS.limits()))]
    pub steps: u32,
}

/// Ranges, units and defaults of the fields of the same names.
#[allow(missing_docs)]
impl Jitter {
    pub const DISTANCE: Parameter<f64> = Parameter::new("move", [0.0, 1e6], "px").or(0.0);
    pub const ANGLE: Parameter<f64> = Parameter::new("rotate", [0.0, 180.0], "degrees").or(0.0);
    pub const SCALE: Parameter<f64> = Parameter::new("scale", [0.0, 90.0], "per cent").or(0.0);
    pub const STRETCH: Parameter<f64> = Parameter::new("stretch", [0.0, 90.0], "per cent").or(0.0);
    pub const FLIP: Parameter<f64> = Parameter::new("flip", [0.0, 1.0], "").or(0.0);
    pub const HUE: Parameter<f64> = Parameter::new("hue", [0.0, 180.0], "degrees").or(0.0);
    pub const CHROMA: Parameter<f64> = Parameter::new("chroma", [0.0, 100.0], "per cent").or(0.0);
    pub const LIGHTNESS: Parameter<f64> = Parameter::new("lightness", [0.0, 100.0], "per cent").or(0.0);
    pub const STEPS: Parameter<u32> = Parameter::new("steps", [0, 1000], "").or(0);
}

impl Jitter {
    /// Whether it changes nothing.
    pub fn is_nothing(&self) -> bool {
        let Self { distance, angle, scale, stretch, flip, hue, chroma, lightness, .. } = self;
        [distance, angle, scale, stretch, flip, hue, chroma, lightness].iter().all(|v| **v == 0.0)
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_none(steps: &u32) -> bool {
    *steps == 0
}

/// How random changes are distributed between their bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Evenly.
    #[default]
    Uniform,
    /// Normally, with the bounds at two standard deviations; values beyond the bounds are drawn again.
    Normal,
}

impl Distribution {
    fn is_uniform(&self) -> bool {
        *self == Self::Uniform
    }
}

/// The group of textons within which an operation works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Within {
    /// Those of a layer.
    #[default]
    Layer,
    /// Those of a category within a layer; those without one are one category.
    Category,
}

/// The point about which textons are transformed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum About {
    /// The centre of each.
    #[default]
    Each,
    /// The mean of the centres of all that are selected.
    Selection,
}

/// The property that determines the painting order of textons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum OrderBy {
    /// Place of the centre from the left.
    X,
    /// Place of the centre from the top.
    Y,
    /// Area.
    Area,
    /// None: any order.
    Random,
    /// Lightness.
    Lightness,
}

/// The textons that are removed first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ThinOrder {
    /// The smallest.
    Area,
    /// Any.
    Random,
    /// Those with the nearest neighbours, so that the others stay evenly spread.
    #[default]
    BlueNoise,
}

/// What a change of colours leaves within elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// Nothing.
    #[default]
    Nothing,
    /// Colours unlike the main one of their element, such as the heart of a flower; lighter and darker shades of the
    /// main one move with it.
    Details,
}

impl Keep {
    /// Whether it is the default.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A direction for longer axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Direction {
    /// Constant over the canvas, in degrees.
    Angle(f64),
    /// The file of a grey picture, black 0° to white 180°, stretched over the canvas.
    Map(String),
}

/// A condition that an element must fulfil to be selected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Condition {
    /// Its number is one of some, or none of them.
    Among {
        /// The property that is compared.
        identity: Identity,
        /// The numbers: indices of categories and libraries, which people number from 1, or ids and numbers of motifs.
        numbers: Vec<u32>,
        /// Whether it must be one of them; otherwise it must be none of them.
        wanted: bool,
    },
    /// Its category is one of some, or none of them.
    Named {
        /// Names of categories in their libraries, in any case of letters, or their numbers from 1.
        categories: Vec<String>,
        /// Whether it must be one of them; otherwise it must be none of them.
        wanted: bool,
    },
    /// A quantity is larger or smaller than a limit.
    Compare {
        /// The property that is compared.
        quantity: Quantity,
        /// How.
        comparison: Comparison,
        /// The limit.
        limit: f64,
    },
    /// Its centre lies inside or outside a shape.
    Place {
        /// File of the shape, as that of [`Action::Mask`].
        shape: String,
        /// Whether it must lie inside.
        inside: bool,
    },
}

/// Properties of elements that are whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Identity {
    /// Category; secondaries have none.
    Category,
    /// Index of the library among those of the scene.
    Library,
    /// Id of the instance.
    Id,
    /// Number of the motif; elements of none have none.
    Motif,
}

impl Identity {
    /// The number shown to people for index 0.
    pub fn first_number(self) -> u32 {
        match self {
            Self::Category | Self::Library => 1,
            Self::Id | Self::Motif => 0,
        }
    }
}

/// Properties of a placed element that are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Area, in pixels².
    Area,
    /// Ratio of its length to its width, from 1.
    Elongation,
    /// Place of its centre from the left, in pixels.
    X,
    /// Place of its centre from the top, in pixels.
    Y,
}

/// How a quantity is compared with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Comparison {
    /// Smaller.
    Less,
    /// At most as large.
    AtMost,
    /// Larger.
    More,
    /// At least as large.
    AtLeast,
}

impl Comparison {
    /// Whether it holds.
    pub fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::Less => value < limit,
            Self::AtMost => value <= limit,
            Self::More => value > limit,
            Self::AtLeast => value >= limit,
        }
    }
}
