//! Tests of curves beside lines that stand.

use super::{cells, exemplar, go_on, page, params, periodic_waves, waves};
use crate::context::{CurveContext, GivenLines};
use crate::exemplar::{CurveExemplar, CurveStroke};
use crate::initial::patches;
use crate::input::{CurveInput, CurveScale};
use crate::optimise::{CurveResult, curves_beside, level_of};
use kurbo::{Circle, ParamCurve, ParamCurveNearest, Shape};
use vtex_base::geometry::{BezPath, Outline, Point, Rect};

/// The parts of strokes at which something is so, cut where it ceases to be.
fn parts(of: &CurveExemplar, is_kept: impl Fn([f64; 2]) -> bool) -> Vec<CurveStroke> {
    let mut parts: Vec<CurveStroke> = Vec::new();
    for stroke in &of.strokes {
        let mut goes_on = false;
        for pair in stroke.points.windows(2) {
            let [mut a, mut b] = [pair[0], pair[1]];
            let border = || {
                let (mut on, mut off) = if is_kept(a) { (a, b) } else { (b, a) };
                for _ in 0..60 {
                    let middle = [0, 1].map(|k| 0.5 * (on[k] + off[k]));
                    *(if is_kept(middle) { &mut on } else { &mut off }) = middle;
                }
                on
            };
            match (is_kept(a), is_kept(b)) {
                (false, false) => {
                    goes_on = false;
                    continue;
                }
                (true, false) => b = border(),
                (false, true) => (a, goes_on) = (border(), false),
                (true, true) => {}
            }
            match parts.last_mut().filter(|_| goes_on) {
                Some(part) => part.points.push(b),
                None => parts.push(CurveStroke { points: vec![a, b], closed: false, style: stroke.style }),
            }
            goes_on = is_kept(pair[1]);
        }
    }
    parts
}

/// What is made in a region of an exemplar's own page, beside the parts of its strokes that are drawn.
fn made_in(region: BezPath, of: &CurveExemplar, drawn: Vec<CurveStroke>, seed: u64) -> CurveResult {
    let size = of.page.size;
    let lines = exemplar(page(size, false), drawn).graph(&go_on).unwrap();
    let context = CurveContext { lines, region: Outline::new(&region).unwrap(), source: None };
    let mut params = params(size, false);
    params.seed = seed;
    curves_beside(&of.graph(&go_on).unwrap(), &context, &params, &go_on).unwrap()
}

/// The right half of a page.
fn right_half(of: &CurveExemplar) -> BezPath {
    let [w, h] = of.page.size;
    Rect::new(0.5 * w, 0.0, w, h).to_path(0.1)
}

/// The left half of the strokes of an exemplar.
fn left_half(of: &CurveExemplar) -> Vec<CurveStroke> {
    parts(of, |p| p[0] <= 0.5 * of.page.size[0])
}

/// The ends of strokes inside a page and their share at which a path begins or ends, within a tenth of a unit.
fn joined(made: &CurveResult, drawn: &[CurveStroke], is_border: impl Fn([f64; 2]) -> bool) -> (usize, f64) {
    let paths = made.curves.iter().map(|c| &c.path);
    let ends: Vec<Point> = paths
        .flat_map(|p| {
            let mut segments = p.segments();
            let first = segments.next();
            let last = segments.last().or(first);
            [first.map(|s| s.start()), last.map(|s| s.end())].into_iter().flatten()
        })
        .collect();
    let wanted: Vec<[f64; 2]> = drawn
        .iter()
        .flat_map(|s| [s.points[0], s.points[s.points.len() - 1]])
        .filter(|p| is_border(*p))
        .collect();
    let is_met = |p: &&[f64; 2]| ends.iter().any(|e| e.distance(Point::new(p[0], p[1])) < 0.1);
    (wanted.len(), wanted.iter().filter(is_met).count() as f64 / wanted.len() as f64)
}

fn length_of(made: &CurveResult) -> f64 {
    made.curves.iter().map(|c| c.shown_length).sum()
}

#[test]
fn lines_that_end_at_the_border_of_a_region_go_on_in_it() {
    for (name, of, least) in
        [("waves", waves(), 15), ("cells", cells(), 6), ("periodic", periodic_waves(), 4)]
    {
        let (drawn, [w, h]) = (left_half(&of), of.page.size);
        let in_half: f64 = of.graph(&go_on).unwrap().length() / 2.0;
        for seed in 0..2 {
            let made = made_in(right_half(&of), &of, drawn.clone(), seed);
            let at_border = |p: [f64; 2]| (p[0] - 0.5 * w).abs() < 1e-6 && p[1] > 1.0 && p[1] < h - 1.0;
            let (ends, share) = joined(&made, &drawn, at_border);
            assert!(ends >= least && share >= 0.9, "{name} {seed}: {share} of {ends}");
            let [leading, on] = made.continued;
            assert!(leading >= ends && on as f64 >= 0.9 * leading as f64, "{name} {seed}");
            for path in made.curves.iter().map(|c| c.path.bounding_box()) {
                assert!(path.x0 > 0.5 * w - 0.2, "{name} {seed}: {path:?}");
            }
            let length = length_of(&made) / in_half;
            assert!((0.8..1.25).contains(&length), "{name} {seed}: {length}");
        }
    }
}

#[test]
fn a_hole_is_closed_from_all_sides() {
    let of = waves();
    let hole = Circle::new((200.0, 200.0), 90.0);
    let drawn = parts(&of, |p| !hole.contains(Point::new(p[0], p[1])));
    let made = made_in(hole.to_path(0.01), &of, drawn.clone(), 1);
    let at_border = |p: [f64; 2]| (hole.center.distance(Point::new(p[0], p[1])) - hole.radius).abs() < 0.01;
    let (ends, share) = joined(&made, &drawn, at_border);
    assert!(ends >= 12 && share >= 0.9, "{share} of {ends}");
    for curve in &made.curves {
        let far = curve.path.segments().map(|s| s.eval(0.5).distance(hole.center)).fold(0.0, f64::max);
        assert!(far < hole.radius + 0.5, "{far}");
    }
}

#[test]
fn lines_that_stand_are_not_drawn_again() {
    let of = periodic_waves();
    let made = made_in(right_half(&of), &of, of.strokes.clone(), 2);
    let share = length_of(&made) / (0.5 * of.graph(&go_on).unwrap().length());
    assert!(share < 0.1, "{share}");
    // With every other line there, those between are made.
    let some: Vec<CurveStroke> = of.strokes.iter().step_by(2).cloned().collect();
    let made = made_in(right_half(&of), &of, some.clone(), 2);
    for point in made.curves.iter().flat_map(|c| c.path.segments().map(|s| s.eval(0.5))) {
        let near = |s: &CurveStroke| {
            let steps = s.points.windows(2).map(|w| kurbo::Line::new((w[0][0], w[0][1]), (w[1][0], w[1][1])));
            steps.map(|l| l.nearest(point, 1e-6).distance_sq).fold(f64::INFINITY, f64::min)
        };
        let nearest = some.iter().map(near).fold(f64::INFINITY, f64::min).sqrt();
        assert!(nearest > 10.0, "{point:?} is {nearest} from a line");
    }
    let share = length_of(&made) / (0.5 * of.graph(&go_on).unwrap().length());
    assert!((0.3..0.7).contains(&share), "{share}");
}

#[test]
fn given_samples_keep_their_places_edges_and_existence() {
    let of = waves();
    let scale = CurveScale { distance: 20.0, radius: 45.0 };
    let input = CurveInput::new(&of.graph(&go_on).unwrap(), scale, &go_on).unwrap();
    let drawn = left_half(&of);
    let lines = exemplar(page(of.page.size, false), drawn).graph(&go_on).unwrap();
    let context = CurveContext { lines, region: Outline::new(&right_half(&of)).unwrap(), source: None };
    let given = GivenLines::new(&context, of.page.size, (scale, scale.distance));
    let standing = given.samples(&input, &go_on).unwrap();
    assert!(standing.given() > 50 && standing.given_edges > 40);
    let first = patches(&input, standing.clone(), (1.0, 3), Some(&given), &go_on).unwrap();
    let params = params(of.page.size, false);
    let (made, level) = level_of(first, &input, (&params, Some(&given)), &go_on).unwrap();
    assert!(!level.energies.is_empty() && made.len() > standing.len() + 50);
    assert_eq!(made.points[..made.given()], standing.points[..]);
    let ends = |of: &[crate::output::JoinedEdge]| of.iter().map(|e| e.ends).collect::<Vec<_>>();
    assert_eq!(ends(&made.edges[..made.given_edges]), ends(&standing.edges));
    // Made samples stand in the region, or where no line is near.
    let off = |s: &usize| !given.is_free(made.points[*s]);
    let strays = (made.given()..made.len()).filter(off).count();
    assert!(strays * 20 < made.len() - made.given(), "{strays}");
}

/// What of an exemplar's strokes lies within a distance of a place, and a copy of it made elsewhere beside it.
fn cloned(of: &CurveExemplar, from: Point, to: Point, beside: Vec<CurveStroke>) -> CurveResult {
    let size = of.page.size;
    let region = |at: Point| Outline::new(&Circle::new(at, 70.0).to_path(0.01)).unwrap();
    let lines = exemplar(page(size, false), beside).graph(&go_on).unwrap();
    let context = CurveContext { lines, region: region(to), source: Some(region(from)) };
    curves_beside(&of.graph(&go_on).unwrap(), &context, &params(size, false), &go_on).unwrap()
}

#[test]
fn a_copy_among_nothing_is_the_same_elsewhere() {
    let of = cells();
    let (from, to) = (Point::new(150.0, 160.0), Point::new(230.0, 210.0));
    let far = CurveStroke { points: vec![[2.0, 2.0], [2.0, 3.0]], closed: false, style: 0 };
    let made = cloned(&of, from, to, vec![far]);
    let inside = parts(&of, |p| from.distance(Point::new(p[0], p[1])) < 70.0);
    let steps = inside.iter().flat_map(|s| s.points.windows(2));
    let lines: Vec<kurbo::Line> =
        steps.map(|w| kurbo::Line::new(Point::new(w[0][0], w[0][1]), Point::new(w[1][0], w[1][1]))).collect();
    let wanted: f64 = lines.iter().map(|l| l.length()).sum();
    assert!((length_of(&made) / wanted - 1.0).abs() < 0.05, "{} of {wanted}", length_of(&made));
    for point in made.curves.iter().flat_map(|c| c.path.segments().map(|s| s.eval(0.5))) {
        let there = point - to.to_vec2() + from.to_vec2();
        let far =
            lines.iter().map(|l| l.nearest(there, 1e-6).distance_sq).fold(f64::INFINITY, f64::min).sqrt();
        assert!(far < 1.5, "{there:?} is {far} from the exemplar");
    }
}

#[test]
fn the_same_beside_lines_on_one_and_on_two_threads() {
    let of = waves();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made_in(right_half(&of), &of, left_half(&of), 7))
    };
    let [one, two] = [1, 2].map(run);
    assert!(one.curves.len() > 10 && one == two);
}
