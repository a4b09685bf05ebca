//! Heights: new terrain from a height map.
//!
//! Heights are copied along a correspondence field whose features are the height, its slopes along both axes
//! and a layer by rank. Coarse and fine parts are blended separately, and the result is matched to the
//! histogram of the original.

use super::carried::{CELLS, deviation};
use super::carrier::{Carrier, pixel_of};
use crate::correspondence::{CHANNELS, CanvasRequest, ExemplarPage, find};
use image::DynamicImage;
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;
use vtex_base::raster::blur::Plane;
use vtex_base::raster::{Limits, check_size, decode};

/// Weights of the features: the height, its slopes along both axes, and the layer.
const WEIGHTS: [f32; 4] = [1.0, 0.6, 0.6, 0.5];
/// Layers of equal area in the features.
const LAYERS: f32 = 6.0;
/// Bins for histogram matching.
const BINS: usize = 1 << 16;

/// A height map.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    size: [usize; 2],
    heights: Vec<f32>,
}

impl Terrain {
    /// A terrain of heights in any unit, row by row.
    ///
    /// # Errors
    /// [`Error::Control`] if their number does not fit, one is not finite, all are equal, or a side is
    /// shorter than 32 pixels.
    pub fn new(size: [usize; 2], heights: Vec<f32>, name: &str) -> Result<Self> {
        let fail = |reason: String| {
            let advice = "give a picture of heights, 32 x 32 pixels or more, best with 16 bits";
            Err(Error::Control { name: name.into(), role: "heights", reason, advice })
        };
        if heights.len() != size[0] * size[1] || size[0].min(size[1]) < 32 {
            return fail(format!("it has {} x {} pixels", size[0], size[1]));
        }
        let unsound = heights.iter().filter(|h| !h.is_finite()).count();
        if unsound > 0 {
            return fail(format!("{unsound} of its heights are not numbers"));
        }
        if heights.iter().all(|&h| h == heights[0]) {
            return fail("all heights are equal".into());
        }
        Ok(Self { size, heights })
    }

    /// Reads the grey values of a picture, 0 to 65535, or its floating-point values as they are.
    ///
    /// # Errors
    /// [`Error::Decode`], [`Error::TooLarge`], and those of [`Terrain::new`].
    pub fn from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        let (mut image, orientation) = decode(bytes, name, limits, 8)?;
        image.apply_orientation(orientation);
        let size = [image.width() as usize, image.height() as usize];
        let heights = match image {
            // The conversion to 16 bits would hide values that are not numbers.
            DynamicImage::ImageRgb32F(image) => image.pixels().map(|p| p.0[0]).collect(),
            DynamicImage::ImageRgba32F(image) => image.pixels().map(|p| p.0[0]).collect(),
            other => other.into_luma16().pixels().map(|p| f32::from(p.0[0])).collect(),
        };
        Self::new(size, heights, name)
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Heights row by row, in their original unit.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Heights as 16-bit numbers: rounded, or stretched to 0 to 65535 if they do not fit.
    pub fn to_16_bits(&self) -> Vec<u16> {
        let (low, high) = self.range();
        let most = f32::from(u16::MAX);
        let fits = low >= 0.0 && high <= most && high > 255.0;
        let value = |h: f32| if fits { h } else { (h - low) / (high - low) * most };
        self.heights.iter().map(|&h| libm::roundf(value(h)).clamp(0.0, most) as u16).collect()
    }

    /// The lowest and the highest height.
    fn range(&self) -> (f32, f32) {
        let low = self.heights.iter().copied().fold(f32::INFINITY, f32::min);
        (low, self.heights.iter().copied().fold(f32::NEG_INFINITY, f32::max))
    }

    /// Makes new terrain of `size` pixels that repeats along the axes of `wrap`. Heights are copied along a
    /// correspondence field, coarse and fine parts blended separately, and matched to the histogram of this
    /// terrain.
    ///
    /// # Errors
    /// A size out of range; [`Error::Interrupted`].
    pub fn carried(
        &self,
        size: [usize; 2],
        wrap: [bool; 2],
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<Self> {
        check_size(size)?;
        let cell = (self.size[0].min(self.size[1]) as f64 / CELLS as f64).round().max(1.0) as usize;
        let page = self.page(cell);
        let cells = size.map(|v| v.div_ceil(cell));
        let field = find(
            &CanvasRequest { pages: &[page], size: cells, wrap, groups: None, active: None, seed },
            progress,
        )?;
        let own = Plane { size: self.size, values: self.heights.clone() };
        let coarse = own.blurred(1.5 * cell as f32, [false; 2]);
        let fine: Vec<f32> = own.values.iter().zip(&coarse.values).map(|(a, b)| a - b).collect();
        let carrier = Carrier::filling(&field, cell, size, pixel_of(self.size));
        // Wide blending keeps slopes continuous across islands; narrow blending keeps the contrast of grain.
        let low = carrier.voted(&[coarse.values], size, 2, 1.25).swap_remove(0);
        let high = carrier.voted(&[fine], size, 1, 0.5).swap_remove(0);
        let heights: Vec<f32> = low.iter().zip(&high).map(|(a, b)| a + b).collect();
        Ok(Self { size, heights: self.matched(&heights) })
    }

    /// The features of the height map for the search.
    fn page(&self, cell: usize) -> ExemplarPage {
        let size = self.size.map(|v| (v / cell).max(1));
        let height = |x: usize, y: usize| {
            let mut sum = 0.0;
            for v in 0..cell {
                let row = (y * cell + v) * self.size[0] + x * cell;
                sum += self.heights[row..row + cell].iter().sum::<f32>();
            }
            sum / (cell * cell) as f32
        };
        let at = |i: usize| [i % size[0], i / size[0]];
        let cells = size[0] * size[1];
        let heights: Vec<f32> = (0..cells).map(|i| height(at(i)[0], at(i)[1])).collect();
        let slope = |i: usize, k: usize| {
            let step = [1, size[0]][k];
            let (v, last) = (at(i)[k], size[k] - 1);
            let (before, after) = (if v > 0 { i - step } else { i }, if v < last { i + step } else { i });
            heights[after] - heights[before]
        };
        let mut ranks: Vec<usize> = (0..cells).collect();
        ranks.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]).then(a.cmp(&b)));
        let mut layers = vec![0.0; cells];
        ranks.iter().enumerate().for_each(|(rank, &i)| {
            layers[i] = libm::floorf(LAYERS * rank as f32 / cells as f32) - (LAYERS - 1.0) / 2.0;
        });
        let mut channels: [Vec<f32>; CHANNELS] = [
            heights.clone(),
            (0..cells).map(|i| slope(i, 0)).collect(),
            (0..cells).map(|i| slope(i, 1)).collect(),
            layers,
            vec![0.0; cells],
            vec![0.0; cells],
        ];
        for (channel, weight) in channels.iter_mut().zip(WEIGHTS) {
            let mean = channel.iter().sum::<f32>() / cells as f32;
            let unit = weight / deviation(std::iter::once(&*channel)).max(f32::MIN_POSITIVE);
            channel.iter_mut().for_each(|v| *v = (*v - mean) * unit);
        }
        let features = (0..cells).map(|i| std::array::from_fn(|c| channels[c][i])).collect();
        ExemplarPage { group: 0, groups: None, size, features, inside: None, periods: None }
    }

    /// Matches heights to the histogram of this terrain, keeping their order.
    fn matched(&self, heights: &[f32]) -> Vec<f32> {
        let low = heights.iter().copied().fold(f32::INFINITY, f32::min);
        let high = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let mut sorted = self.heights.clone();
        sorted.sort_by(f32::total_cmp);
        let place = |h: f32| (h - low) / (high - low).max(f32::MIN_POSITIVE) * (BINS - 1) as f32;
        let mut before = vec![0usize; BINS + 1];
        heights.iter().for_each(|&h| before[place(h) as usize + 1] += 1);
        (0..BINS).for_each(|i| before[i + 1] += before[i]);
        let last = sorted.len() - 1;
        let value = |h: f32| {
            let at = place(h);
            let bin = at as usize;
            let rank =
                before[bin] as f64 + f64::from(at - bin as f32) * (before[bin + 1] - before[bin]) as f64;
            let rank = rank / heights.len() as f64 * last as f64;
            let i = (rank as usize).min(last);
            let next = sorted[(i + 1).min(last)];
            sorted[i] + (next - sorted[i]) * (rank - i as f64) as f32
        };
        heights.iter().map(|&h| value(h)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::clouds;
    use super::*;

    fn hills(size: [usize; 2], seed: u64) -> Terrain {
        let plane = clouds(size, seed);
        let heights = plane.values.iter().map(|v| 20_000.0 + 60_000.0 * v).collect();
        Terrain::new(size, heights, "hills").unwrap()
    }

    /// Earth mover's distance of two histograms, as a share of the range.
    fn distance(a: &Terrain, b: &Terrain) -> f64 {
        let quantiles = |t: &Terrain| {
            let mut all = t.heights.clone();
            all.sort_by(f32::total_cmp);
            (0..1000).map(|k| f64::from(all[k * all.len() / 1000])).collect::<Vec<_>>()
        };
        let (low, high) = a.range();
        let sum: f64 = quantiles(a).iter().zip(quantiles(b)).map(|(x, y)| (x - y).abs()).sum();
        sum / 1000.0 / f64::from(high - low)
    }

    #[test]
    fn heights_and_slopes_are_those_of_the_exemplar() {
        let own = hills([128, 128], 1);
        let made = own.carried([256, 200], [true; 2], 3, &()).unwrap();
        assert_eq!(made.size(), [256, 200]);
        assert!(distance(&own, &made) < 0.005, "{}", distance(&own, &made));
        let slope = |t: &Terrain| {
            let w = t.size[0];
            let pairs = (0..t.heights.len()).filter(|i| (i + 1) % w != 0);
            let steps: Vec<f64> = pairs.map(|i| f64::from((t.heights[i + 1] - t.heights[i]).abs())).collect();
            steps.iter().sum::<f64>() / steps.len() as f64
        };
        let ratio = slope(&made) / slope(&own);
        assert!((0.75..1.3).contains(&ratio), "{ratio}");
        // No step at the seam is larger than those within.
        let [w, h] = made.size;
        let seam =
            (0..h).map(|y| (made.heights[y * w] - made.heights[y * w + w - 1]).abs()).sum::<f32>() / h as f32;
        assert!(f64::from(seam) < 2.0 * slope(&made), "{seam} {}", slope(&made));
        assert_eq!(own.carried([256, 200], [true; 2], 3, &()).unwrap(), made);
    }

    #[test]
    fn what_is_no_terrain_is_refused() {
        let refused =
            |size: [usize; 2], heights: Vec<f32>| Terrain::new(size, heights, "x").unwrap_err().to_string();
        assert!(refused([40, 40], vec![1.0; 1600]).contains("all heights are equal"));
        let mut heights: Vec<f32> = (0..1600).map(|i| i as f32).collect();
        heights[7] = f32::NAN;
        assert!(refused([40, 40], heights.clone()).contains("1 of its heights are not numbers"));
        heights[7] = f32::INFINITY;
        assert!(refused([40, 40], heights.clone()).contains("not numbers"));
        assert!(refused([40, 41], heights).contains("40 x 41 pixels"));
        assert!(hills([64, 64], 1).carried([0, 9], [false; 2], 1, &()).is_err());
    }

    #[test]
    fn sixteen_bits_are_kept() {
        let own = Terrain::new([40, 40], (0..1600).map(|i| i as f32).collect(), "x").unwrap();
        assert_eq!(own.to_16_bits()[..3], [0, 1, 2]);
        let metres =
            Terrain::new([40, 40], (0..1600).map(|i| i as f32 / 1599.0 - 0.5).collect(), "x").unwrap();
        assert_eq!((metres.to_16_bits()[0], metres.to_16_bits()[1599]), (0, 65535));
    }
}
