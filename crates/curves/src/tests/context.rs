//! Tests of curves beside lines that stand.

use super::{cells, exemplar, go_on, line, page, params, periodic_waves, waves};
use crate::context::CurveContext;
use crate::exemplar::{CurveExemplar, CurveStroke};
use crate::optimise::{CurveResult, curves_beside};
use kurbo::{ParamCurve, Shape};
use vtex_base::geometry::{Outline, Point, Rect};

/// The parts of strokes left of `x`.
fn left_of(x: f64, of: &CurveExemplar) -> Vec<CurveStroke> {
    let mut parts: Vec<CurveStroke> = Vec::new();
    for stroke in &of.strokes {
        let mut goes_on = false;
        for pair in stroke.points.windows(2) {
            let [mut a, mut b] = [pair[0], pair[1]];
            let t = (x - a[0]) / (b[0] - a[0]);
            let border = [x, a[1] + t * (b[1] - a[1])];
            match (a[0] <= x, b[0] <= x) {
                (false, false) => {
                    goes_on = false;
                    continue;
                }
                (true, false) => b = border,
                (false, true) => (a, goes_on) = (border, false),
                (true, true) => {}
            }
            match parts.last_mut().filter(|_| goes_on) {
                Some(part) => part.points.push(b),
                None => parts.push(CurveStroke { points: vec![a, b], closed: false, style: stroke.style }),
            }
            goes_on = pair[1][0] <= x;
        }
    }
    parts
}

/// What is made right of the left half of an exemplar's own page.
fn beside_half(of: &CurveExemplar, seed: u64) -> CurveResult {
    let [w, h] = of.page.size;
    let lines = exemplar(page([w, h], false), left_of(0.5 * w, of)).graph(&go_on).unwrap();
    let region = Outline::new(&Rect::new(0.5 * w, 0.0, w, h).to_path(0.1)).unwrap();
    let context = CurveContext { lines, region };
    let mut params = params([w, h], false);
    params.seed = seed;
    curves_beside(&of.graph(&go_on).unwrap(), &context, &params, &go_on).unwrap()
}

#[test]
fn halves_go_on() {
    for (name, of) in [("waves", waves()), ("cells", cells()), ("periodic", periodic_waves())] {
        for seed in 0..3 {
            let made = beside_half(&of, seed);
            let length: f64 = made.curves.iter().map(|c| c.shown_length).sum();
            let whole = of.graph(&go_on).unwrap().length();
            eprintln!("{name} {seed}: continued {:?} curves {} length {:.2} ends {:?} mended {:?}", made.continued, made.curves.len(), length / (0.5 * whole), made.measures.map(|m| m.ends), made.mended);
        }
    }
}
