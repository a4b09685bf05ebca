//! The samples of the result, and the contexts of their clusters.

use crate::context::{BINS, Context, contexts, difference, shares};
use crate::input::{CONTEXT_WEIGHT, InputSamples};
use vtex_base::error::Result;
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::parallel;

/// Samples in clusters.
pub(crate) struct OutputSamples {
    pub(crate) plane: PeriodicPlane,
    pub(crate) points: Vec<[f64; 2]>,
    /// The cluster of each; numbers below [`OutputSamples::clusters`], not all of them used.
    pub(crate) cluster: Vec<u32>,
    pub(crate) clusters: u32,
    /// Number of the samples, and of the clusters, of elements that stand. They are the first.
    pub(crate) given: [usize; 2],
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
            given: [0; 2],
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

/// Sum of the squares of the numbers of samples in a group of clusters.
const GROUP: usize = 1 << 20;

/// Clusters in groups for work that grows with the square of their samples, so that no group takes long unless it is a single
/// cluster.
pub(crate) fn in_groups(members: &[Vec<u32>]) -> impl Iterator<Item = &[Vec<u32>]> {
    let mut sum = 0;
    members.chunk_by(move |a, b| {
        sum += a.len() * a.len();
        let fits = sum + b.len() * b.len() <= GROUP;
        if !fits {
            sum = 0;
        }
        fits
    })
}

/// Most costs that are stored, in bytes. Further ones are computed when they are asked for.
const MOST_STORED: usize = 256 << 20;
/// Rows of costs computed at a time.
const ROWS_AT_ONCE: usize = 256;

/// Costs of the differences between contexts of the result and of the exemplar, in steps of [`STEP`].
pub(crate) struct ContextCosts<'a> {
    input: &'a InputSamples,
    /// The row of each sample.
    row: Vec<u32>,
    /// The first rows, one cost for each context of the exemplar; none if contexts do not count.
    stored: Vec<u8>,
    /// Contexts of the other rows.
    others: Vec<[f32; BINS]>,
}

/// The costs of one context of the result.
#[derive(Clone, Copy)]
pub(crate) enum ContextRow<'a> {
    /// Contexts do not count.
    Free,
    /// Costs in steps of [`STEP`].
    Stored(&'a [u8]),
    /// The context itself, and those of the exemplar.
    Computed(&'a [f32; BINS], &'a [[f32; BINS]]),
}

/// A step of stored costs.
const STEP: f64 = CONTEXT_WEIGHT / 255.0;

fn steps(a: &[f32; BINS], b: &[f32; BINS]) -> u8 {
    (255.0 * difference(a, b) + 0.5) as u8
}

impl ContextRow<'_> {
    /// The cost of a context of the exemplar, as a length.
    #[inline]
    pub(crate) fn cost(&self, context: u32) -> f64 {
        let steps = match self {
            Self::Free => 0,
            Self::Stored(row) => row[context as usize],
            Self::Computed(own, all) => steps(own, &all[context as usize]),
        };
        f64::from(steps) * STEP
    }
}

impl<'a> ContextCosts<'a> {
    /// The costs of all samples. `go_on` is asked in between.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn new(
        output: &OutputSamples,
        input: &'a InputSamples,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        Self::within(output, input, MOST_STORED, go_on)
    }

    /// [`ContextCosts::new`], with at most `most` stored costs.
    pub(crate) fn within(
        output: &OutputSamples,
        input: &'a InputSamples,
        most: usize,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let mut costs = Self { input, row: vec![0; output.len()], stored: Vec::new(), others: Vec::new() };
        if input.without_context {
            return Ok(costs);
        }
        let members = output.members();
        let mut of_sample: Vec<(Context, u32)> = Vec::with_capacity(output.len());
        for members in in_groups(&members) {
            go_on()?;
            let own = parallel::map(members, |members| contexts(&output.unwrapped(members), input.unit));
            for (members, own) in members.iter().zip(own) {
                of_sample.extend(own.into_iter().zip(members.iter().copied()));
            }
        }
        of_sample.sort_unstable();
        let mut different: Vec<Context> = Vec::new();
        for (context, s) in of_sample {
            if different.last() != Some(&context) {
                different.push(context);
            }
            costs.row[s as usize] = different.len() as u32 - 1;
        }
        let own = |context: &Context| match input.known(context) {
            Some(known) => input.contexts[known as usize],
            None => shares(context),
        };
        let (stored, others) = different.split_at(different.len().min(most / input.contexts.len().max(1)));
        for contexts in stored.chunks(ROWS_AT_ONCE) {
            go_on()?;
            let rows = parallel::map(contexts, |context| {
                let own = own(context);
                input.contexts.iter().map(|other| steps(&own, other)).collect::<Vec<u8>>()
            });
            rows.iter().for_each(|row| costs.stored.extend_from_slice(row));
        }
        costs.others = others.iter().map(own).collect();
        Ok(costs)
    }

    /// The costs of a sample of the result.
    pub(crate) fn of(&self, sample: usize) -> ContextRow<'_> {
        if self.input.without_context {
            return ContextRow::Free;
        }
        let width = self.input.contexts.len();
        let row = self.row[sample] as usize;
        match self.stored.get(row * width..(row + 1) * width) {
            Some(costs) => ContextRow::Stored(costs),
            None => ContextRow::Computed(&self.others[row - self.stored.len() / width], &self.input.contexts),
        }
    }
}
