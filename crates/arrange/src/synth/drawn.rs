//! Scenes made beside a drawing that stands: the drawing as a layer beneath what was made.

use vtex_scene::library::{Library, Role};
use vtex_scene::reconstruct::reconstruct;
use vtex_scene::scene::{Element, ElementId, Field, Instance, InstanceId, Layer, LibraryId, Scene};

/// A scene with the drawing of its context beneath its layers. The drawing's elements come first in the scene, and have
/// the first ids, in its own order. Its background is that of the scene.
pub(super) fn with_drawing(mut made: Scene, drawing: &Library) -> Scene {
    let drawn = reconstruct(drawing);
    let (elements, ids) = (drawn.elements.len(), drawn.count() as u32);
    let library = LibraryId(made.libraries.len() as u32);
    made.libraries.push(drawing.reference());
    for instance in made.instances_mut() {
        instance.id = InstanceId(instance.id.0 + ids);
        instance.element = ElementId::after(elements + instance.element.index());
    }
    let of_drawing = drawn.elements.into_iter().map(|element| Element { library, ..element });
    made.elements.splice(0..0, of_drawing);
    let field = drawn.layers.iter().rev().find_map(|layer| layer.field.clone());
    let instances: Vec<Instance> = drawn.layers.into_iter().flat_map(|layer| layer.instances).collect();
    let background = Layer { field: field.map(plain), ..Layer::new(Role::Background) };
    let standing = Layer { name: Layer::DRAWN.into(), instances, ..Layer::new(Role::Primary) };
    made.layers.splice(0..0, [background, standing]);
    made
}

/// The colour of a drawing's page.
fn plain(field: Field) -> Field {
    Field { points: Vec::new(), ..field }
}
