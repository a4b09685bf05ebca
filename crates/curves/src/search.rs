//! Search: for each sample of the result the sample of the exemplar with the most similar neighbourhood, by matching
//! that leaves outliers alone (equations 2.7 to 2.11).
//!
//! Candidates come from coherence (Ashikhmin 2001; Tong et al. 2002): where the sources of neighbours put this sample,
//! and samples of the exemplar with similar surroundings. All samples are searched at once from the sources before, so
//! the result does not depend on an order.

use crate::input::{CurveInput, MOST_NEAR_OUTPUT};
use crate::output::CurveOutput;
use vtex_base::error::Result;
use vtex_base::geometry::dense::{DenseAssignment, NONE};
use vtex_base::geometry::plane::{PointIndex, Vicinity};
use vtex_base::parallel;

/// Neighbours whose sources are asked, candidates taken from them, and similar samples tried for the best.
const ASKED: usize = 12;
const FROM_NEIGHBOURS: usize = 3;
const SIMILAR_TRIED: usize = 2;
/// Samples searched as one piece of work, and pieces between two questions whether to go on.
const PIECE: usize = 32;
const PIECES: usize = 16;

/// Neighbourhoods of the result, and the samples of the exemplar that they are matched with.
pub(crate) struct CurveMatches {
    pub(crate) near: Vicinity,
    /// For each listed neighbour its match, or [`NONE`].
    pub(crate) matched: Vec<u32>,
    /// Distance of each neighbourhood to its match.
    pub(crate) cost: Vec<f64>,
}

impl CurveMatches {
    /// Sum of the distances, for each neighbourhood and each sample in one.
    pub(crate) fn energy(&self) -> f64 {
        let samples = self.matched.len() + self.cost.len();
        self.cost.iter().sum::<f64>() / samples.max(1) as f64
    }

    /// The neighbourhood of a sample and its match: the sample itself, then its neighbours.
    pub(crate) fn pairs<'a>(
        &'a self,
        output: &'a CurveOutput,
        s: usize,
    ) -> impl Iterator<Item = (u32, u32)> + 'a {
        let others = self.near.range(s).map(|k| (self.near.ids[k], self.matched[k]));
        std::iter::once((s as u32, output.source[s])).chain(others.filter(|p| p.1 != NONE))
    }
}

/// What a sample costs that is left alone (c of §2.4.2).
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

impl CurveComparison<'_> {
    /// The distance of the neighbourhoods of `sample` and `source`, if it is less than `bound`; the matches of the
    /// neighbours are then in the assignment.
    pub(crate) fn distance(&mut self, sample: usize, source: u32, bound: f64) -> Option<f64> {
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
        let leave = 2.0 * delta;
        let missing =
            |c: usize| if c < inner { alone(input.ways[ids[c] as usize].len(), delta) } else { 0.0 };
        total += (0..inner).map(missing).sum::<f64>();
        // Rows cost the same alone, so the difference is added here and taken off the row's entries.
        let spare = |s: usize| leave - alone(ways[s].len(), delta);
        total -= own.clone().map(|k| spare(near.ids[k] as usize)).sum::<f64>();
        assignment.begin(ids.len(), leave);
        let mut least = 0.0;
        let reach = 4.0 * leave * leave;
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

    /// The best source of a sample, its distance, and the matches of the neighbours.
    fn best(&mut self, sample: usize) -> (u32, f64, Vec<u32>) {
        let mut candidates = self.candidates(sample);
        let mut best = (self.output.source[sample], f64::INFINITY, Vec::new());
        let (mut tried, mut extended) = (0, false);
        let size = self.input.scale.distance * (1 + self.near.range(sample).len()) as f64;
        while tried < candidates.len() {
            let source = candidates[tried];
            if let Some(found) = self.distance(sample, source, best.1) {
                let ids = &self.input.near.ids[self.input.near.range(source as usize)];
                let of = |c: &u32| if *c == NONE { NONE } else { ids[*c as usize] };
                best = (source, found, self.assignment.of_row().iter().map(of).collect());
            }
            tried += 1;
            // As good as a copy.
            if best.1 <= 0.01 * size {
                break;
            }
            if tried == candidates.len() && !extended && best.1 > 0.05 * size {
                extended = true;
                for &similar in self.input.similar(best.0).iter().take(SIMILAR_TRIED) {
                    if !candidates.contains(&similar) {
                        candidates.push(similar);
                    }
                }
            }
        }
        if best.2.len() != self.near.range(sample).len() {
            best.2 = vec![NONE; self.near.range(sample).len()];
        }
        best
    }

    /// The source so far, and where the sources of neighbours put the sample.
    fn candidates(&self, sample: usize) -> Vec<u32> {
        let (input, output) = (self.input, self.output);
        let mut votes: Vec<(u32, u32)> = Vec::new();
        for k in self.near.range(sample).take(ASKED) {
            let from = input.graph.points[output.source[self.near.ids[k] as usize] as usize];
            let way = self.near.ways[k];
            let at = [from[0] - way[0], from[1] - way[1]];
            if let Some((found, _)) = input.index.nearest(at, 0.75 * input.scale.distance) {
                match votes.iter_mut().find(|v| v.1 == found as u32) {
                    Some(vote) => vote.0 += 1,
                    None => votes.push((1, found as u32)),
                }
            }
        }
        votes.sort_by_key(|&(count, id)| (std::cmp::Reverse(count), id));
        let own = output.source[sample];
        let mut all = vec![own];
        all.extend(votes.iter().map(|v| v.1).filter(|v| *v != own).take(FROM_NEIGHBOURS));
        all
    }
}

/// Searches all samples. `go_on` is asked in between.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn search(
    output: &mut CurveOutput,
    input: &CurveInput,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<CurveMatches> {
    let radius = input.scale.radius;
    let index = PointIndex::new(output.plane, radius, &output.points);
    let near = Vicinity::new(&index, &output.points, radius, (MOST_NEAR_OUTPUT, true));
    let ways = output.ways();
    go_on()?;
    let pieces: Vec<usize> = (0..output.len()).step_by(PIECE).collect();
    let (mut sources, mut cost) = (Vec::with_capacity(output.len()), Vec::with_capacity(output.len()));
    let mut matched = Vec::with_capacity(near.ids.len());
    for pieces in pieces.chunks(PIECES) {
        let of_piece = |&first: &usize| {
            let assignment = DenseAssignment::default();
            let mut comparison = CurveComparison { input, output, ways: &ways, near: &near, assignment };
            (first..(first + PIECE).min(output.len())).map(|s| comparison.best(s)).collect::<Vec<_>>()
        };
        for (source, distance, of) in parallel::map(pieces, of_piece).into_iter().flatten() {
            sources.push(source);
            cost.push(distance);
            matched.extend(of);
        }
        go_on()?;
    }
    output.source = sources;
    Ok(CurveMatches { near, matched, cost })
}
