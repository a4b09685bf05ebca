//! A grid of cells finer than the photograph's pixels, on which details and secondaries are found.
//!
//! Shapes two or three pixels wide look jagged at pixel resolution: petals become squares and stems
//! fall into beads. A smoothly enlarged photograph shows where between pixels one colour changes
//! into the next.

use image::RgbImage;
use std::ops::Deref;
use vtex_base::parallel;
use vtex_base::raster::{Connectivity, Filter, LabelMap, Mask, components, resized};
use vtex_scene::library::AnalyzeParams;

/// Photographs with more pixels than this get one cell per pixel by default. Their smallest
/// elements are larger.
const LARGE_PHOTOGRAPH: u64 = 2_500_000;
/// Radius of the window of pixels that vote on a cell's label.
const REACH: i32 = 2;
/// Standard deviation of the votes' spatial weight, in pixels.
const SPATIAL_DEVIATION: f32 = 0.8;
/// Colour distance (8-bit steps) at which a vote's weight falls to a quarter.
const COLOUR_FALLOFF: f32 = 20.0;
/// A primary that keeps a smaller share of its area than this is resampled without smoothing.
const LEAST_KEPT: f64 = 0.8;

/// Marks a value as measured in cells; values in pixels have no mark. It holds an image, a label map or a
/// mask of cells, or parameters whose lengths and areas count cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells<T>(pub(super) T);

impl<T> Deref for Cells<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// Number of cells along each side of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubpixelGrid {
    pub(super) cells: u32,
}

impl SubpixelGrid {
    /// The grid of `params.cells` cells, or the default for the photograph's size.
    pub(super) fn new(image: &RgbImage, params: &AnalyzeParams) -> Self {
        let pixels = u64::from(image.width()) * u64::from(image.height());
        let fitting = if pixels > LARGE_PHOTOGRAPH { 1 } else { 2 };
        Self { cells: if params.cells == 0 { fitting } else { params.cells } }
    }

    /// Cells per pixel along one axis.
    pub(super) fn along(self) -> f64 {
        f64::from(self.cells)
    }

    /// Cells per pixel by area.
    pub(super) fn area(self) -> f64 {
        self.along() * self.along()
    }

    /// Centroid of a mask of cells, in pixels.
    pub(super) fn centroid(self, mask: &Cells<Mask>) -> [f64; 2] {
        let centre = mask.centroid().map_or([0.0; 2], Into::into);
        centre.map(|v| to_four_digits(v / self.along()))
    }

    /// Area of a mask of cells in pixels, rounded, at least 1.
    pub(super) fn pixel_area(self, mask: &Cells<Mask>) -> u32 {
        (libm::round(f64::from(mask.area()) / self.area()) as u32).max(1)
    }

    /// The photograph enlarged to the grid, with edges sharpened to those of vector shapes. Drawing
    /// them at pixel resolution blurs them again.
    pub(super) fn image(self, image: &RgbImage) -> Cells<RgbImage> {
        if self.cells == 1 {
            return Cells(image.clone());
        }
        let (w, h) = (image.width() * self.cells, image.height() * self.cells);
        Cells(steepened(&resized(image, w, h, Filter::CatmullRom)))
    }

    /// The parameters for details and secondaries, with areas and lengths converted to cells.
    pub(super) fn params(self, params: &AnalyzeParams) -> Cells<AnalyzeParams> {
        let area = self.cells * self.cells;
        Cells(AnalyzeParams {
            // Colour steps between neighbouring cells shrink with their distance.
            detail_scale: params.detail_scale * self.along(),
            detail_sigma: params.detail_sigma * self.along(),
            detail_minimum: params.detail_minimum * area,
            secondary_minimum: params.secondary_minimum * area,
            secondary_maximum: params.secondary_maximum * area,
            ..params.clone()
        })
    }

    /// Upsamples a label map from pixels to cells. Near a border between labels, each cell takes a
    /// weighted vote of the pixels around it; weights fall with distance and with the difference in
    /// colour to `fine`: joint bilateral upsampling (Kopf et al. 2007). Connected labels above 0 stay
    /// connected.
    pub(super) fn labels(
        self,
        image: &RgbImage,
        fine: &Cells<RgbImage>,
        labels: &LabelMap,
    ) -> Cells<LabelMap> {
        if self.cells == 1 {
            return Cells(labels.clone());
        }
        let k = self.cells;
        let mut map = LabelMap::filled(labels.width * k, labels.height * k, 0);
        let width = map.width as usize;
        let windows = self.windows();
        parallel::for_chunks(&mut map.labels, width, |y, row| {
            for (x, label) in row.iter_mut().enumerate() {
                *label = self.vote(image, fine, labels, [x as u32, y as u32], &windows);
            }
        });
        let (before, after) = (labels.areas(), map.areas());
        let lost = |label: u32| {
            let after = after.get(label as usize).copied().unwrap_or(0);
            f64::from(after) < LEAST_KEPT * self.area() * f64::from(before[label as usize])
        };
        let thin: Vec<usize> =
            (0..labels.labels.len()).filter(|&i| labels.labels[i] != 0 && lost(labels.labels[i])).collect();
        thin.into_iter().for_each(|i| self.as_pixel(labels, &mut map, i));
        self.restore_disconnected(labels, &mut map);
        Cells(map)
    }

    /// Assigns a pixel's label to all its cells.
    fn as_pixel(self, labels: &LabelMap, map: &mut LabelMap, pixel: usize) {
        let (x, y) = (pixel as u32 % labels.width, pixel as u32 / labels.width);
        for row in 0..self.cells {
            let start = map.index(x * self.cells, y * self.cells + row);
            map.labels[start..start + self.cells as usize].fill(labels.labels[pixel]);
        }
    }

    /// Restores whole pixels where cells of a label have become disconnected from the rest of it.
    fn restore_disconnected(self, labels: &LabelMap, map: &mut LabelMap) {
        let mut whole = vec![false; labels.labels.len()];
        loop {
            let (pieces, of) = components(map, Connectivity::Four);
            let areas = pieces.areas();
            let mut largest = vec![0; of.iter().max().map_or(0, |&l| l as usize) + 1];
            for (piece, &label) in of.iter().enumerate().skip(1) {
                let best = &mut largest[label as usize];
                if *best == 0 || areas[piece] > areas[*best] {
                    *best = piece;
                }
            }
            let mut changed = false;
            for (i, &piece) in pieces.labels.iter().enumerate() {
                if piece == 0 || largest[of[piece as usize] as usize] == piece as usize {
                    continue;
                }
                let (x, y) = (i as u32 % map.width / self.cells, i as u32 / map.width / self.cells);
                for y in y.saturating_sub(1)..(y + 2).min(labels.height) {
                    for x in x.saturating_sub(1)..(x + 2).min(labels.width) {
                        let pixel = labels.index(x, y);
                        if !std::mem::replace(&mut whole[pixel], true) {
                            self.as_pixel(labels, map, pixel);
                            changed = true;
                        }
                    }
                }
            }
            if !changed {
                return;
            }
        }
    }

    /// For each cell of a pixel, row by row, its window: steps to pixels, and their weights by distance.
    fn windows(self) -> Vec<Vec<([i32; 2], f32)>> {
        let k = self.cells;
        let centre = |v: u32| (v as f32 + 0.5) / k as f32 - 0.5;
        let window = |i: u32| {
            let [x, y] = [centre(i % k), centre(i / k)];
            let steps = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| [dx, dy]));
            let weight = |[dx, dy]: [f32; 2]| near((dx - x) * (dx - x) + (dy - y) * (dy - y));
            steps.map(|step| (step, weight(step.map(|v| v as f32)))).collect()
        };
        (0..k * k).map(window).collect()
    }

    fn vote(
        self,
        image: &RgbImage,
        fine: &RgbImage,
        labels: &LabelMap,
        [x, y]: [u32; 2],
        windows: &[Vec<([i32; 2], f32)>],
    ) -> u32 {
        let k = self.cells;
        let (px, py) = (i64::from(x / k), i64::from(y / k));
        // The neighbour on the cell's side of the pixel; `None` for a cell in the middle.
        let side = |v: u32| (2 * (v % k) + 1).cmp(&k) as i64;
        let own = labels.get(x / k, y / k);
        let beside = [labels.at(px + side(x), py), labels.at(px, py + side(y))].map(|l| l.unwrap_or(own));
        if beside == [own; 2] {
            return own;
        }
        let choice = [own, beside[0], beside[1]];
        let mut votes = [0.0f32; 3];
        let here = fine.get_pixel(x, y).0.map(f32::from);
        for &([dx, dy], weight) in &windows[(y % k * k + x % k) as usize] {
            let (qx, qy) = (px + i64::from(dx), py + i64::from(dy));
            let Some(candidate) = labels.at(qx, qy).and_then(|l| choice.iter().position(|&c| c == l)) else {
                continue;
            };
            let there = image.get_pixel(qx as u32, qy as u32).0.map(f32::from);
            let apart: f32 = (0..3).map(|c| here[c] - there[c]).map(|v| v * v).sum();
            let alike = 1.0 / (1.0 + apart / (COLOUR_FALLOFF * COLOUR_FALLOFF));
            votes[candidate] += weight * alike * alike;
        }
        let best = if votes[1] > votes[0] { 1 } else { 0 };
        choice[if votes[2] > votes[best] { 2 } else { best }]
    }

    /// Downsamples a label map from cells to pixels. A pixel is labelled if at least half of its cells
    /// are; it takes the label of one of them.
    pub(super) fn pixels(self, map: &Cells<LabelMap>) -> LabelMap {
        let k = self.cells;
        let mut pixels = LabelMap::filled(map.width / k, map.height / k, 0);
        let width = pixels.width as usize;
        parallel::for_chunks(&mut pixels.labels, width.max(1), |y, row| {
            for (x, label) in row.iter_mut().enumerate() {
                let cells = (0..k * k).map(|i| map.get(x as u32 * k + i % k, y as u32 * k + i / k));
                let mut taken = cells.filter(|&l| l != 0);
                let first = taken.next();
                let enough = 2 * (1 + taken.count() as u32) >= k * k;
                *label = first.filter(|_| enough).unwrap_or(0);
            }
        });
        pixels
    }
}

/// Rounds to four decimals, which keeps files small.
pub(super) fn to_four_digits(v: f64) -> f64 {
    libm::round(v * 1e4) / 1e4
}

/// Replaces each cell's colour by that of the lightest or the darkest neighbour, whichever is nearer
/// in lightness. Ramps become steps at their steepest point (Kramer and Bruckner 1975).
fn steepened(image: &RgbImage) -> RgbImage {
    let (w, h) = (image.width() as i32, image.height() as i32);
    let lightness = |p: &image::Rgb<u8>| {
        let [r, g, b] = p.0.map(u32::from);
        2 * r + 5 * g + b
    };
    let mut out = image.clone();
    let row = 3 * w as usize;
    parallel::for_chunks(out.as_mut(), row, |y, row| {
        for x in 0..w {
            let here = lightness(image.get_pixel(x as u32, y as u32));
            let (mut low, mut high) = ((here, [x, y as i32]), (here, [x, y as i32]));
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let [px, py] = [(x + dx).clamp(0, w - 1), (y as i32 + dy).clamp(0, h - 1)];
                    let there = lightness(image.get_pixel(px as u32, py as u32));
                    if there < low.0 {
                        low = (there, [px, py]);
                    }
                    if there > high.0 {
                        high = (there, [px, py]);
                    }
                }
            }
            let [px, py] = if high.0 - here < here - low.0 { high.1 } else { low.1 };
            row[3 * x as usize..][..3].copy_from_slice(&image.get_pixel(px as u32, py as u32).0);
        }
    });
    out
}

/// Weight of a vote, from the square of its distance in pixels.
fn near(distance2: f32) -> f32 {
    libm::expf(-distance2 / (2.0 * SPATIAL_DEVIATION * SPATIAL_DEVIATION))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    const STONE: [f64; 3] = [190.0, 120.0, 60.0];
    const GROUND: [f64; 3] = [60.0, 80.0, 70.0];

    /// A picture of the shape `inside` (arguments in pixels), drawn with 16 samples per pixel, and the
    /// labels of the pixels that it mostly covers.
    fn drawn(side: u32, inside: impl Fn(f64, f64) -> bool) -> (RgbImage, LabelMap) {
        let mut labels = LabelMap::filled(side, side, 0);
        let image = RgbImage::from_fn(side, side, |x, y| {
            let sample = |i: u32| [i % 4, i / 4].map(|v| (f64::from(v) + 0.5) / 4.0);
            let hits =
                (0..16).map(sample).filter(|s| inside(f64::from(x) + s[0], f64::from(y) + s[1])).count();
            labels.set(x, y, u32::from(hits >= 8));
            let share = hits as f64 / 16.0;
            Rgb([0, 1, 2].map(|c| (GROUND[c] + (STONE[c] - GROUND[c]) * share) as u8))
        });
        (image, labels)
    }

    /// Number of cells with a wrong label: after upsampling, and with each pixel repeated as a block.
    fn wrong(side: u32, cells: u32, inside: impl Fn(f64, f64) -> bool) -> [usize; 2] {
        let (image, labels) = drawn(side, &inside);
        let grid = SubpixelGrid { cells };
        let map = grid.labels(&image, &grid.image(&image), &labels);
        assert_eq!((map.width, map.height), (side * cells, side * cells));
        let mut wrong = [0; 2];
        for y in 0..map.height {
            for x in 0..map.width {
                let [px, py] = [x, y].map(|v| (f64::from(v) + 0.5) / grid.along());
                let truth = u32::from(inside(px, py));
                wrong[0] += usize::from(map.get(x, y) != truth);
                wrong[1] += usize::from(labels.get(x / cells, y / cells) != truth);
            }
        }
        wrong
    }

    #[test]
    fn cells_follow_edges_better_than_pixels() {
        let disc = |x: f64, y: f64| (x - 20.3) * (x - 20.3) + (y - 19.6) * (y - 19.6) < 121.0;
        let slope = |x: f64, y: f64| y < 9.2 + 0.27 * x;
        for cells in 2..=4 {
            for [fine, blocks] in [wrong(40, cells, disc), wrong(40, cells, slope)] {
                assert!(2 * fine < blocks, "{cells}: {fine} of {blocks}");
            }
        }
    }

    #[test]
    fn what_is_a_pixel_wide_stays_whole() {
        let blade = |x: f64, y: f64| (x - y - 3.0).abs() < 0.75 || (x - 30.5).abs() < 0.5;
        let [fine, blocks] = wrong(40, 2, blade);
        assert!(fine <= blocks, "{fine} of {blocks}");
        // Holds even if its colour equals that of its surroundings.
        let grid = SubpixelGrid { cells: 2 };
        let flat = RgbImage::from_pixel(12, 12, Rgb([90; 3]));
        let mut labels = LabelMap::filled(12, 12, 0);
        (2..10).for_each(|y| labels.set(5, y, 1));
        assert_eq!(grid.labels(&flat, &grid.image(&flat), &labels).areas()[1], 32);
    }

    #[test]
    fn what_was_connected_remains_so() {
        // Noise, in which single pixels keep labels connected.
        let noise = |x: u32, y: u32| (x * 7919 + y * 104_729 + x * y * 31) % 97;
        let image = RgbImage::from_fn(30, 30, |x, y| Rgb([noise(x, y) as u8 * 2; 3]));
        let mut raw = LabelMap::filled(30, 30, 0);
        (0..30).for_each(|y| (0..30).for_each(|x| raw.set(x, y, noise(x, y) / 40)));
        let (labels, _) = components(&raw, Connectivity::Four);
        for cells in 2..=4 {
            let grid = SubpixelGrid { cells };
            let map = grid.labels(&image, &grid.image(&image), &labels);
            let (_, of) = components(&map, Connectivity::Four);
            let count = labels.areas().len();
            assert!(count > 40 && of.len() == count, "{cells}: {} of {count}", of.len());
            assert!(
                (0..map.height)
                    .any(|y| (0..map.width).any(|x| map.get(x, y) != labels.get(x / cells, y / cells)))
            );
        }
    }

    #[test]
    fn ramps_become_steps_and_plains_stay() {
        let ramp = RgbImage::from_fn(12, 3, |x, _| {
            Rgb([[20, 20, 20, 20, 40, 80, 120, 160, 180, 180, 180, 180][x as usize]; 3])
        });
        let row: Vec<u8> = steepened(&ramp).rows().next().unwrap().map(|p| p.0[0]).collect();
        assert_eq!(row, [20, 20, 20, 20, 20, 40, 80, 180, 180, 180, 180, 180]);
        let flat = RgbImage::from_pixel(5, 4, Rgb([7, 100, 200]));
        assert_eq!(steepened(&flat), flat);
    }

    #[test]
    fn pixels_hold_what_half_of_their_cells_do() {
        let grid = SubpixelGrid { cells: 2 };
        let mut map = LabelMap::filled(6, 4, 0);
        [(0, 0), (2, 1), (3, 0), (4, 2), (5, 2), (5, 3)].into_iter().for_each(|(x, y)| map.set(x, y, 3));
        assert_eq!(grid.pixels(&Cells(map)).labels, [0, 3, 0, 0, 0, 3]);
    }

    #[test]
    fn large_photographs_have_a_cell_a_pixel_unless_asked() {
        let cells = |side, cells| {
            SubpixelGrid::new(
                &RgbImage::new(side, side),
                &AnalyzeParams { cells, ..AnalyzeParams::default() },
            )
            .cells
        };
        assert_eq!(
            [cells(500, 0), cells(1581, 0), cells(1582, 0), cells(1582, 3), cells(500, 1)],
            [2, 2, 1, 3, 1]
        );
    }
}
