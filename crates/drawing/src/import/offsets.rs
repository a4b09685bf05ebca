//! Disjoint sets on a torus: members that belong together, each shifted by a number of periods.
//!
//! A set that is connected to its own copy a period away is endless. In a library it is `clipped`, although
//! the arrangement is periodic, and is never moved.

pub(super) use vtex_base::raster::contact::{Shift, minus};

/// The sum of two shifts.
pub(super) fn plus(a: Shift, b: Shift) -> Shift {
    [a[0] + b[0], a[1] + b[1]]
}

/// Disjoint sets of numbers with the shift of each relative to the first of its set.
#[derive(Clone)]
pub(super) struct Offsets {
    parent: Vec<usize>,
    shift: Vec<Shift>,
    /// Whether a set is endless: connected to its own copy a period away.
    endless: Vec<bool>,
}

impl Offsets {
    pub(super) fn new(count: usize) -> Self {
        Self { parent: (0..count).collect(), shift: vec![[0; 2]; count], endless: vec![false; count] }
    }

    /// The representative of the set of `i`, and the shift of `i` relative to it.
    pub(super) fn find(&self, mut i: usize) -> (usize, Shift) {
        let mut shift = [0; 2];
        while self.parent[i] != i {
            shift = plus(shift, self.shift[i]);
            i = self.parent[i];
        }
        (i, shift)
    }

    /// Joins the sets of `a` and of `b`, with `b` moved by `shift`.
    pub(super) fn join(&mut self, a: usize, b: usize, shift: Shift) {
        let ((first, own), (second, other)) = (self.find(a), self.find(b));
        // Keeps the paths to representatives short.
        for (i, root, shift) in [(a, first, own), (b, second, other)] {
            (self.parent[i], self.shift[i]) = (root, shift);
        }
        // In the frame of the first: b is at own + shift.
        let between = plus(plus(own, shift), minus(other));
        if first == second {
            self.endless[first] |= between != [0; 2];
            return;
        }
        let (root, child, between) =
            if first < second { (first, second, between) } else { (second, first, minus(between)) };
        self.parent[child] = root;
        self.shift[child] = between;
        self.endless[root] |= self.endless[child];
    }

    /// Marks the set of `i` as endless.
    pub(super) fn set_endless(&mut self, i: usize) {
        let root = self.find(i).0;
        self.endless[root] = true;
    }

    /// Whether the set of `i` is endless.
    pub(super) fn is_endless(&self, i: usize) -> bool {
        self.endless[self.find(i).0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_add_up_and_contradictions_are_noticed() {
        let mut sets = Offsets::new(4);
        sets.join(2, 1, [1, 0]);
        sets.join(1, 3, [0, 1]);
        assert_eq!(sets.find(3), (1, [0, 1]));
        assert_eq!(sets.find(2), (1, [-1, 0]));
        sets.join(2, 3, [1, 1]);
        assert!(!sets.is_endless(3));
        sets.join(3, 2, [0, 0]);
        assert!(sets.is_endless(1) && !sets.is_endless(0));
    }
}
