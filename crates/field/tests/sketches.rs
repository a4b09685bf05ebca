//! Strokes of a sketch beside what becomes of them.

use std::path::Path;
use vtex_field::layers::{FindParams, LayerExemplar, find};

const SIDE: usize = 600;
/// Least overlap of strokes with the top layer, intersection over union.
const LEAST: f64 = 0.8;

/// A wave and a line of a width.
fn strokes(width: f64) -> Vec<bool> {
    let wave = |k: usize| {
        let k = k as f64 / 4.0;
        [80.0 + 4.4 * k, 300.0 + 170.0 * libm::sin(k / 16.0)]
    };
    let wave: Vec<[f64; 2]> = (0..=400).map(wave).collect();
    let line: Vec<[f64; 2]> =
        (0..=240).map(|k| [60.0 + 2.0 * f64::from(k), 80.0 - f64::from(k) / 12.0]).collect();
    let mut painted = vec![false; SIDE * SIDE];
    for [x, y] in wave.into_iter().chain(line) {
        let around =
            |v: f64| ((v - width / 2.0).max(0.0) as usize)..((v + width / 2.0) as usize + 1).min(SIDE);
        for (v, u) in around(y).flat_map(|v| around(x).map(move |u| (v, u))) {
            painted[v * SIDE + u] |= libm::hypot(u as f64 + 0.5 - x, v as f64 + 0.5 - y) < width / 2.0;
        }
    }
    painted
}

#[test]
#[ignore = "reads photographs from the folder VTEX_FIGURES, prints figures for docs/measurements/layers.md"]
fn strokes_are_the_top_layer() {
    let folder = std::env::var("VTEX_FIGURES").expect("VTEX_FIGURES names a folder of photographs");
    for name in ["rust_metal053c", "aerial_rocks_02", "aerial_grass_rock"] {
        let photograph =
            image::open(Path::new(&folder).join(name).with_extension("jpg")).unwrap().into_rgb8();
        let found =
            find(&photograph, None, &FindParams { seed: 1, ..FindParams::default() }, &()).unwrap().map;
        let top = found.layers.len() as u32 - 1;
        let exemplar = LayerExemplar { map: &found, photograph: None };
        let overlap = |width: f64| {
            let painted = strokes(width);
            let sketch: Vec<Option<u32>> = painted.iter().map(|&p| p.then_some(top)).collect();
            let made = exemplar.sketched(&sketch, [SIDE; 2], [false; 2], 1, &()).unwrap();
            let is_top = made.labels.labels.iter().map(|&l| l == top);
            let (both, either) = is_top.zip(&painted).fold((0, 0), |(both, either), (a, &b)| {
                (both + u32::from(a && b), either + u32::from(a || b))
            });
            f64::from(both) / f64::from(either)
        };
        let overlaps = [6.0, 10.0, 20.0, 30.0, 50.0, 80.0, 120.0].map(overlap);
        println!("{name}: {overlaps:.3?}");
        assert!(overlaps.iter().all(|&v| v >= LEAST), "{name}");
    }
}
