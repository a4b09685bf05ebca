//! What of a picture is correlated: its colours and its edges, without clouds.

use image::RgbImage;
use vtex_base::raster::blur::{Plane, oklab_planes};
use vtex_base::raster::continued;

/// Deviation of the blur that is subtracted, as a share of the shorter side, so that clouds do not count as
/// periods.
const LARGEST: f32 = 1.0 / 8.0;
/// Deviation of the blur that removes structure smaller than an element, in pixels.
const SMALLEST: f32 = 0.8;
/// Edges stronger than those of this share of the pixels count as these do.
const STRONGEST: f64 = 0.98;

/// Planes of one size, each of mean zero.
pub(super) struct Maps {
    /// Lightness and the main axis of chroma, in Oklab.
    pub(super) colour: [Plane; 2],
    /// Strength of edges.
    pub(super) edges: Plane,
    /// Strength of edges, times cosine and sine of twice the direction across them.
    pub(super) turned: [Plane; 2],
}

impl Maps {
    /// The maps of a picture. One that `repeats` has no clouds: whatever it has, it has in each period.
    pub(super) fn new(image: &RgbImage, repeats: bool) -> Self {
        let [l, a, b] = oklab_planes(image, 1);
        let size = l.size;
        let fine = [l, main_component(&a, &b)].map(|plane| plane.blurred(SMALLEST, [repeats; 2]));
        let [edges, cosine, sine] = edges(&fine, repeats);
        let sigma = LARGEST * size[0].min(size[1]) as f32;
        let clear = |plane: &Plane| {
            let mut values = plane.values.clone();
            if !repeats {
                values.iter_mut().zip(clouds(plane, sigma)).for_each(|(value, cloud)| *value -= cloud);
            }
            let mean = values.iter().sum::<f32>() / values.len().max(1) as f32;
            Plane { size, values: values.into_iter().map(|v| v - mean).collect() }
        };
        Self { colour: fine.each_ref().map(clear), edges: clear(&edges), turned: [&cosine, &sine].map(clear) }
    }
}

/// A plane under a wide Gaussian: that of the means of its blocks, drawn out again.
fn clouds(plane: &Plane, sigma: f32) -> Vec<f32> {
    /// Blocks to a standard deviation.
    const BLOCKS: f32 = 5.0;
    let [width, height] = plane.size;
    let side = ((sigma / BLOCKS) as usize).max(1);
    let size = [width.div_ceil(side), height.div_ceil(side)];
    let mut blocks = Plane { size, values: vec![0.0; size[0] * size[1]] };
    let length = |k: usize, block: usize| side.min(plane.size[k] - block * side) as f32;
    for (y, row) in plane.values.chunks_exact(width).enumerate() {
        for (x, value) in row.iter().enumerate() {
            let at = [x / side, y / side];
            blocks.values[at[1] * size[0] + at[0]] += value / (length(0, at[0]) * length(1, at[1]));
        }
    }
    let blurred = blocks.blurred(sigma / side as f32, [false; 2]);
    // The block before a pixel, and the share of the next.
    let before = |k: usize, i: usize| {
        let at = ((i as f32 + 0.5) / side as f32 - 0.5).clamp(0.0, (size[k] - 1) as f32);
        (at as usize, (at as usize + 1).min(size[k] - 1), at.fract())
    };
    let columns: Vec<_> = (0..width).map(|x| before(0, x)).collect();
    let mut values = Vec::with_capacity(width * height);
    for y in 0..height {
        let (above, below, down) = before(1, y);
        values.extend(columns.iter().map(|&(left, right, across)| {
            let row = |y: usize| blurred.at(left, y) * (1.0 - across) + blurred.at(right, y) * across;
            row(above) * (1.0 - down) + row(below) * down
        }));
    }
    values
}

/// Strength of edges in several planes together, and that times cosine and sine of twice the direction across
/// them: from the sum of their structure tensors (Di Zenzo, "A Note on the Gradient of a Multi-Image", 1986).
fn edges(planes: &[Plane; 2], repeats: bool) -> [Plane; 3] {
    let size = planes[0].size;
    // The pixel before and that after.
    let beside = |k: usize, v: usize| [v as i64 - 1, v as i64 + 1].map(|v| continued(v, size[k], repeats));
    let mut values = Vec::with_capacity(size[0] * size[1]);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let ([left, right], [above, below]) = (beside(0, x), beside(1, y));
            let slope = |p: &Plane| [p.at(right, y) - p.at(left, y), p.at(x, below) - p.at(x, above)];
            let [mut along, mut across, mut both] = [0.0; 3];
            for [u, v] in planes.each_ref().map(slope) {
                along += u * u;
                across += v * v;
                both += u * v;
            }
            values.push([(along + across).sqrt(), along - across, 2.0 * both]);
        }
    }
    let mut sorted: Vec<f32> = values.iter().map(|v| v[0]).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let most = sorted[((sorted.len() - 1) as f64 * STRONGEST) as usize];
    let of = |[strength, cosine, sine]: [f32; 3]| {
        let square = (strength * strength).max(f32::MIN_POSITIVE);
        let strength = strength.min(most);
        [strength, strength * cosine / square, strength * sine / square]
    };
    values.iter_mut().for_each(|v| *v = of(*v));
    [0, 1, 2].map(|k| Plane { size, values: values.iter().map(|v| v[k]).collect() })
}

/// The component of two planes along their axis of largest variance.
fn main_component(a: &Plane, b: &Plane) -> Plane {
    let count = a.values.len().max(1) as f32;
    let [ma, mb] = [a, b].map(|p| p.values.iter().sum::<f32>() / count);
    let (mut aa, mut ab, mut bb) = (0f32, 0f32, 0f32);
    for (&u, &v) in a.values.iter().zip(&b.values) {
        let (u, v) = (u - ma, v - mb);
        (aa, ab, bb) = (aa + u * u, ab + u * v, bb + v * v);
    }
    let (sine, cosine) = libm::sincosf(0.5 * libm::atan2f(2.0 * ab, aa - bb));
    let values = a.values.iter().zip(&b.values).map(|(u, v)| cosine * u + sine * v).collect();
    Plane { size: a.size, values }
}
