//! Minimum-cost assignment in a small dense table.
//!
//! Shortest augmenting paths (Jonker and Volgenant 1987), as [`super::super::assign`] does it for sparse
//! tables. The work space is kept from one problem to the next. A problem whose total must exceed a bound is given up
//! before it is solved: the sum of the least costs of its rows is a lower bound.

/// Index of nothing.
pub const NONE: u32 = u32::MAX;

/// A problem, and the work space of its solution.
#[derive(Default)]
pub struct DenseAssignment {
    rows: usize,
    columns: usize,
    /// Costs, row by row.
    costs: Vec<f64>,
    /// Sum of the least costs of the rows so far.
    least: f64,
    /// Cost of a row without a column.
    leave: f64,
    of_row: Vec<u32>,
    of_column: Vec<u32>,
    potential: Vec<f64>,
    distance: Vec<f64>,
    from: Vec<u32>,
    done: Vec<bool>,
    scanned: Vec<u32>,
    /// Entries looked at by all problems.
    pub entries: u64,
}

impl DenseAssignment {
    /// Begins a problem. A row without a column costs `leave`.
    pub fn begin(&mut self, columns: usize, leave: f64) {
        self.columns = columns;
        self.leave = leave;
        self.rows = 0;
        self.least = 0.0;
        self.costs.clear();
    }

    /// Adds a row of costs, one for each column, infinite where there is no entry. Returns the lower bound of the total
    /// of all rows so far.
    pub fn row(&mut self, costs: impl Iterator<Item = f64>) -> f64 {
        let before = self.costs.len();
        self.rows += 1;
        self.costs.extend(costs);
        let least = self.costs[before..].iter().fold(self.leave, |least, c| least.min(*c));
        self.least += least;
        self.least
    }

    /// Solves the problem and returns the least total.
    pub fn solve(&mut self) -> f64 {
        let rows = self.rows;
        self.of_row.clear();
        self.of_row.resize(rows, NONE);
        self.of_column.clear();
        self.of_column.resize(self.columns, NONE);
        self.potential.clear();
        self.potential.resize(self.columns, 0.0);
        self.from.resize(self.columns, 0);
        for row in 0..rows {
            self.augment(row);
        }
        let cost = |(row, column): (usize, &u32)| match *column {
            NONE => self.leave,
            column => self.costs[row * self.columns + column as usize],
        };
        self.of_row.iter().enumerate().map(cost).sum()
    }

    /// The column of each row of the solved problem, or [`NONE`].
    pub fn of_row(&self) -> &[u32] {
        &self.of_row
    }

    fn augment(&mut self, first: usize) {
        let n = self.columns;
        self.distance.clear();
        self.distance.resize(n, f64::INFINITY);
        self.done.clear();
        self.done.resize(n, false);
        self.scanned.clear();
        let (mut row, mut reached, mut own) = (first, 0.0, 0.0);
        let (mut least, mut end) = (self.leave, (first as u32, NONE));
        loop {
            let (mut near, mut nearest) = (f64::INFINITY, NONE);
            let costs = &self.costs[row * n..][..n];
            self.entries += n as u64;
            for c in 0..n {
                if self.done[c] {
                    continue;
                }
                let through = reached + costs[c] - self.potential[c] - own;
                if through < self.distance[c] {
                    self.distance[c] = through;
                    self.from[c] = row as u32;
                }
                if self.distance[c] < near {
                    (near, nearest) = (self.distance[c], c as u32);
                }
            }
            if nearest == NONE || near >= least {
                break;
            }
            let c = nearest as usize;
            if self.of_column[c] == NONE {
                (least, end) = (near, (NONE, nearest));
                break;
            }
            self.done[c] = true;
            self.scanned.push(nearest);
            row = self.of_column[c] as usize;
            reached = near;
            own = self.costs[row * n + c] - self.potential[c];
            if near + self.leave - own < least {
                (least, end) = (near + self.leave - own, (row as u32, NONE));
            }
        }
        for &c in &self.scanned {
            self.potential[c as usize] += self.distance[c as usize].min(least) - least;
        }
        self.take(first as u32, end);
    }

    /// Reassigns the columns along the path from `first` to a row that is left alone, or to a free column.
    fn take(&mut self, first: u32, (row, column): (u32, u32)) {
        let mut next = column;
        if row != NONE {
            next = std::mem::replace(&mut self.of_row[row as usize], NONE);
            if row == first {
                return;
            }
        }
        while next != NONE {
            let row = self.from[next as usize];
            self.of_column[next as usize] = row;
            next = std::mem::replace(&mut self.of_row[row as usize], next);
            if row == first {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::assign::{Table, assign};
    use super::*;
    use crate::sampling::stream;

    #[test]
    fn totals_are_those_of_the_sparse_assignment() {
        let mut random = stream(1, "geometry/dense test", 0);
        let mut dense = DenseAssignment::default();
        for case in 0..300u64 {
            let [rows, columns] = [random.index(12), random.index(13)];
            let leave = 1 + random.below(60) as i64;
            let cost = |random: &mut crate::sampling::Stream| {
                if random.chance(0.2) { None } else { Some(random.below(50) as i64) }
            };
            let table: Vec<Vec<Option<i64>>> =
                (0..rows).map(|_| (0..columns).map(|_| cost(&mut random)).collect()).collect();
            dense.begin(columns, leave as f64);
            let mut bound = 0.0;
            for row in &table {
                bound = dense.row(row.iter().map(|c| c.map_or(f64::INFINITY, |c| c as f64)));
            }
            let total = dense.solve();
            let entries = |row: &Vec<Option<i64>>| {
                row.iter().enumerate().filter_map(|(c, v)| v.map(|v| (c as u32, v))).collect::<Vec<_>>()
            };
            let sparse = assign(&Table::new(table.iter().map(entries).collect()), columns, leave);
            let of = |(row, c): (&Vec<Option<i64>>, &Option<u32>)| {
                c.and_then(|c| row[c as usize]).unwrap_or(leave)
            };
            let wanted: i64 = table.iter().zip(&sparse).map(of).sum();
            assert!((total - wanted as f64).abs() < 1e-9, "case {case}: {total} {wanted}");
            assert!(bound <= total + 1e-9);
            assert_eq!(dense.of_row().len(), rows);
            let mut taken: Vec<u32> = dense.of_row().iter().copied().filter(|c| *c != NONE).collect();
            taken.sort_unstable();
            assert!(taken.windows(2).all(|w| w[0] != w[1]));
        }
    }
}
