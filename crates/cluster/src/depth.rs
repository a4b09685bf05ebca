//! Painting order by preferences (equations 5 to 8 of the paper).
//!
//! The paper orders greedily by the balance of preferences on either side (Cohen, Schapire and Singer 1998). In the
//! middle of rows of scales all balances are 0, and the rows come out mixed. Here the next is always the one that misses
//! the least beneath it, so that preferences which do not contradict each other are all kept.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Steps of preferences.
const STEPS: f64 = 1e6;

/// An order, bottom first, of `count` things that agrees with most preferences, and with all if some order does. A
/// preference of a pair says how sure it is that the first lies beneath the second, 0 to 1. Of equally good ones the
/// first comes first.
pub(crate) fn ordered(count: usize, preferences: &BTreeMap<[u32; 2], f64>) -> Vec<u32> {
    // What should lie beneath each and is not there yet, and the others that wait for it.
    let mut missing = vec![0i64; count];
    let mut waiting: Vec<Vec<(u32, i64)>> = vec![Vec::new(); count];
    for (&[a, b], sure) in preferences {
        // Of pairs that nothing is known of, neither is preferred.
        let by = ((2.0 * sure - 1.0) * STEPS) as i64;
        let [beneath, above] = if by > 0 { [a, b] } else { [b, a] };
        missing[above as usize] += by.abs();
        waiting[beneath as usize].push((above, by.abs()));
    }
    let mut queue: BinaryHeap<Reverse<(i64, u32)>> =
        (0..count as u32).map(|i| Reverse((missing[i as usize], i))).collect();
    let mut done = vec![false; count];
    let mut order = Vec::with_capacity(count);
    while let Some(Reverse((was, i))) = queue.pop() {
        if done[i as usize] || was != missing[i as usize] {
            continue;
        }
        done[i as usize] = true;
        order.push(i);
        for &(above, by) in &waiting[i as usize] {
            if !done[above as usize] {
                missing[above as usize] -= by;
                queue.push(Reverse((missing[above as usize], above)));
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_come_out_in_order() {
        let mut preferences = BTreeMap::new();
        for k in 0..9u32 {
            // 9 beneath 8 beneath 7 …
            preferences.insert([k, k + 1], 0.1);
        }
        let order = ordered(11, &preferences);
        let at = |i: u32| order.iter().position(|o| *o == i).unwrap();
        assert!((0..9).all(|k| at(k + 1) < at(k)), "{order:?}");
        assert_eq!(ordered(3, &BTreeMap::new()), [0, 1, 2]);
    }

    #[test]
    fn rows_of_scales_stay_rows() {
        // Numbers are mixed; each scale lies beneath the two of the next row that it touches, and the one below them.
        let (rows, columns) = (7u32, 6u32);
        let number = |row: u32, column: u32| (row * columns + column) * 11 % (rows * columns);
        let mut preferences = BTreeMap::new();
        for row in 0..rows {
            for column in 0..columns {
                let side = if row % 2 == 0 { column.checked_sub(1) } else { Some(column + 1) };
                let next = [(row + 1, Some(column)), (row + 1, side), (row + 2, Some(column))];
                for (down, across) in next {
                    let Some(across) = across.filter(|c| *c < columns && down < rows) else { continue };
                    let [a, b] = [number(row, column), number(down, across)];
                    preferences.insert([a.min(b), a.max(b)], if a < b { 0.9 } else { 0.1 });
                }
            }
        }
        let order = ordered((rows * columns) as usize, &preferences);
        let mut at = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, i)| at[*i as usize] = k);
        for (&[a, b], sure) in &preferences {
            assert_eq!(at[a as usize] < at[b as usize], *sure > 0.5, "{a} {b} {order:?}");
        }
    }

    #[test]
    fn a_ring_is_cut_where_it_is_least_sure() {
        let preferences = BTreeMap::from([([0, 1], 0.9), ([1, 2], 0.9), ([0, 2], 0.4)]);
        assert_eq!(ordered(3, &preferences), [0, 1, 2]);
    }
}
