//! A palette of 256 colours for many pictures: median cut (Heckbert 1982) along the largest variance, and ordered
//! dithering (Bayer 1973).

use tiny_skia::Pixmap;

/// Bits of a component that the colour table keeps.
const BITS: u32 = 5;
/// Side of the colour table, in cells.
const SIDE: usize = 1 << BITS;
/// Most colours besides the transparent one.
const MOST: usize = 255;
/// Largest shift of a component by dithering, in 8-bit steps.
const SPREAD: f64 = 6.0;

/// A palette, and the nearest colour of each cell of the colour table.
pub(super) struct AnimationPalette {
    /// Red, green and blue of each colour; the last is transparent.
    colours: Vec<u8>,
    /// Index of the colour nearest to the middle of each cell.
    nearest: Vec<u8>,
    /// Whether a pixel of the pictures is transparent.
    transparent: bool,
}

/// Sums over the pixels in one cell of the colour table.
#[derive(Clone, Copy, Default)]
struct ColourCell {
    count: u64,
    sum: [u64; 3],
    squares: [u64; 3],
}

impl AnimationPalette {
    /// The palette of some pictures. Pixels that are less than half opaque are transparent.
    pub(super) fn new(pictures: &[Pixmap]) -> Self {
        let mut cells = vec![ColourCell::default(); SIDE * SIDE * SIDE];
        let mut transparent = false;
        for pixel in pictures.iter().flat_map(|p| p.pixels()) {
            if pixel.alpha() < 128 {
                transparent = true;
                continue;
            }
            let c = pixel.demultiply();
            let rgb = [c.red(), c.green(), c.blue()];
            let cell = &mut cells[index(rgb)];
            cell.count += 1;
            for k in 0..3 {
                cell.sum[k] += u64::from(rgb[k]);
                cell.squares[k] += u64::from(rgb[k]) * u64::from(rgb[k]);
            }
        }
        let used: Vec<ColourCell> = cells.into_iter().filter(|c| c.count > 0).collect();
        let mut colours = median_cut(used);
        let components: Vec<[i32; 3]> = colours.iter().map(|c| c.map(i32::from)).collect();
        let nearest = |i: usize| {
            let middle =
                [i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE].map(|v| (v * 256 / SIDE + 128 / SIDE) as i32);
            let distance =
                |c: &[i32; 3]| (0..3).map(|k| (c[k] - middle[k]) * (c[k] - middle[k])).sum::<i32>();
            // Ties go to the first.
            components.iter().enumerate().min_by_key(|(_, c)| distance(c)).map_or(0, |(k, _)| k as u8)
        };
        let nearest = (0..SIDE * SIDE * SIDE).map(nearest).collect();
        colours.resize(MOST + 1, [0; 3]);
        Self { colours: colours.concat(), nearest, transparent }
    }

    /// All 256 colours, as a GIF stores them.
    pub(super) fn colours(&self) -> &[u8] {
        &self.colours
    }

    /// Index of the transparent colour, if a pixel is transparent.
    pub(super) fn transparent(&self) -> Option<u8> {
        self.transparent.then_some(MOST as u8)
    }

    /// Writes the colour indices of row `y` of a picture to `line`.
    pub(super) fn index_row(&self, picture: &Pixmap, y: usize, line: &mut [u8]) {
        const BAYER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
        let width = picture.width() as usize;
        for (x, (pixel, out)) in picture.pixels()[y * width..][..width].iter().zip(line).enumerate() {
            let c = pixel.demultiply();
            if c.alpha() < 128 && self.transparent {
                *out = MOST as u8;
                continue;
            }
            let shift = (f64::from(BAYER[y % 4][x % 4]) + 0.5) / 16.0 - 0.5;
            let shift = libm::round(shift * 2.0 * SPREAD) as i16;
            let moved = |v: u8| (i16::from(v) + shift).clamp(0, 255) as u8;
            *out = self.nearest[index([c.red(), c.green(), c.blue()].map(moved))];
        }
    }
}

/// Index of the cell of a colour in the colour table.
fn index(rgb: [u8; 3]) -> usize {
    let [r, g, b] = rgb.map(|v| usize::from(v) >> (8 - BITS));
    (r * SIDE + g) * SIDE + b
}

/// The mean colours of groups of cells. The group with the largest spread is halved until there are [`MOST`].
fn median_cut(cells: Vec<ColourCell>) -> Vec<[u8; 3]> {
    let mut groups = vec![CellGroup::new(cells)];
    while groups.len() < MOST {
        let widest = groups.iter().enumerate().max_by_key(|(i, group)| (group.spread, std::cmp::Reverse(*i)));
        let Some((i, _)) = widest.filter(|(_, group)| group.spread > 0) else { break };
        let [a, b] = groups.swap_remove(i).halves();
        groups.extend([a, b]);
    }
    let totals = groups.iter().map(|group| &group.total).filter(|total| total.count > 0);
    totals.map(|total| total.sum.map(|v| (v / total.count) as u8)).collect()
}

/// A group of cells.
struct CellGroup {
    cells: Vec<ColourCell>,
    /// The sums of all cells.
    total: ColourCell,
    /// The component with the largest sum of squared deviations.
    axis: usize,
    /// Its sum of squared deviations; 0 for a single cell.
    spread: u64,
}

impl CellGroup {
    fn new(cells: Vec<ColourCell>) -> Self {
        let mut total = ColourCell::default();
        for cell in &cells {
            total.count += cell.count;
            for k in 0..3 {
                total.sum[k] += cell.sum[k];
                total.squares[k] += cell.squares[k];
            }
        }
        let spread = |k: usize| {
            let mean = u128::from(total.sum[k]) * u128::from(total.sum[k]) / u128::from(total.count.max(1));
            u64::try_from(u128::from(total.squares[k]).saturating_sub(mean)).unwrap_or(u64::MAX)
        };
        let axis = (0..3).rev().max_by_key(|&k| spread(k)).unwrap_or(0);
        let spread = if cells.len() > 1 { spread(axis) } else { 0 };
        Self { cells, total, axis, spread }
    }

    /// The two halves, cut at the mean; neither is empty.
    fn halves(mut self) -> [Self; 2] {
        let k = self.axis;
        let mean = |c: &ColourCell| c.sum[k] * 256 / c.count;
        self.cells.sort_by_key(mean);
        let middle = self.total.sum[k] * 256 / self.total.count;
        let at = self.cells.partition_point(|c| mean(c) < middle).clamp(1, self.cells.len() - 1);
        let second = self.cells.split_off(at);
        [Self::new(self.cells), Self::new(second)]
    }
}
