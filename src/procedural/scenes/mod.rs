//! What each kind of scene is made of: elements, ground, layout and light, drawn at random.

mod plants;
mod stones;

use super::Kind;
use super::SceneParams;
use super::fills::{Light, Style, blend, hex};
use super::ground::{Grains, Ground};
use super::layout::Layout;
use super::render::Shadow;
use super::species::{Form, Species};
use crate::sampling::{Stream, stream};

/// All that a scene is made of.
#[derive(Clone, Debug)]
pub(super) struct Look {
    pub(super) layout: Layout,
    /// What carries labels, with weights.
    pub(super) species: Vec<(f64, Species)>,
    /// Smallest and largest radius in pixels (of circles of the same area).
    pub(super) radius: [f32; 2],
    /// Exponent of the power law that radii follow.
    pub(super) exponent: f64,
    pub(super) ground: Ground,
    /// What grows below and above the elements without a label, and its radius; amounts are
    /// areas of it in areas of the picture.
    pub(super) growth: Vec<Species>,
    pub(super) growth_radius: f32,
    pub(super) below: f64,
    pub(super) above: f64,
    pub(super) shadow: Option<Shadow>,
    /// Share of the light that what lies scattered deepest does not get.
    pub(super) depth: f32,
    /// Unit vector to the light, z towards the camera.
    pub(super) light: [f32; 3],
}

impl Look {
    /// A radius from the truncated power law.
    pub(super) fn draw_radius(&self, random: &mut Stream) -> f32 {
        let [low, high] = self.radius.map(f64::from);
        let e = 1.0 - self.exponent;
        let (a, b) = (libm::pow(low, e), libm::pow(high, e));
        libm::pow(a + (b - a) * random.unit(), 1.0 / e) as f32
    }

    /// One of the species, by weight.
    pub(super) fn species(&self, random: &mut Stream) -> &Species {
        let i = random.weighted(self.species.iter().map(|(w, _)| *w)).unwrap_or(0);
        &self.species[i].1
    }

    /// The look of a scene.
    pub(super) fn of(params: &SceneParams) -> Self {
        let random = &mut stream(params.seed, "procedural/look", 0);
        let mut look = match params.kind {
            Kind::Terrazzo => stones::terrazzo(random),
            Kind::Concrete => stones::concrete(random),
            Kind::Worktop => stones::worktop(random),
            Kind::Gravel => stones::gravel(random),
            Kind::Pebbles => stones::pebbles(random),
            Kind::MudStones => stones::mud_stones(random),
            Kind::Leaves => plants::leaves(random),
            Kind::Litter => plants::litter(random),
            Kind::Flowers => plants::flowers(random),
            Kind::Flakes => stones::flakes(random),
            Kind::Blades => plants::blades(random),
            Kind::Meadow => plants::meadow(random),
            Kind::Mixed => mixed(random),
        };
        let largest = 0.5 * params.size as f32;
        let smallest = (largest / random.range(2.0, 6.0) as f32).max(3.2);
        look.radius = [smallest, largest.max(1.05 * smallest)];
        look.growth_radius = (largest * 0.2).clamp(3.0, 6.0);
        let mean = blend(look.ground.base, look.ground.second, 0.5 * look.ground.broad);
        for (_, species) in &mut look.species {
            for colour in &mut species.palette {
                *colour = blend(mean, *colour, params.contrast as f32);
            }
        }
        if let Some(shadow) = &mut look.shadow {
            let reach = (0.16 * largest).clamp(0.8, 5.0);
            let length = (look.light[0] * look.light[0] + look.light[1] * look.light[1]).sqrt().max(0.1);
            shadow.offset = [-look.light[0] / length * reach, -look.light[1] / length * reach];
            shadow.softness = (0.9 * reach).max(1.0);
        }
        look
    }
}

fn pick<T: Clone>(random: &mut Stream, choices: &[T]) -> T {
    choices[random.index(choices.len())].clone()
}

fn range(random: &mut Stream, low: f64, high: f64) -> f32 {
    random.range(low, high) as f32
}

fn palette(colours: &[u32]) -> Vec<Light> {
    colours.iter().map(|&c| hex(c)).collect()
}

/// Ground, then elements.
fn scheme(random: &mut Stream, schemes: &[&[u32]]) -> (Light, Vec<Light>) {
    let colours = palette(pick(random, schemes));
    (colours[0], colours[1..].to_vec())
}

/// A plain, lightly mottled ground and nothing else.
fn base(random: &mut Stream, ground: Light, layout: Layout) -> Look {
    let angle = random.range(0.0, std::f64::consts::TAU);
    let tilt = random.range(0.35, 0.75);
    let across = libm::sin(tilt);
    Look {
        layout,
        species: Vec::new(),
        radius: [4.0, 16.0],
        exponent: random.range(1.6, 3.0),
        ground: Ground {
            base: ground,
            second: ground.map(|c| c * 0.7),
            broad: range(random, 0.1, 0.5),
            broad_wavelength: range(random, 30.0, 120.0),
            fine: range(random, 0.1, 0.35),
            fine_wavelength: range(random, 3.0, 9.0),
            dust: range(random, 0.05, 0.25),
            stretch: 1.0,
            grains: Vec::new(),
            seed: random.bits() as u32,
        },
        growth: Vec::new(),
        growth_radius: 6.0,
        below: 0.0,
        above: 0.0,
        shadow: None,
        depth: 0.0,
        light: [
            (across * libm::cos(angle)) as f32,
            (across * libm::sin(angle)) as f32,
            libm::cos(tilt) as f32,
        ],
    }
}

fn soft_shadow(random: &mut Stream) -> Option<Shadow> {
    Some(Shadow { strength: range(random, 0.35, 0.75), offset: [0.0; 2], softness: 1.0 })
}

fn stones(random: &mut Stream, palette: Vec<Light>, style: Style) -> Species {
    let form = Form::Pebble { wobble: range(random, 0.05, 0.18), stretch: range(random, 1.1, 1.4) };
    Species { form, palette, style, roughness: range(random, 0.0, 0.03) }
}

fn grains(cell: f32, share: f32, colours: Vec<Light>, strength: f32, relief: f32) -> Grains {
    Grains { cell, share, colours, strength, relief }
}

/// Colours around one, for sand and dust of the same stone.
fn shades(colour: Light, factors: &[f32]) -> Vec<Light> {
    factors.iter().map(|f| colour.map(|c| (c * f).min(0.95))).collect()
}

/// Any form with any fill on any ground, in any colours.
fn mixed(random: &mut Stream) -> Look {
    let makers = [
        stones::terrazzo,
        stones::concrete,
        stones::worktop,
        stones::gravel,
        stones::pebbles,
        stones::mud_stones,
        stones::flakes,
        plants::leaves,
        plants::litter,
        plants::flowers,
        plants::blades,
        plants::meadow,
    ];
    let mut look = pick(random, &makers)(random);
    let other = pick(random, &makers)(random);
    look.layout = other.layout;
    (look.ground, look.growth, look.below, look.above) =
        (other.ground, other.growth, other.below, other.above);
    let third = pick(random, &makers)(random);
    for (i, (_, species)) in look.species.iter_mut().enumerate() {
        if random.chance(0.5) {
            species.style = third.species[i % third.species.len()].1.style.clone();
        }
        if random.chance(0.5) {
            let tone = random.range(0.15, 0.9);
            let chroma = random.range(0.0, 0.5);
            let turn = random.range(0.0, std::f64::consts::TAU);
            species.palette = (0..3 + random.index(4))
                .map(|_| {
                    let (t, h) = (tone + random.range(-0.15, 0.15), turn + random.range(-0.8, 0.8));
                    [0.0, 2.1, 4.2].map(|phase| {
                        let v = (t + chroma * t * libm::cos(h + phase)).clamp(0.05, 0.97) as f32;
                        v * v
                    })
                })
                .collect();
        }
    }
    look
}
