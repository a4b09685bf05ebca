//! Primary textons by their descriptors (paper §3.2.1, algorithms 1 and 2).
//!
//! A region is the texton that a descriptor asked for: textons of one category that touch are
//! separate regions, so packed exemplars are matched stone by stone.

mod score;

use super::choice::Choice;
use super::target::TargetMap;
use crate::error::Result;
use crate::progress::{Progress, advance};
use crate::sampling::{Stream, stream};
use crate::scene::SynthParams;
use score::Scorer;

/// How much a copy of the same texton nearby lowers a candidate's rank, as a share of its area.
const COPY_PENALTY: f64 = 0.3;

/// Name of the stage.
const STAGE: &str = "placement";

/// What placement by descriptors did.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    /// Requests tried.
    pub(super) attempts: u64,
    /// Requests for which no candidate was good enough.
    pub(super) refused: u64,
}

/// Fills the map with textons until nothing is asked for any more.
pub(super) fn place(
    map: &mut TargetMap<'_>,
    choice: &mut Choice,
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<Counts> {
    let mut random = stream(params.seed, "synth/primaries", 0);
    let mut counts = Counts::default();
    let expected = (map.model().density() * f64::from(map.width) * f64::from(map.height)) as u64;
    let mut pictures = Pictures { shown: 0, expected };
    for seed in seeds(map, &mut random) {
        if map.state[map.index(seed[0], seed[1])] != super::model::UNDEFINED
            || !plant(map, choice, seed, &mut random)
        {
            continue;
        }
        while let Some(request) = map.draw_request(&mut random) {
            if counts.attempts % 256 == 0 {
                let done = map.placed.len() as u64;
                advance(progress, STAGE, done, expected.max(done))?;
                pictures.show(map, progress);
            }
            counts.attempts += 1;
            if !answer(map, choice, request, params, &mut random) {
                counts.refused += 1;
            }
        }
    }
    pictures.last(map, progress);
    let done = map.placed.len() as u64;
    advance(progress, STAGE, done, done)?;
    Ok(counts)
}

/// Places where to begin, in random order: the first is the beginning, the others serve where the
/// requests died out before they reached everything.
fn seeds(map: &TargetMap<'_>, random: &mut Stream) -> Vec<[i32; 2]> {
    let step = (map.model().half / 2).max(8);
    let inside = |size: i32| (map.margin + step / 2..size - map.margin).step_by(step as usize);
    let mut seeds: Vec<[i32; 2]> =
        inside(map.height).flat_map(|y| inside(map.width).map(move |x| [x, y])).collect();
    if seeds.is_empty() {
        seeds.push([map.width / 2, map.height / 2]);
    }
    random.shuffle(&mut seeds);
    seeds
}

/// Places a texton drawn by area; false if it would stand on another, or if there is none.
fn plant(map: &mut TargetMap<'_>, choice: &mut Choice, at: [i32; 2], random: &mut Stream) -> bool {
    let model = map.model();
    let areas = model.shapes.iter().map(|s| if s.placeable { f64::from(s.area) } else { 0.0 });
    let Some(primary) = random.weighted(areas) else { return false };
    let known = |i: usize| !matches!(map.state[i], super::model::UNDEFINED | super::model::EMPTY);
    let spans = model.shapes[primary].mask.spans();
    if spans.iter().any(|&s| map.cells(s, at).any(known)) {
        return false;
    }
    map.place(primary as u32, at);
    choice.used(model, primary as u32);
    true
}

/// Places the best of several textons for a request; false if none is good enough.
fn answer(
    map: &mut TargetMap<'_>,
    choice: &mut Choice,
    request: u32,
    params: &SynthParams,
    random: &mut Stream,
) -> bool {
    let model = map.model();
    let category = model.shapes[map.request_of(request).primary as usize].category;
    let region = map.region(request).cells;
    // The place drawn, and the middle of the region: most textons fit better there.
    let Some(drawn) = random.weighted(region.iter().map(|c| f64::from(c.1))) else {
        map.drop_request(request);
        return false;
    };
    let mean = |k: usize| region.iter().map(|c| i64::from(c.0[k])).sum::<i64>() / region.len() as i64;
    let places = [region[drawn].0, [mean(0) as i32, mean(1) as i32]];

    let scorer = Scorer::new(map, request, region.len() as u32, &params.weights);
    let mut best: Option<(f64, u32, [i32; 2])> = None;
    for _ in 0..params.candidates {
        let Some(primary) = choice.draw(model, category, random) else { break };
        let copy = copy_penalty(map, primary, places[0])
            * COPY_PENALTY
            * f64::from(model.shapes[primary as usize].area);
        for at in places {
            let score = scorer.score(primary, at) - copy;
            if best.is_none_or(|b| score > b.0) {
                best = Some((score, primary, at));
            }
        }
    }
    let Some((_, primary, mut at)) = best else {
        map.drop_request(request);
        return false;
    };
    let mut score = scorer.score(primary, at);
    for _ in 0..params.moves {
        let here = at;
        for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            let there = [here[0] + dx, here[1] + dy];
            let s = scorer.score(primary, there);
            if s > score {
                (score, at) = (s, there);
            }
        }
        if at == here {
            break;
        }
    }
    if score > 0.0 {
        map.place(primary, at);
        choice.used(model, primary);
    }
    // Answered or refused: what is left of it is not asked for again.
    map.drop_request(request);
    score > 0.0
}

/// How near the nearest copy of a texton is: 1 at the same place, 0 out of sight.
pub(super) fn copy_penalty(map: &TargetMap<'_>, primary: u32, at: [i32; 2]) -> f64 {
    let reach = map.model().half.clamp(1, 512);
    map.nearest_copy(primary, at, reach).map_or(0.0, |d| 1.0 - d / f64::from(reach))
}

/// Pictures of the target map at each quarter of the work.
struct Pictures {
    shown: u64,
    expected: u64,
}

impl Pictures {
    fn show(&mut self, map: &TargetMap<'_>, progress: &dyn Progress) {
        let quarter = (map.placed.len() as u64 * 4).checked_div(self.expected).unwrap_or(4).min(3);
        if quarter > self.shown {
            self.shown = quarter;
            self.picture(map, progress);
        }
    }

    fn last(&mut self, map: &TargetMap<'_>, progress: &dyn Progress) {
        self.shown = 4;
        self.picture(map, progress);
    }

    fn picture(&self, map: &TargetMap<'_>, progress: &dyn Progress) {
        let name = format!("target-map-{:03}", self.shown * 25);
        progress.picture(&name, &|| super::picture::target(map));
    }
}
