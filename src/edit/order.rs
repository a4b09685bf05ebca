//! Which of many points to keep so that those left are spread evenly.
//!
//! Points are taken away one by one, always the one most crowded by those that are left: weighted
//! sample elimination (Yuksel 2015, "Sample Elimination for Generating Poisson Disk Sample Sets").
//! The distance at which points crowd one another is that of as many points in a perfect lattice, so
//! it grows in steps as points go; a point then always has some ten neighbours, and the whole costs
//! little more than their number.

use crate::geometry::{Point, Vec2};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// By how much the number of points falls at one distance.
const STEP: usize = 3;

/// Indices of `count` of the points, ascending. Equally crowded points go in the order of `ties`,
/// which are random numbers; along an axis with a period, distances are those on a circle of it.
pub(super) fn spread(points: &[Point], ties: &[u64], periods: [Option<f64>; 2], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    while left.len() > count {
        let goal = count.max(left.len() / STEP);
        left = eliminated(points, ties, periods, left, goal);
    }
    left
}

/// A point that may go.
struct Crowded {
    weight: f64,
    tie: u64,
    /// Its index among those left.
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

fn eliminated(
    points: &[Point],
    ties: &[u64],
    periods: [Option<f64>; 2],
    left: Vec<usize>,
    goal: usize,
) -> Vec<usize> {
    let (starts, near) = Grid::new(points, periods, &left, goal).neighbours();
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
        // Weights only fall, so an entry that is out of date stands too high and is put back.
        if weight != weights[index] {
            heap.push(entry(index, weights[index]));
            continue;
        }
        gone[index] = true;
        rest -= 1;
        of(index).iter().for_each(|&(other, w)| weights[other as usize] -= w);
    }
    left.iter().zip(gone).filter(|(_, gone)| !gone).map(|(i, _)| *i).collect()
}

/// Points sorted into square cells as wide as points crowd one another.
struct Grid {
    points: Vec<Point>,
    periods: [Option<f64>; 2],
    origin: Point,
    cell: f64,
    size: [usize; 2],
    /// Points of each cell, by cell.
    order: Vec<usize>,
    starts: Vec<usize>,
    reach: f64,
}

/// Most cells along an axis.
const MOST_CELLS: f64 = 2048.0;

impl Grid {
    fn new(all: &[Point], periods: [Option<f64>; 2], left: &[usize], goal: usize) -> Self {
        let points: Vec<Point> = left.iter().map(|&i| all[i]).collect();
        let (mut low, mut high) = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
        for p in &points {
            low = Point::new(low.x.min(p.x), low.y.min(p.y));
            high = Point::new(high.x.max(p.x), high.y.max(p.y));
        }
        let axis = |period: Option<f64>, low: f64, high: f64| {
            period.map_or((low, (high - low).max(1e-3)), |period| (0.0, period))
        };
        let (x, width) = axis(periods[0], low.x, high.x);
        let (y, height) = axis(periods[1], low.y, high.y);
        // Twice the largest radius of so many discs in the area.
        let reach = 2.0 * libm::sqrt(width * height / (2.0 * libm::sqrt(3.0) * goal.max(1) as f64));
        let reach = reach.min(width.max(height)).max(1e-3);
        let cells = |length: f64| libm::floor(length / reach).clamp(1.0, MOST_CELLS);
        let size = [cells(width) as usize, cells(height) as usize];
        let cell = (width / cells(width)).max(height / cells(height));
        let mut grid = Self {
            points,
            periods,
            origin: Point::new(x, y),
            cell: cell.max(reach),
            size,
            order: Vec::new(),
            starts: vec![0; size[0] * size[1] + 1],
            reach,
        };
        let homes: Vec<usize> = (0..left.len()).map(|i| grid.home(i)).collect();
        homes.iter().for_each(|&home| grid.starts[home + 1] += 1);
        (1..grid.starts.len()).for_each(|c| grid.starts[c] += grid.starts[c - 1]);
        let mut next = grid.starts.clone();
        grid.order = vec![0; left.len()];
        for (i, home) in homes.into_iter().enumerate() {
            grid.order[next[home]] = i;
            next[home] += 1;
        }
        grid
    }

    /// Column and row of a point.
    fn cell_of(&self, p: Point) -> [usize; 2] {
        let along = |v: f64, count: usize| ((v / self.cell).max(0.0) as usize).min(count - 1);
        [along(p.x - self.origin.x, self.size[0]), along(p.y - self.origin.y, self.size[1])]
    }

    fn home(&self, index: usize) -> usize {
        let [column, row] = self.cell_of(self.points[index]);
        row * self.size[0] + column
    }

    /// Cells next to one along an axis, itself too, each once.
    fn beside(&self, axis: usize, at: usize) -> Vec<usize> {
        let count = self.size[axis];
        let mut cells: Vec<usize> = if self.periods[axis].is_some() {
            // The last cell may be narrower than the others, so two beyond the seam.
            (0..5).map(|k| (at + k + 2 * count - 2) % count).collect()
        } else {
            (at.saturating_sub(1)..(at + 2).min(count)).collect()
        };
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// The other points that crowd each point, and how much: those of point i stand at `starts[i]`
    /// up to `starts[i + 1]`.
    fn neighbours(&self) -> (Vec<usize>, Vec<(u32, f64)>) {
        let beside = |axis: usize| -> Vec<Vec<usize>> {
            (0..self.size[axis]).map(|at| self.beside(axis, at)).collect()
        };
        let (columns, rows) = (beside(0), beside(1));
        let (mut starts, mut near) = (vec![0], Vec::new());
        for index in 0..self.points.len() {
            let [column, row] = self.cell_of(self.points[index]);
            for row in &rows[row] {
                for cell in columns[column].iter().map(|column| row * self.size[0] + column) {
                    let others = self.order[self.starts[cell]..self.starts[cell + 1]].iter();
                    near.extend(
                        others.filter_map(|&other| Some((other as u32, self.crowding(index, other)?))),
                    );
                }
            }
            starts.push(near.len());
        }
        (starts, near)
    }

    /// How much one point crowds another; nothing if it is the same or far away.
    fn crowding(&self, index: usize, other: usize) -> Option<f64> {
        let distance = self.distance(index, other);
        (index != other && distance < self.reach).then(|| {
            let near = 1.0 - distance / self.reach;
            let square = near * near;
            let fourth = square * square;
            fourth * fourth
        })
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        let along = |d: f64, period: Option<f64>| match period {
            Some(period) => d.abs().min(period - d.abs()),
            None => d,
        };
        let Vec2 { x, y } = self.points[a] - self.points[b];
        let (x, y) = (along(x, self.periods[0]), along(y, self.periods[1]));
        libm::sqrt(x * x + y * y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    fn points(count: usize) -> (Vec<Point>, Vec<u64>) {
        let mut random = stream(1, "test/points", 0);
        let points =
            (0..count).map(|_| Point::new(random.range(0.0, 400.0), random.range(0.0, 300.0))).collect();
        (points, (0..count).map(|_| random.bits()).collect())
    }

    /// Shortest distance of two kept points, on a torus.
    fn shortest(points: &[Point], kept: &[usize]) -> f64 {
        let along = |d: f64, period: f64| d.abs().min(period - d.abs());
        let mut least = f64::MAX;
        for (n, &i) in kept.iter().enumerate() {
            for &j in &kept[..n] {
                let d = points[i] - points[j];
                least = least.min(libm::hypot(along(d.x, 400.0), along(d.y, 300.0)));
            }
        }
        least
    }

    #[test]
    fn what_is_left_is_spread_evenly_across_the_seams() {
        let (points, ties) = points(2000);
        for count in [600, 100, 9] {
            let kept = spread(&points, &ties, [Some(400.0), Some(300.0)], count);
            assert_eq!(kept.len(), count);
            assert!(kept.windows(2).all(|w| w[0] < w[1]));
            // In a perfect lattice they would be this far apart.
            let lattice = libm::sqrt(400.0 * 300.0 * 2.0 / (libm::sqrt(3.0) * count as f64));
            let share = shortest(&points, &kept) / lattice;
            assert!(share > 0.5, "{count}: {share}");
        }
    }

    #[test]
    fn any_points_and_numbers_end() {
        let (mut all, ties) = points(50);
        let whole = [None, None];
        assert_eq!(spread(&all, &ties, whole, 50).len(), 50);
        assert_eq!(spread(&all, &ties, whole, 70).len(), 50);
        assert_eq!(spread(&all, &ties, whole, 0).len(), 0);
        all.fill(Point::new(7.0, 7.0));
        assert_eq!(spread(&all, &ties, whole, 20).len(), 20);
        all[3] = Point::new(1e7, -1e7);
        assert!(spread(&all, &ties, [None, Some(0.5)], 20).contains(&3));
        assert_eq!(spread(&[], &[], whole, 3), Vec::<usize>::new());
    }
}
