//! Compositions of leaves, flowers and grass.

use super::super::elements::{ElementForm, ElementKind};
use super::super::fills::{Light, Style};
use super::super::layout::ElementLayout;
use super::{Composition, base, grains, palette, pick, range, scheme, shades, soft_shadow, stones};
use vtex_base::sampling::Stream;

fn grass(random: &mut Stream, green: Light) -> Vec<ElementKind> {
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
    let blade = ElementKind {
        form: ElementForm::Leaf {
            ratio: range(random, 9.0, 20.0),
            fullness: 0.35,
            bend: 0.3,
            serration: 0.0,
        },
        palette: greens.clone(),
        style: style.clone(),
        roughness: 0.0,
    };
    let clover = ElementKind {
        form: ElementForm::Star { petals: [3, 4], pointed: 0.1, gap: 0.75 },
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

fn simple_leaves(random: &mut Stream, palette: Vec<Light>, style: Style) -> ElementKind {
    let form = ElementForm::Leaf {
        ratio: range(random, 1.4, 2.6),
        fullness: range(random, 0.25, 0.55),
        bend: 0.25,
        serration: range(random, 0.0, 0.15),
    };
    ElementKind { form, palette, style, roughness: 0.02 }
}

fn lobed_leaves(random: &mut Stream, palette: Vec<Light>, style: Style) -> ElementKind {
    let lobes = if random.chance(0.6) { 5 } else { 7 };
    let form =
        ElementForm::Lobed { lobes, depth: range(random, 0.42, 0.62), serration: range(random, 0.05, 0.25) };
    ElementKind { form, palette, style, roughness: 0.02 }
}

pub(super) fn leaves(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0x4a4034, 0xd9772b, 0xc4521f, 0xe8a23c, 0xa63d1c, 0xdf8f45],
            &[0x2a231c, 0xb98a3a, 0x8d5a2b, 0xd6b04e, 0x7a3b22, 0xa6a04a],
            &[0x3a3128, 0x6f8f3a, 0x8fae4b, 0xc7c25a, 0x4f7030, 0xb59a3c],
            &[0x55504a, 0xc23b2a, 0x8e2a2a, 0xe07b39, 0xf0b64a, 0x70392c],
        ],
    );
    let layout = ElementLayout::Scatter { cluster: range(random, 0.0, 0.7) };
    let mut scene = base(random, background, layout);
    scene.exponent = random.range(1.0, 2.0);
    scene.shadow = soft_shadow(random);
    scene.background.fine = range(random, 0.3, 0.6);
    scene.background.grains = vec![
        grains(range(random, 4.0, 8.0), 0.6, shades(background, &[0.5, 0.8, 1.4, 1.8]), 0.9, 0.5),
        grains(3.0, 0.6, shades(background, &[0.6, 1.2]), 0.8, 0.3),
    ];
    if random.chance(0.5) {
        let green = pick(random, &palette(&[0x5f8a2c, 0x3f7a33, 0x7c9440, 0x4a6b3a]));
        scene.growth = grass(random, green);
        scene.below = 1.6;
        scene.above = if random.chance(0.5) { 0.03 } else { 0.0 };
    }
    let style = leaf_style(random);
    scene.kinds = vec![
        (random.range(0.3, 1.0), simple_leaves(random, colours.clone(), style.clone())),
        (if random.chance(0.5) { 0.7 } else { 0.0 }, lobed_leaves(random, colours, style)),
    ];
    scene
}

pub(super) fn litter(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0x4a423c, 0x8a775e, 0x6f6148, 0x9b8a6a, 0x7a7f5a, 0xa4906f],
            &[0x332a22, 0x6d5236, 0x8a6a44, 0x54402c, 0x9c7c52],
            &[0x57514a, 0x7c6f5f, 0x8b8172, 0x6a6054, 0x8c8a60],
        ],
    );
    let layout = ElementLayout::Scatter { cluster: range(random, 0.2, 0.9) };
    let mut scene = base(random, background, layout);
    scene.background.fine = range(random, 0.3, 0.6);
    scene.background.grains = vec![
        grains(range(random, 4.0, 6.0), 0.6, shades(background, &[0.6, 0.8, 1.3]), 0.8, 0.4),
        grains(2.5, 0.6, shades(colours[0], &[0.5, 0.8]), 0.6, 0.0),
    ];
    scene.shadow = soft_shadow(random);
    let style = leaf_style(random);
    let mut crumpled = stones(random, colours.clone(), Style { streak: 0.3, ..style.clone() });
    crumpled.roughness = 0.22;
    scene.kinds = vec![
        (1.0, simple_leaves(random, colours.clone(), style.clone())),
        (0.6, lobed_leaves(random, colours, style)),
        (0.7, crumpled),
    ];
    scene
}

pub(super) fn flowers(random: &mut Stream) -> Composition {
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
    let layout = ElementLayout::Scatter { cluster: range(random, 0.0, 0.6) };
    let mut scene = base(random, green.map(|c| c * 0.12), layout);
    scene.exponent = random.range(1.0, 2.0);
    scene.shadow = soft_shadow(random);
    scene.growth = grass(random, green);
    scene.below = 2.2;
    scene.above = if random.chance(0.4) { 0.03 } else { 0.0 };
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
    let star = ElementKind {
        form: ElementForm::Star {
            petals: pick(random, &[[5, 5], [5, 8], [10, 16]]),
            pointed: range(random, 0.0, 0.7),
            gap: range(random, 0.45, 0.7),
        },
        palette: colours.clone(),
        style: style.clone(),
        roughness: 0.0,
    };
    let head = ElementKind {
        form: ElementForm::Head { petals: [9, 16] },
        palette: colours,
        style: Style { heart: None, ribs: 0.1, slope: 0.5, ..style },
        roughness: 0.0,
    };
    let heads = if random.chance(0.45) { 1.0 } else { 0.0 };
    let stars = if heads == 0.0 || random.chance(0.3) { 1.0 } else { 0.0 };
    scene.kinds = vec![(stars, star), (heads, head)];
    scene
}

pub(super) fn blades(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0x3a2c1e, 0xcfa96a, 0xb58a4c, 0xe0c48a, 0x8f6c3c],
            &[0x1d2a14, 0x5d8a34, 0x7ba648, 0x47702c, 0x9bbb62],
            &[0x2e2520, 0x7a4a2e, 0x94603c, 0x5f3a28, 0xab7a50],
        ],
    );
    let layout = ElementLayout::Scatter { cluster: range(random, 0.0, 0.5) };
    let mut scene = base(random, background, layout);
    scene.shadow = soft_shadow(random);
    scene.exponent = 1.3;
    scene.background.fine = 0.5;
    scene.background.grains = vec![grains(5.0, 0.5, shades(background, &[0.5, 1.5]), 0.9, 0.4)];
    let style = Style {
        mottle: 0.35,
        ribs: range(random, 0.1, 0.3),
        slope: 0.3,
        dome: 0.6,
        dome_width: 0.4,
        spread: 0.2,
        ..Style::default()
    };
    let form = ElementForm::Leaf {
        ratio: range(random, 5.0, 12.0),
        fullness: range(random, 0.3, 0.5),
        bend: range(random, 0.05, 0.35),
        serration: 0.0,
    };
    scene.kinds = vec![(1.0, ElementKind { form, palette: colours, style, roughness: 0.0 })];
    scene
}

pub(super) fn meadow(random: &mut Stream) -> Composition {
    let (green, colours) = scheme(
        random,
        &[
            &[0x2f6b2a, 0x3f8a38, 0x56a048, 0x2f7434, 0x74b45c, 0x4b8f5a],
            &[0x46702a, 0x6d9a3a, 0x86ac4c, 0x547f2e, 0xa3bc62],
            &[0x3d5f3a, 0x5f8a60, 0x4a7a4e, 0x7ba27c, 0x8a9a58],
        ],
    );
    let mut scene = base(random, green.map(|c| c * 0.06), ElementLayout::Scatter { cluster: 0.0 });
    scene.exponent = random.range(1.0, 2.0);
    scene.shadow = soft_shadow(random);
    scene.depth = range(random, 0.3, 0.8);
    scene.growth = grass(random, green.map(|c| c * 0.5));
    scene.below = 1.6;
    let style = Style {
        mottle: range(random, 0.1, 0.35),
        ribs: range(random, 0.05, 0.3),
        slope: range(random, 0.2, 0.5),
        dome: range(random, 0.1, 0.5),
        rim: range(random, -0.15, 0.15),
        spread: 0.25,
        tint: 0.1,
        ..Style::default()
    };
    let leaflet = ElementKind {
        form: ElementForm::Leaf { ratio: range(random, 1.1, 1.7), fullness: 0.55, bend: 0.1, serration: 0.0 },
        palette: colours.clone(),
        style: style.clone(),
        roughness: 0.01,
    };
    let blade = ElementKind {
        form: ElementForm::Leaf { ratio: range(random, 5.0, 14.0), fullness: 0.4, bend: 0.3, serration: 0.0 },
        palette: colours.clone(),
        style: style.clone(),
        roughness: 0.0,
    };
    let pale = pick(random, &[0xf4f1e6, 0xefe0cc, 0xf3d95a, 0xe8a8c0, 0xb79ad8, 0xa8c46a]);
    let head = ElementKind {
        form: ElementForm::Head { petals: [9, 18] },
        palette: shades(palette(&[pale])[0], &[0.75, 0.9, 1.0]),
        style: Style { slope: 0.5, dome: 0.4, spread: 0.1, ..Style::default() },
        roughness: 0.0,
    };
    let flowers = if random.chance(0.7) { random.range(0.03, 0.25) } else { 0.0 };
    scene.kinds = vec![(1.0, leaflet), (random.range(0.1, 0.8), blade), (flowers, head)];
    scene
}
