//! Periodic drawings: textures placed by the drawing's period ([`crate::arrange::period`]).

use super::compose::{Placement, What, compose_drawing};
use super::report::{CategoryReport, SynthReport};
use crate::arrange::controls::Controls;
use crate::arrange::period::{PeriodCopy, Repeated, place};
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Rect, rounded};
use vtex_base::progress::Progress;
use vtex_scene::element::SimilarTo;
use vtex_scene::library::{ElementId, Library, SourceKind};
use vtex_scene::scene::{Edge, LibraryId, Scene, SynthParams};

/// Whether the period of a library can be repeated: it is a drawing whose borders join, and no control
/// requires another density or whole elements along an edge.
pub(super) fn applies(libraries: &[Library], params: &SynthParams, controls: &Controls) -> bool {
    let [library] = libraries else { return false };
    let drawn = library.source.kind == SourceKind::Drawing
        && library.arrangement.periodic
        && library.secondaries().is_empty()
        && !library.is_layered();
    let clips = controls.domain.is_none() || params.edge == Edge::Clip;
    drawn && clips && !params.varies() && controls.density.is_none() && controls.structure.is_none()
}

/// A texture that repeats the exemplar's period, and its report.
///
/// # Errors
/// As [`place`].
pub(super) fn synthesize(
    library: &Library,
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let repeated = place(library, params, progress)?;
    let params = SynthParams { variation: Some(repeated.variation), ..params.clone() };
    let scene = compose_drawing(library, &params, controls, placements(library, &params, &repeated));
    let categories = CategoryReport::of(library, repeated.covered.iter().copied());
    let report = SynthReport {
        coverage_wanted: library.coverage,
        period: repeated.repeating,
        ..SynthReport::of_scene(std::slice::from_ref(library), &scene, categories)
    };
    Ok((scene, report))
}

/// The elements that reach the canvas, layer by layer in painting order. Equal elements are instances of the
/// first of their class.
fn placements<'a>(
    library: &'a Library,
    params: &'a SynthParams,
    repeated: &'a Repeated,
) -> impl Iterator<Item = Placement<'a>> {
    let canvas = Rect::new(0.0, 0.0, f64::from(params.width), f64::from(params.height));
    let reaches = move |p: &&PeriodCopy| {
        params.tile.any() || p.map.transform_rect_bbox(repeated.bounds[p.element]).overlaps(canvas)
    };
    let mut ordered: Vec<&PeriodCopy> = repeated.placed.iter().filter(reaches).collect();
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
