//! Existence of samples: those that most neighbourhoods miss are added (algorithm 1 of *Continuous Curve Textures*).
//! None is removed: elements of too few samples are dropped when they are reconstructed.

use crate::input::InputSamples;
use crate::output::OutputSamples;
use crate::standing::StandingElements;
use vtex_base::geometry::coherence::{MissedGroup, MissedPoint, NeighbourhoodMatches, StandingPoints};
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::length;
use vtex_base::parallel;

/// A sample that one neighbourhood misses, and the cluster that it would put it in, or [`NONE`].
type MissedSample = (MissedPoint, u32);

/// Adds the samples that most neighbourhoods miss, and returns how many. None is added to an element that stands, or where
/// nothing is made beside `standing` ones.
pub(crate) fn add_missing(
    output: &mut OutputSamples,
    input: &InputSamples,
    matches: &NeighbourhoodMatches,
    standing: Option<&StandingElements>,
) -> usize {
    let distance = input.scale.distance;
    let rim = input.scale.radius - 0.5 * distance;
    let all: Vec<usize> = (0..matches.near.len()).collect();
    let found = parallel::map(&all, |&s| of_neighbourhood(output, input, matches, (s, rim)));
    let (missed, clusters): (Vec<MissedPoint>, Vec<u32>) = found.into_iter().flatten().unzip();
    let present = StandingPoints {
        plane: output.plane,
        points: &output.points,
        alike: |a: u32, b: u32| input.colour_cost(a, b) == 0.0,
        is_of_kind: |s: usize, source: u32| input.colour_cost(output.copied[s], source) == 0.0,
    };
    let groups = present.missed(&missed, distance, rim);
    // Samples of no cluster that belong to one element of the exemplar, moved alike, make a new one.
    let mut new: Vec<(u32, [f64; 2], u32)> = Vec::new();
    let before = output.len();
    for MissedGroup { at, source, members } in &groups {
        let at = output.plane.wrapped(*at);
        let known = commonest(members.iter().map(|&m| clusters[m]).filter(|c| *c != NONE));
        if known.is_some_and(|c| (c as usize) < output.given[1]) || standing.is_some_and(|s| !s.is_free(at)) {
            continue;
        }
        let mut cluster = known.unwrap_or(NONE);
        if cluster == NONE {
            let place = input.place[*source as usize];
            let from = input.points[*source as usize];
            let by = [at[0] - from[0], at[1] - from[1]];
            let same =
                |n: &&(u32, [f64; 2], u32)| n.0 == place && length(output.plane.between(n.1, by)) < distance;
            cluster = new.iter().find(same).map_or(output.clusters, |n| n.2);
            if cluster == output.clusters {
                output.clusters += 1;
                new.push((place, by, cluster));
            }
        }
        output.points.push(at);
        output.source.push(*source);
        output.copied.push(*source);
        output.cluster.push(cluster);
    }
    output.len() - before
}

/// The samples that one neighbourhood misses.
fn of_neighbourhood(
    output: &OutputSamples,
    input: &InputSamples,
    matches: &NeighbourhoodMatches,
    (s, rim): (usize, f64),
) -> Vec<MissedSample> {
    let own = matches.near.range(s);
    let source = output.source[s];
    let (mut found, centre) = (Vec::new(), output.points[s]);
    for k in input.near.range(source as usize) {
        let (i, way) = (input.near.ids[k], input.near.ways[k]);
        if length(way) >= rim || matches.matched[own.clone()].contains(&i) {
            continue;
        }
        let place = input.place[i as usize];
        let beside = own
            .clone()
            .find(|&k| matches.matched[k] != NONE && input.place[matches.matched[k] as usize] == place);
        let cluster = if input.place[source as usize] == place {
            output.cluster[s]
        } else {
            beside.map_or(NONE, |k| output.cluster[matches.near.ids[k] as usize])
        };
        found.push((MissedPoint { at: [centre[0] + way[0], centre[1] + way[1]], source: i }, cluster));
    }
    found
}

/// The commonest of some numbers; of equally common ones the least.
fn commonest(numbers: impl Iterator<Item = u32>) -> Option<u32> {
    let mut all: Vec<u32> = numbers.collect();
    all.sort_unstable();
    let runs = all.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| (run.len(), std::cmp::Reverse(run[0]))).map(|run| run[0])
}
