//! The field at the points of a fine grid, and the colours of rows that approximate it.

use vtex_base::parallel;
use vtex_scene::scene::field::Interpolant;

/// Sampled lines from one row to the next.
const LINES: usize = 4;
/// Largest difference of the grid from a sample, in 8-bit steps. Painting adds up to 1 more.
const BOUND: f64 = 2.2;
/// Largest difference of a row from its best fit, in 8-bit steps. The mean error depends on it.
const TOLERANCE: f64 = 1.75;
/// Number of rounds in which even and odd rows are fitted to each other before stops are sought.
const ROUNDS: usize = 4;

/// Components (0 to 255) along a line, one for each sample.
pub(super) type Line = Vec<[f32; 3]>;

/// The colours that a row may have at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corridor {
    /// The value at which the strips above and below fit best.
    pub(super) target: [f64; 3],
    /// The permitted range; it always contains a whole number.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

/// The sampled field.
pub(super) struct FieldSamples {
    lines: Vec<Line>,
    row_count: usize,
    /// Whether the last row is a copy of the first.
    wraps: bool,
    /// Factor by which the tolerance is widened. The bound grows by its square root, because many small
    /// errors are less visible than a few large ones.
    pub(super) slack: f64,
}

impl FieldSamples {
    /// Samples the field at the places `xs`, on lines that divide the distance of rows. There are
    /// `row_count` rows and one at the lower border.
    pub(super) fn new(field: &Interpolant, xs: &[f64], height: f64, row_count: usize, wraps: bool) -> Self {
        let count = LINES * row_count;
        let ys: Vec<f64> = (0..=count).map(|k| k as f64 * height / count as f64).collect();
        let mut lines = parallel::map(&ys, |&y| -> Line {
            xs.iter().map(|&x| field.at(x, y).map(|v| v as f32)).collect()
        });
        if wraps {
            // The last line may miss the border by a rounding error.
            lines[count] = lines[0].clone();
        }
        Self { lines, row_count, wraps, slack: 1.0 }
    }

    /// Rows that fit best together, before any stop is left out. Where the field has a peak between rows, the
    /// errors above and below it are balanced.
    pub(super) fn balanced_rows(&self) -> Vec<Line> {
        let mut values: Vec<Line> = self.lines.iter().step_by(LINES).cloned().collect();
        for round in 0..ROUNDS {
            self.improve(&mut values, round % 2, |corridor| {
                (corridor.iter().map(|c| c.target.map(|v| v as f32)).collect(), ())
            });
        }
        values
    }

    /// Fits even or odd rows to the present colours of their neighbours. `fit` gives a row's colours within
    /// its corridor, and a further result for each row.
    pub(super) fn improve<T: Clone + Send>(
        &self,
        values: &mut [Line],
        parity: usize,
        fit: impl Fn(&[Corridor]) -> (Line, T) + Sync,
    ) -> Vec<(usize, T)> {
        // The last row of a wrapping background is its first.
        let rows = if self.wraps { self.row_count } else { self.row_count + 1 };
        let chosen: Vec<usize> = (parity..rows).step_by(2).collect();
        let known: &[Line] = values;
        let fitted = parallel::map(&chosen, |&k| {
            let corridor: Vec<Corridor> = (0..known[k].len()).map(|i| self.corridor(known, k, i)).collect();
            fit(&corridor)
        });
        let mut found = Vec::new();
        for (k, (line, other)) in chosen.into_iter().zip(fitted) {
            if k == 0 && self.wraps {
                values[self.row_count] = line.clone();
                found.push((self.row_count, other.clone()));
            }
            values[k] = line;
            found.push((k, other));
        }
        found
    }

    /// The strips at a row: for each the row at its other side, the index of this row's line, and whether the
    /// strip lies before it.
    fn strips(&self, k: usize) -> impl Iterator<Item = (usize, usize, bool)> {
        let (own, last) = (LINES * k, self.row_count);
        let above = match k {
            0 => self.wraps.then_some((last - 1, LINES * last, true)),
            _ => Some((k - 1, own, true)),
        };
        let below = if k < last { Some((k + 1, own, false)) } else { self.wraps.then_some((1, 0, false)) };
        above.into_iter().chain(below)
    }

    /// The corridor of row `k` at sample `i`.
    fn corridor(&self, values: &[Line], k: usize, i: usize) -> Corridor {
        // A sample in which the row has the weight w bounds w · row.
        let mut wanted = [(0.0, [0.0; 3]); 2 * LINES];
        let mut count = 0;
        for (neighbour, own, before) in self.strips(k) {
            let neighbour = values[neighbour][i];
            for m in 0..LINES {
                let field = self.lines[if before { own - m } else { own + m }][i];
                let w = 1.0 - m as f64 / LINES as f64;
                let rest = [0, 1, 2].map(|c| f64::from(field[c]) - (1.0 - w) * f64::from(neighbour[c]));
                wanted[count] = (w, rest);
                count += 1;
            }
        }
        let wanted = &wanted[..count];
        let square: f64 = wanted.iter().map(|(w, _)| w * w).sum();
        let [red, green, blue] = [0, 1, 2].map(|c| {
            let (low, high) = range(wanted, c, BOUND * libm::sqrt(self.slack));
            let tolerance = TOLERANCE * self.slack;
            let best = wanted.iter().map(|(w, rest)| w * rest[c]).sum::<f64>() / square;
            let target = best.clamp(low, high).clamp(0.0, 255.0);
            let whole = libm::round(target);
            [target, low.max(target - tolerance).min(whole), high.min(target + tolerance).max(whole)]
        });
        let component = |n: usize| [red[n], green[n], blue[n]];
        Corridor { target: component(0), low: component(1), high: component(2) }
    }
}

/// The range of component `c` of a row in which all samples stay within the bound. If there is none, because
/// the field has a sharp peak, the least possible bound is used.
fn range(wanted: &[(f64, [f64; 3])], c: usize, mut bound: f64) -> (f64, f64) {
    loop {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (w, rest) in wanted {
            low = low.max((rest[c] - bound) / w);
            high = high.min((rest[c] + bound) / w);
        }
        if low <= high {
            return (low, high);
        }
        bound += 0.25;
    }
}
