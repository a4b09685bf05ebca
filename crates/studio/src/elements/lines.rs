//! Pixels along and within lines that a user draws.

use super::ElementMasks;
use vtex_base::raster::{Mask, Span};

/// Most points of a line, and most pixels along it.
const LONGEST: (usize, f64) = (8192, 200_000.0);

impl ElementMasks {
    /// What a brush of a radius touches.
    pub(super) fn stroke(&self, path: &[[f64; 2]], radius: f64) -> Mask {
        let ends = path.windows(2).map(|pair| [pair[0], pair[1]]);
        let dot = path.first().map(|&at| [at, at]);
        Mask::from_spans(dot.into_iter().chain(ends).flat_map(|[a, b]| self.capsule(a, b, radius)).collect())
    }

    /// The pixels whose centres are within a radius of the line between two places.
    fn capsule(&self, a: [f64; 2], b: [f64; 2], radius: f64) -> Vec<Span> {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let length = (dx * dx + dy * dy).sqrt();
        let side = if length > 0.0 { [-dy * radius / length, dx * radius / length] } else { [0.0; 2] };
        let corners = [
            [a[0] + side[0], a[1] + side[1]],
            [b[0] + side[0], b[1] + side[1]],
            [b[0] - side[0], b[1] - side[1]],
            [a[0] - side[0], a[1] - side[1]],
        ];
        let row = |y: i32| {
            let centre = f64::from(y) + 0.5;
            let disc = |at: [f64; 2]| {
                let up = centre - at[1];
                let reach = radius * radius - up * up;
                (reach >= 0.0).then(|| [at[0] - reach.sqrt(), at[0] + reach.sqrt()])
            };
            let edges = (0..4).filter_map(|i| {
                let x = crossing(corners[i], corners[(i + 1) % 4], centre)?;
                Some([x, x])
            });
            // The shape is convex, so each row has one run.
            let all = [disc(a), disc(b)].into_iter().flatten().chain(edges);
            let [x0, x1] = all.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])?;
            self.run(y, x0, x1)
        };
        self.rows([a[1].min(b[1]) - radius, a[1].max(b[1]) + radius]).filter_map(row).collect()
    }

    /// The pixels whose centres a closed line goes round.
    pub(super) fn enclosed(&self, path: &[[f64; 2]]) -> Mask {
        let ys = || path.iter().map(|at| at[1]);
        let [top, bottom] = [ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max)];
        let mut spans = Vec::new();
        for y in self.rows([top, bottom]) {
            let centre = f64::from(y) + 0.5;
            let sides = path.iter().zip(path.iter().cycle().skip(1));
            let mut crossings: Vec<(f64, i32)> = sides
                .filter_map(|(&a, &b)| Some((crossing(a, b, centre)?, if a[1] < b[1] { 1 } else { -1 })))
                .collect();
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut turns = 0;
            for pair in crossings.windows(2) {
                turns += pair[0].1;
                if turns != 0 {
                    spans.extend(self.run(y, pair[0].0, pair[1].0));
                }
            }
        }
        Mask::from_spans(spans)
    }

    /// The rows of the photograph whose centres lie between two heights.
    fn rows(&self, [top, bottom]: [f64; 2]) -> std::ops::Range<i32> {
        let bound = |y: f64| y.clamp(0.0, f64::from(self.size[1]));
        bound((top - 0.5).ceil()) as i32..bound((bottom - 0.5).floor() + 1.0) as i32
    }

    /// The run of the pixels of a row whose centres lie between two places.
    fn run(&self, y: i32, x0: f64, x1: f64) -> Option<Span> {
        let bound = |x: f64| x.clamp(0.0, f64::from(self.size[0])) as i32;
        let span = Span { y, x0: bound((x0 - 0.5).ceil()), x1: bound((x1 - 0.5).floor() + 1.0) };
        (!span.is_empty()).then_some(span)
    }
}

/// The place where a line crosses a height, of which its upper end is part.
fn crossing(a: [f64; 2], b: [f64; 2], y: f64) -> Option<f64> {
    let crosses = (a[1] <= y) != (b[1] <= y);
    crosses.then(|| a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
}

/// Refuses lines that are too short or too long, and places that are no numbers.
pub(super) fn check_path(path: &[[f64; 2]], least: usize) -> Result<(), String> {
    if path.len() < least {
        return Err("the line is too short".into());
    }
    let length = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).abs() + (pair[1][1] - pair[0][1]).abs();
    let whole: f64 = path.windows(2).map(length).sum();
    let near = path.iter().flatten().all(|v| v.abs() <= 1e6);
    if path.len() > LONGEST.0 || !near || whole > LONGEST.1 {
        return Err("the line is too long".into());
    }
    Ok(())
}
