//! Motifs stay together in textures of all methods.

use super::synthesize;
use super::testing::fill;
use std::collections::BTreeSet;
use vtex_base::geometry::{Point, Vec2, shortest_offset};
use vtex_base::raster::LabelMap;
use vtex_scene::library::testing::library;
use vtex_scene::library::{ElementId, Library, Motif, MotifPart, SourceKind};
use vtex_scene::scene::{Instance, Method, Scene, SynthParams, Tile};

const SIDE: u32 = 240;
const PAIRS: usize = 8;

/// Top left corners of the pairs: one crosses the right border. Their bars lie 9, 10 or 11 px apart.
const PLACES: [[u32; 2]; PAIRS] =
    [[12, 14], [92, 22], [171, 9], [226, 88], [31, 92], [110, 105], [64, 177], [150, 190]];

fn apart(k: usize) -> u32 {
    9 + k as u32 % 3
}

/// A drawing of pairs of bars, with squares between them.
fn pairs() -> Library {
    let mut map = LabelMap::filled(SIDE, SIDE, 0);
    let mut label = 0;
    let mut fill = |x: u32, y: u32, w: u32, h: u32| {
        label += 1;
        fill(&mut map, label, [x, y, w, h]);
    };
    for (k, [x, y]) in PLACES.into_iter().enumerate() {
        let columns = if k == 3 { 10 } else { 24 };
        fill(x, y, columns, 4);
        fill(x, y + apart(k), columns, 4);
    }
    for [x, y] in [[60, 60], [140, 60], [200, 60], [20, 140], [160, 150], [210, 160], [20, 210], [110, 215]] {
        fill(x, y, 9, 9);
    }
    let mut own = library(&map).without_secondaries();
    own.source.kind = SourceKind::Drawing;
    own.arrangement.periodic = true;
    own.elements.iter_mut().for_each(|e| e.clipped = false);
    let part = |k: usize| MotifPart { element: ElementId::after(k), periods: [0; 2] };
    let pair = |k: usize| Motif { kind: 0, parts: vec![part(2 * k), part(2 * k + 1)] };
    own.motifs = (0..PAIRS).map(pair).collect();
    own
}

/// For each first bar of a pair, the vector to the nearest second bar of its pair; `None` where there is none.
fn vectors(scene: &Scene) -> Vec<Option<Vec2>> {
    let size = [scene.width, scene.height].map(f64::from);
    let periods = [scene.tile.x.then_some(size[0]), scene.tile.y.then_some(size[1])];
    let all: Vec<(usize, Point)> = scene
        .individuals()
        .map(|i| {
            let element = scene.element(i);
            (element.source.unwrap().index(), i.affine() * element.bounds().center())
        })
        .collect();
    let firsts = all.iter().filter(|(k, _)| *k < 2 * PAIRS && k % 2 == 0);
    firsts
        .map(|&(k, at)| {
            let others = all.iter().filter(|other| other.0 == k + 1);
            let vectors = others.map(|other| shortest_offset(at, other.1, periods));
            vectors.min_by(|v, w| v.hypot().total_cmp(&w.hypot()))
        })
        .collect()
}

fn made(library: &Library, method: Method, variation: f64) -> Scene {
    let side = 2 * SIDE;
    let params = SynthParams {
        width: side,
        height: side,
        tile: Tile { x: true, y: true },
        seed: 3,
        method,
        variation: Some(variation),
        ..SynthParams::default()
    };
    synthesize(library, &params, &()).unwrap()
}

/// Whether a vector is one between the bars of a pair of the drawing, to a pixel.
fn is_of_pair(vector: &Option<Vec2>) -> bool {
    let length = vector.map_or(f64::INFINITY, |v| v.hypot());
    (f64::from(apart(0)) - 1.0..=f64::from(apart(2)) + 1.0).contains(&length)
}

#[test]
fn pairs_stay_together_whatever_the_method() {
    let library = pairs();
    let clustered = cfg!(feature = "clustered").then_some(Method::Clustered);
    for method in [Method::Period, Method::Descriptor].into_iter().chain(clustered) {
        let found = vectors(&made(&library, method, 1.0));
        assert!(found.len() >= 2 * PAIRS, "{method:?}: {}", found.len());
        assert!(found.iter().all(is_of_pair), "{method:?}: {found:?}");
    }
    // Without motifs they are torn apart.
    let alone = Library { motifs: Vec::new(), ..library };
    let found = vectors(&made(&alone, Method::Period, 1.0));
    let torn = found.iter().filter(|v| !is_of_pair(v)).count();
    assert!(2 * torn > found.len(), "{torn} of {}", found.len());
}

#[test]
fn nothing_is_placed_between_the_parts_of_a_motif() {
    let library = pairs();
    let scene = made(&library, Method::Descriptor, 1.0);
    let size = [scene.width, scene.height].map(f64::from);
    let periods = size.map(Some);
    let boxes: Vec<_> = scene
        .individuals()
        .map(|i| {
            (
                scene.element(i).source.unwrap().index(),
                i.affine().transform_rect_bbox(scene.element(i).bounds()),
            )
        })
        .collect();
    let squares = boxes.iter().filter(|(k, _)| *k >= 2 * PAIRS);
    for (_, square) in squares {
        for (k, bar) in boxes.iter().filter(|(k, _)| *k < 2 * PAIRS && k % 2 == 0) {
            // The hull of the pair reaches from the first bar over the gap to the second.
            let between =
                vtex_base::geometry::Rect::new(0.0, bar.height(), bar.width(), f64::from(apart(k / 2)));
            let by = shortest_offset(bar.origin(), square.origin(), periods);
            let own = square.size().to_rect() + by;
            assert!(own.intersect(between).area() < 1.0, "{square:?} {bar:?}");
        }
    }
}

#[test]
fn parts_move_only_where_the_copies_of_the_drawing_differ() {
    let library = pairs();
    let lengths =
        |scene: &Scene| -> Vec<f64> { vectors(scene).iter().flatten().map(|v| v.hypot()).collect() };
    let whole = |v: &f64| (v - libm::round(*v)).abs() < 0.02;
    assert!(lengths(&made(&library, Method::Period, 0.0)).iter().all(whole));
    let varied = lengths(&made(&library, Method::Period, 1.0));
    assert!(varied.iter().any(|v| !whole(v)), "{varied:?}");
    // Kinds of one copy each: nothing to vary by.
    let mut kinds = library;
    kinds.motifs.iter_mut().enumerate().for_each(|(k, motif)| motif.kind = k as u32);
    assert!(lengths(&made(&kinds, Method::Period, 1.0)).iter().all(whole));
}

#[test]
fn a_variation_of_nothing_is_the_drawing_with_motifs_and_without() {
    let library = pairs();
    let alone = Library { motifs: Vec::new(), ..library.clone() };
    let places = |library: &Library| {
        let scene = made(library, Method::Period, 0.0);
        let mut places: Vec<_> = scene
            .individuals()
            .map(|i| (scene.element(i).source, i.transform.map(|v| libm::round(v * 100.0) as i64)))
            .collect();
        places.sort();
        places
    };
    assert_eq!(places(&library), places(&alone));
}

#[test]
fn the_parts_of_a_motif_have_its_number_and_are_painted_one_after_another() {
    let library = pairs();
    let clustered = cfg!(feature = "clustered").then_some(Method::Clustered);
    for method in [Method::Period, Method::Descriptor].into_iter().chain(clustered) {
        let scene = made(&library, method, 1.0);
        let is_part = |i: &Instance| scene.element(i).source.is_some_and(|s| s.index() < 2 * PAIRS);
        assert!(scene.individuals().all(|i| i.motif.is_some() == is_part(i)), "{method:?}");
        let instances: Vec<&Instance> = scene.individuals().filter(|i| is_part(i)).collect();
        let runs: Vec<&[&Instance]> = instances.chunk_by(|a, b| a.motif == b.motif).collect();
        assert!(runs.iter().all(|run| run.len() == 2), "{method:?}");
        let numbers: BTreeSet<Option<u32>> = runs.iter().map(|run| run[0].motif).collect();
        assert_eq!(numbers.len(), runs.len(), "{method:?}");
    }
}
