//! Properties of every scene between two scenes.

use super::*;
use crate::interpolate::ring::{Ring, length, moments, sine_cosine};
use std::f64::consts::TAU;
use vtex_base::document::Document;
use vtex_base::geometry::{Affine, BezPath, Outline, inside, nearest};
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::{Stream, stream};
use vtex_scene::element::SoftRim;
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{
    ControlPoint, Domain, Edge, ElementId, Field, Gradient, InstanceId, Shadow, Shape, Stroke, testing,
};

const SIZE: u32 = 120;

/// A bumpy blob around a place.
fn blob(random: &mut Stream, x: f64, y: f64, radius: f64) -> Outline {
    let (arms, depth, first) = (2 + random.below(4), random.range(0.0, 0.35), random.range(0.0, TAU));
    let point = |i: u32| {
        let angle = TAU * f64::from(i) / 40.0;
        let r = radius * (1.0 + depth * libm::sin(arms as f64 * angle + first));
        let [s, c] = sine_cosine(angle);
        Point::new(x + r * c, y + r * s)
    };
    Outline::along(&[(0..40).map(point).collect()], 0.05).unwrap()
}

fn colour(random: &mut Stream) -> Colour {
    Colour([0; 3].map(|_| random.below(256) as u8))
}

/// A scene with `primaries` primaries with details, and three times as many secondaries.
fn scene(seed: u64, primaries: u32, tile: bool) -> Scene {
    let random = &mut stream(seed, "test/interpolate", 0);
    let mut elements = Vec::new();
    let (mut primary, mut secondary) = (Vec::new(), Vec::new());
    for k in 0..primaries {
        let radius = random.range(5.0, 9.0);
        let first = Shape::new(blob(random, 0.0, 0.0, radius * 0.6), colour(random));
        let gradient = Gradient::linear([-3.0, 0.0], [3.0, 1.0], [colour(random), colour(random)]);
        let mut details = vec![Shape { gradient: Some(Box::new(gradient)), ..first }];
        for _ in 0..random.below(4) {
            let [s, c] = sine_cosine(random.range(0.0, TAU));
            let outline = blob(random, c * radius * 0.4, s * radius * 0.4, radius * 0.15);
            details.push(Shape::new(outline, colour(random)));
        }
        let own = blob(random, 0.0, 0.0, radius);
        let mut element = testing::element(k, Some((k % 3) as u16), own, colour(random));
        element.shapes.append(&mut details);
        elements.push(element);
    }
    for k in 0..8 {
        let own = blob(random, 0.0, 0.0, 1.5 + f64::from(k) * 0.2);
        elements.push(testing::element(primaries + k, None, own, colour(random)));
    }
    let size = f64::from(SIZE);
    let mut instance = |id: u32, element: u32, own: bool| {
        let (x, y) = (random.unit() * size, random.unit() * size);
        let turn = Affine::translate((x, y)) * vtex_base::geometry::rotation(random.range(0.0, 0.5));
        Instance {
            transform: turn.as_coeffs(),
            colour: own.then(|| colour(random)),
            ..Instance::new(InstanceId(id), ElementId(element))
        }
    };
    for k in 0..primaries {
        primary.push(instance(k, k, false));
    }
    for k in 0..3 * primaries {
        secondary.push(instance(primaries + k, primaries + k % 8, true));
    }
    let points = (0..30).map(|_| ControlPoint {
        x: random.unit() * size,
        y: random.unit() * size,
        colour: colour(random),
    });
    let field = Field { points: points.collect(), ..testing::flat(Colour([9; 3])) };
    Scene {
        tile: Tile { x: tile, y: tile },
        libraries: vec![LibraryRef {
            fine: false,
            exemplar: format!("{seed}.png"),
            sha256: seed.to_string(),
            categories: Vec::new(),
        }],
        ..testing::scene([SIZE; 2], elements, secondary, primary, field)
    }
}

fn between(a: &Scene, b: &Scene, t: f64) -> Scene {
    Interpolation::new(a.clone(), b.clone(), &()).unwrap().at(t)
}

fn flat(outline: &Outline) -> Ring {
    outline.polygons(0.02).swap_remove(0)
}

fn area(scene: &Scene) -> f64 {
    scene.primary().iter().map(|i| scene.element(i).outline().area() * i.affine().determinant()).sum()
}

#[test]
fn the_ends_are_the_scenes_and_all_between_is_valid() {
    let (a, b) = (scene(1, 20, false), scene(2, 12, false));
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    assert!(
        between.at(0.0) == a && between.at(1.0) == b && between.at(-3.0) == a && between.at(f64::NAN) == a
    );
    let [_, (_, secondary), (_, primary)] = between.matched()[..] else { panic!("three layers") };
    assert_eq!((primary.pairs, primary.unmatched), (12, 8));
    assert_eq!(secondary.pairs * 2 + secondary.unmatched, 3 * 32);
    for k in 1..10 {
        let scene = between.at(f64::from(k) / 10.0);
        scene.validate().unwrap();
        assert_eq!(scene.libraries.len(), 2);
        assert!(Scene::from_bytes(scene.to_json(), "between").unwrap() == scene);
    }
}

#[test]
fn a_scene_between_looks_like_its_neighbours() {
    let (a, b) = (scene(3, 20, false), scene(4, 20, false));
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    let areas: Vec<f64> = (0..=20).map(|k| area(&between.at(f64::from(k) / 20.0))).collect();
    let (low, high) = (areas[0].min(areas[20]), areas[0].max(areas[20]));
    for pair in areas.windows(2) {
        assert!(pair[1] > 0.75 * low && pair[1] < 1.15 * high, "{areas:?}");
        assert!((pair[1] - pair[0]).abs() < 0.12 * high, "{areas:?}");
    }
    // The field begins as that of the first.
    let near = between.at(1e-9);
    let field = |s: &Scene| Interpolant::new(s.field(), SIZE, SIZE, s.tile);
    let (first, here) = (field(&a), field(&near));
    for p in &b.field().points {
        let (u, v) = (first.at(p.x, p.y), here.at(p.x, p.y));
        assert!((0..3).all(|k| (u[k] - v[k]).abs() <= 3.0), "{u:?} {v:?}");
    }
}

#[test]
fn nothing_moves_in_leaps() {
    let (a, b) = (scene(5, 15, false), scene(6, 15, false));
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    let places = |t: f64| -> Vec<(InstanceId, Point)> {
        let scene = between.at(t);
        let mut all: Vec<_> = scene
            .primary()
            .iter()
            .map(|i| (i.id, i.affine() * moments(&flat(scene.element(i).outline())).1))
            .collect();
        all.sort_by_key(|p| p.0);
        all
    };
    let mut before = places(0.02);
    for k in 2..50 {
        let here = places(f64::from(k) / 50.0);
        for (id, p) in &here {
            if let Ok(i) = before.binary_search_by_key(id, |p| p.0) {
                assert!(length(before[i].1 - *p) < 3.0, "{id} at {k}");
            }
        }
        before = here;
    }
}

#[test]
fn no_detail_sticks_out_of_its_texton() {
    let (a, b) = (scene(7, 25, false), scene(8, 25, false));
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    for t in [0.1, 0.35, 0.5, 0.8] {
        let scene = between.at(t);
        let mut seen = 0;
        for i in scene.primary() {
            let element = scene.element(i);
            let hull = flat(element.outline());
            for detail in element.details() {
                for p in detail.outline.polygons(0.05).concat() {
                    assert!(inside(&hull, p) || length(nearest(&hull, p) - p) < 0.4, "{t}: {p:?}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 500);
    }
}

#[test]
fn scenes_that_tile_tile_on_the_way() {
    let (a, b) = (scene(9, 20, true), scene(10, 20, true));
    let half = between(&a, &b, 0.5);
    assert!(half.tile.both());
    let on_canvas = |i: &Instance| i.transform[4..].iter().all(|v| (-20.0..140.0).contains(v));
    assert!(half.primary().iter().all(on_canvas));
    // A scene that is not periodic: the copies of the other are listed one by one.
    let plain = scene(11, 20, false);
    let half = between(&a, &plain, 0.5);
    assert!(!half.tile.any());
    let near = between(&a, &plain, 1e-6);
    let copies = a
        .primary()
        .iter()
        .map(|i| a.copies(i.affine().transform_rect_bbox(a.elements[i.element.index()].bounds())).count());
    assert_eq!(near.primary().len(), copies.sum::<usize>());
    near.validate().unwrap();
}

#[test]
fn across_the_canvas_each_side_is_its_own() {
    let (a, b) = (scene(12, 30, true), scene(13, 30, false));
    let mixed = across(a.clone(), b.clone(), Axis::X, &()).unwrap();
    mixed.validate().unwrap();
    assert!(!mixed.tile.any());
    // One of the two is periodic: an instance's copies, shifted by whole widths or heights, exist too.
    let same = |a: [f64; 6], b: [f64; 6]| {
        let periods = |k: usize| (a[k] - b[k]) / f64::from(SIZE);
        a[..4] == b[..4] && [4, 5].iter().all(|&k| (periods(k) - libm::rint(periods(k))).abs() < 1e-9)
    };
    let there = |scene: &Scene, instance: &Instance| {
        scene.primary().iter().any(|i| same(i.transform, instance.transform))
    };
    let mut seen = [0, 0];
    for i in mixed.primary() {
        let x = i.transform[4];
        if (0.0..6.0).contains(&x) {
            assert!(there(&a, i));
            seen[0] += 1;
        } else if (114.0..120.0).contains(&x) {
            assert!(there(&b, i));
            seen[1] += 1;
        }
    }
    assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
}

#[test]
fn domains_become_one_another() {
    let (mut a, mut b) = (scene(14, 10, false), scene(15, 10, false));
    let square = |side: f64| {
        let mut path = BezPath::new();
        path.move_to((60.0 - side, 60.0 - side));
        for (x, y) in [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            path.line_to((60.0 + x * side, 60.0 + y * side));
        }
        path.close_path();
        Domain { outline: Outline::new(&path).unwrap(), edge: Edge::Clip }
    };
    a.domain = Some(square(20.0));
    let grown = between(&a, &b, 0.5).domain.unwrap().outline.area();
    assert!(grown > 1600.0 && grown < 14400.0, "{grown}");
    b.domain = Some(square(40.0));
    let half = between(&a, &b, 0.5).domain.unwrap().outline.area();
    assert!((half - 3600.0).abs() < 60.0, "{half}");
}

#[test]
fn a_part_of_a_shape_without_partner_shrinks_as_it_is() {
    let (mut a, mut b) = (scene(23, 4, false), scene(24, 4, false));
    let rect = |path: &mut BezPath, x: f64, y: f64, w: f64, h: f64| {
        path.move_to((x, y));
        [(x + w, y), (x + w, y + h), (x, y + h)].into_iter().for_each(|p| path.line_to(p));
        path.close_path();
    };
    let mut path = BezPath::new();
    rect(&mut path, 5.0, 5.0, 60.0, 100.0);
    let one = Domain { outline: Outline::new(&path).unwrap(), edge: Edge::Clip };
    rect(&mut path, 80.0, 20.0, 30.0, 30.0);
    let two = Domain { outline: Outline::new(&path).unwrap(), edge: Edge::Clip };
    (a.domain, b.domain) = (Some(two), Some(one));
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    let half = between.at(0.5).domain.unwrap().outline.area();
    assert!((half - 6000.0 - 225.0).abs() < 40.0, "{half}");
    // The points are dense enough that curves through them stay close to the sides.
    for ring in between.domain_motion().unwrap().0.rings {
        let first = &ring[0];
        let far = (0..first.len()).map(|i| length(first[(i + 1) % first.len()] - first[i]));
        assert!(far.fold(0.0, f64::max) < 4.0);
    }
}

#[test]
fn shadows_and_lines_change_without_a_jump() {
    let (a, mut b) = (scene(21, 15, false), scene(22, 15, false));
    for instance in b.instances_mut() {
        instance.transform[..4].copy_from_slice(&[1.4, 0.0, 0.0, 1.4]);
        instance.shadow = Some(Shadow { offset: [6.0, 3.0], opacity: 0.5, blur: 2.0 });
        instance.stroke = Some(Stroke { width: 1.0, colour: Colour([0, 0, 200]) });
    }
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    // Width and opacity on the canvas, by id.
    let look = |t: f64| -> std::collections::BTreeMap<InstanceId, [f64; 2]> {
        let scene = between.at(t);
        scene.validate().unwrap();
        let of = |i: &Instance| {
            let scale = libm::sqrt(i.affine().determinant().abs());
            [i.stroke.map_or(0.0, |s| s.width * scale), i.shadow.map_or(0.0, |s| s.opacity)]
        };
        scene.instances().map(|i| (i.id, of(i))).collect()
    };
    let paired = between.matched()[2].1.pairs;
    let mut before = look(0.01);
    for k in 1..100 {
        let here = look(f64::from(k) / 100.0);
        let mut seen = 0;
        for (id, now) in &here {
            let Some(then) = before.get(id) else { continue };
            let far = |k: usize| (now[k] - then[k]).abs();
            assert!(far(0) < 0.1 && far(1) < 0.1, "{id} at {k}: {then:?} {now:?}");
            seen += 1;
        }
        assert!(seen >= paired, "{seen}");
        before = here;
    }
    assert!(before.values().all(|v| v[0] > 1.3 && v[1] > 0.49), "{before:?}");
}

#[test]
fn plain_backgrounds_mix_and_a_scene_between_says_what_it_is() {
    let plain = |seed: u64, grey: u8| {
        let mut plain = scene(seed, 3, false);
        *plain.field_mut() = testing::flat(Colour([grey; 3]));
        plain
    };
    let (a, b) = (plain(25, 20), plain(26, 220));
    let background =
        |scene: &Scene, x: f64| Interpolant::new(scene.field(), SIZE, SIZE, scene.tile).at(x, 60.0)[0];
    let between = Interpolation::new(a.clone(), b.clone(), &()).unwrap();
    assert!(background(&between.at(0.001), 60.0) < 24.0 && background(&between.at(0.999), 60.0) > 216.0);
    let mixed = across(a.clone(), b.clone(), Axis::X, &()).unwrap();
    assert!(background(&mixed, 3.0) < 24.0 && background(&mixed, 117.0) > 216.0);
    let recorded = |scene: &Scene| scene.edits.last().unwrap().operation.to_string();
    assert_eq!(recorded(&mixed), "interpolation from=25.png to=26.png across=x");
    assert_eq!(recorded(&between.at(0.25)), "interpolation from=25.png to=26.png at=0.25");
}

#[test]
fn a_morph_has_each_scene_in_its_place() {
    let (a, b) = (scene(12, 40, true), scene(13, 40, true));
    let islands = morph(a.clone(), b.clone(), &Morph::Radial, &()).unwrap();
    assert!(islands.tile.x && islands.tile.y, "all borders are of the second");
    let half = vtex_base::raster::ControlMap::new(2, 1, vec![1.0, 0.0]).unwrap();
    let by_map = morph(a.clone(), b.clone(), &Morph::Map(half), &()).unwrap();
    by_map.validate().unwrap();
    assert!(!by_map.tile.any());
    // Of a scene that repeats, copies are listed where the result does not.
    let same = |a: [f64; 6], b: [f64; 6]| {
        let periods = |k: usize| (a[k] - b[k]) / f64::from(SIZE);
        a[..4] == b[..4] && [4, 5].iter().all(|&k| (periods(k) - libm::rint(periods(k))).abs() < 1e-9)
    };
    let there = |scene: &Scene, i: &Instance| scene.primary().iter().any(|k| same(k.transform, i.transform));
    let at = |i: &Instance| (i.transform[4] - 60.0, i.transform[5] - 60.0);
    let mut seen = [0; 4];
    for i in islands.primary() {
        let (x, y) = at(i);
        let far = libm::sqrt(x * x + y * y) / 60.0;
        if far < 0.1 {
            assert!(there(&a, i));
            seen[0] += 1;
        } else if far > 1.0 && (-60.0..60.0).contains(&x) && (-60.0..60.0).contains(&y) {
            assert!(there(&b, i));
            seen[1] += 1;
        }
    }
    for i in by_map.primary() {
        let x = at(i).0;
        if (-60.0..-30.0).contains(&x) {
            assert!(there(&b, i));
            seen[2] += 1;
        } else if (30.0..60.0).contains(&x) {
            assert!(there(&a, i));
            seen[3] += 1;
        }
    }
    assert!(seen[1..].iter().all(|n| *n > 0), "{seen:?}");
    let recorded = |scene: &Scene| scene.edits.last().unwrap().operation.to_string();
    assert!(recorded(&islands).ends_with("morph=radial") && recorded(&by_map).ends_with("morph=map"));
}

#[test]
fn what_both_have_stays_as_it_is() {
    let a = scene(27, 12, false);
    let mut b = a.clone();
    b.primary_mut().truncate(8);
    b.field_mut().points.truncate(20);
    for t in [0.3, 0.7] {
        let between = between(&a, &b, t);
        for i in b.primary() {
            let there = |j: &&Instance| j.transform == i.transform;
            let found = between.primary().iter().find(there).unwrap();
            assert!(
                between.elements[found.element.index()].outline() == b.elements[i.element.index()].outline()
            );
        }
        assert_eq!(between.secondary().len(), a.secondary().len());
    }
}

#[test]
fn other_sizes_and_empty_scenes() {
    let a = scene(16, 5, false);
    let mut b = scene(17, 5, false);
    b.width = 60;
    assert!(matches!(Interpolation::new(a.clone(), b.clone(), &()), Err(Error::Sizes { .. })));
    let mut empty = scene(18, 0, false);
    empty.field_mut().points.clear();
    let half = between(&a, &empty, 0.5);
    half.validate().unwrap();
    assert!(half.primary().len() <= 5);
    between(&empty, &empty, 0.5).validate().unwrap();
    assert!(matches!(
        Interpolation::new(a.clone(), a.clone(), &vtex_testing::StopAtOnce),
        Err(Error::Interrupted)
    ));
}

#[test]
fn an_interpolation_owns_its_scenes() {
    let made = || Interpolation::new(scene(3, 12, false), scene(4, 12, false), &()).unwrap();
    let (here, there) = (made(), made());
    let middle = std::thread::spawn(move || there.at(0.5)).join().unwrap();
    assert_eq!(middle, here.at(0.5));
}

#[test]
fn rims_are_mixed_and_appear() {
    let rim = SoftRim { width: 4.0, colour: Colour([90; 3]), opacity: 0.8 };
    let (mut a, mut b) = (scene(21, 12, false), scene(22, 12, false));
    for scene in [&mut a, &mut b] {
        scene.elements.iter_mut().take(12).for_each(|e| e.shapes[0].rim = Some(Box::new(rim)));
    }
    // Elements at twice the size have rims of twice the width.
    for instance in b.primary_mut() {
        (0..4).for_each(|k| instance.transform[k] *= 2.0);
    }
    let rims = |scene: &Scene| -> Vec<[f64; 2]> {
        let seen = |i: &Instance| {
            let rim = scene.element(i).base().rim.as_ref()?;
            Some([rim.width * libm::sqrt(i.affine().determinant().abs()), rim.opacity])
        };
        scene.primary().iter().filter_map(seen).collect()
    };
    let near = |found: &[[f64; 2]], wanted: [f64; 2]| {
        let off = |k: usize| found.iter().map(|f| (f[k] - wanted[k]).abs()).fold(0.0, f64::max);
        assert!(off(0) < 0.05 * wanted[0] && off(1) < 0.05, "{found:?}, not {wanted:?}");
    };
    let [first, last] = [1e-6, 1.0 - 1e-6].map(|t| between(&a, &b, t));
    near(&rims(&first), [4.0, 0.8]);
    near(&rims(&last), [8.0, 0.8]);
    let middle = rims(&between(&a, &b, 0.5));
    assert_eq!(middle.len(), 12);
    assert!(
        middle.iter().all(|[width, opacity]| (4.0..=8.0).contains(width) && (opacity - 0.8).abs() < 1e-9)
    );
    assert!(middle.iter().any(|[width, _]| (5.0..7.0).contains(width)), "{middle:?}");
    // From none to one.
    a.elements.iter_mut().for_each(|e| e.shapes[0].rim = None);
    let middle = rims(&between(&a, &b, 0.5));
    assert!(middle.iter().any(|[_, opacity]| (0.2..0.6).contains(opacity)), "{middle:?}");
    assert_eq!(rims(&between(&a, &b, 1e-6)).len(), 0);
}
