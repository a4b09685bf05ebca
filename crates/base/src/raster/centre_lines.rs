//! Centre lines of thin painted areas: thinning after Zhang and Suen (1984), spurs pruned, lines smoothed.

use crate::disjoint_sets::DisjointSets;
use crate::error::Result;
use crate::geometry::plane::{PeriodicPlane, along, length};
use std::collections::BTreeMap;

/// Longest spur, and longest piece between two junctions that are one, in widths of the area.
const SPUR: f64 = 1.0;
const ONE_JUNCTION: f64 = 0.9;
/// Passes of smoothing, the reach of each in widths, and how far a point may move from the middle of its cell. Where a
/// line is nearly level its cells go on for many widths on one row: only long reaches see its slope.
const PASSES: usize = 12;
const SMOOTHED: f64 = 1.0;
const MOVED: f64 = 0.7;

/// Painted cells of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Ink {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The axes along which the page repeats.
    pub wraps: [bool; 2],
    /// The cells, row by row.
    pub cells: Vec<bool>,
}

/// A line through the middles of cells, and whether it is closed.
pub type CentreLine = (Vec<[f64; 2]>, bool);

/// The centre lines of painted areas, in cells, and their mean width. What reaches the border of a page that does not
/// repeat is led up to `rim` cells beyond it, so that thinning does not shorten it. Lines may lead beyond a page that
/// repeats, too.
///
/// # Errors
/// Those of `go_on`.
pub fn centre_lines(ink: &Ink, rim: usize, go_on: &dyn Fn() -> Result<()>) -> Result<(Vec<CentreLine>, f64)> {
    let rim = ink.wraps.map(|wraps| if wraps { 0 } else { rim });
    let ink = extended(ink, rim);
    let area = ink.cells.iter().filter(|c| **c).count() as f64;
    let thin = thinned(&ink, go_on)?;
    let paths = paths(&thin);
    let total: f64 = paths.iter().map(|p| along(&p.points)).sum();
    let width = if total > 0.0 { area / total } else { 0.0 };
    go_on()?;
    let paths = joined(pruned(paths, width), &thin, width);
    let reach = libm::round(SMOOTHED * width).max(1.0) as usize;
    let lines = paths.into_iter().map(|p| {
        let points = smoothed(p.points, p.closed, reach);
        // A line round the page ends where it begins only once it is wrapped.
        let closed = p.closed && points.first() == points.last();
        (points, closed)
    });
    let mut lines: Vec<CentreLine> = lines.collect();
    let total: f64 = lines.iter().map(|l| along(&l.0)).sum();
    for point in lines.iter_mut().flat_map(|l| &mut l.0) {
        *point = [point[0] - rim[0] as f64, point[1] - rim[1] as f64];
    }
    Ok((lines, if total > 0.0 { area / total } else { 0.0 }))
}

/// The ink of a page with a rim, in which the cells next to the border go on.
fn extended(ink: &Ink, rim: [usize; 2]) -> Ink {
    let size = [0, 1].map(|k| ink.size[k] + 2 * rim[k]);
    // The outermost cells, which are often half painted, do not count.
    let inner = |v: usize, k: usize| {
        let (low, high) = (1.min(ink.size[k] - 1), ink.size[k].saturating_sub(2));
        if rim[k] == 0 { v } else { v.saturating_sub(rim[k]).clamp(low, high.max(low)) }
    };
    let columns: Vec<usize> = (0..size[0]).map(|x| inner(x, 0)).collect();
    let cells = (0..size[1]).flat_map(|y| {
        let row = inner(y, 1) * ink.size[0];
        columns.iter().map(move |x| ink.cells[row + x])
    });
    Ink { size, wraps: ink.wraps, cells: cells.collect() }
}

/// A path over cells from node to node.
struct CellPath {
    points: Vec<[f64; 2]>,
    closed: bool,
    /// The cells at its ends.
    ends: [usize; 2],
}

impl Ink {
    /// The cell at an offset, if it is on the page.
    fn beside(&self, cell: usize, [dx, dy]: [i64; 2]) -> Option<usize> {
        let at = [cell % self.size[0], cell / self.size[0]];
        let mut to = [0; 2];
        for (k, d) in [dx, dy].into_iter().enumerate() {
            let v = at[k] as i64 + d;
            to[k] = match (0..self.size[k] as i64).contains(&v) {
                true => v as usize,
                false if self.wraps[k] => v.rem_euclid(self.size[k] as i64) as usize,
                false => return None,
            };
        }
        Some(to[1] * self.size[0] + to[0])
    }

    fn is_painted(&self, cell: usize, by: [i64; 2]) -> bool {
        self.beside(cell, by).is_some_and(|c| self.cells[c])
    }

    fn middle(&self, cell: usize) -> [f64; 2] {
        [(cell % self.size[0]) as f64 + 0.5, (cell / self.size[0]) as f64 + 0.5]
    }

    /// The neighbours of a thin line's cell: diagonal ones only where no straight step leads to them.
    fn linked(&self, cell: usize) -> Vec<usize> {
        let mut all = Vec::new();
        for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            if self.is_painted(cell, [dx, dy]) {
                all.extend(self.beside(cell, [dx, dy]));
            }
        }
        for (dx, dy) in [(1, 1), (-1, 1), (-1, -1), (1, -1)] {
            let straight = self.is_painted(cell, [dx, 0]) || self.is_painted(cell, [0, dy]);
            if !straight && self.is_painted(cell, [dx, dy]) {
                all.extend(self.beside(cell, [dx, dy]));
            }
        }
        all
    }
}

/// The eight neighbours, clockwise from above.
const AROUND: [[i64; 2]; 8] = [[0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1]];

/// Ink thinned to lines one cell wide, by the algorithm of Zhang and Suen (1984). A cell may go only once one beside it is
/// unpainted, so only such cells are looked at.
fn thinned(ink: &Ink, go_on: &dyn Fn() -> Result<()>) -> Result<Ink> {
    let mut thin = ink.clone();
    let is_edge = |cell: &usize| thin.cells[*cell] && AROUND.iter().any(|by| !thin.is_painted(*cell, *by));
    let mut edge: Vec<usize> = (0..thin.cells.len()).filter(is_edge).collect();
    let mut is_listed = vec![false; thin.cells.len()];
    edge.iter().for_each(|cell| is_listed[*cell] = true);
    loop {
        let mut is_done = true;
        for second in [false, true] {
            go_on()?;
            let goes = |&cell: &usize| {
                let p = AROUND.map(|by| thin.is_painted(cell, by));
                let count = p.iter().filter(|v| **v).count();
                let rises = (0..8).filter(|&k| !p[k] && p[(k + 1) % 8]).count();
                let [north, _, east, _, south, _, west, _] = p;
                let open = if second {
                    !(north && west && (east || south))
                } else {
                    !(east && south && (north || west))
                };
                (2..=6).contains(&count) && rises == 1 && open
            };
            let goes = crate::parallel::map(&edge, goes);
            let gone: Vec<usize> = edge.iter().zip(&goes).filter(|p| *p.1).map(|p| *p.0).collect();
            edge = edge.into_iter().zip(goes).filter(|p| !p.1).map(|p| p.0).collect();
            gone.iter().for_each(|cell| thin.cells[*cell] = false);
            is_done &= gone.is_empty();
            for beside in gone.iter().flat_map(|cell| AROUND.map(|by| thin.beside(*cell, by))).flatten() {
                if thin.cells[beside] && !std::mem::replace(&mut is_listed[beside], true) {
                    edge.push(beside);
                }
            }
        }
        if is_done {
            return Ok(thin);
        }
    }
}

/// The paths between nodes, then those without nodes.
fn paths(thin: &Ink) -> Vec<CellPath> {
    let plane = PeriodicPlane { size: thin.size.map(|v| v as f64), wraps: thin.wraps };
    let cells: Vec<usize> = (0..thin.cells.len()).filter(|c| thin.cells[*c]).collect();
    let linked: BTreeMap<usize, Vec<usize>> = cells.iter().map(|c| (*c, thin.linked(*c))).collect();
    let mut used: std::collections::BTreeSet<(usize, usize)> = std::collections::BTreeSet::new();
    let mut paths = Vec::new();
    for closed in [false, true] {
        for &first in &cells {
            if closed == (linked[&first].len() != 2) {
                continue;
            }
            for &next in &linked[&first] {
                if used.contains(&(first, next)) {
                    continue;
                }
                let mut points = vec![thin.middle(first)];
                let (mut from, mut at) = (first, next);
                loop {
                    used.insert((from, at));
                    used.insert((at, from));
                    let last = points[points.len() - 1];
                    let way = plane.between(plane.wrapped(last), thin.middle(at));
                    points.push([last[0] + way[0], last[1] + way[1]]);
                    let on = linked[&at].iter().find(|c| **c != from && !used.contains(&(at, **c)));
                    match on {
                        Some(&on) if linked[&at].len() == 2 && at != first => (from, at) = (at, on),
                        _ => break,
                    }
                }
                let closed = closed && at == first;
                paths.push(CellPath { points, closed, ends: [first, at] });
            }
        }
    }
    paths
}

/// The paths without short spurs.
fn pruned(mut paths: Vec<CellPath>, width: f64) -> Vec<CellPath> {
    let mut ends: BTreeMap<usize, usize> = BTreeMap::new();
    paths.iter().flat_map(|p| p.ends).for_each(|e| *ends.entry(e).or_default() += 1);
    paths.retain(|p| {
        let [a, b] = p.ends.map(|e| ends[&e]);
        let spur = !p.closed && a.min(b) == 1 && a.max(b) > 2;
        !(spur && along(&p.points) < SPUR * width)
    });
    paths
}

/// The paths with junctions near one another made one.
fn joined(paths: Vec<CellPath>, thin: &Ink, width: f64) -> Vec<CellPath> {
    let plane = PeriodicPlane { size: thin.size.map(|v| v as f64), wraps: thin.wraps };
    let mut ids: Vec<usize> = paths.iter().flat_map(|p| p.ends).collect();
    ids.sort_unstable();
    let counts: BTreeMap<usize, usize> = ids.chunk_by(|a, b| a == b).map(|c| (c[0], c.len())).collect();
    ids.dedup();
    let number = |cell: usize| ids.partition_point(|c| *c < cell);
    let mut sets = DisjointSets::new(ids.len());
    let inner = |p: &CellPath| {
        let [a, b] = p.ends;
        let junctions = counts[&a] > 2 && counts[&b] > 2;
        junctions && !p.closed && along(&p.points) < ONE_JUNCTION * width
    };
    for path in paths.iter().filter(|p| inner(p)) {
        sets.join(number(path.ends[0]), number(path.ends[1]));
    }
    // Mean place of each set, as ways from its root's cell.
    let mut sums: Vec<([f64; 2], f64)> = vec![([0.0; 2], 0.0); ids.len()];
    for (k, cell) in ids.iter().enumerate() {
        let root = sets.root(k);
        let way = plane.between(thin.middle(ids[root]), thin.middle(*cell));
        let (sum, count) = &mut sums[root];
        *sum = [sum[0] + way[0], sum[1] + way[1]];
        *count += 1.0;
    }
    let mut moved = |cell: usize, at: [f64; 2]| {
        let root = sets.root(number(cell));
        let (sum, count) = sums[root];
        let from = plane.between(thin.middle(cell), thin.middle(ids[root]));
        [at[0] + from[0] + sum[0] / count, at[1] + from[1] + sum[1] / count]
    };
    let mut kept = Vec::new();
    for mut path in paths {
        if inner(&path) {
            continue;
        }
        if !path.closed {
            let n = path.points.len();
            let ends = [path.points[0], path.points[n - 1]];
            let to = [moved(path.ends[0], ends[0]), moved(path.ends[1], ends[1])];
            // Points that the moved ends have passed are left out.
            let far = [0, 1].map(|k| length([to[k][0] - ends[k][0], to[k][1] - ends[k][1]]));
            let apart = |p: &[f64; 2], k: usize| {
                far[k] == 0.0 || length([p[0] - ends[k][0], p[1] - ends[k][1]]) > 1.5 * far[k]
            };
            let inner: Vec<[f64; 2]> =
                path.points[1..n - 1].iter().filter(|p| apart(p, 0) && apart(p, 1)).copied().collect();
            path.points = std::iter::once(to[0]).chain(inner).chain([to[1]]).collect();
        }
        kept.push(path);
    }
    kept
}

/// A line with the steps of the grid smoothed; its ends stay, and no point leaves its cell by far.
fn smoothed(cells: Vec<[f64; 2]>, closed: bool, reach: usize) -> Vec<[f64; 2]> {
    let n = cells.len();
    if n < 3 {
        return cells;
    }
    let mut points = cells.clone();
    // A closed line ends a whole number of periods from its beginning.
    let round = [points[n - 1][0] - points[0][0], points[n - 1][1] - points[0][1]];
    for _ in 0..PASSES {
        let at = |k: i64| {
            let last = n as i64 - 1;
            let turns = k.div_euclid(last);
            let p = points[k.rem_euclid(last) as usize];
            [p[0] + turns as f64 * round[0], p[1] + turns as f64 * round[1]]
        };
        let mean = |k: usize| {
            let reach = if closed { reach } else { reach.min(k).min(n - 1 - k) } as i64;
            let mut sum = [0.0; 2];
            for d in -reach..=reach {
                let p = if closed { at(k as i64 + d) } else { points[(k as i64 + d) as usize] };
                sum = [sum[0] + p[0], sum[1] + p[1]];
            }
            let mean = sum.map(|v| v / (2 * reach + 1) as f64);
            let by = [mean[0] - cells[k][0], mean[1] - cells[k][1]];
            let share = (MOVED / length(by).max(1e-9)).min(1.0);
            [cells[k][0] + share * by[0], cells[k][1] + share * by[1]]
        };
        points = (0..n).map(mean).collect();
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_run_round_the_page_and_meet() {
        // A band of six cells along each axis, and a bar of five by thirty.
        let mut ink = Ink { size: [120, 100], wraps: [true; 2], cells: vec![false; 12000] };
        for (x, y) in (0..100).flat_map(|y| (0..120).map(move |x| (x, y))) {
            let bar = (80..110).contains(&x) && (70..75).contains(&y);
            ink.cells[y * 120 + x] = (20..26).contains(&y) || (40..46).contains(&x) || bar;
        }
        let (lines, width) = centre_lines(&ink, 40, &|| Ok(())).unwrap();
        assert!((width - 6.0).abs() < 0.5, "{width}");
        let total: f64 = lines.iter().map(|l| along(&l.0)).sum();
        assert!((total - 220.0 - 26.0).abs() < 4.0, "{total}");
        let plane = PeriodicPlane { size: [120.0, 100.0], wraps: [true; 2] };
        let is_crossing = |p: &[f64; 2]| length(plane.between(*p, [43.0, 23.0])) < 1.5;
        let ends: Vec<[f64; 2]> = lines.iter().flat_map(|l| [l.0[0], l.0[l.0.len() - 1]]).collect();
        assert_eq!(ends.iter().filter(|p| is_crossing(p)).count(), 4, "{ends:?}");
        assert_eq!(ends.len(), 6);
    }

    #[test]
    fn lines_lead_over_the_border_of_a_page_that_ends() {
        let mut ink = Ink { size: [60, 40], wraps: [false; 2], cells: vec![false; 2400] };
        (0..2400).filter(|i| (18..23).contains(&(i / 60))).for_each(|i| ink.cells[i] = true);
        let (lines, _) = centre_lines(&ink, 20, &|| Ok(())).unwrap();
        let [(points, false)] = &lines[..] else { panic!("{lines:?}") };
        let mut ends = [points[0][0], points[points.len() - 1][0]];
        ends.sort_by(f64::total_cmp);
        assert!(ends[0] < -10.0 && ends[1] > 70.0, "{ends:?}");
        assert!(points.iter().all(|p| (p[1] - 20.5).abs() < 0.6), "{points:?}");
    }
}
