//! Shapes and maps that steer synthesis.

use super::context::DrawnContext;
use vtex_base::error::{Result, check};
use vtex_base::geometry::Outline;
use vtex_base::raster::{ControlMap, LabelMap};
use vtex_scene::library::Library;

/// Shapes and maps that steer synthesis. All maps are stretched over the canvas. The
/// default steers nothing.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    /// The shape to fill, in pixels of the canvas; by default all of the canvas. The parameters say how
    /// textons at its edge are treated.
    pub domain: Option<Outline>,
    /// Density of primaries and secondaries relative to the exemplar's, 0 to 2.
    pub density: Option<ControlMap>,
    /// The amount of each library, 0 to 1: one map for each of several libraries. Values are relative to
    /// their sum. Empty for a single library.
    pub shares: Vec<ControlMap>,
    /// The guide of the large structure, for a single library. `None`: chance decides.
    pub structure: Option<StructureGuide>,
    /// A drawing that stays as it is, and the region beside it to be filled, for
    /// [`Method::Curves`](vtex_scene::scene::Method::Curves) and
    /// [`Method::Clustered`](vtex_scene::scene::Method::Clustered). `None`: the whole canvas is made.
    pub context: Option<DrawnContext>,
}

/// The large structure that placement by correspondences follows.
#[derive(Clone, Debug)]
pub enum StructureGuide {
    /// The stratum of each pixel, by its number in the library.
    Strata(LabelMap),
    /// Lightness, 0 to 1. Its distribution is matched to that of the exemplar.
    Lightness(ControlMap),
}

impl Controls {
    /// Largest density, as many times that of the exemplar.
    pub(crate) const DENSEST: f64 = 2.0;

    /// The density at a point of a canvas, 1 without a map.
    pub(crate) fn density_at(&self, point: [f64; 2], canvas: [f64; 2]) -> f64 {
        self.density.as_ref().map_or(1.0, |map| map.at(point, canvas).clamp(0.0, Self::DENSEST))
    }

    /// The largest density of the canvas.
    pub(crate) fn largest_density(&self) -> f64 {
        let Some(map) = &self.density else { return 1.0 };
        map.values().iter().map(|v| f64::from(*v)).fold(0.0, f64::max).min(Self::DENSEST)
    }

    /// The mean density of the canvas where none is above `most`.
    pub(crate) fn mean_density(&self, most: f64) -> f64 {
        let Some(map) = &self.density else { return 1.0 };
        let values = map.values().iter().map(|v| f64::from(*v).clamp(0.0, most.min(Self::DENSEST)));
        values.sum::<f64>() / map.values().len() as f64
    }

    /// Checks that the maps fit the libraries.
    ///
    /// # Errors
    /// [`Error::Parameter`](vtex_base::Error::Parameter) unless there is a map of shares for each library, or one library and
    /// none; and for a guide of the structure with several libraries, or with strata that the library does not have.
    pub(crate) fn validate(&self, libraries: &[Library]) -> Result<()> {
        let count = libraries.len();
        check((1..=Self::MOST_LIBRARIES).contains(&count), "libraries", count, "1 to 16 libraries")?;
        let maps = self.shares.len();
        check(maps == count || (maps == 0 && count == 1), "map", maps, "a map of shares for each library")?;
        check(self.structure.is_none() || count == 1, "libraries", count, "one library where a map leads")?;
        let alone = self.context.is_none() || count == 1 && self.domain.is_none();
        check(
            alone,
            "context",
            count,
            "one library, without a domain: the region is the shape that is filled",
        )?;
        let Some(StructureGuide::Strata(map)) = &self.structure else { return Ok(()) };
        let most = map.labels.iter().max().map_or(0, |&label| label as usize);
        check(most < libraries[0].strata().len(), "control", most, "numbers of layers of the library, from 0")
    }

    /// Most libraries that one scene is made from.
    pub const MOST_LIBRARIES: usize = 16;
}
