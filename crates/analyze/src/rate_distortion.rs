//! The rate–distortion cost: the squared error that a byte must save to be worth writing.

use super::grid::SubpixelGrid;
use super::moments::PixelMoments;
use image::RgbImage;
use vtex_scene::library::{AnalyzeParams, Shading};

/// Squared error over all components (8-bit steps) that equals one byte at a fit tolerance of 1 px.
const ERROR_PER_BYTE: f64 = 16.0;
/// Bytes of a gradient fill.
pub(super) const GRADIENT_BYTES: f64 = 145.0;
/// Least area of a gradient fill at a fit tolerance of 1 px, in pixels. In smaller regions, noise and
/// JPEG blocks cause exaggerated slopes.
const GRADIENT_AREA: f64 = 80.0;
/// Bytes per pixel of border.
const BORDER_BYTES: f64 = 9.0;
/// Bytes of a secondary, not counting its border.
pub(super) const SECONDARY_BYTES: f64 = 120.0;
/// Sides of the blocks between which contrast is measured, in pixels: ellipses draw nothing finer, and what is
/// coarser is shading rather than grain.
const GRAIN: [usize; 2] = [2, 16];
/// Contrast from which an error costs what the fidelity says, in steps of 8 bits. Most photographs have more.
const FULL_CONTRAST: f64 = 18.0;
/// Least price of a byte, relative to that at full contrast. Below it, ellipses would draw noise that nobody sees.
const LEAST_PRICE: f64 = 0.3;
/// Bisection steps in the search for a cost.
const HALVINGS: usize = 16;

/// Parameters of the rate–distortion cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct RateDistortion {
    /// Least number of cells of a gradient fill; infinite if all fills are flat.
    pub(super) gradient_area: f64,
    /// Squared error over all cells and components (8-bit steps) that equals one byte.
    pub(super) error_per_byte: f64,
    /// Bytes per cell of border. Both adjacent shapes draw it.
    pub(super) border_bytes: f64,
}

impl RateDistortion {
    /// The cost for a fit tolerance: twice the tolerance allows twice the error per byte. Gradients are
    /// off if `params` limits the number of colours.
    pub(super) fn new(params: &AnalyzeParams, grid: SubpixelGrid) -> Self {
        let gradients = params.shading != Shading::Flat && params.colors == 0;
        let gradient_area =
            if gradients { GRADIENT_AREA * params.fidelity * grid.area() } else { f64::INFINITY };
        Self {
            gradient_area,
            error_per_byte: ERROR_PER_BYTE * params.fidelity * grid.area(),
            border_bytes: BORDER_BYTES / grid.along(),
        }
    }

    /// The same for what is seen in a photograph. The eye adapts to contrast: where that is low, smaller errors are
    /// seen, and bytes are cheaper.
    pub(super) fn adapted(self, photograph: &RgbImage) -> Self {
        let share = contrast(photograph) / FULL_CONTRAST;
        self.dearer((share * share).clamp(LEAST_PRICE, 1.0))
    }

    /// The same with bytes that cost `times` as much.
    pub(super) fn dearer(self, times: f64) -> Self {
        Self { error_per_byte: self.error_per_byte * times, ..self }
    }

    /// The lowest cost of a byte, from this one upwards, for which `count` gives at most `most` shapes.
    /// `count` must fall as the cost rises. If no cost suffices, the highest is returned.
    pub(super) fn with_limit(self, most: usize, count: impl Fn(Self) -> usize) -> Self {
        if count(self) <= most {
            return self;
        }
        let at = |doublings: f64| self.dearer(libm::exp2(doublings));
        let (mut low, mut high) = (0.0, 40.0);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if count(at(middle)) <= most { high = middle } else { low = middle }
        }
        at(high)
    }

    /// Cost of a region without its border, and whether its cheaper fill is a gradient.
    pub(super) fn of_region(self, sums: &PixelMoments) -> (f64, bool) {
        let flat = sums.flat_error();
        if sums.count() < self.gradient_area {
            return (flat, false);
        }
        let gradient = sums.gradient_error() + GRADIENT_BYTES * self.error_per_byte;
        (flat.min(gradient), gradient < flat)
    }

    /// Whether a secondary of `area` cells, whose colour differs by `difference` from the background,
    /// saves more error than its bytes cost.
    pub(super) fn is_worth(self, area: u32, difference: [i16; 3]) -> bool {
        let squares: f64 = difference.iter().map(|&d| f64::from(d) * f64::from(d)).sum();
        f64::from(area) * squares >= SECONDARY_BYTES * self.error_per_byte
    }
}

/// Root mean square, over pixels and components, of the differences between small blocks of [`GRAIN`] and the large
/// ones around them, in steps of 8 bits.
fn contrast(photograph: &RgbImage) -> f64 {
    let [fine, coarse] = GRAIN.map(|side| BlockMeans::new(photograph, side));
    let blocks = fine.means.iter().enumerate().map(|(i, (own, count))| {
        let [x, y] = [i % fine.columns, i / fine.columns].map(|v| v * GRAIN[0] / GRAIN[1]);
        let around = coarse.means[y * coarse.columns + x].0;
        count * (0..3).map(|c| (own[c] - around[c]) * (own[c] - around[c])).sum::<f64>()
    });
    libm::sqrt(blocks.sum::<f64>() / photograph.as_raw().len() as f64)
}

/// A picture in square blocks; those along the right and lower borders may be smaller.
struct BlockMeans {
    columns: usize,
    /// The mean colour of each block and its number of pixels, row by row.
    means: Vec<([f64; 3], f64)>,
}

impl BlockMeans {
    fn new(image: &RgbImage, side: usize) -> Self {
        let [columns, rows] = [image.width(), image.height()].map(|v| (v as usize).div_ceil(side));
        let mut means = vec![([0.0; 3], 0.0); columns * rows];
        for (x, y, pixel) in image.enumerate_pixels() {
            let (sum, count) = &mut means[y as usize / side * columns + x as usize / side];
            (0..3).for_each(|c| sum[c] += f64::from(pixel.0[c]));
            *count += 1.0;
        }
        means.iter_mut().for_each(|(sum, count)| *sum = sum.map(|v| v / *count));
        Self { columns, means }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn bytes_are_cheaper_where_contrast_is_low() {
        let cost = RateDistortion::new(&AnalyzeParams::default(), SubpixelGrid { cells: 2 });
        let picture =
            |grey: &dyn Fn(u32, u32) -> u32| RgbImage::from_fn(70, 60, |x, y| Rgb([grey(x, y) as u8; 3]));
        // Stripes four pixels wide.
        let price = |amplitude: u32| {
            let stripes = picture(&|x, _| if x % 8 < 4 { 100 + amplitude } else { 100 - amplitude });
            cost.adapted(&stripes).error_per_byte / cost.error_per_byte
        };
        assert_eq!([price(1), price(20), price(60)], [LEAST_PRICE, 1.0, 1.0]);
        assert!((price(12) - 4.0 / 9.0).abs() < 0.02, "{}", price(12));
        // What is coarser or finer than grain counts little.
        assert!(contrast(&picture(&|x, y| x + y)) < 7.0);
        assert_eq!(contrast(&picture(&|x, y| if (x + y) % 2 == 0 { 10 } else { 90 })), 0.0);
    }

    #[test]
    fn the_lowest_price_that_is_high_enough() {
        let start = RateDistortion::new(&AnalyzeParams::default(), SubpixelGrid { cells: 2 });
        // The number of shapes falls with the square root of the cost.
        let count =
            |p: RateDistortion| (1000.0 / libm::sqrt(p.error_per_byte / start.error_per_byte)) as usize;
        assert_eq!(start.with_limit(1000, count).error_per_byte, start.error_per_byte);
        let found = start.with_limit(100, count);
        assert_eq!(count(found), 100);
        assert!(count(RateDistortion { error_per_byte: found.error_per_byte * 0.95, ..found }) > 100);
        assert!(start.with_limit(0, |_| 5).error_per_byte > 1e9 * start.error_per_byte);
    }
}
