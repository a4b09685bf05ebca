//! The fewest stops of whole-number colours whose interpolation stays within a corridor.
//!
//! Stops are sought from left to right. The whole values that a stop may have are kept as a range for each
//! component: from every value in it some line leads back to the beginning within the corridor. The next stop
//! is placed as far as a line reaches; among the last few places within reach, the one from which the stop
//! after it reaches farthest. Values are chosen last, all at once, so that squared distances to the targets
//! are least (dynamic programming over the ranges).

use super::RowStop;
use super::samples::Corridor;
use vtex_base::raster::colour::Colour;

/// Places for a stop that are compared.
const CANDIDATES: usize = 4;
/// Most whole values of a component that are considered at a stop.
const VALUES: usize = 8;
/// The cost of leaving the corridor: far more than any distance within.
const PENALTY: f64 = 1000.0;

/// A sample that becomes a stop, and the values that each of its components may have.
#[derive(Clone, Copy)]
struct Knot {
    at: usize,
    from: [i32; 3],
    to: [i32; 3],
}

impl Knot {
    /// A knot of one colour: the whole-number colour nearest to the target.
    fn fixed(at: usize, corridor: &[Corridor]) -> Self {
        let value = corridor[at].target.map(|v| libm::round(v) as i32);
        Self { at, from: value, to: value }
    }
}

/// The stops. Writes their colour at each of the places `xs` to `line`. The first and the last stop depend
/// only on their own targets.
pub(super) fn fit(xs: &[f64], corridor: &[Corridor], line: &mut [[f32; 3]]) -> Vec<RowStop> {
    let last = xs.len() - 1;
    let mut knots = vec![Knot::fixed(0, corridor)];
    while let Some(knot) = knots.last().filter(|k| k.at < last) {
        let candidates = reach(xs, corridor, knot);
        let beyond = |k: &Knot| if k.at == last { last + 1 } else { reach(xs, corridor, k)[0].at };
        let mut best = (candidates[0], beyond(&candidates[0]));
        for candidate in &candidates[1..] {
            let further = beyond(candidate);
            if further > best.1 {
                best = (*candidate, further);
            }
        }
        knots.push(best.0);
    }
    let values = [0, 1, 2].map(|c| choose(xs, corridor, &knots, c));
    let colour = |n: usize| [values[0][n], values[1][n], values[2][n]];
    for (n, pair) in knots.windows(2).enumerate() {
        let (a, b) = (colour(n), colour(n + 1));
        for i in pair[0].at..=pair[1].at {
            let t = share(xs, pair[0].at, pair[1].at, i);
            line[i] = [0, 1, 2].map(|c| (f64::from(a[c]) + f64::from(b[c] - a[c]) * t) as f32);
        }
    }
    let stop = |(n, knot): (usize, &Knot)| RowStop {
        x: xs[knot.at],
        colour: Colour(colour(n).map(|v| v.clamp(0, 255) as u8)),
    };
    knots.iter().enumerate().map(stop).collect()
}

/// Position of sample `i` between two others, 0 to 1.
fn share(xs: &[f64], from: usize, to: usize, i: usize) -> f64 {
    (xs[i] - xs[from]) / (xs[to] - xs[from])
}

/// The last few samples that lines reach from a knot, farthest first; at least one.
fn reach(xs: &[f64], corridor: &[Corridor], knot: &Knot) -> Vec<Knot> {
    let last = xs.len() - 1;
    // For each value of each component, the range of slopes that stay within the corridor.
    let mut slopes = [[(f64::NEG_INFINITY, f64::INFINITY); VALUES]; 3];
    let mut found: Vec<Knot> = Vec::new();
    for at in knot.at + 1..=last {
        let length = xs[at] - xs[knot.at];
        let end = Knot::fixed(at, corridor);
        let mut next = Knot { at, from: [i32::MAX; 3], to: [i32::MIN; 3] };
        let mut open = [false; 3];
        for c in 0..3 {
            for (value, (low, high)) in (knot.from[c]..=knot.to[c]).zip(&mut slopes[c]) {
                let value = f64::from(value);
                *low = low.max((corridor[at].low[c] - value) / length);
                *high = high.min((corridor[at].high[c] - value) / length);
                if *low > *high {
                    continue;
                }
                open[c] = true;
                // A small margin for rounding.
                let from = libm::ceil(value + *low * length - 1e-6) as i32;
                let to = libm::floor(value + *high * length + 1e-6) as i32;
                if from <= to {
                    next.from[c] = next.from[c].min(from);
                    next.to[c] = next.to[c].max(to);
                }
            }
            if at == last {
                next.from[c] = next.from[c].max(end.from[c]);
                next.to[c] = next.to[c].min(end.to[c]);
            }
            next.to[c] = next.to[c].min(next.from[c].saturating_add(VALUES as i32 - 1));
        }
        if (0..3).all(|c| next.from[c] <= next.to[c]) {
            found.push(next);
        }
        if open.contains(&false) {
            break;
        }
    }
    if found.is_empty() {
        found.push(Knot::fixed(knot.at + 1, corridor));
    }
    found.reverse();
    found.truncate(CANDIDATES);
    found
}

/// The values of component `c` at all knots.
fn choose(xs: &[f64], corridor: &[Corridor], knots: &[Knot], c: usize) -> Vec<i32> {
    // For each value of each knot, the least cost so far and the value of the previous knot.
    let mut costs = vec![vec![(0.0, 0); (knots[0].to[c] - knots[0].from[c] + 1) as usize]];
    for pair in knots.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        let before = &costs[costs.len() - 1];
        let best = |v: i32| {
            let mut best = (f64::INFINITY, 0);
            for (n, u) in (a.from[c]..=a.to[c]).enumerate() {
                let cost: f64 = (a.at + 1..=b.at)
                    .map(|i| {
                        let value = f64::from(u) + f64::from(v - u) * share(xs, a.at, b.at, i);
                        let place = &corridor[i];
                        let off = value - place.target[c];
                        let out = (place.low[c] - value).max(value - place.high[c]).max(0.0);
                        off * off + PENALTY * out * out
                    })
                    .sum();
                if before[n].0 + cost < best.0 {
                    best = (before[n].0 + cost, n);
                }
            }
            best
        };
        costs.push((b.from[c]..=b.to[c]).map(best).collect());
    }
    let mut values = Vec::with_capacity(knots.len());
    let mut n = 0;
    for (knot, costs) in knots.iter().zip(&costs).rev() {
        values.push(knot.from[c] + n as i32);
        n = costs[n].1;
    }
    values.reverse();
    values
}
