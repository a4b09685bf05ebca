//! Properties of whole synthesised scenes.

use super::{
    Controls, SynthReport, SynthesisMemory, reconstruct, synthesize, synthesize_again, synthesize_with,
};
use crate::arrange::model::{PlaceableId, PlacementModel};
use std::collections::BTreeSet;
use vtex_base::document::Document;
use vtex_base::error::Error;
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::Library;
use vtex_scene::library::testing::{library, mosaic};
use vtex_scene::scene::{Ablation, Method, Role, Scene, SynthParams, Tile};

fn params(width: u32, height: u32, seed: u64) -> SynthParams {
    SynthParams { width, height, seed, ..SynthParams::default() }
}

fn run(library: &Library, params: &SynthParams) -> (Scene, SynthReport) {
    synthesize_with(std::slice::from_ref(library), params, &Controls::default(), &()).unwrap()
}

/// The instances of a scene painted on a map of instance indices, from 1.
fn painted(library: &Library, scene: &Scene) -> LabelMap {
    let model = PlacementModel::new(std::slice::from_ref(library), &SynthParams::default());
    let mut map = LabelMap::filled(scene.width, scene.height, 0);
    for (i, instance) in scene.primary().iter().enumerate() {
        let shape = model.plain(PlaceableId(scene.element(instance).source.unwrap().0));
        let moved = shape.mask.shifted(instance.transform[4] as i32, instance.transform[5] as i32);
        for (x, y) in moved.pixels() {
            if map.at(i64::from(x), i64::from(y)).is_some() {
                map.set(x as u32, y as u32, i as u32 + 1);
            }
        }
    }
    map
}

#[test]
fn test_libraries_are_valid() {
    for fill in [0.3, 0.97] {
        let library = library(&mosaic(120, 14.0, fill, 1));
        assert_eq!(library.validate(), Ok(()));
        assert!(library.primaries().len() > 20);
    }
}

#[test]
fn secondaries_keep_their_colours_without_matching() {
    let mut library = library(&mosaic(200, 15.0, 0.4, 1));
    let first = library.primaries().len();
    for (k, element) in library.elements.iter_mut().skip(first).enumerate() {
        element.colour = Colour([(k * 37 % 200) as u8, 90, 120]);
        element.difference = Some([0; 3]);
    }
    let colours = |ablate: Vec<Ablation>| {
        let params = SynthParams { method: Method::Descriptor, ablate, ..params(300, 300, 1) };
        let (scene, _) = run(&library, &params);
        let of_role = scene.layers.iter().filter(|l| l.role == Role::Secondary);
        let painted = of_role.flat_map(|l| &l.instances).filter_map(|i| i.colour.map(|c| c.0));
        painted.collect::<BTreeSet<_>>()
    };
    // The background is even, so matched colours are alike, however much the exemplar's vary.
    let (matched, kept) = (colours(Vec::new()), colours(vec![Ablation::Matching]));
    assert!(kept.len() > 3 * matched.len(), "{matched:?} {kept:?}");
    // Colours are quantised to steps of five.
    assert!(kept.iter().all(|c| c[1].abs_diff(90) < 3 && c[2].abs_diff(120) < 3), "{kept:?}");
}

#[test]
fn coverage_is_that_of_the_exemplar() {
    for (fill, seed) in [(0.35, 1), (0.6, 2), (0.9, 3), (1.2, 4)] {
        let library = library(&mosaic(200, 15.0, fill, seed));
        for (w, h) in [(330, 270), (180, 400)] {
            let (scene, report) = run(&library, &params(w, h, seed));
            assert_eq!(scene.validate(), Ok(()));
            // The report agrees with the painted map.
            let map = painted(&library, &scene);
            let covered = map.labels.iter().filter(|&&l| l != 0).count() as f64 / map.labels.len() as f64;
            assert!((covered - report.coverage).abs() < 1e-9);
            assert!((covered - library.coverage).abs() < 0.02, "{covered} {}", library.coverage);
            for c in report.categories.iter().filter(|c| c.wanted > 0.02) {
                assert!((c.got / c.wanted - 1.0).abs() < 0.2, "fill {fill}: {c:?}");
            }
        }
    }
}

#[test]
fn reported_overlap_and_repetition_are_those_of_the_scene() {
    let library = library(&mosaic(200, 15.0, 0.9, 3));
    let (scene, report) = run(&library, &params(250, 210, 3));
    // Visible areas as painted, and whole areas, with each instance painted alone.
    let map = painted(&library, &scene);
    let mut visible = map.areas();
    visible.resize(scene.primary().len() + 1, 0);
    let alone = |i: usize| {
        let mut one = scene.clone();
        *one.primary_mut() = vec![scene.primary()[i].clone()];
        painted(&library, &one).areas().get(1).copied().unwrap_or(0)
    };
    let areas: Vec<u32> = (0..scene.primary().len()).map(alone).collect();
    let (shown, all) = (visible[1..].iter().sum::<u32>(), areas.iter().sum::<u32>());
    assert!((report.overlap.hidden - f64::from(all - shown) / f64::from(all)).abs() < 1e-12);
    let buried = areas.iter().zip(&visible[1..]).filter(|(a, v)| *v * 2 < **a).count();
    assert!((report.overlap.buried - buried as f64 / areas.len() as f64).abs() < 1e-12);
    assert!(report.overlap.hidden > 0.001, "nothing to compare");
    assert_eq!(report.repetition.textons, report.textons);
    assert!(report.repetition.textons <= report.repetition.placeable);
    assert!(report.repetition.largest_share * report.primaries as f64 >= 1.0);
}

#[test]
fn textons_stand_all_over_the_canvas() {
    // No quarter, and no strip along a border, is much emptier than the whole.
    let library = library(&mosaic(200, 15.0, 0.6, 5));
    let (scene, report) = run(&library, &params(400, 400, 5));
    let map = painted(&library, &scene);
    let boxes =
        [(0, 0, 200, 200), (200, 0, 400, 200), (0, 200, 200, 400), (200, 200, 400, 400), (0, 0, 400, 12)];
    for (x0, y0, x1, y1) in boxes.into_iter().chain([(0, 388, 400, 400), (0, 0, 12, 400), (388, 0, 400, 400)])
    {
        let taken: usize = (y0..y1).map(|y| (x0..x1).filter(|&x| map.get(x, y) != 0).count()).sum();
        let share = taken as f64 / f64::from((x1 - x0) * (y1 - y0));
        assert!(
            share > 0.7 * report.coverage && share < 1.3 * report.coverage,
            "{share} {}",
            report.coverage
        );
    }
}

#[test]
fn clipped_textons_are_never_placed() {
    let library = library(&mosaic(150, 14.0, 0.9, 6));
    let (scene, _) = run(&library, &params(300, 300, 6));
    assert!(library.primaries().iter().any(|p| p.clipped));
    for instance in scene.primary() {
        let element = scene.element(instance);
        assert!(!library.primaries()[element.source.unwrap().index()].clipped);
    }
}

#[test]
fn little_is_hidden() {
    for (fill, most) in [(0.35, 0.08), (0.9, 0.3)] {
        let library = library(&mosaic(200, 15.0, fill, 7));
        let (scene, _) = run(&library, &params(400, 400, 7));
        let map = painted(&library, &scene);
        let areas = map.areas();
        let model = PlacementModel::new(std::slice::from_ref(&library), &SynthParams::default());
        let (mut visible, mut whole) = (0u32, 0u32);
        for (i, instance) in scene.primary().iter().enumerate() {
            let shape = model.plain(PlaceableId(scene.element(instance).source.unwrap().0));
            let [x, y] = [instance.transform[4] as i32, instance.transform[5] as i32];
            let b = shape.bounds;
            if x + b[0] >= 0 && y + b[1] >= 0 && x + b[2] <= 400 && y + b[3] <= 400 {
                visible += areas[i + 1];
                whole += shape.area;
                assert!(areas[i + 1] > 0, "a texton is hidden altogether");
            }
        }
        let hidden = 1.0 - f64::from(visible) / f64::from(whole);
        assert!(hidden < most, "fill {fill}: {hidden}");
    }
}

#[test]
fn no_secondary_is_hidden() {
    let library = library(&mosaic(200, 15.0, 0.8, 8));
    let (scene, report) = run(&library, &params(400, 300, 8));
    let map = painted(&library, &scene);
    assert!(report.secondaries > 50);
    for instance in scene.secondary() {
        let [x, y] = [instance.transform[4] as i64, instance.transform[5] as i64];
        // Test secondaries cover the four pixels around their origin.
        let seen =
            [(-1, -1), (0, -1), (-1, 0), (0, 0)].iter().any(|(dx, dy)| map.at(x + dx, y + dy) == Some(0));
        assert!(seen, "{x} {y}");
        assert!(instance.colour.is_some());
    }
    // The number of secondaries per area of background is the exemplar's.
    let background = |coverage: f64, w: u32, h: u32| (1.0 - coverage) * f64::from(w) * f64::from(h);
    let wanted = library.secondaries().len() as f64 / background(library.coverage, 200, 200);
    let got = report.secondaries as f64 / background(report.coverage, 400, 300);
    assert!((got / wanted - 1.0).abs() < 0.2, "{got} {wanted}");
}

#[test]
fn equal_textons_keep_apart() {
    let library = library(&mosaic(200, 15.0, 0.6, 9));
    let (scene, _) = run(&library, &params(500, 500, 9));
    let near = scene.primary().iter().enumerate().filter(|(i, a)| {
        scene.primary()[..*i].iter().any(|b| {
            let [dx, dy] = [4, 5].map(|k| a.transform[k] - b.transform[k]);
            a.element == b.element && libm::hypot(dx, dy) < 20.0
        })
    });
    let share = near.count() as f64 / scene.primary().len() as f64;
    assert!(share < 0.02, "{share}");
}

#[test]
fn a_library_without_primaries_gives_a_background() {
    let library = library(&LabelMap::filled(100, 80, 0));
    assert_eq!(library.validate(), Ok(()));
    let (scene, report) = run(&library, &params(200, 150, 1));
    assert!(scene.primary().is_empty() && !scene.secondary().is_empty());
    assert!(scene.field().points.len() > 20);
    assert_eq!((report.coverage, report.attempts), (0.0, 0));

    let mut bare = library.clone().without_secondaries();
    bare.layers[0].field.as_mut().unwrap().points.clear();
    let (scene, _) = run(&bare, &params(64, 64, 1));
    assert!(scene.secondary().is_empty() && scene.field().points.is_empty());
    assert_eq!(scene.validate(), Ok(()));
}

#[test]
fn any_size_and_parameter_is_survived() {
    let mut whole = library(&mosaic(80, 16.0, 0.9, 11));
    let sizes = [(1, 1), (3, 2000), (700, 2), (20, 20)];
    for (w, h) in sizes {
        let (scene, _) = run(&whole, &params(w, h, 0));
        assert_eq!(scene.validate(), Ok(()));
        assert_eq!((scene.width, scene.height), (w, h));
    }
    for (candidates, moves) in [(1, 0), (100, 20)] {
        let p = SynthParams { candidates, moves, ..params(60, 60, 1) };
        assert!(run(&whole, &p).1.coverage > 0.3);
    }
    let mut torus = whole.clone();
    torus.arrangement.periodic = true;
    assert!(run(&torus, &params(90, 90, 1)).1.coverage > 0.3);
    // Extreme libraries: descriptors of size 0, unreachable coverage, no placeable element.
    whole.descriptor_half = 0;
    assert!(run(&whole, &params(90, 90, 1)).1.coverage > 0.3);
    whole.coverage = 1.0;
    whole.categories.iter_mut().for_each(|c| c.coverage = 1.0);
    run(&whole, &params(90, 90, 1));
    whole.elements.iter_mut().for_each(|p| p.clipped = true);
    assert!(run(&whole, &params(50, 50, 1)).0.primary().is_empty());
    let one = library(&LabelMap::filled(30, 30, 1));
    assert!(run(&one, &params(50, 50, 1)).0.primary().is_empty());
}

#[test]
fn refused_are_bad_parameters_and_other_numbers_of_maps() {
    let library = library(&mosaic(60, 16.0, 0.9, 12));
    let fails = |libraries: &[Library], p: &SynthParams| {
        synthesize_with(libraries, p, &Controls::default(), &()).unwrap_err()
    };
    assert!(matches!(fails(&[], &params(9, 9, 0)), Error::Parameter { name: "libraries", .. }));
    let two = [library.clone(), library.clone()];
    assert!(matches!(fails(&two, &params(9, 9, 0)), Error::Parameter { name: "map", .. }));
    let one = std::slice::from_ref(&library);
    assert!(matches!(fails(one, &params(0, 9, 0)), Error::Parameter { name: "size", .. }));
    assert!(matches!(fails(one, &params(100_000, 100_000, 0)), Error::TooLarge { .. }));
}

#[test]
fn asked_to_stop_it_stops() {
    let library = library(&mosaic(60, 16.0, 0.9, 13));
    let result = synthesize(&library, &params(90, 90, 0), &vtex_testing::StopAtOnce);
    assert!(matches!(result, Err(Error::Interrupted)));
}

#[test]
fn reconstruction_is_the_exemplar() {
    let map = mosaic(120, 14.0, 0.9, 14);
    let library = library(&map);
    let scene = reconstruct(&library);
    assert_eq!(scene.validate(), Ok(()));
    assert_eq!(painted(&library, &scene), map);
    // Outlines have not moved.
    for (instance, p) in scene.primary().iter().zip(library.primaries()) {
        let element = scene.element(instance);
        let moved = instance.affine() * element.outline().path();
        assert_eq!(vtex_base::geometry::Outline::new(&moved), Some(p.outline().clone()));
    }
}

#[test]
fn a_scene_does_not_depend_on_what_was_made_before() {
    let libraries = [1, 2].map(|seed| [vtex_scene::library::testing::guided(&mosaic(120, 14.0, 0.6, seed))]);
    let memory = SynthesisMemory::default();
    for (k, width, seed) in [(0, 90, 1), (0, 160, 1), (0, 90, 5), (1, 90, 1), (0, 90, 1)] {
        let params = SynthParams { width, height: 100, seed, ..SynthParams::default() };
        let controls = Controls::default();
        let again = synthesize_again(&libraries[k], &params, &controls, &memory, &()).unwrap();
        let fresh = synthesize_with(&libraries[k], &params, &controls, &()).unwrap();
        assert!(again.1.structure.is_some());
        assert!(again.0.to_json() == fresh.0.to_json(), "{k} {width} {seed}");
    }
}

/// Correspondences.
mod carried {
    use super::*;
    use vtex_base::geometry::{Interior, Outline, Point, parse_path};
    use vtex_base::raster::{ControlMap, squared_distance};
    use vtex_scene::library::testing::guided;
    use vtex_scene::scene::{Edge, Instance, LatticeChoice, Method};

    /// Stones in the left half of an exemplar, few in the right one.
    fn uneven() -> Library {
        let mut map = mosaic(240, 13.0, 0.8, 9);
        let masks = vtex_base::raster::Mask::all_of_labels(&map, map.areas().len());
        let mut names = vec![0; masks.len()];
        let mut count = 0;
        for (label, mask) in masks.iter().enumerate().skip(1) {
            if mask.centroid().is_some_and(|(x, _)| x < 120.0 || label % 9 == 0) {
                count += 1;
                names[label] = count;
            }
        }
        map.labels.iter_mut().for_each(|l| *l = names[*l as usize]);
        guided(&map)
    }

    /// Standard deviation of the share that primaries cover in blocks.
    fn spread(map: &LabelMap, block: u32) -> f64 {
        let (columns, rows) = (map.width / block, map.height / block);
        let share = |k: u32| {
            let (x0, y0) = (k % columns * block, k / columns * block);
            let taken = (0..block * block).filter(|i| map.get(x0 + i % block, y0 + i / block) != 0).count();
            taken as f64 / f64::from(block * block)
        };
        let shares: Vec<f64> = (0..columns * rows).map(share).collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        libm::sqrt(shares.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / shares.len() as f64)
    }

    #[test]
    fn structure_larger_than_a_few_stones_is_kept() {
        let library = uneven();
        let exemplar = spread(&library.arrangement.to_labels(), 40);
        for seed in 1..4 {
            let of = |method| {
                let (scene, report) = run(&library, &SynthParams { method, ..params(360, 360, seed) });
                assert_eq!((scene.validate(), report.method), (Ok(()), method));
                spread(&painted(&library, &scene), 40) / exemplar
            };
            let (carried, drawn) = (of(Method::Correspondence), of(Method::Descriptor));
            assert!((0.75..1.3).contains(&carried), "{carried}");
            assert!(carried > drawn + 0.1, "{carried} {drawn}");
        }
    }

    #[test]
    fn coverage_is_near_that_of_the_exemplar_and_holes_are_closed() {
        for (fill, seed) in [(0.35, 1), (0.9, 3), (1.2, 4)] {
            let library = guided(&mosaic(200, 15.0, fill, seed));
            let (scene, report) = run(&library, &params(400, 330, seed));
            assert_eq!(report.method, Method::Correspondence);
            assert_eq!(scene.validate(), Ok(()));
            assert!(
                (report.coverage - library.coverage).abs() < 0.04,
                "{} {}",
                report.coverage,
                library.coverage
            );
            let structure = report.structure.unwrap();
            assert!((structure.wanted - report.coverage).abs() < 0.04, "{structure:?} {}", report.coverage);
            // Elements stay whole, for which gaps of a few pixels are left between them.
            assert!(structure.fused_share < 0.1 * structure.wanted, "{structure:?}");
            assert!(structure.empty < 0.035 && structure.unwanted < 0.05, "{structure:?}");
            // Fused elements are no larger than elements.
            let areas = library.primaries().iter().map(|p| p.outline().area());
            let largest = areas.fold(0.0, f64::max);
            for t in scene.elements.iter().filter(|t| t.fused) {
                assert!(t.outline().area() < 1.7 * largest, "{} {largest}", t.outline().area());
            }
        }
    }

    /// Radius of the largest disc without primaries and origins of secondaries.
    fn largest_bare_disc(primaries: &LabelMap, secondaries: impl Iterator<Item = [i32; 2]>) -> f32 {
        let mut map = primaries.clone();
        for [x, y] in secondaries.filter(|&[x, y]| primaries.at(x.into(), y.into()).is_some()) {
            map.set(x as u32, y as u32, 1);
        }
        let squares = squared_distance(map.width as usize, map.height as usize, |i| map.labels[i] != 0);
        squares.into_iter().fold(0.0, f32::max).sqrt()
    }

    /// A map that is above 0 where primaries are drawn, fused ones too.
    fn drawn(scene: &Scene) -> LabelMap {
        let mut map = LabelMap::filled(scene.width, scene.height, 0);
        for instance in scene.primary() {
            let inside = Interior::new(scene.element(instance).outline());
            let [dx, dy] = [instance.transform[4], instance.transform[5]];
            for (i, label) in map.labels.iter_mut().enumerate() {
                let [x, y] = [i as u32 % scene.width, i as u32 / scene.width].map(|v| f64::from(v) + 0.5);
                *label |= u32::from(inside.contains(Point::new(x - dx, y - dy)));
            }
        }
        map
    }

    #[test]
    fn ground_below_elements_that_were_left_out_is_not_bare() {
        // Few large stones: many are cut at the borders of islands.
        let library = guided(&mosaic(240, 60.0, 0.5, 5));
        let origins = library.secondaries().iter().map(|s| s.origin());
        let wanted = largest_bare_disc(&library.arrangement.to_labels(), origins);
        for seed in 1..3 {
            let (scene, report) = run(&library, &params(500, 400, seed));
            assert_eq!(report.method, Method::Correspondence);
            let places = scene.secondary().iter().map(|i| [i.transform[4] as i32, i.transform[5] as i32]);
            let found = largest_bare_disc(&drawn(&scene), places);
            // More than four times as large where such ground stays bare.
            assert!(found < 2.0 * wanted, "{found} {wanted}");
        }
    }

    #[test]
    fn neighbours_stand_as_in_the_exemplar_to_the_pixel() {
        let library = guided(&mosaic(240, 14.0, 0.7, 2));
        // Share of primaries whose nearest neighbour is exactly as far away as in the exemplar.
        let kept = |method| {
            let (scene, _) = run(&library, &SynthParams { method, ..params(300, 300, 5) });
            let offsets: Vec<[[f64; 2]; 2]> = scene
                .primary()
                .iter()
                .map(|i| {
                    let source = scene.element(i).source.unwrap().index();
                    let origin = library.primaries()[source].centroid.map(libm::round);
                    let at = [i.transform[4], i.transform[5]];
                    [at, [at[0] - origin[0], at[1] - origin[1]]]
                })
                .collect();
            let same = |(i, [at, offset]): (usize, &[[f64; 2]; 2])| {
                let others = offsets.iter().enumerate().filter(|(j, _)| *j != i);
                let distance = |o: &[[f64; 2]; 2]| libm::hypot(o[0][0] - at[0], o[0][1] - at[1]);
                let nearest = others.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).unwrap();
                nearest.1[1] == *offset
            };
            offsets.iter().enumerate().filter(|o| same(*o)).count() as f64 / offsets.len() as f64
        };
        let (carried, drawn) = (kept(Method::Correspondence), kept(Method::Descriptor));
        assert!(carried > 0.12 && carried > 5.0 * drawn, "{carried} {drawn}");
    }

    /// Bricks of 24 x 14 px in courses, every second one shifted by half a brick.
    fn bricks() -> Library {
        let mut map = LabelMap::filled(240, 200, 0);
        let mut label = 0;
        for row in 0..10u32 {
            for column in 0..9u32 {
                let shift = 15 * (row % 2);
                let columns = (30 * column + 3).saturating_sub(shift)..(30 * column + 27 - shift).min(240);
                if columns.is_empty() {
                    continue;
                }
                label += 1;
                for y in 20 * row + 3..20 * row + 17 {
                    columns.clone().for_each(|x| map.set(x, y, label));
                }
            }
        }
        let mut library = guided(&map);
        library.lattice = Some(vtex_scene::library::Lattice::new(&[[30.0, 0.0], [15.0, 20.0]]).unwrap());
        library
    }

    /// Share of the whole elements of a scene whose offset from their place in the exemplar is a vector of
    /// the lattice of bricks.
    fn in_bond(library: &Library, scene: &Scene) -> f64 {
        let whole = || scene.primary().iter().filter(|i| !scene.element(i).fused);
        let kept = |i: &&Instance| {
            let origin =
                library.primaries()[scene.element(i).source.unwrap().index()].centroid.map(libm::round);
            let [dx, dy] = [i.transform[4] - origin[0], i.transform[5] - origin[1]];
            let course = libm::round(dy / 20.0);
            let off = (dx - 15.0 * course) / 30.0;
            (dy - 20.0 * course).abs() <= 1.0 && 30.0 * (off - libm::round(off)).abs() <= 1.0
        };
        whole().filter(kept).count() as f64 / whole().count().max(1) as f64
    }

    #[test]
    fn bricks_keep_their_bond() {
        let library = bricks();
        let of = |p: SynthParams| run(&library, &p).0;
        for seed in 1..4 {
            let scene = of(params(420, 330, seed));
            assert!(in_bond(&library, &scene) > 0.97, "{}", in_bond(&library, &scene));
        }
        let free = of(SynthParams { lattice: LatticeChoice::Off, ..params(420, 330, 1) });
        let kept = of(SynthParams { lattice: "30,0,15,20".parse().unwrap(), ..params(420, 330, 1) });
        assert!(in_bond(&library, &free) < 0.9 && in_bond(&library, &kept) > 0.97);
        // A tile holds whole periods: 14 bricks and 16 courses, each a little stretched.
        let tile = Tile { x: true, y: true };
        let scene = of(SynthParams { tile, ..params(424, 322, 2) });
        assert_eq!(scene.validate(), Ok(()));
        let refused = synthesize(&library, &SynthParams { tile, ..params(100, 90, 2) }, &());
        assert!(matches!(refused, Err(Error::Periods { nearest: Some(_), .. })), "{refused:?}");
        // Turned elements stay where they are.
        let turned = of(SynthParams { mirror: true, ..params(420, 330, 3) });
        assert!(in_bond(&library, &turned) > 0.97);
        assert!(turned.primary().iter().any(|i| i.transform[0] < 0.0));
    }

    #[test]
    fn a_tile_has_no_seam_and_a_domain_is_kept_to() {
        let library = guided(&mosaic(200, 15.0, 0.8, 6));
        let tile = Tile { x: true, y: true };
        let (scene, report) = run(&library, &SynthParams { tile, ..params(151, 133, 2) });
        assert_eq!(scene.validate(), Ok(()));
        assert!((report.coverage - library.coverage).abs() < 0.08, "{}", report.coverage);
        let outline = Outline::new(&parse_path("M40 30H200V170H40Z").unwrap()).unwrap();
        for edge in [Edge::Clip, Edge::Keep, Edge::Avoid] {
            let controls = Controls { domain: Some(outline.clone()), ..Controls::default() };
            let p = SynthParams { edge, ..params(240, 200, 3) };
            let (scene, _) = synthesize_with(std::slice::from_ref(&library), &p, &controls, &()).unwrap();
            assert!(scene.primary().len() > 20);
            for i in scene.primary() {
                let b = scene.element(i).outline().bounds_after(i.affine());
                let inside = b.x0 > 38.5 && b.y0 > 28.5 && b.x1 < 201.5 && b.y1 < 171.5;
                assert!(edge != Edge::Avoid || inside, "{b:?}");
                let apart = b.x1 < 40.0 || b.y1 < 30.0 || b.x0 > 200.0 || b.y0 > 170.0;
                assert!(!apart, "{b:?}");
            }
        }
    }

    #[test]
    fn densities_and_libraries_go_where_their_maps_say() {
        let [one, two] =
            [(14.0, 0.8, 1), (10.0, 0.6, 2)].map(|(s, f, seed)| guided(&mosaic(200, s, f, seed)));
        let map = |values: Vec<f32>| ControlMap::new(2, 1, values).unwrap();
        let shares = vec![map(vec![1.0, 0.0]), map(vec![0.0, 1.0])];
        let controls = Controls { shares, ..Controls::default() };
        let (scene, report) =
            synthesize_with(&[one.clone(), two], &params(400, 200, 1), &controls, &()).unwrap();
        assert_eq!(report.method, Method::Correspondence);
        // Maps are stretched smoothly: both occur between a quarter and three quarters.
        for i in scene.primary() {
            let library = scene.element(i).library;
            let x = i.transform[4];
            assert!((80.0..320.0).contains(&x) || library.0 == u32::from(x > 200.0), "{x} {library}");
        }
        let covered = |low: f32, high: f32| {
            let controls = Controls { density: Some(map(vec![low, high])), ..Controls::default() };
            let libraries = std::slice::from_ref(&one);
            let (scene, _) = synthesize_with(libraries, &params(400, 200, 1), &controls, &()).unwrap();
            let half = |x0: f64| {
                let inside = |i: &&vtex_scene::scene::Instance| (x0..x0 + 100.0).contains(&i.transform[4]);
                scene.primary().iter().filter(inside).count()
            };
            [half(0.0), half(300.0)]
        };
        let [sparse, dense] = covered(0.2, 1.0);
        assert!(3 * sparse < dense && sparse > 0, "{sparse} {dense}");
    }

    #[test]
    fn islands_turn_and_wrap_with_their_exemplar() {
        let mut library = guided(&mosaic(200, 15.0, 0.6, 8));
        let turned = SynthParams { rotate: Some(180.0), mirror: true, ..params(260, 240, 1) };
        let (scene, report) = run(&library, &turned);
        assert_eq!(scene.validate(), Ok(()));
        assert!((report.coverage - library.coverage).abs() < 0.05, "{}", report.coverage);
        let mirrored = scene.primary().iter().filter(|i| i.affine().determinant() < 0.0).count();
        assert!(mirrored > scene.primary().len() / 10, "{mirrored} of {}", scene.primary().len());
        library.arrangement.periodic = true;
        library.elements.iter_mut().for_each(|p| p.clipped = false);
        let (scene, report) = run(&library, &params(300, 300, 1));
        assert_eq!((scene.validate(), report.method), (Ok(()), Method::Correspondence));
    }

    #[test]
    fn the_method_is_as_asked_for_or_as_the_library_allows() {
        let (with, without) = (guided(&mosaic(90, 12.0, 0.8, 1)), library(&mosaic(90, 12.0, 0.8, 1)));
        let method = |library: &Library, p: &SynthParams| run(library, p).1.method;
        let asked = |method| SynthParams { method, ..params(80, 80, 1) };
        assert_eq!(method(&with, &asked(Method::Auto)), Method::Correspondence);
        assert_eq!(method(&without, &asked(Method::Auto)), Method::Descriptor);
        assert_eq!(method(&with, &asked(Method::Descriptor)), Method::Descriptor);
        let tuned = vtex_scene::scene::Weights { empty: -0.4, ..Default::default() };
        assert_eq!(method(&with, &SynthParams { weights: tuned, ..asked(Method::Auto) }), Method::Descriptor);
        let refused = synthesize(&without, &asked(Method::Correspondence), &());
        assert!(matches!(refused, Err(Error::Parameter { name: "method", .. })), "{refused:?}");
        // A scene's own parameters reproduce it.
        let (scene, _) = run(&with, &asked(Method::Auto));
        assert_eq!(run(&with, &scene.parameters.clone().unwrap()).0, scene);
    }
}
