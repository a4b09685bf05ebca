//! Tests of the whole, and of the steps by hand cases.

mod context;
mod quilt;

use crate::edges::{EdgeVote, chosen};
use crate::exemplar::{CurveElement, CurveExemplar, CurveStroke};
use crate::graph::CurveGraph;
use crate::initial::{noise, patches};
use crate::input::{CurveInput, CurveScale, edge_difference};
use crate::optimise::{CurveParams, CurveParts, CurveResult, PlacedCurveElement, curves, level_of};
use crate::output::CurveOutput;
use crate::search::{choose_sources, search};
use crate::trace::{ShownPart, traced};
use kurbo::{ParamCurveNearest, Point};
use std::f64::consts::TAU;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::{PeriodicPlane, length};
use vtex_base::sampling::stream;

fn go_on() -> Result<()> {
    Ok(())
}

fn page(size: [f64; 2], wraps: bool) -> PeriodicPlane {
    PeriodicPlane { size, wraps: [wraps; 2] }
}

fn stroke(points: Vec<[f64; 2]>) -> CurveStroke {
    CurveStroke { points, closed: false, style: 0 }
}

/// A line given by y at x, every two units from `from` to `to`.
fn line(from: f64, to: f64, y: impl Fn(f64) -> f64) -> CurveStroke {
    let count = ((to - from) / 2.0) as usize;
    stroke((0..=count).map(|i| from + 2.0 * i as f64).map(|x| [x, y(x)]).collect())
}

fn exemplar(page: PeriodicPlane, strokes: Vec<CurveStroke>) -> CurveExemplar {
    CurveExemplar { page, strokes, elements: Vec::new(), weld: 0.5 }
}

/// Waves on a page that does not repeat, no two alike, as they run beyond it.
fn waves() -> CurveExemplar {
    let wave = |k: usize| {
        let turn = 2.1 * k as f64;
        let y = move |x: f64| {
            25.0 * k as f64 + 5.0 * libm::sin(x / 30.0 + 0.4 * turn) + 4.0 * libm::sin(x / 71.0 + turn)
        };
        line(-20.0, 420.0, y)
    };
    exemplar(page([400.0, 400.0], false), (0..17).map(wave).collect())
}

#[test]
fn strokes_that_cross_or_cover_one_another_too_often_are_refused() {
    let at = |k: i32| f64::from(k) + 0.37;
    let across = |k: i32| stroke(vec![[0.0, at(k)], [400.0, at(k)]]);
    let down = |k: i32| stroke(vec![[at(k), 0.0], [at(k), 400.0]]);
    let grid = (0..399).flat_map(|k| [across(k), down(k)]).collect();
    let one_place = (0..4000).map(|k| CurveStroke { style: k, ..across(200) }).collect();
    for strokes in [grid, one_place] {
        let drawn = CurveExemplar { weld: 0.1, ..exemplar(page([400.0, 400.0], false), strokes) };
        assert!(matches!(drawn.graph(&go_on), Err(Error::TooLarge { .. })));
    }
}

/// Waves on a page that repeats, in two styles.
fn periodic_waves() -> CurveExemplar {
    let wave = |k: usize| {
        let mut wave = line(0.0, 240.0, |x| 20.0 + 40.0 * k as f64 + 8.0 * libm::sin(x / 240.0 * TAU));
        wave.style = k as u32 % 2;
        wave
    };
    exemplar(page([240.0, 160.0], true), (0..4).map(wave).collect())
}

/// The borders of Voronoi cells of jittered points, on a page that repeats.
fn cells() -> CurveExemplar {
    const N: i32 = 7;
    const SIDE: f64 = 350.0;
    let mut random = stream(5, "curves/tests", 0);
    let unit = SIDE / f64::from(N);
    let sites: Vec<[f64; 2]> = (0..N * N)
        .map(|k| [k % N, k / N].map(|v| unit * (f64::from(v) + 0.5 + random.range(-0.3, 0.3))))
        .collect();
    let mut strokes = Vec::new();
    for (a, site) in sites.iter().enumerate() {
        let mut ring = vec![[-SIDE, -SIDE], [SIDE, -SIDE], [SIDE, SIDE], [-SIDE, SIDE]];
        let mut owner = vec![usize::MAX; 4];
        for (b, other) in sites.iter().enumerate() {
            for shift in 0..9 {
                let by = [f64::from(shift % 3 - 1) * SIDE, f64::from(shift / 3 - 1) * SIDE];
                let way = [other[0] + by[0] - site[0], other[1] + by[1] - site[1]];
                if length(way) > 0.0 && length(way) < 3.0 * unit {
                    (ring, owner) = cut(&ring, &owner, way, b * 9 + shift as usize);
                }
            }
        }
        for k in 0..ring.len() {
            // Each border once, from the cell of the lower number.
            let other = owner[k] / 9;
            let first = a < other || a == other && owner[k] % 9 < 4;
            let ends = [ring[k], ring[(k + 1) % ring.len()]].map(|p| [p[0] + site[0], p[1] + site[1]]);
            if first {
                strokes.push(stroke(ends.to_vec()));
            }
        }
    }
    exemplar(page([SIDE; 2], true), strokes)
}

/// The part of a ring nearer to the origin than to `way`, and what each side borders on.
fn cut(ring: &[[f64; 2]], owner: &[usize], way: [f64; 2], id: usize) -> (Vec<[f64; 2]>, Vec<usize>) {
    let beyond = |p: [f64; 2]| p[0] * way[0] + p[1] * way[1] - 0.5 * (way[0] * way[0] + way[1] * way[1]);
    let (mut points, mut owners) = (Vec::new(), Vec::new());
    for k in 0..ring.len() {
        let [p, q] = [ring[k], ring[(k + 1) % ring.len()]];
        let [a, b] = [beyond(p), beyond(q)];
        let t = a / (a - b);
        let at = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
        match (a <= 0.0, b <= 0.0) {
            (true, true) => (points.push(p), owners.push(owner[k])),
            (true, false) => {
                points.extend([p, at]);
                (owners.push(owner[k]), owners.push(id))
            }
            (false, true) => (points.push(at), owners.push(owner[k])),
            (false, false) => continue,
        };
    }
    (points, owners)
}

fn params(size: [f64; 2], tile: bool) -> CurveParams {
    let without = CurveParts::default();
    CurveParams { size, tile: [tile; 2], seed: 3, variation: 1.0, tolerance: 0.1, without }
}

fn made(exemplar: &CurveExemplar, params: &CurveParams) -> CurveResult {
    curves(&exemplar.graph(&go_on).unwrap(), params, &go_on).unwrap()
}

fn input(exemplar: &CurveExemplar, distance: f64, radius: f64) -> CurveInput {
    let graph = exemplar.graph(&go_on).unwrap();
    CurveInput::new(&graph, CurveScale { distance, radius }, &go_on).unwrap()
}

/// The exemplar itself as a result.
fn copy(input: &CurveInput) -> CurveOutput {
    let mut output = CurveOutput::new(input.graph.plane);
    for i in 0..input.len() {
        output.push(input.graph.points[i], i as u32, input);
    }
    for (e, edge) in input.graph.edges.iter().enumerate() {
        let half = 2 * e as u32;
        let from = [Some(half), Some(half + 1)];
        output.edges.push(crate::output::JoinedEdge { ends: edge.ends, from, style: edge.style });
    }
    output
}

fn has_node(graph: &CurveGraph, at: [f64; 2], degree: usize) -> bool {
    let near = |n: &usize| length(graph.plane.between(graph.points[*n], at)) < 0.5;
    (0..graph.points.len()).find(near).is_some_and(|n| graph.degree(n) == degree)
}

#[test]
fn crossings_ends_and_corners_are_nodes() {
    let ring = (0..120).map(|k| f64::from(k) / 120.0 * TAU);
    let ring = CurveStroke {
        points: ring.map(|a| [100.0 + 50.0 * libm::cos(a), 100.0 + 50.0 * libm::sin(a)]).collect(),
        closed: true,
        style: 0,
    };
    let strokes = vec![
        ring,
        stroke(vec![[20.0, 130.0], [180.0, 130.0]]),
        stroke(vec![[100.0, 10.0], [100.0, 50.0]]),
        stroke(vec![[10.0, 10.0], [10.0, 60.0], [60.0, 60.0]]),
    ];
    let graph = exemplar(page([200.0, 200.0], false), strokes.clone()).graph(&go_on).unwrap();
    // The line through the ring, the line that ends on it, ends, and a corner.
    for x in [60.0, 140.0] {
        assert!(has_node(&graph, [x, 130.0], 4), "{x} {:?}", graph.points);
    }
    assert!(has_node(&graph, [100.0, 50.0], 3));
    assert!(has_node(&graph, [100.0, 10.0], 1));
    assert!(has_node(&graph, [10.0, 60.0], 2));
    let sampled = graph.sampled(12.0);
    assert!(has_node(&sampled, [10.0, 60.0], 2));
    // Back to paths: the ring is one, the bent line one with a corner, no path is far from its stroke.
    let shown = ShownPart { size: [200.0; 2], tile: [false; 2], margin: 5.0 };
    let paths = traced(&sampled, shown, 0.1);
    assert_eq!(paths.len(), 4, "{paths:?}");
    let corner = |p: &crate::TracedCurve| {
        p.path
            .elements()
            .iter()
            .any(|e| e.end_point().is_some_and(|p| p.distance(Point::new(10.0, 60.0)) < 0.5))
    };
    assert!(paths.iter().any(corner));
    for path in &paths {
        for segment in path.path.segments() {
            for k in 0..=10 {
                let p = kurbo::ParamCurve::eval(&segment, f64::from(k) / 10.0);
                assert!(distance(&strokes, p) < 1.0, "{p:?}");
            }
        }
    }
    for p in strokes.iter().flat_map(|s| &s.points) {
        let far = |path: &crate::TracedCurve| {
            let near = path.path.segments().map(|s| s.nearest(Point::new(p[0], p[1]), 1e-3).distance_sq);
            near.fold(f64::INFINITY, f64::min)
        };
        assert!(paths.iter().map(far).fold(f64::INFINITY, f64::min) < 1.0, "{p:?}");
    }
}

/// Distance of a point from strokes.
fn distance(strokes: &[CurveStroke], p: Point) -> f64 {
    let mut least = f64::INFINITY;
    for stroke in strokes {
        let mut points: Vec<Point> = stroke.points.iter().map(|p| Point::new(p[0], p[1])).collect();
        points.extend(stroke.closed.then(|| points[0]));
        for pair in points.windows(2) {
            least = least.min(kurbo::Line::new(pair[0], pair[1]).nearest(p, 0.0).distance_sq);
        }
    }
    libm::sqrt(least)
}

#[test]
fn edges_tell_samples_apart() {
    let two = [[10.0, 0.0], [-10.0, 0.0]];
    let three = [[-10.0, 3.0], [0.0, 10.0], [10.0, 4.0]];
    // The matched edges are 4 and 3 apart, and one is too many.
    assert!((edge_difference(&two, &three, 12.0) - 19.0).abs() < 1e-9);
    assert!((edge_difference(&three, &two, 12.0) - 19.0).abs() < 1e-9);
    assert_eq!(edge_difference(&two, &two, 12.0), 0.0);
    let one = [[0.0, 10.0]];
    assert!((edge_difference(&one, &three, 5.0) - 10.0).abs() < 1e-9);
}

#[test]
fn the_search_finds_nearly_what_a_search_of_all_finds() {
    let input = input(&waves(), 25.0, 70.0);
    let canvas = PeriodicPlane { size: [420.0, 420.0], wraps: [true; 2] };
    let mut output = patches(&input, CurveOutput::new(canvas), (1.0, 4), None, &go_on).unwrap();
    assert!(output.len() > 200, "{}", output.len());
    let mut found = f64::INFINITY;
    for _ in 0..3 {
        found = search(&mut output, &input, &go_on).unwrap().energy();
    }
    let all: Vec<Vec<u32>> = vec![(0..input.len() as u32).collect(); output.len()];
    choose_sources(&mut output, &input, &all, &go_on).unwrap();
    let best = search(&mut output, &input, &go_on).unwrap().energy();
    assert!(best <= found && found <= 1.1 * best, "{found}, at best {best}");
}

#[test]
fn a_spurious_sample_is_left_alone_and_spoils_nothing() {
    let input = input(&cells(), 15.0, 50.0);
    let mut output = copy(&input);
    let spurious = output.push([175.0, 171.0], 0, &input);
    let matches = search(&mut output, &input, &go_on).unwrap();
    let (mut seen, mut wrong) = (0, 0);
    for s in 0..input.len() {
        assert_eq!(output.source[s] as usize, s);
        for k in matches.near.range(s) {
            let (other, matched) = (matches.near.ids[k], matches.matched[k]);
            if other == spurious {
                seen += 1;
                wrong += usize::from(matched != NONE);
            } else {
                assert_eq!(matched, other);
            }
        }
    }
    assert!(seen > 5 && wrong == 0, "{wrong} of {seen}");
}

#[test]
fn edges_are_chosen_by_confidence_and_by_their_number() {
    // A chain of four with a doubtful chord: the ends want one edge, the inner samples two.
    let vote = |a: u32, b: u32, confidence: f64| EdgeVote { ends: [a, b], confidence };
    let votes = [vote(0, 1, 0.9), vote(1, 2, 0.7), vote(2, 3, 0.8), vote(0, 2, 0.4)];
    let wanted = [1.0, 2.0, 2.0, 1.0];
    let cost = |set: u32| {
        let mut count = [0.0; 4];
        let mut sum = 0.0;
        for (k, v) in votes.iter().enumerate() {
            let is_in = set >> k & 1 == 1;
            sum += if is_in { 1.0 - v.confidence } else { v.confidence };
            if is_in {
                v.ends.iter().for_each(|s| count[*s as usize] += 1.0);
            }
        }
        sum + count.iter().zip(wanted).map(|(c, w): (&f64, f64)| (c - w).abs()).sum::<f64>()
    };
    let best = (0..16).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap();
    let mut found = chosen(&votes, &wanted, vec![0.0; wanted.len()]);
    assert_eq!(found, [0, 2, 1]);
    found.sort_unstable();
    assert_eq!(found.iter().fold(0, |set, k| set | 1 << k), best);
    // Where no sample wants an edge, confidence alone does not make one.
    assert!(chosen(&[vote(0, 1, 0.9)], &[0.0; 2], vec![0.0; 2]).is_empty());
}

#[test]
fn missing_samples_come_back_and_spare_ones_go() {
    let input = input(&periodic_waves(), 12.0, 60.0);
    let whole = copy(&input);
    let mut random = stream(8, "curves/tests", 1);
    let mut less = whole.clone();
    let keep: Vec<bool> = (0..less.len()).map(|s| s % 10 != 3).collect();
    less.retain(&keep);
    let (less, _) = level_of(less, &input, (&params([240.0, 160.0], true), None), &go_on).unwrap();
    let mut more = whole.clone();
    for _ in 0..whole.len() / 10 {
        let at = [random.range(0.0, 240.0), random.range(0.0, 160.0)];
        more.push(at, random.index(input.len()) as u32, &input);
    }
    let (more, level) = level_of(more, &input, (&params([240.0, 160.0], true), None), &go_on).unwrap();
    assert!(level.changed[1] >= whole.len() / 10 - 2, "{level:?}");
    for (name, made) in [("less", less), ("more", more)] {
        let off = made.len().abs_diff(whole.len());
        assert!(off * 50 <= whole.len(), "{name}: {} of {}", made.len(), whole.len());
        let ends = made.incident().iter().filter(|at| at.len() != 2).count();
        assert!(ends * 25 <= whole.len(), "{name}: {ends}");
    }
}

#[test]
fn energy_falls_from_noise_and_patches_begin_lower() {
    let exemplar = cells();
    let input = input(&exemplar, 20.0, 60.0);
    let canvas = page([450.0, 400.0], true);
    let without = CurveParts { no_patches: true, ..CurveParts::default() };
    let params = CurveParams { without, ..params(canvas.size, true) };
    let (_, random) =
        level_of(noise(&input, CurveOutput::new(canvas), 4, None), &input, (&params, None), &go_on).unwrap();
    let first = patches(&input, CurveOutput::new(canvas), (1.0, 4), None, &go_on).unwrap();
    let (_, patched) = level_of(first, &input, (&params, None), &go_on).unwrap();
    // Noise has no edges at first, which cost nothing: the second iteration is the first with all terms.
    let [first, last] = [random.energies[1], random.energies[random.energies.len() - 1]];
    assert!(last < 0.75 * first, "{random:?}");
    assert!(patched.energies[0] < 0.5 * first, "{patched:?}");
}

#[test]
fn forced_matches_cost_more_and_straight_courses_are_shorter() {
    let made_without =
        |without: CurveParts| made(&waves(), &CurveParams { without, ..params([500.0, 400.0], true) });
    let full = made_without(CurveParts::default());
    let forced = made_without(CurveParts { no_robust: true, ..CurveParts::default() });
    // The first iteration of both has the same samples.
    assert!(
        forced.levels[0].energies[0] > 1.2 * full.levels[0].energies[0],
        "{:?} {:?}",
        forced.levels,
        full.levels
    );
    let straight = made_without(CurveParts { no_orientation: true, ..CurveParts::default() });
    assert_eq!(straight.levels, full.levels);
    let lengths = [&straight, &full].map(|r| r.measures[1].length);
    assert!(lengths[0] < 0.9999 * lengths[1], "{lengths:?}");
    for level in &full.levels {
        assert_eq!(level.output.len(), level.samples[1]);
        assert_eq!(level.output.iter().map(|o| o.1).sum::<usize>(), 2 * level.edges.len());
    }
}

#[test]
fn waves_and_cells_go_on_without_loose_ends() {
    for (name, exemplar, most) in [("waves", waves(), 1.0), ("cells", cells(), 0.0)] {
        for tile in [false, true] {
            let made = made(&exemplar, &params([700.0, 500.0], tile));
            let [drawn, found] = &made.measures;
            println!("{name} {tile} {:?} {:?} {:?}", made.levels, made.mended, made.measures);
            let side = 1000.0;
            assert!(found.end_density() * side <= drawn.end_density() * side + most, "{name}: {found:?}");
            assert!(found.degree_variation(drawn) < 0.15, "{name}: {found:?} {drawn:?}");
            let density = found.length / drawn.length;
            let wanted = 700.0 * 500.0 / exemplar.page.area();
            assert!(tile || density > wanted, "{name}");
            assert!(!tile || (density / wanted - 1.0).abs() < 0.15, "{name}: {density} of {wanted}");
        }
    }
}

#[test]
fn periodic_waves_run_on_across_the_borders_of_a_tile() {
    let made = made(&periodic_waves(), &params([480.0, 320.0], true));
    assert_eq!(made.measures[1].ends, 0);
    // Each wave is one path, which ends a whole period from its beginning but for the overlap.
    assert_eq!(made.curves.len(), 8);
    for curve in &made.curves {
        let ends = [curve.path.elements()[0], *curve.path.elements().last().unwrap()]
            .map(|e| e.end_point().unwrap());
        let way = ends[1] - ends[0];
        assert!((way.x.abs() - 480.0).abs() < 4.0 && way.y.abs() < 2.0, "{way:?}");
    }
}

#[test]
fn the_same_on_one_and_on_two_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made(&cells(), &params([500.0, 420.0], true)))
    };
    let one = run(1);
    assert_eq!(one, run(2));
    let other = made(&cells(), &CurveParams { seed: 4, ..params([500.0, 420.0], true) });
    assert_ne!(one.curves, other.curves);
}

#[test]
fn pages_whose_borders_do_not_join_are_known() {
    let is_seamless = |of: &CurveExemplar| of.is_seamless(&of.graph(&go_on).unwrap());
    assert!(is_seamless(&periodic_waves()));
    assert!(is_seamless(&cells()));
    let torn = (0..9).map(|k| line(0.0, 240.0, |x| 15.0 * f64::from(k) + 0.05 * x)).collect();
    let torn = exemplar(page([240.0, 160.0], true), torn);
    assert!(!is_seamless(&torn));
}

/// Waves with dots half-way between them.
fn dotted_waves() -> CurveExemplar {
    let mut exemplar = waves();
    let mut random = stream(8, "curves/tests", 0);
    let point = |k: usize, x: f64| exemplar.strokes[k].points[((x + 20.0) / 2.0) as usize];
    let mut elements = Vec::new();
    for k in 0..16 {
        for j in 0..7 {
            let x = 57.0 * f64::from(j) + random.range(4.0, 50.0);
            let [a, b] = [point(k, x), point(k + 1, x)];
            elements.push(CurveElement { at: [a[0], 0.5 * (a[1] + b[1])], style: 50 + j as u32 % 2 });
        }
    }
    exemplar.elements = elements;
    exemplar
}

#[test]
fn elements_stay_between_the_lines() {
    let exemplar = dotted_waves();
    let params = params([600.0, 500.0], false);
    let found = made(&exemplar, &params);
    let mut points: Vec<Point> = Vec::new();
    found.curves.iter().for_each(|c| kurbo::flatten(c.path.iter(), 0.2, |e| points.extend(e.end_point())));
    let place = |p: &[f64; 2]| Point::new(p[0], p[1]);
    let dense = |a: &Point, b: &Point| (0..=20).map(|k| a.lerp(*b, f64::from(k) / 20.0)).collect::<Vec<_>>();
    let lines: Vec<Point> =
        points.windows(2).filter(|w| w[0].distance(w[1]) < 60.0).flat_map(|w| dense(&w[0], &w[1])).collect();
    let shown = |e: &&PlacedCurveElement| (0..2).all(|k| (0.0..params.size[k]).contains(&e.at[k]));
    let elements: Vec<&PlacedCurveElement> = found.elements.iter().filter(shown).collect();
    let on_page = |e: &&CurveElement| (0..2).all(|k| (0.0..400.0).contains(&e.at[k]));
    let wanted = exemplar.elements.iter().filter(on_page).count() as f64 * 600.0 * 500.0 / (400.0 * 400.0);
    assert!((elements.len() as f64 / wanted - 1.0).abs() < 0.15, "{} of {wanted}", elements.len());
    let nearest =
        |e: &PlacedCurveElement| lines.iter().map(|p| p.distance(place(&e.at))).fold(f64::INFINITY, f64::min);
    // Half-way between lines some 25 apart.
    let between = elements.iter().filter(|e| (6.0..=17.0).contains(&nearest(e))).count();
    assert!(between as f64 > 0.95 * elements.len() as f64, "{between} of {}", elements.len());
    let used: std::collections::BTreeSet<u32> = elements.iter().map(|e| e.element).collect();
    assert!(used.len() > 40, "{}", used.len());
}

#[test]
fn elements_of_a_page_that_repeats_fill_a_tile() {
    let mut exemplar = periodic_waves();
    let row = |k: usize| (0..6).map(move |j| [20.0 + 40.0 * f64::from(j), 40.0 + 40.0 * k as f64]);
    exemplar.elements = (0..4).flat_map(row).map(|at| CurveElement { at, style: 9 }).collect();
    let found = made(&exemplar, &params([480.0, 320.0], true));
    assert_eq!(found.elements.len(), 4 * 24);
}

#[test]
fn bad_input_is_drawn_or_refused() {
    let small = page([200.0, 200.0], false);
    let cases: Vec<(&str, Vec<CurveStroke>)> = vec![
        ("nothing", Vec::new()),
        ("a point", vec![stroke(vec![[50.0, 50.0]])]),
        ("no length", vec![stroke(vec![[50.0, 50.0], [50.0, 50.0], [50.0, 50.0]])]),
        ("not a number", vec![stroke(vec![[50.0, f64::NAN], [80.0, 50.0]])]),
        ("a lone line", vec![stroke(vec![[0.0, 90.0], [200.0, 110.0]])]),
        ("crosses itself", vec![stroke(vec![[20.0, 20.0], [180.0, 180.0], [180.0, 20.0], [20.0, 180.0]])]),
        ("twice the same", vec![stroke(vec![[20.0, 20.0], [180.0, 100.0]]); 2]),
        ("partly the same", vec![line(0.0, 150.0, |_| 60.0), line(50.0, 200.0, |_| 60.1)]),
        (
            "a small ring",
            vec![CurveStroke {
                points: vec![[90.0, 90.0], [96.0, 90.0], [96.0, 96.0], [90.0, 96.0]],
                closed: true,
                style: 3,
            }],
        ),
        ("beside the page", vec![line(300.0, 400.0, |_| 500.0)]),
        ("leaves the page", vec![line(-100.0, 300.0, |x| x), line(-100.0, 300.0, |x| 200.0 - x)]),
    ];
    for (name, strokes) in cases {
        for wraps in [false, true] {
            let plane = PeriodicPlane { wraps: [wraps; 2], ..small };
            let graph = exemplar(plane, strokes.clone()).graph(&go_on).unwrap();
            match curves(&graph, &params([300.0, 260.0], true), &go_on) {
                Ok(made) => assert!(made.curves.iter().all(|c| c.path.is_finite()), "{name}"),
                Err(Error::Parameter { name: "method", .. }) => {}
                Err(other) => panic!("{name}: {other}"),
            }
        }
    }
    // What lies on another stroke counts once.
    let graph = |strokes: &[CurveStroke]| exemplar(small, strokes.to_vec()).graph(&go_on).unwrap();
    let once = [stroke(vec![[20.0, 20.0], [180.0, 100.0]])];
    assert_eq!(graph(&[once[0].clone(), once[0].clone()]).length(), graph(&once).length());
    assert_eq!(graph(&[once[0].clone(), once[0].clone()]).edges.len(), 1);
}

#[test]
fn very_many_segments_are_bounded_and_work_can_be_stopped() {
    let zigzag = |k: usize| {
        let at = |i: usize| [i as f64 * 0.4, 4.0 * k as f64 + if i.is_multiple_of(2) { 0.0 } else { 0.4 }];
        stroke((0..1000).map(at).collect())
    };
    let many = exemplar(page([400.0, 400.0], false), (0..100).map(zigzag).collect());
    match many.graph(&go_on).and_then(|graph| curves(&graph, &params([400.0, 400.0], false), &go_on)) {
        Ok(made) => assert!(!made.curves.is_empty()),
        Err(Error::TooLarge { .. }) => {}
        Err(other) => panic!("{other}"),
    }
    let huge = curves(&periodic_waves().graph(&go_on).unwrap(), &params([2e6, 2e6], false), &go_on);
    assert!(matches!(huge, Err(Error::TooLarge { .. })), "{huge:?}");
    let asked = std::sync::atomic::AtomicU32::new(0);
    let stop = || match asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) {
        20.. => Err(Error::Interrupted),
        _ => Ok(()),
    };
    let graph = cells().graph(&stop);
    let stopped = graph.and_then(|graph| curves(&graph, &params([500.0, 500.0], false), &stop));
    assert!(matches!(stopped, Err(Error::Interrupted)));
}
