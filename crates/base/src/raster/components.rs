//! Connected components of label maps and masks.

use super::{LabelMap, Mask};
use crate::disjoint_sets::DisjointSets;

/// Which pixels count as neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connectivity {
    /// The four pixels that share an edge.
    Four,
    /// Also the four that share a corner.
    Eight,
}

/// Connected components of a label map. Pixels with label 0 stay 0. Components are numbered from 1
/// in the order of their first pixel, row by row. Also returns the original label of each component
/// (index 0 holds 0).
pub fn components(map: &LabelMap, connectivity: Connectivity) -> (LabelMap, Vec<u32>) {
    let (w, h) = (map.width as usize, map.height as usize);
    let mut pieces = LabelMap::filled(map.width, map.height, 0);
    let mut labels = vec![0];
    let mut stack = Vec::new();
    for start in 0..w * h {
        let label = map.labels[start];
        if label == 0 || pieces.labels[start] != 0 {
            continue;
        }
        let piece = labels.len() as u32;
        labels.push(label);
        pieces.labels[start] = piece;
        stack.push(start);
        while let Some(i) = stack.pop() {
            let (x, y) = (i % w, i / w);
            let mut visit = |j: usize| {
                if map.labels[j] == label && pieces.labels[j] == 0 {
                    pieces.labels[j] = piece;
                    stack.push(j);
                }
            };
            let (left, right, up, down) = (x > 0, x + 1 < w, y > 0, y + 1 < h);
            if left {
                visit(i - 1)
            }
            if right {
                visit(i + 1)
            }
            if up {
                visit(i - w)
            }
            if down {
                visit(i + w)
            }
            if connectivity == Connectivity::Eight {
                if left && up {
                    visit(i - w - 1)
                }
                if right && up {
                    visit(i - w + 1)
                }
                if left && down {
                    visit(i + w - 1)
                }
                if right && down {
                    visit(i + w + 1)
                }
            }
        }
    }
    (pieces, labels)
}

/// The connected pieces of a mask, in the order of their first pixel.
pub fn components_of_mask(mask: &Mask, connectivity: Connectivity) -> Vec<Mask> {
    let spans = mask.spans();
    let mut sets = DisjointSets::new(spans.len());
    let reach = i32::from(connectivity == Connectivity::Eight);
    let mut above = 0;
    for i in 0..spans.len() {
        let s = spans[i];
        while above < i
            && (spans[above].y < s.y - 1 || (spans[above].y == s.y - 1 && spans[above].x1 + reach <= s.x0))
        {
            above += 1;
        }
        let mut j = above;
        while j < i && spans[j].y == s.y - 1 && spans[j].x0 < s.x1 + reach {
            sets.join(i, j);
            j += 1;
        }
    }
    let (of, count) = sets.indices();
    let mut pieces: Vec<Vec<super::Span>> = vec![Vec::new(); count];
    for (s, piece) in spans.iter().zip(of) {
        pieces[piece as usize].push(*s);
    }
    pieces.into_iter().map(Mask::from_spans).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_ways_agree(labels in prop::collection::vec(0..2u32, 12 * 9), eight: bool) {
            let map = LabelMap { width: 12, height: 9, labels };
            let c = if eight { Connectivity::Eight } else { Connectivity::Four };
            let (pieces, names) = components(&map, c);
            let masks = components_of_mask(&Mask::from_labels(&map, |l| l == 1), c);
            prop_assert_eq!(masks.len(), names.len() - 1);
            for (i, mask) in masks.iter().enumerate() {
                let same = Mask::from_labels(&pieces, |l| l == i as u32 + 1);
                prop_assert_eq!(mask, &same);
            }
        }
    }
}
