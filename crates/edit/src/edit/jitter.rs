//! Elements moved, turned, scaled, stretched, mirrored and recoloured at random, each on its own.

use super::Draw;
use super::place::{put, set};
use super::selection::Chosen;
use super::textons::{measured, repaint, selected, selected_mut};
use vtex_base::geometry::{Affine, rotation};
use vtex_base::raster::oklab_map::OklabMap;
use vtex_base::sampling::Stream;
use vtex_scene::scene::{Distribution, Instance, Jitter, Scene};

/// Random amounts between bounds.
struct Amounts<'a> {
    jitter: &'a Jitter,
    random: Stream,
}

impl Amounts<'_> {
    /// A signed amount of at most `most`.
    fn either_way(&mut self, most: f64) -> f64 {
        let steps = u64::from(self.jitter.steps);
        match self.jitter.distribution {
            // Both ends are as likely as each step between them.
            Distribution::Uniform if steps > 0 => {
                most * (self.random.below(2 * steps + 1) as f64 / steps as f64 - 1.0)
            }
            Distribution::Uniform => self.random.range(-most, most),
            Distribution::Normal => most * self.stepped(|random| random.normal() / 2.0),
        }
    }

    /// A share of a disc's radius, 0 to 1, such that points at this distance are uniform over the disc.
    fn radius(&mut self) -> f64 {
        match self.jitter.distribution {
            Distribution::Uniform => self.stepped(|random| libm::sqrt(random.unit())),
            Distribution::Normal => self.stepped(|random| {
                let (x, y) = (random.normal(), random.normal());
                libm::sqrt(x * x + y * y) / 2.0
            }),
        }
    }

    /// A number drawn until its absolute value is at most 1, rounded to steps if there are any.
    fn stepped(&mut self, draw: impl Fn(&mut Stream) -> f64) -> f64 {
        let steps = f64::from(self.jitter.steps);
        loop {
            let value = draw(&mut self.random);
            if value.abs() <= 1.0 {
                return if steps > 0.0 { libm::round(value * steps) / steps } else { value };
            }
        }
    }
}

/// Changes each selected texton by random amounts.
pub(super) fn jitter(scene: &mut Scene, chosen: &Chosen, jitter: &Jitter, draw: &Draw) {
    let angles: Vec<f64> = if jitter.stretch > 0.0 {
        measured(scene).iter().map(|m| m.angle()).collect()
    } else {
        vec![0.0; scene.elements.len()]
    };
    let (periods, recolours) = (scene.periods(), [jitter.hue, jitter.chroma, jitter.lightness] != [0.0; 3]);
    let mut maps = Vec::with_capacity(if recolours { selected(scene, chosen).count() } else { 0 });
    for instance in selected_mut(scene, chosen) {
        let mut amounts = Amounts { jitter, random: draw.of("edit/jitter", instance.id) };
        placed(instance, &mut amounts, angles[instance.element.index()], periods);
        if recolours {
            let hue = amounts.either_way(jitter.hue).to_radians();
            let chroma = 1.0 + amounts.either_way(jitter.chroma) / 100.0;
            maps.push(OklabMap::adjust(hue, chroma, amounts.either_way(jitter.lightness) / 100.0));
        }
    }
    repaint(scene, chosen, &maps);
}

/// Changes the place, angle, size and shape of an instance; `angle` is that of its element's longer axis.
fn placed(instance: &mut Instance, amounts: &mut Amounts<'_>, angle: f64, periods: [Option<f64>; 2]) {
    let jitter = amounts.jitter;
    let radius = jitter.distance * amounts.radius();
    let towards = amounts.random.range(0.0, std::f64::consts::TAU);
    let by = [radius * libm::cos(towards), radius * libm::sin(towards)];
    let turned = amounts.either_way(jitter.angle).to_radians();
    let factor = 1.0 + amounts.either_way(jitter.scale) / 100.0;
    put(instance, Affine::scale(factor) * rotation(turned), by, periods);
    if jitter.stretch > 0.0 {
        let ratio = libm::sqrt(1.0 + amounts.either_way(jitter.stretch) / 100.0);
        let stretched = rotation(angle) * Affine::scale_non_uniform(ratio, 1.0 / ratio) * rotation(-angle);
        map_first(instance, stretched, periods);
    }
    if jitter.flip > 0.0 && amounts.random.chance(jitter.flip) {
        map_first(instance, Affine::FLIP_X, periods);
    }
}

/// Changes an instance's map before it is applied.
fn map_first(instance: &mut Instance, map: Affine, periods: [Option<f64>; 2]) {
    let [.., x, y] = instance.transform;
    let [a, b, c, d, ..] = (instance.affine() * map).as_coeffs();
    set(instance, [a, b, c, d, x, y], periods);
}
