//! Operations as plain data, files read and every value within its range.

use crate::geometry::Region;
use crate::library::Library;
use crate::raster::ControlMap;
use crate::raster::colour::Colour;

/// Something done to a selection of a scene's textons.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// As it was written; this is what the scene records.
    pub text: String,
    /// Where the textons stand that it is for.
    pub layers: Layers,
    /// What they fulfil, all of these.
    pub conditions: Vec<Condition>,
    /// What is done to them.
    pub action: Action,
}

/// Layers of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// Primaries only.
    Primary,
    /// Secondaries only.
    Secondary,
    /// The points of the background only; for colours.
    Background,
    /// Primaries and secondaries.
    #[default]
    All,
}

/// What is done. Lengths in pixels of the canvas, angles in degrees, clockwise on the screen, shares
/// 0 to 1; the ranges are those of [`super::catalogue`].
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Fewer textons: a share of each layer is kept, or those that are large enough.
    Thin {
        /// Share kept.
        keep: Option<f64>,
        /// Which go first.
        order: ThinOrder,
        /// Smaller textons go, and smaller details of those that stay, in pixels².
        minimum_area: Option<f64>,
    },
    /// Each texton is kept with the probability that the map has where it stands.
    Density {
        /// Probabilities, 0 to 1, stretched over the canvas.
        map: ControlMap,
    },
    /// Longer axes are turned towards a direction.
    Orient {
        /// The direction.
        direction: Direction,
        /// Share of the way.
        strength: f64,
    },
    /// Colours are mixed with one, in Oklab.
    Tint {
        /// The colour.
        colour: Colour,
        /// Its share.
        amount: f64,
        /// Share of the textons that are tinted.
        share: f64,
    },
    /// Colours like one are moved to another, those less like it less far, in Oklab.
    Recolor {
        /// What is sought.
        from: Colour,
        /// What it becomes.
        to: Colour,
        /// Oklab distance up to which colours are moved.
        reach: f64,
    },
    /// Categories get new mean colours; what is lighter or darker within them stays so.
    Palette {
        /// The new colours.
        colours: Vec<Colour>,
    },
    /// A shadow under each texton.
    Shadow {
        /// Where it falls.
        angle: f64,
        /// How far.
        length: f64,
        /// How dark.
        opacity: f64,
        /// Width of its soft edge.
        blur: f64,
    },
    /// Details are dropped; each texton has one colour, the mean.
    Flatten,
    /// Outlines are drawn again with fewer points, and details too small to be seen then go.
    Simplify {
        /// How far an outline may move.
        tolerance: f64,
    },
    /// A line along each outline.
    Outline {
        /// Its width.
        width: f64,
        /// Its colour.
        colour: Colour,
    },
    /// Each texton becomes the one of a library that fits best.
    Replace {
        /// The library.
        library: Box<Library>,
    },
    /// Textons are moved along x and y.
    Move {
        /// By so much.
        by: [f64; 2],
    },
    /// Textons grow about their own centres.
    Scale {
        /// The factor.
        factor: f64,
    },
    /// Textons turn about their own centres.
    Rotate {
        /// The angle.
        angle: f64,
    },
    /// Textons are moved, turned and scaled at random, each on its own.
    Jitter {
        /// Largest distance.
        distance: f64,
        /// Largest angle either way.
        angle: f64,
        /// Largest change of size either way, in per cent.
        scale: f64,
    },
    /// Textons are taken away.
    Delete,
    /// Textons whose centre lies on the wrong side of an outline are taken away.
    Mask {
        /// Inside of the outline, on the canvas.
        region: Region,
        /// Whether those inside are kept, else those outside.
        inside: bool,
    },
}

/// Which textons go first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThinOrder {
    /// The smallest.
    Area,
    /// Any.
    Random,
    /// Those with the nearest neighbours, so that what is left stays even.
    #[default]
    BlueNoise,
}

/// A direction for longer axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// Everywhere the same, in degrees.
    Angle(f64),
    /// By place: 0 is 0°, 1 is 180°, stretched over the canvas.
    Map(ControlMap),
}

/// What a texton must fulfil to be selected.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// One of some numbers is its own, or none is.
    Among {
        /// What is compared.
        identity: Identity,
        /// The numbers.
        numbers: Vec<u32>,
        /// Whether one of them is wanted.
        wanted: bool,
    },
    /// A quantity is larger or smaller than a limit.
    Compare {
        /// What is compared.
        quantity: Quantity,
        /// How.
        comparison: Comparison,
        /// The limit.
        limit: f64,
    },
    /// Its centre lies in a region, or does not.
    Place {
        /// The region, on the canvas.
        region: Region,
        /// Whether it is to lie inside.
        inside: bool,
    },
}

/// What tells textons apart by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Category; secondaries have none.
    Category,
    /// Index of the library among those of the scene.
    Library,
    /// Id of the instance.
    Id,
}

/// What is measured of a texton where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Area, in pixels².
    Area,
    /// How much longer than broad it is, from 1.
    Elongation,
    /// Place of its centre from the left, in pixels.
    X,
    /// Place of its centre from the top, in pixels.
    Y,
}

/// How a quantity is compared with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    pub(super) fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::Less => value < limit,
            Self::AtMost => value <= limit,
            Self::More => value > limit,
            Self::AtLeast => value >= limit,
        }
    }
}
