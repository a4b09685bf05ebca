//! Properties of generated scenes.

use super::*;
use proptest::prelude::*;

fn scene(kind: SceneKind, seed: u64) -> SceneParams {
    SceneParams { kind, ..SceneParams::random(seed, 160, 120) }
}

/// Brightness values of the pixels of each instance, index 0 the background.
fn values(scene: &GeneratedExemplar) -> Vec<Vec<f64>> {
    let count = scene.instances.areas().len();
    let mut values = vec![Vec::new(); count];
    for (pixel, &label) in scene.image.pixels().zip(&scene.instances.labels) {
        values[label as usize].push(pixel.0.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0);
    }
    values
}

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt())
}

#[test]
fn labels_are_dense_for_every_kind() {
    for kind in SceneKind::ALL {
        for seed in 0..3 {
            let scene = generate(&scene(kind, seed)).unwrap();
            let areas = scene.instances.areas();
            assert!(areas.len() > 1, "{kind:?} {seed}: nothing drawn");
            assert!(areas[1..].iter().all(|&a| a > 0), "{kind:?} {seed}: a label is missing");
            assert_eq!(areas.iter().sum::<u32>(), 160 * 120);
        }
    }
}

#[test]
fn coverage_is_about_what_was_asked_for() {
    for kind in SceneKind::ALL {
        for coverage in [0.0, 0.1, 0.4] {
            let params = SceneParams { coverage, size: 24.0, ..scene(kind, 5) };
            let got = 1.0 - f64::from(generate(&params).unwrap().instances.areas()[0]) / (160.0 * 120.0);
            assert!((got - coverage).abs() < 0.05, "{kind:?}: {got} for {coverage}");
        }
    }
}

#[test]
fn dense_scenes_are_dense() {
    for (kind, least) in [(SceneKind::Gravel, 0.85), (SceneKind::Leaves, 0.85), (SceneKind::Worktop, 0.55)] {
        for seed in 0..4 {
            let params = SceneParams { coverage: 0.9, contrast: 1.0, ..scene(kind, seed) };
            let got = 1.0 - f64::from(generate(&params).unwrap().instances.areas()[0]) / (160.0 * 120.0);
            assert!(got > least, "{kind:?} {seed}: {got}");
        }
    }
}

#[test]
fn elements_vary_inside_beyond_the_sensor_noise() {
    for kind in SceneKind::ALL {
        let params = SceneParams { noise: 0.0, size: 40.0, coverage: 0.3, ..scene(kind, 8) };
        let scene = generate(&params).unwrap();
        let large: Vec<f64> =
            values(&scene)[1..].iter().filter(|v| v.len() >= 100).map(|v| mean_and_deviation(v).1).collect();
        assert!(!large.is_empty(), "{kind:?}");
        let mean = large.iter().sum::<f64>() / large.len() as f64;
        assert!(mean > 2.0, "{kind:?}: elements are flat ({mean})");
    }
}

/// Mean distance of the elements' brightness from the background's.
fn distance_from_background(params: &SceneParams) -> f64 {
    let values = values(&generate(params).unwrap());
    let (background, _) = mean_and_deviation(&values[0]);
    let far = values[1..].iter().map(|v| (mean_and_deviation(v).0 - background).abs());
    far.sum::<f64>() / (values.len() - 1) as f64
}

#[test]
fn contrast_brings_elements_off_the_background() {
    for kind in [SceneKind::Terrazzo, SceneKind::Concrete, SceneKind::Flakes] {
        let params = SceneParams { coverage: 0.3, contrast: 1.0, ..scene(kind, 2) };
        let strong = distance_from_background(&params);
        let weak = distance_from_background(&SceneParams { contrast: 0.15, ..params });
        assert!(weak < 0.7 * strong && weak < 25.0, "{kind:?}: {weak} against {strong}");
    }
}

#[test]
fn random_scenes_span_sizes_coverages_and_contrasts() {
    let all: Vec<SceneParams> = (0..200).map(|seed| SceneParams::random(seed, 256, 256)).collect();
    assert!(SceneKind::ALL.iter().all(|k| all.iter().any(|p| p.kind == *k)));
    let count = |f: &dyn Fn(&SceneParams) -> bool| all.iter().filter(|p| f(p)).count();
    assert!(count(&|p| p.contrast < 0.4) > 10 && count(&|p| p.contrast > 0.8) > 40);
    assert!(count(&|p| p.coverage < 0.2) > 15 && count(&|p| p.coverage > 0.7) > 15);
    assert!(count(&|p| p.size < 20.0) > 20 && count(&|p| p.size > 70.0) > 20);
}

#[test]
fn areas_reach_from_tens_to_thousands_of_pixels() {
    let (mut small, mut large) = (0, 0);
    for seed in 0..40 {
        let areas = generate(&SceneParams::random(seed, 256, 256)).unwrap().instances.areas();
        small += areas[1..].iter().filter(|a| (30..100).contains(*a)).count();
        large += areas[1..].iter().filter(|a| (2000..9000).contains(*a)).count();
    }
    assert!(small > 500 && large > 20, "{small} {large}");
}

#[test]
fn parameters_out_of_range_are_named() {
    let good = SceneParams::default();
    for (name, bad) in [
        ("width", SceneParams { width: 0, ..good.clone() }),
        ("height", SceneParams { height: 20_000, ..good.clone() }),
        ("coverage", SceneParams { coverage: f64::NAN, ..good.clone() }),
        ("contrast", SceneParams { contrast: 1.5, ..good.clone() }),
        ("size", SceneParams { size: 0.0, ..good.clone() }),
        ("blur", SceneParams { blur: f64::INFINITY, ..good.clone() }),
        ("noise", SceneParams { noise: -1.0, ..good }),
    ] {
        assert!(generate(&bad).unwrap_err().to_string().starts_with(name), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_parameters_make_a_scene_and_the_seed_decides_it(
        width in 1..90u32,
        height in 1..90u32,
        seed: u64,
        kind in prop::sample::select(SceneKind::ALL.to_vec()),
        coverage in 0.0..0.95f64,
        contrast in 0.0..1.0f64,
        size in 8.0..400.0f64,
    ) {
        let params =
            SceneParams { width, height, seed, kind, coverage, contrast, size, ..SceneParams::default() };
        let scene = generate(&params).unwrap();
        prop_assert_eq!(scene.image.dimensions(), (width, height));
        prop_assert_eq!((scene.instances.width, scene.instances.height), (width, height));
        prop_assert_eq!(&scene, &generate(&params).unwrap());
        if width * height > 200 {
            let other = generate(&SceneParams { seed: seed ^ 1, ..params }).unwrap();
            prop_assert_ne!(&scene.image, &other.image);
        }
    }
}
