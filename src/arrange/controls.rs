//! Shapes and maps that steer synthesis.

use crate::error::{Error, Result, check};
use crate::geometry::Outline;
use crate::raster::{ControlMap, LabelMap};

/// Shapes and maps that steer synthesis. All maps are stretched over the canvas. The
/// default steers nothing.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    /// The shape to fill, in pixels of the canvas; by default all of the canvas. What becomes of
    /// textons at its edge is in the parameters.
    pub domain: Option<Outline>,
    /// Density of primaries and secondaries relative to the exemplar's, 0 to 2.
    pub density: Option<ControlMap>,
    /// How much of each library there is, 0 to 1: one map for each of several libraries. What they
    /// say counts relative to their sum. None for a single library.
    pub shares: Vec<ControlMap>,
    /// What leads the large structure of a single library; by default chance.
    pub lead: Option<Lead>,
}

/// What leads the large structure. Placement by correspondences follows it.
#[derive(Clone, Debug)]
pub enum Lead {
    /// The stratum of each pixel, by its number in the library.
    Strata(LabelMap),
    /// Lightness, 0 to 1. Its distribution is matched to that of the exemplar.
    Lightness(ControlMap),
}

impl Controls {
    /// Checks what can be checked: the number of maps.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless there is a map of shares for each library, or one library and
    /// none.
    pub(crate) fn validate(&self, libraries: usize) -> Result<()> {
        check((1..=Self::MOST_LIBRARIES).contains(&libraries), "libraries", libraries, "1 to 16 libraries")?;
        let maps = self.shares.len();
        if maps == libraries || (maps == 0 && libraries == 1) {
            return Ok(());
        }
        Err(Error::Parameter {
            name: "map",
            value: maps.to_string(),
            allowed: "a map of shares for each library",
        })
    }

    /// Most libraries that one scene is made from.
    pub const MOST_LIBRARIES: usize = 16;
}
