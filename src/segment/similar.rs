//! Search for masks similar to a given one.

use super::hashing::ByNumber;
use crate::raster::Mask;

/// Box `(x0, y0, x1, y1)`, ends exclusive.
pub(super) type Bounds = (i32, i32, i32, i32);

/// Spatial index of bounding boxes by size class and position. Masks with an IoU above one half lie in
/// neighbouring squares.
#[derive(Default)]
pub(super) struct SimilarMasks {
    squares: ByNumber<Vec<usize>>,
}

impl SimilarMasks {
    fn class(b: Bounds) -> u32 {
        ((b.2 - b.0).max(b.3 - b.1).max(8) as u32 / 8).ilog2()
    }

    /// The square of a size class's grid that contains the centre of a box.
    fn square(b: Bounds, class: u32) -> (u32, i32, i32) {
        let side = 8 << class;
        (class, (b.0 + b.2).div_euclid(2 * side), (b.1 + b.3).div_euclid(2 * side))
    }

    /// The number of a square. Squares of images of up to 2³⁰ pixels have different ones.
    fn key((class, x, y): (u32, i32, i32)) -> u64 {
        let low = |v: i32| u64::from(v as u32) & 0x0fff_ffff;
        u64::from(class) << 56 | low(x) << 28 | low(y)
    }

    /// Adds a box under an index.
    pub(super) fn add(&mut self, bounds: Bounds, index: usize) {
        self.squares.entry(Self::key(Self::square(bounds, Self::class(bounds)))).or_default().push(index);
    }

    /// Indices of boxes whose masks may be similar, ascending.
    pub(super) fn near(&self, bounds: Bounds) -> Vec<usize> {
        let own = Self::class(bounds);
        let mut indices = Vec::new();
        for class in own.saturating_sub(1)..=own + 1 {
            let (_, x, y) = Self::square(bounds, class);
            for j in y - 2..=y + 2 {
                for i in x - 2..=x + 2 {
                    indices
                        .extend(self.squares.get(&Self::key((class, i, j))).into_iter().flatten().copied());
                }
            }
        }
        indices.sort_unstable();
        indices
    }
}

/// A mask with its bounding box and area.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) mask: Mask,
    pub(super) bounds: Bounds,
    pub(super) area: u32,
}

impl Measured {
    /// Measures a mask; `None` if it is empty.
    pub(super) fn new(mask: Mask) -> Option<Self> {
        Some(Self { bounds: mask.bounds()?, area: mask.area(), mask })
    }

    /// Intersection over union; 0 if one area is more than twice the other.
    pub(super) fn iou(&self, other: &Self) -> f32 {
        let (a, b) = (self.bounds, other.bounds);
        let apart = a.0 >= b.2 || b.0 >= a.2 || a.1 >= b.3 || b.1 >= a.3;
        if apart || self.area.min(other.area) * 2 < self.area.max(other.area) {
            return 0.0;
        }
        let both = self.mask.overlap(&other.mask);
        both as f32 / (self.area + other.area - both) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Span;
    use proptest::prelude::*;

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> Measured {
        let spans = (y..y + h).map(|y| Span { y, x0: x, x1: x + w }).collect();
        Measured::new(Mask::from_spans(spans)).unwrap()
    }

    proptest! {
        #[test]
        fn whatever_is_alike_is_near(
            (x, y, w, h) in (-50..50i32, -50..50i32, 1..80i32, 1..80i32),
            (dx, dy, dw, dh) in (-20..20i32, -20..20i32, -20..20i32, -20..20i32),
        ) {
            let a = rectangle(x, y, w, h);
            let b = rectangle(x + dx, y + dy, (w + dw).max(1), (h + dh).max(1));
            let mut index = SimilarMasks::default();
            index.add(a.bounds, 7);
            if a.iou(&b) > 0.5 {
                prop_assert_eq!(index.near(b.bounds), [7]);
            }
        }
    }
}
