//! Which cells of a canvas are taken, a bit for each: a test of a row looks at little memory.

use std::ops::Range;

const BITS: usize = u64::BITS as usize;

/// A bit for each cell.
pub(super) struct TakenCells(Vec<u64>);

impl TakenCells {
    /// As many cells, all free.
    pub(super) fn none(count: usize) -> Self {
        Self(vec![0; count.div_ceil(BITS)])
    }

    /// Takes or frees a cell.
    pub(super) fn set_one(&mut self, cell: usize, taken: bool) {
        self.set_bits(cell / BITS, 1 << (cell % BITS), taken);
    }

    /// Takes or frees cells.
    pub(super) fn set(&mut self, cells: Range<usize>, taken: bool) {
        for (word, bits) in words(cells) {
            self.set_bits(word, bits, taken);
        }
    }

    fn set_bits(&mut self, word: usize, bits: u64, taken: bool) {
        let word = &mut self.0[word];
        *word = if taken { *word | bits } else { *word & !bits };
    }

    /// Whether a cell is taken.
    pub(super) fn any(&self, cells: Range<usize>) -> bool {
        words(cells).any(|(word, bits)| self.0[word] & bits != 0)
    }

    /// Frees all cells.
    pub(super) fn clear(&mut self) {
        self.0.fill(0);
    }
}

/// The words that a range of cells has bits in, and these.
fn words(cells: Range<usize>) -> impl Iterator<Item = (usize, u64)> {
    let Range { start, end } = cells;
    let (first, last) = (start / BITS, end.div_ceil(BITS));
    (first..if start < end { last } else { first }).map(move |word| {
        let low = start.saturating_sub(word * BITS);
        let high = (end - word * BITS).min(BITS);
        (word, u64::MAX << low & u64::MAX >> (BITS - high))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_single_cells() {
        for (start, end) in [(0, 0), (3, 3), (0, 64), (63, 65), (5, 9), (60, 200), (64, 128), (191, 192)] {
            let mut taken = TakenCells::none(200);
            taken.set(start..end, true);
            for cell in 0..200 {
                assert_eq!(taken.any(cell..cell + 1), (start..end).contains(&cell), "{start} {end} {cell}");
            }
            assert_eq!((taken.any(0..start), taken.any(end..200)), (false, false));
            taken.set(start + (end - start) / 2..end, false);
            assert_eq!(taken.any(0..200), end > start + 1);
            taken.clear();
            assert!(!taken.any(0..200));
            (start..end).for_each(|cell| taken.set_one(cell, true));
            assert!((0..200).all(|cell| taken.any(cell..cell + 1) == (start..end).contains(&cell)));
            (start..end).for_each(|cell| taken.set_one(cell, false));
            assert!(!taken.any(0..200));
        }
    }
}
