//! Disjoint sets of numbers (union–find).

/// Sets of the numbers `0..count`, each alone at first.
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// `count` sets of one number each.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The representative of the set of `i`.
    pub fn root(&mut self, i: usize) -> usize {
        let mut i = i as u32;
        while self.parent[i as usize] != i {
            let up = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = up;
            i = up;
        }
        i as usize
    }

    /// Joins the sets of `a` and `b`. The lower of their roots becomes the representative.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.attach(a.min(b), a.max(b));
    }

    /// Joins two sets, given by their roots. The first root becomes the representative.
    pub fn attach(&mut self, root: usize, child: usize) {
        self.parent[child] = root as u32;
    }

    /// The index of each number's set, counted from 0 in the order of their first numbers; and how
    /// many sets there are.
    pub fn indices(&mut self) -> (Vec<u32>, usize) {
        const OPEN: u32 = u32::MAX;
        let mut index = vec![OPEN; self.parent.len()];
        let mut count = 0;
        let of = (0..self.parent.len())
            .map(|i| {
                let root = self.root(i);
                if index[root] == OPEN {
                    index[root] = count;
                    count += 1;
                }
                index[root]
            })
            .collect();
        (of, count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::DisjointSets;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_a_flood_fill_reaches_is_one_set(pairs in prop::collection::vec((0..20usize, 0..20usize), 0..25)) {
            let mut sets = DisjointSets::new(20);
            pairs.iter().for_each(|&(a, b)| sets.join(a, b));
            let mut of = [usize::MAX; 20];
            let mut count = 0;
            for i in 0..20 {
                if of[i] != usize::MAX {
                    continue;
                }
                of[i] = count;
                while let Some(&(a, b)) = pairs.iter().find(|(a, b)| (of[*a] == count) != (of[*b] == count)) {
                    of[a] = count;
                    of[b] = count;
                }
                count += 1;
            }
            let (found, sets) = sets.indices();
            prop_assert_eq!(sets, count);
            prop_assert!(found.iter().zip(of).all(|(&f, o)| f as usize == o));
        }
    }
}
