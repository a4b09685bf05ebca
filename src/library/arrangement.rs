//! The arrangement: a run-length coded map of the primaries in the exemplar.

use crate::raster::LabelMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The map of primaries over the exemplar, row by row.
///
/// Descriptors are not stored individually. Each is a window of this map around its texton, extended
/// by the textons that reach out of it, and is derived from the map when needed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Arrangement {
    /// Width, in pixels.
    pub width: u32,
    /// Height, in pixels.
    pub height: u32,
    /// `label, length, label, length, …` over all rows in turn. Label 0 is background, label k is primary
    /// k - 1. Lengths add up to `width * height`.
    pub runs: Vec<u32>,
}

impl Arrangement {
    /// Encodes a label map in which label k is primary k - 1 and 0 is background.
    pub fn from_labels(map: &LabelMap) -> Self {
        let mut runs = Vec::new();
        for run in map.labels.chunk_by(|a, b| a == b) {
            runs.extend([run[0], run.len() as u32]);
        }
        Self { width: map.width, height: map.height, runs }
    }

    /// Decodes the label map. The arrangement must be valid (see [`Arrangement::check`]).
    pub fn to_labels(&self) -> LabelMap {
        let mut labels = Vec::with_capacity(self.width as usize * self.height as usize);
        for run in self.runs.chunks_exact(2) {
            labels.extend(std::iter::repeat_n(run[0], run[1] as usize));
        }
        labels.resize(self.width as usize * self.height as usize, 0);
        LabelMap { width: self.width, height: self.height, labels }
    }

    /// Checks that the runs cover the map exactly and contain no label above `largest`.
    ///
    /// # Errors
    /// A description of the first fault.
    pub fn check(&self, largest: u32) -> Result<(), String> {
        let pairs = self.runs.chunks_exact(2);
        if !pairs.remainder().is_empty() {
            return Err("arrangement.runs has an odd number of entries".into());
        }
        let mut total = 0u64;
        for run in pairs {
            if run[0] > largest {
                return Err(format!("arrangement.runs names primary {}, there are {largest}", run[0]));
            }
            total += u64::from(run[1]);
        }
        let wanted = u64::from(self.width) * u64::from(self.height);
        if total != wanted {
            return Err(format!("arrangement.runs covers {total} pixels, not {wanted}"));
        }
        Ok(())
    }
}
