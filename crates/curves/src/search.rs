//! Search: for each sample of the result the sample of the exemplar with the most similar neighbourhood, by matching
//! that leaves outliers alone (equations 2.7 to 2.11).

use crate::input::{CurveInput, MOST_NEAR_OUTPUT};
use crate::output::CurveOutput;
use vtex_base::error::Result;
use vtex_base::geometry::coherence::{self, CompareNeighbourhoods, NeighbourhoodMatches};
use vtex_base::geometry::dense::{DenseAssignment, NONE};
use vtex_base::geometry::plane::{PointIndex, Vicinity};
use vtex_base::parallel;

/// What a sample costs that has no match though every one should, in sample distances: more than any match.
const FORCED: f64 = 100.0;
/// Longest distance of matched samples beside given lines, in sample distances.
const BESIDE_GIVEN: f64 = 1.2;
/// Samples between two questions whether to go on.
const AT_ONCE: usize = 256;
/// Neighbours whose sources are asked.
const ASKED: usize = 12;

/// The neighbourhood of a sample and its match: the sample itself, then its neighbours.
pub(crate) fn matched_pairs<'a>(
    matches: &'a NeighbourhoodMatches,
    output: &'a CurveOutput,
    s: usize,
) -> impl Iterator<Item = (u32, u32)> + 'a {
    let others = matches.near.range(s).map(|k| (matches.near.ids[k], matches.matched[k]));
    std::iter::once((s as u32, output.source[s])).chain(others.filter(|p| p.1 != NONE))
}

/// What a sample costs that is left alone (c of §2.4.2.3).
pub(crate) fn alone(edges: usize, delta: f64) -> f64 {
    (1.2 + 0.4 * edges as f64).min(2.0) * delta
}

/// One comparison of neighbourhoods, with its work space.
pub(crate) struct CurveComparison<'a> {
    pub(crate) input: &'a CurveInput,
    pub(crate) output: &'a CurveOutput,
    pub(crate) ways: &'a [Vec<[f64; 2]>],
    pub(crate) near: &'a Vicinity,
    pub(crate) assignment: DenseAssignment,
}

impl CompareNeighbourhoods for CurveComparison<'_> {
    fn distance(&mut self, sample: usize, source: u32, bound: f64) -> Option<f64> {
        let Self { input, output, ways, near, assignment } = self;
        let delta = input.scale.distance;
        let own = near.range(sample);
        let columns = input.near.range(source as usize);
        let mut total = input.unlike((&ways[sample], output.style[sample]), source);
        // Samples of the exemplar that the neighbourhood should have, but for those at its rim.
        let rim = input.scale.radius - 0.5 * delta;
        let (ids, offsets) = (&input.near.ids[columns.clone()], &input.near.ways[columns]);
        let inner = offsets.partition_point(|w| w[0] * w[0] + w[1] * w[1] < rim * rim);
        let inner = if own.len() < MOST_NEAR_OUTPUT { inner } else { 0 };
        let leave = if input.is_robust { 2.0 * delta } else { FORCED * delta };
        let missing =
            |c: usize| if c < inner { alone(input.ways[ids[c] as usize].len(), delta) } else { 0.0 };
        total += (0..inner).map(missing).sum::<f64>();
        // Rows cost the same alone, so the difference is added here and taken off the row's entries. A given sample is no
        // outlier, unless a line was cut there: that is one sample too many on the line that goes on.
        let spare = |s: usize| match input.is_robust {
            true if s < output.given() && output.ahead(s as u32).is_none() => leave - FORCED * delta,
            true => leave - alone(ways[s].len(), delta),
            false => 0.0,
        };
        total -= own.clone().map(|k| spare(near.ids[k] as usize)).sum::<f64>();
        assignment.begin(ids.len(), leave);
        let mut least = 0.0;
        // Beside given lines something may be missing for good, which nothing far away should stand for.
        let farthest = if output.given() > 0 { BESIDE_GIVEN * delta } else { 2.0 * leave };
        let reach = farthest * farthest;
        for k in own {
            let (way, other) = (near.ways[k], near.ids[k] as usize);
            let (of, spare) = ((&ways[other][..], output.style[other]), spare(other));
            least = assignment.row(ids.iter().zip(offsets).enumerate().map(|(c, (&i, w))| {
                let (x, y) = (way[0] - w[0], way[1] - w[1]);
                let far = x * x + y * y;
                if far > reach {
                    return f64::INFINITY;
                }
                libm::sqrt(far) + input.unlike(of, i) + spare - missing(c)
            }));
        }
        if total + least >= bound {
            return None;
        }
        total += assignment.solve();
        (total < bound).then_some(total)
    }

    fn assignment(&self) -> &DenseAssignment {
        &self.assignment
    }

    fn similar(&self, source: u32) -> &[u32] {
        self.input.similar(source)
    }

    fn compared(&self, sample: usize) -> usize {
        1 + self.near.range(sample).len()
    }
}

/// The samples around each sample.
fn neighbourhoods(output: &CurveOutput, input: &CurveInput) -> Vicinity {
    let radius = input.scale.radius;
    let index = PointIndex::new(output.plane, radius, &output.points);
    Vicinity::new(&index, &output.points, radius, (MOST_NEAR_OUTPUT, true))
}

/// Searches all samples. `go_on` is asked in between.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn search(
    output: &mut CurveOutput,
    input: &CurveInput,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<NeighbourhoodMatches> {
    let near = neighbourhoods(output, input);
    let ways = output.ways();
    go_on()?;
    let compare = || {
        let assignment = DenseAssignment::default();
        CurveComparison { input, output, ways: &ways, near: &near, assignment }
    };
    let found = coherence::search(input.sources(), &near, (&output.source, ASKED), compare, go_on)?;
    output.source = found.source;
    Ok(NeighbourhoodMatches { near, matched: found.matched, cost: found.cost })
}

/// Lets each sample have that of its candidates whose neighbourhood is most similar. `go_on` is asked in between.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn choose_sources(
    output: &mut CurveOutput,
    input: &CurveInput,
    candidates: &[Vec<u32>],
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let near = neighbourhoods(output, input);
    let ways = output.ways();
    let samples: Vec<usize> = (0..output.len()).collect();
    let mut chosen = Vec::with_capacity(samples.len());
    for part in samples.chunks(AT_ONCE) {
        go_on()?;
        chosen.extend(parallel::map(part, |s| {
            let assignment = DenseAssignment::default();
            let mut compare = CurveComparison { input, output, ways: &ways, near: &near, assignment };
            let mut best = (output.source[*s], f64::INFINITY);
            for source in &candidates[*s] {
                if let Some(cost) = compare.distance(*s, *source, best.1) {
                    best = (*source, cost);
                }
            }
            best.0
        }));
    }
    output.source = chosen;
    Ok(())
}
