//! Edges by vote: every neighbourhood that holds two samples says whether their matches are joined (equation 2.16), and
//! the samples how many edges they want (equation 2.17). Edges are then chosen one by one (equations 2.18 to 2.21).

use crate::input::CurveInput;
use crate::output::{CurveOutput, JoinedEdge};
use crate::search::matched_pairs;
use vtex_base::geometry::coherence::NeighbourhoodMatches;
use vtex_base::geometry::plane::length;
use vtex_base::parallel;

/// Longest edge, in sample distances.
const LONGEST: f64 = 2.0;

/// A pair of samples that may be joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeVote {
    pub(crate) ends: [u32; 2],
    /// Share of the neighbourhoods whose matches are joined.
    pub(crate) confidence: f64,
}

/// Joins samples anew by the votes of the matched neighbourhoods. Given edges stay; given samples are joined with one
/// another only where curves go on from both.
pub(crate) fn improve_edges(output: &mut CurveOutput, input: &CurveInput, matches: &NeighbourhoodMatches) {
    let all: Vec<usize> = (0..matches.near.len()).collect();
    let longest = LONGEST * input.scale.distance;
    let between_ends = output.edges[..output.given_edges].iter().map(|e| e.ends);
    let between_ends: Vec<[u32; 2]> =
        between_ends.filter(|ends| ends.iter().all(|s| output.ahead(*s).is_some())).collect();
    // Whether two samples are given, and no curves go on from both to one another.
    let is_fixed = |a: u32, b: u32| {
        let given = |s: u32| (s as usize) < output.given();
        let apart = output.ahead(a).is_none() || output.ahead(b).is_none();
        given(a) && given(b) && (apart || between_ends.iter().any(|e| e.contains(&a) && e.contains(&b)))
    };
    // For each pair the edge of the exemplar between the matches, or none.
    let ballots = parallel::map(&all, |&s| {
        let pairs: Vec<(u32, u32)> = matched_pairs(matches, output, s).collect();
        let mut ballots: Vec<([u32; 2], u32)> = Vec::new();
        for (k, &(a, i)) in pairs.iter().enumerate() {
            for &(b, j) in &pairs[k + 1..] {
                let way = output.plane.between(output.points[a as usize], output.points[b as usize]);
                if a == b || is_fixed(a, b) || length(way) > longest {
                    continue;
                }
                let joined = input.graph.leaving[i as usize].iter().find(|h| input.graph.end(**h) == j);
                let style = joined.map_or(u32::MAX, |h| input.graph.edge(*h).style);
                ballots.push(([a.min(b), a.max(b)], style));
            }
        }
        ballots
    });
    let mut ballots = ballots.concat();
    ballots.sort_unstable();
    let mut votes = Vec::new();
    let mut styles = Vec::new();
    for run in ballots.chunk_by(|a, b| a.0 == b.0) {
        // No style sorts last.
        let joined = run.partition_point(|v| v.1 != u32::MAX);
        if joined > 0 {
            votes.push(EdgeVote { ends: run[0].0, confidence: joined as f64 / run.len() as f64 });
            let common =
                run[..joined].chunk_by(|a, b| a.1 == b.1).max_by_key(|c| (c.len(), u32::MAX - c[0].1));
            styles.push(common.map_or(0, |c| c[0].1));
        }
    }
    let mut wanted = vec![(0.0, 0.0); matches.near.len()];
    for s in 0..matches.near.len() {
        for (a, i) in matched_pairs(matches, output, s) {
            wanted[a as usize].0 += input.ways[i as usize].len() as f64;
            wanted[a as usize].1 += 1.0;
        }
    }
    let mut wanted: Vec<f64> =
        wanted.into_iter().map(|(sum, count): (f64, f64)| sum / count.max(1.0)).collect();
    let mut standing = vec![0.0; wanted.len()];
    output.edges.truncate(output.given_edges);
    for edge in &output.edges {
        edge.ends.iter().for_each(|s| standing[*s as usize] += 1.0);
    }
    for s in (0..output.given()).filter(|s| output.ahead[*s].is_some()) {
        wanted[s] = wanted[s].max(standing[s] + 1.0);
    }
    for v in chosen(&votes, &wanted, standing) {
        output.edges.push(JoinedEdge { ends: votes[v].ends, from: [None; 2], style: styles[v] });
    }
    for s in output.given()..output.len() {
        output.style[s] = input.style[output.source[s] as usize];
    }
}

/// The pairs that are joined, in the order of their confidence: each if that brings confidences and numbers of edges
/// nearer to those wanted (equations 2.18 to 2.21). `count` are the edges that samples have already.
pub(crate) fn chosen(votes: &[EdgeVote], wanted: &[f64], mut count: Vec<f64>) -> Vec<usize> {
    let mut order: Vec<usize> = (0..votes.len()).collect();
    order.sort_by(|&a, &b| votes[b].confidence.total_cmp(&votes[a].confidence).then(a.cmp(&b)));
    let mut joined = Vec::new();
    for v in order {
        let EdgeVote { ends, confidence } = votes[v];
        let miss = |more: f64| -> f64 {
            ends.iter().map(|s| (count[*s as usize] + more - wanted[*s as usize]).abs()).sum()
        };
        if (1.0 - confidence) + miss(1.0) <= confidence + miss(0.0) {
            ends.iter().for_each(|s| count[*s as usize] += 1.0);
            joined.push(v);
        }
    }
    joined
}
