//! Library → scene: the exemplar drawn back from its library.

mod equal;
mod limit_colours;
mod listing;

pub use equal::equal;
pub use listing::{Listing, element, translated};

use crate::library::{Library, SourceKind};
use crate::scene::{Instance, InstanceId, Layer, LibraryId, Scene, Tile};
use equal::share_equal;
use limit_colours::limit_colours;
use vtex_base::geometry::Affine;

/// Draws the exemplar's own arrangement from its library, layer by layer. Elements have their original
/// places and colours. If the library has a limit of colours, the scene keeps it, and each field has one
/// colour.
pub fn reconstruct(library: &Library) -> Scene {
    let page = library.page();
    let by = [f64::from(library.source.width) / page[0], f64::from(library.source.height) / page[1]];
    let whole = by.iter().all(|v| (v - 1.0).abs() < 1e-9);
    if whole || !library.arrangement.periodic {
        return as_it_stands(library);
    }
    // A period that is not a whole number of units is stretched to whole units.
    as_it_stands(&library.scaled(by))
}

/// [`reconstruct`] on a canvas of the size of the exemplar.
fn as_it_stands(library: &Library) -> Scene {
    let (width, height) = (library.source.width, library.source.height);
    let mut scene = Scene::new([width, height], vec![library.reference()], Vec::new());
    let mut listing = Listing::new(LibraryId(0), library);
    let mut next = 0;
    for layer in &library.layers {
        let mut instances = Vec::with_capacity(layer.instances.len());
        for placed in &layer.instances {
            let number = placed.element.index();
            let own = &library.elements[number];
            let element = listing.element(&mut scene, placed.element);
            let [x, y] = own.origin().map(f64::from);
            let transform = (Affine::new(placed.transform) * Affine::translate((x, y))).as_coeffs();
            let colour = own.difference.map(|_| own.colour);
            instances.push(Instance { transform, colour, ..Instance::new(InstanceId(next), element) });
            next += 1;
        }
        let (name, region, field) = (layer.name.clone(), layer.region.clone(), layer.field.clone());
        scene.layers.push(Layer { name, region, field, instances, ..Layer::new(layer.role) });
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
