//! Composes scenes of placed elements, for all methods of placement.

use crate::arrange::PlacementResult;
use crate::arrange::controls::Controls;
use crate::arrange::model::Content;
use crate::arrange::variation::Variation;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::Library;
use vtex_scene::reconstruct::Listing;
use vtex_scene::scene::{
    Domain, Element, ElementId, Instance, InstanceId, Layer, LibraryId, Role, Scene, SynthParams,
};

/// A placed element.
pub(crate) struct Placement<'a> {
    pub(crate) what: What<'a>,
    /// From the coordinates of the element to those of the canvas.
    pub(crate) transform: [f64; 6],
    /// Index of the layer.
    pub(crate) layer: usize,
    /// Number of the motif of which it is a part.
    pub(crate) motif: Option<u32>,
}

/// The content of a placement.
pub(crate) enum What<'a> {
    /// An element of a library, in a colour of its own or in the element's.
    Known(LibraryId, ElementId, Option<Colour>),
    /// An element made for this scene.
    Made(&'a Element),
    /// An instance of an earlier scene, which keeps its identity, element, colour and effects.
    Kept(&'a Instance),
}

/// A scene with layers but without elements.
pub(crate) fn blank(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    layers: Vec<Layer>,
) -> Scene {
    let references = libraries.iter().map(Library::reference).collect();
    Scene {
        parameters: Some(params.clone()),
        page: params.page,
        tile: params.tile,
        domain: controls.domain.clone().map(|outline| Domain { outline, edge: params.edge }),
        ..Scene::new([params.width, params.height], references, layers)
    }
}

/// A texture of one drawing: its layers, filled with placements; beside a drawing that stands, one layer of what was made.
pub(super) fn compose_drawing<'a>(
    library: &Library,
    params: &SynthParams,
    controls: &Controls,
    placements: impl IntoIterator<Item = Placement<'a>>,
) -> Scene {
    let libraries = std::slice::from_ref(library);
    if controls.context.is_some() {
        let predicted = Layer { name: Layer::PREDICTED.into(), predicted: true, ..Layer::new(Role::Primary) };
        let placements = placements.into_iter().map(|p| Placement { layer: 0, ..p });
        return compose(
            blank(libraries, params, controls, vec![predicted]),
            InstanceId(0),
            libraries,
            placements,
        );
    }
    let layers = library.layers.iter().map(|own| Layer {
        name: own.name.clone(),
        field: own.field.clone(),
        ..Layer::new(own.role)
    });
    compose(blank(libraries, params, controls, layers.collect()), InstanceId(0), libraries, placements)
}

/// Adds placements to the layers of a scene, in their order. Elements are listed in the order of their first
/// instance, after those that the scene lists already. New instances are numbered from `first` on.
pub(crate) fn compose<'a>(
    mut scene: Scene,
    first: InstanceId,
    libraries: &[Library],
    placements: impl IntoIterator<Item = Placement<'a>>,
) -> Scene {
    let listing = |(k, library)| Listing::of(LibraryId(k as u32), library, &scene);
    let mut listings: Vec<Listing<'_>> = libraries.iter().enumerate().map(listing).collect();
    let mut ids = (first.0..=u32::MAX).chain(0..first.0).map(InstanceId);
    let mut fresh = |element| Instance::new(ids.next().unwrap_or(first), element);
    for Placement { what, transform, layer, motif } in placements {
        let instance = match what {
            What::Known(library, source, colour) => {
                let element = listings[library.index()].element(&mut scene, source);
                Instance { transform, motif, colour, ..fresh(element) }
            }
            What::Made(element) => {
                let element = scene.add(element.clone());
                Instance { transform, motif, ..fresh(element) }
            }
            What::Kept(instance) => Instance { transform, ..instance.clone() },
        };
        scene.layers[layer].instances.push(instance);
    }
    scene
}

/// The content of a placed primary, and its transform.
pub(crate) fn primary<'a>(
    arrangement: &'a PlacementResult<'_>,
    placed: &crate::arrange::PlacedElement,
) -> (What<'a>, [f64; 6]) {
    let model = arrangement.cells.model();
    let element = &model[placed.element];
    let known = What::Known(LibraryId(element.library as u32), ElementId(element.index), None);
    match element.content {
        // A fused element is stored with its variation applied.
        Content::Fused(fused) => {
            (What::Made(&model.fused[fused as usize]), at(&Variation::default(), placed.at))
        }
        Content::Mapped(map) => (known, at(&model.maps[map as usize], placed.at)),
        Content::Known => (known, at(&model.variations[usize::from(placed.variation)], placed.at)),
    }
}

/// The transform of a variation at a place of the canvas.
pub(crate) fn at(variation: &Variation, at: [i32; 2]) -> [f64; 6] {
    // Five decimals are precise to a hundredth of a pixel at a distance of a thousand, and short.
    let [a, b, c, d] = variation.matrix.map(|v| libm::round(v * 1e5) / 1e5);
    [a, b, c, d, f64::from(at[0]), f64::from(at[1])]
}
