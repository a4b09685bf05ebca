//! The samples of the exemplar at one level.

use crate::context::{BINS, Context, contexts, difference, shares, unit};
use crate::figures::{ClusterExemplar, samples};
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::geometry::coherence::SourcePoints;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, Vicinity, length};

/// Weight of the difference of contexts (w_f of the paper), in lengths of which the exemplar has 400. The
/// difference of colours weighs as much.
pub(crate) const CONTEXT_WEIGHT: f64 = 10.0;
/// Difference of colours in Oklab that counts as complete.
const OTHER_COLOUR: f64 = 0.25;
/// Mean number of samples in a neighbourhood: the radius is reduced to that.
const NEIGHBOURS: f64 = 26.0;
/// Most samples in a neighbourhood of the exemplar, and of the result.
const MOST_NEAR: usize = 40;
pub(crate) const MOST_NEAR_OUTPUT: usize = 30;
/// Number of similar samples that each sample knows.
pub(crate) const SIMILAR: usize = 3;
/// Samples with which each is compared to find similar ones, at most.
const COMPARED: usize = 500;
/// Samples that are compared between two questions whether to go on.
const AT_ONCE: usize = 4096;

/// Lengths of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelScale {
    /// Least distance of samples (δ).
    pub(crate) distance: f64,
    /// Radius of neighbourhoods (r).
    pub(crate) radius: f64,
}

/// The samples, and what is known of them.
pub(crate) struct InputSamples {
    pub(crate) plane: PeriodicPlane,
    pub(crate) scale: LevelScale,
    pub(crate) points: Vec<[f64; 2]>,
    /// The place that each belongs to, which is its cluster. Places are in painting order.
    pub(crate) place: Vec<u32>,
    /// The first sample of each place; its samples follow each other.
    pub(crate) first: Vec<u32>,
    /// Samples of each figure, around its reference point.
    pub(crate) of_figure: Vec<Vec<[f64; 2]>>,
    /// Figure of each place.
    pub(crate) figure: Vec<u32>,
    /// Whether the result may have the element of each place.
    pub(crate) placeable: Vec<bool>,
    /// Samples near each.
    pub(crate) near: Vicinity,
    pub(crate) index: PointIndex,
    /// Whether contexts do not count.
    pub(crate) without_context: bool,
    /// Unit of contexts.
    pub(crate) unit: f64,
    /// The different contexts, and which of them each sample has.
    pub(crate) contexts: Vec<[f32; BINS]>,
    known: BTreeMap<Context, u32>,
    pub(crate) context: Vec<u32>,
    /// Cost of a difference of categories.
    colours: Vec<f64>,
    category: Vec<u32>,
    categories: usize,
    /// Samples with the most similar neighbourhoods.
    similar: Vec<[u32; SIMILAR]>,
}

impl InputSamples {
    /// The samples of an exemplar whose page is about 400 long, at a level of the given lengths.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn new(
        exemplar: &ClusterExemplar,
        scale: LevelScale,
        seed: u64,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let figures: Vec<usize> = (0..exemplar.figures.len()).collect();
        let of_figure = vtex_base::parallel::map(&figures, |&f| {
            samples(&exemplar.figures[f], scale.distance, seed, f as u64)
        });
        let unit = unit(of_figure.iter().map(Vec::as_slice)).max(scale.distance);
        let mut known: BTreeMap<Context, u32> = BTreeMap::new();
        let mut different: Vec<[f32; BINS]> = Vec::new();
        let mut of_figures: Vec<Vec<u32>> = Vec::new();
        for points in &of_figure {
            let own = contexts(points, unit).into_iter().map(|context| {
                *known.entry(context).or_insert_with(|| {
                    different.push(shares(&context));
                    different.len() as u32 - 1
                })
            });
            of_figures.push(own.collect());
        }
        let (mut points, mut place, mut first, mut context) = (Vec::new(), Vec::new(), vec![0], Vec::new());
        for (k, p) in exemplar.places.iter().enumerate() {
            for (way, own) in of_figure[p.figure as usize].iter().zip(&of_figures[p.figure as usize]) {
                points.push(exemplar.page.wrapped([p.at[0] + way[0], p.at[1] + way[1]]));
                place.push(k as u32);
                context.push(*own);
            }
            first.push(points.len() as u32);
        }
        // So many samples that a neighbourhood has about as many as the paper's.
        let mean =
            libm::sqrt(NEIGHBOURS * exemplar.page.area() / points.len().max(1) as f64 / std::f64::consts::PI);
        let scale = LevelScale { radius: scale.radius.min(mean.max(1.5 * scale.distance)), ..scale };
        let reach = scale.radius + 0.5 * scale.distance;
        let index = PointIndex::new(exemplar.page, reach, &points);
        let near = Vicinity::new(&index, &points, reach, (MOST_NEAR, true));
        let categories = exemplar.figures.iter().map(|f| f.category as usize + 1).max().unwrap_or(0);
        let mut made = Self {
            plane: exemplar.page,
            scale,
            points,
            first,
            figure: exemplar.places.iter().map(|p| p.figure).collect(),
            placeable: exemplar.places.iter().map(|p| p.placeable).collect(),
            category: place
                .iter()
                .map(|k| exemplar.figures[exemplar.places[*k as usize].figure as usize].category)
                .collect(),
            place,
            of_figure,
            near,
            index,
            without_context: false,
            unit,
            contexts: different,
            known,
            context,
            colours: colours(exemplar, categories),
            categories,
            similar: Vec::new(),
        };
        made.similar = made.find_similar(go_on)?;
        Ok(made)
    }

    /// The number of samples.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Index of a context that samples of the exemplar have.
    pub(crate) fn known(&self, context: &Context) -> Option<u32> {
        self.known.get(context).copied()
    }

    /// Cost of the difference in colour between two samples.
    pub(crate) fn colour_cost(&self, a: u32, b: u32) -> f64 {
        self.colours
            [self.category[a as usize] as usize * self.categories + self.category[b as usize] as usize]
    }

    /// The samples of the place that a sample belongs to.
    pub(crate) fn cluster(&self, place: u32) -> std::ops::Range<usize> {
        self.first[place as usize] as usize..self.first[place as usize + 1] as usize
    }

    /// The samples, for a search.
    pub(crate) fn sources(&self) -> SourcePoints<'_> {
        let Self { plane, points, index, near, .. } = self;
        SourcePoints { plane: *plane, points, index, near, distance: self.scale.distance }
    }

    /// Samples with neighbourhoods similar to that of sample `i`, the most similar first.
    pub(crate) fn similar(&self, i: u32) -> &[u32; SIMILAR] {
        &self.similar[i as usize]
    }

    fn find_similar(&self, go_on: &dyn Fn() -> Result<()>) -> Result<Vec<[u32; SIMILAR]>> {
        let signatures: Vec<[f32; SIGNATURE]> = (0..self.len()).map(|i| self.signature(i)).collect();
        let all: Vec<usize> = (0..self.len()).collect();
        let stride = self.len().div_ceil(COMPARED).max(1);
        let most_similar = |&i: &usize| {
            let mut best = [(f32::INFINITY, i as u32); SIMILAR];
            for j in (i % stride..self.len()).step_by(stride).filter(|&j| j != i) {
                let colour = self.colour_cost(i as u32, j as u32) / CONTEXT_WEIGHT;
                let own = difference(
                    &self.contexts[self.context[i] as usize],
                    &self.contexts[self.context[j] as usize],
                );
                let apart: f32 = signatures[i].iter().zip(&signatures[j]).map(|(a, b)| (a - b).abs()).sum();
                let far = apart + 4.0 * own + 4.0 * colour as f32;
                if far < best[SIMILAR - 1].0 {
                    best[SIMILAR - 1] = (far, j as u32);
                    best.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                }
            }
            best.map(|b| b.1)
        };
        let mut similar = Vec::with_capacity(self.len());
        for chunk in all.chunks(AT_ONCE) {
            go_on()?;
            similar.extend(vtex_base::parallel::map(chunk, most_similar));
        }
        Ok(similar)
    }

    /// Where the neighbours of a sample are: shares of sectors and rings, those between shared out.
    fn signature(&self, i: usize) -> [f32; SIGNATURE] {
        let mut counts = [0.0f32; SIGNATURE];
        for way in &self.near.ways[self.near.range(i)] {
            let turn = (libm::atan2(way[1], way[0]) / std::f64::consts::TAU + 1.0) * SECTORS as f64;
            let ring = (length(*way) / self.scale.radius * RINGS as f64 - 0.5).clamp(0.0, RINGS as f64 - 1.0);
            let (sector, inner) = (libm::floor(turn), libm::floor(ring));
            for (s, share) in [(sector, 1.0 - (turn - sector)), (sector + 1.0, turn - sector)] {
                for (r, part) in [(inner, 1.0 - (ring - inner)), (inner + 1.0, ring - inner)] {
                    if part > 0.0 {
                        counts[(r as usize).min(RINGS - 1) * SECTORS + s as usize % SECTORS] +=
                            (share * part) as f32;
                    }
                }
            }
        }
        counts
    }
}

/// Classes of a signature.
const SECTORS: usize = 8;
const RINGS: usize = 3;
const SIGNATURE: usize = SECTORS * RINGS;

/// Costs of the differences in colour of all pairs of categories.
fn colours(exemplar: &ClusterExemplar, categories: usize) -> Vec<f64> {
    let mut sums = vec![([0.0; 3], 0.0); categories];
    for f in &exemplar.figures {
        let (sum, count) = &mut sums[f.category as usize];
        *count += 1.0;
        (0..3).for_each(|k| sum[k] += f.colour[k]);
    }
    let mean: Vec<[f64; 3]> = sums.iter().map(|(sum, n)| sum.map(|v| v / f64::max(*n, 1.0))).collect();
    let cost = |a: &[f64; 3], b: &[f64; 3]| {
        let d: f64 = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
        CONTEXT_WEIGHT * (libm::sqrt(d) / OTHER_COLOUR).min(1.0)
    };
    mean.iter().flat_map(|a| mean.iter().map(move |b| cost(a, b))).collect()
}
