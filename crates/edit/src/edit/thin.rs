//! Removes textons: all but a share, small ones, or those outside a map or a shape.

use super::Draw;
use super::selection::Chosen;
use super::textons::{change, measured, size};
use vtex_base::geometry::{Interior, Point};
use vtex_base::raster::ControlMap;
use vtex_base::sampling::evenly_reduced;
use vtex_scene::scene::{Instance, Scene, Shape, ThinOrder};

/// Keeps the instances for which `keep` holds, and all that are not selected. `keep` gets the unchanged
/// scene.
pub(super) fn retain(scene: &mut Scene, chosen: &Chosen, keep: impl Fn(&Scene, &Instance) -> bool) {
    let marks = scene.instances().zip(chosen.instances()).map(|(i, chosen)| !chosen || keep(scene, i));
    let marks: Vec<bool> = marks.collect();
    keep_marked(scene, &marks);
}

/// Keeps the instances that are marked, in painting order.
fn keep_marked(scene: &mut Scene, marks: &[bool]) {
    let mut rest = marks;
    for layer in &mut scene.layers {
        let (own, others) = rest.split_at(layer.instances.len());
        retain_marked(&mut layer.instances, own);
        rest = others;
    }
}

/// Keeps the items that are marked.
fn retain_marked<T>(items: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    items.retain(|_| marks.next().is_some_and(|mark| *mark));
}

/// Keeps each texton with the probability that the map has at its place.
pub(super) fn by_map(scene: &mut Scene, chosen: &Chosen, map: &ControlMap, draw: &Draw) {
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    retain(scene, chosen, |scene, instance| {
        let at = scene.place(instance);
        draw.of("edit/density", instance.id).chance(map.at([at.x, at.y], canvas))
    });
}

/// Keeps the textons whose centre lies inside a region, or those whose centre lies outside.
pub(super) fn by_region(scene: &mut Scene, chosen: &Chosen, region: &Interior, inside: bool) {
    retain(scene, chosen, |scene, instance| region.contains(scene.place(instance)) == inside);
}

/// Removes small textons and details, then all but a share of each layer.
pub(super) fn thin(
    scene: &mut Scene,
    chosen: &Chosen,
    keep: Option<f64>,
    order: ThinOrder,
    minimum_area: Option<f64>,
    draw: &Draw,
) {
    let mut chosen = chosen.clone();
    if let Some(least) = minimum_area {
        let moments = measured(scene);
        let large = |i: &Instance| moments[i.element.index()].moved(i.affine()).area >= least;
        for (layer, chosen) in scene.layers.iter_mut().zip(&mut chosen.layers) {
            let stays: Vec<bool> = layer
                .instances
                .iter()
                .zip(&chosen.instances)
                .map(|(i, chosen)| !chosen || large(i))
                .collect();
            retain_marked(&mut layer.instances, &stays);
            retain_marked(&mut chosen.instances, &stays);
        }
        change(scene, &chosen, |element, size| {
            let large = |s: &&Shape| s.outline.area() * size * size >= least;
            let details = element.details().iter().filter(large);
            element.with_shapes(std::iter::once(element.base()).chain(details).cloned().collect())
        });
    }
    let Some(share) = keep else { return };
    let marks = scene.layers.iter().zip(&chosen.layers);
    let marks = marks.flat_map(|(layer, c)| kept(scene, &layer.instances, &c.instances, share, order, draw));
    let marks: Vec<bool> = marks.collect();
    keep_marked(scene, &marks);
}

/// The instances of a layer that remain when a share of the selected ones is kept.
fn kept(
    scene: &Scene,
    instances: &[Instance],
    chosen: &[bool],
    share: f64,
    order: ThinOrder,
    draw: &Draw,
) -> Vec<bool> {
    let selected: Vec<usize> = (0..instances.len()).filter(|&i| chosen[i]).collect();
    let count = libm::round(share * selected.len() as f64) as usize;
    let random = |i: usize| draw.of("edit/thin", instances[i].id).bits();
    let mut kept: Vec<bool> = chosen.iter().map(|chosen| !chosen).collect();
    let mut keep = |i: usize| kept[i] = true;
    match order {
        ThinOrder::Random => {
            let mut ranked: Vec<(u64, usize)> = selected.iter().map(|&i| (random(i), i)).collect();
            ranked.sort_unstable();
            ranked[..count].iter().for_each(|&(_, i)| keep(i));
        }
        ThinOrder::Area => {
            let areas: Vec<f64> = scene.elements.iter().map(|t| t.outline().area()).collect();
            let area = |i: usize| {
                let size = size(&instances[i]);
                areas[instances[i].element.index()] * size * size
            };
            let mut ranked: Vec<(f64, usize)> = selected.iter().map(|&i| (area(i), i)).collect();
            ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            ranked[..count].iter().for_each(|&(_, i)| keep(i));
        }
        ThinOrder::BlueNoise => {
            let points: Vec<Point> = selected.iter().map(|&i| scene.place(&instances[i])).collect();
            let ties: Vec<u64> = selected.iter().map(|&i| random(i)).collect();
            let left = evenly_reduced(&points, &ties, scene.periods(), count);
            left.into_iter().for_each(|k| keep(selected[k]));
        }
    }
    kept
}
