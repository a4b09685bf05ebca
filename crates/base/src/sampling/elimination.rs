//! Points of which any number can be left out, and the others lie evenly.
//!
//! Points are removed one by one, always the most crowded one: weighted sample elimination (Yuksel 2015,
//! "Sample Elimination for Generating Poisson Disk Sample Sets"). The distance at which points crowd one
//! another is the spacing of equally many points in a perfect lattice, so it grows in steps as points are
//! removed. A point then always has about ten neighbours, and the cost is nearly proportional to the number
//! of points.

use crate::geometry::{NearPoints, Point, shortest_offset};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Factor by which the number of points falls before the distance is updated.
const STEP: usize = 3;
/// The same as a fraction where any number of points may remain: so it suits nearly each.
const RANKS: (usize, usize) = (4, 5);

/// Indices of `count` of the points, ascending. Equally crowded points are removed in the order of `ties`,
/// which are random numbers. Along an axis with a period, distances wrap around.
pub fn evenly_reduced(points: &[Point], ties: &[u64], periods: [Option<f64>; 2], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    while left.len() > count {
        let goal = count.max(left.len() / STEP);
        left = eliminated(points, ties, periods, left, goal, |_| ());
    }
    left
}

/// A rank for each point, above 0 and below 1, all as far apart: the points of the lowest ranks lie evenly at any number
/// of them. `ties` and `periods` are those of [`evenly_reduced`].
pub fn even_ranks(points: &[Point], ties: &[u64], periods: [Option<f64>; 2]) -> Vec<f64> {
    let count = points.len();
    let mut ranks = vec![0.5 / count.max(1) as f64; count];
    let mut above = count;
    let mut left: Vec<usize> = (0..count).collect();
    while left.len() > 1 {
        let goal = (left.len() * RANKS.0 / RANKS.1).max(1);
        left = eliminated(points, ties, periods, left, goal, |gone| {
            above -= 1;
            ranks[gone] = (above as f64 + 0.5) / count as f64;
        });
    }
    ranks
}

/// A point that remains.
struct Crowded {
    weight: f64,
    tie: u64,
    /// Its index among the remaining points.
    index: usize,
}

impl PartialEq for Crowded {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Crowded {}

impl PartialOrd for Crowded {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Crowded {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_weight = self.weight.total_cmp(&other.weight);
        by_weight.then(self.tie.cmp(&other.tie)).then(self.index.cmp(&other.index))
    }
}

/// The points of `left` that are left when all but `goal` are removed; `removed` gets each of the others.
fn eliminated(
    points: &[Point],
    ties: &[u64],
    periods: [Option<f64>; 2],
    left: Vec<usize>,
    goal: usize,
    mut removed: impl FnMut(usize),
) -> Vec<usize> {
    let kept: Vec<Point> = left.iter().map(|&i| points[i]).collect();
    let (starts, near) = crowding(&kept, periods, reach(&kept, periods, goal));
    let of = |i: usize| &near[starts[i]..starts[i + 1]];
    let mut weights: Vec<f64> = (0..left.len()).map(|i| of(i).iter().map(|(_, w)| w).sum()).collect();
    let entry = |index: usize, weight: f64| Crowded { weight, tie: ties[left[index]], index };
    let mut heap: BinaryHeap<Crowded> = weights.iter().enumerate().map(|(i, w)| entry(i, *w)).collect();
    let mut gone = vec![false; left.len()];
    let mut rest = left.len();
    while rest > goal {
        let Some(Crowded { weight, index, .. }) = heap.pop() else { break };
        if gone[index] {
            continue;
        }
        // Weights only fall, so an outdated entry is too high and is put back.
        if weight != weights[index] {
            heap.push(entry(index, weights[index]));
            continue;
        }
        gone[index] = true;
        removed(left[index]);
        rest -= 1;
        of(index).iter().for_each(|&(other, w)| weights[other as usize] -= w);
    }
    left.iter().zip(gone).filter(|(_, gone)| !gone).map(|(i, _)| *i).collect()
}

/// The distance at which points crowd one another when `goal` points are to remain: twice the largest radius
/// of that number of discs in the area.
fn reach(points: &[Point], periods: [Option<f64>; 2], goal: usize) -> f64 {
    let length = |period: Option<f64>, at: &dyn Fn(&Point) -> f64| {
        let low = points.iter().map(at).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
        period.unwrap_or((high - low).max(1e-3))
    };
    let (width, height) = (length(periods[0], &|p| p.x), length(periods[1], &|p| p.y));
    let reach = 2.0 * libm::sqrt(width * height / (2.0 * libm::sqrt(3.0) * goal.max(1) as f64));
    reach.min(width.max(height)).max(1e-3)
}

/// The other points that crowd each point, and their weights: those of point i are at `starts[i]` up to
/// `starts[i + 1]`.
fn crowding(points: &[Point], periods: [Option<f64>; 2], reach: f64) -> (Vec<usize>, Vec<(u32, f64)>) {
    let cells = NearPoints::new(points, periods, reach);
    let (mut starts, mut near) = (vec![0], Vec::new());
    for (index, &at) in points.iter().enumerate() {
        cells.each(at, |other| {
            let square = shortest_offset(at, points[other], periods).hypot2();
            if other != index && square < reach * reach {
                near.push((other as u32, weight(libm::sqrt(square) / reach)));
            }
        });
        starts.push(near.len());
    }
    (starts, near)
}

/// The weight of a neighbour by its distance, as a share of the distance at which points begin to crowd.
fn weight(distance: f64) -> f64 {
    let near = 1.0 - distance;
    let square = near * near;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    fn points(count: usize, [width, height]: [f64; 2]) -> (Vec<Point>, Vec<u64>) {
        let mut random = stream(1, "test/points", 0);
        let points =
            (0..count).map(|_| Point::new(random.range(0.0, width), random.range(0.0, height))).collect();
        (points, (0..count).map(|_| random.bits()).collect())
    }

    /// Shortest distance of two kept points.
    fn shortest(points: &[Point], kept: &[usize], periods: [Option<f64>; 2]) -> f64 {
        let pairs = kept.iter().enumerate().flat_map(|(n, i)| kept[..n].iter().map(move |j| (*i, *j)));
        let apart = pairs.map(|(i, j)| libm::sqrt(shortest_offset(points[i], points[j], periods).hypot2()));
        apart.fold(f64::MAX, f64::min)
    }

    #[test]
    fn what_is_left_is_spread_evenly_across_the_seams() {
        // Cells have different sizes along the two axes.
        for canvas in [[400.0, 300.0], [1000.0, 61.0], [90.0, 700.0]] {
            let (points, ties) = points(2000, canvas);
            let periods = canvas.map(Some);
            for count in [600, 100, 9] {
                let kept = evenly_reduced(&points, &ties, periods, count);
                assert_eq!(kept.len(), count);
                assert!(kept.windows(2).all(|w| w[0] < w[1]));
                // Their distance in a perfect lattice.
                let area = canvas[0] * canvas[1];
                let lattice = libm::sqrt(area * 2.0 / (libm::sqrt(3.0) * count as f64));
                let share = shortest(&points, &kept, periods) / lattice;
                assert!(share > 0.5, "{canvas:?} {count}: {share}");
            }
        }
    }

    #[test]
    fn points_of_the_lowest_ranks_lie_evenly() {
        let canvas = [400.0, 300.0];
        let (points, ties) = points(2000, canvas);
        let ranks = even_ranks(&points, &ties, canvas.map(Some));
        let mut sorted = ranks.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.iter().zip(0..).all(|(rank, k)| (rank - (f64::from(k) + 0.5) / 2000.0).abs() < 1e-12));
        for count in [600, 100, 9] {
            let share = f64::from(count) / 2000.0;
            let kept: Vec<usize> = (0..2000).filter(|&i| ranks[i] < share).collect();
            assert_eq!(kept.len(), count as usize);
            let lattice = libm::sqrt(canvas[0] * canvas[1] * 2.0 / (libm::sqrt(3.0) * f64::from(count)));
            let apart = shortest(&points, &kept, canvas.map(Some)) / lattice;
            assert!(apart > 0.35, "{count}: {apart}");
        }
        assert!(even_ranks(&[], &[], [None; 2]).is_empty());
        assert_eq!(even_ranks(&points[..1], &ties, [None; 2]), [0.5]);
    }

    #[test]
    fn any_points_and_numbers_end() {
        let (mut all, ties) = points(50, [400.0, 300.0]);
        let whole = [None, None];
        assert_eq!(evenly_reduced(&all, &ties, whole, 50).len(), 50);
        assert_eq!(evenly_reduced(&all, &ties, whole, 70).len(), 50);
        assert_eq!(evenly_reduced(&all, &ties, whole, 0).len(), 0);
        all.fill(Point::new(7.0, 7.0));
        assert_eq!(evenly_reduced(&all, &ties, whole, 20).len(), 20);
        all[3] = Point::new(1e7, -1e7);
        assert!(evenly_reduced(&all, &ties, [None, Some(0.5)], 20).contains(&3));
        assert_eq!(evenly_reduced(&[], &[], whole, 3), Vec::<usize>::new());
    }
}
