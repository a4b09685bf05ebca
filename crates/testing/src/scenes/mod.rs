//! Random compositions of each kind of scene: elements, background, layout and light.

mod plants;
mod stones;

use super::SceneKind;
use super::SceneParams;
use super::background::{BackgroundParams, Grains};
use super::elements::{ElementForm, ElementKind};
use super::fills::{Light, Style, blend, hex};
use super::layout::ElementLayout;
use super::render::SoftShadow;
use vtex_base::sampling::{Stream, stream};

/// The composition of a scene.
#[derive(Clone, Debug)]
pub(super) struct Composition {
    pub(super) layout: ElementLayout,
    /// Kinds of labelled elements, with weights.
    pub(super) kinds: Vec<(f64, ElementKind)>,
    /// Smallest and largest radius in pixels, as radii of circles of the same area.
    pub(super) radius: [f32; 2],
    /// Exponent of the radii's power law.
    pub(super) exponent: f64,
    pub(super) background: BackgroundParams,
    /// Unlabelled vegetation below and above the elements, its radius, and its amounts as shares of the
    /// picture's area.
    pub(super) growth: Vec<ElementKind>,
    pub(super) growth_radius: f32,
    pub(super) below: f64,
    pub(super) above: f64,
    pub(super) shadow: Option<SoftShadow>,
    /// Share of the light that the lowest scattered elements lack.
    pub(super) depth: f32,
    /// Unit vector to the light; z points to the camera.
    pub(super) light: [f32; 3],
}

impl Composition {
    /// A random radius from the truncated power law.
    pub(super) fn draw_radius(&self, random: &mut Stream) -> f32 {
        let [low, high] = self.radius.map(f64::from);
        let e = 1.0 - self.exponent;
        let (a, b) = (libm::pow(low, e), libm::pow(high, e));
        libm::pow(a + (b - a) * random.unit(), 1.0 / e) as f32
    }

    /// A random kind of element, by weight.
    pub(super) fn draw_kind(&self, random: &mut Stream) -> &ElementKind {
        let i = random.weighted(self.kinds.iter().map(|(w, _)| *w)).unwrap_or(0);
        &self.kinds[i].1
    }

    /// A random composition for a scene's parameters.
    pub(super) fn of(params: &SceneParams) -> Self {
        let random = &mut stream(params.seed, "procedural/look", 0);
        let mut scene = match params.kind {
            SceneKind::Terrazzo => stones::terrazzo(random),
            SceneKind::Concrete => stones::concrete(random),
            SceneKind::Worktop => stones::worktop(random),
            SceneKind::Gravel => stones::gravel(random),
            SceneKind::Pebbles => stones::pebbles(random),
            SceneKind::MudStones => stones::mud_stones(random),
            SceneKind::Leaves => plants::leaves(random),
            SceneKind::Litter => plants::litter(random),
            SceneKind::Flowers => plants::flowers(random),
            SceneKind::Flakes => stones::flakes(random),
            SceneKind::Blades => plants::blades(random),
            SceneKind::Meadow => plants::meadow(random),
            SceneKind::Mixed => mixed(random),
        };
        let largest = 0.5 * params.size as f32;
        let smallest = (largest / random.range(2.0, 6.0) as f32).max(3.2);
        scene.radius = [smallest, largest.max(1.05 * smallest)];
        scene.growth_radius = (largest * 0.2).clamp(3.0, 6.0);
        let mean = blend(scene.background.base, scene.background.second, 0.5 * scene.background.broad);
        for (_, kind) in &mut scene.kinds {
            for colour in &mut kind.palette {
                *colour = blend(mean, *colour, params.contrast as f32);
            }
        }
        if let Some(shadow) = &mut scene.shadow {
            let reach = (0.16 * largest).clamp(0.8, 5.0);
            let length = (scene.light[0] * scene.light[0] + scene.light[1] * scene.light[1]).sqrt().max(0.1);
            shadow.offset = [-scene.light[0] / length * reach, -scene.light[1] / length * reach];
            shadow.softness = (0.9 * reach).max(1.0);
        }
        scene
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

/// Chooses a colour scheme: the background's colour, then those of the elements.
fn scheme(random: &mut Stream, schemes: &[&[u32]]) -> (Light, Vec<Light>) {
    let colours = palette(pick(random, schemes));
    (colours[0], colours[1..].to_vec())
}

/// A plain, slightly mottled background and nothing else.
fn base(random: &mut Stream, background: Light, layout: ElementLayout) -> Composition {
    let angle = random.range(0.0, std::f64::consts::TAU);
    let tilt = random.range(0.35, 0.75);
    let across = libm::sin(tilt);
    Composition {
        layout,
        kinds: Vec::new(),
        radius: [4.0, 16.0],
        exponent: random.range(1.6, 3.0),
        background: BackgroundParams {
            base: background,
            second: background.map(|c| c * 0.7),
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

fn soft_shadow(random: &mut Stream) -> Option<SoftShadow> {
    Some(SoftShadow { strength: range(random, 0.35, 0.75), offset: [0.0; 2], softness: 1.0 })
}

fn stones(random: &mut Stream, palette: Vec<Light>, style: Style) -> ElementKind {
    let form = ElementForm::Pebble { wobble: range(random, 0.05, 0.18), stretch: range(random, 1.1, 1.4) };
    ElementKind { form, palette, style, roughness: range(random, 0.0, 0.03) }
}

fn grains(cell: f32, share: f32, colours: Vec<Light>, strength: f32, relief: f32) -> Grains {
    Grains { cell, share, colours, strength, relief }
}

/// Shades of one colour, for sand and dust of the same stone.
fn shades(colour: Light, factors: &[f32]) -> Vec<Light> {
    factors.iter().map(|f| colour.map(|c| (c * f).min(0.95))).collect()
}

/// Any form with any fill on any background, in any colours.
fn mixed(random: &mut Stream) -> Composition {
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
    let mut scene = pick(random, &makers)(random);
    let other = pick(random, &makers)(random);
    scene.layout = other.layout;
    (scene.background, scene.growth, scene.below, scene.above) =
        (other.background, other.growth, other.below, other.above);
    let third = pick(random, &makers)(random);
    for (i, (_, kind)) in scene.kinds.iter_mut().enumerate() {
        if random.chance(0.5) {
            kind.style = third.kinds[i % third.kinds.len()].1.style.clone();
        }
        if random.chance(0.5) {
            let tone = random.range(0.15, 0.9);
            let chroma = random.range(0.0, 0.5);
            let turn = random.range(0.0, std::f64::consts::TAU);
            kind.palette = (0..3 + random.index(4))
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
    scene
}
