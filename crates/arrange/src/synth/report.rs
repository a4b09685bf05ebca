//! The report of a synthesis: how close a scene is to its exemplar.

use super::strata::StratumReport;
use crate::arrange::correspondence::Structure;
use crate::arrange::{PlacementResult, Plan};
use serde::Serialize;
use vtex_scene::library::{Category, Library};
use vtex_scene::scene::{Method, Role, Scene};
use vtex_scene::statistics::{Overlap, Repetition};

/// Coverage wanted and reached, and the steps taken. Shares are of the canvas, 0 to 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SynthReport {
    /// Share of the canvas that primaries should cover. For one library without maps and domain it is the
    /// exemplar's.
    pub coverage_wanted: f64,
    /// Share of the canvas that primaries cover.
    pub coverage: f64,
    /// Coverage by category, library by library in their order.
    pub categories: Vec<CategoryReport>,
    /// The nested layers of the canvas, from bottom to top; empty if it has none.
    pub strata: Vec<StratumReport>,
    /// Primaries placed.
    pub primaries: usize,
    /// Different primaries among them.
    pub textons: usize,
    /// Secondaries placed.
    pub secondaries: usize,
    /// Control points of the background.
    pub control_points: usize,
    /// Requests of descriptors tried.
    pub attempts: u64,
    /// Requests that no element fitted well enough.
    pub refused: u64,
    /// Elements removed to correct the density.
    pub removed: u64,
    /// Elements added to correct the density.
    pub added: u64,
    /// The method that placed the primaries.
    pub method: Method,
    /// Measures of the correspondence field, if there is one.
    pub structure: Option<Structure>,
    /// Area of primaries hidden by others.
    pub overlap: Overlap,
    /// Repetition of the same primaries.
    pub repetition: Repetition,
    /// Share of the places that repeat the exemplar's own period, if the period was repeated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period: Option<f64>,
    /// What the optimisation of clustered samples did, if it arranged the elements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clusters: Option<ClusterReport>,
    /// What the synthesis of curves did, if it made the lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curves: Option<CurveReport>,
}

/// Counts and measures of the synthesis of curves.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CurveReport {
    /// Samples on the finest level that was optimised; 0 for a canvas too large for that.
    pub samples: usize,
    /// Iterations over all levels.
    pub iterations: usize,
    /// Energy of each iteration for each sample of a neighbourhood, level by level.
    pub energies: Vec<Vec<f64>>,
    /// Paths of the result.
    pub paths: usize,
    /// Pairs of loose ends joined.
    pub joined: usize,
    /// Loose ends led to a line beside them.
    pub attached: usize,
    /// Samples of loose branches taken away.
    pub removed: usize,
    /// Ends of lines for each thousand units of length, of the exemplar and of the result.
    pub ends: [f64; 2],
    /// Total variation between the numbers of lines that meet at nodes, of the exemplar and of the result, 0 to 1.
    pub degree_variation: f64,
    /// Beside a drawing that stands: its ends that lead into the region, and how many of them are continued.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continued: Option<[usize; 2]>,
}

/// Counts of the optimisation of clustered samples, over all levels.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ClusterReport {
    /// Samples on the finest level.
    pub samples: usize,
    /// Iterations.
    pub iterations: usize,
    /// Energy of each iteration for each sample of a neighbourhood, level by level.
    pub energies: Vec<Vec<f64>>,
    /// Samples that changed their cluster.
    pub switched: usize,
    /// Clusters merged.
    pub merged: usize,
    /// Clusters split.
    pub split: usize,
    /// Elements moved away from others.
    pub moved: usize,
    /// Clusters and elements removed.
    pub removed: usize,
    /// Elements added in gaps.
    pub added: usize,
    /// Elements that took the place of those of another category.
    pub exchanged: usize,
    /// Beside a drawing that stands, how many of its elements are the library's, and how many there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recognised: Option<[usize; 2]>,
}

/// Coverage of one category.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CategoryReport {
    /// Share wanted of the canvas.
    pub wanted: f64,
    /// Share of the canvas that its elements visibly cover.
    pub got: f64,
}

impl SynthReport {
    /// What is to be said of a drawing before it is composed: `share` of what the exemplar covers is wanted, and the
    /// categories cover `got`; nothing yet where it is counted in the scene.
    pub(super) fn of_drawing(library: &Library, share: f64, got: Option<Vec<f64>>) -> Self {
        let mut got = got.unwrap_or_default().into_iter();
        let category =
            |c: &Category| CategoryReport { wanted: share * c.coverage, got: got.next().unwrap_or(0.0) };
        let categories = library.categories.iter().map(category).collect();
        Self { coverage_wanted: share * library.coverage, categories, ..Self::default() }
    }

    /// The report where `share` of what was wanted is.
    pub(super) fn wanted_times(&mut self, share: f64) {
        self.coverage_wanted *= share;
        self.categories.iter_mut().for_each(|category| category.wanted *= share);
    }

    /// What is to be said of elements placed one by one, before they are composed.
    pub(crate) fn of_arrangement(plan: &Plan<'_>, arrangement: &PlacementResult<'_>) -> Self {
        let PlacementResult { cells: map, descriptors, correction, .. } = arrangement;
        let canvas = f64::from(plan.params.width) * f64::from(plan.params.height);
        let wanted = map.region.wanted(map.model());
        let wanted = |c: usize| wanted.iter().map(|zone| zone[c]).sum::<f64>() / canvas;
        let plain = plan.libraries.len() == 1 && map.region.is_plain();
        let category = |(c, category): (usize, &Category)| CategoryReport {
            // If only the exemplar sets the target, elements that cannot be placed count too.
            wanted: if plain { category.coverage } else { wanted(c) },
            got: map.covered_by(c) as f64 / canvas,
        };
        let all = plan.libraries.iter().flat_map(|l| &l.categories);
        let categories: Vec<CategoryReport> = all.enumerate().map(category).collect();
        Self {
            coverage_wanted: if plain { plan.libraries[0].coverage } else { sum(&categories, |c| c.wanted) },
            categories,
            attempts: descriptors.attempts,
            refused: descriptors.refused,
            removed: correction.removed,
            added: correction.added,
            structure: arrangement.structure,
            ..Self::default()
        }
    }

    /// The report with what its scene shows.
    pub(super) fn of_scene(self, libraries: &[Library], scene: &Scene) -> Self {
        Self {
            coverage: sum(&self.categories, |c| c.got),
            primaries: scene.of_role(Role::Primary).count(),
            textons: scene.elements.iter().filter(|e| e.category.is_some()).count(),
            secondaries: scene.of_role(Role::Secondary).count(),
            control_points: scene.layers.iter().flat_map(|l| &l.field).map(|f| f.points.len()).sum(),
            method: scene.parameters.as_ref().map_or(Method::Descriptor, |p| p.method),
            overlap: Overlap::of_scene(scene, libraries),
            repetition: Repetition::of_scene(scene, libraries),
            ..self
        }
    }
}

/// A sum over categories. An empty sum of floats is -0; folding from 0 avoids it.
fn sum(categories: &[CategoryReport], of: fn(&CategoryReport) -> f64) -> f64 {
    categories.iter().map(of).fold(0.0, |sum, v| sum + v)
}
