//! Placement by descriptors (paper §3.2.1, algorithms 1 and 2).
//!
//! A region is the texton that a descriptor asked for: textons of one category that touch are
//! separate regions, so packed exemplars are matched stone by stone.
//!
//! # What an attempt costs, and why few fail
//!
//! The paper draws a cell of the map for each attempt, finds its region anew, scores twenty
//! candidates, and leaves the map as it is when none is good enough: four of five attempts fail,
//! most of them where others have failed before. Here
//!
//! * a request keeps its cells, so its region is found by visiting the cells of one texton;
//! * a request is drawn by its weight from running sums, and is tried once: answered or refused, it is not
//!   asked for again. A second attempt would only try other candidates of the same category; missing coverage
//!   is corrected by [`super::density`];
//! * a request is dropped as soon as other elements cover more than half of it: any element that answered it
//!   would overlap them;
//! * candidates are tried at the place drawn and in the middle of the region, where most fit best;
//! * a candidate whose upper bound, which follows from its size, is below the best score is skipped. This
//!   does not change the choice.
//!
//! So the cost of an attempt does not depend on the size of the canvas.

pub(super) mod bands;
mod score;
mod target;

use super::choice::MemberWeights;
use super::model::{EMPTY, PlaceableId, UNDEFINED, VariantId};
use super::occupancy::{Occupancy, PlacedId, RequestId};
use super::picture;
use bands::{Bands, WindowChanges};
use score::Scorer;
use std::sync::atomic::{AtomicU64, Ordering};
use target::TargetMap;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::sampling::{Stream, stream};
use vtex_scene::scene::{Ablation, SynthParams};

/// Penalty of a candidate's rank for a copy of the same texton nearby, as a share of its area.
const COPY_PENALTY: f64 = 0.3;

/// Name of the stage.
const STAGE: &str = "placement";

/// Counts of placement by descriptors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DescriptorCounts {
    /// Requests tried.
    pub(crate) attempts: u64,
    /// Requests for which no candidate was good enough.
    pub(crate) refused: u64,
}

impl DescriptorCounts {
    fn add(&mut self, other: &Self) {
        self.attempts += other.attempts;
        self.refused += other.refused;
    }
}

/// Windows filled before their results are put together.
const BATCH: usize = 4;

/// The requests that an element already placed makes with its descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InitialRequests {
    /// None.
    None,
    /// All, but they are dropped: the requested cells stay empty.
    Dropped,
    /// All.
    Open,
}

/// Fills the undefined cells until no request is left. `initial` says for each element already placed which
/// requests it makes.
pub(super) fn place<'a>(
    cells: Occupancy<'a>,
    initial: &[InitialRequests],
    choice: &mut MemberWeights,
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<(Occupancy<'a>, DescriptorCounts)> {
    let mut counts = DescriptorCounts::default();
    if !cells.state.contains(&UNDEFINED) {
        return Ok((cells, counts));
    }
    let mut map = TargetMap::new(cells);
    let with = |requests: InitialRequests| {
        let ids = (0..).map(PlacedId).zip(initial);
        ids.filter(move |(_, own)| **own == requests).map(|(id, _)| id)
    };
    with(InitialRequests::Open).for_each(|id| map.write_descriptor(id));
    let open = map.requests.len();
    with(InitialRequests::Dropped).for_each(|id| map.write_descriptor(id));
    (open..map.requests.len()).for_each(|i| map.drop_request(RequestId(i as u32)));

    let watch = DescriptorProgress::new(&map, progress);
    let bands = if params.without(Ablation::Seeds) { None } else { Bands::new(map.model(), map.grid()) };
    if let Some(bands) = bands {
        for first in 0..2 {
            let every_second: Vec<usize> = (first..bands.cores.len()).step_by(2).collect();
            for batch in every_second.chunks(BATCH) {
                let filled = parallel::map(batch, |&band| {
                    let mut window = bands.window(&map, band);
                    let mut random = stream(params.seed, "synth/primaries", 1 + band as u64);
                    let mut choice = choice.clone();
                    let counts = fill(&mut window.map, &mut choice, params, &watch, &mut random)?;
                    Ok((window.changes(&map), counts))
                });
                let filled: Vec<(WindowChanges, DescriptorCounts)> =
                    filled.into_iter().collect::<Result<_>>()?;
                filled.iter().for_each(|(_, c)| counts.add(c));
                map.absorb(filled.into_iter().map(|f| f.0).collect(), choice);
                watch.picture(&map);
            }
        }
    }
    // Fills all of the map, or the requests that are left across the bands.
    let mut random = stream(params.seed, "synth/primaries", 0);
    counts.add(&fill(&mut map, choice, params, &watch, &mut random)?);
    watch.finish(&map)?;
    Ok((map.cells, counts))
}

/// Answers the requests of a map or a window until none is left. Starts at random places.
fn fill(
    map: &mut TargetMap<'_>,
    choice: &mut MemberWeights,
    params: &SynthParams,
    watch: &DescriptorProgress<'_>,
    random: &mut Stream,
) -> Result<DescriptorCounts> {
    let mut counts = DescriptorCounts::default();
    let mut seeds = seeds(map, random);
    if params.without(Ablation::Seeds) {
        seeds.truncate(1);
    }
    // Textons already placed may have made requests before any is inserted.
    for seed in std::iter::once(None).chain(seeds.into_iter().map(Some)) {
        if let Some([x, y]) = seed
            && (map.cells.state[map.grid().index(x, y)] != UNDEFINED || !insert(map, choice, [x, y], random))
        {
            continue;
        }
        while let Some(request) = map.draw_request(random) {
            if counts.attempts % 256 == 0 {
                watch.advance()?;
            }
            counts.attempts += 1;
            if answer(map, choice, request, params, random) {
                watch.placed.fetch_add(1, Ordering::Relaxed);
            } else {
                counts.refused += 1;
            }
        }
    }
    Ok(counts)
}

/// Starting places in random order. Those after the first are used where requests ended before the whole map
/// was filled.
fn seeds(map: &TargetMap<'_>, random: &mut Stream) -> Vec<[i32; 2]> {
    let step = (map.model().half / 2).max(8);
    let inside = |size: i32, margin: i32| (margin + step / 2..size - margin).step_by(step as usize);
    let [mx, my] = map.grid().margin;
    let columns = || inside(map.grid().width, mx);
    let mut seeds: Vec<[i32; 2]> =
        inside(map.grid().height, my).flat_map(|y| columns().map(move |x| [x, y])).collect();
    if seeds.is_empty() {
        seeds.push([map.grid().width / 2, map.grid().height / 2]);
    }
    seeds.retain(|&at| map.cells.inside(at) && map.core.as_ref().is_none_or(|core| core.contains(&at[1])));
    random.shuffle(&mut seeds);
    seeds
}

/// Places a texton drawn by area; `false` if it would overlap another, or if there is none.
fn insert(map: &mut TargetMap<'_>, choice: &mut MemberWeights, at: [i32; 2], random: &mut Stream) -> bool {
    let model = map.model();
    let library = map.cells.region.draw_library(map.grid().point(at), random);
    let source = &model.sources[library];
    let area = |i: u32| {
        let element = PlaceableId(i);
        if model[element].placeable { f64::from(model.plain(element).area) } else { 0.0 }
    };
    let Some(drawn) = random.weighted(source.elements.clone().map(area)) else { return false };
    let variant = model.draw_variant(PlaceableId(source.elements.start + drawn as u32), random);
    let cells = &map.cells;
    let known = |i: usize| !matches!(cells.state[i], UNDEFINED | EMPTY) || !cells.region.admits(i, library);
    let spans = model.shape(variant).mask.spans();
    if !cells.allows(variant, at) || spans.iter().flat_map(|&s| cells.grid.cells(s, at)).flatten().any(known)
    {
        return false;
    }
    map.place(variant, at, 0.0);
    choice.used(model, variant);
    true
}

/// Places the best of several textons for a request; `false` if none is good enough.
fn answer(
    map: &mut TargetMap<'_>,
    choice: &mut MemberWeights,
    request: RequestId,
    params: &SynthParams,
    random: &mut Stream,
) -> bool {
    let model = map.model();
    let region = map.cells_of(request);
    // The place drawn, and the middle of the region: most textons fit better there.
    let Some(drawn) = random.weighted(region.iter().map(|c| f64::from(c.1))) else {
        map.drop_request(request);
        return false;
    };
    let mean = |k: usize| region.iter().map(|c| i64::from(c.0[k])).sum::<i64>() / region.len() as i64;
    let places = [region[drawn].0, [mean(0) as i32, mean(1) as i32]];
    let strict = params.without(Ablation::Overlap);
    let scorer = Scorer::new(map, request, region.len() as u32, &params.weights, strict);
    let Some(candidate) = best_candidate(map, &scorer, choice, request, places, params, random) else {
        map.drop_request(request);
        return false;
    };
    let moves = if params.without(Ablation::Improve) { 0 } else { params.moves };
    let RequestCandidate { variant, at, score } = candidate.improved(&scorer, moves);
    if score > 0.0 {
        map.place(variant, at, (score / f64::from(model.shape(variant).area)) as f32);
        choice.used(model, variant);
    }
    // Answered or refused: the rest of the request is not tried again.
    map.drop_request(request);
    score > 0.0
}

/// A texton at a place where it may answer a request.
#[derive(Clone, Copy)]
struct RequestCandidate {
    variant: VariantId,
    at: [i32; 2],
    score: f64,
}

/// The best of several textons drawn for a request, at one of two places. Copies of near textons rank lower.
fn best_candidate(
    map: &TargetMap<'_>,
    scorer: &Scorer<'_, '_>,
    choice: &MemberWeights,
    request: RequestId,
    places: [[i32; 2]; 2],
    params: &SynthParams,
    random: &mut Stream,
) -> Option<RequestCandidate> {
    let model = map.model();
    let requested = *model.element(map.get(request).variant);
    // Where libraries meet, the library of the texton is drawn by their shares.
    let library = map.cells.region.draw_library(map.grid().point(places[1]), random);
    let categories = &model.sources[library].categories;
    let covers = categories.clone().map(|c| model.wanted[c]);
    let mut best: Option<RequestCandidate> = None;
    for _ in 0..params.candidates {
        let category = if library == requested.library {
            requested.category
        } else {
            let Some(drawn) = random.weighted(covers.clone()) else { break };
            categories.start + drawn
        };
        let Some(element) = choice.draw(model, category, random) else { break };
        let variant = model.draw_variant(element, random);
        let bound = scorer.bound(variant);
        if best.is_some_and(|b| bound <= b.score) {
            continue;
        }
        let mut penalty = 0.0;
        if !params.without(Ablation::Copies) {
            let nearness = map.cells.copy_nearness(element, places[0]);
            penalty = nearness * COPY_PENALTY * f64::from(model.shape(variant).area);
        }
        if best.is_some_and(|b| bound - penalty <= b.score) {
            continue;
        }
        for at in places {
            let score = scorer.score(variant, at) - penalty;
            if best.is_none_or(|b| score > b.score) {
                best = Some(RequestCandidate { variant, at, score });
            }
        }
    }
    best
}

impl RequestCandidate {
    /// The candidate after moves by one cell that improve its score, which then has no penalty.
    fn improved(self, scorer: &Scorer<'_, '_>, moves: u32) -> Self {
        let Self { variant, mut at, .. } = self;
        let mut score = scorer.score(variant, at);
        for _ in 0..moves {
            let here = at;
            for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let there = [here[0] + dx, here[1] + dy];
                let moved = scorer.score(variant, there);
                if moved > score {
                    (score, at) = (moved, there);
                }
            }
            if at == here {
                break;
            }
        }
        Self { variant, at, score }
    }
}

/// Reports the work as it goes on.
struct DescriptorProgress<'p> {
    progress: &'p dyn Progress,
    placed: AtomicU64,
    expected: u64,
    pictures: AtomicU64,
}

impl<'p> DescriptorProgress<'p> {
    fn new(map: &TargetMap<'_>, progress: &'p dyn Progress) -> Self {
        let expected = (map.model().density() * map.grid().len() as f64) as u64;
        Self { progress, placed: AtomicU64::new(0), expected, pictures: AtomicU64::new(0) }
    }

    fn advance(&self) -> Result<()> {
        let done = self.placed.load(Ordering::Relaxed);
        advance(self.progress, STAGE, done, self.expected.max(done))
    }

    /// A picture of the target map as it is.
    fn picture(&self, map: &TargetMap<'_>) {
        let name = format!("target-map-{}", self.pictures.fetch_add(1, Ordering::Relaxed) + 1);
        self.progress.picture(&name, &|| picture::target(&map.cells));
    }

    fn finish(&self, map: &TargetMap<'_>) -> Result<()> {
        self.picture(map);
        let done = self.placed.load(Ordering::Relaxed);
        advance(self.progress, STAGE, done, done)
    }
}
