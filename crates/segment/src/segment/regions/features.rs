//! Features of a node of the merge tree.

use super::merge_tree::{BINS, MergedRegion, Union};
use super::oversegmentation::GradientImage;

/// Number of features.
pub const FEATURES: usize = 31;

/// Measurements of the whole image, shared by all nodes.
pub(super) struct NodeFeatureContext {
    width: usize,
    height: usize,
    sigma: f32,
    mean: [f32; 3],
    deviation: [f32; 3],
    gradient: f32,
    /// Integral image of the colours and of L², at pixel corners.
    integral: Vec<[f64; 4]>,
    /// Share of the image's pixels in each cell of colour space.
    palette: Vec<f32>,
}

/// Number of colour cells: L in steps of 5, a and b in steps of 8 from -64.
const CELLS: [usize; 3] = [21, 17, 17];

fn cell(colour: [f32; 3]) -> [usize; 3] {
    let at = |v: f32, step: f32, n: usize| ((v / step).max(0.0) as usize).min(n - 1);
    [at(colour[0], 5.0, CELLS[0]), at(colour[1] + 64.0, 8.0, CELLS[1]), at(colour[2] + 64.0, 8.0, CELLS[2])]
}

fn cell_index([l, a, b]: [usize; 3]) -> usize {
    (l * CELLS[1] + a) * CELLS[2] + b
}

impl NodeFeatureContext {
    pub(super) fn new(field: &GradientImage) -> Self {
        let (w, h) = (field.width, field.height);
        let count = (w * h) as f64;
        let mut integral = vec![[0.0f64; 4]; (w + 1) * (h + 1)];
        let mut squares = [0.0f64; 3];
        let mut counts = vec![0u32; CELLS[0] * CELLS[1] * CELLS[2]];
        for y in 0..h {
            let mut row = [0.0f64; 4];
            for x in 0..w {
                let c = field.colours[y * w + x];
                counts[cell_index(cell(c))] += 1;
                let v = c.map(f64::from);
                for k in 0..3 {
                    row[k] += v[k];
                    squares[k] += v[k] * v[k];
                }
                row[3] += v[0] * v[0];
                let above = integral[y * (w + 1) + x + 1];
                integral[(y + 1) * (w + 1) + x + 1] = std::array::from_fn(|k| above[k] + row[k]);
            }
        }
        let total = integral[(w + 1) * (h + 1) - 1];
        let mean: [f64; 3] = std::array::from_fn(|k| total[k] / count);
        let deviation =
            std::array::from_fn(|k| libm::sqrt((squares[k] / count - mean[k] * mean[k]).max(0.0)) as f32);
        let gradient = field.gradient.iter().map(|&g| f64::from(g)).sum::<f64>() / count;
        // Neighbouring cells count half, which reduces the influence of the grid's position.
        let mut palette = vec![0.0; counts.len()];
        for l in 0..CELLS[0] {
            for a in 0..CELLS[1] {
                for b in 0..CELLS[2] {
                    let at = |l, a, b| counts[cell_index([l, a, b])] as f32;
                    let mut sum = at(l, a, b);
                    let beside = [
                        (l > 0).then(|| at(l - 1, a, b)),
                        (l + 1 < CELLS[0]).then(|| at(l + 1, a, b)),
                        (a > 0).then(|| at(l, a - 1, b)),
                        (a + 1 < CELLS[1]).then(|| at(l, a + 1, b)),
                        (b > 0).then(|| at(l, a, b - 1)),
                        (b + 1 < CELLS[2]).then(|| at(l, a, b + 1)),
                    ];
                    sum += 0.5 * beside.into_iter().flatten().sum::<f32>();
                    palette[cell_index([l, a, b])] = sum / count as f32;
                }
            }
        }
        Self {
            width: w,
            height: h,
            sigma: field.sigma as f32,
            mean: mean.map(|v| v as f32),
            deviation,
            gradient: gradient as f32,
            integral,
            palette,
        }
    }

    /// Sums of colour and L², and the area, of a box with exclusive ends.
    fn sums([x0, y0, x1, y1]: [usize; 4], integral: &[[f64; 4]], width: usize) -> [f64; 5] {
        let at = |x: usize, y: usize| integral[y * (width + 1) + x];
        let (a, b, c, d) = (at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1));
        let area = ((x1 - x0) * (y1 - y0)) as f64;
        std::array::from_fn(|k| if k < 4 { d[k] - b[k] - c[k] + a[k] } else { area })
    }

    /// The features of a region. Quantities that span orders of magnitude are logarithms.
    pub(super) fn features(&self, region: &MergedRegion, union: Option<Union>) -> [f32; FEATURES] {
        let (s, rim) = (&region.sums, &region.rim);
        let ln = |v: f32| libm::logf(v.max(0.0) + 0.05);
        let length = |v: [f32; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let (n, mean) = (f64::from(s.area), s.mean());
        let border = s.border.iter().sum::<u32>() as f32;
        let perimeter = rim.length + border;
        let around = rim.length.max(1.0);

        // Second moments of position; a pixel counts as a square.
        let [x, y] = [s.place[0] / n, s.place[1] / n];
        let xx = s.place[2] / n - x * x + 1.0 / 12.0;
        let yy = s.place[3] / n - y * y + 1.0 / 12.0;
        let xy = s.place[4] / n - x * y;
        let determinant = (xx * yy - xy * xy).max(1e-3);
        let half = libm::sqrt(((xx - yy) * (xx - yy) / 4.0 + xy * xy).max(0.0));
        let (long, short) = ((xx + yy) / 2.0 + half, ((xx + yy) / 2.0 - half).max(1e-3));

        // Standard deviation of L after removing a linear slope of light.
        let variance: [f64; 3] = std::array::from_fn(|c| {
            (s.colour_square[c] / n - f64::from(mean[c]) * f64::from(mean[c])).max(0.0)
        });
        let lightness = f64::from(mean[0]);
        let (lx, ly) = (s.shade[0] / n - lightness * x, s.shade[1] / n - lightness * y);
        let explained = (lx * lx * yy - 2.0 * lx * ly * xy + ly * ly * xx) / determinant;
        let residual = (variance[0] - explained).max(0.0);

        // The surroundings: a box enlarged by half its size on each side, without the node.
        let [x0, y0, x1, y1] = s.bounds.map(|v| v as usize);
        let margin = (libm::sqrt(n) * 0.5) as usize + 3;
        let wide = [
            x0.saturating_sub(margin),
            y0.saturating_sub(margin),
            (x1 + 1 + margin).min(self.width),
            (y1 + 1 + margin).min(self.height),
        ];
        let sums = Self::sums(wide, &self.integral, self.width);
        let left = (sums[4] - n).max(1.0);
        let ring: [f32; 3] = std::array::from_fn(|c| ((sums[c] - s.colour[c]) / left) as f32);
        let ring_variance =
            ((sums[3] - s.colour_square[0]) / left - f64::from(ring[0]) * f64::from(ring[0])).max(0.0);
        let apart = [mean[0] - ring[0], mean[1] - ring[1], mean[2] - ring[2]];
        let off = [mean[0] - self.mean[0], mean[1] - self.mean[1], mean[2] - self.mean[2]];

        let mut below = 0.25 * around;
        let mut quantile = 0.0;
        for (bin, &h) in rim.histogram.iter().enumerate() {
            if h >= below {
                quantile = bin as f32 + if h > 0.0 { below / h } else { 0.0 };
                break;
            }
            below -= h;
            quantile = BINS as f32;
        }
        let box_area = ((x1 + 1 - x0) * (y1 + 1 - y0)) as f32;
        let outer = union.map_or(4.0 * region.weight + 40.0, |union| union.weight);
        let sibling = union.map_or(0.0, |union| union.area - s.area);
        let step = [rim.step[0] / around, rim.step[1] / around, rim.step[2] / around];
        let step_length = rim.step_length / around;
        [
            libm::logf(s.area),
            12.566 * s.area / (0.64 * perimeter * perimeter).max(1.0),
            (n / (4.0 * std::f64::consts::PI * libm::sqrt(determinant))) as f32,
            libm::sqrt(short / long) as f32,
            s.area / box_area,
            border / perimeter.max(1.0),
            ln(step_length),
            ln(length(step)),
            length(step) / (step_length + 0.05),
            0.1 * step[0],
            ln(rim.gradient / around),
            quantile,
            rim.faint / around,
            ln((s.gradient / n) as f32),
            ln(libm::sqrt(variance[0] + variance[1] + variance[2]) as f32),
            ln(libm::sqrt(residual) as f32),
            ln(region.weight),
            ln(outer),
            libm::logf((sibling + 1.0) / s.area),
            libm::logf(s.area / s.basins as f32),
            ln(length(apart)),
            0.1 * apart[0],
            length(apart) / (libm::sqrt(variance[0] + ring_variance) as f32 + 1.0),
            ln(length(off)),
            0.1 * off[0],
            libm::logf(self.palette[cell_index(cell(mean))] + 1e-4),
            ln(length(self.deviation)),
            ln(self.gradient),
            ln(libm::sqrt(ring_variance) as f32),
            libm::logf(outer + 0.5) - libm::logf(region.weight + 0.5),
            self.sigma,
        ]
    }
}
