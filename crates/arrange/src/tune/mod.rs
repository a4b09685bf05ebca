//! Searches the weights of the score for one library.
//!
//! For each set of weights primaries are placed on several canvases. The objective is a weighted sum of four
//! terms ([`Terms`]):
//!
//! * *coverage*, category by category, before density is corrected. The correction reaches the wanted
//!   coverage with any weights, but it adds textons that no descriptor requested;
//! * *overlap*, *repetition* and *correlation* after the correction.
//!
//! Only the ratios of the weights matter, so one weight keeps its default. The others keep their signs, and
//! their logarithms are searched at random: each round compares the best set so far with sets drawn around
//! it, and the step shrinks from round to round.
//!
//! Every round has new canvases, so that the search does not fit the random draws of a few. The result is
//! compared with the initial weights on further canvases; unless it is better there, the initial weights are
//! returned.
//!
//! Works badly where all weights give about the same objective. Weights mainly change how much density has to
//! correct; the final arrangement hardly depends on them.

mod document;
#[cfg(test)]
mod tests;

pub use document::TunedWeights;

use crate::arrange::Plan;
use crate::synth::one_by_one::primaries;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use vtex_base::Parameter;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::sampling::stream;
use vtex_scene::element::CategoryId;
use vtex_scene::library::Library;
use vtex_scene::scene::LibraryId;
use vtex_scene::scene::{Method, SynthParams, Weights};
use vtex_scene::statistics::{Layout, PairCorrelations, largest_categories, neighbour_distance};

/// Name of the stage.
const STAGE: &str = "tuning";
/// Sets of weights in a round of the search.
const ROUND: u32 = 8;
/// Standard deviation of the first step, in logarithms of weights.
const STEP: f64 = 1.0;
/// Factor of the step from round to round.
const SHRINKING: f64 = 0.9;
/// Number of canvases of the final comparison, as a multiple of those in the search.
const UNSEEN: u32 = 4;

/// How weights are searched.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneParams {
    /// How scenes are placed: size, seed, candidates, moves, and the initial weights. Default: as
    /// [`SynthParams`], with canvases of [`TuneParams::SIDE`].
    pub synth: SynthParams,
    /// Canvases placed for each set of weights.
    pub seeds: u32,
    /// Sets of weights tried.
    pub evaluations: u32,
}

/// Ranges, units and defaults of the fields of the same names.
#[allow(missing_docs)]
impl TuneParams {
    /// Of the width and the height of a canvas.
    pub const SIDE: Parameter<u32> = SynthParams::SIDE.or(500);
    pub const SEEDS: Parameter<u32> = Parameter::new("seeds", [1, 100], "").or(3);
    pub const EVALUATIONS: Parameter<u32> = Parameter::new("evaluations", [10, 100_000], "").or(200);
}

impl Default for TuneParams {
    fn default() -> Self {
        let (width, height) = (Self::SIDE.default(), Self::SIDE.default());
        let synth = SynthParams { width, height, ..SynthParams::default() };
        Self { synth, seeds: Self::SEEDS.default(), evaluations: Self::EVALUATIONS.default() }
    }
}

impl TuneParams {
    /// Checks every range.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] naming the first parameter out of range.
    pub fn validate(&self) -> Result<()> {
        self.synth.validate()?;
        Self::SEEDS.check(self.seeds)?;
        Self::EVALUATIONS.check(self.evaluations)
    }
}

/// Terms of a set of weights; of each, less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Sum of the absolute errors of coverage by category, before density is corrected, as a share of the
    /// wanted coverage.
    pub coverage: f64,
    /// Share of the area of primaries that other primaries hide.
    pub overlap: f64,
    /// Share of the primaries with a copy nearer than two mean neighbour distances.
    pub repetition: f64,
    /// Difference of pair correlation from the exemplar's, within and between the five largest
    /// categories.
    pub correlation: f64,
}

impl Terms {
    /// The value that the search minimises: the sum of the terms, weighted by how visible each is.
    pub fn objective(&self) -> f64 {
        self.coverage + 2.0 * self.overlap + self.repetition + self.correlation
    }
}

/// The measures of a library that scenes are compared with.
struct Judge<'a> {
    library: &'a Library,
    params: &'a TuneParams,
    categories: Vec<CategoryId>,
    unit: f64,
    exemplar: PairCorrelations,
}

/// The measures of one canvas.
struct Sample {
    terms: Terms,
    correlation: PairCorrelations,
}

impl<'a> Judge<'a> {
    fn new(library: &'a Library, params: &'a TuneParams) -> Self {
        let categories = largest_categories(library);
        let unit = neighbour_distance(library);
        let exemplar =
            PairCorrelations::new(&Layout::of_library(library), LibraryId::default(), &categories, unit);
        Self { library, params, categories, unit, exemplar }
    }

    /// The terms of several sets of weights, each on canvases of the same seeds.
    fn terms(&self, all: &[Weights], seeds: &[u64], progress: &dyn Progress) -> Result<Vec<Terms>> {
        let jobs: Vec<(&Weights, u64)> =
            all.iter().flat_map(|w| seeds.iter().map(move |s| (w, *s))).collect();
        let samples = parallel::map(&jobs, |(w, s)| self.sample(w, *s, progress));
        let samples = samples.into_iter().collect::<Result<Vec<Sample>>>()?;
        Ok(samples.chunks(seeds.len()).map(|of_one| self.together(of_one)).collect())
    }

    fn sample(&self, weights: &Weights, seed: u64, progress: &dyn Progress) -> Result<Sample> {
        let by_descriptors = SynthParams {
            weights: weights.clone(),
            seed,
            method: Method::Descriptor,
            ..self.params.synth.clone()
        };
        let libraries = Cow::Borrowed(std::slice::from_ref(self.library));
        let plan = Plan { libraries, controls: Cow::default(), params: by_descriptors, memory: None };
        let (arranged, covered) = primaries(&plan, progress)?;
        let (scene, report) = arranged.composed(&plan, progress)?;
        let wanted: Vec<f64> = self.library.categories.iter().map(|c| c.coverage).collect();
        let error: f64 = covered.iter().zip(&wanted).map(|(c, w)| (c - w).abs()).sum();
        let layout = Layout::of_scene(&scene);
        let terms = Terms {
            coverage: error / wanted.iter().sum::<f64>().max(1e-9),
            overlap: report.overlap.hidden,
            repetition: report.repetition.near,
            correlation: 0.0,
        };
        Ok(Sample {
            terms,
            correlation: PairCorrelations::new(&layout, LibraryId::default(), &self.categories, self.unit),
        })
    }

    /// Mean terms of several canvases. Pair correlations are added up before they are compared.
    fn together(&self, samples: &[Sample]) -> Terms {
        let mean = |f: fn(&Terms) -> f64| {
            samples.iter().map(|s| f(&s.terms)).sum::<f64>() / samples.len().max(1) as f64
        };
        let mut curves: Option<PairCorrelations> = None;
        for s in samples {
            match &mut curves {
                Some(sum) => sum.add(&s.correlation),
                None => curves = Some(s.correlation.clone()),
            }
        }
        let difference = curves.and_then(|c| c.difference(&self.exemplar));
        Terms {
            coverage: mean(|t| t.coverage),
            overlap: mean(|t| t.overlap),
            repetition: mean(|t| t.repetition),
            correlation: difference.map_or(0.0, |d| d.rms),
        }
    }
}

/// Searches the weights of the score for a library. Same library, parameters and program: the same
/// weights, on any number of threads.
///
/// # Errors
/// [`vtex_base::Error::Parameter`] for a parameter out of range, [`vtex_base::Error::Interrupted`].
pub fn tune(library: &Library, params: &TuneParams, progress: &dyn Progress) -> Result<TunedWeights> {
    params.validate()?;
    let library = library.at_scale(library.source.scale);
    let judge = Judge::new(&library, params);
    let begin = &params.synth.weights;
    let mut random = stream(params.synth.seed, "tune/search", 0);
    let (mut best, mut step) = (coordinates(begin), STEP);
    let mut canvases = stream(params.synth.seed, "tune/canvases", 0);
    let mut seeds = |count: u32| -> Vec<u64> { (0..count).map(|_| canvases.bits()).collect() };
    let total = u64::from(params.evaluations);
    let mut tried = 0;
    advance(progress, STAGE, 0, total)?;
    while tried < params.evaluations {
        let mut points = vec![best];
        points.extend((1..ROUND).map(|_| best.map(|v| v + step * random.normal())));
        let weights: Vec<Weights> = points.iter().map(|p| at(begin, *p)).collect();
        let watch = TuneProgress { progress, done: u64::from(tried), total };
        let terms = judge.terms(&weights, &seeds(params.seeds), &watch)?;
        let least = terms.iter().zip(&points).min_by(|a, b| a.0.objective().total_cmp(&b.0.objective()));
        best = least.map_or(best, |(_, point)| *point);
        step *= SHRINKING;
        tried += ROUND;
        advance(progress, STAGE, u64::from(tried).min(total), total)?;
    }
    let found = at(begin, best);
    let watch = TuneProgress { progress, done: total, total };
    let judged = judge.terms(&[begin.clone(), found.clone()], &seeds(params.seeds * UNSEEN), &watch)?;
    let better = judged[1].objective() < judged[0].objective();
    let (weights, after) = if better { (found, judged[1]) } else { (begin.clone(), judged[0]) };
    if !better {
        progress.warn("no weights were found that are better than those to begin with");
    }
    Ok(TunedWeights {
        format: TunedWeights::FORMAT.into(),
        version: TunedWeights::VERSION,
        program: vtex_base::PROGRAM.into(),
        library: library.reference().exemplar(),
        weights,
        before: judged[0],
        after,
        size: [params.synth.width, params.synth.height],
        seed: params.synth.seed,
        seeds: params.seeds,
        evaluations: tried,
    })
}

/// Smallest and largest size of a weight relative to that of the target.
const RANGE: [f64; 2] = [0.005, 20.0];

/// Weights as the search sees them: logarithms of their sizes relative to that of the target.
fn coordinates(w: &Weights) -> [f64; 4] {
    let scale = w.target.abs().max(1e-3);
    [w.uncovered, w.empty, w.mismatched, w.same_overlap]
        .map(|v| libm::log((v.abs() / scale).clamp(RANGE[0], RANGE[1])))
}

/// Weights at a point of the search, rounded to thousandths, with the signs and the target weight of the
/// initial ones.
fn at(begin: &Weights, point: [f64; 4]) -> Weights {
    let scale = begin.target.abs().max(1e-3);
    let size = |k: usize, sign: f64| {
        let value = scale * libm::exp(point[k]).clamp(RANGE[0], RANGE[1]);
        (libm::round(value.min(10.0) * 1e3) / 1e3).copysign(sign)
    };
    Weights {
        target: begin.target,
        uncovered: size(0, begin.uncovered),
        empty: size(1, begin.empty),
        mismatched: size(2, begin.mismatched),
        same_overlap: size(3, begin.same_overlap),
    }
}

/// Reports the progress of the search in place of that of single placements, and stops these on request.
struct TuneProgress<'a> {
    progress: &'a dyn Progress,
    done: u64,
    total: u64,
}

impl Progress for TuneProgress<'_> {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        self.progress.advance(STAGE, self.done, self.total)
    }
}
