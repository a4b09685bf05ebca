//! Connected components of label maps and masks.

use super::{LabelMap, Mask, Span};
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

/// The holes of a mask: connected areas that it encloses.
pub fn holes(mask: &Mask) -> Vec<Mask> {
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return Vec::new() };
    let mut holes = components_of_mask(&complement(mask, (x0, y0, x1, y1)), Connectivity::Four);
    holes.retain(|area| {
        area.bounds()
            .is_some_and(|(left, top, right, bottom)| left > x0 && top > y0 && right < x1 && bottom < y1)
    });
    holes
}

/// The pixels of a box that a mask does not contain.
pub fn complement(mask: &Mask, (x0, y0, x1, y1): (i32, i32, i32, i32)) -> Mask {
    let mut gaps = Vec::new();
    let mut rest = mask.spans();
    for y in y0..y1 {
        let n = rest.iter().take_while(|s| s.y == y).count();
        let mut from = x0;
        for s in &rest[..n] {
            gaps.push(Span { y, x0: from, x1: s.x0 });
            from = s.x1;
        }
        gaps.push(Span { y, x0: from, x1 });
        rest = &rest[n..];
    }
    Mask::from_spans(gaps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn holes_are_what_is_enclosed() {
        // A ring with a gap at its corner, which only leads out diagonally, a bay, and a single pixel.
        let rows = ["#### ##.#", "#..# #..#", "#..# #..#", "### .####"];
        let labels = rows.concat().bytes().map(|b| u32::from(b == b'#')).collect();
        let mask = Mask::from_labels(&LabelMap { width: 9, height: 4, labels }, |label| label == 1);
        let found: Vec<u32> = holes(&mask).iter().map(Mask::area).collect();
        assert_eq!(found, [4]);
    }

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
