//! What each kind of scene is made of: elements, ground, layout and light, drawn at random.

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
            Kind::Terrazzo => terrazzo(random),
            Kind::Concrete => concrete(random),
            Kind::Worktop => worktop(random),
            Kind::Gravel => gravel(random),
            Kind::Pebbles => pebbles(random),
            Kind::MudStones => mud_stones(random),
            Kind::Leaves => leaves(random),
            Kind::Litter => litter(random),
            Kind::Flowers => flowers(random),
            Kind::Flakes => flakes(random),
            Kind::Blades => blades(random),
            Kind::Mixed => mixed(random),
        };
        let largest = 0.5 * params.size as f32;
        let smallest = (largest / random.range(2.0, 6.0) as f32).max(3.2);
        look.radius = [smallest, largest.max(1.05 * smallest)];
        look.growth_radius = (largest * 0.3).clamp(4.0, 10.0);
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

fn chips(random: &mut Stream, palette: Vec<Light>, style: Style) -> Species {
    let form =
        Form::Chip { corners: [4, 8], stretch: range(random, 1.05, 1.5), rounding: range(random, 0.03, 0.3) };
    Species { form, palette, style, roughness: range(random, 0.02, 0.08) }
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

fn terrazzo(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0xdcc8b2, 0xd99a45, 0x8a3b45, 0x5d7068, 0xb98f6f, 0x3f5753, 0xe8a860],
            &[0xe9e6df, 0x2f4858, 0x86a8a0, 0xc98d6b, 0x26363a, 0xb8bdb5],
            &[0x3a3c40, 0xe8dcc8, 0xb55d3c, 0x7c8c7e, 0xd5a24b, 0x9aa5a8],
            &[0xefe1d8, 0xd77a61, 0x223843, 0xdbb3a0, 0xa6554a, 0x8e9aaf],
            &[0xd8d4c4, 0x52614f, 0x9aa583, 0xc2a15f, 0x7b4b3a, 0xede6d0],
        ],
    );
    let layout = if random.chance(0.5) {
        Layout::Cells { gap: range(random, 2.0, 6.0) }
    } else {
        Layout::Packed { gap: range(random, 1.0, 3.0) }
    };
    let mut look = base(random, ground, layout);
    look.ground.dust *= 0.5;
    let crumbs = range(random, 0.15, 0.6);
    look.ground.grains = vec![
        grains(range(random, 3.5, 6.5), crumbs, colours.clone(), 0.85, 0.0),
        grains(3.0, 0.5, shades(ground, &[0.6, 0.8, 1.25]), 0.6, 0.0),
    ];
    let style = Style {
        mottle: range(random, 0.2, 0.6),
        wavelength: range(random, 0.4, 1.2),
        hardness: range(random, 1.0, 3.0),
        second: [0.62, 0.6, 0.6],
        veins: if random.chance(0.5) { range(random, 0.1, 0.5) } else { 0.0 },
        speckle: range(random, 0.0, 0.25),
        rim: range(random, -0.2, 0.1),
        rim_width: 0.15,
        ..Style::default()
    };
    look.species = vec![(1.0, chips(random, colours, style))];
    look
}

fn concrete(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0xb9b8b0, 0x6f7479, 0x8b6a60, 0x9b9a92, 0xd9d4c8, 0x55585c],
            &[0xd6d2ca, 0x77818c, 0x9aa4b0, 0x8a8f96, 0x666f7a],
            &[0x8f8b84, 0x5a5753, 0xb7ada0, 0x6e5f55, 0x474543],
            &[0xc9bfae, 0x8c7a66, 0x6c6259, 0xa89a86, 0x7a4f40],
        ],
    );
    let layout = Layout::Packed { gap: range(random, 1.0, 4.0) };
    let mut look = base(random, ground, layout);
    look.ground.grains = vec![
        grains(range(random, 5.0, 8.0), 0.25, colours.clone(), 0.5, 0.1),
        grains(range(random, 3.0, 4.5), 0.6, shades(ground, &[0.55, 0.75, 1.3]), 0.7, 0.15),
        grains(2.2, 0.6, shades(ground, &[0.6, 0.8, 1.2]), 0.6, 0.0),
    ];
    let style = Style {
        mottle: range(random, 0.3, 0.7),
        wavelength: range(random, 0.3, 1.0),
        hardness: range(random, 1.0, 3.0),
        second: [0.6, 0.62, 0.65],
        streak: if random.chance(0.4) { range(random, 0.1, 0.4) } else { 0.0 },
        speckle: range(random, 0.1, 0.4),
        rim: range(random, -0.3, 0.3),
        rim_width: 0.15,
        spread: 0.2,
        ..Style::default()
    };
    let mut flakes = chips(random, colours.clone(), style.clone());
    flakes.roughness = 0.18;
    look.species = vec![(3.0, chips(random, colours.clone(), style.clone())), (1.0, flakes)];
    look.species.push((1.0, stones(random, colours, style)));
    look
}

fn worktop(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0xddd6cc, 0x5b4f47, 0x93857a, 0xc6bcb1, 0xeee9e1, 0x77695e, 0xb3a698],
            &[0xc8c8c6, 0x2c2d30, 0x8a8c8f, 0xe6e4e0, 0x5c5e62, 0xb0aaa5],
            &[0x4c4038, 0xa3705a, 0xd6b8a4, 0x2b2625, 0x7f6a60, 0xc09078],
            &[0x3b4a4a, 0x20302f, 0x6c8580, 0xa9b8ae, 0x46605b, 0x89958a],
        ],
    );
    let layout = Layout::Cells { gap: range(random, 0.6, 2.5) };
    let mut look = base(random, ground, layout);
    look.ground.grains = vec![grains(range(random, 2.5, 4.5), 0.5, colours.clone(), 0.6, 0.0)];
    let style = Style {
        mottle: range(random, 0.2, 0.5),
        wavelength: range(random, 0.5, 1.5),
        second: [0.75, 0.72, 0.7],
        veins: range(random, 0.0, 0.3),
        speckle: range(random, 0.1, 0.4),
        facets: if random.chance(0.4) { 3 } else { 0 },
        facet_strength: 0.25,
        slope: 0.2,
        ..Style::default()
    };
    look.species = vec![(1.0, chips(random, colours, style))];
    look.species[0].1.roughness = range(random, 0.05, 0.14);
    look
}

fn gravel(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x2b2b2b, 0x8d8d8d, 0x9e9e9e, 0x7c7c7c, 0xa8a8a8],
            &[0x2e2a26, 0x9b9186, 0x857a6e, 0xb3a999, 0x6f6860],
            &[0x23272b, 0x77818a, 0x8d969c, 0x626b73, 0xa9a59d],
            &[0x33241d, 0xa8694c, 0x8f5540, 0xbe8463, 0x754436],
            &[0x3a362f, 0xc9c0b0, 0xd9d2c5, 0xb4a896, 0xe4dfd6],
        ],
    );
    let layout = if random.chance(0.6) {
        Layout::Scatter { cluster: 0.0 }
    } else {
        Layout::Cells { gap: range(random, 0.5, 2.0) }
    };
    let mut look = base(random, ground, layout);
    look.exponent = random.range(1.0, 2.5);
    look.shadow = soft_shadow(random);
    look.ground.grains =
        vec![grains(range(random, 4.0, 6.0), 0.8, shades(colours[0], &[0.25, 0.45, 0.6]), 0.8, 0.5)];
    let style = Style {
        mottle: range(random, 0.15, 0.4),
        wavelength: range(random, 0.4, 1.0),
        second: [0.65; 3],
        speckle: range(random, 0.05, 0.25),
        rim: range(random, -0.35, 0.0),
        facets: 4,
        facet_strength: range(random, 0.5, 0.9),
        spread: 0.15,
        ..Style::default()
    };
    look.species = vec![(1.0, chips(random, colours, style))];
    look
}

fn pebbles(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x6e6152, 0xb9ab98, 0x7d7f80, 0x4b4f52, 0xd8cfc0, 0x96755c, 0xa9b0ad, 0x8b5a48],
            &[0x4a4a45, 0x9aa19c, 0x6b7572, 0xc7c9c2, 0x3d4443, 0x84908a],
            &[0xb8a27e, 0xe2d6bf, 0xc9a982, 0x9b8467, 0xf0e9db, 0x7a6a58],
            &[0x3a3029, 0xc5926a, 0x8e4f3b, 0xe0c3a0, 0x6d5a4f, 0xa4a29a],
        ],
    );
    let layout = if random.chance(0.5) {
        Layout::Scatter { cluster: range(random, 0.0, 0.6) }
    } else {
        Layout::Packed { gap: range(random, 0.0, 1.5) }
    };
    let mut look = base(random, ground, layout);
    look.shadow = soft_shadow(random);
    look.ground.grains = vec![
        grains(range(random, 4.0, 7.0), 0.6, shades(ground, &[0.5, 0.8, 1.2, 1.5]), 0.9, 0.5),
        grains(2.5, 0.7, shades(ground, &[0.6, 0.8, 1.2]), 0.7, 0.3),
    ];
    let style = Style {
        mottle: range(random, 0.2, 0.5),
        wavelength: range(random, 0.4, 1.4),
        second: [0.6, 0.58, 0.56],
        streak: if random.chance(0.5) { range(random, 0.1, 0.35) } else { 0.0 },
        veins: if random.chance(0.4) { range(random, 0.2, 0.6) } else { 0.0 },
        speckle: range(random, 0.0, 0.25),
        dome: range(random, 0.65, 0.95),
        dome_width: range(random, 0.6, 1.1),
        spread: 0.15,
        ..Style::default()
    };
    let banded = Style { streak: 0.45, veins: 0.0, speckle: 0.05, ..style.clone() };
    look.species =
        vec![(2.0, stones(random, colours.clone(), style)), (1.0, stones(random, colours, banded))];
    look
}

fn mud_stones(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x4a3d1c, 0x6f6032, 0x7d6f3e, 0x5c5130, 0x867a52],
            &[0x5a4a3a, 0x7a6856, 0x8b7a68, 0x6b5c50, 0x94887a],
            &[0x3f3a35, 0x5b5650, 0x6d675f, 0x4e4a46, 0x7a736a],
            &[0x7a5236, 0x9a6f4d, 0x8c6244, 0xb08a68, 0x6f4c36],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.3, 0.9) };
    let mut look = base(random, ground, layout);
    look.ground.broad = 0.6;
    look.ground.second = ground.map(|c| c * 0.45);
    look.ground.fine = range(random, 0.4, 0.7);
    look.ground.grains = vec![
        grains(range(random, 6.0, 9.0), 0.35, shades(colours[0], &[0.6, 0.9, 1.1]), 0.8, 0.6),
        grains(range(random, 3.5, 5.0), 0.6, shades(ground, &[0.5, 0.8, 1.3]), 0.8, 0.6),
    ];
    look.shadow = soft_shadow(random);
    let style = Style {
        mottle: range(random, 0.4, 0.8),
        wavelength: range(random, 0.3, 0.8),
        second: [0.5, 0.5, 0.5],
        speckle: range(random, 0.2, 0.45),
        dome: range(random, 0.6, 0.95),
        dome_width: 0.8,
        spread: 0.2,
        ..Style::default()
    };
    let mut broken = chips(random, colours.clone(), style.clone());
    broken.form = Form::Chip { corners: [5, 8], stretch: 1.3, rounding: 0.5 };
    look.species = vec![(2.0, stones(random, colours, style)), (1.0, broken)];
    look
}

fn grass(random: &mut Stream, green: Light) -> Vec<Species> {
    let style = Style {
        mottle: 0.3,
        ribs: 0.25,
        slope: 0.35,
        spread: 0.25,
        tint: 0.1,
        rim: -0.2,
        ..Style::default()
    };
    let greens = shades(green, &[0.55, 0.8, 1.0, 1.35]);
    let blade = Species {
        form: Form::Leaf { ratio: range(random, 9.0, 20.0), fullness: 0.35, bend: 0.3, serration: 0.0 },
        palette: greens.clone(),
        style: style.clone(),
        roughness: 0.0,
    };
    let clover = Species {
        form: Form::Star { petals: [3, 4], pointed: 0.1, gap: 0.75 },
        palette: greens,
        style: Style { dome: 0.35, ..style },
        roughness: 0.0,
    };
    match random.below(3) {
        0 => vec![blade],
        1 => vec![blade.clone(), blade, clover],
        _ => vec![blade, clover.clone(), clover],
    }
}

fn leaf_style(random: &mut Stream) -> Style {
    Style {
        mottle: range(random, 0.3, 0.7),
        wavelength: range(random, 0.5, 1.2),
        hardness: range(random, 1.0, 2.5),
        second: [0.7, 0.45, 0.4],
        ribs: range(random, 0.15, 0.4),
        speckle: range(random, 0.0, 0.2),
        dome: range(random, 0.2, 0.5),
        slope: 0.25,
        spread: 0.18,
        tint: 0.08,
        ..Style::default()
    }
}

fn simple_leaves(random: &mut Stream, palette: Vec<Light>, style: Style) -> Species {
    let form = Form::Leaf {
        ratio: range(random, 1.4, 2.6),
        fullness: range(random, 0.25, 0.55),
        bend: 0.25,
        serration: range(random, 0.0, 0.15),
    };
    Species { form, palette, style, roughness: 0.02 }
}

fn lobed_leaves(random: &mut Stream, palette: Vec<Light>, style: Style) -> Species {
    let lobes = if random.chance(0.6) { 5 } else { 7 };
    let form = Form::Lobed { lobes, depth: range(random, 0.5, 0.7), serration: range(random, 0.05, 0.25) };
    Species { form, palette, style, roughness: 0.02 }
}

fn leaves(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x1c2410, 0xd9772b, 0xc4521f, 0xe8a23c, 0xa63d1c, 0xdf8f45],
            &[0x2a231c, 0xb98a3a, 0x8d5a2b, 0xd6b04e, 0x7a3b22, 0xa6a04a],
            &[0x3a3128, 0x6f8f3a, 0x8fae4b, 0xc7c25a, 0x4f7030, 0xb59a3c],
            &[0x55504a, 0xc23b2a, 0x8e2a2a, 0xe07b39, 0xf0b64a, 0x70392c],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.0, 0.7) };
    let mut look = base(random, ground, layout);
    look.exponent = random.range(1.0, 2.0);
    look.shadow = soft_shadow(random);
    look.ground.fine = range(random, 0.3, 0.6);
    look.ground.grains = vec![
        grains(range(random, 4.0, 8.0), 0.6, shades(ground, &[0.5, 0.8, 1.4, 1.8]), 0.9, 0.5),
        grains(3.0, 0.6, shades(ground, &[0.6, 1.2]), 0.8, 0.3),
    ];
    if random.chance(0.5) {
        let green = pick(random, &palette(&[0x5f8a2c, 0x3f7a33, 0x7c9440, 0x4a6b3a]));
        look.growth = grass(random, green);
        look.below = 1.6;
        look.above = if random.chance(0.5) { 0.03 } else { 0.0 };
    }
    let style = leaf_style(random);
    look.species = vec![
        (random.range(0.3, 1.0), simple_leaves(random, colours.clone(), style.clone())),
        (if random.chance(0.5) { 0.7 } else { 0.0 }, lobed_leaves(random, colours, style)),
    ];
    look
}

fn litter(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x4a423c, 0x8a775e, 0x6f6148, 0x9b8a6a, 0x7a7f5a, 0xa4906f],
            &[0x332a22, 0x6d5236, 0x8a6a44, 0x54402c, 0x9c7c52],
            &[0x57514a, 0x7c6f5f, 0x8b8172, 0x6a6054, 0x8c8a60],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.2, 0.9) };
    let mut look = base(random, ground, layout);
    look.ground.fine = range(random, 0.3, 0.6);
    look.ground.grains = vec![
        grains(range(random, 4.0, 6.0), 0.6, shades(ground, &[0.6, 0.8, 1.3]), 0.8, 0.4),
        grains(2.5, 0.6, shades(colours[0], &[0.5, 0.8]), 0.6, 0.0),
    ];
    look.shadow = soft_shadow(random);
    let style = leaf_style(random);
    let mut crumpled = stones(random, colours.clone(), Style { streak: 0.3, ..style.clone() });
    crumpled.roughness = 0.22;
    look.species = vec![
        (1.0, simple_leaves(random, colours.clone(), style.clone())),
        (0.6, lobed_leaves(random, colours, style)),
        (0.7, crumpled),
    ];
    look
}

fn flowers(random: &mut Stream) -> Look {
    let (green, colours) = scheme(
        random,
        &[
            &[0x4f7f2a, 0xf4f1e6, 0xfaf6ee, 0xe9e3d2],
            &[0x3f6f30, 0xf3c93b, 0xf7d95c, 0xe8b12e],
            &[0x5b8a3c, 0xb58ad6, 0x9a6cc7, 0xd0b0e6],
            &[0x3d6b3a, 0xe88aa5, 0xf2b0c2, 0xd96c8e],
            &[0x6a8f45, 0x7fa4e0, 0x5f86cc, 0xa8c2ef],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.0, 0.6) };
    let mut look = base(random, green.map(|c| c * 0.12), layout);
    look.exponent = random.range(1.0, 2.0);
    look.shadow = soft_shadow(random);
    look.growth = grass(random, green);
    look.below = 2.2;
    look.above = if random.chance(0.4) { 0.03 } else { 0.0 };
    let heart = pick(random, &palette(&[0xe5b22f, 0xc98a1e, 0xb7c15a, 0x6b3f24]));
    let style = Style {
        mottle: 0.25,
        wavelength: 0.7,
        second: [0.8, 0.72, 0.8],
        ribs: range(random, 0.05, 0.2),
        dome: range(random, 0.3, 0.6),
        rim: range(random, -0.1, 0.1),
        heart: Some((heart, range(random, 0.22, 0.36))),
        spread: 0.08,
        ..Style::default()
    };
    let star = Species {
        form: Form::Star {
            petals: pick(random, &[[5, 5], [5, 8], [10, 16]]),
            pointed: range(random, 0.0, 0.7),
            gap: range(random, 0.45, 0.7),
        },
        palette: colours.clone(),
        style: style.clone(),
        roughness: 0.0,
    };
    let head = Species {
        form: Form::Head { petals: [9, 16] },
        palette: colours,
        style: Style { heart: None, ribs: 0.1, slope: 0.5, ..style },
        roughness: 0.0,
    };
    let heads = if random.chance(0.45) { 1.0 } else { 0.0 };
    let stars = if heads == 0.0 || random.chance(0.3) { 1.0 } else { 0.0 };
    look.species = vec![(stars, star), (heads, head)];
    look
}

fn flakes(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0xc9ccce, 0xa85a2a, 0x8c4520, 0xc07a44, 0x7a3b1e],
            &[0x7f9aa0, 0x8d5b3d, 0xa8734c, 0x6c4632],
            &[0x8a4a2a, 0xd5d9d6, 0xbfc9c8, 0xe6e4da],
            &[0x9c9a8e, 0x4f6a45, 0x6f8a55, 0xb8b46a, 0x839a86],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.2, 0.9) };
    let mut look = base(random, ground, layout);
    look.ground.stretch = range(random, 0.1, 8.0);
    look.ground.grains =
        vec![grains(range(random, 3.0, 5.0), range(random, 0.1, 0.4), colours.clone(), 0.6, 0.0)];
    let style = Style {
        mottle: range(random, 0.4, 0.9),
        wavelength: range(random, 0.3, 0.7),
        hardness: range(random, 1.0, 3.0),
        second: [0.6, 0.5, 0.45],
        speckle: range(random, 0.1, 0.4),
        rim: range(random, -0.4, 0.4),
        rim_width: 0.2,
        spread: 0.15,
        ..Style::default()
    };
    if random.chance(0.4) {
        look.shadow = Some(Shadow { strength: 0.35, offset: [0.0; 2], softness: 1.0 });
    }
    let form = Form::Pebble { wobble: range(random, 0.2, 0.5), stretch: range(random, 1.0, 1.5) };
    let roughness = range(random, 0.15, 0.4);
    look.species = vec![(1.0, Species { form, palette: colours, style, roughness })];
    look
}

fn blades(random: &mut Stream) -> Look {
    let (ground, colours) = scheme(
        random,
        &[
            &[0x3a2c1e, 0xcfa96a, 0xb58a4c, 0xe0c48a, 0x8f6c3c],
            &[0x1d2a14, 0x5d8a34, 0x7ba648, 0x47702c, 0x9bbb62],
            &[0x2e2520, 0x7a4a2e, 0x94603c, 0x5f3a28, 0xab7a50],
        ],
    );
    let layout = Layout::Scatter { cluster: range(random, 0.0, 0.5) };
    let mut look = base(random, ground, layout);
    look.shadow = soft_shadow(random);
    look.exponent = 1.3;
    look.ground.fine = 0.5;
    look.ground.grains = vec![grains(5.0, 0.5, shades(ground, &[0.5, 1.5]), 0.9, 0.4)];
    let style = Style {
        mottle: 0.35,
        ribs: range(random, 0.1, 0.3),
        slope: 0.3,
        dome: 0.6,
        dome_width: 0.4,
        spread: 0.2,
        ..Style::default()
    };
    let form = Form::Leaf {
        ratio: range(random, 5.0, 12.0),
        fullness: range(random, 0.3, 0.5),
        bend: range(random, 0.05, 0.35),
        serration: 0.0,
    };
    look.species = vec![(1.0, Species { form, palette: colours, style, roughness: 0.0 })];
    look
}

/// Any form with any fill on any ground, in any colours.
fn mixed(random: &mut Stream) -> Look {
    let makers =
        [terrazzo, concrete, worktop, gravel, pebbles, mud_stones, leaves, litter, flowers, flakes, blades];
    let mut look = pick(random, &makers)(random);
    let other = pick(random, &makers)(random);
    look.ground = other.ground;
    look.layout = other.layout;
    if random.chance(0.5) {
        look.growth = Vec::new();
    }
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
