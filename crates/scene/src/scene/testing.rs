//! Scenes of the three layers of a homogeneous photograph, for tests.

use super::{CategoryId, Element, ElementId, Field, Instance, LibraryId, LibraryRef, Role, Scene, Shape};
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;

/// A scene of one library without parameters, domain and edits.
pub fn scene(
    size: [u32; 2],
    elements: Vec<Element>,
    secondary: Vec<Instance>,
    primary: Vec<Instance>,
    field: Field,
) -> Scene {
    let mut layers = Scene::three_layers(field);
    (layers[1].instances, layers[2].instances) = (secondary, primary);
    let library = LibraryRef {
        exemplar: "test.jpg".into(),
        sha256: "0".repeat(64),
        categories: Vec::new(),
        fine: false,
    };
    Scene { elements, ..Scene::new(size, vec![library], layers) }
}

/// A field of one colour without control points.
pub fn flat(colour: Colour) -> Field {
    Field { spacing: 25.0, fallback: colour, points: Vec::new() }
}

/// An element of the first library with one shape.
pub fn element(source: u32, category: Option<u16>, outline: Outline, colour: Colour) -> Element {
    Element {
        library: LibraryId(0),
        source: Some(ElementId(source)),
        category: category.map(CategoryId),
        fused: false,
        silhouette: None,
        shapes: vec![Shape::new(outline, colour)],
    }
}

impl Scene {
    fn index_of(&self, role: Role) -> usize {
        self.layers.iter().position(|layer| layer.role == role).unwrap()
    }

    /// Instances of the first layer of primaries.
    pub fn primary(&self) -> &[Instance] {
        &self.layers[self.index_of(Role::Primary)].instances
    }

    /// Mutable access to the same.
    pub fn primary_mut(&mut self) -> &mut Vec<Instance> {
        let index = self.index_of(Role::Primary);
        &mut self.layers[index].instances
    }

    /// Instances of the first layer of secondaries.
    pub fn secondary(&self) -> &[Instance] {
        &self.layers[self.index_of(Role::Secondary)].instances
    }

    /// Mutable access to the same.
    pub fn secondary_mut(&mut self) -> &mut Vec<Instance> {
        let index = self.index_of(Role::Secondary);
        &mut self.layers[index].instances
    }

    /// The first background.
    pub fn field(&self) -> &Field {
        self.layers.iter().find_map(|layer| layer.field.as_ref()).unwrap()
    }

    /// Mutable access to the same.
    pub fn field_mut(&mut self) -> &mut Field {
        self.layers.iter_mut().find_map(|layer| layer.field.as_mut()).unwrap()
    }
}
