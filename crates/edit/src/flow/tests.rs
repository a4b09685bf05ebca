//! Scenes in a flow.

use super::*;
use vtex_base::document::Document;
use vtex_base::geometry::{Outline, parse_path};
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::stream;
use vtex_scene::scene::{ElementId, testing};

const CANVAS: [f64; 2] = [400.0, 300.0];

/// Small bars on a canvas that repeats, none across a border.
pub(super) fn scene() -> Scene {
    let outline = Outline::new(&parse_path("M-4-2h8v4h-8z").unwrap()).unwrap();
    let bar = testing::element(0, Some(0), outline, Colour([90; 3]));
    let mut random = stream(1, "test/flow", 0);
    let primary = (0..120).map(|k| {
        let at = [random.range(9.0, 391.0), random.range(9.0, 291.0)].map(libm::round);
        let transform =
            (Affine::translate((at[0], at[1])) * vtex_base::geometry::rotation(f64::from(k))).as_coeffs();
        Instance { transform, ..Instance::new(InstanceId(k), ElementId(0)) }
    });
    let primary = primary.collect();
    let scene = testing::scene([400, 300], vec![bar], Vec::new(), primary, testing::flat(Colour([9; 3])));
    Scene { tile: Tile { x: true, y: true }, ..scene }
}

fn flows() -> [Flow; 4] {
    let map = ControlMap::new(2, 2, vec![0.1, 0.3, 0.6, 0.2]).unwrap();
    [Flow::Shear, Flow::Vortex, Flow::Wind, Flow::Field(map)]
}

fn flowing(flow: &Flow) -> Flowing {
    Flowing::new(&scene(), flow, &FlowParams::default()).unwrap()
}

fn place(i: &Instance) -> Point {
    Point::new(i.transform[4], i.transform[5])
}

/// The instances that reach the canvas.
fn seen(scene: &Scene) -> Vec<&Instance> {
    let near = |p: Point| (-5.0..CANVAS[0] + 5.0).contains(&p.x) && (-5.0..CANVAS[1] + 5.0).contains(&p.y);
    scene.primary().iter().filter(|i| near(place(i))).collect()
}

#[test]
fn a_loop_begins_and_ends_with_the_scene() {
    for flow in flows() {
        let flowing = flowing(&flow);
        for time in [0.0, 1.0] {
            let first = flowing.at(time);
            let found = seen(&first);
            assert_eq!(found.len(), 120, "{flow:?}");
            for (a, b) in found.iter().zip(scene().primary()) {
                let same = a.transform.iter().zip(b.transform).all(|(a, b)| (a - b).abs() < 1e-9);
                assert!(same && a.id == b.id, "{flow:?} {a:?} {b:?}");
            }
        }
        flowing.at(0.37).validate().unwrap();
    }
}

#[test]
fn a_vortex_keeps_radii_and_turns_evenly() {
    let flowing = flowing(&Flow::Vortex);
    let middle = Point::new(200.0, 150.0);
    let (from, to) = (flowing.at(0.0), flowing.at(0.3));
    for (a, b) in from.primary().iter().zip(to.primary()) {
        let arms = [a, b].map(|i| place(i) - middle);
        let [r, s] = arms.map(|v| libm::sqrt(v.hypot2()));
        assert!((r - s).abs() < 1e-6, "{r} {s}");
        let turn = libm::atan2(arms[0].cross(arms[1]), arms[0].dot(arms[1]));
        let wanted = 0.3 * std::f64::consts::TAU;
        assert!((turn - wanted).abs() < 1e-6, "{turn}");
    }
    // The number of elements on the canvas stays about the same, so corners are never empty.
    for time in [0.1, 0.2, 0.4, 0.77] {
        let count = seen(&flowing.at(time)).len();
        assert!(count.abs_diff(120) < 24, "{time}: {count}");
    }
}

#[test]
fn a_shear_moves_bands_and_wraps() {
    let flowing = flowing(&Flow::Shear);
    let original = scene();
    for time in [0.25, 0.5, 0.9] {
        let now = flowing.at(time);
        assert_eq!(now.count(), flowing.count());
        for i in now.primary().iter().filter(|i| i.id.0 < 120) {
            let (from, to) = (place(&original.primary()[i.id.0 as usize]), place(i));
            assert!((to.y - from.y).abs() < 1e-9);
            let far = (to.x - from.x).rem_euclid(400.0);
            let wanted = match from.y {
                y if y < 100.0 => -400.0 * time,
                y if y > 200.0 => 400.0 * time,
                _ => 0.0,
            };
            let off = (far - wanted).rem_euclid(400.0);
            let off = off.min(400.0 - off);
            assert!(off < 30.0 && ((100.0..200.0).contains(&from.y)) <= (off == 0.0), "{off}");
        }
    }
}

#[test]
fn nothing_that_is_seen_jumps() {
    for flow in flows() {
        let flowing = flowing(&flow);
        let frames = 120;
        let mut before = flowing.at(0.0);
        for k in 1..=frames {
            let now = flowing.at(f64::from(k) / f64::from(frames));
            let old: std::collections::BTreeMap<_, _> = before.primary().iter().map(|i| (i.id, i)).collect();
            for i in seen(&now) {
                let size = |i: &Instance| libm::sqrt(i.affine().determinant());
                // An element that jumps is too small to be visible, or comes from outside the canvas.
                if let Some(b) = old.get(&i.id).filter(|b| place(b).distance(place(i)) > 20.0) {
                    let outside = !seen(&before).iter().any(|s| s.id == b.id);
                    // Or a copy replaces it: bars are identified by their direction.
                    let same = |s: &Instance| (0..4).all(|k| (s.transform[k] - i.transform[k]).abs() < 1e-6);
                    let copy = before.primary().iter().any(|s| same(s) && place(s).distance(place(i)) < 20.0);
                    assert!(size(i) < 0.35 || outside || copy, "{flow:?} {k} {i:?} {b:?}");
                }
            }
            before = now;
        }
    }
}

#[test]
fn strange_parameters_are_refused() {
    for params in [
        FlowParams { rounds: 0, ..FlowParams::default() },
        FlowParams { strength: f64::NAN, ..FlowParams::default() },
    ] {
        assert!(matches!(
            Flowing::new(&scene(), &Flow::Wind, &params),
            Err(vtex_base::Error::Parameter { .. })
        ));
    }
    let empty = testing::scene([9, 9], Vec::new(), Vec::new(), Vec::new(), testing::flat(Colour([0; 3])));
    assert_eq!(Flowing::new(&empty, &Flow::Vortex, &FlowParams::default()).unwrap().at(0.4).count(), 0);
}

#[test]
fn copies_have_ids_of_their_own_even_if_the_last_is_taken() {
    let mut before = scene();
    before.layers.iter_mut().flat_map(|l| &mut l.instances).last().unwrap().id = InstanceId(u32::MAX);
    let flowing = Flowing::new(&before, &Flow::Vortex, &FlowParams::default()).unwrap();
    assert!(flowing.count() > before.count());
    assert_eq!(flowing.at(0.3).validate(), Ok(()));
}
