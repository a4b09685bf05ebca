//! Variation of appearances and shapes, reduced or increased (Tu, dissertation, equations 4.25 to 4.30).

use super::amount::Amount;
use super::groups::groups;
use super::place::draw_as;
use super::selection::Chosen;
use super::uncovering::uncovering;
use vtex_base::geometry::Lower;
use vtex_base::raster::oklab_map::OklabMap;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{Instance, Repaint, Scene, Within};

/// Scales the deviation of each texton's colours from the mean of its group.
pub(super) fn colours(scene: &mut Scene, chosen: &Chosen, factor: &Amount<'_>, within: Within) {
    let appearances = scene.appearances();
    let factors: Vec<f64> = scene.instances().map(|i| factor.factor(scene, i)).collect();
    let mut maps = vec![OklabMap::IDENTITY; appearances.len()];
    for group in groups(scene, chosen, within) {
        let mut sum = [0.0; 3];
        for &i in &group {
            (0..3).for_each(|k| sum[k] += f64::from(appearances[i].median[k]));
        }
        let mean = sum.map(|v| v / group.len() as f64);
        for i in group {
            let of = appearances[i].median;
            let further = factors[i] - 1.0;
            let by = std::array::from_fn(|k| (further * (f64::from(of[k]) - mean[k])) as f32);
            maps[i] = OklabMap::shift(by);
        }
    }
    let mut elements = std::mem::take(&mut scene.elements);
    let mut repaint = Repaint::default();
    for (instance, map) in scene.instances_mut().zip(&maps) {
        repaint.paint(&mut elements, instance, map);
    }
    scene.elements = elements;
}

/// Scales the deviation of each texton's covariance from the mean of its group: with U = L·Lᵀ, the mean Ū =
/// L̄·L̄ᵀ and W = L·L̄⁻¹, it becomes Wᵗ·Ū·(Wᵗ)ᵀ. Centres do not move. Textons that grow are painted before the smaller
/// ones that they now overlap. Returns the number of textons that stay unchanged because they are too thin, or would
/// become so.
pub(super) fn shapes(scene: &mut Scene, chosen: &Chosen, factor: &Amount<'_>, within: Within) -> usize {
    let gaussians = scene.gaussians();
    let factors: Vec<f64> = scene.instances().map(|i| factor.factor(scene, i)).collect();
    let mut targets: Vec<Option<Gaussian>> = vec![None; gaussians.len()];
    let mut thin = 0;
    for group in groups(scene, chosen, within) {
        let roots: Vec<(usize, Gaussian, Lower)> = group
            .iter()
            .filter_map(|&i| gaussians[i].and_then(|g| Some((i, g, Lower::root(g.covariance)?))))
            .collect();
        thin += group.len() - roots.len();
        let mut sum = [0.0; 3];
        for (_, g, _) in &roots {
            (0..3).for_each(|k| sum[k] += g.covariance[k]);
        }
        let mean = sum.map(|v| v / roots.len() as f64);
        let Some(middle) = Lower::root(mean) else { continue };
        for (i, own, root) in roots {
            if factors[i] != 1.0 {
                let away = root.times(middle.inverse()).power(factors[i]);
                let target = own.with(away.map(mean), own.direction);
                targets[i] = Some(target).filter(|t| !t.is_degenerate());
                thin += usize::from(targets[i].is_none());
            }
        }
    }
    let periods = scene.periods();
    for ((instance, own), target) in scene.instances_mut().zip(&gaussians).zip(&targets) {
        if let (Some(own), Some(target)) = (own, target) {
            let was = instance.clone();
            draw_as(instance, &was, own, target, periods);
        }
    }
    let mut first = 0;
    for layer in &mut scene.layers {
        let own = first..first + layer.instances.len();
        first = own.end;
        let order = uncovering(&gaussians[own.clone()], &targets[own], periods);
        if !order.is_sorted() {
            let places = order.into_iter().zip(&layer.instances);
            let moved = |(i, place): (usize, &Instance)| Instance {
                height: place.height,
                ..layer.instances[i].clone()
            };
            layer.instances = places.map(moved).collect();
        }
    }
    thin
}
