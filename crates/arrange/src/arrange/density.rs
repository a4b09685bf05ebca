//! Corrects the coverage of each category in both directions, zone by zone where the density varies.
//!
//! Where a category covers too much, a few of its textons are drawn at random and the one that is hidden most
//! and fitted worst is removed. Where categories cover too little, a texton is added at the place farthest
//! from placed elements, of a category drawn in proportion to its deficit, with the least overlap. More
//! overlap is allowed only when nothing else has worked.

use super::choice::MemberWeights;
use super::clearance::Clearance;
use super::grid::CellRun;
use super::model::{PlaceableId, VariantId};
use super::occupancy::{Occupancy, PlacedId};
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::sampling::{Stream, stream};
use vtex_scene::scene::{Ablation, SynthParams};

/// A texton with a smaller visible share is removed: it adds more overlap than coverage.
const LEAST_VISIBLE: f64 = 0.4;
/// Textons compared for each one that is removed.
const REMOVAL_CANDIDATES: usize = 12;
/// Failures after which more overlap is allowed.
const PATIENCE: u32 = 12;
/// Step by which the allowed overlap grows, as a share of the texton's area.
const MORE_OVERLAP: f64 = 0.04;
/// Penalty of a candidate's rank for a copy of the same texton nearby.
const COPY_PENALTY: f64 = 0.5;
/// Weight of a cell of overlap relative to a free cell.
const OVERLAP_COST: f64 = 3.0;
/// Weight of a bad fit for removal, relative to being hidden completely.
const MISFIT: f64 = 0.5;
/// Most overlap allowed, as a share of the texton's area.
const MOST_OVERLAP: f64 = 1.0;
/// Most places drawn until one suits the wanted category.
const PLACES: usize = 24;
/// Share of a texton that has to be on the canvas for it to be added.
const LEAST_ON_CANVAS: f64 = 0.25;
/// Steps of the moves that improve a place, in pixels.
const STEPS: [i32; 3] = [4, 2, 1];

/// Name of the stage.
const STAGE: &str = "density";

/// Numbers of textons removed and added.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DensityCounts {
    /// Taken away.
    pub(crate) removed: u64,
    /// Added.
    pub(crate) added: u64,
}

/// Corrects the coverage of every category to the wanted one.
pub(super) fn correct(
    map: &mut Occupancy<'_>,
    choice: &mut MemberWeights,
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<DensityCounts> {
    let mut counts = DensityCounts::default();
    if params.without(Ablation::Density) {
        return Ok(counts);
    }
    let mut random = stream(params.seed, "synth/density", 0);
    if (0..map.region.zone_count()).all(|zone| map.region.is_settled(zone)) {
        return Ok(counts);
    }
    let mut wanted = map.region.wanted(map.model());
    for (zone, wanted) in wanted.iter_mut().enumerate().filter(|(zone, _)| map.region.is_settled(*zone)) {
        *wanted = map.covered[zone].iter().map(|&cells| cells as f64).collect();
    }
    if map.region.zone_count() > 1 {
        map.count_overhang();
    }
    counts.removed = thin(map, &wanted, !params.without(Ablation::Removal), &mut random);
    if !params.without(Ablation::Growth) {
        counts.added = grow(map, choice, &wanted, params, progress, &mut random)?;
    }
    Ok(counts)
}

/// Removes textons that are nearly hidden, then the excess of every category; the worst textons first, or
/// random ones.
fn thin(map: &mut Occupancy<'_>, wanted: &[Vec<f64>], worst: bool, random: &mut Stream) -> u64 {
    let mut removed = 0;
    let categories = map.model().members.len();
    let mut standing: Vec<Vec<PlacedId>> = vec![Vec::new(); wanted.len() * categories];
    for id in (0..map.placed.len() as u32).map(PlacedId) {
        let p = *map.get(id);
        let zone = zone_of(map, p.variant, p.at);
        if p.removed || zone.is_some_and(|zone| map.region.is_settled(zone)) {
        } else if f64::from(p.visible) < LEAST_VISIBLE * f64::from(p.cells) || p.cells == 0 {
            map.remove(id);
            removed += 1;
        } else if let Some(zone) = zone {
            standing[zone * categories + map.model().element(p.variant).category].push(id);
        }
    }
    for (k, textons) in standing.iter_mut().enumerate() {
        let (zone, category) = (k / categories, k % categories);
        loop {
            let excess = map.covered[zone][category] as f64 - wanted[zone][category];
            let count = if worst { REMOVAL_CANDIDATES.min(textons.len()) } else { 1.min(textons.len()) };
            let candidates: Vec<usize> = (0..count).map(|_| random.index(textons.len())).collect();
            let badness = |&k: &usize| {
                let p = map.get(textons[k]);
                1.0 - f64::from(p.visible) / f64::from(p.cells) - MISFIT * f64::from(p.score)
            };
            // No texton is removed that would leave a gap larger than the excess. Where no texton is wanted
            // there are no gaps.
            let none = wanted[zone][category] <= 0.0;
            let fits = |&k: &usize| none || f64::from(map.get(textons[k]).visible) < 2.0 * excess;
            let best = candidates.into_iter().filter(fits).max_by(|a, b| badness(a).total_cmp(&badness(b)));
            let Some(k) = best else { break };
            map.remove(textons.swap_remove(k));
            removed += 1;
        }
    }
    removed
}

/// The zone of a texton: that of its origin, or of the first of its cells that is to be filled; `None` if it
/// is not visible.
fn zone_of(map: &Occupancy<'_>, variant: VariantId, at: [i32; 2]) -> Option<usize> {
    let zone = |i: usize| map.region.zone(i);
    if let Some(zone) = map.grid.canvas_cell(at).and_then(zone) {
        return Some(zone);
    }
    let spans = map.model().shape(variant).mask.spans().iter();
    spans.flat_map(|&s| map.grid.runs(s, at)).flat_map(|run| run.canvas).find_map(zone)
}

/// The deficit of every category in every zone.
struct Deficit<'w> {
    wanted: &'w [Vec<f64>],
    /// Area of the smallest texton of each category.
    smallest: Vec<f64>,
}

impl Deficit<'_> {
    /// Missing pixels of a category in a zone; zero if its smallest texton would cover too much.
    fn of(&self, map: &Occupancy<'_>, zone: usize, category: usize) -> f64 {
        let deficit = self.wanted[zone][category] - map.covered[zone][category] as f64;
        if deficit > 0.5 * self.smallest[category] { deficit } else { 0.0 }
    }

    /// The deficit of each category in each zone, zone by zone.
    fn all(&self, map: &Occupancy<'_>) -> Vec<f64> {
        let zones = 0..self.wanted.len();
        zones.flat_map(|z| (0..self.smallest.len()).map(move |c| self.of(map, z, c))).collect()
    }
}

/// Adds textons in free space until every category has its wanted coverage.
fn grow(
    map: &mut Occupancy<'_>,
    choice: &mut MemberWeights,
    wanted: &[Vec<f64>],
    params: &SynthParams,
    progress: &dyn Progress,
    random: &mut Stream,
) -> Result<u64> {
    let model = map.model();
    if model.members.iter().all(Vec::is_empty) {
        return Ok(0);
    }
    // Half the typical distance between textons, so that distances tell how far the middle of a gap is from
    // the textons around it.
    let reach = libm::round(0.5 / libm::sqrt(model.density().max(1e-9))).clamp(4.0, 40.0) as i32;
    let smallest =
        |m: &Vec<PlaceableId>| m.iter().map(|&p| model.plain(p).area).min().map_or(f64::INFINITY, f64::from);
    let deficit = Deficit { wanted, smallest: model.members.iter().map(smallest).collect() };
    // Centres may lie off the canvas, but not so far that most textons could not be seen.
    let outside = libm::sqrt(model.mean_area() / std::f64::consts::PI) as i32;
    let mut clearance = Clearance::new(map, reach, outside);
    let mut deficits = deficit.all(map);
    let begin: f64 = deficits.iter().sum();
    let (mut allowed, mut failures, mut added, mut attempts) = (0.02, 0, 0, 0u64);
    while allowed < MOST_OVERLAP {
        if attempts % 256 == 0 {
            let done = (begin - deficits.iter().sum::<f64>()).max(0.0) as u64;
            advance(progress, STAGE, done, begin as u64)?;
        }
        attempts += 1;
        let Some(k) = random.weighted(deficits.iter().copied()) else { break };
        let (zone, category) = (k / deficit.smallest.len(), k % deficit.smallest.len());
        let most = 1.5 * deficits[k].max(deficit.smallest[category]);
        match candidate(map, choice, &clearance, [zone, category], most, params, random) {
            Some((variant, at, overlap)) if overlap <= allowed => {
                let id = map.stand(variant, at, 0.0, |_| {});
                clearance.add(map, id);
                choice.used(model, variant);
                added += 1;
                failures = 0;
                deficits = deficit.all(map);
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

/// A free place in a zone where a library has a part. Places are drawn on the whole canvas until one suits.
fn free_place(
    map: &Occupancy<'_>,
    clearance: &Clearance,
    zone: usize,
    library: usize,
    random: &mut Stream,
) -> Option<[i32; 2]> {
    if map.region.is_plain() && !map.region.is_shared() {
        return clearance.draw(map, random);
    }
    for _ in 0..PLACES {
        let at = clearance.draw(map, random)?;
        let i = map.grid.index(at[0], at[1]);
        let suits = map.region.zone(i) == Some(zone) && map.region.admits(i, library);
        if suits && (!map.region.is_shared() || random.chance(map.region.shares(map.grid.point(at))[library]))
        {
            return Some(at);
        }
    }
    None
}

/// The best of several textons of a category, each at its own place in a zone, moved to where it overlaps
/// least, and its overlapping share. `most` limits the pixels that it may add.
fn candidate(
    map: &Occupancy<'_>,
    choice: &MemberWeights,
    clearance: &Clearance,
    [zone, category]: [usize; 2],
    most: f64,
    params: &SynthParams,
    random: &mut Stream,
) -> Option<(VariantId, [i32; 2], f64)> {
    let model = map.model();
    let mut best: Option<(f64, VariantId, [i32; 2])> = None;
    for _ in 0..params.candidates.div_ceil(2) {
        let element = choice.draw(model, category, random)?;
        let variant = model.draw_variant(element, random);
        let Some(at) = free_place(map, clearance, zone, model.element(variant).library, random) else {
            continue;
        };
        if f64::from(map.cells_inside(variant, at)) > most {
            continue;
        }
        let mut value = fit(map, clearance, variant, at).0;
        if !params.without(Ablation::Copies) {
            value -= COPY_PENALTY * map.copy_nearness(element, at);
        }
        if best.is_none_or(|b| value > b.0) {
            best = Some((value, variant, at));
        }
    }
    let (_, variant, mut at) = best?;
    let (mut value, mut overlap) = fit(map, clearance, variant, at);
    for step in STEPS {
        for _ in 0..params.moves {
            let here = at;
            for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let there = [here[0] + dx * step, here[1] + dy * step];
                let (v, o) = fit(map, clearance, variant, there);
                if v > value {
                    (value, overlap, at) = (v, o, there);
                }
            }
            if at == here {
                break;
            }
        }
    }
    value.is_finite().then_some((variant, at, overlap))
}

/// How well a texton fits at a place: mean distance to placed textons, as a share of the largest stored
/// distance, minus the weighted overlapping share; and the overlapping share. Only cells on the canvas count,
/// and a large part of the texton has to be there. Cells in which its library has no part count as
/// overlapped.
fn fit(map: &Occupancy<'_>, clearance: &Clearance, variant: VariantId, at: [i32; 2]) -> (f64, f64) {
    const NOT_THERE: (f64, f64) = (f64::NEG_INFINITY, 1.0);
    if !map.allows(variant, at) {
        return NOT_THERE;
    }
    let (mut sum, mut taken, mut cells) = (0u32, 0u32, 0u32);
    let shape = map.model().shape(variant);
    let library = map.model().element(variant).library;
    let plain = map.region.is_plain() && !map.region.is_shared();
    for CellRun { canvas, .. } in shape.mask.spans().iter().flat_map(|&s| map.grid.runs(s, at)) {
        if plain {
            let row = &clearance.distance[canvas];
            cells += row.len() as u32;
            for &d in row {
                sum += u32::from(d);
                taken += u32::from(d == 0);
            }
            continue;
        }
        for i in canvas.filter(|&i| map.region.zone(i).is_some()) {
            let d = if map.region.admits(i, library) { clearance.distance[i] } else { 0 };
            cells += 1;
            sum += u32::from(d);
            taken += u32::from(d == 0);
        }
    }
    if cells == 0 || f64::from(cells) < LEAST_ON_CANVAS * f64::from(shape.area) {
        return NOT_THERE;
    }
    let share = |v: u32| f64::from(v) / f64::from(cells);
    (share(sum) / f64::from(clearance.limit) - OVERLAP_COST * share(taken), share(taken))
}
