//! The texton library: all that analysis knows of an exemplar (`*.lib.json`).

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

/// All that analysis knows of one exemplar. Coordinates are exemplar pixels, x right, y down,
/// pixel centres at .5; colours are 8-bit sRGB.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Library {
    /// Always `vtex-library`.
    pub format: String,
    /// Version of the format; this is 1.
    pub version: u32,
    /// Where the library comes from.
    pub source: Source,
    /// Large distinct textons, in painting order.
    pub primaries: Vec<Primary>,
    /// Small textons between the primaries.
    pub secondaries: Secondaries,
    /// Clusters of primaries that look alike.
    pub categories: Vec<Category>,
    /// Share of the exemplar covered by primaries, 0 to 1.
    pub coverage: f64,
    /// The smooth ground.
    pub background: Background,
    /// Which primary stands where in the exemplar: descriptors are windows of this map.
    pub arrangement: Arrangement,
    /// Half the side of a descriptor's window, in pixels (DESIGN: 2.25 mean neighbour distances).
    pub descriptor_half: u32,
    /// The exemplar's colours on a coarse grid, which placement by correspondences follows. Absent
    /// from libraries of older versions, whose textons are placed by descriptors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guide: Option<Guide>,
}

/// Where a library comes from.
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
    /// What made the masks, such as `regions`.
    pub segmenter: String,
    /// The parameters, resolved.
    pub parameters: AnalyzeParams,
    /// Name and version of the program.
    pub program: String,
    /// What the user was warned of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// A large distinct texton.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Primary {
    /// Its index.
    pub id: TextonId,
    /// Its outline, where it stands in the exemplar.
    pub outline: Outline,
    /// Median colour of its pixels.
    pub colour: Colour,
    /// Colour painted beneath the details: that of the largest detail, which is not repeated.
    pub base: Colour,
    /// Painted in place of the base colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
    /// Its category.
    pub category: CategoryId,
    /// Number of pixels.
    pub area: u32,
    /// Mean of its pixel centres.
    pub centroid: [f64; 2],
    /// Polsby–Popper compactness of its smooth outline, 0 to 1.
    pub compactness: f64,
    /// Cut by the border of the exemplar: part of the arrangement, never placed anew.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clipped: bool,
    /// What is painted on it, in painting order. What is painted later covers the joints.
    pub details: Vec<Detail>,
}

impl Primary {
    /// The point that stands for it: its centroid in whole pixels.
    pub(crate) fn origin(&self) -> [i32; 2] {
        self.centroid.map(|v| libm::round(v) as i32)
    }
}

/// A patch on a primary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Detail {
    /// Its outline, where it stands in the exemplar.
    pub outline: Outline,
    /// Its colour; with a gradient, its median colour.
    pub colour: Colour,
    /// Painted in place of the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
}

/// The secondary textons and their spacing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Secondaries {
    /// Typical distance between neighbours, in pixels; 0 if there are fewer than three.
    pub spacing: f64,
    /// The textons.
    pub textons: Vec<Secondary>,
}

/// A small texton between the primaries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Secondary {
    /// Its outline, where it stands in the exemplar.
    pub outline: Outline,
    /// Median colour of its pixels.
    pub colour: Colour,
    /// Colour minus the background field at the centroid, per sRGB component, -255 to 255.
    pub difference: [i16; 3],
    /// Number of pixels.
    pub area: u32,
    /// Mean of its pixel centres.
    pub centroid: [f64; 2],
}

impl Secondary {
    /// The point that stands for it: its centroid in whole pixels.
    pub(crate) fn origin(&self) -> [i32; 2] {
        self.centroid.map(|v| libm::round(v) as i32)
    }
}

/// A cluster of primaries that look alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Category {
    /// Mean of its members' features: red, green, blue (0 to 255), area (px), compactness.
    pub centre: [f64; 5],
    /// Number of members.
    pub members: u32,
    /// Share of the exemplar that its members cover, 0 to 1.
    pub coverage: f64,
}

/// The ground beneath all textons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Background {
    /// Distance between sites, in pixels.
    pub spacing: f64,
    /// Colour where nothing better is known.
    pub fallback: Colour,
    /// The palette, each colour where it was taken.
    pub sites: Vec<ControlPoint>,
}

impl Library {
    /// The name in [`Library::format`].
    pub const FORMAT: &'static str = "vtex-library";
    /// The version in [`Library::version`].
    pub const VERSION: u32 = 1;

    /// Reads and validates a library; `.gz` is unpacked by content.
    ///
    /// # Errors
    /// Unreadable file, not JSON, another format or version, or a broken invariant.
    pub fn read(path: &Path) -> Result<Self> {
        document::read(path)
    }

    /// Reads and validates a library from bytes; `name` appears in errors.
    ///
    /// # Errors
    /// As [`Library::read`], without the file.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        document::from_bytes(bytes, name)
    }

    /// The library as JSON, ending in a newline.
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
