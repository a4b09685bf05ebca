//! Periodic drawings: textures placed by the drawing's period ([`crate::arrange::period`]).

use super::compose::{Arranged, Placement, What};
use super::in_place::vary_in_place;
use super::methods::PlacementMethod;
use super::refusal::refusal;
use super::report::SynthReport;
use super::thinned::thin;
use crate::arrange::Plan;
use crate::arrange::motifs::DrawnElement;
use crate::arrange::period::{Repeated, place};
use std::collections::BTreeSet;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Rect, rounded};
use vtex_base::progress::Progress;
use vtex_scene::element::SimilarTo;
use vtex_scene::library::{ElementId, Library};
use vtex_scene::scene::{Edge, LibraryId, Method, SynthParams};

/// Placement by the period.
pub(super) struct Periodic;

impl PlacementMethod for Periodic {
    fn fits(plan: &Plan<'_>, _: &dyn Progress) -> Result<Self> {
        let allowed = "for one drawing whose borders join, and with a map of densities only where \
             no line runs on from copy to copy";
        if applies(plan) { Ok(Self) } else { Err(refusal(Method::Period, allowed)) }
    }

    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
        let library = &plan.libraries[0];
        let repeated = place(library, &plan.params, progress)?;
        let placements = placements(library, &plan.params, &repeated).collect();
        let period = repeated.repeating;
        let report = SynthReport { period, ..SynthReport::of_drawing(library, 1.0, Some(repeated.covered)) };
        let mut arranged = Arranged::of_drawing(plan, repeated.variation, placements, report);
        if plan.params.tile.any() {
            let period = [library.source.width, library.source.height].map(f64::from);
            let periods = |k: usize, size: u32| libm::round(f64::from(size) / period[k]) as i32;
            let periods = [periods(0, plan.params.width), periods(1, plan.params.height)];
            let stacking = library.source.stacking;
            arranged.blank.stacking = [0, 1].map(|k| stacking[k].saturating_mul(periods[k]));
        }
        thin(&mut arranged, plan, "primaries", progress)?;
        vary_in_place(&mut arranged, plan, "primaries", progress)?;
        Ok(arranged)
    }
}

/// Whether the period of a library can be repeated: it is a drawing whose borders join, and no control
/// requires whole elements along an edge, or lines that run on to end.
pub(super) fn applies(plan: &Plan<'_>) -> bool {
    let ([library], controls) = (&*plan.libraries, &plan.controls) else { return false };
    let drawn = library.is_drawing()
        && library.arrangement.periodic
        && library.secondaries().is_empty()
        && !library.is_layered();
    let can_thin = controls.density.is_none() || !library.primaries().iter().any(|e| e.clipped);
    let clips = controls.domain.is_none() || plan.params.edge == Edge::Clip;
    drawn && clips && can_thin && controls.structure.is_none()
}

/// The elements that reach the canvas, layer by layer in painting order. Equal elements are instances of the
/// first of their class.
fn placements<'a>(
    library: &'a Library,
    params: &'a SynthParams,
    repeated: &'a Repeated,
) -> impl Iterator<Item = Placement<'static>> {
    let canvas = Rect::new(0.0, 0.0, f64::from(params.width), f64::from(params.height));
    let reaches = move |p: &&DrawnElement| {
        params.tile.any() || p.map.transform_rect_bbox(repeated.bounds[p.element]).overlaps(canvas)
    };
    // Motifs that are turned in the end are turned as wholes.
    let motifs: BTreeSet<u32> =
        repeated.placed.iter().filter(|p| params.varies() && reaches(p)).filter_map(|p| p.motif).collect();
    let is_shown = |p: &&DrawnElement| reaches(p) || p.motif.is_some_and(|motif| motifs.contains(&motif));
    let mut ordered: Vec<&DrawnElement> = repeated.placed.iter().filter(is_shown).collect();
    ordered.sort_by_key(|p| (p.order, p.motif));
    let is_stacked = params.tile.any() && library.source.stacking != [0; 2];
    ordered.into_iter().map(move |p| {
        let SimilarTo { first, map } = repeated.equal[p.element];
        let [x, y] = library.elements[first].origin().map(f64::from);
        Placement {
            what: What::Known(LibraryId(0), ElementId::after(first), None),
            transform: rounded(p.map * map * Affine::translate((x, y))),
            layer: p.order.layer,
            motif: p.motif,
            height: if is_stacked { p.order.height() } else { 0 },
        }
    })
}
