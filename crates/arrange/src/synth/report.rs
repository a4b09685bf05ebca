//! The report of a synthesis: how close a scene is to its exemplar.

use super::strata::StratumReport;
use crate::arrange::PlacementResult;
use crate::arrange::correspondence::Structure;
use serde::Serialize;
use vtex_scene::library::{Category, Library};
use vtex_scene::scene::{Method, Role, Scene};
use vtex_scene::statistics::{Overlap, Repetition};

/// Coverage wanted and reached, and the steps taken. Shares are of the canvas, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CategoryReport {
    /// Share wanted of the canvas.
    pub wanted: f64,
    /// Share of the canvas that its elements visibly cover.
    pub got: f64,
}

impl CategoryReport {
    /// The coverage of each category of a library, of which the exemplar's share is wanted.
    pub(super) fn of(library: &Library, got: impl IntoIterator<Item = f64>) -> Vec<Self> {
        let wanted = library.categories.iter().map(|c| c.coverage);
        wanted.zip(got).map(|(wanted, got)| Self { wanted, got }).collect()
    }
}

impl SynthReport {
    /// The report of any scene, given the coverage of its categories, without figures of placement.
    pub(super) fn of_scene(libraries: &[Library], scene: &Scene, categories: Vec<CategoryReport>) -> Self {
        // An empty sum of floats is -0; folding from 0 avoids it.
        let sum = |of: fn(&CategoryReport) -> f64| categories.iter().map(of).fold(0.0, |sum, v| sum + v);
        Self {
            coverage_wanted: sum(|c| c.wanted),
            coverage: sum(|c| c.got),
            categories,
            strata: Vec::new(),
            primaries: scene.of_role(Role::Primary).count(),
            textons: scene.elements.iter().filter(|e| e.category.is_some()).count(),
            secondaries: scene.of_role(Role::Secondary).count(),
            control_points: scene.layers.iter().flat_map(|l| &l.field).map(|f| f.points.len()).sum(),
            attempts: 0,
            refused: 0,
            removed: 0,
            added: 0,
            method: scene.parameters.as_ref().map_or(Method::Descriptor, |p| p.method),
            structure: None,
            overlap: Overlap::of_scene(scene, libraries),
            repetition: Repetition::of_scene(scene, libraries),
            period: None,
            clusters: None,
            curves: None,
        }
    }

    /// The report of a scene that was composed of an arrangement.
    pub(crate) fn of_arrangement(
        libraries: &[Library],
        arrangement: &PlacementResult<'_>,
        scene: &Scene,
    ) -> Self {
        let PlacementResult { cells: map, descriptors, correction, .. } = arrangement;
        let canvas = f64::from(scene.width) * f64::from(scene.height);
        let wanted = map.region.wanted(map.model());
        let wanted = |c: usize| wanted.iter().map(|zone| zone[c]).sum::<f64>() / canvas;
        let plain = libraries.len() == 1 && map.region.is_plain();
        let category = |(c, category): (usize, &Category)| CategoryReport {
            // If only the exemplar sets the target, elements that cannot be placed count too.
            wanted: if plain { category.coverage } else { wanted(c) },
            got: map.covered_by(c) as f64 / canvas,
        };
        let all = libraries.iter().flat_map(|l| &l.categories);
        let report = Self::of_scene(libraries, scene, all.enumerate().map(category).collect());
        Self {
            coverage_wanted: if plain { libraries[0].coverage } else { report.coverage_wanted },
            attempts: descriptors.attempts,
            refused: descriptors.refused,
            removed: correction.removed,
            added: correction.added,
            structure: arrangement.structure,
            ..report
        }
    }
}
