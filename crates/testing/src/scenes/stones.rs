//! Compositions of stone, concrete and rust.

use super::super::elements::{ElementForm, ElementKind};
use super::super::fills::{Light, Style};
use super::super::layout::ElementLayout;
use super::super::render::SoftShadow;
use super::{Composition, base, grains, range, scheme, shades, soft_shadow, stones};
use vtex_base::sampling::Stream;

fn chips(random: &mut Stream, palette: Vec<Light>, style: Style) -> ElementKind {
    let form = ElementForm::Chip {
        corners: [4, 8],
        stretch: range(random, 1.05, 1.5),
        rounding: range(random, 0.03, 0.3),
    };
    ElementKind { form, palette, style, roughness: range(random, 0.02, 0.08) }
}

pub(super) fn terrazzo(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
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
        ElementLayout::Cells { gap: range(random, 2.0, 6.0) }
    } else {
        ElementLayout::Packed { gap: range(random, 1.0, 3.0) }
    };
    let mut scene = base(random, background, layout);
    scene.background.dust *= 0.5;
    let crumbs = range(random, 0.15, 0.6);
    scene.background.grains = vec![
        grains(range(random, 3.5, 6.5), crumbs, colours.clone(), 0.85, 0.0),
        grains(3.0, 0.5, shades(background, &[0.6, 0.8, 1.15]), 0.6, 0.0),
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
    scene.kinds = vec![(1.0, chips(random, colours, style))];
    scene
}

pub(super) fn concrete(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0xb9b8b0, 0x6f7479, 0x8b6a60, 0x9b9a92, 0xd9d4c8, 0x55585c],
            &[0xd6d2ca, 0x77818c, 0x9aa4b0, 0x8a8f96, 0x666f7a],
            &[0x8f8b84, 0x5a5753, 0xb7ada0, 0x6e5f55, 0x474543],
            &[0xc9bfae, 0x8c7a66, 0x6c6259, 0xa89a86, 0x7a4f40],
        ],
    );
    let layout = ElementLayout::Packed { gap: range(random, 1.0, 4.0) };
    let mut scene = base(random, background, layout);
    scene.background.grains = vec![
        grains(range(random, 5.0, 8.0), 0.25, colours.clone(), 0.5, 0.1),
        grains(range(random, 3.0, 4.5), 0.6, shades(background, &[0.55, 0.75, 0.85, 1.15]), 0.7, 0.15),
        grains(2.2, 0.6, shades(background, &[0.6, 0.8, 1.2]), 0.6, 0.0),
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
    scene.kinds = vec![(3.0, chips(random, colours.clone(), style.clone())), (1.0, flakes)];
    scene.kinds.push((1.0, stones(random, colours, style)));
    scene
}

pub(super) fn worktop(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0xddd6cc, 0x5b4f47, 0x93857a, 0xc6bcb1, 0xeee9e1, 0x77695e, 0xb3a698],
            &[0xc8c8c6, 0x2c2d30, 0x8a8c8f, 0xe6e4e0, 0x5c5e62, 0xb0aaa5],
            &[0x4c4038, 0xa3705a, 0xd6b8a4, 0x2b2625, 0x7f6a60, 0xc09078],
            &[0x3b4a4a, 0x20302f, 0x6c8580, 0xa9b8ae, 0x46605b, 0x89958a],
        ],
    );
    let layout = ElementLayout::Cells { gap: range(random, 0.6, 2.5) };
    let mut scene = base(random, background, layout);
    scene.background.grains = vec![grains(range(random, 2.5, 4.5), 0.5, colours.clone(), 0.6, 0.0)];
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
    scene.kinds = vec![(1.0, chips(random, colours, style))];
    scene.kinds[0].1.roughness = range(random, 0.05, 0.14);
    scene
}

pub(super) fn gravel(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
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
        ElementLayout::Scatter { cluster: 0.0 }
    } else {
        ElementLayout::Cells { gap: range(random, 0.5, 2.0) }
    };
    let mut scene = base(random, background, layout);
    scene.exponent = random.range(1.0, 2.5);
    scene.shadow = soft_shadow(random);
    scene.background.grains =
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
    scene.kinds = vec![(1.0, chips(random, colours, style))];
    scene
}

pub(super) fn pebbles(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0x6e6152, 0xb9ab98, 0x7d7f80, 0x4b4f52, 0xd8cfc0, 0x96755c, 0xa9b0ad, 0x8b5a48],
            &[0x4a4a45, 0x9aa19c, 0x6b7572, 0xc7c9c2, 0x3d4443, 0x84908a],
            &[0xb8a27e, 0xe2d6bf, 0xc9a982, 0x9b8467, 0xf0e9db, 0x7a6a58],
            &[0x3a3029, 0xc5926a, 0x8e4f3b, 0xe0c3a0, 0x6d5a4f, 0xa4a29a],
        ],
    );
    let layout = if random.chance(0.5) {
        ElementLayout::Scatter { cluster: range(random, 0.0, 0.6) }
    } else {
        ElementLayout::Packed { gap: range(random, 0.0, 1.5) }
    };
    let mut scene = base(random, background, layout);
    scene.shadow = soft_shadow(random);
    scene.background.grains = vec![
        grains(range(random, 4.0, 7.0), 0.6, shades(background, &[0.5, 0.7, 0.9, 1.2]), 0.9, 0.5),
        grains(2.5, 0.7, shades(background, &[0.6, 0.8, 1.2]), 0.7, 0.3),
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
    scene.kinds = vec![(2.0, stones(random, colours.clone(), style)), (1.0, stones(random, colours, banded))];
    scene
}

pub(super) fn mud_stones(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0x4a3d1c, 0x6f6032, 0x7d6f3e, 0x5c5130, 0x867a52],
            &[0x5a4a3a, 0x7a6856, 0x8b7a68, 0x6b5c50, 0x94887a],
            &[0x3f3a35, 0x5b5650, 0x6d675f, 0x4e4a46, 0x7a736a],
            &[0x7a5236, 0x9a6f4d, 0x8c6244, 0xb08a68, 0x6f4c36],
        ],
    );
    let layout = ElementLayout::Scatter { cluster: range(random, 0.3, 0.9) };
    let mut scene = base(random, background, layout);
    scene.background.broad = 0.6;
    scene.background.second = background.map(|c| c * 0.45);
    scene.background.fine = range(random, 0.4, 0.7);
    scene.background.grains = vec![
        grains(range(random, 6.0, 9.0), 0.35, shades(colours[0], &[0.6, 0.9, 1.1]), 0.8, 0.6),
        grains(range(random, 3.5, 5.0), 0.6, shades(background, &[0.5, 0.7, 1.1]), 0.8, 0.6),
    ];
    scene.shadow = soft_shadow(random);
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
    broken.form = ElementForm::Chip { corners: [5, 8], stretch: 1.3, rounding: 0.5 };
    scene.kinds = vec![(2.0, stones(random, colours, style)), (1.0, broken)];
    scene
}

pub(super) fn flakes(random: &mut Stream) -> Composition {
    let (background, colours) = scheme(
        random,
        &[
            &[0xc9ccce, 0xa85a2a, 0x8c4520, 0xc07a44, 0x7a3b1e],
            &[0x7f9aa0, 0x8d5b3d, 0xa8734c, 0x6c4632],
            &[0x8a4a2a, 0xd5d9d6, 0xbfc9c8, 0xe6e4da],
            &[0x9c9a8e, 0x4f6a45, 0x6f8a55, 0xb8b46a, 0x839a86],
        ],
    );
    let layout = ElementLayout::Scatter { cluster: range(random, 0.2, 0.9) };
    let mut scene = base(random, background, layout);
    scene.background.stretch = range(random, 0.1, 8.0);
    scene.background.grains =
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
        scene.shadow = Some(SoftShadow { strength: 0.35, offset: [0.0; 2], softness: 1.0 });
    }
    let form = ElementForm::Pebble { wobble: range(random, 0.2, 0.5), stretch: range(random, 1.0, 1.5) };
    let roughness = range(random, 0.15, 0.4);
    scene.kinds = vec![(1.0, ElementKind { form, palette: colours, style, roughness })];
    scene
}
