//! Pictures on several levels of resolution.

use image::RgbImage;
use vtex_base::raster::colour::oklab;
use vtex_base::raster::{LabelMap, continued};

/// A picture on one level: colours, and which pixels have one.
#[derive(Clone)]
pub(super) struct PictureLevel {
    pub(super) size: [usize; 2],
    /// Along which axes places beyond the border are those at the opposite border; else they are mirrored.
    pub(super) wrap: [bool; 2],
    /// Colours in Oklab, row by row.
    pub(super) pixels: Vec<[f32; 3]>,
    pub(super) known: Vec<bool>,
    /// The label of each pixel, if pixels have labels.
    pub(super) labels: Option<LabelMap>,
}

impl PictureLevel {
    /// The finest level of a picture.
    pub(super) fn of(image: &RgbImage, labels: Option<&LabelMap>) -> Self {
        let size = [image.width() as usize, image.height() as usize];
        Self {
            pixels: image.pixels().map(|p| oklab(p.0)).collect(),
            known: vec![true; size[0] * size[1]],
            ..Self::empty(size, [false; 2], labels)
        }
    }

    /// A picture without a known pixel.
    pub(super) fn empty(size: [usize; 2], wrap: [bool; 2], labels: Option<&LabelMap>) -> Self {
        let count = size[0] * size[1];
        Self { size, wrap, pixels: vec![[0.0; 3]; count], known: vec![false; count], labels: labels.cloned() }
    }

    /// The level at half the resolution: means of the known of 2 × 2 pixels. A pixel is known if two of them
    /// are. Its label is that of most of them; of equally many, of the first.
    pub(super) fn halved(&self) -> Self {
        let size = self.size.map(|v| v.div_ceil(2));
        let mut halved = Self::empty(size, self.wrap, None);
        let mut labels = Vec::new();
        for i in 0..size[0] * size[1] {
            let [x, y] = [i % size[0] * 2, i / size[0] * 2];
            let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| {
                (y + dy).min(self.size[1] - 1) * self.size[0] + (x + dx).min(self.size[0] - 1)
            });
            let (mut sum, mut count) = ([0.0; 3], 0);
            for p in four.into_iter().filter(|&p| self.known[p]) {
                (0..3).for_each(|c| sum[c] += self.pixels[p][c]);
                count += 1;
            }
            halved.known[i] = count >= 2;
            halved.pixels[i] = sum.map(|v| v / count.max(1) as f32);
            if let Some(map) = &self.labels {
                let of = four.map(|p| map.labels[p]);
                let votes = |label: u32| of.iter().filter(|&&l| l == label).count();
                labels.extend(of.into_iter().rev().max_by_key(|&label| votes(label)));
            }
        }
        let [width, height] = size.map(|v| v as u32);
        halved.labels = self.labels.is_some().then_some(LabelMap { width, height, labels });
        halved
    }

    /// The index of a place, which may lie beyond the border.
    #[inline]
    pub(super) fn index(&self, [x, y]: [i64; 2]) -> usize {
        let Self { size: [width, height], wrap, .. } = *self;
        continued(y, height, wrap[1]) * width + continued(x, width, wrap[0])
    }

    /// The place of an index.
    pub(super) fn place(&self, i: usize) -> [i64; 2] {
        [i % self.size[0], i / self.size[0]].map(|v| v as i64)
    }

    /// The label of a pixel; 0 without labels.
    #[inline]
    pub(super) fn label(&self, i: usize) -> u32 {
        self.labels.as_ref().map_or(0, |map| map.labels[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn halves_are_means_of_what_is_known() {
        let image = RgbImage::from_fn(5, 4, |x, y| Rgb([(x * 40) as u8, (y * 50) as u8, 9]));
        let labels =
            LabelMap { width: 5, height: 4, labels: (0..20).map(|i| u32::from(i % 5 > 2)).collect() };
        let mut level = PictureLevel::of(&image, Some(&labels));
        level.known[0] = false;
        [1, 2, 7].into_iter().for_each(|i| level.known[i + 1] = false);
        let half = level.halved();
        assert_eq!(half.size, [3, 2]);
        // Of the second, a single pixel is known.
        assert_eq!(half.known, [true, false, true, true, true, true]);
        let mean =
            |of: &[usize], c: usize| of.iter().map(|&i| level.pixels[i][c]).sum::<f32>() / of.len() as f32;
        for c in 0..3 {
            assert!((half.pixels[0][c] - mean(&[1, 5, 6], c)).abs() < 1e-6);
            assert!((half.pixels[5][c] - mean(&[14, 19], c)).abs() < 1e-6);
        }
        assert_eq!(half.labels.unwrap().labels, [0, 0, 1, 0, 0, 1]);
    }

    #[test]
    fn places_beyond_the_border_wrap_or_are_mirrored() {
        let level = PictureLevel::empty([4, 3], [true, false], None);
        assert_eq!(level.index([-1, 0]), 3);
        assert_eq!(level.index([9, 1]), 5);
        assert_eq!(level.index([2, -1]), 2);
        assert_eq!(level.index([2, 3]), 10);
        assert_eq!(level.index([0, 7]), 4);
        assert!((0..12).all(|i| level.index(level.place(i)) == i));
    }
}
