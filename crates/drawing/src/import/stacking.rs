//! How the copies of a periodic page overlap: how much later those one period further along are painted.
//!
//! Scales in rows lie each over the next one, and the last row of the page over the first of its copy below. No order of
//! the page's elements tells this. What is drawn at two borders does: each copy has a place in the painting order among
//! what it overlaps. One number for each axis is looked for: the places by which a copy one period further along is later.

use super::offsets::{Shift, minus, plus};
use std::collections::BTreeSet;
use vtex_base::geometry::Rect;

/// Most pairs that are compared, and most of those that tell something that are used.
const MOST: usize = 20_000_000;
const USED: usize = 2_000;
/// Part of the bounds, at each side, that is not taken as overlapping others.
const RIM: f64 = 0.05;
/// Least part of the pairs in whose order copies are seen to be stacked.
const LEAST: f64 = 0.9;

/// A piece as it was drawn: a copy of a piece or element, moved by some periods.
#[derive(Clone, Copy)]
pub(super) struct DrawnCopy {
    pub(super) piece: usize,
    pub(super) shift: Shift,
    pub(super) bounds: Rect,
}

/// Pairs of overlapping copies: the periods between them, and the places by which the one painted later is before the
/// other in the order of elements. The periods bring more than these.
pub(super) struct Overlaps(Vec<(Shift, i32)>);

impl Overlaps {
    /// Looks at copies in painting order. Only those of one layer are compared.
    pub(super) fn new(copies: &[DrawnCopy], layers: &[usize]) -> Self {
        let moved: Vec<usize> = (0..copies.len()).filter(|&k| copies[k].shift != [0; 2]).collect();
        if moved.len().saturating_mul(copies.len()) > MOST {
            return Self(Vec::new());
        }
        let inner = |copy: &DrawnCopy| {
            let b = copy.bounds;
            b.inflate(-RIM * b.width(), -RIM * b.height())
        };
        let inner: Vec<Rect> = copies.iter().map(inner).collect();
        let mut pairs = Vec::new();
        for &a in &moved {
            for b in (0..copies.len()).filter(|&b| b != a && inner[a].overlaps(inner[b])) {
                let (earlier, later) = (copies[a.min(b)], copies[a.max(b)]);
                let between = plus(later.shift, minus(earlier.shift));
                if between != [0; 2] && layers[earlier.piece] == layers[later.piece] {
                    pairs.push((between, earlier.piece as i32 - later.piece as i32));
                }
            }
        }
        let step = pairs.len().div_ceil(USED).max(1);
        Self(pairs.into_iter().step_by(step).collect())
    }

    /// The places for each axis that agree with most pairs, the smallest ones; zeros unless they agree with far more than
    /// zeros do.
    pub(super) fn stacking(&self) -> [i32; 2] {
        let along = |axis: usize, other: i32| {
            let told = self.0.iter().filter(|(between, _)| between[axis] != 0);
            let told: Vec<(i32, i32)> =
                told.map(|(between, least)| (between[axis], least - other * between[1 - axis])).collect();
            best(&told)
        };
        let agreeing = |[x, y]: [i32; 2]| {
            let agrees = |(between, least): &&(Shift, i32)| x * between[0] + y * between[1] > *least;
            self.0.iter().filter(agrees).count()
        };
        let x = best_alone(&self.0, 0);
        let y = best_alone(&self.0, 1);
        let choices = [[x, along(1, x)], [along(0, y), y]];
        let found = choices.into_iter().max_by_key(|&choice| agreeing(choice)).unwrap_or_default();
        let (all, found_count, flat) = (self.0.len(), agreeing(found), agreeing([0; 2]));
        let is_better = 2 * (all - found_count) <= all - flat && found_count as f64 >= LEAST * all as f64;
        if is_better && all > flat { found } else { [0; 2] }
    }
}

/// The best places for an axis, from pairs between which there are periods along that axis only.
fn best_alone(pairs: &[(Shift, i32)], axis: usize) -> i32 {
    let alone = pairs.iter().filter(|(between, _)| between[axis] != 0 && between[1 - axis] == 0);
    best(&alone.map(|(between, least)| (between[axis], *least)).collect::<Vec<_>>())
}

/// The smallest number that, times the periods of most pairs, is more than their least places.
fn best(pairs: &[(i32, i32)]) -> i32 {
    // Just enough for a pair, or just not too much.
    let bound = |&(periods, least): &(i32, i32)| {
        let enough = (f64::from(least) + 1.0) / f64::from(periods);
        if periods > 0 { libm::ceil(enough) as i32 } else { libm::floor(enough) as i32 }
    };
    let choices: BTreeSet<i32> = pairs.iter().map(bound).chain([0]).collect();
    let agreeing = |choice: i32| pairs.iter().filter(|(periods, least)| choice * periods > *least).count();
    let key = |choice: &i32| (agreeing(*choice), std::cmp::Reverse(choice.abs()));
    choices.into_iter().max_by_key(key).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(drawn: &[([f64; 2], usize, Shift)]) -> [i32; 2] {
        let copies = drawn.iter().map(|&([x, y], piece, shift)| DrawnCopy {
            piece,
            shift,
            bounds: Rect::new(x - 0.4, y - 0.4, x + 0.4, y + 0.4),
        });
        Overlaps::new(&copies.collect::<Vec<_>>(), &[0; 20]).stacking()
    }

    #[test]
    fn rows_lie_over_the_next_ones() {
        // Two rows, painted from below to above, from above to below, and as the elements are numbered.
        let below = seen(&[([0.5, 1.0], 0, [0, 0]), ([0.5, 0.5], 1, [0, 0]), ([0.5, 0.0], 0, [0, -1])]);
        assert!(below[0] == 0 && below[1] < -1, "{below:?}");
        let above = seen(&[([0.5, 0.0], 0, [0, 0]), ([0.5, 0.5], 1, [0, 0]), ([0.5, 1.0], 0, [0, 1])]);
        assert!(above[0] == 0 && above[1] > 1, "{above:?}");
        let flat = seen(&[([0.5, 0.0], 0, [0, 0]), ([0.5, 1.0], 0, [0, 1]), ([0.5, 0.5], 1, [0, 0])]);
        assert_eq!(flat, [0, 0]);
    }

    #[test]
    fn within_rows_copies_lie_over_their_neighbours_and_below_the_next_row() {
        // Rows of two, drawn from left to right and from below to above with what lies beyond the borders.
        let mut drawn = Vec::new();
        for row in (-1..=2i32).rev() {
            for column in -1..=3i32 {
                let element = (1 - row.rem_euclid(2)) * 2 + column.rem_euclid(2);
                let at =
                    [0.5 * f64::from(column) + 0.25 * f64::from(row.rem_euclid(2)), 0.5 * f64::from(row)];
                let shift = [column.div_euclid(2), row.div_euclid(2)];
                drawn.push((at, element as usize, shift));
            }
        }
        let [x, y] = seen(&drawn);
        assert!((2..4).contains(&x) && y <= -4, "{x} {y}");
    }
}
