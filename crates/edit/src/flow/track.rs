//! The path of an element through a loop as a few keys with linear motion between them, for animated
//! documents.

use super::Now;
use super::paths::Path;
use vtex_base::geometry::Vec2;

/// Largest deviation of the keys from the path: in pixels, radians, and shares of the element's size.
const TOLERANCE: [f64; 3] = [0.25, 0.01, 0.02];
/// Time between two keys of an instantaneous change, as a share of the loop.
const INSTANT: f64 = 1e-6;

/// A position of an element on its path, relative to its place in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Share of the loop, 0 to 1.
    pub time: f64,
    /// Offset from its place, in pixels.
    pub way: Vec2,
    /// Angle by which it is turned about its place, in radians.
    pub angle: f64,
    /// Factor of its size about its place.
    pub size: f64,
}

impl Key {
    /// The key interpolated between two, at a time between theirs.
    fn between(a: &Self, b: &Self, time: f64) -> Self {
        let share = (time - a.time) / (b.time - a.time).max(f64::MIN_POSITIVE);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let way = a.way.lerp(b.way, share);
        Self { time, way, angle: mix(a.angle, b.angle), size: mix(a.size, b.size) }
    }

    /// Deviation of another key, in tolerances.
    fn off(&self, other: &Self) -> f64 {
        let way = libm::sqrt((self.way - other.way).hypot2()) / TOLERANCE[0];
        let angle = (self.angle - other.angle).abs() / TOLERANCE[1];
        way.max(angle).max((self.size - other.size).abs() / TOLERANCE[2])
    }
}

/// Keys from the beginning of a loop to its end, in order of time; two at almost the same time where an
/// element vanishes and reappears elsewhere. Empty if the element rests.
pub(super) fn keys(path: &Path) -> Vec<Key> {
    if matches!(path, Path::Still) {
        return Vec::new();
    }
    // Changes at the ends of the loop are moved within it.
    let within = |time: f64| time.clamp(3.0 * INSTANT, 1.0 - 3.0 * INSTANT);
    let mut ends: Vec<f64> = path.jumps().into_iter().map(within).collect();
    ends.sort_by(f64::total_cmp);
    ends.push(1.0);
    ends.dedup();
    let mut keys = Vec::new();
    let mut begin = 0.0;
    for end in ends {
        let last = if end < 1.0 { end - INSTANT } else { end };
        let samples = libm::ceil(path.samples() * (last - begin)).max(1.0) as usize;
        let key = |k: usize| {
            let time = begin + (last - begin) * (k as f64 / samples as f64);
            let Now { way, angle, size } = path.at(time);
            Key { time, way, angle, size }
        };
        let all: Vec<Key> = (0..=samples).map(key).collect();
        keep(&all, &mut keys);
        keys.push(all[samples]);
        begin = end + INSTANT;
    }
    if keys.iter().all(|key| key.off(&keys[0]) < 1.0) { Vec::new() } else { keys }
}

/// Adds the keys of `all` that are needed, except the last (Douglas and Peucker).
fn keep(all: &[Key], kept: &mut Vec<Key>) {
    let (first, last) = (all[0], all[all.len() - 1]);
    let off = |key: &Key| key.off(&Key::between(&first, &last, key.time));
    let worst = (1..all.len().saturating_sub(1)).map(|k| (k, off(&all[k])));
    match worst.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))) {
        Some((k, far)) if far > 1.0 => {
            keep(&all[..=k], kept);
            keep(&all[k..], kept);
        }
        _ => kept.push(first),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::{Flow, FlowParams, Flowing};
    use vtex_base::raster::ControlMap;

    /// The interpolated key at a time.
    fn at(keys: &[Key], time: f64) -> Key {
        let after = keys.iter().position(|key| key.time >= time).unwrap().max(1);
        Key::between(&keys[after - 1], &keys[after], time)
    }

    #[test]
    fn keys_lead_where_the_flow_does() {
        let mut scene = crate::flow::tests::scene();
        // An element on the border, which crosses it at the ends of a loop.
        let on_border = scene.layers.iter_mut().rev().find_map(|layer| layer.instances.first_mut()).unwrap();
        on_border.transform[4] = 0.0;
        let field = Flow::Field(ControlMap::new(2, 1, vec![0.1, 0.4]).unwrap());
        for flow in [Flow::Shear, Flow::Vortex, Flow::Wind, field] {
            let params = FlowParams { rounds: 2, strength: 3.0, seed: 5 };
            let flowing = Flowing::new(&scene, &flow, &params).unwrap();
            assert_eq!(flowing.rounds(), (flow == Flow::Vortex).then_some(2.0));
            let ways = flowing.ways();
            assert_eq!(ways.len(), flowing.scene().count());
            assert!(ways.iter().any(|keys| !keys.is_empty()));
            for (path, keys) in flowing.paths.iter().zip(&ways).filter(|(_, keys)| !keys.is_empty()) {
                assert_eq!((keys[0].time, keys[keys.len() - 1].time), (0.0, 1.0));
                assert!(keys.is_sorted_by(|a, b| a.time < b.time) && keys.len() < 400, "{}", keys.len());
                for step in 0..997 {
                    let time = f64::from(step) / 997.0;
                    let Now { way, angle, size } = path.at(time);
                    let key = at(keys, time);
                    let wanted = Key { time, way, angle, size };
                    // Between samples the deviation may be a little larger than at them.
                    assert!(key.off(&wanted) < 1.6, "{flow:?} {time} {key:?} {wanted:?}");
                }
            }
        }
    }
}
