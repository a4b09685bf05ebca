//! Scenes of several strata.

use super::layer_map;
use crate::synth::{Controls, StructureGuide, SynthReport, reconstruct, synthesize_with};
use vtex_base::document::Document as _;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{ControlMap, LabelMap};
use vtex_scene::library::Library;
use vtex_scene::library::testing::{guided, layered, mosaic};
use vtex_scene::scene::{ControlPoint, Method, Role, Scene, SynthParams, Tile, pixels};

fn params(seed: u64) -> SynthParams {
    SynthParams { width: 260, height: 210, seed, ..SynthParams::default() }
}

fn run(library: &Library, params: &SynthParams, controls: &Controls) -> (Scene, SynthReport) {
    let (scene, report) = synthesize_with(std::slice::from_ref(library), params, controls, &()).unwrap();
    assert_eq!(scene.validate(), Ok(()));
    (scene, report)
}

fn library() -> Library {
    layered(&mosaic(200, 13.0, 0.6, 1))
}

/// The pixels of a region.
fn region(scene: &Scene, layer: usize) -> LabelMap {
    let mut map = LabelMap::filled(scene.width, scene.height, 0);
    for (x, y) in pixels::mask(scene.layers[layer].region.as_ref().unwrap()).pixels() {
        if map.at(i64::from(x), i64::from(y)).is_some() {
            map.set(x as u32, y as u32, 1);
        }
    }
    map
}

#[test]
fn each_stratum_has_its_layers_and_area() {
    let library = library();
    for tile in [Tile::default(), Tile { x: true, y: true }] {
        let params = SynthParams { tile, ..params(3) };
        let (scene, report) = run(&library, &params, &Controls::default());
        let names: Vec<&str> = scene.layers.iter().map(|l| &l.name[..]).collect();
        let of = |name: &str| ["", " secondary", " primary"].map(|role| format!("{name}{role}"));
        assert_eq!(names, [of("paint"), of("rust")].concat());
        assert!(scene.layers[0].region.is_none());
        assert_eq!(report.strata.len(), 2);
        for stratum in &report.strata {
            assert!((stratum.area - stratum.area_wanted).abs() < 0.06, "{stratum:?}");
        }
        let inside = region(&scene, 3);
        let area = inside.labels.iter().filter(|&&l| l == 1).count() as f64 / inside.labels.len() as f64;
        assert!((area - report.strata[1].area).abs() < 0.02, "{area} {:?}", report.strata);
        // Small elements belong to the stratum at their centre.
        let wrong = |layer: usize| {
            let wrong =
                |t: &[f64; 6]| inside.at(t[4] as i64, t[5] as i64).is_some_and(|l| (l == 1) != (layer > 2));
            scene.layers[layer].instances.iter().filter(|i| wrong(&i.transform)).count()
        };
        for layer in [1, 4] {
            assert!(wrong(layer) * 10 <= scene.layers[layer].instances.len(), "{}", wrong(layer));
        }
        let again = run(&library, &params, &Controls::default()).0;
        assert_eq!(again, scene);
    }
}

#[test]
fn a_map_leads_the_strata() {
    let library = library();
    let mut given = LabelMap::filled(26, 21, 0);
    (5..16).for_each(|y| (6..20).for_each(|x| given.set(x, y, 1)));
    let controls = Controls { structure: Some(StructureGuide::Strata(given.clone())), ..Controls::default() };
    let (scene, report) = run(&library, &params(1), &controls);
    let inside = region(&scene, 3);
    let same = (0..260 * 210).filter(|&i| {
        let at = given.get(i as u32 % 260 / 10, i as u32 / 260 / 10);
        inside.labels[i] == at
    });
    let same = same.count() as f64 / (260.0 * 210.0);
    assert!(same > 0.9, "{same}");
    assert!((report.strata[1].area_wanted - given.areas()[1] as f64 / (26.0 * 21.0)).abs() < 0.01);
    // Elements lie in their stratum.
    for (layer, stratum) in [(2, 0), (5, 1)] {
        let place = |i: &vtex_scene::scene::Instance| {
            let [x, y] = [i.transform[4], i.transform[5]].map(|v| (v / 10.0).max(0.0) as u32);
            given.get(x.min(25), y.min(20))
        };
        let instances = &scene.layers[layer].instances;
        let astray = instances.iter().filter(|i| place(i) != stratum).count();
        assert!(instances.len() > 10 && astray * 5 < instances.len(), "{astray} {}", instances.len());
    }
}

#[test]
fn light_and_dark_lead() {
    // The background of the exemplar grows lighter to the right; here it is to grow lighter downwards.
    let mut library = guided(&LabelMap::filled(200, 200, 0));
    let background = |i: u32| {
        let [x, y] = [i % 10 * 20 + 10, i / 10 * 20 + 10];
        ControlPoint { x: x.into(), y: y.into(), colour: Colour([40 + (x * 60 / 200) as u8; 3]) }
    };
    library.layers[0].field.as_mut().unwrap().points = (0..100).map(background).collect();
    let ramp = ControlMap::new(1, 8, (0..8).map(|v| v as f32 / 7.0).collect());
    let controls = Controls { structure: ramp.map(StructureGuide::Lightness), ..Controls::default() };
    let scene = run(&library, &params(2), &controls).0;
    let mean = |rows: std::ops::Range<f64>| {
        let points = &scene.layers[0].field.as_ref().unwrap().points;
        let own = points.iter().filter(|p| rows.contains(&p.y));
        let values: Vec<f64> = own.map(|p| p.colour.to_f64()[0]).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let (upper, lower) = (mean(0.0..70.0), mean(140.0..210.0));
    assert!(lower > upper + 25.0, "{upper} {lower}");
}

#[test]
fn other_ways_of_placing_know_one_background() {
    let library = library();
    let descriptor = SynthParams { method: Method::Descriptor, ..params(1) };
    let (scene, report) = run(&library, &descriptor, &Controls::default());
    assert_eq!((scene.layers.len(), report.strata.len()), (3, 0));
    let values: Vec<u8> =
        scene.layers[0].field.iter().flat_map(|f| &f.points).map(|p| p.colour.0[0]).collect();
    assert!(values.contains(&60) && values.contains(&180));
}

#[test]
fn an_exemplar_is_drawn_back_with_its_regions() {
    let library = library();
    let scene = reconstruct(&library);
    assert_eq!(scene.validate(), Ok(()));
    assert_eq!(scene.layers.len(), 6);
    assert_eq!(region(&scene, 3), library.strata_labels());
    assert!(scene.layers.iter().all(|l| l.role != Role::Background || l.field.is_some()));
    let map = layer_map(&library);
    assert_eq!((map.layers.len(), map.shares()), (2, vec![0.5, 0.5]));
}
