//! Scene → its categories: number, plain name and mean colour.

use serde::Serialize;
use std::collections::BTreeMap;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::colour_names;
use vtex_scene::scene::{CategoryId, Element, LibraryId, Scene};

/// A category of which a scene shows elements.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SceneCategory {
    /// Its library.
    pub library: LibraryId,
    /// Its number in the library.
    pub category: CategoryId,
    /// A plain name for its colour; no other category of the scene has it.
    pub name: String,
    /// Mean colour of its elements where they stand: of the first shape of each, in sRGB.
    pub colour: Colour,
    /// Number of its elements on the canvas.
    pub elements: usize,
}

/// The categories of a scene's elements, by library and number. Those that no element of the canvas
/// belongs to are left out.
pub fn categories(scene: &Scene) -> Vec<SceneCategory> {
    let mut sums: BTreeMap<(LibraryId, CategoryId), ([f64; 3], usize)> = BTreeMap::new();
    for instance in scene.individuals() {
        let element = scene.element(instance);
        let Some(category) = element.category else { continue };
        let colour = instance.colour.unwrap_or(element.base().colour).to_f64();
        let (sum, count) = sums.entry((element.library, category)).or_default();
        (0..3).for_each(|k| sum[k] += colour[k]);
        *count += 1;
    }
    let colours: Vec<Colour> =
        sums.values().map(|(sum, count)| Colour::from_f64(sum.map(|v| v / *count as f64))).collect();
    let found = sums.into_iter().zip(colour_names::distinct(&colours)).zip(colours);
    found
        .map(|((((library, category), (_, elements)), name), colour)| SceneCategory {
            library,
            category,
            name,
            colour,
            elements,
        })
        .collect()
}

/// The class that elements of a category have in an SVG: `category-2`, or `category-2-1` for category 2
/// of library 1 where a scene is made from several.
pub(super) fn class(scene: &Scene, element: &Element) -> Option<String> {
    Some(class_of(scene, element.library, element.category?))
}

/// [`class`] of a category by its number.
pub(super) fn class_of(scene: &Scene, library: LibraryId, category: CategoryId) -> String {
    if scene.libraries.len() > 1 {
        format!("category-{category}-{library}")
    } else {
        format!("category-{category}")
    }
}
