//! Fair assignment of windows (the paper, §3.2): all windows of the exemplar are used equally often.

use super::patches::{BorderWindows, best_turn};
use std::collections::BTreeMap;
use vtex_base::parallel;
use vtex_base::sampling::Stream;

/// The window that is assigned to a window of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Assigned {
    /// Index of the exemplar's window.
    pub(super) patch: u32,
    /// Rotation of that window, in quarter turns.
    pub(super) turn: u8,
    /// Number of pixels in which the two differ.
    pub(super) cost: u32,
}

/// Assigns a window of the exemplar to each of the n windows of a region. Each of the m exemplar windows is
/// used ⌊n/m⌋ times; a random selection is used once more to make up the rest. In each round, every
/// exemplar window proposes to the nearest free windows, as many as its remaining uses. Of several
/// proposals the nearest wins.
pub(super) fn assign(
    region: &BorderWindows,
    exemplar: &BorderWindows,
    turns: &[usize],
    random: &mut Stream,
) -> Vec<Assigned> {
    let (wanted, known) = (region.len(), exemplar.len());
    if wanted == 0 || known == 0 {
        return Vec::new();
    }
    let mut copies = vec![wanted / known; known];
    let mut order: Vec<usize> = (0..known).collect();
    random.shuffle(&mut order);
    order[..wanted % known].iter().for_each(|&e| copies[e] += 1);
    let mut assigned: Vec<Option<Assigned>> = vec![None; wanted];
    let mut free: Vec<u32> = (0..wanted as u32).collect();
    while !free.is_empty() {
        let proposing: Vec<usize> = (0..known).filter(|&e| copies[e] > 0).collect();
        let proposals = parallel::map(&proposing, |&e| nearest(exemplar, e, region, &free, copies[e], turns));
        // The best proposal to each window; ties go to the first.
        let mut best: BTreeMap<u32, (u32, usize, usize)> = BTreeMap::new();
        for (&e, list) in proposing.iter().zip(&proposals) {
            for &(cost, s, turn) in list {
                let offer = (cost, e, turn);
                best.entry(s).and_modify(|old| *old = (*old).min(offer)).or_insert(offer);
            }
        }
        for (&s, &(cost, e, turn)) in &best {
            assigned[s as usize] = Some(Assigned { patch: e as u32, turn: turn as u8, cost });
            copies[e] -= 1;
        }
        free.retain(|&s| assigned[s as usize].is_none());
    }
    assigned.into_iter().flatten().collect()
}

/// The `count` free windows of a region most similar to a window of the exemplar: the number of different
/// pixels, the index and the rotation.
fn nearest(
    exemplar: &BorderWindows,
    e: usize,
    region: &BorderWindows,
    free: &[u32],
    count: usize,
    turns: &[usize],
) -> Vec<(u32, u32, usize)> {
    let cost = |&s: &u32| {
        let (cost, turn) = best_turn(&region.windows[s as usize][0], &exemplar.windows[e], turns);
        (cost, s, turn)
    };
    if count == 1 {
        return free.iter().map(cost).min().into_iter().collect();
    }
    let mut all: Vec<_> = free.iter().map(cost).collect();
    let count = count.min(all.len());
    all.select_nth_unstable(count - 1);
    all.truncate(count);
    all
}

#[cfg(test)]
mod tests {
    use super::super::super::map::LayerRegion;
    use super::super::super::testing::nested;
    use super::*;
    use vtex_base::geometry::{Table, assign as exact};
    use vtex_base::sampling::stream;

    fn patches(size: [usize; 2], seed: u64) -> BorderWindows {
        let inside = nested(size, 2, seed).labels.iter().map(|&l| l == 1).collect();
        BorderWindows::new(&LayerRegion { size, wrap: [false; 2], inside }, 15)
    }

    /// The first windows of a set.
    fn first(mut all: BorderWindows, count: usize) -> BorderWindows {
        all.at.truncate(count);
        all.windows.truncate(count);
        all
    }

    #[test]
    fn every_window_is_used_as_often() {
        let (region, exemplar) = (patches([150, 120], 1), patches([60, 60], 2));
        let found = assign(&region, &exemplar, &[0, 1, 2, 3], &mut stream(1, "test", 0));
        assert_eq!(found.len(), region.len());
        let mut uses = vec![0; exemplar.len()];
        found.iter().for_each(|a| uses[a.patch as usize] += 1);
        let least = region.len() / exemplar.len();
        assert!(uses.iter().all(|&n| n == least || n == least + 1), "{uses:?}");
        for (window, a) in region.windows.iter().zip(&found) {
            let other = &exemplar.windows[a.patch as usize];
            assert_eq!(best_turn(&window[0], other, &[0, 1, 2, 3]).0, a.cost);
        }
    }

    #[test]
    fn the_cost_is_near_the_least() {
        let (region, exemplar) = (first(patches([90, 90], 3), 200), first(patches([90, 90], 4), 200));
        let found = assign(&region, &exemplar, &[0, 1, 2, 3], &mut stream(1, "test", 0));
        let greedy: i64 = found.iter().map(|a| i64::from(a.cost)).sum();
        let row = |window: &[super::super::patches::Window; 4]| {
            let cost = |e: usize| i64::from(best_turn(&window[0], &exemplar.windows[e], &[0, 1, 2, 3]).0);
            (0..exemplar.len()).map(|e| (e as u32, cost(e))).collect()
        };
        let table: Vec<Vec<(u32, i64)>> = region.windows.iter().map(row).collect();
        let partners = exact(&Table::new(table.clone()), exemplar.len(), 1 << 40);
        let least: i64 = partners.iter().zip(&table).map(|(e, row)| row[e.unwrap() as usize].1).sum();
        assert!(greedy as f64 <= 1.3 * least as f64, "{greedy} {least}");
    }

    #[test]
    fn nothing_to_assign() {
        let (some, none) = (patches([40, 40], 1), first(patches([40, 40], 1), 0));
        assert!(assign(&none, &some, &[0], &mut stream(1, "test", 0)).is_empty());
        assert!(assign(&some, &none, &[0], &mut stream(1, "test", 0)).is_empty());
    }
}
