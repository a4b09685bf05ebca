//! Which texton of one scene becomes which of the other.
//!
//! What a pair costs grows with the square of the way between the two, in units of the typical
//! distance of textons, of the ratio of their sizes, and of the difference of their colours. Pairs
//! that cost more than leaving both alone are never made, so only those near each other need be
//! looked at, and the assignment among these is the cheapest that there is. Where more than
//! [`EXACT`] textons are to be assigned, only the [`NEAREST`] cheapest partners of each are looked at,
//! so that crowds do not fill the memory: an approximation that costs nothing where textons are spread
//! evenly (`benches/editing.md`).

use crate::geometry::{NearPoints, Point, Table, assign, shortest_way};
use crate::parallel;

/// Up to so many textons all partners are looked at.
const EXACT: usize = 3000;
/// Partners looked at beyond that.
const NEAREST: usize = 16;
/// What leaving a texton without partner costs: a way of about two and a half typical distances.
const NONE: f64 = 6.0;
/// What the square of the natural logarithm of the ratio of sizes costs.
const SIZE: f64 = 0.5;
/// What the square of a distance in Oklab costs.
const COLOUR: f64 = 12.0;
/// What another category of the same library costs.
const CATEGORY: f64 = 0.3;
/// Costs are whole multiples of this share of a unit.
const UNIT: f64 = 65536.0;

/// What tells textons apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traits {
    /// Its centre.
    pub(super) at: Point,
    /// Square root of its area.
    pub(super) size: f64,
    /// Mean colour, in Oklab.
    pub(super) colour: [f32; 3],
    /// Library and category, if it has one.
    pub(super) category: Option<(u32, u16)>,
}

/// The plane in which things lie.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// Area over which they are spread.
    pub(super) area: f64,
    /// Lengths after which it repeats along x and y.
    pub(super) periods: [Option<f64>; 2],
}

/// Pairs, and what is left over on each side, ascending.
pub(super) struct Correspondence {
    pub(super) pairs: Vec<[u32; 2]>,
    pub(super) alone: [Vec<u32>; 2],
}

/// The cheapest correspondence of two sets.
pub(super) fn correspond(from: &[Traits], to: &[Traits], plane: &Plane) -> Correspondence {
    let most = if from.len().min(to.len()) > EXACT { NEAREST } else { usize::MAX };
    among(from, to, plane, most)
}

/// The cheapest correspondence in which each has one of its `most` cheapest partners.
fn among(from: &[Traits], to: &[Traits], plane: &Plane, most: usize) -> Correspondence {
    // The fewer are the rows: few of them then go without a column.
    let swapped = from.len() > to.len();
    let (rows, columns) = if swapped { (to, from) } else { (from, to) };
    let own = if rows.is_empty() {
        Vec::new()
    } else {
        let spacing = libm::sqrt(plane.area / rows.len() as f64).max(1e-9);
        let places: Vec<Point> = columns.iter().map(|c| c.at).collect();
        let near = NearPoints::new(&places, plane.periods, spacing * libm::sqrt(NONE));
        let table = parallel::map(rows, |row| {
            let mut entries: Vec<(u32, i64)> = Vec::new();
            near.each(row.at, |k| {
                let cost = cost(row, &columns[k], plane, spacing);
                if cost < NONE {
                    entries.push((k as u32, libm::round(cost * UNIT) as i64));
                }
            });
            if entries.len() > most {
                entries.sort_unstable_by_key(|e| (e.1, e.0));
                entries.truncate(most);
            }
            entries
        });
        assign(&Table::new(table), columns.len(), (NONE * UNIT) as i64)
    };
    let mut taken = vec![false; columns.len()];
    own.iter().flatten().for_each(|&k| taken[k as usize] = true);
    let paired = own.iter().enumerate().filter_map(|(i, k)| k.map(|k| [i as u32, k]));
    let mut pairs: Vec<[u32; 2]> = paired.map(|[i, k]| if swapped { [k, i] } else { [i, k] }).collect();
    pairs.sort_unstable();
    let without =
        |free: &dyn Fn(usize) -> bool, n: usize| (0..n).filter(|&i| free(i)).map(|i| i as u32).collect();
    let mut alone: [Vec<u32>; 2] =
        [without(&|i| own[i].is_none(), rows.len()), without(&|k| !taken[k], columns.len())];
    if swapped {
        alone.reverse();
    }
    Correspondence { pairs, alone }
}

fn cost(a: &Traits, b: &Traits, plane: &Plane, spacing: f64) -> f64 {
    let square = |v: f64| v * v;
    let way = shortest_way(a.at, b.at, plane.periods).hypot2() / square(spacing);
    let size = square(libm::log(a.size.max(1e-3) / b.size.max(1e-3)));
    let colour: f64 = a.colour.iter().zip(b.colour).map(|(a, b)| square(f64::from(a - b))).sum();
    let other = match (a.category, b.category) {
        (Some(a), Some(b)) if a.0 == b.0 && a.1 != b.1 => CATEGORY,
        _ => 0.0,
    };
    way + SIZE * size + COLOUR * colour + other
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    fn scattered(n: usize, seed: u64) -> Vec<Traits> {
        let mut random = stream(seed, "test/scattered", 0);
        let mut unit = || random.unit();
        (0..n)
            .map(|_| Traits {
                at: Point::new(unit() * 100.0, unit() * 100.0),
                size: 1.0 + unit(),
                colour: [unit() as f32, 0.0, 0.0],
                category: None,
            })
            .collect()
    }

    const PLANE: Plane = Plane { area: 1e4, periods: [None; 2] };

    #[test]
    fn a_set_corresponds_to_itself() {
        let set = scattered(60, 1);
        let found = correspond(&set, &set, &PLANE);
        assert_eq!(found.pairs.len(), 60);
        assert!(found.pairs.iter().all(|[a, b]| a == b));
    }

    #[test]
    fn everything_is_paired_or_alone_either_way_round() {
        let (a, b) = (scattered(90, 2), scattered(40, 3));
        let found = correspond(&a, &b, &PLANE);
        let back = correspond(&b, &a, &PLANE);
        assert_eq!(found.pairs.len() + found.alone[0].len(), 90);
        assert_eq!(found.pairs.len() + found.alone[1].len(), 40);
        assert!(found.pairs.len() > 35, "{}", found.pairs.len());
        let mut turned: Vec<[u32; 2]> = back.pairs.iter().map(|[a, b]| [*b, *a]).collect();
        turned.sort_unstable();
        assert_eq!(turned, found.pairs);
    }

    /// Sum of what all pairs cost, and all that are alone on the side of the fewer.
    fn sum(from: &[Traits], to: &[Traits], found: &Correspondence) -> f64 {
        let spacing = libm::sqrt(PLANE.area / from.len().min(to.len()) as f64);
        let of = |[i, k]: &[u32; 2]| cost(&from[*i as usize], &to[*k as usize], &PLANE, spacing);
        found.pairs.iter().map(of).sum::<f64>() + NONE * (from.len().min(to.len()) - found.pairs.len()) as f64
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
        let one = |x: f64| Traits { at: Point::new(x, 50.0), size: 1.0, colour: [0.5; 3], category: None };
        let (a, b) = (vec![one(1.0), one(30.0), one(60.0)], vec![one(99.0), one(31.0), one(62.0)]);
        let small = Plane { area: 300.0, periods: [None; 2] };
        assert_eq!(correspond(&a, &b, &small).pairs, [[1, 1], [2, 2]]);
        let ring = Plane { periods: [Some(100.0), None], ..small };
        assert_eq!(correspond(&a, &b, &ring).pairs, [[0, 0], [1, 1], [2, 2]]);
        assert!(correspond(&[], &b, &ring).pairs.is_empty());
    }
}
