//! What matched neighbourhoods say about pairs of close samples: whether they belong to one cluster (link confidence,
//! equations 10 and 11), and which lies beneath the other (equations 5 to 7).

use crate::input::InputSamples;
use crate::output::OutputSamples;
use vtex_base::geometry::coherence::NeighbourhoodMatches;
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::{PointIndex, Vicinity};
use vtex_base::parallel;

/// Most partners of a sample.
const MOST_PARTNERS: usize = 96;

/// Votes on the pairs of close samples.
pub(crate) struct PairVotes {
    /// The partners of each sample. Pairs are listed from both sides.
    pub(crate) near: Vicinity,
    /// For each listed pair: how many neighbourhoods hold both, in how many of them the matches share a cluster, and in
    /// how many the match of the first lies beneath that of the second.
    pub(crate) counts: Vec<[u16; 3]>,
}

impl PairVotes {
    /// The votes on all pairs closer than `reach`.
    pub(crate) fn new(
        output: &OutputSamples,
        input: &InputSamples,
        matches: &NeighbourhoodMatches,
        reach: f64,
    ) -> Self {
        let index = PointIndex::new(output.plane, reach, &output.points);
        let near = Vicinity::new(&index, &output.points, reach, (MOST_PARTNERS, true));
        let holders = holders(output, matches);
        let of = |part: &std::ops::Range<usize>| {
            let mut slot = vec![NONE; output.len()];
            let mut counts = Vec::new();
            for s in part.clone() {
                let own = near.range(s);
                let before = counts.len();
                counts.resize(before + own.len(), [0u16; 3]);
                own.clone().for_each(|k| slot[near.ids[k] as usize] = (k - own.start) as u32);
                for &(centre, match_of_s) in
                    &holders.of[holders.starts[s] as usize..holders.starts[s + 1] as usize]
                {
                    let (place, centre) = (input.place[match_of_s as usize], centre as usize);
                    let mut count = |other: u32, matched: u32| {
                        let k = slot[other as usize];
                        if k != NONE && matched != NONE {
                            let there = input.place[matched as usize];
                            let [all, same, below] = &mut counts[before + k as usize];
                            *all += 1;
                            *same += u16::from(there == place);
                            *below += u16::from(place < there);
                        }
                    };
                    count(centre as u32, output.source[centre]);
                    for k in matches.near.range(centre) {
                        count(matches.near.ids[k], matches.matched[k]);
                    }
                }
                own.for_each(|k| slot[near.ids[k] as usize] = NONE);
            }
            counts
        };
        let piece = output.len().div_ceil(32).max(256);
        let parts: Vec<_> =
            (0..output.len()).step_by(piece).map(|a| a..(a + piece).min(output.len())).collect();
        Self { counts: parallel::map(&parts, of).concat(), near }
    }

    /// Confidence that a listed pair belongs to one cluster, 0 to 1; `None` if no neighbourhood holds both.
    pub(crate) fn link(&self, k: usize) -> Option<f64> {
        let [all, same, _] = self.counts[k];
        (all > 0).then(|| f64::from(same) / f64::from(all))
    }
}

/// For each sample the neighbourhoods that hold it, and its match there.
struct Holders {
    starts: Vec<u32>,
    of: Vec<(u32, u32)>,
}

fn holders(output: &OutputSamples, matches: &NeighbourhoodMatches) -> Holders {
    let mut starts = vec![0u32; output.len() + 1];
    let each = |f: &mut dyn FnMut(usize, u32, u32)| {
        for centre in 0..matches.near.len() {
            f(centre, centre as u32, output.source[centre]);
            for k in matches.near.range(centre).filter(|&k| matches.matched[k] != NONE) {
                f(matches.near.ids[k] as usize, centre as u32, matches.matched[k]);
            }
        }
    };
    each(&mut |s, _, _| starts[s + 1] += 1);
    for s in 1..starts.len() {
        starts[s] += starts[s - 1];
    }
    let mut next = starts.clone();
    let mut of = vec![(0, 0); starts[output.len()] as usize];
    each(&mut |s, centre, matched| {
        of[next[s] as usize] = (centre, matched);
        next[s] += 1;
    });
    Holders { starts, of }
}
