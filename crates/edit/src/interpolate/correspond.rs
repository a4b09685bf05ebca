//! Correspondences between the textons of two scenes.
//!
//! The cost of a pair is a weighted sum of the squared distance in units of the typical spacing, the
//! squared logarithm of the ratio of sizes, and the squared difference of colours. A pair that costs
//! more than leaving both unmatched is never made. So only nearby textons need be considered, and
//! the assignment among them is optimal. Above [`EXACT`] textons, only the [`NEAREST`] cheapest
//! partners of each are considered, which bounds memory. For evenly spread textons this
//! approximation costs nothing (`docs/measurements/editing.md`).

use vtex_base::geometry::{NearPoints, Point, Table, assign, shortest_offset};
use vtex_base::parallel;
use vtex_scene::scene::{CategoryId, LibraryId};

/// Number of textons up to which all partners are considered.
const EXACT: usize = 3000;
/// Number of partners considered per texton above that.
const NEAREST: usize = 16;
/// Cost of leaving a texton unmatched: equals a distance of about two and a half typical spacings.
const UNMATCHED_COST: f64 = 6.0;
/// Weight of the squared natural logarithm of the ratio of sizes.
const SIZE: f64 = 0.5;
/// Weight of the squared colour distance in Oklab.
const COLOUR: f64 = 12.0;
/// Cost of a different category of the same library.
const CATEGORY: f64 = 0.3;
/// Integer costs per unit of cost.
const UNIT: f64 = 65536.0;

/// Properties by which textons are matched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Properties {
    /// Centre on the canvas.
    pub(super) at: Point,
    /// Square root of the area.
    pub(super) size: f64,
    /// Mean colour, in Oklab.
    pub(super) colour: [f32; 3],
    /// Library and category, for primaries.
    pub(super) category: Option<(LibraryId, CategoryId)>,
}

/// The plane in which textons are matched.
#[derive(Clone, Copy)]
pub(super) struct MatchingPlane {
    /// Area over which they are spread, in pixels².
    pub(super) area: f64,
    /// Periods along x and y, `None` where the plane does not repeat.
    pub(super) periods: [Option<f64>; 2],
}

/// Matched pairs, and the unmatched indices of each side in ascending order.
pub(super) struct Matching {
    pub(super) pairs: Vec<[u32; 2]>,
    pub(super) unmatched: [Vec<u32>; 2],
}

/// The cheapest correspondence of two sets of textons.
pub(super) fn correspond(from: &[Properties], to: &[Properties], plane: &MatchingPlane) -> Matching {
    let most = if from.len().min(to.len()) > EXACT { NEAREST } else { usize::MAX };
    among(from, to, plane, most)
}

/// The cheapest correspondence in which each texton is matched to one of its `most` cheapest partners.
fn among(from: &[Properties], to: &[Properties], plane: &MatchingPlane, most: usize) -> Matching {
    // The smaller set forms the rows, so that few of them stay unassigned.
    let swapped = from.len() > to.len();
    let (rows, columns) = if swapped { (to, from) } else { (from, to) };
    let own = if rows.is_empty() {
        Vec::new()
    } else {
        let spacing = libm::sqrt(plane.area / rows.len() as f64).max(1e-9);
        let places: Vec<Point> = columns.iter().map(|c| c.at).collect();
        let near = NearPoints::new(&places, plane.periods, spacing * libm::sqrt(UNMATCHED_COST));
        let table = parallel::map(rows, |row| {
            let mut entries: Vec<(u32, i64)> = Vec::new();
            near.each(row.at, |k| {
                let cost = cost(row, &columns[k], plane, spacing);
                if cost < UNMATCHED_COST {
                    entries.push((k as u32, libm::round(cost * UNIT) as i64));
                }
            });
            if entries.len() > most {
                entries.sort_unstable_by_key(|e| (e.1, e.0));
                entries.truncate(most);
            }
            entries
        });
        assign(&Table::new(table), columns.len(), (UNMATCHED_COST * UNIT) as i64)
    };
    let mut taken = vec![false; columns.len()];
    own.iter().flatten().for_each(|&k| taken[k as usize] = true);
    let paired = own.iter().enumerate().filter_map(|(i, k)| k.map(|k| [i as u32, k]));
    let mut pairs: Vec<[u32; 2]> = paired.map(|[i, k]| if swapped { [k, i] } else { [i, k] }).collect();
    pairs.sort_unstable();
    let without =
        |free: &dyn Fn(usize) -> bool, n: usize| (0..n).filter(|&i| free(i)).map(|i| i as u32).collect();
    let mut unmatched: [Vec<u32>; 2] =
        [without(&|i| own[i].is_none(), rows.len()), without(&|k| !taken[k], columns.len())];
    if swapped {
        unmatched.reverse();
    }
    Matching { pairs, unmatched }
}

fn cost(a: &Properties, b: &Properties, plane: &MatchingPlane, spacing: f64) -> f64 {
    let square = |v: f64| v * v;
    let distance2 = shortest_offset(a.at, b.at, plane.periods).hypot2() / square(spacing);
    let size = square(libm::log(a.size.max(1e-3) / b.size.max(1e-3)));
    let colour: f64 = a.colour.iter().zip(b.colour).map(|(a, b)| square(f64::from(a - b))).sum();
    let other = match (a.category, b.category) {
        (Some(a), Some(b)) if a.0 == b.0 && a.1 != b.1 => CATEGORY,
        _ => 0.0,
    };
    distance2 + SIZE * size + COLOUR * colour + other
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    fn scattered(n: usize, seed: u64) -> Vec<Properties> {
        let mut random = stream(seed, "test/scattered", 0);
        let mut unit = || random.unit();
        (0..n)
            .map(|_| Properties {
                at: Point::new(unit() * 100.0, unit() * 100.0),
                size: 1.0 + unit(),
                colour: [unit() as f32, 0.0, 0.0],
                category: None,
            })
            .collect()
    }

    const PLANE: MatchingPlane = MatchingPlane { area: 1e4, periods: [None; 2] };

    #[test]
    fn a_set_corresponds_to_itself() {
        let set = scattered(60, 1);
        let found = correspond(&set, &set, &PLANE);
        assert_eq!(found.pairs.len(), 60);
        assert!(found.pairs.iter().all(|[a, b]| a == b));
    }

    #[test]
    fn everything_is_paired_or_unmatched() {
        let (a, b) = (scattered(90, 2), scattered(40, 3));
        let found = correspond(&a, &b, &PLANE);
        let back = correspond(&b, &a, &PLANE);
        assert_eq!(found.pairs.len() + found.unmatched[0].len(), 90);
        assert_eq!(found.pairs.len() + found.unmatched[1].len(), 40);
        assert!(found.pairs.len() > 35, "{}", found.pairs.len());
        let mut turned: Vec<[u32; 2]> = back.pairs.iter().map(|[a, b]| [*b, *a]).collect();
        turned.sort_unstable();
        assert_eq!(turned, found.pairs);
    }

    /// Total cost of all pairs and of the unmatched textons on the smaller side.
    fn sum(from: &[Properties], to: &[Properties], found: &Matching) -> f64 {
        let spacing = libm::sqrt(PLANE.area / from.len().min(to.len()) as f64);
        let of = |[i, k]: &[u32; 2]| cost(&from[*i as usize], &to[*k as usize], &PLANE, spacing);
        found.pairs.iter().map(of).sum::<f64>()
            + UNMATCHED_COST * (from.len().min(to.len()) - found.pairs.len()) as f64
    }

    #[test]
    fn few_partners_are_nearly_as_good_as_all() {
        for (n, m) in [(1500, 1500), (1500, 3500)] {
            let (a, b) = (scattered(n, 4), scattered(m, 5));
            let [all, few] = [usize::MAX, NEAREST].map(|most| sum(&a, &b, &among(&a, &b, &PLANE, most)));
            assert!(few >= all - 1e-6 && few < 1.002 * all, "{n} and {m}: {few} instead of {all}");
        }
    }

    #[test]
    fn nothing_goes_far_and_seams_are_crossed() {
        let one =
            |x: f64| Properties { at: Point::new(x, 50.0), size: 1.0, colour: [0.5; 3], category: None };
        let (a, b) = (vec![one(1.0), one(30.0), one(60.0)], vec![one(99.0), one(31.0), one(62.0)]);
        let small = MatchingPlane { area: 300.0, periods: [None; 2] };
        assert_eq!(correspond(&a, &b, &small).pairs, [[1, 1], [2, 2]]);
        let ring = MatchingPlane { periods: [Some(100.0), None], ..small };
        assert_eq!(correspond(&a, &b, &ring).pairs, [[0, 0], [1, 1], [2, 2]]);
        assert!(correspond(&[], &b, &ring).pairs.is_empty());
    }
}
