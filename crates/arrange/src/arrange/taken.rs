//! Which pixels of a canvas are taken, a bit for each: a test of a row looks at little memory.

use std::ops::Range;
use vtex_base::raster::{Mask, Span};

/// Largest gap between elements that is distinguished, in pixels.
pub(crate) const REACH: u16 = 40;

const BITS: usize = u64::BITS as usize;

/// The pixels of a canvas and its margins, each free or taken.
pub(crate) struct TakenPixels {
    /// The first pixel of canvas and margins, and their size, in pixels.
    pub(crate) first: [i32; 2],
    pub(crate) size: [i32; 2],
    /// Whether each axis repeats.
    pub(crate) wraps: [bool; 2],
    bits: Vec<u64>,
}

impl TakenPixels {
    /// A canvas that is free.
    pub(crate) fn none(first: [i32; 2], size: [i32; 2], wraps: [bool; 2]) -> Self {
        let count = size[0] as usize * size[1] as usize;
        Self { first, size, wraps, bits: vec![0; count.div_ceil(BITS)] }
    }

    /// The numbers of the pixels of a run that is moved and has `beside` more pixels at either end, in two parts where it
    /// crosses a seam.
    pub(crate) fn row(&self, span: Span, by: [i32; 2], beside: i64) -> [Range<usize>; 2] {
        let [width, height] = self.size.map(i64::from);
        let [dx, dy] = [0, 1].map(|k| i64::from(by[k]) - i64::from(self.first[k]));
        let [x0, x1, y] =
            [i64::from(span.x0) + dx - beside, i64::from(span.x1) + dx + beside, i64::from(span.y) + dy];
        // Most rows lie within the canvas.
        if x0 >= 0 && x0 < x1 && x1 <= width && (0..height).contains(&y) {
            let row = y * width;
            return [(row + x0) as usize..(row + x1) as usize, 0..0];
        }
        let y = if self.wraps[1] { y.rem_euclid(height) } else { y };
        if !(0..height).contains(&y) {
            return [0..0, 0..0];
        }
        let cells = |low: i64, high: i64| {
            let [low, high] = [low, high.max(low)].map(|x| (y * width + x.clamp(0, width)) as usize);
            low..high
        };
        if !self.wraps[0] {
            return [cells(x0, x1), 0..0];
        }
        let length = (x1 - x0).min(width);
        let start = x0.rem_euclid(width);
        [cells(start, start + length), cells(0, start + length - width)]
    }

    /// Takes or frees a pixel.
    pub(crate) fn set_one(&mut self, pixel: usize, taken: bool) {
        self.set_bits(pixel / BITS, 1 << (pixel % BITS), taken);
    }

    /// Takes or frees pixels.
    pub(crate) fn set(&mut self, pixels: Range<usize>, taken: bool) {
        for (word, bits) in words(pixels) {
            self.set_bits(word, bits, taken);
        }
    }

    /// Takes or frees the pixels of a mask that is moved.
    pub(crate) fn set_mask(&mut self, mask: &Mask, by: [i32; 2], taken: bool) {
        for span in mask.spans() {
            for part in self.row(*span, by, 0) {
                self.set(part, taken);
            }
        }
    }

    fn set_bits(&mut self, word: usize, bits: u64, taken: bool) {
        let word = &mut self.bits[word];
        *word = if taken { *word | bits } else { *word & !bits };
    }

    /// Whether a pixel is taken.
    pub(crate) fn any(&self, pixels: Range<usize>) -> bool {
        words(pixels).any(|(word, bits)| self.bits[word] & bits != 0)
    }

    /// Whether all pixels within a distance of a mask that is moved are free. The disc is looked at in rows that are at
    /// most `step` and 0.35 of the distance apart, but at least a pixel.
    pub(crate) fn is_free(&self, mask: &Mask, by: [i32; 2], distance: i32, step: f64) -> bool {
        let reach = f64::from(distance);
        let step = (0.35 * reach).min(step).max(1.0);
        let count = libm::ceil(reach / step) as i32;
        let row = |k: i32| {
            let part = f64::from(k) / f64::from(count.max(1));
            let [dy, beside] = [part, libm::sqrt(1.0 - part * part)].map(|v| libm::round(v * reach) as i32);
            ([by[0], by[1].saturating_add(dy)], i64::from(beside))
        };
        // The row of the mask itself is the most likely to be taken, so it is tested first.
        let mut rows = std::iter::once(0).chain((1..=count).flat_map(|k| [-k, k])).map(row);
        rows.all(|(by, beside)| {
            mask.spans().iter().all(|s| self.row(*s, by, beside).into_iter().all(|part| !self.any(part)))
        })
    }

    /// Frees all pixels.
    pub(crate) fn clear(&mut self) {
        self.bits.fill(0);
    }
}

/// The distance that elements keep from each other, in pixels: three quarters of the lower fifth percentile of the gaps
/// around them.
pub(crate) fn usual_clearance(gaps: impl Iterator<Item = u16>) -> i32 {
    let mut gaps: Vec<u16> = gaps.collect();
    gaps.sort_unstable();
    let usual = gaps.get(gaps.len() / 5).copied().unwrap_or(1);
    i32::from(usual.max(2)) * 3 / 4
}

/// The words that a range of pixels has bits in, and these.
fn words(pixels: Range<usize>) -> impl Iterator<Item = (usize, u64)> {
    let Range { start, end } = pixels;
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
    fn ranges_are_those_of_single_pixels() {
        for (start, end) in [(0, 0), (3, 3), (0, 64), (63, 65), (5, 9), (60, 200), (64, 128), (191, 192)] {
            let mut taken = TakenPixels::none([0, 0], [200, 1], [false; 2]);
            taken.set(start..end, true);
            for pixel in 0..200 {
                assert_eq!(
                    taken.any(pixel..pixel + 1),
                    (start..end).contains(&pixel),
                    "{start} {end} {pixel}"
                );
            }
            assert_eq!((taken.any(0..start), taken.any(end..200)), (false, false));
            taken.set(start + (end - start) / 2..end, false);
            assert_eq!(taken.any(0..200), end > start + 1);
            taken.clear();
            assert!(!taken.any(0..200));
            (start..end).for_each(|pixel| taken.set_one(pixel, true));
            assert!((0..200).all(|pixel| taken.any(pixel..pixel + 1) == (start..end).contains(&pixel)));
            (start..end).for_each(|pixel| taken.set_one(pixel, false));
            assert!(!taken.any(0..200));
        }
    }

    #[test]
    fn distances_cross_seams_and_margins() {
        let block =
            |x: i32, y: i32| Mask::from_spans((y..y + 3).map(|y| Span { y, x0: x, x1: x + 3 }).collect());
        for wraps in [[true, true], [true, false], [false, true], [false, false]] {
            let mut taken = TakenPixels::none([-10, -20], [50, 60], wraps);
            taken.set_mask(&block(0, 0), [-10, 4], true);
            // Three pixels to the left of the first column, and as many above the first row.
            for (at, axis) in [([34, 4], 0), ([-10, -21], 1)] {
                assert!(taken.is_free(&block(0, 0), at, 2, 1.0), "{wraps:?} {axis}");
            }
            assert_eq!(taken.is_free(&block(0, 0), [34, 4], 4, 1.0), !wraps[0]);
            assert!(!taken.is_free(&block(0, 0), [-4, 4], 4, 1.0));
            assert!(taken.is_free(&block(0, 0), [-4, 4], 3, 1.0));
            taken.set_mask(&block(0, 0), [-10, 4], false);
            assert!(!taken.any(0..3000));
            taken.set_mask(&block(0, 37), [0, 0], true);
            assert_eq!(taken.is_free(&block(0, 0), [0, -18], 3, 1.0), !wraps[1]);
        }
    }
}
