//! The painting order of elements.

use super::Draw;
use super::selection::Chosen;
use vtex_scene::scene::{Instance, OrderBy, Scene};

/// Sorts the selected instances of each layer; those that are not selected keep their places in the order.
pub(super) fn order(scene: &mut Scene, chosen: &Chosen, by: OrderBy, reverse: bool, draw: &Draw) {
    let keys = keys(scene, by, draw);
    let mut first = 0;
    for (layer, chosen) in scene.layers.iter_mut().zip(&chosen.layers) {
        let places: Vec<usize> = (0..layer.instances.len()).filter(|&i| chosen.instances[i]).collect();
        let mut sorted = places.clone();
        let key = |i: usize| keys[first + i];
        // The sort is stable: equal elements keep their order.
        sorted.sort_by(|&a, &b| {
            let rising = key(a).total_cmp(&key(b));
            if reverse { rising.reverse() } else { rising }
        });
        let new: Vec<Instance> = sorted.iter().map(|&i| layer.instances[i].clone()).collect();
        for (&i, instance) in places.iter().zip(new) {
            // The height is that of the place in the order.
            layer.instances[i] = Instance { height: layer.instances[i].height, ..instance };
        }
        first += layer.instances.len();
    }
}

/// The number by which each instance is sorted.
fn keys(scene: &Scene, by: OrderBy, draw: &Draw) -> Vec<f64> {
    match by {
        OrderBy::X => scene.instances().map(|i| scene.place(i).x).collect(),
        OrderBy::Y => scene.instances().map(|i| scene.place(i).y).collect(),
        OrderBy::Area => {
            let areas: Vec<f64> = scene.elements.iter().map(|e| e.outline().area()).collect();
            let area = |i: &Instance| areas[i.element.index()] * i.affine().determinant().abs();
            scene.instances().map(area).collect()
        }
        OrderBy::Random => scene.instances().map(|i| draw.of("edit/order", i.id).unit()).collect(),
        OrderBy::Lightness => scene.appearances().iter().map(|a| f64::from(a.mean[0])).collect(),
    }
}
