//! Scenes from placed elements; the exemplar's own arrangement as a scene.

use super::equal::share_equal;
use super::few::limit_colours;
use super::secondaries;
use super::strata::Strata;
use crate::arrange::Arrangement;
use crate::arrange::controls::Controls;
use crate::arrange::variation::Variation;
use crate::geometry::{Affine, Outline};
use crate::library::{Library, SourceKind};
use crate::raster::colour::Colour;
use crate::scene::{
    Domain, Element, ElementId, Field, Instance, InstanceId, Layer, LibraryId, Scene, SynthParams, Tile,
};
use std::collections::BTreeMap;

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
    let references = libraries.iter().map(Library::reference).collect();
    let layers = match &strata {
        Some(strata) => strata.layers(),
        None => Scene::three_layers(background),
    };
    let mut scene = Scene::new([params.width, params.height], references, layers);
    scene.parameters = Some(params.clone());
    scene.tile = params.tile;
    scene.domain = controls.domain.clone().map(|outline| Domain { outline, edge: params.edge });
    let mut known: Vec<Known<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Known::new(LibraryId(k as u32), l)).collect();
    let model = arrangement.cells.model();
    for p in secondaries {
        let element = known[p.library].secondary(&mut scene, p.secondary);
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
                let element = known[placed.library].primary(&mut scene, placed.index);
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

/// [`reconstruct`](super::reconstruct) on a canvas of the size of the exemplar.
pub(super) fn reconstruct(library: &Library) -> Scene {
    let (width, height) = (library.source.width, library.source.height);
    let mut scene = Scene::new([width, height], vec![library.reference()], Vec::new());
    let mut known = Known::new(LibraryId(0), library);
    let mut next = 0;
    for layer in &library.layers {
        let mut instances = Vec::with_capacity(layer.instances.len());
        for placed in &layer.instances {
            let number = placed.element.index();
            let own = &library.elements[number];
            let element = known.element(&mut scene, placed.element);
            let [x, y] = own.origin().map(f64::from);
            let transform = (Affine::new(placed.transform) * Affine::translate((x, y))).as_coeffs();
            let colour = own.difference.map(|_| own.colour);
            instances.push(Instance { transform, colour, ..Instance::new(InstanceId(next), element) });
            next += 1;
        }
        let (name, region, field) = (layer.name.clone(), layer.region.clone(), layer.field.clone());
        scene.layers.push(Layer { name, role: layer.role, region, field, instances });
    }
    let wrap = library.arrangement.periodic;
    scene.tile = Tile { x: wrap, y: wrap };
    if library.source.kind == SourceKind::Drawing {
        share_equal(&mut scene, library);
        return scene;
    }
    let most = library.source.parameters.colors as usize;
    if most > 0 {
        limit_colours(&mut scene, most);
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

/// The elements of a library that a scene already holds, by their indices in the scene.
pub(crate) struct Known<'a> {
    /// Index of the library in the scene.
    number: LibraryId,
    library: &'a Library,
    /// Index in the scene of each of the library's elements.
    elements: Vec<Option<ElementId>>,
    /// Shapes of elements that take their colour from the field, by path data. The smallest are often
    /// identical to the pixel, and every instance has its own colour.
    alike: BTreeMap<String, ElementId>,
}

impl<'a> Known<'a> {
    fn new(number: LibraryId, library: &'a Library) -> Self {
        Self { number, library, elements: vec![None; library.elements.len()], alike: BTreeMap::new() }
    }

    /// The elements that a scene already holds.
    pub(crate) fn of(number: LibraryId, library: &'a Library, scene: &Scene) -> Self {
        let mut known = Self::new(number, library);
        let own = |e: &&Element| e.library == number && !e.fused;
        for (i, element) in scene.elements.iter().enumerate().filter(|(_, e)| own(e)) {
            let id = ElementId::after(i);
            if let Some(place) = element.source.and_then(|s| known.elements.get_mut(s.index())) {
                *place = Some(id);
            }
            if element.category.is_none() {
                known.alike.insert(element.outline().to_string(), id);
            }
        }
        known
    }

    /// The primary with the given number among the library's, added to the scene if it is missing.
    pub(crate) fn primary(&mut self, scene: &mut Scene, number: u32) -> ElementId {
        self.element(scene, ElementId(number))
    }

    /// The secondary with the given number among the library's, or one of the same shape, added to the
    /// scene if it is missing.
    pub(crate) fn secondary(&mut self, scene: &mut Scene, number: u32) -> ElementId {
        self.element(scene, self.library.secondary_id(number))
    }

    fn element(&mut self, scene: &mut Scene, source: ElementId) -> ElementId {
        if let Some(known) = self.elements[source.index()] {
            return known;
        }
        let element = element(self.number, self.library, source);
        let id = if self.library.elements[source.index()].difference.is_some() {
            *self.alike.entry(element.outline().to_string()).or_insert_with(|| scene.add(element))
        } else {
            scene.add(element)
        };
        self.elements[source.index()] = Some(id);
        id
    }
}

/// A library's element for a scene, shifted so that its centroid in whole pixels is at (0, 0).
pub(crate) fn element(number: LibraryId, library: &Library, source: ElementId) -> Element {
    let own = &library.elements[source.index()];
    let [x, y] = own.origin().map(f64::from);
    let shift = Affine::translate((-x, -y));
    Element {
        library: number,
        source: Some(source),
        category: own.category,
        fused: false,
        silhouette: own.silhouette.as_ref().map(|outline| translated(outline, own.origin())),
        shapes: own.shapes.iter().map(|shape| shape.moved(shift)).collect(),
    }
}

/// An outline shifted so that `origin` is at (0, 0).
pub(crate) fn translated(outline: &Outline, origin: [i32; 2]) -> Outline {
    let shift = Affine::translate((-f64::from(origin[0]), -f64::from(origin[1])));
    // Fails only beyond any exemplar's size; the element then keeps its coordinates.
    Outline::new(&(shift * outline.path())).unwrap_or_else(|| outline.clone())
}
