//! How far apart the colours of two layers are, relative to what they vary within a layer.
//!
//! Two materials differ in hue or chroma, or plainly in lightness. A wall in light and shade, or bleached and sooty,
//! has one hue throughout, and its lightness passes from one to the other. In the photographs with layers the chroma
//! of two layers differed by .5 deviations or more, in a wall of stones by .2.

use vtex_base::raster::LabelMap;
use vtex_base::raster::blur::Plane;

/// Difference of lightness, in deviations, from which two layers are clearly apart.
const CLEAR_LIGHTNESS: f64 = 1.5;
/// The same of chroma.
const CLEAR_CHROMA: f64 = 1.0;
/// Difference of chroma, in deviations, from which two layers are two materials.
const OTHER_CHROMA: f64 = 0.3;

/// Differences between the mean colours of two layers, in the mean standard deviation within a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Separation {
    pub(super) lightness: f64,
    /// Of both components of hue and chroma.
    pub(super) chroma: f64,
}

impl Separation {
    /// Measures the layers 0 and 1 of a map on the Oklab planes of a picture of its size.
    pub(super) fn new(map: &LabelMap, planes: &[Plane; 3]) -> Self {
        let mut counts = [0f64; 2];
        map.labels.iter().for_each(|&l| counts[l as usize] += 1.0);
        let [lightness, a, b] = planes.each_ref().map(|plane| {
            let mut sums = [[0f64; 2]; 2];
            for (&value, &label) in plane.values.iter().zip(&map.labels) {
                let [sum, squares] = &mut sums[label as usize];
                *sum += f64::from(value);
                *squares += f64::from(value) * f64::from(value);
            }
            let moments = [0, 1].map(|k| {
                let n = counts[k].max(1.0);
                let mean = sums[k][0] / n;
                [mean, libm::sqrt((sums[k][1] / n - mean * mean).max(0.0))]
            });
            [moments[1][0] - moments[0][0], (moments[0][1] + moments[1][1]) / 2.0]
        });
        let ratio = |apart: f64, within: f64| if within > 0.0 { apart / within } else { 0.0 };
        Self {
            lightness: ratio(lightness[0].abs(), lightness[1]),
            chroma: ratio(libm::hypot(a[0], b[0]), libm::hypot(a[1], b[1])),
        }
    }

    /// Whether the layers are clearly apart in lightness or in chroma.
    pub(super) fn is_clear(&self) -> bool {
        self.lightness >= CLEAR_LIGHTNESS || self.chroma >= CLEAR_CHROMA
    }

    /// Whether the layers are two materials rather than one in light and shade.
    pub(super) fn is_of_material(&self) -> bool {
        self.lightness >= CLEAR_LIGHTNESS || self.chroma >= OTHER_CHROMA
    }
}

#[cfg(test)]
mod tests {
    use super::super::find::{FindParams, find};
    use super::super::testing::nested;
    use image::{Rgb, RgbImage};
    use vtex_base::sampling::stream;

    /// The layers found in blotches of one colour on another, with grain, and the reason.
    fn layers(colours: [[f64; 3]; 2]) -> (usize, String) {
        let map = nested([256, 256], 2, 7);
        let mut random = stream(1, "test/shade", 0);
        let photo = RgbImage::from_fn(256, 256, |x, y| {
            let grain = random.range(-55.0, 55.0);
            Rgb(colours[map.get(x, y) as usize].map(|v| (v + grain + random.range(-12.0, 12.0)) as u8))
        });
        let found = find(&photo, None, &FindParams::default(), &()).unwrap();
        (found.map.layers.len(), found.decision.why)
    }

    #[test]
    fn light_and_shade_are_one_material() {
        let (count, why) = layers([[160.0, 150.0, 140.0], [120.0, 112.5, 105.0]]);
        assert!(count == 1 && why.contains("light and shade"), "{count}: {why}");
        let (count, why) = layers([[160.0, 150.0, 140.0], [120.0, 117.0, 80.0]]);
        assert_eq!(count, 2, "{why}");
    }
}
