//! Placement: libraries and control in, placed elements out.
//!
//! Elements are carried from the exemplar along a correspondence field ([`correspondence`]), or placed by
//! their descriptors until nothing is requested any more ([`descriptor`]). Where both are needed,
//! descriptors begin with the carried elements. Then coverage is corrected in both directions ([`density`]),
//! whichever method placed the elements. [`period`] is a method of its own: it needs no field and no model.
//!
//! Synthesis, warp and the search of weights call [`arrange`]. They use the placed elements ([`PlacedElement`]), the
//! cells that these leave free, and the field if there is one.

mod bins;
mod choice;
mod clearance;
pub(crate) mod context;
pub(crate) mod controls;
pub(crate) mod correspondence;
mod density;
pub(crate) mod descriptor;
pub(crate) mod grid;
pub(crate) mod model;
pub(crate) mod motifs;
pub(crate) mod occupancy;
pub(crate) mod period;
mod picture;
pub(crate) mod region;
pub(crate) mod sites;
pub(crate) mod taken;
#[cfg(test)]
mod tests;
pub(crate) mod turned;
pub(crate) mod variation;

use choice::MemberWeights;
use controls::Controls;
use correspondence::{Correspondence, Structure};
use descriptor::InitialRequests;
use grid::Grid;
use model::{Content, EMPTY, PlaceableId, PlacementModel, UNDEFINED, VariantId};
use occupancy::Occupancy;
use region::PlacementRegion;
use std::borrow::Cow;
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_field::correspondence::PagesMemory;
use vtex_scene::library::Library;
use vtex_scene::scene::{Ablation, Method, SynthParams};

/// Widest margin around a canvas that does not repeat, in pixels.
const WIDEST_MARGIN: i32 = 256;
/// Score of an element that is placed beforehand: elements placed by descriptors are removed before it.
const FIXED_SCORE: f32 = 1.0;

/// What a texture is made of, and how: decided once, before anything is placed. All lengths are in pixels of the canvas.
#[derive(Clone)]
pub(crate) struct Plan<'a> {
    /// Libraries that elements are taken from.
    pub(crate) libraries: Cow<'a, [Library]>,
    pub(crate) controls: Cow<'a, Controls>,
    /// The parameters, with the method that is used.
    pub(crate) params: SynthParams,
    /// What earlier canvases of the same libraries have left.
    pub(crate) memory: Option<&'a PagesMemory>,
}

/// The data that all parts of a correspondence field use.
#[derive(Clone, Copy)]
pub(crate) struct PlacementContext<'a> {
    pub(crate) plan: &'a Plan<'a>,
    pub(crate) grid: &'a Grid,
    pub(crate) region: &'a PlacementRegion<'a>,
    pub(crate) progress: &'a dyn Progress,
}

/// An element that is placed before placement begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fixed {
    /// The variant.
    pub(crate) variant: VariantId,
    /// Place of its origin, in pixels of the canvas.
    pub(crate) at: [i32; 2],
    /// The requests of its descriptor.
    pub(crate) requests: InitialRequests,
}

/// A placed element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedElement {
    /// Which element: a primary, or a part of one.
    pub(crate) element: PlaceableId,
    /// Index of its variation in the model.
    pub(crate) variation: u16,
    /// Place of its origin, in pixels of the canvas.
    pub(crate) at: [i32; 2],
    /// Its index among the fixed elements, if it was placed beforehand.
    pub(crate) fixed: Option<usize>,
}

/// The result of placement.
pub(crate) struct PlacementResult<'a> {
    /// The elements that can be seen, in painting order.
    pub(crate) placed: Vec<PlacedElement>,
    /// The element on each cell.
    pub(crate) cells: Occupancy<'a>,
    /// The field that elements were carried along, if any.
    pub(crate) correspondence: Option<Correspondence>,
    /// The islands and elements carried along it.
    pub(crate) structure: Option<Structure>,
    /// Counts of placement by descriptors.
    pub(crate) descriptors: descriptor::DescriptorCounts,
    /// Counts of the correction of density.
    pub(crate) correction: density::DensityCounts,
    /// Cells covered by each category before density was corrected.
    pub(crate) covered_before: Vec<u64>,
}

/// Places elements on a canvas: by correspondences if that is the method of the plan, else by descriptors. `fixed` are
/// placed beforehand, but for those whose origin lies beyond the margin. The model is made of the plan's libraries.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(crate) fn arrange<'a>(
    model: &'a mut PlacementModel,
    plan: &'a Plan<'_>,
    fixed: &[Fixed],
    progress: &dyn Progress,
) -> Result<PlacementResult<'a>> {
    let params = &plan.params;
    let is_carried = params.method == Method::Correspondence;
    let grid = Grid::around(model, params);
    let region = PlacementRegion::new(&grid, &plan.controls, params.edge, is_carried);
    let on_grid = |at: [i32; 2]| [0, 1].map(|k| at[k] + grid.margin[k]);
    let (mut standing, mut initial, mut on_canvas) = (Vec::new(), Vec::new(), Vec::new());
    for (i, f) in fixed.iter().enumerate() {
        let at = on_grid(f.at);
        if grid.cell(at).is_some() {
            standing.push((f.variant, at));
            initial.push(f.requests);
            on_canvas.push(i);
        }
    }
    let (mut correspondence, mut structure) = (None, None);
    if is_carried {
        let context = PlacementContext { plan, grid: &grid, region: &region, progress };
        let found = Correspondence::new(&context, model)?;
        let carried = found.carry(&context, model)?;
        // Where descriptors continue, they begin with the elements beside the area.
        let begin = |variant: VariantId| match model.element(variant).content {
            Content::Known if !region.all_carried() => InitialRequests::Open,
            _ => InitialRequests::None,
        };
        initial.extend(carried.elements.iter().map(|&(variant, _)| begin(variant)));
        standing.extend(carried.elements);
        (correspondence, structure) = (Some(found), Some(carried.structure));
    }

    let model: &'a PlacementModel = model;
    let mut cells = Occupancy::new(model, region, grid);
    let mut choice = MemberWeights::new(model, !params.without(Ablation::Decay));
    for &(variant, at) in &standing {
        cells.stand(variant, at, FIXED_SCORE, |_| {});
        if model.element(variant).placeable {
            choice.used(model, variant);
        }
    }
    empty_where_carried(&mut cells);
    let (mut cells, descriptors) = descriptor::place(cells, &initial, &mut choice, params, progress)?;
    let covered_before = (0..model.members.len()).map(|c| cells.covered_by(c)).collect();
    let correction = density::correct(&mut cells, &mut choice, params, progress)?;
    progress.picture("placed", &|| picture::placed(&cells));
    if let Some(correspondence) = &mut correspondence {
        correspondence.take_ground(&plan.libraries, &cells, params.seed);
    }
    let placed = placed(&cells, &on_canvas);
    Ok(PlacementResult { placed, cells, correspondence, structure, descriptors, correction, covered_before })
}

/// Makes undefined cells empty in the zones that a field serves.
fn empty_where_carried(cells: &mut Occupancy<'_>) {
    let all = cells.region.all_carried();
    let Occupancy { region, state, .. } = cells;
    for (i, state) in state.iter_mut().enumerate() {
        if *state == UNDEFINED && (all || region.cell_is_carried(i)) {
            *state = EMPTY;
        }
    }
}

/// The elements that can be seen, in painting order. The first of those ever placed are the fixed ones.
fn placed(cells: &Occupancy<'_>, fixed: &[usize]) -> Vec<PlacedElement> {
    let order = cells.painting_order().into_iter().filter(|&id| cells.is_seen(id));
    order
        .map(|id| {
            let standing = cells.get(id);
            PlacedElement {
                element: cells.model().element_of(standing.variant),
                variation: cells.model().variation_of(standing.variant),
                at: [0, 1].map(|k| standing.at[k] - cells.grid.margin[k]),
                fixed: fixed.get(id.0 as usize).copied(),
            }
        })
        .collect()
}
