//! Painting order by preferences (equations 5 to 8 of the paper; Cohen, Schapire and Singer 1998).

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Steps of preferences.
const STEPS: f64 = 1e6;

/// An order, bottom first, of `count` things that agrees with most preferences. A preference of a pair says how sure it
/// is that the first lies beneath the second, 0 to 1. Of equally good ones the first comes first.
pub(crate) fn ordered(count: usize, preferences: &BTreeMap<[u32; 2], f64>) -> Vec<u32> {
    let mut value = vec![0i64; count];
    let mut partners: Vec<Vec<(u32, i64)>> = vec![Vec::new(); count];
    for (&[a, b], sure) in preferences {
        // Of pairs that nothing is known of, neither is preferred.
        let by = ((2.0 * sure - 1.0) * STEPS) as i64;
        value[a as usize] += by;
        value[b as usize] -= by;
        partners[a as usize].push((b, -by));
        partners[b as usize].push((a, by));
    }
    let mut queue: BinaryHeap<(i64, Reverse<u32>)> =
        (0..count as u32).map(|i| (value[i as usize], Reverse(i))).collect();
    let mut done = vec![false; count];
    let mut order = Vec::with_capacity(count);
    while let Some((was, Reverse(i))) = queue.pop() {
        if done[i as usize] || was != value[i as usize] {
            continue;
        }
        done[i as usize] = true;
        order.push(i);
        for &(other, by) in &partners[i as usize] {
            if !done[other as usize] {
                // Its value loses what it owes to the pair with this one.
                value[other as usize] -= by;
                queue.push((value[other as usize], Reverse(other)));
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
}
