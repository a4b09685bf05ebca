//! All pages of one level in one array, so that a source is a single index.

use super::{
    CHANNELS, COARSEST, CellSource, ExemplarPage, LANES, LARGEST_FEATURE, MOST_COMPARED, MOST_LEVELS, PATCH,
    Periods, REACH, UNIT,
};

/// Features in a row of a patch.
pub(super) const ROW: usize = PATCH * LANES;

/// The pages of one level, one below the other, each with a frame of [`REACH`] mirrored cells.
pub(super) struct Atlas {
    /// Number of the level; 0 is the finest.
    pub(super) level: usize,
    /// Cells in a row.
    pub(super) stride: usize,
    /// Features cell by cell.
    pub(super) features: Vec<i16>,
    /// Whether a cell can be a source.
    pub(super) inside: Vec<bool>,
    /// Group of each cell; `None` if each page has one group.
    groups: Option<Vec<u8>>,
    pub(super) pages: Vec<PagePosition>,
    /// Phase of each cell; empty if no page has periods.
    pub(super) phases: Vec<[f32; 2]>,
}

/// The position of a page in an atlas.
pub(super) struct PagePosition {
    pub(super) group: u8,
    /// Row of its first cell.
    top: usize,
    pub(super) size: [usize; 2],
    /// Cells along its border that cannot be sources: their neighbourhood is not known, and islands would
    /// continue there without end.
    rim: usize,
    pub(super) periods: Option<Periods>,
}

/// A page on one level.
struct PageLevel {
    size: [usize; 2],
    features: Vec<[f32; CHANNELS]>,
    inside: Option<Vec<bool>>,
    groups: Option<Vec<u8>>,
    periods: Option<Periods>,
}

impl PageLevel {
    /// The level reduced to half: means of 2 × 2 cells. An odd last row or column is left out.
    fn reduced(&self) -> Self {
        let size = self.size.map(|v| (v / 2).max(1));
        let mut features = Vec::with_capacity(size[0] * size[1]);
        let mut inside = self.inside.as_ref().map(|_| Vec::with_capacity(size[0] * size[1]));
        let mut groups = self.groups.as_ref().map(|_| Vec::with_capacity(size[0] * size[1]));
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = |dx: usize, dy: usize| {
                    (2 * y + dy).min(self.size[1] - 1) * self.size[0] + (2 * x + dx).min(self.size[0] - 1)
                };
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                features.push(std::array::from_fn(|c| {
                    four.iter().map(|&i| self.features[i][c]).sum::<f32>() / 4.0
                }));
                if let (Some(new), Some(old)) = (&mut inside, &self.inside) {
                    new.push(four.iter().all(|&i| old[i]));
                }
                if let (Some(new), Some(old)) = (&mut groups, &self.groups) {
                    new.push(most_frequent(four.map(|i| old[i])));
                }
            }
        }
        let periods = self.periods.as_ref().map(Periods::halved);
        Self { size, features, inside, groups, periods }
    }
}

impl Atlas {
    /// The levels, from the finest to one whose smallest page is [`COARSEST`] cells wide or high.
    pub(super) fn pyramid(pages: &[ExemplarPage]) -> Vec<Self> {
        let mut levels: Vec<PageLevel> = pages
            .iter()
            .map(|p| PageLevel {
                size: p.size,
                features: p.features.clone(),
                inside: p.inside.clone(),
                groups: p.groups.clone(),
                periods: p.periods.clone(),
            })
            .collect();
        let groups: Vec<u8> = pages.iter().map(|p| p.group).collect();
        let mut pyramid = vec![Self::new(0, &levels, &groups)];
        let shortest = |levels: &[PageLevel]| levels.iter().flat_map(|l| l.size).min().unwrap_or(0);
        // Elongated pages get coarser levels than their shorter side alone would give.
        let large = |levels: &[PageLevel]| {
            levels.iter().map(|l| l.size[0] * l.size[1]).sum::<usize>() > MOST_COMPARED
        };
        let goes_on = |levels: &[PageLevel]| {
            shortest(levels) >= 2 * COARSEST || (large(levels) && shortest(levels) >= 2 * PATCH)
        };
        while pyramid.len() < MOST_LEVELS && goes_on(&levels) {
            levels = levels.iter().map(PageLevel::reduced).collect();
            let coarser = Self::new(pyramid.len(), &levels, &groups);
            // A group of single cells may vanish, and other cells replace it. The group of a page may not.
            let has = |g: &u8| coarser.sources_of(*g).next().is_some();
            if coarser.groups.is_none() && !groups.iter().all(has) {
                break;
            }
            pyramid.push(coarser);
        }
        pyramid
    }

    fn new(level: usize, levels: &[PageLevel], groups: &[u8]) -> Self {
        let stride = levels.iter().map(|l| l.size[0]).max().unwrap_or(0) + 2 * REACH;
        let rows: usize = levels.iter().map(|l| l.size[1] + 2 * REACH).sum();
        let any_periods = levels.iter().any(|l| l.periods.is_some());
        let mut atlas = Self {
            level,
            stride,
            features: vec![0; stride * rows * LANES],
            inside: vec![false; stride * rows],
            groups: levels.first().and_then(|l| l.groups.as_ref()).map(|_| vec![0; stride * rows]),
            pages: Vec::new(),
            phases: if any_periods { vec![[0.0; 2]; stride * rows] } else { Vec::new() },
        };
        let mut top = 0;
        for (level, &group) in levels.iter().zip(groups) {
            let [w, h] = level.size;
            let rim = match w.min(h) {
                0..8 => 0,
                8..24 => 1,
                _ => REACH,
            };
            for y in 0..h + 2 * REACH {
                for x in 0..w + 2 * REACH {
                    let (px, py) = (mirrored(x, w), mirrored(y, h));
                    let to = ((top + y) * stride + x) * LANES;
                    for c in 0..CHANNELS {
                        atlas.features[to + c] = stored(level.features[py * w + px][c]);
                    }
                    let within = |v: usize, size: usize| (REACH + rim..size + REACH - rim).contains(&v);
                    let real = within(x, w) && within(y, h);
                    let inside = level.inside.as_ref().is_none_or(|i| i[py * w + px]);
                    atlas.inside[(top + y) * stride + x] = real && inside;
                    if let (Some(all), Some(own)) = (&mut atlas.groups, &level.groups) {
                        all[(top + y) * stride + x] = own[py * w + px];
                    }
                }
            }
            let periods = level.periods.clone();
            for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).filter(|_| periods.is_some()) {
                let phase = periods.as_ref().map_or([0.0; 2], |p| p.on_page([x as f32, y as f32]));
                atlas.phases[(top + REACH + y) * stride + REACH + x] = phase;
            }
            atlas.pages.push(PagePosition { group, top: top + REACH, size: level.size, rim, periods });
            top += h + 2 * REACH;
        }
        atlas
    }

    /// All cells of a group that can be sources, in order.
    pub(super) fn sources_of(&self, group: u8) -> impl Iterator<Item = u32> + '_ {
        let pages = self.pages.iter().filter(move |p| self.groups.is_some() || p.group == group);
        pages.flat_map(move |p| {
            (0..p.size[1]).flat_map(move |y| {
                let start = (p.top + y) * self.stride + REACH;
                let inside = (start..start + p.size[0]).filter(|&i| self.inside[i]);
                let own = inside.filter(move |&i| self.groups.as_ref().is_none_or(|g| g[i] == group));
                own.map(|i| i as u32)
            })
        })
    }

    /// The cells of a group for an exhaustive comparison, at most [`MOST_COMPARED`].
    pub(super) fn compared(&self, group: u8) -> Vec<u32> {
        let all: Vec<u32> = self.sources_of(group).collect();
        let step = all.len().div_ceil(MOST_COMPARED).max(1);
        all.into_iter().step_by(step).collect()
    }

    /// Replaces groups without sources on this level by the nearest group that has some.
    pub(super) fn with_sources(&self, mut groups: Vec<u8>) -> Vec<u8> {
        let last = self.last_group();
        let has: Vec<bool> = (0..=last).map(|g| self.sources_of(g).next().is_some()).collect();
        let nearest = |group: u8| {
            let known = (0..=last).filter(|&k| has[usize::from(k)]);
            known.min_by_key(|k| k.abs_diff(group)).unwrap_or(0)
        };
        let table: Vec<u8> = (0..=u8::MAX).map(nearest).collect();
        groups.iter_mut().for_each(|group| *group = table[usize::from(*group)]);
        groups
    }

    /// The highest group number.
    pub(super) fn last_group(&self) -> u8 {
        let last = match &self.groups {
            Some(groups) => groups.iter().copied().max(),
            None => self.pages.iter().map(|p| p.group).max(),
        };
        last.unwrap_or(0)
    }

    /// Group of a cell.
    pub(super) fn group(&self, cell: u32) -> u8 {
        match &self.groups {
            Some(groups) => groups[cell as usize],
            None => self.pages[self.page(cell)].group,
        }
    }

    /// Number of the page of a cell.
    pub(super) fn page(&self, cell: u32) -> usize {
        if self.pages.len() == 1 {
            return 0;
        }
        let row = cell as usize / self.stride;
        self.pages.partition_point(|p| p.top <= row + REACH).max(1) - 1
    }

    /// Page and place of a cell.
    pub(super) fn source(&self, cell: u32) -> CellSource {
        let page = self.page(cell);
        let (x, y) = (cell as usize % self.stride, cell as usize / self.stride);
        CellSource { page: page as u16, at: [(x - REACH) as u16, (y - self.pages[page].top) as u16] }
    }

    /// The cell of a page at a place, clamped to the cells that may be sources.
    pub(super) fn cell(&self, page: usize, at: [i64; 2]) -> u32 {
        let sheet = &self.pages[page];
        let (rim, size) = (sheet.rim as i64, sheet.size.map(|v| v as i64));
        let [x, y] = [0, 1].map(|k| at[k].clamp(rim, size[k] - 1 - rim) as usize);
        ((sheet.top + y) * self.stride + x + REACH) as u32
    }

    /// The cell of a page at a place, if it can be a source.
    pub(super) fn cell_within(&self, page: usize, at: [i64; 2]) -> Option<u32> {
        let size = self.pages[page].size;
        let inside = (0..2).all(|k| (0..size[k] as i64).contains(&at[k]));
        let cell = inside.then(|| self.cell(page, at))?;
        (self.source(cell).at.map(i64::from) == at && self.inside[cell as usize]).then_some(cell)
    }

    /// The cell at an offset from another, if it can be a source.
    #[inline]
    pub(super) fn moved(&self, cell: u32, dx: isize, dy: isize) -> Option<u32> {
        let at = cell as isize + dy * self.stride as isize + dx;
        (at >= 0 && self.inside.get(at as usize) == Some(&true)).then_some(at as u32)
    }

    /// Index of the first feature of the patch around a cell.
    #[inline]
    pub(super) fn patch(&self, cell: u32) -> usize {
        (cell as usize - REACH * self.stride - REACH) * LANES
    }

    /// The features of a cell.
    #[inline]
    pub(super) fn of(&self, cell: u32) -> &[i16] {
        &self.features[cell as usize * LANES..][..CHANNELS]
    }
}

/// Squared distance of two patches, each given by its features and the length of a feature row. Only values
/// below `limit` are exact.
#[inline(always)]
pub(super) fn distance(a: &[i16], a_row: usize, b: &[i16], b_row: usize, limit: i32) -> i32 {
    let mut sum = 0i32;
    for r in 0..PATCH {
        let (x, y) = (&a[r * a_row..][..ROW], &b[r * b_row..][..ROW]);
        for i in 0..ROW {
            let d = i32::from(x[i].wrapping_sub(y[i]));
            // Features are clamped, so nothing wraps; checks would keep the loop from being vectorized.
            sum = sum.wrapping_add(d.wrapping_mul(d));
        }
        if sum >= limit {
            break;
        }
    }
    sum
}

/// The most frequent of four groups. Ties go to the highest, because upper layers are thin.
fn most_frequent(four: [u8; 4]) -> u8 {
    let count = |group: u8| four.iter().filter(|&&g| g == group).count();
    four.into_iter().max_by_key(|&g| (count(g), g)).unwrap_or(0)
}

/// The stored form of a feature.
fn stored(v: f32) -> i16 {
    // Features are clamped, so that sums of squared differences fit 32 bits.
    libm::roundf(v.clamp(-LARGEST_FEATURE, LARGEST_FEATURE) * UNIT) as i16
}

/// The index within `0..size` that a framed index mirrors.
fn mirrored(framed: usize, size: usize) -> usize {
    let i = framed as i64 - REACH as i64;
    let i = if i < 0 { -1 - i } else { i };
    let i = if i >= size as i64 { 2 * size as i64 - 1 - i } else { i };
    i.clamp(0, size as i64 - 1) as usize
}
