//! The library that each cell takes its source from, and the cells that need none. Regions of a library are
//! as large as a descriptor.

use crate::arrange::PlacementContext;
use crate::arrange::model::PlacementModel;
use crate::arrange::sites::scattered;
use vtex_base::sampling::stream;

/// Cells farther than this from the area to fill need no source, in pixels.
const AROUND: i32 = 24;

/// The library of every cell; `None` for one library. Where several have a part, each gets regions the size
/// of some elements, in proportion to its share.
pub(super) fn libraries(
    context: &PlacementContext<'_>,
    model: &PlacementModel,
    size: [usize; 2],
    place: impl Fn(usize, usize) -> [i32; 2],
) -> Option<Vec<u8>> {
    let PlacementContext { plan, grid, region, .. } = *context;
    if !region.is_shared() {
        return None;
    }
    let mut random = stream(plan.params.seed, "correspondence/libraries", 0);
    let canvas = grid.canvas();
    let radius = f64::from(model.half.max(8));
    let sites = scattered(grid, radius, radius, &mut random);
    // The random numbers that decide for a library, one for all cells of a site.
    let draws: Vec<f64> = sites.centres().iter().map(|_| random.unit()).collect();
    let library = |at: [i32; 2]| {
        let at = [0, 1].map(|k| at[k].clamp(0, canvas[k] as i32 - 1));
        let draw = sites.owner(at).map_or(0.5, |site| draws[site]);
        let shares = region.shares(at.map(f64::from));
        let mut sum = 0.0;
        let known = model.sources.len();
        let found = (0..known).find(|&k| {
            sum += shares[k];
            shares[k] > 0.0 && draw < sum
        });
        found.unwrap_or_else(|| (0..known).rev().find(|&k| shares[k] > 0.0).unwrap_or(0)) as u8
    };
    Some(
        (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .map(|(x, y)| library(place(x, y)))
            .collect(),
    )
}

/// The cells that need a source; `None` if all do.
pub(super) fn active(
    context: &PlacementContext<'_>,
    size: [usize; 2],
    place: impl Fn(usize, usize) -> [i32; 2],
) -> Option<Vec<bool>> {
    let PlacementContext { grid, region, .. } = *context;
    if region.is_plain() {
        return None;
    }
    let wanted = |at: [i32; 2]| {
        let at = [0, 1].map(|k| at[k] + grid.margin[k]);
        grid.canvas_cell(at).is_some_and(|i| region.cell_is_carried(i))
    };
    let near = |at: [i32; 2]| {
        let step = AROUND / 2;
        (-2..=2).any(|v| (-2..=2).any(|u| wanted([at[0] + u * step, at[1] + v * step])))
    };
    Some(
        (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .map(|(x, y)| near(place(x, y)))
            .collect(),
    )
}
