//! Elements of a library as elements of a scene, each listed once.

use crate::element::Profile;
use crate::library::Library;
use crate::scene::{Element, ElementId, LibraryId, Scene};
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, Outline};

/// The elements of a library that a scene already holds, by their indices in the scene.
pub struct Listing<'a> {
    /// Index of the library in the scene.
    number: LibraryId,
    library: &'a Library,
    /// Index in the scene of each of the library's elements.
    elements: Vec<Option<ElementId>>,
    /// Elements that take their colour from the field, by form. The smallest are often identical to the pixel, and
    /// every instance has its own colour.
    alike: BTreeMap<(String, Option<Profile>), ElementId>,
}

impl<'a> Listing<'a> {
    /// An empty listing.
    pub fn new(number: LibraryId, library: &'a Library) -> Self {
        Self { number, library, elements: vec![None; library.elements.len()], alike: BTreeMap::new() }
    }

    /// The elements that a scene already holds.
    pub fn of(number: LibraryId, library: &'a Library, scene: &Scene) -> Self {
        let mut listing = Self::new(number, library);
        let own = |e: &&Element| e.library == number && !e.fused;
        for (i, element) in scene.elements.iter().enumerate().filter(|(_, e)| own(e)) {
            let id = ElementId::after(i);
            if let Some(place) = element.source.and_then(|s| listing.elements.get_mut(s.index())) {
                *place = Some(id);
            }
            if element.category.is_none() {
                listing.alike.insert(form(element), id);
            }
        }
        listing
    }

    /// The element with the given identity in the library, or a secondary of the same shape, added to the
    /// scene if it is missing.
    pub fn element(&mut self, scene: &mut Scene, source: ElementId) -> ElementId {
        if let Some(known) = self.elements[source.index()] {
            return known;
        }
        let element = element(self.number, self.library, source);
        let id = if self.library.elements[source.index()].difference.is_some() {
            *self.alike.entry(form(&element)).or_insert_with(|| scene.add(element))
        } else {
            scene.add(element)
        };
        self.elements[source.index()] = Some(id);
        id
    }
}

/// The path data of an element, and its profile if it is a soft ellipse.
fn form(element: &Element) -> (String, Option<Profile>) {
    (element.outline().to_string(), element.base().ellipse.as_ref().map(|ellipse| ellipse.profile))
}

/// A library's element for a scene, shifted so that its centroid in whole pixels is at (0, 0).
pub fn element(number: LibraryId, library: &Library, source: ElementId) -> Element {
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
pub fn translated(outline: &Outline, origin: [i32; 2]) -> Outline {
    let shift = Affine::translate((-f64::from(origin[0]), -f64::from(origin[1])));
    // Fails only beyond any exemplar's size; the element then keeps its coordinates.
    Outline::new(&(shift * outline.path())).unwrap_or_else(|| outline.clone())
}
