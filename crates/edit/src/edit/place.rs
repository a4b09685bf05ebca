//! Textons moved, turned and scaled, each about its own centre.

use super::amount::Amount;
use super::selection::Chosen;
use super::style::keep_widths;
use super::textons::{measured, selected, selected_mut, size};
use vtex_base::geometry::{Affine, Point, Vec2, rotation, rounded, shortest_offset, wrapped};
use vtex_base::raster::ControlMap;
use vtex_scene::element::{Gaussian, ROUND};
use vtex_scene::scene::{About, Instance, Scene};

/// The least factor by which a texton is scaled.
const SMALLEST: f64 = 0.01;

/// The direction towards which longer axes are turned.
pub(super) enum Towards<'a> {
    /// One angle, in radians.
    Angle(f64),
    /// A map of angles: 0 to 1 is half a turn.
    Map(&'a ControlMap),
}

/// Changes the linear part of an instance's map by `about` and moves it by `by`.
pub(super) fn put(instance: &mut Instance, about: Affine, by: [f64; 2], periods: [Option<f64>; 2]) {
    let [.., x, y] = instance.transform;
    let [a, b, c, d, ..] = (about * instance.affine()).as_coeffs();
    set(instance, [a, b, c, d, x + by[0], y + by[1]], periods);
}

/// Sets the map of an instance, rounded as synthesis rounds it; where the scene repeats, its origin is
/// wrapped onto the canvas.
pub(super) fn set(instance: &mut Instance, map: [f64; 6], periods: [Option<f64>; 2]) {
    let [a, b, c, d, x, y] = map;
    let [x, y] = [wrapped(x, periods[0]), wrapped(y, periods[1])];
    let [a, b, c, d, x, y] = rounded(Affine::new([a, b, c, d, x, y]));
    // A rounded place may lie on the far edge, so it is wrapped again.
    instance.transform = [a, b, c, d, wrapped(x, periods[0]), wrapped(y, periods[1])];
}

/// Moves an instance from the frame `own` to the frame `target`; shadow and line keep their widths.
pub(crate) fn draw_as(
    instance: &mut Instance,
    drawn: &Instance,
    own: &Gaussian,
    target: &Gaussian,
    periods: [Option<f64>; 2],
) {
    let before = size(instance);
    set(instance, drawn.decoded(own, target), periods);
    keep_widths(instance, before);
}

pub(super) fn shift(scene: &mut Scene, chosen: &Chosen, by: [f64; 2]) {
    let periods = scene.periods();
    selected_mut(scene, chosen).for_each(|i| put(i, Affine::IDENTITY, by, periods));
}

/// Scales each texton by a factor that may vary over the canvas.
pub(super) fn scale(scene: &mut Scene, chosen: &Chosen, factor: &Amount<'_>) {
    each(scene, chosen, |scene, instance| Affine::scale(factor.factor(scene, instance).max(SMALLEST)));
}

/// Turns each texton by an angle in degrees that may vary over the canvas.
pub(super) fn rotate(scene: &mut Scene, chosen: &Chosen, angle: &Amount<'_>) {
    each(scene, chosen, |scene, instance| rotation(angle.of(scene, instance, 360.0).to_radians()));
}

/// Changes the linear part of each map.
fn each(scene: &mut Scene, chosen: &Chosen, about: impl Fn(&Scene, &Instance) -> Affine) {
    let changes: Vec<Affine> = selected(scene, chosen).map(|i| about(scene, i)).collect();
    let periods = scene.periods();
    for (instance, about) in selected_mut(scene, chosen).zip(changes) {
        put(instance, about, [0.0; 2], periods);
    }
}

/// Moves, turns and scales textons, each about its own centre or all about their common centre.
pub(super) fn transform(scene: &mut Scene, chosen: &Chosen, map: Affine, by: [f64; 2], about: About) {
    let periods = scene.periods();
    let centre = match about {
        About::Each => None,
        About::Selection => middle(scene, chosen),
    };
    for instance in selected_mut(scene, chosen) {
        let [.., x, y] = instance.transform;
        let way = centre.map_or(Vec2::ZERO, |centre| {
            let arm = shortest_offset(centre, Point::new(x, y), periods);
            (map * arm.to_point()).to_vec2() - arm
        });
        put(instance, map, [by[0] + way.x, by[1] + way.y], periods);
    }
}

/// Mean place of all selected instances; on a canvas that repeats, of the copies nearest to the first.
fn middle(scene: &Scene, chosen: &Chosen) -> Option<Point> {
    let places: Vec<Point> = selected(scene, chosen).map(|i| scene.place(i)).collect();
    let first = *places.first()?;
    let sum = places.iter().fold(Vec2::ZERO, |sum, p| sum + shortest_offset(first, *p, scene.periods()));
    Some(first + sum / places.len() as f64)
}

/// Turns longer axes a share of the way to a direction, the shorter way round.
pub(super) fn orient(scene: &mut Scene, chosen: &Chosen, towards: &Towards<'_>, strength: f64) {
    let moments = measured(scene);
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    let turns: Vec<f64> = selected(scene, chosen)
        .map(|instance| {
            let now = moments[instance.element.index()].moved(instance.affine());
            let wanted = match towards {
                Towards::Angle(angle) => *angle,
                Towards::Map(map) => {
                    let at = scene.place(instance);
                    map.turn_at([at.x, at.y], canvas) * std::f64::consts::PI
                }
            };
            if now.elongation() < ROUND { 0.0 } else { strength * half_turn(wanted - now.angle()) }
        })
        .collect();
    let periods = scene.periods();
    for (instance, angle) in selected_mut(scene, chosen).zip(turns) {
        if angle != 0.0 {
            put(instance, rotation(angle), [0.0; 2], periods);
        }
    }
}

/// The angle moved by half turns to between -π/2 and π/2.
fn half_turn(angle: f64) -> f64 {
    angle - std::f64::consts::PI * libm::round(angle / std::f64::consts::PI)
}
