//! Scene → its categories: number, plain name and mean colour.

use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::colour_names;
use vtex_scene::scene::{CategoryId, Element, LibraryId, Scene};

/// A category of which a scene shows elements. Serialised, library and category are numbers from 1.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SceneCategory {
    /// Its library.
    #[serde(serialize_with = "library_number")]
    pub library: LibraryId,
    /// Its index in the library.
    #[serde(serialize_with = "CategoryId::serialize_number")]
    pub category: CategoryId,
    /// Its name in the library; for scenes without names, a plain name of its colour.
    pub name: String,
    /// Mean colour of its instances, in sRGB: that of the first shape of each.
    pub colour: Colour,
    /// Number of its elements on the canvas.
    pub elements: usize,
}

fn library_number<S: Serializer>(library: &LibraryId, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(library.number())
}

/// The categories of a scene's elements, by library and number. Categories without an element on the canvas
/// are left out.
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
            name: scene.libraries[library.index()].categories.get(category.index()).cloned().unwrap_or(name),
            colour,
            elements,
        })
        .collect()
}

/// The class that elements of a category have in an SVG: `category-2`, or `category-2-1` for the second
/// category of the first library where a scene is made from several.
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
