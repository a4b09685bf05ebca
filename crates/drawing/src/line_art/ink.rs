//! Ink on paper: which cells of a picture are painted.

use image::RgbImage;
use std::ops::Range;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::raster::colour::{of_pixels, oklab, squared_distance};
use vtex_base::raster::{Connectivity, ControlMap, Ink, LabelMap, components};

/// Blocks in which the paper is measured: their number along the longer side, and their least side in pixels.
const BLOCKS: u32 = 48;
const LEAST_BLOCK: usize = 16;
/// Share of the pixels of a block, those farthest from the ink, whose mean colour is the paper's.
const PAPER: f64 = 0.3;
/// Share of the difference between ink and paper from which on a pixel is ink, and that for lines so thin, in pixels,
/// that they never reach the whole.
const INKED: f32 = 0.5;
const THINLY_INKED: f32 = 0.4;
const THIN: f64 = 2.0;
/// Least difference between ink and paper, in Oklab.
const LEAST_CONTRAST: f32 = 0.1;
/// Steps in which the threshold settles.
const STEPS: usize = 8;
/// Cells across a line, most cells along a pixel, and most cells of a page.
const CELLS: f64 = 8.0;
const FINEST: usize = 4;
const MOST_CELLS: usize = 16_000_000;
/// Largest speck and largest hole that do not count, in squares of the width of lines.
const SPECK: f64 = 1.5;
const HOLE: f64 = 0.5;
/// Least number of lines that end at a border, and share of their ink with ink opposite, where borders join.
const FEWEST_AT_BORDER: usize = 6;
const JOINED: f64 = 0.85;

/// The ink of a picture.
pub(super) struct InkOfPicture {
    /// The painted cells, of which `fine` lie along each side of a pixel.
    pub(super) cells: Ink,
    pub(super) fine: usize,
    /// How far each pixel is from the paper, in Oklab.
    pub(super) difference: Vec<f32>,
    /// Number of specks that were left out.
    pub(super) specks: usize,
}

/// The ink of a picture, unless nothing stands out from the paper. `wrap`: whether its borders join; `None` to find out.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn ink(
    image: &RgbImage,
    wrap: Option<bool>,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Option<InkOfPicture>> {
    let size = [image.width() as usize, image.height() as usize];
    let Some(difference) = differences(image, go_on)? else { return Ok(None) };
    let Some([of_paper, of_ink]) = means(&difference) else { return Ok(None) };
    let from = |share: f32| of_paper + share * (of_ink - of_paper);
    let width = mean_width(&difference, size, from(INKED));
    let threshold = from(if width < THIN { THINLY_INKED } else { INKED });
    let pixels = size[0] * size[1];
    let most = libm::floor(libm::sqrt(MOST_CELLS as f64 / pixels as f64)) as usize;
    let fine = (libm::ceil(CELLS / width) as usize).clamp(1, FINEST).min(most.max(1));
    let fine_size = size.map(|v| fine * v);
    let Some(map) = ControlMap::new(image.width(), image.height(), difference.clone()) else {
        return Ok(None);
    };
    let rows: Vec<usize> = (0..fine_size[1]).collect();
    let of_row = |y: &usize| -> Vec<bool> {
        let at = |x: usize| map.at([x as f64 + 0.5, *y as f64 + 0.5], fine_size.map(|v| v as f64));
        (0..fine_size[0]).map(|x| at(x) >= f64::from(threshold)).collect()
    };
    let mut cells = Ink { size: fine_size, wraps: [false; 2], cells: parallel::map(&rows, of_row).concat() };
    go_on()?;
    let square = (fine as f64 * width) * (fine as f64 * width);
    let specks = flip_small(&mut cells, true, SPECK * square);
    go_on()?;
    flip_small(&mut cells, false, HOLE * square);
    cells.wraps = [wrap.unwrap_or_else(|| borders_join(&cells, 0.5 * fine as f64 * width)); 2];
    Ok(Some(InkOfPicture { cells, fine, difference, specks }))
}

/// How far each pixel is from the paper, in Oklab; `None` for a picture without pixels.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn differences(image: &RgbImage, go_on: &dyn Fn() -> Result<()>) -> Result<Option<Vec<f32>>> {
    let size = [image.width() as usize, image.height() as usize];
    let colours = of_pixels(image, oklab);
    go_on()?;
    let Some(paper) = Paper::new(&colours, size) else { return Ok(None) };
    let rows: Vec<usize> = (0..size[1]).collect();
    let of_row = |y: &usize| -> Vec<f32> {
        let difference = |x| libm::sqrtf(squared_distance(colours[y * size[0] + x], paper.at(x, *y)));
        (0..size[0]).map(difference).collect()
    };
    let difference = parallel::map(&rows, of_row).concat();
    go_on()?;
    Ok(Some(difference))
}

/// The colour of the paper at each place, measured in blocks.
struct Paper {
    /// Lightness and the two axes of Oklab, a value for each block.
    components: [ControlMap; 3],
    /// Size of all blocks together, in pixels.
    size: [f64; 2],
}

impl Paper {
    fn new(colours: &[[f32; 3]], size: [usize; 2]) -> Option<Self> {
        let side = size[0].max(size[1]).div_ceil(BLOCKS as usize).max(LEAST_BLOCK);
        let blocks = size.map(|v| v.div_ceil(side));
        // Larger the farther a colour is from the ink.
        let sign = if is_mostly_light(colours) { 1.0 } else { -1.0 };
        let bareness = |colour: &[f32; 3]| sign * colour[0];
        let range = |k: usize, axis: usize| -> Range<usize> { k * side..((k + 1) * side).min(size[axis]) };
        let all: Vec<usize> = (0..blocks[0] * blocks[1]).collect();
        let of_block = |&block: &usize| -> [f32; 3] {
            let columns = range(block % blocks[0], 0);
            let mut own: Vec<[f32; 3]> = range(block / blocks[0], 1)
                .flat_map(|y| &colours[y * size[0] + columns.start..y * size[0] + columns.end])
                .copied()
                .collect();
            own.sort_by(|a, b| bareness(b).total_cmp(&bareness(a)));
            own.truncate((libm::ceil(PAPER * own.len() as f64) as usize).max(1));
            mean(&own)
        };
        let found = parallel::map(&all, of_block);
        // A block that is all ink is like the paper of its neighbours; then the steps between blocks are evened out.
        let around = |block: usize, of: &[[f32; 3]]| -> Vec<[f32; 3]> {
            let near = |v: usize, k: usize| v.saturating_sub(1)..(v + 2).min(blocks[k]);
            let columns = near(block % blocks[0], 0);
            let rows = near(block / blocks[0], 1);
            rows.flat_map(|y| columns.clone().map(move |x| of[y * blocks[0] + x])).collect()
        };
        let clear = |block: &usize| {
            let near = around(*block, &found).into_iter();
            near.max_by(|a, b| bareness(a).total_cmp(&bareness(b))).unwrap_or(found[*block])
        };
        let cleared: Vec<[f32; 3]> = all.iter().map(clear).collect();
        let even: Vec<[f32; 3]> = all.iter().map(|block| mean(&around(*block, &cleared))).collect();
        let map = |k: usize| {
            let values = even.iter().map(|c| c[k]).collect();
            ControlMap::new(blocks[0] as u32, blocks[1] as u32, values)
        };
        let components = [map(0)?, map(1)?, map(2)?];
        Some(Self { components, size: blocks.map(|v| (v * side) as f64) })
    }

    /// The colour at a pixel, between the middles of blocks.
    fn at(&self, x: usize, y: usize) -> [f32; 3] {
        [0, 1, 2].map(|k| self.components[k].at([x as f64 + 0.5, y as f64 + 0.5], self.size) as f32)
    }
}

fn mean(colours: &[[f32; 3]]) -> [f32; 3] {
    let sum = |k: usize| colours.iter().map(|c| f64::from(c[k])).fold(0.0, |a, b| a + b);
    std::array::from_fn(|k| (sum(k) / colours.len().max(1) as f64) as f32)
}

/// Whether most pixels are nearer to the lightest than to the darkest.
fn is_mostly_light(colours: &[[f32; 3]]) -> bool {
    let mut lightness: Vec<f32> = colours.iter().map(|c| c[0]).collect();
    let middle = lightness.len() / 2;
    let median = *lightness.select_nth_unstable_by(middle, f32::total_cmp).1;
    let (low, high) = lightness.iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    median >= 0.5 * (low + high)
}

/// The mean difference of the paper and that of the ink, which the middle between them divides (Ridler and Calvard
/// 1978).
pub(super) fn means(difference: &[f32]) -> Option<[f32; 2]> {
    let mut sorted = difference.to_vec();
    let high = sorted.len() - 1 - sorted.len() / 1000;
    let strongest = *sorted.select_nth_unstable_by(high, f32::total_cmp).1;
    let mut found = [0.0, strongest];
    for _ in 0..STEPS {
        let middle = 0.5 * (found[0] + found[1]);
        let (mut sums, mut counts) = ([0.0; 2], [0u64; 2]);
        for d in difference {
            let k = usize::from(*d >= middle);
            sums[k] += f64::from(*d);
            counts[k] += 1;
        }
        found = [0, 1].map(|k| (sums[k] / counts[k].max(1) as f64) as f32);
    }
    (found[1] - found[0] >= LEAST_CONTRAST).then_some(found)
}

/// Mean width of lines in pixels: twice their area over the length of their borders.
pub(super) fn mean_width(difference: &[f32], [width, height]: [usize; 2], threshold: f32) -> f64 {
    let inked = |i: usize| difference[i] >= threshold;
    let area = (0..difference.len()).filter(|i| inked(*i)).count();
    let mut border = 0;
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            border += usize::from(x + 1 < width && inked(i) != inked(i + 1));
            border += usize::from(y + 1 < height && inked(i) != inked(i + width));
        }
    }
    // Borders along the grid are 4/π times as long, on average over all directions.
    let length = std::f64::consts::FRAC_PI_4 * border as f64;
    if length > 0.0 { (2.0 * area as f64 / length).max(1.0) } else { 1.0 }
}

/// Whether the ink goes on across the borders: most of what touches a border has ink within `reach` cells on the
/// opposite one.
fn borders_join(cells: &Ink, reach: f64) -> bool {
    let [width, height] = cells.size;
    let reach = libm::ceil(reach) as usize;
    let at = |x: usize, y: usize| cells.cells[y * width + x];
    let column = |x: usize| (0..height).map(|y| at(x, y)).collect::<Vec<_>>();
    let row = |y: usize| (0..width).map(|x| at(x, y)).collect::<Vec<_>>();
    let (mut inked, mut met, mut runs) = (0, 0, 0);
    let mut compare = |a: &[bool], b: &[bool]| {
        for k in (0..a.len()).filter(|k| a[*k]) {
            inked += 1;
            runs += usize::from(k == 0 || !a[k - 1]);
            met += usize::from(b[k.saturating_sub(reach)..(k + reach + 1).min(b.len())].contains(&true));
        }
    };
    for [one, other] in [[column(0), column(width - 1)], [row(0), row(height - 1)]] {
        compare(&one, &other);
        compare(&other, &one);
    }
    runs >= FEWEST_AT_BORDER && met as f64 >= JOINED * inked as f64
}

/// Makes paper of small pieces of ink, or ink of small pieces of paper, and says of how many.
fn flip_small(cells: &mut Ink, painted: bool, most: f64) -> usize {
    let [width, height] = cells.size.map(|v| v as u32);
    let mut map = LabelMap::filled(width, height, 0);
    for (label, cell) in map.labels.iter_mut().zip(&cells.cells) {
        *label = u32::from(*cell == painted);
    }
    let connectivity = if painted { Connectivity::Eight } else { Connectivity::Four };
    let (pieces, _) = components(&map, connectivity);
    let areas = pieces.areas();
    let is_small = |label: u32| label > 0 && f64::from(areas[label as usize]) < most;
    for (label, cell) in pieces.labels.iter().zip(&mut cells.cells) {
        if is_small(*label) {
            *cell = !painted;
        }
    }
    (1..areas.len()).filter(|l| is_small(*l as u32)).count()
}
