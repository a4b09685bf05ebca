//! Coverage as in the exemplar, in both directions: textons are taken away from categories that
//! cover too much and added, where there is room, to those that cover too little.

use super::choice::Choice;
use super::clearance::Clearance;
use super::primaries::copy_penalty;
use super::target::TargetMap;
use crate::error::Result;
use crate::progress::{Progress, advance};
use crate::sampling::{Stream, stream};
use crate::scene::SynthParams;

/// A texton of which a smaller share is visible is taken away: it adds more pile-up than cover.
const LEAST_VISIBLE: f64 = 0.4;
/// Textons looked at for each one taken away.
const REMOVAL_CANDIDATES: usize = 12;
/// Failures after which more overlap is allowed.
const PATIENCE: u32 = 12;
/// Overlap allowed more each time, as a share of the texton's area.
const MORE_OVERLAP: f64 = 0.04;
/// How much a copy of the same texton nearby lowers a candidate's rank.
const COPY_PENALTY: f64 = 0.5;
/// How much a cell of overlap outweighs a cell of free ground.
const OVERLAP_COST: f64 = 3.0;
/// Share of a texton that has to be on the canvas for it to be added.
const LEAST_ON_CANVAS: f64 = 0.25;
/// Steps of the moves that improve a place, in pixels.
const STEPS: [i32; 3] = [4, 2, 1];

/// Name of the stage.
const STAGE: &str = "density";

/// How many textons were taken away and added.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    /// Taken away.
    pub(super) removed: u64,
    /// Added.
    pub(super) added: u64,
}

/// Brings the coverage of every category to what the exemplar has.
pub(super) fn correct(
    map: &mut TargetMap<'_>,
    choice: &mut Choice,
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<Counts> {
    let mut random = stream(params.seed, "synth/density", 0);
    let canvas = f64::from(params.width) * f64::from(params.height);
    let wanted: Vec<f64> = map.model().wanted.iter().map(|share| share * canvas).collect();
    let removed = thin(map, &wanted, &mut random);
    let added = grow(map, choice, &wanted, params, progress, &mut random)?;
    Ok(Counts { removed, added })
}

/// Takes away what is nearly hidden, then from every category what is too much.
fn thin(map: &mut TargetMap<'_>, wanted: &[f64], random: &mut Stream) -> u64 {
    let mut removed = 0;
    let mut standing: Vec<Vec<u32>> = vec![Vec::new(); wanted.len()];
    for id in 0..map.placed.len() as u32 {
        let p = map.placed[id as usize];
        if f64::from(p.visible) < LEAST_VISIBLE * f64::from(p.cells) || p.cells == 0 {
            map.remove(id);
            removed += 1;
        } else if cells_on_canvas(map, p.primary, p.at) > 0 {
            standing[map.model().shapes[p.primary as usize].category].push(id);
        }
    }
    for (category, textons) in standing.iter_mut().enumerate() {
        loop {
            let excess = map.covered[category] as f64 - wanted[category];
            // Of several drawn, the one that is hidden most; none that would leave a larger gap.
            let candidates: Vec<usize> =
                (0..REMOVAL_CANDIDATES.min(textons.len())).map(|_| random.index(textons.len())).collect();
            let hidden = |&k: &usize| {
                let p = map.placed[textons[k] as usize];
                1.0 - f64::from(p.visible) / f64::from(p.cells)
            };
            let fits = |&k: &usize| f64::from(map.placed[textons[k] as usize].visible) < 2.0 * excess;
            let best = candidates.into_iter().filter(fits).max_by(|a, b| hidden(a).total_cmp(&hidden(b)));
            let Some(k) = best else { break };
            map.remove(textons.swap_remove(k));
            removed += 1;
        }
    }
    removed
}

/// How many cells of a texton at a place are on the canvas.
fn cells_on_canvas(map: &TargetMap<'_>, primary: u32, at: [i32; 2]) -> u32 {
    let (m, w, h) = (map.margin, map.width, map.height);
    let spans = map.model().shapes[primary as usize].mask.spans().iter();
    let inside = spans.filter(|s| (m..h - m).contains(&(s.y + at[1])));
    inside.map(|s| ((s.x1 + at[0]).min(w - m) - (s.x0 + at[0]).max(m)).max(0) as u32).sum()
}

/// Adds textons in free space until every category covers what it should.
fn grow(
    map: &mut TargetMap<'_>,
    choice: &mut Choice,
    wanted: &[f64],
    params: &SynthParams,
    progress: &dyn Progress,
    random: &mut Stream,
) -> Result<u64> {
    let model = map.model();
    if model.members.iter().all(Vec::is_empty) {
        return Ok(0);
    }
    // Half the typical distance between textons, so that distances tell how far the middle of a
    // gap is from what stands around it.
    let reach = libm::round(0.5 / libm::sqrt(model.density().max(1e-9))).clamp(4.0, 40.0) as i32;
    let smallest: Vec<f64> = model
        .members
        .iter()
        .map(|m| m.iter().map(|&i| model.shapes[i as usize].area).min().map_or(f64::INFINITY, f64::from))
        .collect();
    // Centres may lie off the canvas, but not so far that most textons could not be seen.
    let whole = model.members.iter().flatten().map(|&i| f64::from(model.shapes[i as usize].area));
    let mean = whole.clone().sum::<f64>() / whole.count() as f64;
    let frame = (map.margin - libm::sqrt(mean / std::f64::consts::PI) as i32).max(0);
    let mut clearance = Clearance::new(map, reach, frame);
    let lack = |map: &TargetMap<'_>, c: usize| {
        let lack = wanted[c] - map.covered[c] as f64;
        if lack > 0.5 * smallest[c] { lack } else { 0.0 }
    };
    let total = |map: &TargetMap<'_>| (0..wanted.len()).map(|c| lack(map, c)).sum::<f64>();
    let begin = total(map);
    let (mut allowed, mut failures, mut added, mut attempts) = (0.02, 0, 0, 0u64);
    while allowed < 1.0 {
        if attempts % 256 == 0 {
            let done = (begin - total(map)).max(0.0) as u64;
            advance(progress, STAGE, done, begin as u64)?;
        }
        attempts += 1;
        let lacks: Vec<f64> = (0..wanted.len()).map(|c| lack(map, c)).collect();
        let Some(category) = random.weighted(lacks.iter().copied()) else { break };
        let most = 1.5 * lacks[category].max(smallest[category]);
        match candidate(map, choice, &clearance, category, most, params, random) {
            Some((primary, at, overlap)) if overlap <= allowed => {
                let id = map.stand(primary, at);
                clearance.add(map, id);
                choice.used(model, primary);
                added += 1;
                failures = 0;
            }
            _ => failures += 1,
        }
        if failures >= PATIENCE {
            (allowed, failures) = (allowed + MORE_OVERLAP, 0);
        }
    }
    advance(progress, STAGE, begin as u64, begin as u64)?;
    Ok(added)
}

/// The best of several textons of a category, each at a place of its own, moved to where it
/// overlaps least, and the share of it that overlaps. `most` bounds what it may add, in pixels.
fn candidate(
    map: &TargetMap<'_>,
    choice: &Choice,
    clearance: &Clearance,
    category: usize,
    most: f64,
    params: &SynthParams,
    random: &mut Stream,
) -> Option<(u32, [i32; 2], f64)> {
    let model = map.model();
    let mut best: Option<(f64, u32, [i32; 2])> = None;
    for _ in 0..params.candidates.div_ceil(2) {
        let primary = choice.draw(model, category, random)?;
        let at = clearance.draw(random)?;
        if f64::from(cells_on_canvas(map, primary, at)) > most {
            continue;
        }
        let value = fit(map, clearance, primary, at).0 - COPY_PENALTY * copy_penalty(map, primary, at);
        if best.is_none_or(|b| value > b.0) {
            best = Some((value, primary, at));
        }
    }
    let (_, primary, mut at) = best?;
    let (mut value, mut overlap) = fit(map, clearance, primary, at);
    for step in STEPS {
        for _ in 0..params.moves {
            let here = at;
            for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let there = [here[0] + dx * step, here[1] + dy * step];
                let (v, o) = fit(map, clearance, primary, there);
                if v > value {
                    (value, overlap, at) = (v, o, there);
                }
            }
            if at == here {
                break;
            }
        }
    }
    value.is_finite().then_some((primary, at, overlap))
}

/// How well a texton fits at a place: mean distance to what stands, as a share of the largest
/// told apart, less the share of it that overlaps, weighted; and that share alone. Only cells on
/// the canvas count, and a good part of the texton has to be there.
fn fit(map: &TargetMap<'_>, clearance: &Clearance, primary: u32, at: [i32; 2]) -> (f64, f64) {
    let (mut sum, mut taken, mut cells) = (0u32, 0u32, 0u32);
    for &span in map.model().shapes[primary as usize].mask.spans() {
        let row = &clearance.distance[map.canvas_part(&map.cells(span, at))];
        cells += row.len() as u32;
        for &d in row {
            sum += u32::from(d);
            taken += u32::from(d == 0);
        }
    }
    let area = map.model().shapes[primary as usize].area;
    if f64::from(cells) < LEAST_ON_CANVAS * f64::from(area) {
        return (f64::NEG_INFINITY, 1.0);
    }
    let share = |v: u32| f64::from(v) / f64::from(cells);
    (share(sum) / f64::from(clearance.limit) - OVERLAP_COST * share(taken), share(taken))
}
