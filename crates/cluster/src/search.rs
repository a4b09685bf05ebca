//! Search: for each sample of the result the sample of the exemplar with the most similar neighbourhood.

use crate::input::{InputSamples, MOST_NEAR_OUTPUT};
use crate::output::{ContextCosts, ContextRow, OutputSamples};
use vtex_base::error::Result;
use vtex_base::geometry::coherence::{self, CompareNeighbourhoods, NeighbourhoodMatches};
use vtex_base::geometry::dense::DenseAssignment;
use vtex_base::geometry::plane::{PointIndex, Vicinity, length};

/// Neighbours whose sources are asked.
const ASKED: usize = 10;

/// One comparison of neighbourhoods, with its work space.
struct Comparison<'a> {
    input: &'a InputSamples,
    output: &'a OutputSamples,
    costs: &'a ContextCosts<'a>,
    near: &'a Vicinity,
    assignment: DenseAssignment,
}

impl CompareNeighbourhoods for Comparison<'_> {
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

    fn assignment(&self) -> &DenseAssignment {
        &self.assignment
    }

    fn similar(&self, source: u32) -> &[u32] {
        self.input.similar(source)
    }

    fn compared(&self, sample: usize) -> usize {
        self.near.range(sample).len()
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
) -> Result<NeighbourhoodMatches> {
    let radius = input.scale.radius;
    let index = PointIndex::new(output.plane, radius, &output.points);
    let near = Vicinity::new(&index, &output.points, radius, (MOST_NEAR_OUTPUT, true));
    go_on()?;
    let costs = ContextCosts::new(output, input, go_on)?;
    go_on()?;
    let compare = || {
        let assignment = DenseAssignment::default();
        Comparison { input, output, costs: &costs, near: &near, assignment }
    };
    let found = coherence::search(input.sources(), &near, (&output.source, ASKED), compare, go_on)?;
    output.source = found.source;
    Ok(NeighbourhoodMatches { near, matched: found.matched, cost: found.cost })
}
