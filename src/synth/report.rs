//! How close a synthesised scene came to its exemplar, in figures.

use super::strata::StratumReport;
use crate::arrange::Arrangement;
use crate::arrange::correspondence::Structure;
use crate::library::Library;
use crate::scene::{Method, Role, Scene};
use crate::statistics::{Overlap, Repetition};
use serde::Serialize;

/// Coverage wanted and got, and what was done for it. Shares are of the canvas, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Share of the canvas that primaries should cover: for one library without maps and domain,
    /// that of the exemplar.
    pub coverage_wanted: f64,
    /// Share of the canvas that primaries cover.
    pub coverage: f64,
    /// The same by category, library by library in their order.
    pub categories: Vec<CategoryReport>,
    /// The nested layers of the canvas, from bottom to top; empty if it has none.
    pub strata: Vec<StratumReport>,
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
    /// How primaries were placed.
    pub method: Method,
    /// What came along the field of correspondences, if there was one.
    pub structure: Option<Structure>,
    /// How much primaries hide of one another.
    pub overlap: Overlap,
    /// How often the same primaries come back.
    pub repetition: Repetition,
    /// Share of the places that repeat the exemplar's own period, if that was repeated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period: Option<f64>,
}

/// Coverage of one category.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CategoryReport {
    /// Share wanted of the canvas.
    pub wanted: f64,
    /// Share of the canvas that can be seen of it.
    pub got: f64,
}

impl Report {
    pub(crate) fn new(libraries: &[Library], arrangement: &Arrangement<'_>, scene: &Scene) -> Self {
        let Arrangement { cells: map, descriptors, correction, .. } = arrangement;
        let canvas = f64::from(scene.width) * f64::from(scene.height);
        let wanted = map.region.wanted(map.model());
        let wanted = |c: usize| wanted.iter().map(|zone| zone[c]).sum::<f64>() / canvas;
        let plain = libraries.len() == 1 && map.region.is_plain();
        let category = |(c, category): (usize, &crate::library::Category)| CategoryReport {
            // What cannot be placed is wanted too, where nothing but the exemplar says what is.
            wanted: if plain { category.coverage } else { wanted(c) },
            got: map.covered_by(c) as f64 / canvas,
        };
        let all = libraries.iter().flat_map(|l| &l.categories);
        let categories: Vec<CategoryReport> = all.enumerate().map(category).collect();
        let sum = |of: fn(&CategoryReport) -> f64| categories.iter().map(of).sum::<f64>();
        Self {
            strata: Vec::new(),
            coverage_wanted: if plain { libraries[0].coverage } else { sum(|c| c.wanted) },
            coverage: sum(|c| c.got),
            categories,
            primaries: scene.of_role(Role::Primary).count(),
            textons: scene.elements.iter().filter(|t| t.category.is_some()).count(),
            secondaries: scene.of_role(Role::Secondary).count(),
            control_points: scene.layers.iter().flat_map(|l| &l.field).map(|f| f.points.len()).sum(),
            attempts: descriptors.attempts,
            refused: descriptors.refused,
            removed: correction.removed,
            added: correction.added,
            method: scene.parameters.as_ref().map_or(Method::Descriptor, |p| p.method),
            structure: arrangement.structure,
            overlap: Overlap::of_scene(scene, libraries),
            repetition: Repetition::of_scene(scene, libraries),
            period: None,
        }
    }
}
