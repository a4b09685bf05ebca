//! Search for masks similar to a given one.

use rustc_hash::FxHashMap;
use vtex_base::raster::Mask;

/// Box `(x0, y0, x1, y1)`, ends exclusive.
pub(super) type Bounds = (i32, i32, i32, i32);

/// Spatial index of masks by size class and position of their bounding boxes. Masks with an IoU above one
/// half lie in neighbouring squares.
#[derive(Default)]
pub(super) struct SimilarMasks {
    squares: FxHashMap<u64, Vec<IndexedMask>>,
}

/// A mask in the index.
#[derive(Clone, Copy)]
struct IndexedMask {
    index: usize,
    bounds: Bounds,
    area: u32,
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

    /// Adds a mask under an index.
    pub(super) fn add(&mut self, mask: &Measured, index: usize) {
        let Measured { bounds, area, .. } = *mask;
        let key = Self::key(Self::square(bounds, Self::class(bounds)));
        self.squares.entry(key).or_default().push(IndexedMask { index, bounds, area });
    }

    /// The masks whose IoU may be above 0 and at least `least`, by ascending index.
    pub(super) fn near(&self, mask: &Measured, least: f32) -> Vec<SimilarMask> {
        let own = Self::class(mask.bounds);
        let mut near = Vec::new();
        for class in own.saturating_sub(1)..=own + 1 {
            let (_, x, y) = Self::square(mask.bounds, class);
            for j in y - 2..=y + 2 {
                for i in x - 2..=x + 2 {
                    let entries = self.squares.get(&Self::key((class, i, j))).into_iter().flatten();
                    near.extend(entries.filter_map(|entry| {
                        let most = most((mask.bounds, mask.area), (entry.bounds, entry.area));
                        (most > 0.0 && most >= least).then_some(SimilarMask { index: entry.index, most })
                    }));
                }
            }
        }
        near.sort_unstable_by_key(|near| near.index);
        near
    }
}

/// A mask that may be similar to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SimilarMask {
    pub(super) index: usize,
    /// Upper bound of their IoU.
    pub(super) most: f32,
}

/// Upper bound of the IoU of two masks, given their boxes and areas; 0 if one area is more than twice the
/// other.
fn most((a, area): (Bounds, u32), (b, other): (Bounds, u32)) -> f32 {
    let (width, height) = (a.2.min(b.2) - a.0.max(b.0), a.3.min(b.3) - a.1.max(b.1));
    if width <= 0 || height <= 0 || area.min(other) * 2 < area.max(other) {
        return 0.0;
    }
    iou(area, other, (width as u32 * height as u32).min(area).min(other))
}

/// The IoU of two masks of these areas whose intersection has the area `both`.
fn iou(area: u32, other: u32, both: u32) -> f32 {
    both as f32 / (area + other - both) as f32
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
        if most((self.bounds, self.area), (other.bounds, other.area)) == 0.0 {
            return 0.0;
        }
        iou(self.area, other.area, self.mask.overlap(&other.mask))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vtex_base::raster::Span;

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
            index.add(&a, 7);
            if a.iou(&b) > 0.5 {
                let near = index.near(&b, 0.5);
                prop_assert!(near.len() == 1 && near[0].index == 7 && near[0].most >= a.iou(&b));
            }
        }
    }
}
