//! The canvas on one level: the source of each cell, and its features.

use super::atlas::Atlas;
use super::{CHANNELS, LANES, REACH};
use vtex_base::sampling::Stream;

/// A canvas on one level.
#[derive(Clone)]
pub(super) struct LevelCanvas {
    /// Size in cells.
    pub(super) size: [usize; 2],
    pub(super) wrap: [bool; 2],
    /// Group that each cell takes its source from.
    pub(super) groups: Option<Vec<u8>>,
    /// Preference for sources that continue adjacent cells, 0 to 1.
    pub(super) coherence: f32,
    /// Cells that need a source.
    pub(super) active: Option<Vec<bool>>,
    /// Source of each cell, row by row.
    pub(super) sources: Vec<u32>,
    /// Squared distance between the neighbourhood of each cell and that of its source.
    pub(super) costs: Vec<i32>,
    /// Features of each cell, with a frame of [`REACH`] cells.
    pub(super) values: Vec<i16>,
}

/// Sizes of a canvas on each level, from the finest.
pub(super) fn sizes(finest: [usize; 2], levels: usize) -> Vec<[usize; 2]> {
    std::iter::successors(Some(finest), |s| Some(s.map(|v| v.div_ceil(2)))).take(levels).collect()
}

/// Values of the finest level, sampled on a coarser one.
pub(super) fn reduced(values: &[u8], size: [usize; 2], coarse: [usize; 2]) -> Vec<u8> {
    let at = |x: usize, y: usize| {
        let [u, v] = [(2 * x + 1) * size[0] / (2 * coarse[0]), (2 * y + 1) * size[1] / (2 * coarse[1])];
        values[v.min(size[1] - 1) * size[0] + u.min(size[0] - 1)]
    };
    (0..coarse[1]).flat_map(|y| (0..coarse[0]).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect()
}

/// For each cell of a coarser level, whether a value of the finest level is set within it or beside it.
pub(super) fn any_within(values: &[bool], size: [usize; 2], coarse: [usize; 2]) -> Vec<bool> {
    let range = |v: usize, k: usize| {
        let cells = size[k].div_ceil(coarse[k]);
        (v * cells).saturating_sub(cells)..((v + 2) * cells).min(size[k])
    };
    let any = |x: usize, y: usize| range(y, 1).any(|v| values[v * size[0]..][range(x, 0)].contains(&true));
    (0..coarse[1]).flat_map(|y| (0..coarse[0]).map(move |x| (x, y))).map(|(x, y)| any(x, y)).collect()
}

impl LevelCanvas {
    /// A canvas without sources, with the groups and the activity of its cells.
    pub(super) fn new(
        size: [usize; 2],
        wrap: [bool; 2],
        (groups, active): (Option<Vec<u8>>, Option<Vec<bool>>),
    ) -> Self {
        let framed = (size[0] + 2 * REACH) * (size[1] + 2 * REACH);
        let cells = size[0] * size[1];
        Self {
            size,
            wrap,
            groups,
            active,
            coherence: 0.0,
            sources: vec![0; cells],
            costs: vec![1; cells],
            values: vec![0; framed * LANES],
        }
    }

    /// Whether a cell needs a source.
    #[inline]
    pub(super) fn is_active(&self, cell: usize) -> bool {
        self.active.as_ref().is_none_or(|active| active[cell])
    }

    /// Initialises the sources with blocks of `block` cells from random places.
    pub(super) fn random(self, atlas: &Atlas, block: usize, random: &mut Stream) -> Self {
        let mut canvas = self;
        let size = canvas.size;
        let all: Vec<Vec<u32>> = (0..=atlas.last_group()).map(|g| atlas.sources_of(g).collect()).collect();
        for y0 in (0..size[1]).step_by(block) {
            for x0 in (0..size[0]).step_by(block) {
                let draw = random.unit();
                for y in y0..(y0 + block).min(size[1]) {
                    for x in x0..(x0 + block).min(size[0]) {
                        let i = y * size[0] + x;
                        let cells = &all[usize::from(canvas.group(i, atlas))];
                        let source = atlas.source(cells[(draw * cells.len() as f64) as usize]);
                        let at = [
                            i64::from(source.at[0]) + (x - x0) as i64,
                            i64::from(source.at[1]) + (y - y0) as i64,
                        ];
                        let continued = atlas.cell(usize::from(source.page), at);
                        let first = atlas.cell(usize::from(source.page), source.at.map(i64::from));
                        canvas.sources[i] = if atlas.inside[continued as usize] { continued } else { first };
                    }
                }
            }
        }
        canvas
    }

    /// The group that a cell takes its source from.
    pub(super) fn group(&self, cell: usize, atlas: &Atlas) -> u8 {
        self.groups.as_ref().map_or_else(|| atlas.pages[0].group, |g| g[cell])
    }

    /// Gives the cells of the next finer level, `canvas`, the finer cells of these sources.
    pub(super) fn finer(&self, coarse: &Atlas, fine: &Atlas, mut canvas: Self) -> Self {
        let size = canvas.size;
        let axis = |v: usize, k: usize| {
            let parent = v * self.size[k] / size[k];
            // The first cell of the parent.
            let first = (parent * size[k]).div_ceil(self.size[k]);
            (parent, (v - first) as i64)
        };
        let columns: Vec<_> = (0..size[0]).map(|x| axis(x, 0)).collect();
        let mut sources = Vec::with_capacity(size[0] * size[1]);
        for y in 0..size[1] {
            let (row, dy) = axis(y, 1);
            for &(column, dx) in &columns {
                let parent = coarse.source(self.sources[row * self.size[0] + column]);
                let at = [2 * i64::from(parent.at[0]) + dx, 2 * i64::from(parent.at[1]) + dy];
                sources.push(fine.cell(usize::from(parent.page), at));
            }
        }
        canvas.sources = sources;
        canvas.correct_groups(fine);
        canvas
    }

    /// Corrects cells whose source is of a wrong group: they continue a near cell of the right group, or
    /// take any source of that group.
    fn correct_groups(&mut self, atlas: &Atlas) {
        if self.groups.is_none() {
            return;
        }
        let sources = self.sources.clone();
        for i in 0..sources.len() {
            let group = self.group(i, atlas);
            if atlas.group(sources[i]) == group && atlas.inside[sources[i] as usize] {
                continue;
            }
            let [x, y] = [i % self.size[0], i / self.size[0]];
            let near = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| [dx, dy]));
            let near = near.filter_map(|[dx, dy]| {
                let q = self.neighbour([x, y], [dx, dy])?;
                atlas.moved(sources[q], -dx, -dy).filter(|&s| atlas.group(s) == group)
            });
            let found = { near }.next().or_else(|| {
                let count = atlas.sources_of(group).count();
                // Spread over the page, so that not all start at one place.
                atlas.sources_of(group).nth((i * 7919) % count.max(1))
            });
            self.sources[i] = found.unwrap_or(sources[i]);
        }
    }

    /// Index of the cell at an offset; `None` beyond a border.
    #[inline]
    pub(super) fn neighbour(&self, [x, y]: [usize; 2], [dx, dy]: [isize; 2]) -> Option<usize> {
        let axis = |v: usize, d: isize, k: usize| {
            let to = v as isize + d;
            if (0..self.size[k] as isize).contains(&to) {
                Some(to as usize)
            } else if self.wrap[k] {
                Some(to.rem_euclid(self.size[k] as isize) as usize)
            } else {
                None
            }
        };
        Some(axis(y, dy, 1)? * self.size[0] + axis(x, dx, 0)?)
    }

    /// Length of a row of values.
    pub(super) fn value_row(&self) -> usize {
        (self.size[0] + 2 * REACH) * LANES
    }

    /// Index of the first value of a cell.
    #[inline]
    pub(super) fn value_at(&self, x: usize, y: usize) -> usize {
        (y + REACH) * self.value_row() + (x + REACH) * LANES
    }

    /// Index of the first value of the patch around a cell.
    #[inline]
    pub(super) fn patch(&self, x: usize, y: usize) -> usize {
        y * self.value_row() + x * LANES
    }

    /// Fills the frame with the opposite side where the canvas repeats, else with its border.
    pub(super) fn frame(&mut self) {
        let [w, h] = self.size;
        let real = |framed: usize, size: usize, wrap: bool| {
            let v = framed as isize - REACH as isize;
            let v = if wrap { v.rem_euclid(size as isize) } else { v.clamp(0, size as isize - 1) };
            v as usize
        };
        for y in 0..h + 2 * REACH {
            let row_inside = (REACH..h + REACH).contains(&y);
            for x in 0..w + 2 * REACH {
                if row_inside && x == REACH {
                    continue;
                }
                if row_inside && (REACH..w + REACH).contains(&x) {
                    continue;
                }
                let from = self.value_at(real(x, w, self.wrap[0]), real(y, h, self.wrap[1]));
                let to = self.patch(x, y);
                self.values.copy_within(from..from + CHANNELS, to);
            }
        }
    }

    /// Sets the features of every cell to those of its source.
    pub(super) fn copy_sources(&mut self, atlas: &Atlas) {
        for y in 0..self.size[1] {
            for x in 0..self.size[0] {
                let to = self.value_at(x, y);
                self.values[to..to + CHANNELS].copy_from_slice(atlas.of(self.sources[y * self.size[0] + x]));
            }
        }
        self.frame();
    }

    /// Difference in contrast between the canvas and the first page: the sum of absolute log ratios over
    /// blocks of several sizes.
    pub(super) fn contrast_error(&self, atlas: &Atlas) -> f32 {
        let light = |cell: u32| {
            let of = atlas.of(cell);
            [of[0], of[1], of[2]].map(f32::from)
        };
        let page = &atlas.pages[0];
        let own = |x: usize, y: usize| light(self.sources[y * self.size[0] + x]);
        let theirs = |x: usize, y: usize| light(atlas.cell(0, [x as i64, y as i64]));
        let blocks = (0..).map(|k| 1 << k).take_while(|block| 3 * block <= page.size[0].min(page.size[1]));
        let error = |block: usize| {
            let (a, b) = (spread(self.size, block, own), spread(page.size, block, theirs));
            if a > 0.0 && b > 0.0 { libm::logf(a / b).abs() } else { 0.0 }
        };
        blocks.map(error).sum()
    }
}

/// Standard deviation of the means of sliding blocks of cells; 0 if fewer than 3 × 3 blocks fit side by
/// side.
fn spread(size: [usize; 2], block: usize, value: impl Fn(usize, usize) -> [f32; 3]) -> f32 {
    if size[0] < 3 * block || size[1] < 3 * block {
        return 0.0;
    }
    // Summed-area table.
    let stride = size[0] + 1;
    let mut before = vec![[0f64; 3]; stride * (size[1] + 1)];
    for y in 0..size[1] {
        let mut row = [0f64; 3];
        for x in 0..size[0] {
            let v = value(x, y);
            for c in 0..3 {
                row[c] += f64::from(v[c]);
                before[(y + 1) * stride + x + 1][c] = before[y * stride + x + 1][c] + row[c];
            }
        }
    }
    let (mut sum, mut squares, mut count) = ([0f64; 3], [0f64; 3], 0.0);
    for y in block..=size[1] {
        for x in block..=size[0] {
            count += 1.0;
            for c in 0..3 {
                let at = |y: usize, x: usize| before[y * stride + x][c];
                let all = at(y, x) - at(y - block, x) - at(y, x - block) + at(y - block, x - block);
                let mean = all / (block * block) as f64;
                sum[c] += mean;
                squares[c] += mean * mean;
            }
        }
    }
    let variance = |c: usize| (squares[c] / count - (sum[c] / count) * (sum[c] / count)).max(0.0);
    libm::sqrt((0..3).map(variance).sum::<f64>()) as f32
}
