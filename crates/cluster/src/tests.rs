//! The optimisation on small exemplars made here.

use crate::board::{Board, BoardElement};
use crate::clustering::{ClusteringParts, MOST_STEPS, improve_clusters};
use crate::figures::{ClusterExemplar, Figure, FigurePlace};
use crate::holes::leaves_hole;
use crate::input::{InputSamples, LevelScale};
use crate::optimise::{ClusterParams, ClusterResult, ClusteredElement, cluster, cluster_beside, level_of};
use crate::output::{ContextCosts, OutputSamples};
use crate::raster::pixels;
use crate::rebuild::{rebuilt, sampled};
use crate::relations::PlaceRelations;
use crate::search::search;
use crate::shape_energy::{ClusterWork, shape_match, shape_match_below};
use crate::standing::ClusterContext;
use crate::votes::PairVotes;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::coherence::NeighbourhoodMatches;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, Vicinity, length};
use vtex_base::geometry::{Affine, Interior, Outline, Point, parse_path};
use vtex_base::sampling::stream;

const SCALE: LevelScale = LevelScale { distance: 13.3, radius: 50.0 };

fn figure(text: &str, category: u32) -> Figure {
    let outlines = vec![Outline::new(&parse_path(text).unwrap()).unwrap()];
    Figure { outlines, category, colour: [0.3 + 0.2 * f64::from(category), 0.0, 0.0] }
}

/// Discs, bars and triangles on a page that repeats, at places that no two of are equal, none touching.
fn loose() -> ClusterExemplar {
    let figures = vec![
        figure("M-22 0C-22 29 22 29 22 0C22 -29 -22 -29 -22 0Z", 0),
        figure("M-10 -34H10V34H-10Z", 1),
        figure("M-26 22L0 -26L26 22Z", 2),
    ];
    let mut random = stream(5, "cluster/test page", 0);
    let places = (0..16).map(|k| {
        let at = [f64::from(k % 4), f64::from(k / 4)].map(|v| 50.0 + 100.0 * v + random.range(-14.0, 14.0));
        FigurePlace { figure: random.below(3) as u32, at, placeable: true }
    });
    ClusterExemplar {
        page: PeriodicPlane { size: [400.0; 2], wraps: [true; 2] },
        places: places.collect(),
        figures,
    }
}

/// Bars beneath discs that cover their upper ends.
fn stems() -> ClusterExemplar {
    let mut exemplar = loose();
    exemplar.figures =
        vec![figure("M-5 0H5V60H-5Z", 0), figure("M-20 0C-20 27 20 27 20 0C20 -27 -20 -27 -20 0Z", 1)];
    let at: Vec<[f64; 2]> = exemplar.places.iter().map(|p| p.at).collect();
    let of = |figure: u32| at.iter().map(move |at| FigurePlace { figure, at: *at, placeable: true });
    exemplar.places = of(0).chain(of(1)).collect();
    exemplar
}

fn params(size: f64, tile: bool) -> ClusterParams {
    ClusterParams {
        size: [size; 2],
        tile: [tile; 2],
        seed: 3,
        variation: 1.0,
        without: ClusteringParts::default(),
        without_context: false,
        without_depth: false,
    }
}

fn run(exemplar: &ClusterExemplar, params: &ClusterParams) -> ClusterResult {
    cluster(exemplar, params, &|| Ok(())).unwrap()
}

/// The exemplar itself as a result.
fn copied<'a>(exemplar: &ClusterExemplar, relations: &'a PlaceRelations<'a>) -> Board<'a> {
    let mut board = Board::new(exemplar.page, relations);
    for (k, place) in exemplar.places.iter().enumerate() {
        board.add(BoardElement { place: k as u32, at: place.at });
    }
    board
}

/// A result of four samples that hold each other, matched by hand: a and b share a cluster in one of four
/// neighbourhoods, b and d in all, a and c in none; a is beneath b in three.
#[test]
fn votes_count_matches_that_share_a_cluster_and_their_order() {
    let exemplar = loose();
    let input = InputSamples::new(&exemplar, SCALE, 1, &|| Ok(())).unwrap();
    let (low, high) = (input.first[2], input.first[7]);
    let plane = PeriodicPlane { size: [400.0; 2], wraps: [false; 2] };
    let mut output = OutputSamples::new(plane);
    output.points = vec![[100.0, 100.0], [105.0, 100.0], [100.0, 106.0], [106.0, 107.0]];
    output.cluster = vec![0, 0, 1, 1];
    output.clusters = 2;
    let index = PointIndex::new(plane, 50.0, &output.points);
    let near = Vicinity::new(&index, &output.points, 50.0, (36, true));
    // What each neighbourhood says of a, b, c and d.
    let said =
        [[high, high, low, high], [low, high, high, high], [low, high, high, high], [low, high, high, high]];
    output.source = (0..4).map(|s| said[s][s]).collect();
    output.copied = output.source.clone();
    let matched = (0..4).flat_map(|s| near.range(s).map(move |k| (s, k)));
    let matched = matched.map(|(s, k)| said[s][near.ids[k] as usize]).collect();
    let matches = NeighbourhoodMatches { near, matched, cost: vec![0.0; 4] };
    let votes = PairVotes::new(&output, &input, &matches, 40.0);
    let pair = |a: usize, b: u32| votes.near.range(a).find(|k| votes.near.ids[*k] == b).unwrap();
    assert_eq!(votes.link(pair(0, 1)), Some(0.25));
    assert_eq!(votes.link(pair(1, 3)), Some(1.0));
    assert_eq!(votes.link(pair(0, 2)), Some(0.0));
    assert_eq!(votes.counts[pair(0, 1)], [4, 1, 3]);
    assert_eq!(votes.counts[pair(1, 0)], [4, 1, 0]);
}

#[test]
fn shape_energy_is_zero_for_a_copy_and_one_for_a_missing_sample() {
    let exemplar = loose();
    let input = InputSamples::new(&exemplar, SCALE, 1, &|| Ok(())).unwrap();
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let mut board = Board::new(exemplar.page, &relations);
    board.add(BoardElement { place: 3, at: [377.0, 391.0] });
    let output = sampled(&board, &input);
    let work = &mut ClusterWork::default();
    let all = output.members();
    let whole = shape_match(&output, &input, &all[0], |_| true, work).unwrap();
    assert!(whole.energy < 1e-6, "{whole:?}");
    let at = output.plane.between(whole.by, [377.0, 391.0]);
    assert!(length(at) < 1e-6, "{whole:?}");
    let part = shape_match(&output, &input, &all[0][1..], |_| true, work).unwrap();
    assert!((part.energy - 1.0).abs() < 1e-6, "{part:?}");
    assert_eq!(shape_match(&output, &input, &all[0], |_| false, work), None);
}

#[test]
fn an_energy_is_found_if_it_is_below_the_bound() {
    let exemplar = loose();
    let input = InputSamples::new(&exemplar, SCALE, 1, &|| Ok(())).unwrap();
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let output = sampled(&copied(&exemplar, &relations), &input);
    let work = &mut ClusterWork::default();
    for pair in output.members().chunks(2) {
        for members in [pair[0][1..].to_vec(), pair.concat()] {
            let whole = shape_match(&output, &input, &members, |_| true, work).unwrap();
            let mut below = |by: f64| {
                shape_match_below(&output, &input, &members, (|_| true, whole.energy + by), work)
                    .filter(|m| m.energy < whole.energy + by)
            };
            assert_eq!(below(1e-6), Some(whole));
            assert_eq!(below(-1e-6), None);
        }
    }
}

#[test]
fn the_work_on_large_shapes_over_one_another_is_bounded() {
    // Zigzags across the page, cut by its border, and small triangles.
    let mut random = stream(9, "cluster/test page", 1);
    let mut zigzag = |category: u32| {
        let points = (0..40).map(|_| {
            let at: [f64; 2] = std::array::from_fn(|_| random.range(-240.0, 240.0));
            format!("L{:.1} {:.1}", at[0], at[1])
        });
        figure(&format!("M0 0{}Z", points.collect::<String>()), category)
    };
    let mut figures: Vec<Figure> = (0..30).map(&mut zigzag).collect();
    figures.push(figure("M-9 -9H9L0 9Z", 30));
    let middle = |figure: u32| FigurePlace { figure, at: [200.0; 2], placeable: false };
    let small = |k: u32| {
        let at = [f64::from(k % 7), f64::from(k / 7)].map(|v| 30.0 + 55.0 * v);
        FigurePlace { figure: 30, at, placeable: true }
    };
    let page = PeriodicPlane { size: [400.0; 2], wraps: [false; 2] };
    let exemplar =
        ClusterExemplar { page, figures, places: (0..30).map(middle).chain((0..49).map(small)).collect() };
    let found = run(&exemplar, &params(600.0, false));
    assert!(!found.elements.is_empty());
    let steps: u64 = found.levels.iter().map(|level| level.steps).sum();
    assert!((MOST_STEPS..MOST_STEPS + MOST_STEPS / 4).contains(&steps), "{steps}");
}

#[test]
fn costs_of_contexts_are_the_same_stored_or_computed() {
    let exemplar = loose();
    let go_on = || Ok(());
    let input = InputSamples::new(&exemplar, SCALE, 1, &go_on).unwrap();
    let relations = PlaceRelations::new(&exemplar, &go_on).unwrap();
    let mut output = sampled(&copied(&exemplar, &relations), &input);
    // Cut clusters have contexts of their own.
    (0..output.len()).filter(|s| s % 5 == 0).for_each(|s| output.cluster[s] = output.clusters);
    output.clusters += 1;
    let width = input.contexts.len();
    let of = |most: usize| -> Vec<f64> {
        let costs = ContextCosts::within(&output, &input, most, &go_on).unwrap();
        (0..output.len())
            .flat_map(|s| (0..width).map(move |c| (s, c)))
            .map(|(s, c)| costs.of(s).cost(c as u32))
            .collect()
    };
    let all = of(usize::MAX);
    assert!(all.iter().any(|c| *c > 0.0));
    assert_eq!(all, of(0));
    assert_eq!(all, of(7 * width));
}

/// Adjusted Rand index of two groupings.
fn rand_index(a: &[u32], b: &[u32]) -> f64 {
    let pairs = |n: f64| n * (n - 1.0) / 2.0;
    let count = |of: &dyn Fn(usize) -> (u32, u32)| -> f64 {
        let mut keys: Vec<(u32, u32)> = (0..a.len()).map(of).collect();
        keys.sort_unstable();
        keys.chunk_by(|x, y| x == y).map(|run| pairs(run.len() as f64)).sum()
    };
    let (both, of_a, of_b) = (count(&|i| (a[i], b[i])), count(&|i| (a[i], 0)), count(&|i| (0, b[i])));
    let expected = of_a * of_b / pairs(a.len() as f64);
    (both - expected) / (0.5 * (of_a + of_b) - expected)
}

#[test]
fn clusters_are_recovered_from_shuffled_ids_and_energy_never_rises() {
    let exemplar = loose();
    let input = InputSamples::new(&exemplar, SCALE, 1, &|| Ok(())).unwrap();
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let mut output = sampled(&copied(&exemplar, &relations), &input);
    let truth = output.cluster.clone();
    let matches = search(&mut output, &input, &|| Ok(())).unwrap();
    assert!(matches.energy() < 0.1, "a copy has hardly any energy: {}", matches.energy());
    let votes = PairVotes::new(&output, &input, &matches, 4.0 * SCALE.distance);
    let mut random = stream(1, "cluster/test ids", 0);
    for id in &mut output.cluster {
        *id = random.below(u64::from(output.clusters)) as u32;
    }
    assert!(rand_index(&output.cluster, &truth) < 0.1);
    for round in 0..4 {
        let parts = ClusteringParts::default();
        let (done, [before, after]) =
            improve_clusters(&mut output, &input, &votes, (parts, &mut ClusterWork::default()), &|| Ok(()))
                .unwrap();
        assert!(after <= before + 1e-6, "round {round}: {before} {after}");
        assert!(round > 0 || done.switched > 0);
    }
    let found = rand_index(&output.cluster, &truth);
    assert!(found >= 0.9, "{found}");
    let none =
        ClusteringParts { no_switch: true, no_merge: true, no_split: true, ..ClusteringParts::default() };
    let kept = output.cluster.clone();
    improve_clusters(&mut output, &input, &votes, (none, &mut ClusterWork::default()), &|| Ok(())).unwrap();
    assert_eq!(rand_index(&output.cluster, &kept), 1.0);
}

#[test]
fn energy_falls_and_samples_return_to_their_places() {
    let exemplar = loose();
    let input = InputSamples::new(&exemplar, SCALE, 1, &|| Ok(())).unwrap();
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let mut output = sampled(&copied(&exemplar, &relations), &input);
    let mut random = stream(2, "cluster/test noise", 0);
    for p in &mut output.points {
        *p = p.map(|v| v + random.range(-0.4, 0.4) * SCALE.distance);
    }
    let (output, _, report) =
        level_of(output, &input, (&params(400.0, true), None), &mut ClusterWork::default(), &|| Ok(()))
            .unwrap();
    let (first, last) = (report.energies[0], report.energies[report.energies.len() - 1]);
    assert!(last < 0.7 * first, "{:?}", report.energies);
    let (board, of_cluster) = rebuilt(&output, &input, &relations, exemplar.page, &|| Ok(())).unwrap();
    assert_eq!(of_cluster.len(), exemplar.places.len());
    assert_eq!(board.standing().len(), exemplar.places.len());
}

/// Number of elements on each pixel of a canvas of a side of `size`, whose edges may join.
fn covered(exemplar: &ClusterExemplar, result: &ClusterResult, size: f64, tile: bool) -> Vec<u8> {
    let relations = PlaceRelations::new(exemplar, &|| Ok(())).unwrap();
    let side = size as i32;
    let mut cells = vec![0u8; (side * side) as usize];
    for element in &result.elements {
        let own = relations.pixels_of(exemplar.places[element.place].figure);
        let by = element.at.map(|v| libm::round(v) as i32);
        for y in own.rows[0]..own.rows[1] {
            for run in own.runs_of(y) {
                for x in run[0]..run[1] {
                    let (mut x, mut y) = (x + by[0], y + by[1]);
                    if tile {
                        (x, y) = (x.rem_euclid(side), y.rem_euclid(side));
                    }
                    if (0..side).contains(&x) && (0..side).contains(&y) {
                        cells[(y * side + x) as usize] += 1;
                    }
                }
            }
        }
    }
    cells
}

#[test]
fn density_mix_and_distances_are_those_of_the_exemplar() {
    let exemplar = loose();
    let nearest = |at: &[[f64; 2]], plane: PeriodicPlane| -> Vec<f64> {
        let of = |i: usize| {
            let others = (0..at.len()).filter(|j| *j != i);
            others.map(|j| length(plane.between(at[i], at[j]))).fold(f64::INFINITY, f64::min)
        };
        let mut all: Vec<f64> = (0..at.len()).map(of).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let at: Vec<[f64; 2]> = exemplar.places.iter().map(|p| p.at).collect();
    let wanted = nearest(&at, exemplar.page);
    for tile in [true, false] {
        let result = run(&exemplar, &params(800.0, tile));
        let cells = covered(&exemplar, &result, 800.0, tile);
        let share = |cells: &[u8]| cells.iter().filter(|c| **c > 0).count() as f64 / cells.len() as f64;
        let own = ClusterResult {
            elements: (0..16)
                .map(|place| crate::ClusteredElement { place, at: exemplar.places[place].at })
                .collect(),
            levels: Vec::new(),
        };
        let (got, asked) = (share(&cells), share(&covered(&exemplar, &own, 400.0, true)));
        assert!((got / asked - 1.0).abs() < 0.1, "{got} {asked}");
        // None overlaps another, not even across a seam.
        assert!(cells.iter().filter(|c| **c > 1).count() < 20);
        let inside = |e: &&crate::ClusteredElement| tile || e.at.iter().all(|v| (0.0..800.0).contains(v));
        let on: Vec<_> = result.elements.iter().filter(inside).collect();
        let mut chi = 0.0;
        for f in 0..3u32 {
            let of = |place: usize| exemplar.places[place].figure == f;
            let expected = (0..16).filter(|k| of(*k)).count() as f64 / 16.0 * on.len() as f64;
            let found = on.iter().filter(|e| of(e.place)).count() as f64;
            chi += (found - expected) * (found - expected) / expected;
        }
        // The 95 % quantile of χ² with two degrees of freedom.
        assert!(chi < 5.99, "{chi}");
        let plane = PeriodicPlane { size: [800.0; 2], wraps: [tile; 2] };
        let found = nearest(&on.iter().map(|e| e.at).collect::<Vec<_>>(), plane);
        let quantile = |of: &[f64], q: usize| of[q * (of.len() - 1) / 50];
        let apart: f64 =
            (0..=50).map(|q| (quantile(&found, q) - quantile(&wanted, q)).abs()).sum::<f64>() / 51.0;
        let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
        assert!(apart < 0.2 * mean, "{apart} of {mean}");
    }
}

#[test]
fn what_lies_above_stays_above() {
    let exemplar = stems();
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let right = |without_depth: bool| {
        let result = run(&exemplar, &ClusterParams { without_depth, ..params(800.0, true) });
        let plane = PeriodicPlane { size: [800.0; 2], wraps: [true; 2] };
        let figure = |e: &crate::ClusteredElement| exemplar.places[e.place].figure;
        let (mut right, mut all) = (0u32, 0u32);
        for (i, a) in result.elements.iter().enumerate() {
            for b in &result.elements[i + 1..] {
                let way = plane.between(a.at, b.at);
                if figure(a) != figure(b) && relations.overlap(figure(a), figure(b), way) > 0 {
                    all += 1;
                    right += u32::from(figure(a) == 0);
                }
            }
        }
        assert!(all > 30, "{all}");
        f64::from(right) / f64::from(all)
    };
    assert!(right(false) >= 0.95);
    assert!(right(true) < 0.95);
}

#[test]
fn threads_do_not_matter_and_seeds_do() {
    let exemplar = loose();
    let asked = params(600.0, true);
    let on = |threads: usize, asked: &ClusterParams| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&exemplar, asked))
    };
    let one = on(1, &asked);
    assert_eq!(one, on(2, &asked));
    assert_ne!(one.elements, on(2, &ClusterParams { seed: 4, ..asked }).elements);
    let parts = ClusteringParts { no_link: true, ..ClusteringParts::default() };
    assert_ne!(one.levels, on(2, &ClusterParams { without: parts, ..asked }).levels);
    for level in &one.levels {
        assert_eq!(level.output.len(), level.samples[1]);
        assert!(
            level
                .output
                .iter()
                .all(|s| (-1.0..=601.0).contains(&s.at[0]) && s.cluster < level.clusters[0] as u32)
        );
    }
    assert_ne!(one.levels, on(2, &ClusterParams { without_context: true, ..asked }).levels);
}

#[test]
fn without_variation_the_exemplar_goes_on() {
    let exemplar = loose();
    let result = run(&exemplar, &ClusterParams { variation: 0.0, ..params(800.0, true) });
    assert_eq!(result.elements.len(), 64);
    for element in &result.elements {
        let off = exemplar.page.between(exemplar.page.wrapped(element.at), exemplar.places[element.place].at);
        assert!(length(off) < 1.0, "{element:?}");
    }
}

#[test]
fn poor_exemplars_give_a_result_or_a_clear_error() {
    let page = PeriodicPlane { size: [400.0; 2], wraps: [true; 2] };
    let square = figure("M-20 -20H20V20H-20Z", 0);
    let huge = figure("M-130 -130H130V130H-130Z", 1);
    let place = |figure, x, y| FigurePlace { figure, at: [x, y], placeable: true };
    let of = |figures: &[&Figure], places: Vec<FigurePlace>| ClusterExemplar {
        page,
        figures: figures.iter().map(|f| (*f).clone()).collect(),
        places,
    };
    let one = of(&[&square], vec![place(0, 100.0, 100.0)]);
    let two = of(&[&square], vec![place(0, 100.0, 100.0), place(0, 300.0, 250.0)]);
    let large = of(&[&square, &huge], vec![place(1, 150.0, 150.0), place(0, 340.0, 340.0)]);
    for exemplar in [&one, &two, &large] {
        let result = run(exemplar, &params(900.0, false));
        assert!(result.elements.len() >= 4, "{}", result.elements.len());
        let open = ClusterExemplar { page: PeriodicPlane { wraps: [false; 2], ..page }, ..exemplar.clone() };
        assert!(!run(&open, &params(900.0, false)).elements.is_empty());
    }
    let nothing = of(&[&square], vec![FigurePlace { placeable: false, ..place(0, 100.0, 100.0) }]);
    assert_eq!(run(&nothing, &params(500.0, false)), ClusterResult::default());
    let refused = cluster(&large, &params(120.0, true), &|| Ok(()));
    assert!(matches!(refused, Err(Error::Parameter { name: "canvas", .. })), "{refused:?}");
    let refused = cluster(&one, &params(4e6, false), &|| Ok(()));
    assert!(matches!(refused, Err(Error::TooLarge { .. })), "{refused:?}");
}

#[test]
fn ten_thousand_elements_stop_when_asked_to() {
    let dot = figure("M-1 -1H1V1H-1Z", 0);
    let places = (0..10_000u32).map(|k| {
        let at = [f64::from(k % 100), f64::from(k / 100)].map(|v| 2.0 + 4.0 * v);
        FigurePlace { figure: 0, at, placeable: true }
    });
    let exemplar = ClusterExemplar {
        page: PeriodicPlane { size: [400.0; 2], wraps: [true; 2] },
        figures: vec![dot],
        places: places.collect(),
    };
    let stopped_at = |most: u32| {
        let asked = std::cell::Cell::new(0);
        let go_on = || -> Result<()> {
            asked.set(asked.get() + 1);
            if asked.get() > most { Err(Error::Interrupted) } else { Ok(()) }
        };
        let result = cluster(&exemplar, &params(400.0, false), &go_on);
        assert!(matches!(result, Err(Error::Interrupted)));
        asked.get()
    };
    // Each stage asks: no question is missed once the answer is no.
    for most in [0, 4, 40, 80] {
        assert_eq!(stopped_at(most), most + 1);
    }
}

/// The exemplar repeated over a canvas of a side of 1000, without what lies in a disc, and what lies there.
fn with_hole(exemplar: &ClusterExemplar) -> (ClusterContext, Vec<FigurePlace>) {
    let disc = "M330 500C330 273 670 273 670 500C670 727 330 727 330 500Z";
    let region = Outline::new(&parse_path(disc).unwrap()).unwrap();
    let interior = Interior::new(&region);
    let copies = (0..9).flat_map(|k| exemplar.places.iter().map(move |p| (k, p)));
    let at =
        |k: i32, p: &FigurePlace| [p.at[0] + 400.0 * f64::from(k % 3), p.at[1] + 400.0 * f64::from(k / 3)];
    let all = copies.map(|(k, p)| FigurePlace { at: at(k, p), ..*p });
    let (inside, outside) = all.partition(|p| interior.contains(Point::new(p.at[0], p.at[1])));
    // Every second element has a figure of the context that looks like the exemplar's.
    let figures: Vec<Figure> = exemplar.figures.iter().map(|f| Figure { category: 7, ..f.clone() }).collect();
    let own =
        |(k, p): (usize, FigurePlace)| FigurePlace { figure: p.figure + (k % 2 * figures.len()) as u32, ..p };
    let outside: Vec<FigurePlace> = outside;
    let places = outside.into_iter().enumerate().map(own).collect();
    (ClusterContext { figures, places, region, source: None }, inside)
}

/// Share of some elements that a result has at the same places.
fn recovered(exemplar: &ClusterExemplar, result: &ClusterResult, wanted: &[FigurePlace]) -> f64 {
    let is_there = |w: &&FigurePlace| {
        result.elements.iter().any(|e| {
            let off = [e.at[0] - w.at[0], e.at[1] - w.at[1]];
            exemplar.places[e.place].figure == w.figure && length(off) < 8.0
        })
    };
    wanted.iter().filter(is_there).count() as f64 / wanted.len() as f64
}

#[test]
fn a_hole_is_filled_so_that_it_fits() {
    let exemplar = loose();
    let (context, wanted) = with_hole(&exemplar);
    let inside = Interior::new(&context.region);
    let beside = |context: &ClusterContext, variation: f64| {
        let asked = ClusterParams { variation, ..params(1000.0, false) };
        cluster_beside(&exemplar, context, &asked, &|| Ok(())).unwrap()
    };
    let relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let as_it_was = beside(&context, 0.0);
    let share = recovered(&exemplar, &as_it_was, &wanted);
    assert!(share >= 0.9, "{share} of {}", wanted.len());
    for variation in [0.0, 1.0] {
        let made = beside(&context, variation);
        let count = made.elements.len() as f64 / wanted.len() as f64;
        assert!((0.75..=1.25).contains(&count), "{count}");
        for e in &made.elements {
            assert!(inside.contains(Point::new(e.at[0], e.at[1])), "{e:?}");
            let figure = exemplar.places[e.place].figure;
            let hidden = |p: &FigurePlace| {
                let way = [p.at[0] - e.at[0], p.at[1] - e.at[1]];
                relations.overlap(figure, p.figure % exemplar.figures.len() as u32, way)
            };
            assert_eq!(context.places.iter().map(hidden).sum::<u32>(), 0, "{e:?}");
        }
    }
    // A part of the exemplar is laid there first, and fits.
    let source = context.region.moved(Affine::translate((-400.0, -400.0)));
    let cloned = beside(&ClusterContext { source: Some(source), ..context.clone() }, 1.0);
    let share = recovered(&exemplar, &cloned, &wanted);
    assert!(share >= 0.9, "{share} of {}", wanted.len());
}

#[test]
fn figures_that_the_exemplar_does_not_have_are_kept_clear() {
    let exemplar = loose();
    let (mut context, wanted) = with_hole(&exemplar);
    let star = Figure {
        colour: [0.9, 0.1, 0.1],
        ..figure("M0 -60L20 -20L60 0L20 20L0 60L-20 20L-60 0L-20 -20Z", 0)
    };
    context.figures.push(star.clone());
    let figure = (exemplar.figures.len() + context.figures.len()) as u32 - 1;
    let at = [500.0, 500.0];
    context.places.push(FigurePlace { figure, at, placeable: true });
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let asked = params(1000.0, false);
        pool.install(|| cluster_beside(&exemplar, &context, &asked, &|| Ok(())).unwrap())
    };
    let made = on(1);
    assert_eq!(made, on(2));
    assert!(made.elements.len() > 3 && made.elements.len() < wanted.len());
    let [all, _] = pixels(&star, 0.0);
    for e in &made.elements {
        let [own, _] = pixels(&exemplar.figures[exemplar.places[e.place].figure as usize], 0.0);
        let by = [0, 1].map(|k| libm::round(e.at[k] - at[k]) as i32);
        assert_eq!(all.overlap(&own, by), 0, "{e:?}");
    }
}

#[test]
fn of_what_reaches_far_beyond_the_window_only_the_part_there_counts() {
    let exemplar = loose();
    let (mut context, wanted) = with_hole(&exemplar);
    let own = exemplar.figures.len() + context.figures.len();
    // A bar across the region, two thousand times as long, whose reference point is far away; and one far beside it.
    context.figures.push(figure("M-1 -8H700000V8H-1Z", 0));
    let bar = FigurePlace { figure: own as u32, at: [-350_000.0, 500.0], placeable: true };
    context.places.extend([bar, FigurePlace { at: [-350_000.0, 90_000.0], ..bar }]);
    let made = cluster_beside(&exemplar, &context, &params(1000.0, false), &|| Ok(())).unwrap();
    assert!(made.elements.len() > 3 && made.elements.len() < wanted.len());
    for e in &made.elements {
        let bounds = exemplar.figures[exemplar.places[e.place].figure as usize].bounds();
        let [above, below] = [e.at[1] + bounds.y1, e.at[1] + bounds.y0];
        assert!(above < 493.0 || below > 507.0, "{e:?}");
    }
}

/// Discs and bars on a page that ends, most of the bars near its border, where blocks seldom come from.
fn uneven() -> ClusterExemplar {
    let mut exemplar = loose();
    exemplar.page.wraps = [false; 2];
    for place in &mut exemplar.places {
        let far = place.at.map(|v| (v - 200.0).abs());
        place.figure = u32::from(far[0].max(far[1]) > 100.0);
    }
    exemplar
}

#[test]
fn a_page_that_ends_keeps_its_shares_and_distances() {
    let exemplar = uneven();
    let nearest = |at: &[[f64; 2]], size: f64| -> Vec<f64> {
        let far = |p: &[f64; 2], q: &[f64; 2]| length([p[0] - q[0], p[1] - q[1]]);
        let of = |p: &[f64; 2]| at.iter().filter(|q| *q != p).map(|q| far(p, q)).fold(1e9, f64::min);
        // Of those whose nearest neighbour lies within for sure.
        let within = |p: &[f64; 2], d: f64| p.iter().all(|v| *v >= d && *v <= size - d);
        let mut all: Vec<f64> =
            at.iter().map(|p| (p, of(p))).filter(|(p, d)| within(p, *d)).map(|d| d.1).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let given: Vec<[f64; 2]> = exemplar.places.iter().map(|p| p.at).collect();
    let wanted = nearest(&given, 400.0);
    for seed in 0..3 {
        let asked = ClusterParams { seed, ..params(1200.0, false) };
        let made = cluster(&exemplar, &asked, &|| Ok(())).unwrap();
        let on_canvas = |e: &&ClusteredElement| e.at.iter().all(|v| (0.0..1200.0).contains(v));
        let elements: Vec<&ClusteredElement> = made.elements.iter().filter(on_canvas).collect();
        let bars = elements.iter().filter(|e| exemplar.places[e.place].figure == 1).count();
        let share = bars as f64 / elements.len() as f64;
        assert!((0.65..=0.85).contains(&share), "{bars} of {}", elements.len());
        let count = elements.len() as f64 / (9.0 * 16.0);
        assert!((0.9..=1.1).contains(&count), "{}", elements.len());
        let at: Vec<[f64; 2]> = elements.iter().map(|e| e.at).collect();
        let found = nearest(&at, 1200.0);
        let quantile = |of: &[f64], q: f64| of[(q * of.len() as f64) as usize];
        let off: f64 = (0..20)
            .map(|k| (f64::from(k) + 0.5) / 20.0)
            .map(|q| (quantile(&found, q) - quantile(&wanted, q)).abs())
            .sum::<f64>()
            / 20.0;
        let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
        assert!(off < 0.2 * mean, "{off} of {mean}");
    }
}

#[test]
fn an_element_leaves_a_hole_if_all_others_are_farther_than_is_usual() {
    let exemplar = loose();
    let mut relations = PlaceRelations::new(&exemplar, &|| Ok(())).unwrap();
    let standing = copied(&exemplar, &relations).elements;
    let spots = |relations: &PlaceRelations<'_>, e: &BoardElement| {
        let own = relations.spots_of(exemplar.places[e.place as usize].figure);
        own.iter().map(|s| [e.at[0] + s[0], e.at[1] + s[1]]).collect::<Vec<_>>()
    };
    let nearest = |id: usize| {
        let own = spots(&relations, &standing[id].unwrap());
        let middle = [0, 1].map(|k| own.iter().map(|s| s[k]).sum::<f64>() / own.len() as f64);
        let others = standing.iter().enumerate().filter(|other| other.0 != id).flat_map(|other| other.1);
        let all = others.flat_map(|other| spots(&relations, other));
        all.map(|s| length(exemplar.page.between(middle, s))).fold(f64::INFINITY, f64::min)
    };
    let distances: Vec<f64> = (0..standing.len()).map(nearest).collect();
    let mut sorted = distances.clone();
    sorted.sort_by(f64::total_cmp);
    relations.widest = sorted[sorted.len() / 2] + 1e-6;
    let board = copied(&exemplar, &relations);
    let found: Vec<bool> = (0..standing.len()).map(|id| leaves_hole(&board, id)).collect();
    let wanted: Vec<bool> = distances.iter().map(|far| *far > relations.widest).collect();
    assert!(found == wanted && wanted.contains(&true) && wanted.contains(&false));
}
