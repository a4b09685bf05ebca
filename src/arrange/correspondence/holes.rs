//! Holes: where a primary is wanted and none stands.
//!
//! Each is filled by a whole primary of like colour that fits, if there is one; what is left is for
//! fragments.

use super::alike::Alike;
use super::arrivals::Plan;
use crate::arrange::model::{Model, PlaceableId, VariantId};
use crate::raster::{Connectivity, LabelMap, Mask, components};

/// Fewest pixels of a hole.
const LEAST: u32 = 12;
/// Primaries compared for each hole.
const CANDIDATES: usize = 40;
/// Areas of primaries compared, as shares of the hole's.
const AREAS: [f64; 2] = [0.55, 1.2];
/// Least share of a hole that a primary has to fill.
const FILLED: f64 = 0.6;
/// Most of a primary that may lie on region.
const ON_BACKGROUND: f64 = 0.3;
/// What a pixel on background and one on others weigh against one of the hole.
const COSTS: [f64; 2] = [1.0, 2.0];

/// Pixels on which a part of one primary is wanted.
pub(super) struct Hole {
    /// Index of the arrival that they voted for.
    pub(super) arrival: u32,
    /// The pixels, on the map.
    pub(super) mask: Mask,
}

/// The holes of a plan.
pub(super) fn find(plan: &Plan<'_>) -> Vec<Hole> {
    let grid = plan.grid;
    let mut holes = LabelMap::filled(grid.width as u32, grid.height as u32, 0);
    for (y, row) in plan.rows.iter().enumerate() {
        for &(x0, x1, arrival) in row {
            for x in x0..x1 {
                let i = grid.index(x, y as i32);
                if plan.is_hole(i) {
                    holes.labels[i] = arrival + 1;
                }
            }
        }
    }
    let (pieces, of) = components(&holes, Connectivity::Four);
    drop(holes);
    let masks = Mask::all_of_labels(&pieces, of.len());
    let whole = of.into_iter().zip(masks).skip(1).filter(|(_, mask)| mask.area() >= LEAST);
    whole.map(|(label, mask)| Hole { arrival: label - 1, mask }).collect()
}

/// Lets whole primaries stand in holes that they fill; gives their variants and places. Holes that remain
/// are kept.
pub(super) fn fill(
    holes: &mut Vec<Hole>,
    plan: &mut Plan<'_>,
    alike: &Alike,
    model: &Model,
    allowed: impl Fn(VariantId, [i32; 2]) -> bool,
) -> Vec<(VariantId, [i32; 2])> {
    // The largest first, for there are fewest that fit them.
    holes.sort_by_key(|hole| std::cmp::Reverse(hole.mask.area()));
    let mut standing = Vec::new();
    holes.retain(|hole| {
        let Some((x, y)) = hole.mask.centroid() else { return false };
        let at = [x, y].map(|v| libm::round(v) as i32);
        let arrival = plan.arrivals[hole.arrival as usize];
        let wanted = f64::from(hole.mask.area());
        let most = plan.tolerance(model, arrival.variant);
        let value = |element: PlaceableId| {
            let variant = model.varied(element, arrival.variant);
            let shape = model.shape(variant);
            let (taken, background) = plan.beneath(&shape.mask, at);
            let (area, taken, background) = (f64::from(shape.area), f64::from(taken), f64::from(background));
            let filled = area - taken - background;
            let fits =
                taken <= most * area && background <= ON_BACKGROUND * area && filled >= FILLED * wanted;
            (fits && allowed(variant, at))
                .then_some((filled - COSTS[0] * background - COSTS[1] * taken, variant))
        };
        let areas = AREAS[0] * wanted..AREAS[1] * wanted;
        let found = alike.of(model.element_of(arrival.variant), areas, CANDIDATES, 0.0).filter_map(value);
        let best = found.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, variant)) = best else { return true };
        plan.stand(model, variant, at);
        standing.push((variant, at));
        false
    });
    standing
}
