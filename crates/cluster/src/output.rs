//! The samples of the result, and the contexts of their clusters.

use crate::context::{Context, contexts, difference, shares};
use crate::input::{CONTEXT_WEIGHT, InputSamples};
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::parallel;

/// Samples in clusters.
pub(crate) struct OutputSamples {
    pub(crate) plane: PeriodicPlane,
    pub(crate) points: Vec<[f64; 2]>,
    /// The cluster of each; numbers below [`OutputSamples::clusters`], not all of them used.
    pub(crate) cluster: Vec<u32>,
    pub(crate) clusters: u32,
    /// The sample of the exemplar whose neighbourhood is the most similar (μ).
    pub(crate) source: Vec<u32>,
    /// The sample of the exemplar that it was copied from, whose colour it keeps.
    pub(crate) copied: Vec<u32>,
}

impl OutputSamples {
    pub(crate) fn new(plane: PeriodicPlane) -> Self {
        Self {
            plane,
            points: Vec::new(),
            cluster: Vec::new(),
            clusters: 0,
            source: Vec::new(),
            copied: Vec::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Numbers clusters anew, in the order of their first samples, without gaps.
    pub(crate) fn renumber(&mut self) {
        let mut new = vec![u32::MAX; self.clusters as usize];
        let mut count = 0;
        for cluster in &mut self.cluster {
            let own = &mut new[*cluster as usize];
            if *own == u32::MAX {
                *own = count;
                count += 1;
            }
            *cluster = *own;
        }
        self.clusters = count;
    }

    /// The samples of each cluster.
    pub(crate) fn members(&self) -> Vec<Vec<u32>> {
        let mut members = vec![Vec::new(); self.clusters as usize];
        for (s, cluster) in self.cluster.iter().enumerate() {
            members[*cluster as usize].push(s as u32);
        }
        members
    }

    /// Places of samples, each by the shortest way from the one before, so that a cluster is not torn by a seam.
    pub(crate) fn unwrapped(&self, members: &[u32]) -> Vec<[f64; 2]> {
        let mut last = None;
        let step = |s: &u32| {
            let p = self.points[*s as usize];
            let here = match last {
                None => p,
                Some(before) => {
                    let way = self.plane.between(before, p);
                    [before[0] + way[0], before[1] + way[1]]
                }
            };
            last = Some(here);
            here
        };
        members.iter().map(step).collect()
    }
}

/// Costs of the differences between contexts of the result and of the exemplar, in steps of [`STEP`].
pub(crate) struct ContextCosts {
    /// The row of each sample.
    row: Vec<u32>,
    width: usize,
    table: Vec<u8>,
}

/// A step of stored costs.
const STEP: f64 = CONTEXT_WEIGHT / 255.0;

impl ContextCosts {
    pub(crate) fn new(output: &OutputSamples, input: &InputSamples) -> Self {
        if input.without_context {
            let width = input.contexts.len();
            return Self { row: vec![0; output.len()], width, table: vec![0; width] };
        }
        let members = output.members();
        let own = parallel::map(&members, |members| contexts(&output.unwrapped(members), input.unit));
        let mut of_sample: Vec<(Context, u32)> = Vec::with_capacity(output.len());
        for (members, own) in members.iter().zip(own) {
            of_sample.extend(own.into_iter().zip(members.iter().copied()));
        }
        of_sample.sort_unstable();
        let mut row = vec![0; output.len()];
        let mut different: Vec<Context> = Vec::new();
        for (context, s) in of_sample {
            if different.last() != Some(&context) {
                different.push(context);
            }
            row[s as usize] = different.len() as u32 - 1;
        }
        let width = input.contexts.len();
        let rows = parallel::map(&different, |context| {
            let own = match input.known(context) {
                Some(known) => input.contexts[known as usize],
                None => shares(context),
            };
            let cost = |other| (255.0 * difference(&own, other) + 0.5) as u8;
            input.contexts.iter().map(cost).collect::<Vec<u8>>()
        });
        Self { row, width, table: rows.concat() }
    }

    /// The costs of a sample of the result, by the contexts of the exemplar.
    pub(crate) fn of(&self, sample: usize) -> &[u8] {
        &self.table[self.row[sample] as usize * self.width..][..self.width]
    }

    /// A stored cost as a length.
    pub(crate) fn cost(stored: u8) -> f64 {
        f64::from(stored) * STEP
    }
}
