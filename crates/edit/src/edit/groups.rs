//! Groups of selected elements, such as a layer or a category, within which an operation works.

use super::selection::Chosen;
use std::collections::BTreeMap;
use vtex_scene::scene::{CategoryId, LibraryId, Scene, Within};

/// The layer, and the category in its library if groups are categories.
type Key = (usize, Option<(LibraryId, Option<CategoryId>)>);

/// Indices of the selected instances, in painting order of the scene, group by group.
pub(super) fn groups(scene: &Scene, chosen: &Chosen, within: Within) -> Vec<Vec<usize>> {
    let mut found: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
    let mut index = 0;
    for (k, (layer, chosen)) in scene.layers.iter().zip(&chosen.layers).enumerate() {
        for (instance, chosen) in layer.instances.iter().zip(&chosen.instances) {
            if *chosen {
                let element = scene.element(instance);
                let category = (within == Within::Category).then_some((element.library, element.category));
                found.entry((k, category)).or_default().push(index);
            }
            index += 1;
        }
    }
    found.into_values().collect()
}
