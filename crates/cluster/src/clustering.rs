//! Clustering: samples change clusters, clusters are merged and split, as long as that lowers the sum of link and shape
//! energy (§6.5 of the paper).
//!
//! Operations wait in queues, the best first. An operation that concerns a cluster changed since is stale: it is
//! skipped, and those of the changed clusters are computed anew.

use crate::cut::normalised_cut;
use crate::input::InputSamples;
use crate::output::{OutputSamples, in_groups};
use crate::shape_energy::{ClusterWork, shape_match, shape_match_below};
use crate::votes::PairVotes;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use vtex_base::error::Result;
use vtex_base::geometry::plane::length;
use vtex_base::parallel;

/// Weight of the shape energy (w_s); that of the link energy is 1.
const SHAPE_WEIGHT: f64 = 4.0;
/// Steps of gains in queues, for each unit of energy.
const STEPS: f64 = 1e6;
/// Operations between two questions whether to go on.
const OPERATIONS: usize = 256;
/// Steps after which clusters stay as they are, for all levels together: some five seconds. Drawings whose elements are
/// small and side by side need less than half of it; shapes as large as the page, one over the other, a hundred times it.
pub(crate) const MOST_STEPS: u64 = 400_000_000;
/// Steps between two questions whether to go on.
const STEPS_AT_ONCE: u64 = 4_000_000;
/// Clusters of more samples are not split.
const MOST_SPLIT: usize = 2000;

/// Parts of clustering that are left out, for experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClusteringParts {
    /// Samples do not change clusters.
    pub no_switch: bool,
    /// Clusters are not merged.
    pub no_merge: bool,
    /// Clusters are not split.
    pub no_split: bool,
    /// Link energy is 0.
    pub no_link: bool,
    /// Shape energy is 0.
    pub no_shape: bool,
}

/// Operations done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClusterOperations {
    /// Samples that changed clusters.
    pub switched: usize,
    /// Pairs of clusters merged.
    pub merged: usize,
    /// Clusters split.
    pub split: usize,
}

/// An operation on clusters.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Operation {
    /// Merge the second cluster into the first.
    Merge(u32, u32),
    /// Move some samples of a cluster to a new one.
    Split(u32, Vec<u32>),
}

struct Clustering<'a> {
    output: &'a mut OutputSamples,
    input: &'a InputSamples,
    votes: &'a PairVotes,
    parts: ClusteringParts,
    /// 1 − 2 · confidence of each listed pair: the energy that it costs to be together.
    together: Vec<f64>,
    members: Vec<Vec<u32>>,
    shape: Vec<f64>,
    version: Vec<u32>,
    work: &'a mut ClusterWork,
    /// Steps at the last question whether to go on.
    asked: u64,
}

/// Improves the clusters of samples until `work` has [`MOST_STEPS`] steps. Returns what was done, and the energy before and
/// after.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_clusters(
    output: &mut OutputSamples,
    input: &InputSamples,
    votes: &PairVotes,
    (parts, work): (ClusteringParts, &mut ClusterWork),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(ClusterOperations, [f64; 2])> {
    let of_pair = |k: usize| votes.link(k).filter(|_| !parts.no_link).map_or(0.0, |l| 1.0 - 2.0 * l);
    let together = (0..votes.near.ids.len()).map(of_pair).collect();
    let members = output.members();
    let version = vec![0; members.len()];
    let mut state = Clustering {
        output,
        input,
        votes,
        parts,
        together,
        members,
        shape: Vec::new(),
        version,
        asked: work.steps,
        work,
    };
    state.measure(go_on)?;
    let before = state.energy();
    let mut done = ClusterOperations::default();
    if !parts.no_switch {
        done.switched = state.switch(go_on)?;
        state.measure(go_on)?;
    }
    state.merge_and_split(&mut done, go_on)?;
    let after = state.energy();
    output.renumber();
    Ok((done, [before, after]))
}

impl Clustering<'_> {
    /// Shape energies of all clusters.
    fn measure(&mut self, go_on: &dyn Fn() -> Result<()>) -> Result<()> {
        let Self { output, input, members, parts, .. } = self;
        let of = |members: &Vec<u32>| {
            let mut work = ClusterWork::default();
            let found = shape_match(output, input, members, |_| true, &mut work);
            (found.filter(|_| !parts.no_shape).map_or(0.0, |m| m.energy), work.steps)
        };
        let mut shape = Vec::with_capacity(members.len());
        for group in in_groups(members) {
            go_on()?;
            for (energy, steps) in parallel::map(group, of) {
                shape.push(energy);
                self.work.steps += steps;
            }
        }
        self.shape = shape;
        Ok(())
    }

    /// Whether clusters have to stay as they are.
    fn is_over(&self) -> bool {
        self.work.steps >= MOST_STEPS
    }

    /// The shape energy of some samples.
    fn shape_of(&mut self, members: &[u32], go_on: &dyn Fn() -> Result<()>) -> Result<f64> {
        Ok(self.shape_below(members, f64::INFINITY, go_on)?.unwrap_or(0.0))
    }

    /// The shape energy of some samples, if it is below `bound`.
    fn shape_below(
        &mut self,
        members: &[u32],
        bound: f64,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<f64>> {
        if self.parts.no_shape {
            return Ok(Some(0.0));
        }
        if self.work.steps - self.asked > STEPS_AT_ONCE {
            self.asked = self.work.steps;
            go_on()?;
        }
        let Self { output, input, work, .. } = self;
        Ok(shape_match_below(output, input, members, (|_| true, bound), work).map(|m| m.energy))
    }

    fn energy(&self) -> f64 {
        let link: f64 = (0..self.output.len()).map(|s| self.links(s, self.output.cluster[s])).sum();
        link + SHAPE_WEIGHT * self.shape.iter().sum::<f64>()
    }

    /// Whether a cluster is an element that stands, and stays as it is.
    fn is_given(&self, cluster: u32) -> bool {
        (cluster as usize) < self.output.given[1]
    }

    /// Link energy of the pairs listed for a sample, if it belongs to `cluster`.
    fn links(&self, s: usize, cluster: u32) -> f64 {
        let near = &self.votes.near;
        let of = |k: usize| {
            let same = self.output.cluster[near.ids[k] as usize] == cluster;
            if same { self.together[k] } else { -self.together[k] }
        };
        near.range(s).map(of).sum()
    }

    /// Partners of a sample within twice the sample distance.
    fn beside(&self, s: usize) -> impl Iterator<Item = usize> + '_ {
        let near = &self.votes.near;
        let reach = 2.0 * self.input.scale.distance;
        near.range(s).take_while(move |&k| length(near.ways[k]) < reach)
    }

    /// The adjacent cluster that a sample gains most by changing to, and the gain in steps, if that is positive; and the
    /// pairs looked at.
    fn best_switch(&self, s: usize) -> (Option<(i64, u32)>, u64) {
        let own = self.output.cluster[s];
        if self.is_given(own) {
            return (None, 0);
        }
        let mut others: Vec<u32> = self
            .beside(s)
            .map(|k| self.output.cluster[self.votes.near.ids[k] as usize])
            .filter(|c| *c != own && !self.is_given(*c))
            .collect();
        others.sort_unstable();
        others.dedup();
        let now = if others.is_empty() { return (None, 0) } else { self.links(s, own) };
        let pairs = (others.len() + 1) as u64 * self.votes.near.range(s).len() as u64;
        // Pairs count from both sides.
        let gain = |c: u32| ((2.0 * (now - self.links(s, c)) * STEPS) as i64, c);
        let gains = others.into_iter().map(gain).filter(|g| g.0 > 0);
        (gains.max_by_key(|g| (g.0, Reverse(g.1))), pairs)
    }

    /// Samples change clusters by link energy alone.
    fn switch(&mut self, go_on: &dyn Fn() -> Result<()>) -> Result<usize> {
        let count = self.output.len();
        let all: Vec<usize> = (0..count).collect();
        let first = parallel::map(&all, |&s| self.best_switch(s));
        let mut stamp = vec![0u32; count];
        let mut queue: BinaryHeap<(i64, Reverse<usize>, u32, u32)> = BinaryHeap::new();
        queue.extend(
            all.iter()
                .zip(first)
                .filter_map(|(&s, (best, _))| best.map(|(gain, c)| (gain, Reverse(s), c, 0))),
        );
        let mut done = 0;
        while let Some((_, Reverse(s), cluster, at)) = queue.pop() {
            if stamp[s] != at {
                continue;
            }
            if done >= count || self.is_over() {
                break;
            }
            if usize::is_multiple_of(done, OPERATIONS) {
                go_on()?;
            }
            let own = self.output.cluster[s] as usize;
            self.output.cluster[s] = cluster;
            self.members[own].retain(|m| *m as usize != s);
            self.members[cluster as usize].push(s as u32);
            done += 1;
            let changed = self.votes.near.range(s).map(|k| self.votes.near.ids[k] as usize).chain([s]);
            for other in changed.collect::<Vec<_>>() {
                stamp[other] += 1;
                let (best, pairs) = self.best_switch(other);
                self.work.steps += pairs;
                if let Some((gain, c)) = best {
                    queue.push((gain, Reverse(other), c, stamp[other]));
                }
            }
        }
        Ok(done)
    }

    /// Sum of the pairs between two clusters, each pair once, and whether the clusters are adjacent.
    fn between(&self, a: u32, b: u32) -> (f64, bool) {
        let near = &self.votes.near;
        let reach = 2.0 * self.input.scale.distance;
        let (small, other) =
            if self.members[a as usize].len() <= self.members[b as usize].len() { (a, b) } else { (b, a) };
        let (mut sum, mut adjacent) = (0.0, false);
        for &s in &self.members[small as usize] {
            for k in near.range(s as usize) {
                if self.output.cluster[near.ids[k] as usize] == other {
                    sum += self.together[k];
                    adjacent |= length(near.ways[k]) < reach;
                }
            }
        }
        (sum, adjacent)
    }

    /// The gain of merging two adjacent clusters in steps, if it is positive.
    fn merge_gain(&mut self, a: u32, b: u32, go_on: &dyn Fn() -> Result<()>) -> Result<Option<i64>> {
        let (sum, adjacent) = self.between(a, b);
        let looked_at = self.members[a as usize].len().min(self.members[b as usize].len());
        self.work.steps += (looked_at * self.votes.near.ids.len() / self.output.len().max(1)) as u64;
        let parts = self.shape[a as usize] + self.shape[b as usize];
        // No shape is better than a perfect one.
        let most = parts - 4.0 * sum / SHAPE_WEIGHT;
        if !adjacent || most <= 0.0 {
            return Ok(None);
        }
        let both = [&self.members[a as usize][..], &self.members[b as usize][..]].concat();
        let gain = |shape| ((SHAPE_WEIGHT * (parts - shape) - 4.0 * sum) * STEPS) as i64;
        Ok(self.shape_below(&both, most, go_on)?.map(gain).filter(|g| *g > 0))
    }

    /// The gain of splitting a cluster by its links, in steps, and the samples that leave; if it is positive.
    fn split_gain(&mut self, a: u32, go_on: &dyn Fn() -> Result<()>) -> Result<Option<(i64, Vec<u32>)>> {
        let members = &self.members[a as usize];
        if members.len() < 2 || members.len() > MOST_SPLIT {
            return Ok(None);
        }
        let near = &self.votes.near;
        let mut apart = 0.0;
        for &s in members {
            for k in near.range(s as usize) {
                if self.output.cluster[near.ids[k] as usize] == a {
                    apart += self.together[k].max(0.0);
                }
            }
        }
        if 2.0 * apart + SHAPE_WEIGHT * self.shape[a as usize] <= 0.0 {
            return Ok(None);
        }
        let of: BTreeMap<u32, usize> = members.iter().enumerate().map(|(i, s)| (*s, i)).collect();
        let links = |s: u32| {
            let own = near.range(s as usize);
            own.filter_map(|k| Some((*of.get(&near.ids[k])?, self.votes.link(k)?))).collect::<Vec<_>>()
        };
        let graph: Vec<Vec<(usize, f64)>> = members.iter().map(|s| links(*s)).collect();
        let Some(side) = normalised_cut(&graph) else { return Ok(None) };
        let take = |which: bool| -> Vec<u32> {
            members.iter().zip(&side).filter(|(_, s)| **s == which).map(|(m, _)| *m).collect()
        };
        let (stay, leave) = (take(false), take(true));
        let mut cut = 0.0;
        for (i, &s) in members.iter().enumerate().filter(|(i, _)| side[*i]) {
            for k in near.range(s as usize) {
                cut +=
                    of.get(&near.ids[k]).filter(|j| side[**j] != side[i]).map_or(0.0, |_| self.together[k]);
            }
        }
        let most = self.shape[a as usize] + 4.0 * cut / SHAPE_WEIGHT;
        let Some(first) = self.shape_below(&stay, most, go_on)? else { return Ok(None) };
        let Some(second) = self.shape_below(&leave, most - first, go_on)? else { return Ok(None) };
        let parts = first + second;
        let gain = SHAPE_WEIGHT * (self.shape[a as usize] - parts) + 4.0 * cut;
        Ok(Some(((gain * STEPS) as i64, leave)).filter(|g| g.0 > 0))
    }

    fn neighbours(&self, a: u32) -> Vec<u32> {
        let near = &self.votes.near;
        let of = |s: &u32| {
            self.beside(*s as usize).map(|k| self.output.cluster[near.ids[k] as usize]).collect::<Vec<_>>()
        };
        let mut all: Vec<u32> =
            self.members[a as usize].iter().flat_map(of).filter(|c| *c != a && !self.is_given(*c)).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Clusters are merged and split, at most as often as there are clusters.
    fn merge_and_split(
        &mut self,
        done: &mut ClusterOperations,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        let count = self.members.len();
        let mut queue = BinaryHeap::new();
        for a in 0..count as u32 {
            if (a as usize).is_multiple_of(OPERATIONS) {
                go_on()?;
            }
            self.push(a, true, &mut queue, go_on)?;
        }
        let mut operations = 0;
        while let Some((_, Reverse(operation), versions)) = queue.pop() {
            let (a, b) = match &operation {
                Operation::Merge(a, b) => (*a, *b),
                Operation::Split(a, _) => (*a, *a),
            };
            if versions != [self.version[a as usize], self.version[b as usize]] {
                continue;
            }
            if operations >= count || self.is_over() {
                break;
            }
            if usize::is_multiple_of(operations, 16) {
                go_on()?;
            }
            operations += 1;
            let new = match operation {
                Operation::Merge(a, b) => {
                    done.merged += 1;
                    let moved = std::mem::take(&mut self.members[b as usize]);
                    moved.iter().for_each(|s| self.output.cluster[*s as usize] = a);
                    self.members[a as usize].extend(moved);
                    self.shape[b as usize] = 0.0;
                    b
                }
                Operation::Split(a, leave) => {
                    done.split += 1;
                    let new = self.members.len() as u32;
                    leave.iter().for_each(|s| self.output.cluster[*s as usize] = new);
                    let cluster = &self.output.cluster;
                    self.members[a as usize].retain(|s| cluster[*s as usize] == a);
                    self.members.push(leave);
                    self.shape.push(0.0);
                    self.version.push(0);
                    self.output.clusters += 1;
                    new
                }
            };
            for c in [a, new] {
                self.version[c as usize] += 1;
                let members = self.members[c as usize].clone();
                self.shape[c as usize] = self.shape_of(&members, go_on)?;
            }
            for c in [a, new] {
                self.push(c, false, &mut queue, go_on)?;
            }
        }
        Ok(())
    }

    /// Queues the operations of a cluster; merges with earlier clusters only if asked for by `later` being false.
    fn push(
        &mut self,
        a: u32,
        later: bool,
        queue: &mut BinaryHeap<(i64, Reverse<Operation>, [u32; 2])>,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        if self.is_given(a) {
            return Ok(());
        }
        let own = self.version[a as usize];
        if !self.parts.no_merge {
            for b in self.neighbours(a).into_iter().filter(|b| !later || *b > a) {
                if self.is_over() {
                    return Ok(());
                }
                if let Some(gain) = self.merge_gain(a, b, go_on)? {
                    let versions = [own, self.version[b as usize]];
                    queue.push((gain, Reverse(Operation::Merge(a, b)), versions));
                }
            }
        }
        if !self.parts.no_split
            && let Some((gain, leave)) = self.split_gain(a, go_on)?
        {
            queue.push((gain, Reverse(Operation::Split(a, leave)), [own; 2]));
        }
        Ok(())
    }
}
