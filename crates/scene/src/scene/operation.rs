//! Operations on scenes as plain data: an action and the elements that it applies to. Scenes record them, and
//! `edit` applies them.

use super::InstanceId;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
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
    #[serde(default, alias = "layers", skip_serializing_if = "Option::is_none")]
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
        /// Share kept. 0 to 1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        keep: Option<f64>,
        /// The textons that are removed first.
        order: ThinOrder,
        /// Smaller textons are removed, and smaller details of the others, in pixels²; from 0.
        #[serde(default, skip_serializing_if = "Option::is_none")]
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
        /// Share of the way. 0 to 1.
        strength: f64,
    },
    /// Colours are mixed with one, in Oklab.
    Tint {
        /// The colour, or a picture, stretched over the canvas, that has the colour at each texton's place.
        colour: ColourOrMap,
        /// Its share. 0 to 1.
        amount: f64,
        /// Share of the textons that are tinted. 0 to 1.
        share: f64,
    },
    /// Colours similar to one are shifted towards another, less similar ones by a smaller amount, in Oklab.
    Recolor {
        /// The colour that is replaced.
        from: Colour,
        /// The colour that replaces it.
        to: Colour,
        /// Oklab distance up to which colours are moved. 0.01 to 2.
        reach: f64,
    },
    /// Categories get new mean colours; differences in lightness within them stay.
    Palette {
        /// The new colours.
        colours: Vec<Colour>,
        /// The file that they were read from, if any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String>,
    },
    /// A shadow under each texton.
    Shadow {
        /// Where it falls. -360 to 360.
        angle: f64,
        /// How far. 0 to 1000.
        length: f64,
        /// How dark. 0 to 1; 0 takes shadows away.
        opacity: f64,
        /// Width of its soft edge. 0 to 200.
        blur: f64,
    },
    /// Details are dropped; each texton has one colour, the mean.
    Flatten,
    /// Outlines are drawn again with fewer points, and details too small to be seen then go.
    Simplify {
        /// How far an outline may move. 0.01 to 100.
        tolerance: f64,
    },
    /// A line along each outline.
    Outline {
        /// Its width. 0 to 1000; 0 takes lines away.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// Each texton becomes the one of a library that fits best.
    Replace {
        /// File of the library.
        library: String,
    },
    /// Textons are moved.
    Move {
        /// To the right. -10⁶ to 10⁶.
        x: f64,
        /// Down. -10⁶ to 10⁶.
        y: f64,
    },
    /// Textons grow about their own centres.
    Scale {
        /// The factor, 0.01 to 100; or a map, black 0.01, middle grey 1, white 2.
        factor: NumberOrMap,
    },
    /// Textons turn about their own centres.
    Rotate {
        /// The angle, -360 to 360; or a map, black 0 to white 360.
        angle: NumberOrMap,
    },
    /// Textons are moved, turned, scaled and stretched together, about their own centres or the centre of
    /// all.
    Transform {
        /// Shift to the right and down. -10⁶ to 10⁶ each.
        by: [f64; 2],
        /// Factors along x and y. 0.01 to 100 each.
        scale: [f64; 2],
        /// The angle, applied after scaling. -360 to 360.
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
        /// Share of the textons that take part. 0 to 1.
        share: f64,
        /// Whether outlines are exchanged too, each drawn in the other's frame.
        outlines: bool,
    },
    /// The variation of appearances and shapes about their mean is scaled (Tu, dissertation, equations 4.27
    /// to 4.30). Each factor is 0 to 4, where 0 makes all equal and 1 changes nothing, or a map, black 0,
    /// middle grey 1, white 2.
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
        /// Number of rounds. 1 to 1000.
        rounds: u32,
        /// Share of the missing distance that is moved in each round. 0 to 1.
        strength: f64,
        /// Least distance, 0 to 1000; default: that of a regular lattice of equally many textons.
        #[serde(default, skip_serializing_if = "Option::is_none")]
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
        /// Largest distance of the median colours of similar textons, in Oklab, 0 to 2; default: textons of
        /// one category are similar.
        #[serde(default, skip_serializing_if = "Option::is_none")]
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
    /// Largest distance. 0 to 10⁶.
    pub distance: f64,
    /// Largest angle either way. 0 to 180.
    pub angle: f64,
    /// Largest change of size either way, in per cent. 0 to 90.
    pub scale: f64,
    /// Largest change of the ratio of length to width either way, in per cent; areas stay. 0 to 90.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub stretch: f64,
    /// Share of the textons that are mirrored, left to right. 0 to 1.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub flip: f64,
    /// Largest turn of hues either way, in degrees. 0 to 180.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub hue: f64,
    /// Largest change of chroma either way, in per cent. 0 to 100.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub chroma: f64,
    /// Largest change of lightness either way, in per cent of that of white. 0 to 100.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub lightness: f64,
    /// How changes are distributed.
    #[serde(default, skip_serializing_if = "Distribution::is_uniform")]
    pub distribution: Distribution,
    /// Number of equal steps from 0 to each bound; changes are multiples of a step. Up to 1000; 0 for
    /// continuous changes.
    #[serde(default, skip_serializing_if = "is_none")]
    pub steps: u32,
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

/// A direction for longer axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Direction {
    /// Constant over the canvas, in degrees. -360 to 360.
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
        /// The numbers: indices of categories and libraries, which people number from 1, or ids.
        numbers: Vec<u32>,
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
}

impl Identity {
    /// The number shown to people for index 0.
    pub fn first_number(self) -> u32 {
        match self {
            Self::Category | Self::Library => 1,
            Self::Id => 0,
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
