//! Measures the elements that instances share, and changes them for some instances.

use super::selection::Chosen;
use vtex_base::geometry::SecondMoments;
use vtex_base::parallel;
use vtex_base::raster::oklab_map::OklabMap;
use vtex_scene::scene::{Element, ElementId, Instance, Repaint, Scene};

/// The moments of every element's outline, in its own coordinates.
pub(super) fn measured(scene: &Scene) -> Vec<SecondMoments> {
    parallel::map(&scene.elements, |element| SecondMoments::new(element.outline()))
}

/// The scale of an instance relative to its element: the square root of the ratio of areas.
pub(super) fn size(instance: &Instance) -> f64 {
    libm::sqrt(instance.affine().determinant().abs())
}

/// The selected instances, in painting order.
pub(super) fn selected<'a>(scene: &'a Scene, chosen: &'a Chosen) -> impl Iterator<Item = &'a Instance> {
    let all = scene.instances().zip(chosen.instances());
    all.filter(|(_, chosen)| *chosen).map(|(instance, _)| instance)
}

/// As [`selected`], mutable.
pub(super) fn selected_mut<'a>(
    scene: &'a mut Scene,
    chosen: &'a Chosen,
) -> impl Iterator<Item = &'a mut Instance> {
    let all = scene.instances_mut().zip(chosen.instances());
    all.filter(|(_, chosen)| *chosen).map(|(instance, _)| instance)
}

/// Recolours each selected instance by its own map; `maps` has one for each.
pub(super) fn repaint(scene: &mut Scene, chosen: &Chosen, maps: &[OklabMap]) {
    let mut elements = std::mem::take(&mut scene.elements);
    let mut repaint = Repaint::default();
    for (instance, map) in selected_mut(scene, chosen).zip(maps) {
        repaint.paint(&mut elements, instance, map);
    }
    scene.elements = elements;
}

/// Changes the elements of the selected instances. `change` gets an element and the largest size at
/// which a selected instance shows it; instances that are not selected keep the element as it was.
pub(super) fn change(
    scene: &mut Scene,
    chosen: &Chosen,
    change: impl Fn(&Element, f64) -> Element + Sync + Send,
) {
    let count = scene.elements.len();
    let mut largest = vec![None::<f64>; count];
    for instance in selected(scene, chosen) {
        let known = &mut largest[instance.element.index()];
        *known = Some(known.unwrap_or(0.0).max(size(instance)));
    }
    let mut kept = vec![false; count];
    for (instance, chosen) in scene.instances().zip(chosen.instances()) {
        kept[instance.element.index()] |= !chosen;
    }
    let concerned: Vec<(usize, f64)> =
        largest.iter().enumerate().filter_map(|(i, size)| Some((i, (*size)?))).collect();
    let changed = parallel::map(&concerned, |&(i, size)| change(&scene.elements[i], size));
    let mut target: Vec<ElementId> = (0..count).map(ElementId::after).collect();
    for ((i, _), element) in concerned.into_iter().zip(changed) {
        if kept[i] {
            target[i] = scene.add(element);
        } else {
            scene.elements[i] = element;
        }
    }
    for instance in selected_mut(scene, chosen) {
        instance.element = target[instance.element.index()];
    }
}
