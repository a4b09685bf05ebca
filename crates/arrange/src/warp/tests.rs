//! Properties of warps.

use super::*;
use crate::synth::synthesize_with;
use kurbo::Shape;
use std::collections::BTreeMap;
use vtex_base::geometry::{Outline, Point, parse_path};
use vtex_scene::library::testing::{library, mosaic};

fn source() -> Library {
    library(&mosaic(160, 14.0, 0.6, 1))
}

/// A scene and the share of it that primaries cover.
fn scene(params: SynthParams) -> (Scene, f64) {
    let (scene, report) = synthesize_with(&[source()], &params, &Controls::default(), &()).unwrap();
    (scene, report.coverage)
}

fn plain() -> SynthParams {
    SynthParams { width: 260, height: 200, seed: 4, ..SynthParams::default() }
}

fn bent(scene: &Scene, bend: &Bend) -> (Scene, SynthReport) {
    let (result, report) = warp(scene, vec![source()], bend, WarpParams::default(), &()).unwrap();
    let again = Scene::from_bytes(result.to_json(), "warped").unwrap();
    assert_eq!(again, result);
    (result, report)
}

fn by_id(instances: &[Instance]) -> BTreeMap<InstanceId, &Instance> {
    instances.iter().map(|i| (i.id, i)).collect()
}

fn path(text: &str) -> Outline {
    Outline::new(&parse_path(text).unwrap()).unwrap()
}

#[test]
fn nothing_changes_where_nothing_is_bent() {
    let (before, _) = scene(plain());
    let bend = Bend::scale(&before, [1.0, 1.0]).unwrap();
    let (after, _) = bent(&before, &bend);
    let (old, new) = (by_id(before.primary()), by_id(after.primary()));
    let same = old.iter().filter(|(id, i)| new.get(*id) == Some(*i)).count();
    assert!(same as f64 >= 0.97 * old.len() as f64, "{same} of {}", old.len());
    assert!(new.len() as f64 <= 1.03 * old.len() as f64);
    let kept = by_id(after.secondary());
    let same = before.secondary().iter().filter(|i| kept.get(&i.id) == Some(i)).count();
    assert!(same as f64 >= 0.9 * before.secondary().len() as f64, "{same} of {}", before.secondary().len());
    assert_eq!(after.field().points, before.field().points);
}

#[test]
fn density_stays_when_the_canvas_grows_or_shrinks() {
    let (before, coverage) = scene(plain());
    for factors in [[1.6, 1.6], [0.6, 0.7], [2.0, 0.5]] {
        let bend = Bend::scale(&before, factors).unwrap();
        let (after, report) = bent(&before, &bend);
        let size = [f64::from(after.width), f64::from(after.height)];
        assert!((size[0] - 260.0 * factors[0]).abs() < 1.0 && (size[1] - 200.0 * factors[1]).abs() < 1.0);
        assert!((report.coverage - coverage).abs() < 0.03, "{factors:?}: {} {coverage}", report.coverage);
        let wanted = factors[0] * factors[1] * before.secondary().len() as f64;
        let share = after.secondary().len() as f64 / wanted;
        assert!((0.75..1.3).contains(&share), "{factors:?}: {share}");
        // Control points also lie around the canvas.
        let around = |scene: &Scene| {
            let margin = 4.0 * scene.field().spacing;
            let area = (f64::from(scene.width) + margin) * (f64::from(scene.height) + margin);
            scene.field().points.len() as f64 / area
        };
        let share = around(&after) / around(&before);
        assert!((0.5..1.6).contains(&share), "{factors:?}: {share}");
        // Moved elements are at the expected places, in their own size.
        let old = by_id(before.primary());
        let mut carried = 0;
        for instance in after.primary() {
            if let Some(was) = old.get(&instance.id) {
                carried += 1;
                assert_eq!(instance.transform[..4], was.transform[..4]);
                for k in 0..2 {
                    assert!((instance.transform[4 + k] - was.transform[4 + k] * factors[k]).abs() <= 0.5);
                }
                let (a, b) = (after.element(instance), before.element(was));
                assert_eq!(a, b);
            }
        }
        let likely = (factors[0] * factors[1]).min(1.0) * old.len() as f64;
        assert!(carried as f64 > 0.5 * likely, "{factors:?}: {carried} of {}", old.len());
    }
}

#[test]
fn a_cage_is_filled_and_nothing_else() {
    let params = SynthParams { rotate: Some(40.0), mirror: true, scale_jitter: 20.0, ..plain() };
    let (before, _) = scene(params);
    let (square, blob) = (path("M0 0H260V200H0z"), path("M60 20L300 0L250 240L150 150L20 220z"));
    let error = Bend::cage(square.clone(), blob.clone(), [320, 250]).unwrap_err();
    assert!(error.to_string().contains("4 sides, the cage after 5"), "{error}");
    let square = path("M0 0H260V200H130H0z");
    let bend = Bend::cage(square, blob.clone(), [320, 250]).unwrap();
    let (after, report) = bent(&before, &bend);
    assert_eq!((after.width, after.height), (320, 250));
    assert_eq!(after.domain.as_ref().map(|d| &d.outline), Some(&blob));
    // Its part of the canvas is as densely filled as the scene was.
    assert!((report.coverage / report.coverage_wanted - 1.0).abs() < 0.1, "{report:?}");
    let outside = |i: &&Instance| !blob.path().contains(Point::new(i.transform[4], i.transform[5]));
    let away = after.secondary().iter().filter(outside).count();
    assert!(away * 20 < after.secondary().len(), "{away} of {}", after.secondary().len());
}

#[test]
fn a_domain_is_bent_with_its_scene() {
    let disc = path("M130 20C250 20 250 180 130 180C10 180 10 20 130 20z");
    let controls = Controls { domain: Some(disc.clone()), ..Controls::default() };
    let params = SynthParams { edge: Edge::Keep, ..plain() };
    let (before, _) = synthesize_with(&[source()], &params, &controls, &()).unwrap();
    let (after, _) = bent(&before, &Bend::scale(&before, [2.0, 1.0]).unwrap());
    let domain = after.domain.unwrap();
    assert_eq!(domain.edge, Edge::Keep);
    assert!((domain.outline.area() / disc.area() - 2.0).abs() < 0.02);
}

#[test]
fn libraries_stay_apart() {
    let (one, mut two) = (source(), library(&mosaic(120, 20.0, 0.5, 2)));
    two.source.sha256 = "another".into();
    let half = |left: f32| {
        let values = vec![left, left, 1.0 - left, 1.0 - left];
        vtex_base::raster::ControlMap::new(4, 1, values).unwrap()
    };
    let controls = Controls { shares: vec![half(1.0), half(0.0)], ..Controls::default() };
    let params = plain();
    let (before, _) = synthesize_with(&[one.clone(), two.clone()], &params, &controls, &()).unwrap();
    let bend = Bend::scale(&before, [1.5, 1.5]).unwrap();
    // Libraries may be given in any order.
    let (after, _) = warp(&before, vec![two, one.clone()], &bend, WarpParams::default(), &()).unwrap();
    let strays = after.primary().iter().filter(|i| {
        let library = after.elements[i.element.index()].library;
        let (x, middle) = (i.transform[4], 1.5 * 130.0);
        if library.0 == 0 { x > middle + 40.0 } else { x < middle - 40.0 }
    });
    assert!(strays.count() * 50 < after.primary().len());
    let error = warp(&before, vec![one], &bend, WarpParams::default(), &()).unwrap_err();
    assert!(error.to_string().contains("it is not given"), "{error}");
}

#[test]
fn foreign_libraries_are_refused() {
    let (before, _) = scene(plain());
    let bend = Bend::scale(&before, [1.2, 1.0]).unwrap();
    let go = |libraries| warp(&before, libraries, &bend, WarpParams::default(), &()).unwrap_err().to_string();
    let mut other = source();
    other.source.sha256 = "another".into();
    assert!(go(vec![]).contains("it is not given"));
    assert!(go(vec![source(), other]).contains("made without it"));
    // The same photograph, analysed differently.
    assert!(go(vec![library(&mosaic(160, 14.0, 0.6, 2))]).contains("are not those of the scene"));
    for bad in [0.0, 0.05, 11.0, f64::NAN] {
        assert!(Bend::scale(&before, [1.0, bad]).is_err());
    }
}
