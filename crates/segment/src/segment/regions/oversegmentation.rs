//! An image in Oklab, its gradient, and the gradient's basins.

use image::RgbImage;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::raster::blur::{convolve, gaussian};
use vtex_base::raster::colour::{of_pixels, oklab};

/// A smoothed image and its gradient.
pub(super) struct GradientImage {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Standard deviation of the initial smoothing, in pixels.
    pub(super) sigma: f64,
    /// Smoothed Oklab, L times 100, a and b times 200, so that a step of 1 is just noticeable.
    pub(super) colours: Vec<[f32; 3]>,
    /// Magnitude of the colour gradient, per pixel.
    pub(super) gradient: Vec<f32>,
}

/// An image in Oklab, L times 100, a and b times 200.
pub(super) struct ScaledOklabImage {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl ScaledOklabImage {
    pub(super) fn new(image: &RgbImage) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let pixels = of_pixels(image, |rgb| {
            let [l, a, b] = oklab(rgb);
            [100.0 * l, 200.0 * a, 200.0 * b]
        });
        Self { width, height, pixels }
    }
}

/// Depth below the lowest point of its rim from which a basin is a region by itself. More than half of all
/// basins are less deep; without them a tree is built in a third of the time.
const SHALLOW: f32 = 1.0;

impl GradientImage {
    /// Smooths an image by `sigma` pixels and computes its gradient.
    pub(super) fn new(image: &ScaledOklabImage, sigma: f64) -> Self {
        let (width, height) = (image.width, image.height);
        let at = |x: usize, y: usize| image.pixels[y * width + x];
        let colours = convolve(at, [width, height], &[0..width, 0..height], &gaussian(sigma), [false; 2]);
        let mut gradient = vec![0.0; width * height];
        for y in 0..height {
            let (up, down) = (y.saturating_sub(1) * width, (y + 1).min(height - 1) * width);
            for x in 0..width {
                let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
                let (l, r) = (colours[y * width + left], colours[y * width + right]);
                let (u, d) = (colours[up + x], colours[down + x]);
                let sum: f32 = (0..3)
                    .map(|c| {
                        let (dx, dy) = (r[c] - l[c], d[c] - u[c]);
                        dx * dx + dy * dy
                    })
                    .sum();
                gradient[y * width + x] = 0.5 * sum.sqrt();
            }
        }
        Self { width, height, sigma, colours, gradient }
    }

    /// The basins of the gradient and their number. Each pixel drains to the lowest of its four neighbours
    /// (ties: the lower index) until none is lower. Basins are 4-connected and numbered from 0 in the
    /// order of their first pixel.
    pub(super) fn basins(&self) -> (Vec<u32>, usize) {
        let (w, count) = (self.width, self.width * self.height);
        let mut basins = DisjointSets::new(count);
        for i in 0..count {
            let x = i % w;
            let mut lowest = (self.gradient[i], i);
            let mut look = |j: usize| {
                if (self.gradient[j], j) < lowest {
                    lowest = (self.gradient[j], j);
                }
            };
            if i >= w {
                look(i - w);
            }
            if x > 0 {
                look(i - 1);
            }
            if x + 1 < w {
                look(i + 1);
            }
            if i + w < count {
                look(i + w);
            }
            basins.attach(lowest.1, i);
        }
        basins.indices()
    }

    /// Basins as those of [`GradientImage::basins`], each shallow one united with the neighbour that it would
    /// overflow into (ties: the one of the lower number), and the number of basins in each.
    pub(super) fn deep_basins(&self) -> (Vec<u32>, Vec<u32>) {
        let (mut labels, count) = self.basins();
        // The lowest point of each basin and of its rim, and the neighbour there.
        let mut floor = vec![f32::INFINITY; count];
        let mut rim = vec![(f32::INFINITY, 0); count];
        for (i, &a) in labels.iter().enumerate() {
            floor[a as usize] = floor[a as usize].min(self.gradient[i]);
            let mut meet = |j: usize| {
                let b = labels[j];
                if a != b {
                    let pass = self.gradient[i].max(self.gradient[j]);
                    for (basin, beside) in [(a, b), (b, a)] {
                        let least = &mut rim[basin as usize];
                        if (pass, beside) < *least {
                            *least = (pass, beside);
                        }
                    }
                }
            };
            if (i + 1) % self.width != 0 {
                meet(i + 1);
            }
            if i + self.width < labels.len() {
                meet(i + self.width);
            }
        }
        let mut united = DisjointSets::new(count);
        for (basin, (pass, beside)) in rim.into_iter().enumerate() {
            if pass - floor[basin] < SHALLOW {
                united.join(basin, beside as usize);
            }
        }
        let (numbers, deep) = united.indices();
        let mut counts = vec![0; deep];
        numbers.iter().for_each(|&n| counts[n as usize] += 1);
        labels.iter_mut().for_each(|label| *label = numbers[*label as usize]);
        (labels, counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vtex_base::raster::{Connectivity, LabelMap, components};

    proptest! {
        #[test]
        fn basins_are_connected(values in prop::collection::vec(any::<[u8; 3]>(), 15 * 11)) {
            let image = RgbImage::from_fn(15, 11, |x, y| image::Rgb(values[(y * 15 + x) as usize]));
            let field = GradientImage::new(&ScaledOklabImage::new(&image), 0.8);
            let (fine, count) = field.basins();
            let (deep, counts) = field.deep_basins();
            for (labels, count) in [(fine, count), (deep, counts.len())] {
                let labels = labels.into_iter().map(|l| l + 1).collect();
                let (_, pieces) = components(&LabelMap { width: 15, height: 11, labels }, Connectivity::Four);
                prop_assert_eq!(pieces.len(), count + 1);
            }
        }
    }

    #[test]
    fn shallow_basins_are_united_and_counted() {
        // Two slopes with a step between them, and ripples much lower than the step.
        let image = RgbImage::from_fn(60, 20, |x, y| {
            let ripple = ((x * 7 + y * 13) % 5) as u8 / 3;
            image::Rgb([if x < 30 { 90 } else { 160 } + ripple; 3])
        });
        let field = GradientImage::new(&ScaledOklabImage::new(&image), 0.8);
        let (fine, count) = field.basins();
        let (labels, counts) = field.deep_basins();
        assert_eq!(counts.iter().sum::<u32>() as usize, count);
        assert!(count > 20 && counts.len() < count / 2, "{count}, {}", counts.len());
        let mut of_fine = vec![None; count];
        for (&f, &label) in fine.iter().zip(&labels) {
            assert_eq!(*of_fine[f as usize].get_or_insert(label), label);
        }
        // No region far from the step crosses it.
        let side = |from: usize| (0..20).flat_map(move |y| (from..from + 26).map(move |x| y * 60 + x));
        let left: std::collections::BTreeSet<u32> = side(0).map(|i| labels[i]).collect();
        assert!(side(34).all(|i| !left.contains(&labels[i])));
    }

    #[test]
    fn a_constant_image_is_one_basin() {
        let image = RgbImage::from_pixel(9, 6, image::Rgb([10, 200, 90]));
        assert_eq!(GradientImage::new(&ScaledOklabImage::new(&image), 0.8).basins().1, 1);
    }
}
