//! How often colours are used, beside how often the exemplar has them: a search for similar neighbourhoods
//! alone prefers smooth parts, and loses dark and rare colours.

use super::pyramid::PictureLevel;

/// Bins of lightness.
const BINS: usize = 64;
/// Increase of the distance of a colour that is used twice as often as the exemplar has it (after Kopf et
/// al. 2007).
const OVERUSE: f32 = 2.0;
/// Share of a bin that is added to what the exemplar has, against rare colours having no use at all.
const SMOOTHED: f32 = 0.002;

/// Use of the colours of each label.
pub(super) struct ColourUse {
    /// The least lightness, and bins per unit.
    least: f32,
    scale: f32,
    /// Shares of the bins in the exemplar, by label.
    wanted: Vec<[f32; BINS]>,
    /// Number of pixels in each bin, by label.
    used: Vec<[f32; BINS]>,
    /// Number of pixels, by label.
    count: Vec<f32>,
}

impl ColourUse {
    /// The colours of an exemplar with labels below `labels`, none of them used.
    pub(super) fn new(exemplar: &PictureLevel, labels: usize) -> Self {
        let light = || exemplar.pixels.iter().map(|p| p[0]);
        let least = light().fold(f32::INFINITY, f32::min);
        let range = light().fold(f32::NEG_INFINITY, f32::max) - least;
        let mut new = Self {
            least,
            scale: BINS as f32 / range.max(1e-6),
            wanted: vec![[0.0; BINS]; labels],
            used: vec![[0.0; BINS]; labels],
            count: vec![0.0; labels],
        };
        for (i, pixel) in exemplar.pixels.iter().enumerate() {
            let bin = new.bin(pixel);
            new.wanted[exemplar.label(i) as usize][bin] += 1.0;
        }
        for bins in &mut new.wanted {
            let all = bins.iter().sum::<f32>().max(1.0);
            bins.iter_mut().for_each(|v| *v /= all);
        }
        new
    }

    fn bin(&self, pixel: &[f32; 3]) -> usize {
        (((pixel[0] - self.least) * self.scale) as usize).min(BINS - 1)
    }

    /// Adds a pixel of a label, or takes one away (−1).
    pub(super) fn add(&mut self, label: u32, pixel: &[f32; 3], number: f32) {
        let bin = self.bin(pixel);
        self.used[label as usize][bin] += number;
        self.count[label as usize] += number;
    }

    /// The factor of a distance for a pixel of a label.
    #[inline]
    pub(super) fn factor(&self, label: u32, pixel: &[f32; 3]) -> f32 {
        let (label, bin) = (label as usize, self.bin(pixel));
        let count = self.count[label].max(1.0);
        let wanted = self.wanted[label][bin];
        let over = (self.used[label][bin] / count - wanted) / (wanted + SMOOTHED);
        1.0 + OVERUSE * over.max(0.0)
    }
}

/// Gives the pixels `open` of a picture the exemplar's distribution in each channel, label by label.
pub(super) fn match_colours(made: &mut PictureLevel, open: &[usize], exemplar: &PictureLevel, labels: u32) {
    for label in 0..labels {
        let own: Vec<usize> = open.iter().copied().filter(|&i| made.label(i) == label).collect();
        let known = || (0..exemplar.pixels.len()).filter(|&i| exemplar.label(i) == label);
        if own.is_empty() || known().next().is_none() {
            continue;
        }
        for c in 0..3 {
            let mut wanted: Vec<f32> = known().map(|i| exemplar.pixels[i][c]).collect();
            wanted.sort_by(f32::total_cmp);
            let mut order = own.clone();
            order.sort_by(|&a, &b| made.pixels[a][c].total_cmp(&made.pixels[b][c]));
            for (rank, &i) in order.iter().enumerate() {
                made.pixels[i][c] = wanted[(2 * rank + 1) * wanted.len() / (2 * order.len())];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};

    #[test]
    fn what_is_used_too_often_costs_more() {
        let exemplar =
            PictureLevel::of(&RgbImage::from_fn(10, 10, |x, _| Rgb([if x < 3 { 0 } else { 200 }; 3])), None);
        let (dark, light) = (exemplar.pixels[0], exemplar.pixels[9]);
        let mut used = ColourUse::new(&exemplar, 1);
        assert_eq!([used.factor(0, &dark), used.factor(0, &light)], [1.0; 2]);
        (0..10).for_each(|_| used.add(0, &light, 1.0));
        assert_eq!(used.factor(0, &dark), 1.0);
        assert!(used.factor(0, &light) > 1.5);
        (0..3).for_each(|_| {
            used.add(0, &light, -1.0);
            used.add(0, &dark, 1.0);
        });
        assert!(used.factor(0, &light) < 1.0 + 1e-4 && used.factor(0, &dark) < 1.0 + 1e-4);
    }

    #[test]
    fn matched_pixels_have_the_distribution_of_the_exemplar() {
        let exemplar =
            PictureLevel::of(&RgbImage::from_fn(8, 8, |x, y| Rgb([(x * 30) as u8, (y * 9) as u8, 7])), None);
        let mut made = exemplar.clone();
        made.pixels.iter_mut().for_each(|p| *p = p.map(|v| 0.2 + v * 0.5));
        let open: Vec<usize> = (0..64).collect();
        match_colours(&mut made, &open, &exemplar, 1);
        assert_eq!(made.pixels, exemplar.pixels);
    }
}
