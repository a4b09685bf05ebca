//! Search: for each sample of the result the sample of the exemplar with the most similar neighbourhood.
//!
//! Candidates come from coherence (Ashikhmin 2001; Tong et al. 2002): where the sources of neighbours put this
//! sample, and samples of the exemplar with neighbourhoods similar to that. All samples are searched at once from
//! the sources before, so the result does not depend on an order.

use crate::input::{InputSamples, MOST_NEAR_OUTPUT};
use crate::output::{ContextCosts, ContextRow, OutputSamples};
use vtex_base::error::Result;
use vtex_base::geometry::dense::{DenseAssignment, NONE};
use vtex_base::geometry::plane::{PointIndex, Vicinity, length};
use vtex_base::parallel;

/// Neighbours whose sources are asked.
const ASKED: usize = 10;
/// Candidates from neighbours, and similar samples tried for the best of them.
const FROM_NEIGHBOURS: usize = 3;
const SIMILAR_TRIED: usize = 2;
/// Samples searched as one piece of work.
const PIECE: usize = 64;
/// Pieces between two questions whether to go on.
const PIECES: usize = 16;

/// Neighbourhoods of the result, and the samples of the exemplar that they are matched with.
pub(crate) struct Matches {
    pub(crate) near: Vicinity,
    /// For each listed neighbour its match, or [`NONE`].
    pub(crate) matched: Vec<u32>,
    /// Distance of each neighbourhood to its match.
    pub(crate) cost: Vec<f64>,
}

impl Matches {
    /// Sum of the distances, for each neighbourhood and each sample in one.
    pub(crate) fn energy(&self) -> f64 {
        let samples = self.matched.len() + self.cost.len();
        self.cost.iter().sum::<f64>() / samples.max(1) as f64
    }
}

/// One comparison of neighbourhoods, with its work space.
struct Comparison<'a> {
    input: &'a InputSamples,
    output: &'a OutputSamples,
    costs: &'a ContextCosts<'a>,
    near: &'a Vicinity,
    assignment: DenseAssignment,
}

impl Comparison<'_> {
    /// The distance of the neighbourhoods of `sample` and `source`, if it is less than `bound`; the matches of the
    /// neighbours are then in the assignment.
    fn distance(&mut self, sample: usize, source: u32, bound: f64) -> Option<f64> {
        let Self { input, output, costs, near, assignment } = self;
        let delta = input.scale.distance;
        let own = near.range(sample);
        let columns = input.near.range(source as usize);
        let context = |of: ContextRow<'_>, i: u32| of.cost(input.context[i as usize]);
        let mut total = context(costs.of(sample), source) + input.colour_cost(output.copied[sample], source);
        // Samples of the exemplar that the neighbourhood should have, but for those at its rim.
        let reach = if own.len() < MOST_NEAR_OUTPUT {
            input.scale.radius
        } else {
            length(near.ways[own.end - 1]).min(input.scale.radius)
        };
        let rim = reach - 0.5 * delta;
        let (ids, ways) = (&input.near.ids[columns.clone()], &input.near.ways[columns]);
        let inner = ways.partition_point(|w| w[0] * w[0] + w[1] * w[1] < rim * rim);
        let alone = 2.0 * delta;
        total += alone * inner as f64;
        if total - alone * (inner.min(own.len()) as f64) >= bound {
            return None;
        }
        assignment.begin(ids.len(), alone);
        let mut least = 0.0;
        for k in own {
            let (way, other) = (near.ways[k], near.ids[k] as usize);
            let (of, colour) = (costs.of(other), output.copied[other]);
            least = assignment.row(ids.iter().zip(ways).enumerate().map(|(c, (&i, w))| {
                let (x, y) = (way[0] - w[0], way[1] - w[1]);
                let far = x * x + y * y;
                if far > 4.0 * alone * alone {
                    return f64::INFINITY;
                }
                let cost = libm::sqrt(far) + context(of, i) + input.colour_cost(colour, i);
                if c < inner { cost - alone } else { cost }
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
        while tried < candidates.len() {
            let source = candidates[tried];
            if let Some(found) = self.distance(sample, source, best.1) {
                let columns = self.input.near.range(source as usize);
                let ids = &self.input.near.ids[columns];
                let of = |c: &u32| if *c == NONE { NONE } else { ids[*c as usize] };
                best = (source, found, self.assignment.of_row().iter().map(of).collect());
            }
            tried += 1;
            // As good as a copy.
            if best.1 <= 0.01 * self.input.scale.distance * self.near.range(sample).len() as f64 {
                break;
            }
            let good = 0.05 * self.input.scale.distance * self.near.range(sample).len() as f64;
            if tried == candidates.len() && !extended && best.1 > good {
                extended = true;
                for &similar in &self.input.similar(best.0)[..SIMILAR_TRIED] {
                    if !candidates.contains(&similar) {
                        candidates.push(similar);
                    }
                }
            }
        }
        best
    }

    /// The source so far, and where the sources of neighbours put the sample.
    fn candidates(&self, sample: usize) -> Vec<u32> {
        let (input, output) = (self.input, self.output);
        let mut votes: Vec<(u32, u32)> = Vec::new();
        for k in self.near.range(sample).take(ASKED) {
            let from = input.points[output.source[self.near.ids[k] as usize] as usize];
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
    output: &mut OutputSamples,
    input: &InputSamples,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Matches> {
    let radius = input.scale.radius;
    let index = PointIndex::new(output.plane, radius, &output.points);
    let near = Vicinity::new(&index, &output.points, radius, (MOST_NEAR_OUTPUT, true));
    go_on()?;
    let costs = ContextCosts::new(output, input, go_on)?;
    go_on()?;
    let pieces: Vec<usize> = (0..output.len()).step_by(PIECE).collect();
    let (mut sources, mut cost) = (Vec::with_capacity(output.len()), Vec::with_capacity(output.len()));
    let mut matched = Vec::with_capacity(near.ids.len());
    for pieces in pieces.chunks(PIECES) {
        let of_piece = |&first: &usize| {
            let assignment = DenseAssignment::default();
            let mut comparison = Comparison { input, output, costs: &costs, near: &near, assignment };
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
    Ok(Matches { near, matched, cost })
}
