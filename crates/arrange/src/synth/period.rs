//! Periodic drawings: textures placed by the drawing's period ([`crate::arrange::period`]).

use super::compose::{Arranged, Placement, What};
use super::methods::PlacementMethod;
use super::refusal::refusal;
use super::report::SynthReport;
use crate::arrange::Plan;
use crate::arrange::motifs::DrawnElement;
use crate::arrange::period::{Repeated, place};
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
        let allowed =
            "for one drawing whose borders join, without a map of densities, turned or mirrored elements";
        if applies(plan) { Ok(Self) } else { Err(refusal(Method::Period, allowed)) }
    }

    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
        let library = &plan.libraries[0];
        let repeated = place(library, &plan.params, progress)?;
        let placements = placements(library, &plan.params, &repeated).collect();
        let period = repeated.repeating;
        let report = SynthReport { period, ..SynthReport::of_drawing(library, 1.0, Some(repeated.covered)) };
        Ok(Arranged::of_drawing(plan, repeated.variation, placements, report))
    }
}

/// Whether the period of a library can be repeated: it is a drawing whose borders join, and no control
/// requires another density or whole elements along an edge.
pub(super) fn applies(plan: &Plan<'_>) -> bool {
    let ([library], controls) = (&*plan.libraries, &plan.controls) else { return false };
    let drawn = library.is_drawing()
        && library.arrangement.periodic
        && library.secondaries().is_empty()
        && !library.is_layered();
    let clips = controls.domain.is_none() || plan.params.edge == Edge::Clip;
    drawn && clips && !plan.params.varies() && controls.density.is_none() && controls.structure.is_none()
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
    let mut ordered: Vec<&DrawnElement> = repeated.placed.iter().filter(reaches).collect();
    ordered.sort_by_key(|p| (p.order, p.motif));
    ordered.into_iter().map(|p| {
        let SimilarTo { first, map } = repeated.equal[p.element];
        let [x, y] = library.elements[first].origin().map(f64::from);
        Placement {
            what: What::Known(LibraryId(0), ElementId::after(first), None),
            transform: rounded(p.map * map * Affine::translate((x, y))),
            layer: p.order.0,
            motif: p.motif,
        }
    })
}
