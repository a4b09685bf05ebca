//! Equal elements, and scenes that list them once.

use crate::element::{SimilarTo, classes};
use crate::library::{ExemplarElement, Library};
use crate::scene::{ElementId, Instance, Scene};
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, rounded};

/// Largest difference between equal elements, in pixels.
const EQUAL: f64 = 0.12;

/// For each element, the first that is equal to it up to a similarity.
pub fn equal(elements: &[ExemplarElement]) -> Vec<SimilarTo> {
    classes(elements.len(), |k| &elements[k].shapes, |k| elements[k].clipped, EQUAL)
}

/// Lists equal elements of a reconstruction once: their instances show the first, turned and moved.
pub(super) fn share_equal(scene: &mut Scene, library: &Library) {
    let equal = equal(library.primaries());
    let origin = |k: usize| {
        let [x, y] = library.elements[k].origin().map(f64::from);
        Affine::translate((x, y))
    };
    let listed: BTreeMap<usize, ElementId> = scene
        .elements
        .iter()
        .enumerate()
        .filter_map(|(i, e)| Some((e.source?.index(), ElementId::after(i))))
        .collect();
    let sources: Vec<Option<usize>> = scene.elements.iter().map(|e| e.source.map(|s| s.index())).collect();
    let change = |instance: &mut Instance| {
        let Some(own) = sources[instance.element.index()] else { return };
        let Some(&SimilarTo { first, map }) = equal.get(own) else { return };
        if let Some(&id) = listed.get(&first).filter(|_| first != own) {
            let to = instance.affine() * origin(own).inverse() * map * origin(first);
            instance.transform = rounded(to);
            instance.element = id;
        }
    };
    scene.instances_mut().for_each(change);
    scene.drop_unused();
}
