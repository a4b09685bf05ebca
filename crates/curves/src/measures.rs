//! Measures of graphs of curves.

use crate::graph::{CurveEdge, CurveGraph};
use vtex_base::geometry::plane::along;

/// Highest number of ends at a node that is told apart.
const MOST_ENDS: usize = 7;

/// Measures of the curves of a page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurveMeasures {
    /// Sum of the lengths of all curves, in the unit of the page.
    pub length: f64,
    /// Ends that meet no other curve, without those at the border of the page.
    pub ends: usize,
    /// Shares of the nodes at which 0, 1, … curves end; the last stands for 7 and more. Nodes stand about every sample
    /// distance along curves.
    pub degrees: [f64; MOST_ENDS + 1],
}

impl CurveMeasures {
    /// The measures of a graph.
    pub(crate) fn of(graph: &CurveGraph) -> Self {
        Self::of_part(graph, |_| true)
    }

    /// The measures of the nodes of a graph that are in a part of the page, and of the edges that begin there.
    pub(crate) fn of_part(graph: &CurveGraph, is_in: impl Fn([f64; 2]) -> bool) -> Self {
        let mut degrees = [0.0; MOST_ENDS + 1];
        let inner = (0..graph.points.len()).filter(|n| !graph.open[*n] && is_in(graph.points[*n]));
        let (mut ends, mut count) = (0, 0.0f64);
        for n in inner {
            let degree = graph.degree(n);
            ends += usize::from(degree == 1);
            degrees[degree.min(MOST_ENDS)] += 1.0;
            count += 1.0;
        }
        degrees.iter_mut().for_each(|d| *d /= count.max(1.0));
        let begins = |e: &&CurveEdge| is_in(graph.points[e.ends[0] as usize]);
        let length = graph.edges.iter().filter(begins).map(|e| along(&e.shape)).sum();
        Self { length, ends, degrees }
    }

    /// Ends for each unit of length.
    pub fn end_density(&self) -> f64 {
        if self.length > 0.0 { self.ends as f64 / self.length } else { 0.0 }
    }

    /// Total variation between the numbers of curves at nodes of two pages, 0 to 1.
    pub fn degree_variation(&self, other: &Self) -> f64 {
        0.5 * self.degrees.iter().zip(&other.degrees).map(|(a, b)| (a - b).abs()).sum::<f64>()
    }
}
