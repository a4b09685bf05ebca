//! The file of weights that a search found (`*.weights.json`).

use super::Terms;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::document;
use vtex_base::document::Document;
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

document!(TunedWeights, "vtex-weights", 1);

impl Document for TunedWeights {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> Result<(), String> {
        let params = SynthParams { weights: self.weights.clone(), ..SynthParams::default() };
        params.validate().map_err(|e| e.to_string())
    }
}
