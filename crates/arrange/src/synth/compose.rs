//! Scenes from placed elements.

use super::secondaries;
use super::strata::Strata;
use crate::arrange::Arrangement;
use crate::arrange::controls::Controls;
use crate::arrange::variation::Variation;
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::Library;
use vtex_scene::reconstruct::{Listing, reference};
use vtex_scene::scene::{
    Domain, ElementId, Field, Instance, InstanceId, Layer, LibraryId, Scene, SynthParams,
};

/// Positions of the element layers within a stratum.
const SECONDARY: usize = 1;
const PRIMARY: usize = 2;

/// Makes the scene of an arrangement. Elements are listed in the order of their first instance.
pub(crate) fn scene(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    arrangement: &Arrangement<'_>,
    secondaries: &[secondaries::Placed],
    (background, strata): (Field, Option<Strata>),
) -> Scene {
    let references = libraries.iter().map(reference).collect();
    let layers = match &strata {
        Some(strata) => strata.layers(),
        None => Scene::three_layers(background),
    };
    let mut scene = Scene::new([params.width, params.height], references, layers);
    scene.parameters = Some(params.clone());
    scene.tile = params.tile;
    scene.domain = controls.domain.clone().map(|outline| Domain { outline, edge: params.edge });
    let mut listings: Vec<Listing<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Listing::new(LibraryId(k as u32), l)).collect();
    let model = arrangement.cells.model();
    for p in secondaries {
        let element = listings[p.library].secondary(&mut scene, p.secondary);
        let variation = &model.variations[usize::from(p.variation)];
        let stratum = strata.as_ref().map_or(0, |strata| strata.of_secondary(p));
        push(&mut scene, (stratum, SECONDARY), element, p.at, variation, Some(p.colour));
    }
    for p in &arrangement.placed {
        let placed = &model[p.element];
        let (element, variation) = match placed.fused {
            // A fused element is stored with its variation applied.
            Some(fused) => (scene.add(model.fused[fused as usize].clone()), &Variation::default()),
            None => {
                let element = listings[placed.library].primary(&mut scene, placed.index);
                (element, &model.variations[usize::from(p.variation)])
            }
        };
        let of = |strata: &Strata| strata.of_primary(&libraries[0], arrangement, p.element, p.at);
        let stratum = strata.as_ref().map_or(0, of);
        push(&mut scene, (stratum, PRIMARY), element, p.at, variation, None);
    }
    if strata.is_some() {
        without_empty_strata(&mut scene);
    }
    scene
}

/// Removes strata without a place on the canvas: a given map may lack some, and small canvases have no room
/// for all.
fn without_empty_strata(scene: &mut Scene) {
    let layers = std::mem::take(&mut scene.layers);
    for mut stratum in layers.chunks(Strata::LAYERS).map(<[Layer]>::to_vec) {
        let nowhere = stratum[0].region.as_ref().is_some_and(Outline::is_empty);
        if nowhere {
            (stratum[0].region, stratum[0].field) = (None, None);
        }
        if !nowhere || stratum.iter().any(|layer| !layer.instances.is_empty()) {
            scene.layers.extend(stratum);
        }
    }
}

/// Appends an instance to a layer of a stratum. Ids are numbered across all layers.
fn push(
    scene: &mut Scene,
    (stratum, layer): (usize, usize),
    element: ElementId,
    at: [i32; 2],
    variation: &Variation,
    colour: Option<Colour>,
) {
    let id = InstanceId(scene.count() as u32);
    let layer = &mut scene.layers[stratum * Strata::LAYERS + layer];
    layer.instances.push(instance(id, element, at, variation, colour));
}

/// An element at a place of the canvas.
pub(crate) fn instance(
    id: InstanceId,
    element: ElementId,
    at: [i32; 2],
    variation: &Variation,
    colour: Option<Colour>,
) -> Instance {
    // Five decimals are precise to a hundredth of a pixel at a distance of a thousand, and short.
    let [a, b, c, d] = variation.matrix.map(|v| libm::round(v * 1e5) / 1e5);
    let transform = [a, b, c, d, f64::from(at[0]), f64::from(at[1])];
    Instance { transform, colour, ..Instance::new(id, element) }
}
