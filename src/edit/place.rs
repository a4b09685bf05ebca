//! Textons moved, turned and scaled, each about its own centre.

use super::Draw;
use super::selection::{Chosen, place};
use super::textons::{measured, selected_mut};
use crate::geometry::{Affine, wrapped};
use crate::raster::ControlMap;
use crate::scene::{Instance, Scene};

/// Textons less elongated than this have no longer axis to speak of.
const ROUND: f64 = 1.05;

/// Where longer axes are turned.
pub(super) enum Towards<'a> {
    /// Everywhere the same, in radians.
    Angle(f64),
    /// By place: 0 to 1 is half a turn.
    Map(&'a ControlMap),
}

/// Changes the linear part of an instance's map by `about` and moves it by `by`.
fn put(instance: &mut Instance, about: Affine, by: [f64; 2], periods: [Option<f64>; 2]) {
    let [.., x, y] = instance.transform;
    let [a, b, c, d, ..] = (about * instance.affine()).as_coeffs();
    set(instance, [a, b, c, d, x + by[0], y + by[1]], periods);
}

/// Gives an instance a map of numbers as long as those of synthesis; where the scene repeats, its
/// origin comes onto the canvas.
pub(super) fn set(instance: &mut Instance, map: [f64; 6], periods: [Option<f64>; 2]) {
    let along = |v: f64, period: Option<f64>| {
        // A rounded place may lie on the far edge.
        wrapped(libm::round(wrapped(v, period) * 100.0) / 100.0, period)
    };
    let [a, b, c, d, x, y] = map;
    let [a, b, c, d] = [a, b, c, d].map(|v| libm::round(v * 1e5) / 1e5);
    instance.transform = [a, b, c, d, along(x, periods[0]), along(y, periods[1])];
}

pub(super) fn shift(scene: &mut Scene, chosen: &Chosen, by: [f64; 2]) {
    let periods = scene.periods();
    selected_mut(scene, chosen).for_each(|i| put(i, Affine::IDENTITY, by, periods));
}

pub(super) fn scale(scene: &mut Scene, chosen: &Chosen, factor: f64) {
    let periods = scene.periods();
    selected_mut(scene, chosen).for_each(|i| put(i, Affine::scale(factor), [0.0; 2], periods));
}

pub(super) fn rotate(scene: &mut Scene, chosen: &Chosen, angle: f64) {
    let (periods, turn) = (scene.periods(), turn(angle.to_radians()));
    selected_mut(scene, chosen).for_each(|i| put(i, turn, [0.0; 2], periods));
}

/// Moves, turns and scales each texton at random: evenly within a disc of radius `distance` pixels,
/// by at most `angle` degrees and `scale` per cent either way.
pub(super) fn jitter(scene: &mut Scene, chosen: &Chosen, distance: f64, angle: f64, scale: f64, draw: &Draw) {
    let periods = scene.periods();
    for instance in selected_mut(scene, chosen) {
        let mut random = draw.of("edit/jitter", instance.id);
        let (radius, towards) =
            (distance * libm::sqrt(random.unit()), random.range(0.0, std::f64::consts::TAU));
        let by = [radius * libm::cos(towards), radius * libm::sin(towards)];
        let angle = random.range(-angle, angle).to_radians();
        let factor = 1.0 + random.range(-scale, scale) / 100.0;
        put(instance, Affine::scale(factor) * turn(angle), by, periods);
    }
}

/// Turns longer axes a share of the way to a direction, the shorter way round.
pub(super) fn orient(scene: &mut Scene, chosen: &Chosen, towards: &Towards<'_>, strength: f64) {
    let moments = measured(scene);
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    let turns: Vec<f64> = super::textons::selected(scene, chosen)
        .map(|instance| {
            let now = moments[instance.element.index()].moved(instance.affine());
            let wanted = match towards {
                Towards::Angle(angle) => *angle,
                Towards::Map(map) => {
                    let at = place(scene, instance);
                    map.at([at.x, at.y], canvas) * std::f64::consts::PI
                }
            };
            if now.elongation() < ROUND { 0.0 } else { strength * half_turn(wanted - now.angle()) }
        })
        .collect();
    let periods = scene.periods();
    for (instance, angle) in selected_mut(scene, chosen).zip(turns) {
        if angle != 0.0 {
            put(instance, turn(angle), [0.0; 2], periods);
        }
    }
}

/// The angle moved by half turns to between -π/2 and π/2.
fn half_turn(angle: f64) -> f64 {
    angle - std::f64::consts::PI * libm::round(angle / std::f64::consts::PI)
}

fn turn(angle: f64) -> Affine {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    Affine::new([cosine, sine, -sine, cosine, 0.0, 0.0])
}
