//! Integer weights with fast sums: draws in proportion, changes in logarithmic time.

use crate::sampling::Stream;

/// Weights in a Fenwick tree (1994). Integers, so the order of changes leaves no trace.
#[derive(Clone, Debug, Default)]
pub struct WeightTree {
    values: Vec<u64>,
    /// Entry i (from 1) sums the last `i & -i` values up to value i - 1.
    tree: Vec<u64>,
    total: u64,
}

impl WeightTree {
    /// `count` weights of zero.
    pub fn zeros(count: usize) -> Self {
        Self { values: vec![0; count], tree: vec![0; count + 1], total: 0 }
    }

    /// Appends a weight.
    pub fn push(&mut self, value: u64) {
        if self.tree.is_empty() {
            self.tree.push(0);
        }
        self.values.push(0);
        let i = self.values.len();
        let mut sum = 0;
        let mut j = i - 1;
        while j > i - lowest_bit(i) {
            sum += self.tree[j];
            j -= lowest_bit(j);
        }
        self.tree.push(sum);
        self.set(i - 1, value);
    }

    /// Changes a weight.
    pub fn set(&mut self, index: usize, value: u64) {
        let old = std::mem::replace(&mut self.values[index], value);
        if old == value {
            return;
        }
        self.total = self.total - old + value;
        let mut i = index + 1;
        while i < self.tree.len() {
            self.tree[i] = self.tree[i] - old + value;
            i += lowest_bit(i);
        }
    }

    /// A weight.
    pub fn get(&self, index: usize) -> u64 {
        self.values[index]
    }

    /// An index drawn in proportion to the weights; `None` if all are zero.
    pub fn draw(&self, random: &mut Stream) -> Option<usize> {
        (self.total > 0).then(|| self.find(random.below(self.total)))
    }

    /// The index at which the running sum first exceeds `target`, which is below the total.
    fn find(&self, mut target: u64) -> usize {
        let mut at = 0;
        let mut step = self.values.len().next_power_of_two();
        while step > 0 {
            let next = at + step;
            if next < self.tree.len() && self.tree[next] <= target {
                target -= self.tree[next];
                at = next;
            }
            step /= 2;
        }
        at
    }
}

fn lowest_bit(i: usize) -> usize {
    i & i.wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_as_a_plain_scan_does(
            start in prop::collection::vec(0..9u64, 0..40),
            changes in prop::collection::vec((0..40usize, 0..9u64), 0..40),
        ) {
            let mut sums = WeightTree::default();
            start.iter().for_each(|&v| sums.push(v));
            let mut plain = start.clone();
            for (i, v) in changes {
                if i < plain.len() {
                    sums.set(i, v);
                    plain[i] = v;
                }
            }
            prop_assert_eq!(sums.total, plain.iter().sum::<u64>());
            let mut target = 0;
            for (i, &v) in plain.iter().enumerate() {
                prop_assert_eq!(sums.get(i), v);
                for _ in 0..v {
                    prop_assert_eq!(sums.find(target), i);
                    target += 1;
                }
            }
        }
    }
}
