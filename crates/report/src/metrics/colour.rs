//! Earth mover's distances of colour distributions: per RGB channel, and in CIE Lab.

use super::transport;
use image::RgbImage;
use vtex_base::raster::colour::linear_table;

/// Edge of a bin in Lab, in ΔE.
const BIN: f64 = 10.0;
/// Approximate number of pixels sampled for a Lab histogram: fewer only if the picture is smaller.
const PIXELS: usize = 60_000;
/// Largest number of bins in a Lab histogram; only the fullest are kept.
const BINS: usize = 500;

/// Earth mover's distance between the histograms of one channel, averaged over red, green and blue,
/// 0 to 255.
pub(super) fn emd_rgb(a: &RgbImage, b: &RgbImage) -> f64 {
    let histograms = |image: &RgbImage| {
        let mut counts = [[0.0f64; 256]; 3];
        image.pixels().for_each(|p| (0..3).for_each(|c| counts[c][usize::from(p.0[c])] += 1.0));
        let pixels = f64::from(image.width()) * f64::from(image.height());
        counts.map(|channel| channel.map(|n| n / pixels))
    };
    let (a, b) = (histograms(a), histograms(b));
    let channel = |c: usize| {
        let mut moved = 0.0f64;
        (0..256).fold(0.0, |sum, k| {
            moved += a[c][k] - b[c][k];
            sum + moved.abs()
        })
    };
    (0..3).map(channel).sum::<f64>() / 3.0
}

/// Earth mover's distance between Lab histograms with bins of 10 ΔE, solved exactly, in ΔE.
pub(super) fn emd_lab(a: &RgbImage, b: &RgbImage) -> f64 {
    let (a, b) = (lab_histogram(a), lab_histogram(b));
    let distance = |p: &[i32; 3], q: &[i32; 3]| {
        let squares: i32 = (0..3).map(|c| (p[c] - q[c]) * (p[c] - q[c])).sum();
        BIN * libm::sqrt(f64::from(squares))
    };
    transport::mean_cost(&a, &b, distance)
}

/// The fullest bins with their numbers of pixels, in the order of the bins.
fn lab_histogram(image: &RgbImage) -> Vec<([i32; 3], u64)> {
    let to_lab = LabTable::new();
    let all = image.width() as usize * image.height() as usize;
    let mut bins: Vec<[i32; 3]> = image
        .pixels()
        .step_by((all / PIXELS).max(1))
        .map(|p| to_lab.of(p.0).map(|v| libm::rint(f64::from(v) / BIN) as i32))
        .collect();
    bins.sort_unstable();
    let mut counted: Vec<([i32; 3], u64)> =
        bins.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u64)).collect();
    counted.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    counted.truncate(BINS);
    counted.sort_unstable();
    counted
}

/// Conversion of 8-bit sRGB to CIE Lab (D65, 2° observer), by table.
pub(super) struct LabTable {
    linear: &'static [f64; 256],
}

impl LabTable {
    pub(super) fn new() -> Self {
        Self { linear: linear_table() }
    }

    /// Lab of a colour: L 0 to 100, a and b roughly -100 to 100.
    pub(super) fn of(&self, rgb: [u8; 3]) -> [f32; 3] {
        let [r, g, b] = rgb.map(|v| self.linear[usize::from(v)]);
        let f = |t: f64| if t > 0.008_856 { libm::cbrt(t) } else { 7.787 * t + 16.0 / 116.0 };
        let x = f((0.412_453 * r + 0.357_580 * g + 0.180_423 * b) / 0.950_47);
        let y = f(0.212_671 * r + 0.715_160 * g + 0.072_169 * b);
        let z = f((0.019_334 * r + 0.119_193 * g + 0.950_227 * b) / 1.088_83);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)].map(|v| v as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn shifted_colours_are_as_far_apart_as_they_were_shifted() {
        let image = |by: u8| RgbImage::from_fn(40, 40, |x, y| Rgb([(x * 3 + y) as u8 + by, 90, 7]));
        assert!((emd_rgb(&image(0), &image(30)) - 10.0).abs() < 1e-9);
        assert_eq!(emd_rgb(&image(5), &image(5)), 0.0);
    }

    #[test]
    fn black_is_a_hundred_from_white_and_half_as_far_from_both() {
        let grey = |v: u8| RgbImage::from_pixel(30, 20, Rgb([v; 3]));
        let both = RgbImage::from_fn(30, 20, |x, _| Rgb([if x < 15 { 0 } else { 255 }; 3]));
        assert!((emd_lab(&grey(0), &grey(255)) - 100.0).abs() < 1e-9);
        assert!((emd_lab(&both, &grey(255)) - 50.0).abs() < 1e-9);
        assert_eq!(emd_lab(&both, &both), 0.0);
    }

    #[test]
    fn lab_of_known_colours() {
        for (rgb, lab) in [([255; 3], [100.0, 0.0, 0.0]), ([255, 0, 0], [53.24, 80.09, 67.20])] {
            let found = LabTable::new().of(rgb);
            assert!((0..3).all(|c| (found[c] - lab[c]).abs() < 0.02), "{found:?}");
        }
    }
}
