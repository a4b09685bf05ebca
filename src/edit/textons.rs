//! The textons that instances share: measured, changed for some of them, dropped when none is left.

use super::selection::Chosen;
use crate::geometry::SecondMoments;
use crate::parallel;
use crate::scene::{Instance, Scene, Texton};

/// The moments of every texton's outline, in its own coordinates.
pub(super) fn measured(scene: &Scene) -> Vec<SecondMoments> {
    parallel::map(&scene.textons, |texton| SecondMoments::new(&texton.outline))
}

/// How much larger an instance is than its texton: the square root of the ratio of areas.
pub(super) fn size(instance: &Instance) -> f64 {
    libm::sqrt(instance.affine().determinant().abs())
}

/// The selected instances, secondaries first.
pub(super) fn selected<'a>(scene: &'a Scene, chosen: &'a Chosen) -> impl Iterator<Item = &'a Instance> {
    let pairs = [(&scene.secondary, &chosen.secondary), (&scene.primary, &chosen.primary)];
    let pairs = pairs.into_iter().flat_map(|(all, chosen)| all.iter().zip(chosen));
    pairs.filter(|(_, chosen)| **chosen).map(|(instance, _)| instance)
}

/// As [`selected`], to change them.
pub(super) fn selected_mut<'a>(
    scene: &'a mut Scene,
    chosen: &'a Chosen,
) -> impl Iterator<Item = &'a mut Instance> {
    let pairs = [(&mut scene.secondary, &chosen.secondary), (&mut scene.primary, &chosen.primary)];
    let pairs = pairs.into_iter().flat_map(|(all, chosen)| all.iter_mut().zip(chosen));
    pairs.filter(|(_, chosen)| **chosen).map(|(instance, _)| instance)
}

/// Changes the textons of the selected instances. `change` gets a texton and the largest size at
/// which a selected instance shows it; instances that are not selected keep the texton as it was.
pub(super) fn change(
    scene: &mut Scene,
    chosen: &Chosen,
    change: impl Fn(&Texton, f64) -> Texton + Sync + Send,
) {
    let count = scene.textons.len();
    let mut largest = vec![None::<f64>; count];
    for instance in selected(scene, chosen) {
        let known = &mut largest[instance.texton as usize];
        *known = Some(known.unwrap_or(0.0).max(size(instance)));
    }
    let mut kept = vec![false; count];
    let pairs = [(&scene.secondary, &chosen.secondary), (&scene.primary, &chosen.primary)];
    for (instances, chosen) in pairs {
        for (instance, chosen) in instances.iter().zip(chosen) {
            kept[instance.texton as usize] |= !chosen;
        }
    }
    let concerned: Vec<(usize, f64)> =
        largest.iter().enumerate().filter_map(|(i, size)| Some((i, (*size)?))).collect();
    let changed = parallel::map(&concerned, |&(i, size)| change(&scene.textons[i], size));
    let mut target: Vec<u32> = (0..count as u32).collect();
    for ((i, _), texton) in concerned.into_iter().zip(changed) {
        if kept[i] {
            target[i] = scene.textons.len() as u32;
            scene.textons.push(texton);
        } else {
            scene.textons[i] = texton;
        }
    }
    for instance in selected_mut(scene, chosen) {
        instance.texton = target[instance.texton as usize];
    }
}
