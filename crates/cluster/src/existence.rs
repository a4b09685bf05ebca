//! Existence of samples: those that most neighbourhoods miss are added (algorithm 1 of *Continuous Curve Textures*).
//! None is removed: elements of too few samples are dropped when they are reconstructed.

use crate::input::InputSamples;
use crate::output::OutputSamples;
use crate::search::Matches;
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::{PointIndex, length};

/// Share of the neighbourhoods around a place that must miss a sample there.
const MAJORITY: f64 = 0.5;

/// A sample that one neighbourhood misses.
struct Missing {
    at: [f64; 2],
    source: u32,
    /// The cluster that the neighbourhood would put it in, or [`NONE`].
    cluster: u32,
}

/// Adds the samples that most neighbourhoods miss, and returns how many.
pub(crate) fn add_missing(output: &mut OutputSamples, input: &InputSamples, matches: &Matches) -> usize {
    let delta = input.scale.distance;
    let rim = input.scale.radius - 0.5 * delta;
    let all: Vec<usize> = (0..matches.near.len()).collect();
    let missing: Vec<Missing> =
        vtex_base::parallel::map(&all, |&s| of_neighbourhood(output, input, matches, (s, rim)))
            .into_iter()
            .flatten()
            .collect();
    if missing.is_empty() {
        return 0;
    }
    let places: Vec<[f64; 2]> = missing.iter().map(|m| m.at).collect();
    let index = PointIndex::new(output.plane, 0.5 * delta, &places);
    let standing = PointIndex::new(output.plane, rim, &output.points);
    let alike = |a: u32, b: u32| input.colour_cost(a, b) == 0.0;
    let together = |m: usize| {
        let mut group = Vec::new();
        index.within(places[m], 0.5 * delta, |k, way| {
            if alike(missing[k].source, missing[m].source) {
                group.push((k, way));
            }
        });
        group.sort_by_key(|g| g.0);
        group
    };
    let counted: Vec<usize> = (0..missing.len()).collect();
    let counts = vtex_base::parallel::map(&counted, |&m| together(m).len());
    let mut order = counted;
    order.sort_by_key(|&m| (std::cmp::Reverse(counts[m]), m));
    let mut taken = vec![false; missing.len()];
    let mut added: Vec<(u32, [f64; 2], u32)> = Vec::new();
    for m in order {
        if taken[m] {
            continue;
        }
        let group = together(m);
        group.iter().for_each(|g| taken[g.0] = true);
        let (mut around, mut occupied) = (0u32, false);
        standing.within(places[m], rim, |s, way| {
            around += 1;
            occupied |= length(way) < 0.5 * delta && alike(output.copied[s], missing[m].source);
        });
        let close = |(source, at, _): &(u32, [f64; 2], u32)| {
            alike(*source, missing[m].source) && length(output.plane.between(*at, places[m])) < 0.7 * delta
        };
        if occupied || (group.len() as f64) <= MAJORITY * f64::from(around) || added.iter().any(close) {
            continue;
        }
        let part = 1.0 / group.len() as f64;
        let off = group.iter().fold([0.0; 2], |sum, (_, w)| [sum[0] + part * w[0], sum[1] + part * w[1]]);
        let at = output.plane.wrapped([places[m][0] + off[0], places[m][1] + off[1]]);
        let cluster = commonest(group.iter().map(|g| missing[g.0].cluster).filter(|c| *c != NONE));
        added.push((missing[m].source, at, cluster.unwrap_or(NONE)));
    }
    // Samples of no cluster that belong to one element of the exemplar, moved alike, make a new one.
    let mut new: Vec<(u32, [f64; 2], u32)> = Vec::new();
    for (source, at, cluster) in &added {
        let mut cluster = *cluster;
        if cluster == NONE {
            let place = input.place[*source as usize];
            let from = input.points[*source as usize];
            let by = [at[0] - from[0], at[1] - from[1]];
            let same =
                |n: &&(u32, [f64; 2], u32)| n.0 == place && length(output.plane.between(n.1, by)) < delta;
            cluster = new.iter().find(same).map_or(output.clusters, |n| n.2);
            if cluster == output.clusters {
                output.clusters += 1;
                new.push((place, by, cluster));
            }
        }
        output.points.push(*at);
        output.source.push(*source);
        output.copied.push(*source);
        output.cluster.push(cluster);
    }
    added.len()
}

/// The samples that one neighbourhood misses.
fn of_neighbourhood(
    output: &OutputSamples,
    input: &InputSamples,
    matches: &Matches,
    (s, rim): (usize, f64),
) -> Vec<Missing> {
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
        found.push(Missing { at: [centre[0] + way[0], centre[1] + way[1]], source: i, cluster });
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
