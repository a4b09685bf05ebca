//! How close a synthesised scene came to its exemplar, in figures.

use super::statistics::{Overlap, Repetition};
use super::target::TargetMap;
use super::{density, primaries};
use crate::library::Library;
use crate::scene::Scene;
use serde::Serialize;

/// Coverage wanted and got, and what was done for it. Shares are of the canvas, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Share of the exemplar that primaries cover.
    pub coverage_wanted: f64,
    /// Share of the canvas that primaries cover.
    pub coverage: f64,
    /// The same by category, in the library's order.
    pub categories: Vec<CategoryReport>,
    /// Primary textons placed.
    pub primaries: usize,
    /// Different primaries among them.
    pub textons: usize,
    /// Secondary textons placed.
    pub secondaries: usize,
    /// Control points of the background.
    pub control_points: usize,
    /// Requests of descriptors tried.
    pub attempts: u64,
    /// Requests for which no texton was good enough.
    pub refused: u64,
    /// Textons taken away to correct the density.
    pub removed: u64,
    /// Textons added to correct the density.
    pub added: u64,
    /// How much primaries hide of one another.
    pub overlap: Overlap,
    /// How often the same primaries come back.
    pub repetition: Repetition,
}

/// Coverage of one category.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CategoryReport {
    /// Share of the exemplar.
    pub wanted: f64,
    /// Share of the canvas that can be seen of it.
    pub got: f64,
}

impl Report {
    pub(super) fn new(
        libraries: &[Library],
        map: &TargetMap<'_>,
        scene: &Scene,
        placement: primaries::Counts,
        correction: density::Counts,
    ) -> Self {
        let library = &libraries[0];
        let canvas = f64::from(scene.width) * f64::from(scene.height);
        let category = |(c, covered): (&crate::library::Category, &u64)| CategoryReport {
            wanted: c.coverage,
            got: *covered as f64 / canvas,
        };
        Self {
            coverage_wanted: library.coverage,
            coverage: map.covered.iter().sum::<u64>() as f64 / canvas,
            categories: library.categories.iter().zip(&map.covered).map(category).collect(),
            primaries: scene.primary.len(),
            textons: scene.textons.iter().filter(|t| t.category.is_some()).count(),
            secondaries: scene.secondary.len(),
            control_points: scene.background.points.len(),
            attempts: placement.attempts,
            refused: placement.refused,
            removed: correction.removed,
            added: correction.added,
            overlap: Overlap::of_scene(scene, libraries),
            repetition: Repetition::of_scene(scene, libraries),
        }
    }
}
