//! The file of weights that a search found (`*.weights.json`).

use super::Terms;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::Path;
use vtex_base::document::{self, Document};
use vtex_base::error::Result;
use vtex_scene::scene::{LibraryRef, SynthParams, Weights};

/// The result of tuning for one library: the weights of the placement score, and the measured quality of
/// placement before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TunedWeights {
    /// Always `vtex-weights`.
    pub format: String,
    /// Version of the format; this is 1.
    pub version: u32,
    /// Name and version of the program.
    pub program: String,
    /// The library they were found for.
    pub library: LibraryRef,
    /// The weights.
    pub weights: Weights,
    /// Terms of the default weights, on scenes that the search has not seen.
    pub before: Terms,
    /// Terms of these weights, on the same scenes.
    pub after: Terms,
    /// Width and height of the scenes, in pixels.
    pub size: [u32; 2],
    /// Seed of the search and of its scenes.
    pub seed: u64,
    /// Scenes placed for each set of weights.
    pub seeds: u32,
    /// Sets of weights tried.
    pub evaluations: u32,
}

impl TunedWeights {
    /// The name in [`TunedWeights::format`].
    pub const FORMAT: &'static str = "vtex-weights";
    /// The version in [`TunedWeights::version`].
    pub const VERSION: u32 = 1;

    /// Reads and validates weights.
    ///
    /// # Errors
    /// Unreadable file, not JSON, another format or version, or weights out of range.
    pub fn read(path: &Path) -> Result<Self> {
        document::read(path)
    }

    /// Reads and validates weights from bytes; `name` appears in errors.
    ///
    /// # Errors
    /// As [`TunedWeights::read`], without the file.
    pub fn from_bytes<'a>(bytes: impl Into<Cow<'a, [u8]>>, name: &str) -> Result<Self> {
        document::from_bytes(bytes, name)
    }

    /// The weights as JSON, ending in a newline.
    pub fn to_json(&self) -> Vec<u8> {
        document::to_json(self)
    }
}

impl Document for TunedWeights {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> std::result::Result<(), String> {
        let params = SynthParams { weights: self.weights.clone(), ..SynthParams::default() };
        params.validate().map_err(|e| e.to_string())
    }
}
