//! The optimisation from coarse to fine.

use crate::balance::balance;
use crate::board::{Board, BoardElement};
use crate::clustering::{ClusterOperations, ClusteringParts, MOST_STEPS, improve_clusters};
use crate::depth::ordered;
use crate::existence::add_missing;
use crate::figures::ClusterExemplar;
use crate::initial::{blocks, copy, is_regular};
use crate::input::{InputSamples, LevelScale};
use crate::mend::{MendCounts, complete, mend};
use crate::output::OutputSamples;
use crate::positions::improve_positions;
use crate::rebuild::{rebuilt, sampled};
use crate::relations::PlaceRelations;
use crate::search::search;
use crate::shape_energy::ClusterWork;
use crate::standing::{ClusterContext, StandingElements, standing};
use crate::votes::PairVotes;
use std::collections::BTreeMap;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::{PeriodicPlane, length};
use vtex_base::sampling::stream;

/// Mean side of the exemplar, in the lengths of the optimiser.
const SIDE: f64 = 400.0;
/// Sample distance and radius of neighbourhoods of each level, as shares of the mean side (§7 of the paper).
const LEVELS: [LevelScale; 3] = [
    LevelScale { distance: 1.0 / 20.0, radius: 1.0 / 6.0 },
    LevelScale { distance: 1.0 / 30.0, radius: 1.0 / 8.0 },
    LevelScale { distance: 1.0 / 40.0, radius: 1.0 / 12.0 },
];
/// Samples of an element of the mean size at most, on each level; and how many a square of the sample distance holds.
const SAMPLES: [f64; 3] = [8.0, 16.0, 24.0];
const PACKING: f64 = 1.3;
/// Variation of a regular exemplar, in which a block out of line is seen at once.
const STRICT: f64 = 0.25;
/// Covered area, as a share of the exemplar's, from which a first arrangement is taken.
const FULL: f64 = 0.96;
/// How far the window around a region reaches, in radii of the first level, beyond the largest element.
const AROUND: f64 = 2.0;
/// Iterations of a level at most, and the change of energy below which it ends earlier.
const ITERATIONS: usize = 7;
const SETTLED: f64 = 0.01;
/// Distance up to which samples tell the painting order of their elements, in sample distances.
const OVERLAPS: f64 = 2.0;
/// Reach of links, in sample distances (λ).
const LINKS: f64 = 4.0;
/// Most samples of the result: levels with more are left out.
const MOST_SAMPLES: f64 = 20_000.0;
/// Most elements of the exemplar, repeated to the size of a few neighbourhoods, and of the result.
const MOST_PLACES: f64 = 50_000.0;
const MOST_ELEMENTS: f64 = 400_000.0;

/// What is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterParams {
    /// Width and height of the canvas, in the unit of the exemplar.
    pub size: [f64; 2],
    /// The axes along which the canvas repeats without a seam.
    pub tile: [bool; 2],
    /// Seed of all random choices.
    pub seed: u64,
    /// How readily the exemplar is rearranged, 0 to 1. With 0 it goes on as it is wherever it can.
    pub variation: f64,
    /// Parts of clustering that are left out.
    pub without: ClusteringParts,
    /// Whether samples do not know where they lie within their cluster.
    pub without_context: bool,
    /// Whether the painting order is left as chance has it.
    pub without_depth: bool,
}

/// An element of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusteredElement {
    /// Index of the place in the exemplar whose element it is.
    pub place: usize,
    /// Its reference point, in the unit of the exemplar. It may lie beside the canvas.
    pub at: [f64; 2],
}

/// A sample of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterSample {
    /// Its place, in the unit of the exemplar. It may lie beside the canvas.
    pub at: [f64; 2],
    /// Number of its cluster.
    pub cluster: u32,
}

/// What a level did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LevelReport {
    /// Samples of the exemplar, and of the result at the end.
    pub samples: [usize; 2],
    /// Energy of each iteration, for each neighbourhood and sample.
    pub energies: Vec<f64>,
    /// Energy of the clusters before and after each iteration.
    pub cluster_energies: Vec<[f64; 2]>,
    /// Samples added.
    pub added: usize,
    /// Operations on clusters.
    pub operations: ClusterOperations,
    /// Steps of clustering, some nanoseconds each: distances measured to compare shapes, and pairs of samples looked at.
    pub steps: u64,
    /// Clusters at the end, and those that became elements.
    pub clusters: [usize; 2],
    /// Elements mended.
    pub mended: MendCounts,
    /// Distance of samples, in the unit of the exemplar.
    pub distance: f64,
    /// The samples at the end, before clusters became elements.
    pub output: Vec<ClusterSample>,
}

/// The result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClusterResult {
    /// The elements in painting order.
    pub elements: Vec<ClusteredElement>,
    /// The levels, from coarse to fine.
    pub levels: Vec<LevelReport>,
}

/// Arranges elements like those of an exemplar on a canvas. `go_on` is asked between parts of the work.
///
/// # Errors
/// [`Error::TooLarge`] for too many elements; those of `go_on`.
pub fn cluster(
    exemplar: &ClusterExemplar,
    params: &ClusterParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<ClusterResult> {
    arranged(exemplar, None, params, go_on)
}

/// Arranges elements like those of an exemplar in a region beside elements that stand. The result holds the new ones
/// alone, those whose reference points lie in the region. `params.tile` must be false.
///
/// # Errors
/// Those of [`cluster`].
pub fn cluster_beside(
    exemplar: &ClusterExemplar,
    context: &ClusterContext,
    params: &ClusterParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<ClusterResult> {
    arranged(exemplar, Some(context), params, go_on)
}

fn arranged(
    exemplar: &ClusterExemplar,
    context: Option<&ClusterContext>,
    params: &ClusterParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<ClusterResult> {
    if !exemplar.places.iter().any(|p| p.placeable) {
        return Ok(ClusterResult::default());
    }
    let unit = SIDE / (0.5 * (exemplar.page.size[0] + exemplar.page.size[1]));
    let mut own = exemplar.scaled(unit);
    let extent = own.figures.iter().map(|f| {
        let b = f.bounds();
        [b.x0, b.y0, b.x1, b.y1].into_iter().fold(0.0, |m: f64, v| m.max(v.abs()))
    });
    let largest = 2.0 * extent.fold(0.0, f64::max);
    let around = largest + AROUND * LEVELS[0].radius * SIDE;
    let beside = context.map(|context| {
        let window = context.window((params.size, unit), around);
        standing(context, (unit, &window), &mut own, go_on).map(|drawn| (window, drawn))
    });
    let beside = beside.transpose()?;
    // No neighbourhood, no element and none of the elements around one may meet itself across a seam.
    let around_element = 2.1 * PlaceRelations::reach_of_partners(&own);
    let least = (4.2 * LEVELS[0].radius * SIDE).max(1.1 * largest).max(around_element);
    check(&own, params, (unit, least))?;
    let scene = own.repeated(least);
    let mut relations = PlaceRelations::new(&scene, go_on)?;
    go_on()?;
    if let Some((context, (window, drawn))) = context.zip(beside) {
        let standing = StandingElements::new(window, drawn, &relations, context.source_at(unit).as_ref());
        relations = relations.beside(standing, go_on)?;
    }
    let standing = relations.standing.as_ref();
    let plane = standing.map_or_else(|| canvas(&own, params, unit, largest), |s| s.window.plane);
    let shown = |at: [f64; 2]| shown(at, (plane, standing), params, unit);
    let (mut board, first) = first_arrangement(&relations, plane, (own.page, params), go_on)?;
    let mut levels = Vec::new();
    let mut last = None;
    let mut work = ClusterWork::default();
    for scale in scales(&relations) {
        let mut input = InputSamples::new(&scene, scale, params.seed, go_on)?;
        input.without_context = params.without_context;
        go_on()?;
        let expected = input.len() as f64 * plane.area() / scene.page.area();
        if expected > MOST_SAMPLES {
            break;
        }
        let output = sampled(&board, &input);
        // What stands may have more.
        if output.len() as f64 > MOST_SAMPLES {
            break;
        }
        let (output, votes, mut report) = level_of(output, &input, (params, standing), &mut work, go_on)?;
        report.distance = scale.distance / unit;
        let samples = output.points.iter().zip(&output.cluster);
        report.output = samples.map(|(p, &cluster)| ClusterSample { at: shown(*p), cluster }).collect();
        if work.steps >= MOST_STEPS {
            // Clusters were left in the middle of it: the arrangement stays as it was.
            levels.push(report);
            break;
        }
        let (new, of_cluster) = rebuilt(&output, &input, &relations, plane, go_on)?;
        board = new;
        report.clusters = [of_cluster.len(), of_cluster.iter().filter(|c| **c != NONE).count()];
        report.mended = mend(&mut board, params.seed, go_on)?;
        levels.push(report);
        last = Some((output, votes, of_cluster, scale.distance));
    }
    if standing.is_some() {
        let completed = complete(&mut board, params.seed, go_on)?;
        if let Some(level) = levels.last_mut() {
            level.mended.added += completed.added;
        }
    }
    // Beside elements that stand the neighbours say what belongs there.
    let is_balanced = params.variation > 0.0 && standing.is_none();
    let exchanged = if is_balanced { balance(&mut board, params.seed, go_on)? } else { 0 };
    if let Some(level) = levels.first_mut() {
        level.mended.moved += first.moved;
        level.mended.removed += first.removed;
        level.mended.added += first.added;
        level.mended.exchanged += exchanged;
    }
    let order = painting_order(&board, last.as_ref(), params, go_on)?;
    let copies = scene.places.len() / own.places.len();
    let is_shown = |e: &BoardElement| (e.place as usize) < scene.places.len();
    let elements = order
        .into_iter()
        .filter(is_shown)
        .map(|e| ClusteredElement { place: e.place as usize / copies, at: shown(e.at) });
    Ok(ClusterResult { elements: elements.collect(), levels })
}

/// A place of the plane in the unit of the exemplar, beside the canvas on the nearer side.
fn shown(
    at: [f64; 2],
    (plane, standing): (PeriodicPlane, Option<&StandingElements>),
    params: &ClusterParams,
    unit: f64,
) -> [f64; 2] {
    if let Some(standing) = standing {
        return [0, 1].map(|k| (at[k] + standing.window.low[k]) / unit);
    }
    std::array::from_fn(|k| {
        let size = params.size[k] * unit;
        let beyond = at[k] > 0.5 * (size + plane.size[k]);
        let at = if beyond && !params.tile[k] { at[k] - plane.size[k] } else { at[k] };
        at / unit
    })
}

/// Blocks, mended. Where they lose too much, as blocks of interlocking swatches do, they vary less.
fn first_arrangement<'a>(
    relations: &'a PlaceRelations<'a>,
    plane: PeriodicPlane,
    (period, params): (PeriodicPlane, &ClusterParams),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(Board<'a>, MendCounts)> {
    let variation = if is_regular(relations, period) { STRICT * params.variation } else { params.variation };
    go_on()?;
    if let Some(by) = relations.standing.as_ref().and_then(|s| s.copied) {
        let mut board = copy(relations, plane, by.map(|v| -v));
        let counts = mend(&mut board, params.seed, go_on)?;
        return Ok((board, counts));
    }
    let mut kept: Option<(f64, Board<'a>, MendCounts)> = None;
    for part in [1.0, 0.5, 0.2, 0.0] {
        let mut board = blocks(relations, plane, (variation * part, params.seed), go_on)?;
        let counts = mend(&mut board, params.seed, go_on)?;
        let fullness = board.fullness();
        if kept.as_ref().is_none_or(|k| fullness > k.0) {
            kept = Some((fullness, board, counts));
        }
        if params.variation == 0.0 || kept.as_ref().is_some_and(|k| k.0 >= FULL) {
            break;
        }
    }
    let (_, board, counts) =
        kept.unwrap_or_else(|| (0.0, Board::new(plane, relations), MendCounts::default()));
    Ok((board, counts))
}

/// Lengths of the levels: those of the paper, but no shorter than elements of the mean size need.
fn scales(relations: &PlaceRelations<'_>) -> [LevelScale; 3] {
    let places = &relations.exemplar.places;
    let area: f64 = places.iter().map(|p| f64::from(relations.area(p.figure))).sum();
    let mean = area / places.len() as f64;
    std::array::from_fn(|k| {
        let [distance, radius] = [LEVELS[k].distance * SIDE, LEVELS[k].radius * SIDE];
        let by = (libm::sqrt(mean / (PACKING * SAMPLES[k])) / distance).max(1.0);
        LevelScale { distance: by * distance, radius: by * radius }
    })
}

/// Refuses what is too large.
fn check(own: &ClusterExemplar, params: &ClusterParams, (unit, least): (f64, f64)) -> Result<()> {
    let page = own.page;
    let times = |k: usize| if page.wraps[k] { libm::ceil(least / page.size[k]).max(1.0) } else { 1.0 };
    let places = own.places.len() as f64 * times(0) * times(1);
    let count = own.places.len() as f64 * params.size[0] * params.size[1] * unit * unit / page.area();
    let small = (0..2).any(|k| params.tile[k] && params.size[k] * unit < least.min(2.0 * page.size[k]) * 0.5);
    let too_large = |what, name: &str, found: String, most: f64| {
        let limit = format!("{} thousand elements", most / 1e3);
        Err(Error::TooLarge { what, name: name.into(), found, limit })
    };
    if places > MOST_PLACES {
        let found = format!("{} elements that are repeated {} times", own.places.len(), times(0) * times(1));
        return too_large(Large::Drawing, "the drawing", found, MOST_PLACES);
    }
    if count > MOST_ELEMENTS {
        let found = format!("about {:.0} thousand elements", count / 1e3);
        return too_large(Large::Canvas, "size", found, MOST_ELEMENTS);
    }
    if small {
        return Err(Error::Parameter {
            name: "canvas",
            value: format!("{} x {} px", params.size[0], params.size[1]),
            allowed: "large enough for the largest element of the drawing beside a copy of itself".into(),
        });
    }
    Ok(())
}

/// The canvas with a margin along axes that do not repeat. It always repeats: what is beside it on one side is beside
/// it on the other.
fn canvas(own: &ClusterExemplar, params: &ClusterParams, unit: f64, largest: f64) -> PeriodicPlane {
    let size = std::array::from_fn(|k| {
        let size = params.size[k] * unit;
        if params.tile[k] {
            return size;
        }
        let wanted = (size + largest + LEVELS[0].radius * SIDE).max(2.2 * largest);
        let page = own.page.size[k];
        // A whole number of periods leaves a regular arrangement as it is.
        if own.page.wraps[k] { libm::ceil(wanted / page - 1e-9) * page } else { wanted }
    });
    PeriodicPlane { size, wraps: [true; 2] }
}

/// The iterations of one level.
pub(crate) fn level_of(
    mut output: OutputSamples,
    input: &InputSamples,
    (params, standing): (&ClusterParams, Option<&StandingElements>),
    work: &mut ClusterWork,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(OutputSamples, PairVotes, LevelReport)> {
    let mut report = LevelReport::default();
    let before_level = work.steps;
    let reach = LINKS * input.scale.distance;
    let mut iteration = 0;
    loop {
        let matches = search(&mut output, input, go_on)?;
        let energy = matches.energy();
        let before = report.energies.last().copied();
        report.energies.push(energy);
        improve_positions(&mut output, input, &matches, go_on)?;
        let added = add_missing(&mut output, input, &matches, standing);
        go_on()?;
        let votes = PairVotes::new(&output, input, &matches, reach);
        let (done, energies) = improve_clusters(&mut output, input, &votes, (params.without, work), go_on)?;
        report.cluster_energies.push(energies);
        report.added += added;
        report.operations.switched += done.switched;
        report.operations.merged += done.merged;
        report.operations.split += done.split;
        iteration += 1;
        let still = added == 0 && done == ClusterOperations::default();
        let settled = before.is_some_and(|b| (b - energy).abs() <= SETTLED * b);
        if iteration == ITERATIONS
            || work.steps >= MOST_STEPS
            || energy <= 1e-9 && still
            || settled && (still || iteration > ITERATIONS / 2)
        {
            report.samples = [input.len(), output.len()];
            report.steps = work.steps - before_level;
            return Ok((output, votes, report));
        }
    }
}

/// The elements in painting order.
fn painting_order(
    board: &Board<'_>,
    last: Option<&(OutputSamples, PairVotes, Vec<u32>, f64)>,
    params: &ClusterParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<BoardElement>> {
    let mut ids: Vec<usize> = (0..board.elements.len()).filter(|id| board.elements[*id].is_some()).collect();
    if params.without_depth {
        let mut all = board.standing();
        stream(params.seed, "cluster/order", 0).shuffle(&mut all);
        return Ok(all);
    }
    // Where nothing is known, the order is the exemplar's.
    ids.sort_by_key(|id| (board.elements[*id].map(|e| e.place), *id));
    let mut rank = vec![NONE; board.elements.len()];
    ids.iter().enumerate().for_each(|(k, id)| rank[*id] = k as u32);
    let mut voted: BTreeMap<[u32; 2], (f64, u32)> = BTreeMap::new();
    if let Some((output, votes, of_cluster, distance)) = last {
        // The cluster numbers are those after the last clustering, as are the elements'.
        let element = |s: usize| match of_cluster[output.cluster[s] as usize] {
            NONE => NONE,
            id => rank[id as usize],
        };
        let reach = OVERLAPS * distance;
        for s in 0..votes.near.len() {
            let a = element(s);
            for k in votes.near.range(s).take_while(|k| length(votes.near.ways[*k]) < reach) {
                let b = element(votes.near.ids[k] as usize);
                let [all, _, below] = votes.counts[k];
                // A pair counts once, from its lower number.
                if a != NONE && b != NONE && a < b && all > 0 {
                    let (sum, count) = voted.entry([a, b]).or_default();
                    *sum += f64::from(below) / f64::from(all);
                    *count += 1;
                }
            }
        }
    }
    go_on()?;
    let relations = board.relations;
    let mut preferences: BTreeMap<[u32; 2], f64> = BTreeMap::new();
    for (n, &id) in ids.iter().enumerate() {
        if usize::is_multiple_of(n, 64) {
            go_on()?;
        }
        let Some(element) = board.elements[id] else { continue };
        let figure = board.figure(element.place);
        for (other, there, way) in board.near(element.at, relations.reach[figure as usize] + board.largest) {
            let (a, b) = (rank[id], rank[other]);
            let there = board.figure(there.place);
            let meets =
                a < b && length(way) < relations.reach[figure as usize] + relations.reach[there as usize];
            if !meets || relations.overlap(figure, there, way) == 0 {
                continue;
            }
            let sure = match voted.get(&[a, b]) {
                Some((sum, count)) => sum / f64::from(*count),
                None => relations.beneath(figure, there).unwrap_or(0.5),
            };
            preferences.insert([a, b], sure);
        }
    }
    let order = ordered(ids.len(), &preferences);
    Ok(order.into_iter().filter_map(|k| board.elements[ids[k as usize]]).collect())
}
