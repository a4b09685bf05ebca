//! Minimum-cost assignment of rows to columns in a sparse cost table. Rows may stay unassigned.
//!
//! Shortest augmenting paths with column potentials (Jonker and Volgenant 1987); each path is found by
//! Dijkstra's algorithm over the existing entries. A search ends at a free column, or where leaving
//! a row unassigned is as cheap, so it stays local. The result is exact for the entries given. Costs
//! are integers, so there is no rounding.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A sparse cost table, stored row by row.
#[derive(Default)]
pub struct Table {
    /// The entries of row i are `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    /// Column and cost, at least 0.
    entries: Vec<(u32, i64)>,
}

impl Table {
    /// Builds the table from the entries of each row.
    pub fn new(rows: Vec<Vec<(u32, i64)>>) -> Self {
        let mut starts = vec![0];
        let mut entries = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        for row in rows {
            entries.extend(row);
            starts.push(entries.len());
        }
        Self { starts, entries }
    }

    fn row(&self, row: usize) -> &[(u32, i64)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }
}

/// State of a column.
#[derive(Clone, Copy)]
struct Column {
    /// The row assigned to it.
    row: Option<u32>,
    /// Dual potential, at most 0.
    potential: i64,
    /// The last search that reached it, its distance in that search, and the row it was reached from.
    seen: u32,
    distance: i64,
    from: u32,
    done: bool,
}

/// The column assigned to each row, for the least total cost. An unassigned row costs `none`.
/// `columns` is the number of columns.
pub fn assign(table: &Table, columns: usize, none: i64) -> Vec<Option<u32>> {
    let rows = table.starts.len().saturating_sub(1);
    let fresh = Column { row: None, potential: 0, seen: 0, distance: 0, from: 0, done: false };
    let mut solver =
        Solver { table, columns: vec![fresh; columns], own: vec![None; rows], none, heap: BinaryHeap::new() };
    for row in 0..rows {
        solver.augment(row as u32);
    }
    solver.own.iter().map(|own| own.map(|(column, _)| column)).collect()
}

struct Solver<'a> {
    table: &'a Table,
    columns: Vec<Column>,
    /// The column assigned to each row, with its cost.
    own: Vec<Option<(u32, i64)>>,
    none: i64,
    heap: BinaryHeap<Reverse<(i64, u32)>>,
}

/// Where a search ends: at a free column, or at a row that becomes unassigned.
enum End {
    Column(u32),
    Row(u32),
}

impl Solver<'_> {
    /// Adds one row to the assignment and keeps the total cost minimal.
    fn augment(&mut self, first: u32) {
        self.heap.clear();
        let search = first + 1;
        let mut scanned: Vec<u32> = Vec::new();
        let (mut least, mut end) = (self.none, End::Row(first));
        self.scan(first, search, 0, 0, least);
        while let Some(Reverse((distance, column))) = self.heap.pop() {
            if distance >= least {
                break;
            }
            let found = &mut self.columns[column as usize];
            if found.done || found.distance != distance {
                continue;
            }
            found.done = true;
            let Some(row) = found.row else {
                (least, end) = (distance, End::Column(column));
                break;
            };
            let potential = found.potential;
            scanned.push(column);
            // An assigned row already pays the cost of its column.
            let own = self.own[row as usize].map_or(0, |(_, cost)| cost) - potential;
            if distance + self.none - own < least {
                (least, end) = (distance + self.none - own, End::Row(row));
            }
            self.scan(row, search, distance, own, least);
        }
        for column in scanned {
            let column = &mut self.columns[column as usize];
            column.potential += column.distance.min(least) - least;
        }
        self.take(first, end);
    }

    /// Relaxes the entries of a row reached at `distance`; `own` is the reduced cost of its own column.
    fn scan(&mut self, row: u32, search: u32, distance: i64, own: i64, least: i64) {
        for &(column, cost) in self.table.row(row as usize) {
            let there = &mut self.columns[column as usize];
            let through = distance + cost - there.potential - own;
            if through >= least || there.seen == search && (there.done || there.distance <= through) {
                continue;
            }
            (there.seen, there.distance, there.from, there.done) = (search, through, row, false);
            self.heap.push(Reverse((through, column)));
        }
    }

    /// Reassigns the columns along the path from `first` to `end`.
    fn take(&mut self, first: u32, end: End) {
        let mut next = match end {
            End::Row(row) => {
                let left = self.own[row as usize].take();
                if row == first {
                    return;
                }
                left.map(|(column, _)| column)
            }
            End::Column(column) => Some(column),
        };
        while let Some(column) = next {
            let row = self.columns[column as usize].from;
            let cost = self.table.row(row as usize).iter().find(|e| e.0 == column).map_or(0, |e| e.1);
            next = self.own[row as usize].replace((column, cost)).map(|(before, _)| before);
            self.columns[column as usize].row = Some(row);
            if row == first {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least total cost by exhaustive search.
    fn least(rows: &[Vec<(u32, i64)>], taken: &mut Vec<u32>, none: i64) -> i64 {
        let Some((row, rest)) = rows.split_first() else { return 0 };
        let mut best = none + least(rest, taken, none);
        for &(column, cost) in row {
            if !taken.contains(&column) {
                taken.push(column);
                best = best.min(cost + least(rest, taken, none));
                taken.pop();
            }
        }
        best
    }

    proptest! {
        #[test]
        fn no_assignment_is_cheaper(
            costs in prop::collection::vec(prop::collection::vec(prop::option::of(0..40i64), 5), 1..7),
            none in 1..40i64,
        ) {
            let rows: Vec<Vec<(u32, i64)>> = costs.iter()
                .map(|row| row.iter().enumerate().filter_map(|(c, v)| v.map(|v| (c as u32, v))).collect())
                .collect();
            let wanted = least(&rows, &mut Vec::new(), none);
            let table = Table::new(rows.clone());
            let found = assign(&table, 5, none);
            let mut columns: Vec<u32> = found.iter().flatten().copied().collect();
            columns.sort_unstable();
            prop_assert!(columns.windows(2).all(|w| w[0] != w[1]), "a column is taken twice");
            let cost = |(row, own): (&Vec<(u32, i64)>, &Option<u32>)| match own {
                Some(column) => row.iter().find(|e| e.0 == *column).unwrap().1,
                None => none,
            };
            prop_assert_eq!(rows.iter().zip(&found).map(cost).sum::<i64>(), wanted);
        }
    }

    #[test]
    fn a_tie_is_broken_alike_and_nothing_gives_nothing() {
        let table = Table::new(vec![vec![(0, 5), (1, 5)], vec![(0, 5), (1, 5)]]);
        assert_eq!(assign(&table, 2, 100), [Some(0), Some(1)]);
        assert!(assign(&Table::new(Vec::new()), 0, 1).is_empty());
        assert_eq!(assign(&Table::new(vec![Vec::new()]), 0, 1), [None]);
    }
}
