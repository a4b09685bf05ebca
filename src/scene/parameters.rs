//! Parameters of synthesis, as stored in the scene.

use crate::error::Result;
use crate::error::check;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of synthesis. Lengths in pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SynthParams {
    /// Width of the canvas. 1 to 100 000, default 1000.
    pub width: u32,
    /// Height of the canvas. 1 to 100 000, default 1000.
    pub height: u32,
    /// Seed of the random streams. Default 0.
    pub seed: u64,
    /// Candidates tried for each place. 1 to 1000, default 20.
    pub candidates: u32,
    /// Moves by one cell that may improve a placement. 0 to 100, default 5.
    pub moves: u32,
    /// Weights of the score.
    pub weights: Weights,
    /// Distance between background points; by default the library's.
    pub background_spacing: Option<f64>,
}

/// Weights of the five areas of the score (paper §3.2.1). Each -10 to 10.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Weights {
    /// Requested region covered. Default 0.5.
    pub target: f64,
    /// Requested region left uncovered. Default -0.4.
    pub uncovered: f64,
    /// Cells covered that should be empty. Default -0.2.
    pub empty: f64,
    /// Cells covered that should hold another category. Default -0.5.
    pub mismatched: f64,
    /// Cells covered of another region of the same category. Default -0.5.
    pub same_overlap: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { target: 0.5, uncovered: -0.4, empty: -0.2, mismatched: -0.5, same_overlap: -0.5 }
    }
}

impl Default for SynthParams {
    fn default() -> Self {
        Self {
            width: 1000,
            height: 1000,
            seed: 0,
            candidates: 20,
            moves: 5,
            weights: Weights::default(),
            background_spacing: None,
        }
    }
}

impl SynthParams {
    /// Largest side of a canvas, in pixels.
    pub const LARGEST_SIDE: u32 = 100_000;

    /// Checks every range.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] naming the first parameter out of range.
    pub fn validate(&self) -> Result<()> {
        let side = |v: u32| (1..=Self::LARGEST_SIDE).contains(&v);
        let size = || format!("{}x{}", self.width, self.height);
        check(side(self.width) && side(self.height), "size", size(), "1 to 100000 px on each side")?;
        check((1..=1000).contains(&self.candidates), "candidates", self.candidates, "1 to 1000")?;
        check(self.moves <= 100, "moves", self.moves, "0 to 100")?;
        let w = &self.weights;
        for value in [w.target, w.uncovered, w.empty, w.mismatched, w.same_overlap] {
            check((-10.0..=10.0).contains(&value), "weights", value, "-10 to 10 each")?;
        }
        if let Some(spacing) = self.background_spacing {
            check((4.0..=1000.0).contains(&spacing), "background-spacing", spacing, "4 to 1000 px")?;
        }
        Ok(())
    }
}
