//! The texton library: the result of analysing an exemplar (`*.lib.json`).

mod arrangement;
mod guide;
mod parameters;
#[cfg(test)]
pub(crate) mod testing;
mod validate;

pub use arrangement::Arrangement;
pub use guide::{Guide, Picture};
pub use parameters::{AnalyzeParams, Shading};

use crate::document::{self, Document};
use crate::error::Result;
use crate::geometry::Outline;
use crate::raster::colour::Colour;
use crate::scene::{ControlPoint, Gradient};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Largest side of an exemplar, in pixels.
const LARGEST_SIDE: u32 = 16_384;

/// Index of a primary texton in [`Library::primaries`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct TextonId(pub u32);

/// Index of a category in [`Library::categories`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct CategoryId(pub u16);

/// The result of analysing one exemplar. Coordinates are exemplar pixels, x right, y down, pixel
/// centres at .5; colours are 8-bit sRGB.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Library {
    /// Always `vtex-library`.
    pub format: String,
    /// Version of the format; this is 1.
    pub version: u32,
    /// The exemplar, and how it was analysed.
    pub source: Source,
    /// Large distinct textons, in painting order.
    pub primaries: Vec<Primary>,
    /// Small textons between the primaries.
    pub secondaries: Secondaries,
    /// Clusters of primaries that look alike.
    pub categories: Vec<Category>,
    /// Share of the exemplar covered by primaries, 0 to 1.
    pub coverage: f64,
    /// Colours of the background between the textons.
    pub background: Background,
    /// Map of the primaries in the exemplar. Descriptors are windows of this map.
    pub arrangement: Arrangement,
    /// Half the side of a descriptor's window, in pixels. By default 2.25 mean neighbour distances.
    pub descriptor_half: u32,
    /// The exemplar's colours on a coarse grid, which placement by correspondences follows. `None` in
    /// libraries of older versions; their textons are placed by descriptors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guide: Option<Guide>,
}

/// The origin of a library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// File name of the exemplar, without its folder.
    pub file: String,
    /// Width of the exemplar, in pixels.
    pub width: u32,
    /// Height of the exemplar, in pixels.
    pub height: u32,
    /// SHA-256 of the exemplar's file, in hexadecimal.
    pub sha256: String,
    /// Name of the segmenter that made the masks, such as `regions`.
    pub segmenter: String,
    /// Parameters of the analysis, with all defaults filled in.
    pub parameters: AnalyzeParams,
    /// Name and version of the program that made the library.
    pub program: String,
    /// Warnings of the analysis, one sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// A large distinct texton.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Primary {
    /// Index in [`Library::primaries`].
    pub id: TextonId,
    /// Outline at its position in the exemplar.
    pub outline: Outline,
    /// Median colour of its pixels.
    pub colour: Colour,
    /// Fill colour underneath the details: that of the largest detail, which is not listed itself.
    pub base: Colour,
    /// Gradient that replaces the base colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
    /// Category of similar primaries.
    pub category: CategoryId,
    /// Area, in pixels.
    pub area: u32,
    /// Centroid, in pixels.
    pub centroid: [f64; 2],
    /// Polsby–Popper compactness of the outline, 4π · area / perimeter², 0 to 1.
    pub compactness: f64,
    /// Whether it is cut off by the border of the exemplar. Such a texton belongs to the arrangement but
    /// is never placed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clipped: bool,
    /// Patches painted on the primary, in painting order. Each extends a little underneath later ones.
    pub details: Vec<Detail>,
}

impl Primary {
    /// The point that stands for it: its centroid in whole pixels.
    pub(crate) fn origin(&self) -> [i32; 2] {
        self.centroid.map(|v| libm::round(v) as i32)
    }
}

/// A detail of a primary: a filled shape on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Detail {
    /// Outline at its position in the exemplar.
    pub outline: Outline,
    /// Fill colour; if there is a gradient, the median colour.
    pub colour: Colour,
    /// Gradient that replaces the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
}

/// The secondary textons and their spacing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Secondaries {
    /// Typical distance between neighbours, in pixels; 0 if there are fewer than three.
    pub spacing: f64,
    /// The secondary textons.
    pub textons: Vec<Secondary>,
}

/// A small texton between the primaries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Secondary {
    /// Outline at its position in the exemplar.
    pub outline: Outline,
    /// Median colour of its pixels.
    pub colour: Colour,
    /// Colour minus the background field at the centroid, per sRGB component, -255 to 255.
    pub difference: [i16; 3],
    /// Area, in pixels.
    pub area: u32,
    /// Centroid, in pixels.
    pub centroid: [f64; 2],
}

impl Secondary {
    /// The point that stands for it: its centroid in whole pixels.
    pub(crate) fn origin(&self) -> [i32; 2] {
        self.centroid.map(|v| libm::round(v) as i32)
    }
}

/// A cluster of similar primaries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Category {
    /// Mean of its members' features: red, green, blue (0 to 255), area (pixels), compactness (0 to 1).
    pub centre: [f64; 5],
    /// Number of members.
    pub members: u32,
    /// Share of the exemplar that its members cover, 0 to 1.
    pub coverage: f64,
}

/// The background palette: colours sampled between the textons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Background {
    /// Least distance between sites, in pixels.
    pub spacing: f64,
    /// Colour of the background if there are no sites.
    pub fallback: Colour,
    /// Sampled colours with their positions.
    pub sites: Vec<ControlPoint>,
}

impl Library {
    /// Value of [`Library::format`].
    pub const FORMAT: &'static str = "vtex-library";
    /// Value of [`Library::version`].
    pub const VERSION: u32 = 1;

    /// Reads and validates a library. Gzip is detected by content.
    ///
    /// # Errors
    /// [`crate::Error::Read`] for an unreadable file; [`crate::Error::Format`] for anything but a valid
    /// library of this version.
    pub fn read(path: &Path) -> Result<Self> {
        document::read(path)
    }

    /// Reads and validates a library from bytes, plain or gzip. `name` appears in errors.
    ///
    /// # Errors
    /// [`crate::Error::Format`] for anything but a valid library of this version.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        document::from_bytes(bytes, name)
    }

    /// Serialises the library as JSON, ending in a newline.
    pub fn to_json(&self) -> Vec<u8> {
        document::to_json(self)
    }
}

impl Document for Library {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> std::result::Result<(), String> {
        validate::validate(self)
    }
}
