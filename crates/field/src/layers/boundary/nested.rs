//! Regions made one after the other, each within the one below (the paper, §3.3).

use super::super::map::LayerRegion;
use super::SIDES;
use super::assignment::Assigned;
use super::patches::BorderWindows;
use super::pyramid::{doubled, halved};
use super::shape::{BoundaryModel, Bounds, Votes, fill, optimise};
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::blur::Plane;
use vtex_base::sampling::stream;

/// Most levels.
const LEVELS: usize = 3;
/// Area within which a region may grow, as a multiple of its own.
const GROWTH: f64 = 1.5;

/// The regions to make.
pub(in super::super) struct Job<'a> {
    /// Regions of the exemplar from S_1 up.
    pub(in super::super) exemplar: &'a [LayerRegion],
    pub(in super::super) size: [usize; 2],
    pub(in super::super) wrap: [bool; 2],
    /// Share of the canvas that each region covers.
    pub(in super::super) shares: &'a [f64],
    pub(in super::super) start: Start<'a>,
    pub(in super::super) seed: u64,
}

/// The initial regions.
pub(in super::super) enum Start<'a> {
    /// Random regions.
    Random,
    /// Regions from S_1 up. Only the free cells change, and start at random.
    Hole { regions: &'a [LayerRegion], free: &'a [bool] },
}

/// One level of the canvas.
struct BoundaryLevel {
    size: [usize; 2],
    /// Cells that may change.
    free: Option<Vec<bool>>,
    /// Regions that are kept in all other cells.
    kept: Vec<LayerRegion>,
}

/// A region on one level after its optimisation.
struct OptimisedRegion {
    region: LayerRegion,
    last: Option<(BorderWindows, Vec<Assigned>)>,
}

/// Makes the regions from S_1 up on the cells of a canvas.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(in super::super) fn nested(job: &Job<'_>, progress: &dyn Progress) -> Result<Vec<LayerRegion>> {
    let levels = levels(job);
    let mut below: Option<Vec<OptimisedRegion>> = None;
    let mut found = Vec::new();
    let mut models: Option<Vec<BoundaryModel>> = None;
    for (k, exemplar) in job.exemplar.iter().enumerate() {
        let own = pyramid(exemplar, levels.len());
        let own: Vec<BoundaryModel> =
            own.into_iter().enumerate().map(|(l, region)| BoundaryModel::new(region, side(l))).collect();
        let mut done: Vec<OptimisedRegion> = Vec::new();
        for level in (0..levels.len()).rev() {
            advance(
                progress,
                "borders",
                (k * levels.len() + levels.len() - 1 - level) as u64,
                (job.exemplar.len() * levels.len()) as u64,
            )?;
            let BoundaryLevel { size, free, kept } = &levels[level];
            let cells = size[0] * size[1];
            let area = libm::round(job.shares[k] * cells as f64) as usize;
            let coarser = done.last().map(|d| doubled(&d.region, *size));
            // The levels of the region below are listed from the coarsest.
            let under = below.as_ref().map(|b| &b[levels.len() - 1 - level]);
            let mut random = stream(job.seed, "layers/boundary", (k * LEVELS + level) as u64);
            let values = match (under, &models) {
                (Some(under), Some(models)) => {
                    let start = coarser.clone().unwrap_or_else(|| noise(job, *size, level, k, area));
                    seeded(under, &models[level], &own[level], &start)
                }
                _ => match &coarser {
                    Some(coarser) => coarser.inside.iter().map(|&v| if v { 1.0 } else { 0.0 }).collect(),
                    None => noise_values(job, *size, level, k),
                },
            };
            let mut region = LayerRegion { size: *size, wrap: job.wrap, inside: vec![false; cells] };
            let mut changeable = free.clone();
            if let Some(free) = free {
                (0..cells).filter(|&i| !free[i]).for_each(|i| region.inside[i] = kept[k].inside[i]);
            }
            if let Some(under) = under {
                // The region may only grow inside the region below, where votes for it are highest.
                let most = libm::ceil(GROWTH * area as f64) as usize;
                let mut wide = LayerRegion { inside: under.region.inside.clone(), ..region.clone() };
                fill(&mut wide, &values, &Bounds { free: Some(&under.region.inside), area: most });
                let grows: Vec<bool> = (0..cells)
                    .map(|i| {
                        under.region.inside[i] && wide.inside[i] && changeable.as_ref().is_none_or(|m| m[i])
                    })
                    .collect();
                changeable = Some(grows);
            }
            let bounds = Bounds { free: changeable.as_deref(), area };
            fill(&mut region, &values, &bounds);
            let last = optimise(&mut region, &own[level], &bounds, &mut random);
            done.push(OptimisedRegion { region, last });
        }
        found.push(done[done.len() - 1].region.clone());
        (below, models) = (Some(done), Some(own));
    }
    Ok(found)
}

/// Side of the windows on a level.
fn side(level: usize) -> usize {
    SIDES[usize::from(level > 0)]
}

/// The levels of a region, from the finest.
pub(super) fn pyramid(region: &LayerRegion, levels: usize) -> Vec<LayerRegion> {
    let mut all = vec![region.clone()];
    while all.len() < levels {
        all.push(halved(&all[all.len() - 1]));
    }
    all
}

/// The levels of the canvas, from the finest; fewer if the canvas or the exemplar is small.
fn levels(job: &Job<'_>) -> Vec<BoundaryLevel> {
    let shortest = job.exemplar.iter().flat_map(|r| r.size).chain(job.size).min().unwrap_or(1);
    let count = (0..LEVELS).take_while(|l| shortest >> l >= 16).count().max(1);
    let mut all: Vec<BoundaryLevel> = Vec::new();
    for level in 0..count {
        let before = all.last();
        let size = before.map_or(job.size, |l| l.size.map(|v| v.div_ceil(2)));
        let next = match (&job.start, before) {
            (Start::Random, _) => BoundaryLevel { size, free: None, kept: Vec::new() },
            (Start::Hole { regions, free }, None) => {
                BoundaryLevel { size, free: Some(free.to_vec()), kept: regions.to_vec() }
            }
            (Start::Hole { .. }, Some(fine)) => {
                // A cell that holds a free cell is free.
                let mut free = vec![false; size[0] * size[1]];
                for (i, _) in fine.free.iter().flatten().enumerate().filter(|(_, free)| **free) {
                    free[i / fine.size[0] / 2 * size[0] + i % fine.size[0] / 2] = true;
                }
                let kept = fine.kept.iter().map(halved).collect();
                BoundaryLevel { size, free: Some(free), kept }
            }
        };
        debug_assert_eq!(level, all.len());
        all.push(next);
    }
    all
}

/// Values of blurred noise.
fn noise_values(job: &Job<'_>, size: [usize; 2], level: usize, k: usize) -> Vec<f32> {
    let mut random = stream(job.seed, "layers/boundary/start", (k * LEVELS + level) as u64);
    let values = (0..size[0] * size[1]).map(|_| random.normal() as f32).collect();
    Plane { size, values }.blurred(2.0, job.wrap).values
}

/// A random region of the given area.
fn noise(job: &Job<'_>, size: [usize; 2], level: usize, k: usize, area: usize) -> LayerRegion {
    let values = noise_values(job, size, level, k);
    let mut region = LayerRegion { size, wrap: job.wrap, inside: vec![false; values.len()] };
    fill(&mut region, &values, &Bounds { free: None, area });
    region
}

/// Share of the votes that put each cell inside the next region. The windows last assigned to the region
/// below vote with the exemplar's next region at their places. Cells without votes keep their state in
/// `start`. Cells outside the region below rank last.
fn seeded(
    under: &OptimisedRegion,
    below: &BoundaryModel,
    own: &BoundaryModel,
    start: &LayerRegion,
) -> Vec<f32> {
    let votes = under
        .last
        .as_ref()
        .map(|(patches, assigned)| Votes::new(&under.region, patches, assigned, below, &own.region));
    let value = |i: usize| {
        let was = if start.inside[i] { 1.0 } else { 0.0 };
        let share = votes.as_ref().and_then(|v| v.share(i)).unwrap_or(was);
        if under.region.inside[i] { share } else { share - 10.0 }
    };
    (0..start.inside.len()).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::testing;
    use super::super::patches::shape_distance;
    use super::*;

    fn regions(size: [usize; 2], count: usize, seed: u64) -> Vec<LayerRegion> {
        let map = testing::nested(size, count, seed);
        let region = |k: usize| {
            let inside = map.labels.iter().map(|&l| l as usize >= k).collect();
            LayerRegion { size, wrap: [false; 2], inside }
        };
        (1..count).map(region).collect()
    }

    fn shares(regions: &[LayerRegion]) -> Vec<f64> {
        regions.iter().map(|r| r.area() as f64 / r.inside.len() as f64).collect()
    }

    #[test]
    fn regions_are_nested_and_of_the_area_wanted() {
        let exemplar = regions([64, 64], 3, 1);
        let shares = shares(&exemplar);
        for wrap in [[false; 2], [true; 2]] {
            let job = Job {
                exemplar: &exemplar,
                size: [128, 120],
                wrap,
                shares: &shares,
                start: Start::Random,
                seed: 3,
            };
            let made = nested(&job, &()).unwrap();
            assert_eq!(made.len(), 2);
            for (region, share) in made.iter().zip(&shares) {
                let own = region.area() as f64 / region.inside.len() as f64;
                assert!((own - share).abs() < 0.01, "{own} {share}");
            }
            assert!((0..128 * 120).all(|i| made[0].inside[i] || !made[1].inside[i]));
            assert!(wrap[0] || nested(&job, &()).unwrap() == made);
            let d = shape_distance(&made[0], &exemplar[0]);
            assert!(d < 25.0, "{d}");
        }
    }

    #[test]
    fn outside_a_hole_nothing_changes() {
        let exemplar = regions([64, 64], 3, 2);
        let old = regions([80, 70], 3, 5);
        let free: Vec<bool> =
            (0..80 * 70).map(|i| (20..50).contains(&(i % 80)) && (15..45).contains(&(i / 80))).collect();
        let shares = shares(&old);
        let start = Start::Hole { regions: &old, free: &free };
        let job =
            Job { exemplar: &exemplar, size: [80, 70], wrap: [false; 2], shares: &shares, start, seed: 1 };
        let made = nested(&job, &()).unwrap();
        for (own, theirs) in made.iter().zip(&old) {
            assert!((0..80 * 70).all(|i| free[i] || own.inside[i] == theirs.inside[i]));
            assert!((own.area() as f64 / theirs.area() as f64 - 1.0).abs() < 0.02);
        }
        assert!((0..80 * 70).all(|i| made[0].inside[i] || !made[1].inside[i]));
    }
}
