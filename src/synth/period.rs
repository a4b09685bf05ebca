//! Periodic drawings: textures placed by the drawing's period ([`crate::arrange::period`]).

use super::compose::element;
use super::report::{CategoryReport, Report};
use crate::arrange::controls::Controls;
use crate::arrange::period::{Placed, Repeated, place};
use crate::error::Result;
use crate::geometry::{Affine, Rect, rounded};
use crate::library::{ElementId, Library, SourceKind};
use crate::progress::Progress;
use crate::scene::{Domain, Edge, Instance, InstanceId, Layer, LibraryId, Method, Role, Scene, SynthParams};
use crate::statistics::{Overlap, Repetition};
use std::collections::BTreeMap;

/// Whether the period of a library can be repeated: it is a drawing whose borders join, and nothing asks
/// for another density or for whole elements along an edge.
pub(super) fn applies(libraries: &[Library], params: &SynthParams, controls: &Controls) -> bool {
    let [library] = libraries else { return false };
    let drawn = library.source.kind == SourceKind::Drawing
        && library.arrangement.periodic
        && library.secondaries().is_empty()
        && !library.is_layered();
    let clips = controls.domain.is_none() || params.edge == Edge::Clip;
    let varied = params.rotate > 0.0 || params.mirror || params.scale_jitter > 0.0;
    drawn && clips && !varied && controls.density.is_none() && controls.lead.is_none()
}

/// A texture of the exemplar's period, and how close it came.
///
/// # Errors
/// As [`place`].
pub(super) fn synthesize(
    library: &Library,
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, Report)> {
    let repeated = place(library, params, progress)?;
    let mut scene = scene(library, params, controls, &repeated);
    if let Some(p) = scene.parameters.as_mut() {
        p.variation = Some(repeated.variation);
    }
    let report = report(library, &scene, &repeated);
    Ok((scene, report))
}

/// The scene of placed elements, in the layers of the library. Equal elements are shared.
fn scene(library: &Library, params: &SynthParams, controls: &Controls, repeated: &Repeated) -> Scene {
    let mut scene = Scene::new([params.width, params.height], vec![library.reference()], Vec::new());
    scene.parameters = Some(params.clone());
    scene.tile = params.tile;
    scene.domain = controls.domain.clone().map(|outline| Domain { outline, edge: params.edge });
    let canvas = Rect::new(0.0, 0.0, f64::from(params.width), f64::from(params.height));
    let mut listed: BTreeMap<usize, crate::scene::ElementId> = BTreeMap::new();
    let mut next = 0;
    let mut by_layer: Vec<Vec<&Placed>> = vec![Vec::new(); library.layers.len()];
    repeated.placed.iter().for_each(|p| by_layer[p.order.0].push(p));
    for (layer, own) in library.layers.iter().zip(&mut by_layer) {
        own.sort_by_key(|p| p.order.1);
        let mut instances = Vec::new();
        for p in own {
            let reach = p.map.transform_rect_bbox(repeated.bounds[p.element]);
            if !params.tile.any() && !reach.overlaps(canvas) {
                continue;
            }
            let (first, from) = repeated.equal[p.element];
            let id = *listed
                .entry(first)
                .or_insert_with(|| scene.add(element(LibraryId(0), library, ElementId::after(first))));
            let [x, y] = library.elements[first].origin().map(f64::from);
            let transform = rounded(p.map * from * Affine::translate((x, y)));
            instances.push(Instance { transform, ..Instance::new(InstanceId(next), id) });
            next += 1;
        }
        let (name, region, field) = (layer.name.clone(), None, layer.field.clone());
        scene.layers.push(Layer { name, role: layer.role, region, field, instances });
    }
    scene
}

fn report(library: &Library, scene: &Scene, repeated: &Repeated) -> Report {
    let categories: Vec<CategoryReport> = library
        .categories
        .iter()
        .zip(&repeated.covered)
        .map(|(c, &got)| CategoryReport { wanted: c.coverage, got })
        .collect();
    let libraries = std::slice::from_ref(library);
    Report {
        coverage_wanted: library.coverage,
        coverage: repeated.covered.iter().sum(),
        categories,
        strata: Vec::new(),
        primaries: scene.of_role(Role::Primary).count(),
        textons: scene.elements.len(),
        secondaries: 0,
        control_points: 0,
        attempts: 0,
        refused: 0,
        removed: 0,
        added: 0,
        method: Method::Period,
        structure: None,
        overlap: Overlap::of_scene(scene, libraries),
        repetition: Repetition::of_scene(scene, libraries),
        period: repeated.repeating,
    }
}
