//! One region on one level: windows vote on which pixels are inside (the paper, §3.2).

use super::super::map::LayerRegion;
use super::assignment::{Assigned, assign};
use super::patches::{BorderWindows, shown, turned};
use vtex_base::sampling::Stream;

/// Most iterations on a level.
const ITERATIONS: usize = 8;
/// Iterations end when fewer pixels change than this share of the border's.
const SETTLED: f64 = 1e-3;

/// An exemplar's region on one level.
pub(super) struct BoundaryModel {
    pub(super) region: LayerRegion,
    pub(super) patches: BorderWindows,
    /// Permitted rotations of windows, in quarter turns.
    pub(super) turns: Vec<usize>,
}

impl BoundaryModel {
    pub(super) fn new(region: LayerRegion, side: usize) -> Self {
        let patches = BorderWindows::new(&region, side);
        let turns = if has_direction(&region) { vec![0, 2] } else { vec![0, 1, 2, 3] };
        Self { region, patches, turns }
    }
}

/// Whether borders run mainly along one axis.
fn has_direction(region: &LayerRegion) -> bool {
    let [w, h] = region.size;
    let differs = |i: usize, j: usize| usize::from(region.inside[i] != region.inside[j]);
    let across: usize = (0..w * h).filter(|i| (i + 1) % w != 0).map(|i| differs(i, i + 1)).sum();
    let down: usize = (0..w * (h - 1)).map(|i| differs(i, i + w)).sum();
    across.max(down) > across.min(down) + across.min(down) / 4
}

/// Votes of windows on each pixel.
pub(super) struct Votes {
    pub(super) inside: Vec<f32>,
    pub(super) outside: Vec<f32>,
}

impl Votes {
    /// Votes of the windows assigned to a border. Each shows `read` at the place of its exemplar window,
    /// weighted by how well the windows agree and by the distance to their centres.
    pub(super) fn new(
        region: &LayerRegion,
        patches: &BorderWindows,
        assigned: &[Assigned],
        model: &BoundaryModel,
        read: &LayerRegion,
    ) -> Self {
        let side = patches.side;
        let pixels = region.inside.len();
        let mut votes = Self { inside: vec![0.0; pixels], outside: vec![0.0; pixels] };
        let sigma = side as f32 / 2.0;
        let reach = (side / 2) as i64;
        let near: Vec<f32> = (0..side * side)
            .map(|i| {
                let d = [(i % side) as i64 - reach, (i / side) as i64 - reach];
                libm::expf(-((d[0] * d[0] + d[1] * d[1]) as f32) / (2.0 * sigma * sigma))
            })
            .collect();
        let turns: Vec<Vec<usize>> = (0..4).map(|turn| turned(side, turn).collect()).collect();
        let mut from = vec![false; side * side];
        for (&pixel, a) in patches.at.iter().zip(assigned) {
            let middle = model.patches.at[a.patch as usize] as usize;
            for (i, q) in shown(read, middle, side).enumerate() {
                from[turns[usize::from(a.turn)][i]] = read.inside[q];
            }
            let trust = 1.0 / (1.0 + a.cost as f32);
            for (i, q) in shown(region, pixel as usize, side).enumerate() {
                let to = if from[i] { &mut votes.inside } else { &mut votes.outside };
                to[q] += trust * near[i];
            }
        }
        votes
    }

    /// Share of the votes for inside; `None` without votes.
    pub(super) fn share(&self, pixel: usize) -> Option<f32> {
        let all = self.inside[pixel] + self.outside[pixel];
        (all > 1e-7).then(|| self.inside[pixel] / all)
    }
}

/// The pixels that may change, and the area to reach.
pub(super) struct Bounds<'a> {
    /// Pixels that may change; `None` if all may.
    pub(super) free: Option<&'a [bool]>,
    /// Number of pixels inside at the end.
    pub(super) area: usize,
}

/// Makes the border of a region look like that of a model. Returns the last assignment, if there is one.
pub(super) fn optimise(
    region: &mut LayerRegion,
    model: &BoundaryModel,
    bounds: &Bounds<'_>,
    random: &mut Stream,
) -> Option<(BorderWindows, Vec<Assigned>)> {
    let mut last = None;
    for _ in 0..ITERATIONS {
        let patches = BorderWindows::new(region, model.patches.side);
        let assigned = assign(&patches, &model.patches, &model.turns, random);
        if assigned.is_empty() {
            break;
        }
        let votes = Votes::new(region, &patches, &assigned, model, &model.region);
        let value = |i: usize| match (votes.share(i), region.inside[i]) {
            (Some(share), _) => share,
            (None, true) => 2.0,
            (None, false) => -1.0,
        };
        let values: Vec<f32> = (0..region.inside.len()).map(value).collect();
        let changed = fill(region, &values, bounds);
        let settled = (changed as f64) < SETTLED * patches.len() as f64;
        last = Some((patches, assigned));
        if settled {
            break;
        }
    }
    last
}

/// Puts the free pixels with the largest values inside until the area is reached. Returns the number of
/// changed pixels.
pub(super) fn fill(region: &mut LayerRegion, values: &[f32], bounds: &Bounds<'_>) -> usize {
    let is_free = |i: usize| bounds.free.is_none_or(|free| free[i]);
    let fixed = (0..values.len()).filter(|&i| !is_free(i) && region.inside[i]).count();
    let mut order: Vec<usize> = (0..values.len()).filter(|&i| is_free(i)).collect();
    let wanted = bounds.area.saturating_sub(fixed).min(order.len());
    // Ties go to pixels that are inside already.
    order.sort_by(|&a, &b| {
        values[b].total_cmp(&values[a]).then(region.inside[b].cmp(&region.inside[a])).then(a.cmp(&b))
    });
    let mut changed = 0;
    for (rank, &i) in order.iter().enumerate() {
        let inside = rank < wanted;
        changed += usize::from(region.inside[i] != inside);
        region.inside[i] = inside;
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{clouds, nested};
    use super::super::patches::distance;
    use super::*;
    use vtex_base::raster::blur::Plane;
    use vtex_base::sampling::stream;

    /// Rough rust on 2/5 of a square.
    fn rust(seed: u64) -> LayerRegion {
        let soft = clouds([96, 96], seed);
        let mut random = stream(seed, "rust", 0);
        let rough = (0..96 * 96).map(|i| 9.0 * soft.values[i] + random.range(-0.6, 0.6) as f32).collect();
        let rough = Plane { size: [96; 2], values: rough }.blurred(1.0, [false; 2]);
        let mut region = LayerRegion { size: [96; 2], wrap: [false; 2], inside: vec![false; 96 * 96] };
        fill(&mut region, &rough.values, &Bounds { free: None, area: AREA });
        region
    }

    const AREA: usize = 96 * 96 * 2 / 5;

    #[test]
    fn borders_come_to_look_like_the_exemplars() {
        let model = BoundaryModel::new(rust(4), 15);
        let of = |region: &LayerRegion| distance(&BorderWindows::new(region, 15), &model.patches);
        // The distance of another sample of the same rust: no new border can be expected to be nearer.
        let floor = of(&rust(5));
        let disc = |i: usize| {
            let d = [(i % 96) as f32 - 47.5, (i / 96) as f32 - 47.5];
            -(d[0] * d[0] + d[1] * d[1])
        };
        let blob = clouds([96, 96], 9).blurred(6.0, [false; 2]).values;
        for values in [(0..96 * 96).map(disc).collect(), blob] {
            let mut region = LayerRegion { size: [96; 2], wrap: [false; 2], inside: vec![false; 96 * 96] };
            let bounds = Bounds { free: None, area: AREA };
            fill(&mut region, &values, &bounds);
            let before = of(&region);
            optimise(&mut region, &model, &bounds, &mut stream(1, "test", 0));
            let after = of(&region);
            assert!(before - after >= 0.5 * (before - floor), "{before} {after} {floor}");
            assert_eq!(region.area(), AREA);
        }
    }

    #[test]
    fn what_is_not_free_stays() {
        let inside: Vec<bool> = nested([50, 50], 2, 1).labels.iter().map(|&l| l == 1).collect();
        let model =
            BoundaryModel::new(LayerRegion { size: [50; 2], wrap: [false; 2], inside: inside.clone() }, 11);
        let mut region = LayerRegion {
            size: [50; 2],
            wrap: [false; 2],
            inside: nested([50, 50], 2, 2).labels.iter().map(|&l| l == 1).collect(),
        };
        let before = region.clone();
        let free: Vec<bool> = (0..2500).map(|i| i % 50 > 24).collect();
        let area = region.area();
        optimise(&mut region, &model, &Bounds { free: Some(&free), area }, &mut stream(1, "test", 0));
        assert_eq!(region.area(), area);
        assert!((0..2500).all(|i| free[i] || region.inside[i] == before.inside[i]));
        assert_ne!(region, before);
    }
}
