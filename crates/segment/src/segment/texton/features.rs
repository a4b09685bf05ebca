//! Features of a candidate mask, from the texton network and from the image.

use super::network::Embedding;
use image::RgbImage;
use vtex_base::raster::colour::{of_pixels, oklab};
use vtex_base::raster::{Mask, Span};

/// Number of features.
pub const FEATURES: usize = 32;
/// Indices of the predicted IoU, the stability, and the region tree's score.
pub(super) const PREDICTED: usize = 23;
pub(super) const STABILITY: usize = 24;
pub(super) const REGION: usize = 27;
/// Quantile of the steps along a rim that serves as the rim's strength.
const QUANTILE: f64 = 0.3;

/// Measures of a mask from the search that found it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SearchMeasures {
    /// IoU predicted by the network; 0 for a node of the region tree.
    pub(super) predicted_iou: f32,
    /// Stability; see [`crate::segment::prompt::FoundMask`].
    pub(super) stability: f32,
    pub(super) votes: u32,
    /// Score of the most similar node of the region tree, times its IoU.
    pub(super) region: f32,
    /// Largest IoU with a mask found at another scale.
    pub(super) agreement: f32,
    /// For a mask of the network, the largest IoU with a node of the region tree, and vice versa.
    pub(super) cross: f32,
}

/// Measurements of the whole image, shared by all masks.
pub(super) struct MaskFeatureContext {
    width: i32,
    height: i32,
    colours: Vec<[f32; 3]>,
    fine: ScaleMaps,
    coarse: ScaleMaps,
    /// For each cell of the fine maps, the squared length of its appearance, and its largest expected IoU
    /// as a logit.
    squares: Vec<f32>,
    quality: Vec<f32>,
    /// Means of the two probability maps over the image.
    texton: f32,
    border: f32,
}

/// The network's maps of the image at one scale.
struct ScaleMaps {
    /// Cells per pixel.
    scale: f32,
    embedding: Embedding,
    /// Probabilities, row by row.
    texton: Vec<f32>,
    border: Vec<f32>,
    /// Column of cells of each column of pixels, and first cell of each row of pixels.
    columns: Vec<u32>,
    rows: Vec<u32>,
}

impl ScaleMaps {
    fn new(embedding: Embedding, scale: f32, [width, height]: [u32; 2]) -> Self {
        let sure = |v: f32| 1.0 / (1.0 + libm::expf(-v));
        let texton = embedding.texton().map(sure).collect();
        let border = embedding.border().map(sure).collect();
        let scale = scale / super::network::CELL as f32;
        let at = |v: u32, n: usize| (((v as f32 + 0.5) * scale) as usize).min(n - 1);
        let columns = (0..width).map(|x| at(x, embedding.width) as u32).collect();
        let rows = (0..height).map(|y| (at(y, embedding.height) * embedding.width) as u32).collect();
        Self { scale, embedding, texton, border, columns, rows }
    }

    /// The first cell of a row of pixels.
    fn row(&self, y: i32) -> usize {
        self.rows[y as usize] as usize
    }

    fn cell(&self, x: i32, y: i32) -> usize {
        self.row(y) + self.columns[x as usize] as usize
    }
}

impl MaskFeatureContext {
    /// From the network's embeddings of the image at two scales.
    pub(super) fn new(image: &RgbImage, [fine, coarse]: [(Embedding, f32); 2]) -> Self {
        let size = [image.width(), image.height()];
        let fine = ScaleMaps::new(fine.0, fine.1, size);
        let cells = 0..fine.embedding.width * fine.embedding.height;
        let square =
            |i: usize| fine.embedding.cell(i)[Embedding::APPEARANCE].iter().map(|v| v * v).sum::<f32>();
        let mean = |v: &[f32]| (v.iter().map(|&v| f64::from(v)).sum::<f64>() / v.len().max(1) as f64) as f32;
        Self {
            width: image.width() as i32,
            height: image.height() as i32,
            colours: of_pixels(image, oklab),
            squares: cells.clone().map(square).collect(),
            quality: cells.map(|i| fine.embedding.quality(i)).collect(),
            texton: mean(&fine.texton),
            border: mean(&fine.border),
            fine,
            coarse: ScaleMaps::new(coarse.0, coarse.1, size),
        }
    }

    /// The features of a non-empty mask.
    pub(super) fn features(&self, mask: &Mask, origin: &SearchMeasures) -> [f32; FEATURES] {
        let inside = self.inside(mask);
        let rim = self.rim(mask);
        let area = inside.area;
        let (x0, y0, x1, y1) = mask.bounds().unwrap_or((0, 0, 1, 1));
        let perimeter = rim.cracks.max(1.0) * std::f32::consts::FRAC_PI_4;
        let ln = |v: f32| libm::logf(v.max(0.0) + 1e-3);
        [
            libm::logf(area),
            (4.0 * std::f32::consts::PI * area / (perimeter * perimeter)).min(1.2),
            inside.elongation,
            area / ((x1 - x0) * (y1 - y0)) as f32,
            rim.outside / rim.cracks.max(1.0),
            inside.texton[0],
            rim.texton[0],
            rim.border[0],
            rim.border_quantile,
            inside.border[0],
            inside.texton[1],
            rim.texton[1],
            rim.border[1],
            inside.border[1],
            ln(inside.appearance),
            ln(rim.appearance),
            ln(rim.appearance) - ln(inside.appearance),
            ln(inside.centre_spread / area),
            inside.centre_offset / area.sqrt(),
            ln(10.0 * rim.colour),
            ln(10.0 * rim.colour_quantile),
            ln(10.0 * inside.colour),
            inside.quality,
            origin.predicted_iou,
            origin.stability,
            libm::logf(origin.votes as f32 + 1.0),
            f32::from(u8::from(origin.votes > 0)),
            origin.region,
            origin.agreement,
            origin.cross,
            self.texton,
            self.border,
        ]
    }

    fn inside(&self, mask: &Mask) -> Inside {
        const APPEARANCE: usize = Embedding::APPEARANCE.end;
        let place = Embedding::CENTRE_RANGE.start;
        let centre = |cell: usize| -> [f32; 2] {
            let cell = self.fine.embedding.cell(cell);
            [cell[place], cell[place + 1]]
        };
        // Centres relative to one of them, so that single precision is enough for their squares.
        let origin = mask.spans().first().map_or([0.0; 2], |s| centre(self.fine.cell(s.x0, s.y)));
        let (mut appearance, mut appearance_square) = ([0.0f64; APPEARANCE], 0.0f64);
        let (mut centres, mut centre_square) = ([0.0f64; 2], 0.0f64);
        let (mut colour, mut colour_square) = ([0.0f64; 3], 0.0f64);
        let (mut texton, mut border, mut quality) = ([0.0f64; 2], [0.0f64; 2], 0.0f64);
        let (mut moments, mut n) = ([0.0f64; 5], 0.0f64);
        for &Span { y, x0, x1 } in mask.spans() {
            // Sums of a run, in single precision.
            let (mut looks, mut looks_square) = ([0.0f32; APPEARANCE], 0.0f32);
            let (mut away, mut away_square) = ([0.0f32; 2], 0.0f32);
            let (mut colours, mut colours_square) = ([0.0f32; 3], 0.0f32);
            let mut maps = [0.0f32; 3];
            let (row, coarse_row) = (self.fine.row(y), self.coarse.row(y));
            for x in x0 as usize..x1 as usize {
                let fine = row + self.fine.columns[x] as usize;
                let coarse = coarse_row + self.coarse.columns[x] as usize;
                let cell = self.fine.embedding.cell(fine);
                for k in 0..APPEARANCE {
                    looks[k] += cell[k];
                }
                looks_square += self.squares[fine];
                for (k, v) in centre(fine).into_iter().enumerate() {
                    away[k] += v - origin[k];
                    away_square += (v - origin[k]) * (v - origin[k]);
                }
                for (sum, v) in colours.iter_mut().zip(self.colours[y as usize * self.width as usize + x]) {
                    *sum += v;
                    colours_square += v * v;
                }
                let here = [self.fine.texton[fine], self.coarse.texton[coarse], self.quality[fine]];
                maps.iter_mut().zip(here).for_each(|(sum, v)| *sum += v);
            }
            let add = |sums: &mut [f64], run: &[f32]| {
                sums.iter_mut().zip(run).for_each(|(sum, &v)| *sum += f64::from(v));
            };
            add(&mut appearance, &looks);
            add(&mut centres, &away);
            add(&mut colour, &colours);
            add(&mut texton, &maps);
            quality += f64::from(maps[2]);
            appearance_square += f64::from(looks_square);
            centre_square += f64::from(away_square);
            colour_square += f64::from(colours_square);
            // Sums of the places of pixels' centres and of their squares.
            let (from, to, count) = (f64::from(x0), f64::from(x1), f64::from(x1 - x0));
            let (px, py) = (count * (from + to) / 2.0, f64::from(y) + 0.5);
            let squares = (to * to * to - from * from * from) / 3.0 - count / 12.0;
            for (m, v) in moments.iter_mut().zip([px, count * py, squares, count * py * py, px * py]) {
                *m += v;
            }
            n += count;
        }
        let interior = mask.interior();
        for (x, y) in interior.pixels() {
            border[0] += f64::from(self.fine.border[self.fine.cell(x, y)]);
            border[1] += f64::from(self.coarse.border[self.coarse.cell(x, y)]);
        }
        let inner = f64::from(interior.area());
        let spread = |square: f64, sums: &[f64]| {
            let mean: f64 = sums.iter().map(|s| s * s).sum::<f64>() / n;
            ((square - mean).max(0.0) / n) as f32
        };
        let mean = [moments[0] / n, moments[1] / n];
        let (xx, yy) = (moments[2] / n - mean[0] * mean[0], moments[3] / n - mean[1] * mean[1]);
        let xy = moments[4] / n - mean[0] * mean[1];
        let root = libm::sqrt((xx - yy) * (xx - yy) / 4.0 + xy * xy);
        let (long, short) = ((xx + yy) / 2.0 + root, ((xx + yy) / 2.0 - root).max(0.0));
        // Predicted centres are in units of pixels of the enlarged image.
        let unit = super::encoder::UNIT / (self.fine.scale * super::network::CELL as f32);
        let offset = [0, 1].map(|k| (f64::from(origin[k]) + centres[k] / n) * f64::from(unit) - mean[k]);
        Inside {
            area: n as f32,
            elongation: libm::sqrt((short + 0.08) / (long + 0.08)) as f32,
            texton: texton.map(|v| (v / n) as f32),
            border: border.map(|v| if inner > 0.0 { (v / inner) as f32 } else { 0.5 }),
            appearance: spread(appearance_square, &appearance),
            centre_spread: spread(centre_square, &centres) * unit * unit,
            centre_offset: libm::sqrt(offset[0] * offset[0] + offset[1] * offset[1]) as f32,
            colour: spread(colour_square, &colour).sqrt(),
            quality: (quality / n) as f32,
        }
    }

    fn rim(&self, mask: &Mask) -> RimMeans {
        let (mut borders, mut steps) = (Vec::new(), Vec::new());
        let (mut coarse, mut appearance, mut texton) = (0.0f64, 0.0f64, [0.0f64; 2]);
        let (mut cracks, mut outside) = (0.0f32, 0.0f32);
        mask.for_cracks(|[x, y], [dx, dy], thick| {
            cracks += 1.0;
            let (ox, oy) = (x + dx, y + dy);
            if ox < 0 || oy < 0 || ox >= self.width || oy >= self.height {
                outside += 1.0;
                return;
            }
            let within = if thick { (x - dx, y - dy) } else { (x, y) };
            let (fx, fy) = ((ox + dx).clamp(0, self.width - 1), (oy + dy).clamp(0, self.height - 1));
            let at = |m: &ScaleMaps, map: &[f32]| map[m.cell(x, y)].max(map[m.cell(ox, oy)]);
            borders.push(at(&self.fine, &self.fine.border));
            coarse += f64::from(at(&self.coarse, &self.coarse.border));
            let (a, b) = (self.fine.cell(within.0, within.1), self.fine.cell(fx, fy));
            texton[0] += f64::from(self.fine.texton[b]);
            texton[1] += f64::from(self.coarse.texton[self.coarse.cell(fx, fy)]);
            let [a, b] = [a, b].map(|i| &self.fine.embedding.cell(i)[Embedding::APPEARANCE]);
            let mut squares = [0.0f32; 4];
            for (a, b) in a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0) {
                for k in 0..4 {
                    squares[k] += (a[k] - b[k]) * (a[k] - b[k]);
                }
            }
            appearance += f64::from(squares.iter().sum::<f32>());
            let colour = |(x, y): (i32, i32)| self.colours[(y * self.width + x) as usize];
            let d2: f32 = colour(within).iter().zip(colour((fx, fy))).map(|(a, b)| (a - b) * (a - b)).sum();
            steps.push(d2.sqrt());
        });
        let n = borders.len().max(1) as f64;
        let mean = |v: &[f32]| (v.iter().map(|&v| f64::from(v)).sum::<f64>() / n) as f32;
        RimMeans {
            cracks,
            outside,
            texton: texton.map(|v| (v / n) as f32),
            border: [mean(&borders), (coarse / n) as f32],
            border_quantile: quantile(&mut borders),
            appearance: (appearance / n) as f32,
            colour: mean(&steps),
            colour_quantile: quantile(&mut steps),
        }
    }
}

fn quantile(values: &mut [f32]) -> f32 {
    let at = (QUANTILE * values.len() as f64) as usize;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(at, f32::total_cmp).1 }
}

/// Sums over a mask's pixels; arrays of two hold the values at the fine and the coarse scale.
struct Inside {
    area: f32,
    elongation: f32,
    texton: [f32; 2],
    border: [f32; 2],
    appearance: f32,
    centre_spread: f32,
    centre_offset: f32,
    colour: f32,
    quality: f32,
}

/// Means along the rim of a mask.
struct RimMeans {
    cracks: f32,
    /// Number of cracks on the image's border.
    outside: f32,
    texton: [f32; 2],
    border: [f32; 2],
    border_quantile: f32,
    appearance: f32,
    colour: f32,
    colour_quantile: f32,
}
