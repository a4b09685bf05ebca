//! The search for the sources that fit the neighbourhood of each cell.

use super::atlas::{Atlas, distance};
use super::canvas::LevelCanvas;
use super::copies::BlockCopies;
use super::similar::Similar;
use super::{ALONE, CHANNELS, COHERENT, COPY, LANES, OCCURRENCE, PATCH, REACH, RowProgress, UNIT};
use vtex_base::parallel;

/// Offsets to the cells around a cell.
const AROUND: [[isize; 2]; 8] = [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -1], [1, -1], [-1, 1], [1, 1]];
/// [`Pass::step`] of exhaustive searches, of others, and of those on levels where islands hold together. In
/// exhaustive ones distant cells find the same sources too.
const SEARCH_STEPS: [usize; 3] = [4, 2, 1];
/// Distance of two patches that differ by one standard deviation in one channel.
const PATCH_UNIT: f32 = UNIT * UNIT * (PATCH * PATCH) as f32;

/// The cells that change together: one of each square of `step` × `step` cells.
#[derive(Clone, Copy)]
struct Pass {
    /// Side of the squares, in cells.
    step: usize,
    /// Column and row within the square.
    at: [usize; 2],
}

impl Pass {
    /// The passes that take every cell once.
    fn all(step: usize) -> impl Iterator<Item = Self> {
        (0..step * step).map(move |k| Self { step, at: [k % step, k / step] })
    }

    fn has_row(self, y: usize) -> bool {
        y % self.step == self.at[1]
    }

    /// Columns of the cells of a row.
    fn of_row(self, width: usize) -> impl Iterator<Item = usize> {
        (self.at[0]..width).step_by(self.step)
    }
}

impl LevelCanvas {
    /// Alternates votes and searches, the first `exhaustive` searches among all sources. No vote follows
    /// the last search.
    pub(super) fn optimise(
        &mut self,
        atlas: &Atlas,
        similar: &Similar,
        exhaustive: usize,
        iterations: usize,
        watch: &RowProgress<'_>,
    ) {
        for iteration in 0..iterations {
            self.vote(atlas, watch);
            self.match_histograms(atlas);
            self.frame();
            self.search(atlas, similar, iteration < exhaustive, None, watch);
        }
    }

    /// Like [`LevelCanvas::optimise`], but cells inside islands keep their sources and features.
    pub(super) fn refine(
        &mut self,
        atlas: &Atlas,
        similar: &Similar,
        iterations: usize,
        watch: &RowProgress<'_>,
    ) {
        for _ in 0..iterations {
            let deep = self.inside_islands(atlas);
            let open: Vec<bool> = (0..deep.len()).map(|i| !deep[i] && self.is_active(i)).collect();
            self.copy_sources(atlas);
            let all = self.active.replace(open);
            self.vote(atlas, watch);
            let open = std::mem::replace(&mut self.active, all);
            self.frame();
            self.search(atlas, similar, false, open.as_deref(), watch);
        }
    }

    /// Whether the patches over a cell and over its adjacent cells all come from one place.
    fn inside_islands(&self, atlas: &Atlas) -> Vec<bool> {
        let [w, h] = self.size;
        let all = |known: &[bool]| -> Vec<bool> {
            let around = |i: usize| {
                let at = [i % w, i / w];
                known[i] && AROUND.iter().all(|&d| self.neighbour(at, d).is_none_or(|q| known[q]))
            };
            (0..w * h).map(around).collect()
        };
        let mut whole = vec![false; w * h];
        parallel::for_chunks(&mut whole, w, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, whole)| *whole = self.is_whole(atlas, [x, y]));
        });
        // Each round adds a cell: a patch reaches two cells, and the patches over it two more.
        all(&all(&all(&whole)))
    }

    /// The occurrence cost of every cell of an atlas: it grows as the cells around it are used as sources.
    fn occurrence_costs(&self, atlas: &Atlas) -> Vec<i32> {
        let mut taken = vec![0u32; atlas.inside.len()];
        (0..self.sources.len())
            .filter(|&i| self.is_active(i))
            .for_each(|i| taken[self.sources[i] as usize] += 1);
        // Mean number of uses of a source, group by group.
        let mut wanted = vec![0f32; usize::from(atlas.last_group()) + 1];
        for i in (0..self.sources.len()).filter(|&i| self.is_active(i)) {
            wanted[usize::from(self.group(i, atlas))] += 1.0;
        }
        for (group, wanted) in (0..).zip(&mut wanted) {
            *wanted /= atlas.sources_of(group).count().max(1) as f32;
        }
        let stride = atlas.stride;
        let mut rows = vec![0u32; taken.len()];
        for (row, taken) in rows.chunks_mut(stride).zip(taken.chunks(stride)) {
            for x in REACH..stride - REACH {
                row[x] = taken[x - REACH..=x + REACH].iter().sum();
            }
        }
        let mut costs = vec![0; taken.len()];
        parallel::for_chunks(&mut costs, stride, |y, costs| {
            if y < REACH || (y + REACH + 1) * stride > rows.len() {
                return;
            }
            for (x, cost) in costs.iter_mut().enumerate() {
                let i = y * stride + x;
                if atlas.inside[i] {
                    let sum: u32 = (y - REACH..=y + REACH).map(|r| rows[r * stride + x]).sum();
                    let mean = sum as f32 / (PATCH * PATCH) as f32;
                    let ratio = mean / wanted[usize::from(atlas.group(i as u32))].max(1e-6);
                    *cost = (OCCURRENCE * PATCH_UNIT * ratio.min(1e3)) as i32;
                }
            }
        });
        costs
    }

    /// Gives every cell, or every `open` one, the best source: of its own, those that continue adjacent
    /// cells, and those similar to these; or, if `exhaustive`, of all. It takes several passes, and what
    /// frequent sources and copies cost is known anew in each: were all cells to change at once, many would
    /// take the same source together, and leave it together.
    fn search(
        &mut self,
        atlas: &Atlas,
        similar: &Similar,
        exhaustive: bool,
        open: Option<&[bool]>,
        watch: &RowProgress<'_>,
    ) {
        let groups = if exhaustive { usize::from(atlas.last_group()) + 1 } else { 0 };
        let all: Vec<Vec<u32>> = (0..groups).map(|g| atlas.compared(g as u8)).collect();
        let kind = usize::from(!exhaustive);
        let step = SEARCH_STEPS[if atlas.level < COHERENT { 2 } else { kind }];
        for pass in Pass::all(step) {
            let this = &*self;
            let occurrence = this.occurrence_costs(atlas);
            // Where only borders move, hardly any copy comes or goes.
            let copies = open.is_none().then(|| BlockCopies::new(this, atlas, exhaustive));
            // The earlier sources remain if the work is stopped.
            let mut found: Vec<(u32, i32)> =
                this.sources.iter().copied().zip(this.costs.iter().copied()).collect();
            parallel::for_chunks(&mut found, this.size[0], |y, found| {
                if !pass.has_row(y) || !watch.keep_going(this.size[0] / pass.step) {
                    return;
                }
                for x in pass.of_row(this.size[0]) {
                    let i = y * this.size[0] + x;
                    if !open.map_or_else(|| this.is_active(i), |open| open[i]) {
                        continue;
                    }
                    let mut best = Best::new(this, atlas, [x, y], &occurrence);
                    best.copies = copies.as_ref().map(|copies| (copies, i, COPY[kind]));
                    best.consider_around(this, [x, y]);
                    best.consider_periods(this.sources[i]);
                    if exhaustive {
                        best.consider_all(&all[usize::from(this.group(i, atlas))]);
                    } else {
                        for k in 0..best.known {
                            similar.of(best.seen[k]).for_each(|s| best.consider(s, 0));
                        }
                    }
                    found[x] = (best.source, best.cost);
                }
            });
            for (i, (source, cost)) in found.into_iter().enumerate() {
                (self.sources[i], self.costs[i]) = (source, cost);
            }
        }
    }

    /// The source that continues a neighbour's to this cell, if it is of the cell's group.
    #[inline]
    pub(super) fn continued(&self, atlas: &Atlas, [x, y]: [usize; 2], [dx, dy]: [isize; 2]) -> Option<u32> {
        let neighbour = self.neighbour([x, y], [dx, dy])?;
        let source = atlas.moved(self.sources[neighbour], -dx, -dy)?;
        let suits = self.groups.as_ref().is_none_or(|g| g[y * self.size[0] + x] == atlas.group(source));
        suits.then_some(source)
    }

    /// Whether the source of a cell continues those of all cells around it.
    pub(super) fn is_whole(&self, atlas: &Atlas, at: [usize; 2]) -> bool {
        let own = self.sources[at[1] * self.size[0] + at[0]];
        AROUND.iter().all(|&d| self.neighbour(at, d).is_none() || self.continued(atlas, at, d) == Some(own))
    }

    /// Passes in which every cell shows only its source, and the borders of islands move to where the
    /// neighbourhoods agree. Each pass takes a quarter of the cells, so that adjacent cells see each
    /// other's changes.
    pub(super) fn mosaic(
        &mut self,
        atlas: &Atlas,
        similar: &Similar,
        passes: usize,
        watch: &RowProgress<'_>,
    ) {
        self.copy_sources(atlas);
        let none = vec![0; atlas.inside.len()];
        for pass in (0..passes).flat_map(|_| Pass::all(2)) {
            let this = &*self;
            let mut rows: Vec<Vec<(usize, u32)>> = vec![Vec::new(); this.size[1]];
            parallel::for_chunks(&mut rows, 1, |y, changes| {
                if !pass.has_row(y) || !watch.keep_going(this.size[0] / pass.step) {
                    return;
                }
                for x in pass.of_row(this.size[0]) {
                    let i = y * this.size[0] + x;
                    if !this.is_active(i) || this.is_whole(atlas, [x, y]) {
                        continue;
                    }
                    let mut best = Best::new(this, atlas, [x, y], &none);
                    best.consider_around(this, [x, y]);
                    for k in 0..best.known {
                        similar.of(best.seen[k]).take(1).for_each(|s| best.consider(s, 0));
                    }
                    if best.source != this.sources[i] {
                        changes[0].push((x, best.source));
                    }
                }
            });
            let mut changed = false;
            for (y, row) in rows.into_iter().enumerate() {
                for (x, source) in row {
                    self.show(atlas, [x, y], source);
                    changed = true;
                }
            }
            if changed {
                self.frame();
            }
        }
    }

    /// Gives a cell a source and its features.
    pub(super) fn show(&mut self, atlas: &Atlas, [x, y]: [usize; 2], source: u32) {
        self.sources[y * self.size[0] + x] = source;
        let to = self.value_at(x, y);
        self.values[to..to + CHANNELS].copy_from_slice(atlas.of(source));
    }
}

/// The best source of a cell so far.
pub(super) struct Best<'a> {
    values: &'a [i16],
    row: usize,
    atlas: &'a Atlas,
    extra: &'a [i32],
    coherence: f32,
    /// The sources that are already used, the searching cell, and the cost of a copy.
    copies: Option<(&'a BlockCopies, usize, f32)>,
    /// Place of the cell, and its phase if the first page has periods.
    at: [f32; 2],
    phase: [f32; 2],
    pub(super) source: u32,
    pub(super) cost: i32,
    /// The first of the sources considered so far.
    seen: [u32; 12],
    known: usize,
}

impl<'a> Best<'a> {
    pub(super) fn new(
        canvas: &'a LevelCanvas,
        atlas: &'a Atlas,
        [x, y]: [usize; 2],
        extra: &'a [i32],
    ) -> Self {
        let values = &canvas.values[canvas.patch(x, y)..];
        let row = canvas.value_row();
        let coherence = canvas.coherence;
        let at = [x as f32, y as f32];
        let periods = atlas.pages.first().and_then(|page| page.periods.as_ref());
        Self {
            values,
            row,
            atlas,
            extra,
            coherence,
            copies: None,
            at,
            phase: periods.map_or([0.0; 2], |periods| periods.on_canvas(at)),
            source: 0,
            cost: i32::MAX,
            seen: [0; 12],
            known: 0,
        }
    }

    /// Considers the cell's own source, and the sources that continue those of the cells around it.
    fn consider_around(&mut self, canvas: &LevelCanvas, at: [usize; 2]) {
        let (mut sources, mut supports, mut count) = ([0; 9], [0; 9], 1);
        sources[0] = canvas.sources[at[1] * canvas.size[0] + at[0]];
        for d in AROUND {
            let Some(continued) = canvas.continued(self.atlas, at, d) else { continue };
            let known = sources[..count].iter().position(|&s| s == continued);
            let k = known.unwrap_or(count);
            (sources[k], count) = (continued, count.max(k + 1));
            supports[k] += 1;
        }
        for k in 0..count {
            self.consider(sources[k], supports[k]);
        }
    }

    /// Considers a source moved to where its offset keeps to the periods, and moved on by each period.
    fn consider_periods(&mut self, source: u32) {
        let page = self.atlas.page(source);
        let Some(periods) = &self.atlas.pages[page].periods else { return };
        let at = self.atlas.source(source).at.map(f32::from);
        let [dx, dy] = periods.residual(self.atlas.phases[source as usize], periods.on_canvas(self.at));
        let own = [at[0] - dx, at[1] - dy];
        let mut consider = |x: f32, y: f32| {
            let place = [x, y].map(|v| libm::rintf(v) as i64);
            if let Some(moved) = self.atlas.cell_within(page, place) {
                self.consider(moved, 0);
            }
        };
        consider(own[0], own[1]);
        for [x, y] in periods.vectors.iter().filter(|v| **v != [0.0; 2]) {
            consider(own[0] + x, own[1] + y);
            consider(own[0] - x, own[1] - y);
        }
    }

    /// Takes a source if it is better. It continues `support` of the cells around.
    #[inline]
    pub(super) fn consider(&mut self, source: u32, support: u32) {
        if self.seen[..self.known].contains(&source) {
            return;
        }
        if self.known < self.seen.len() {
            self.seen[self.known] = source;
            self.known += 1;
        }
        let (extra, factor) = self.incoherence(support);
        self.compare(source, extra, factor);
    }

    /// Considers many sources, even those considered before: with support of an adjacent cell their cost was
    /// lower.
    fn consider_all(&mut self, sources: &[u32]) {
        let (extra, factor) = self.incoherence(0);
        sources.iter().for_each(|&source| self.compare(source, extra, factor));
    }

    /// The extra cost of a source that continues `support` of the cells around, and the factor of its
    /// distance.
    #[inline]
    fn incoherence(&self, support: u32) -> (i32, f32) {
        let alone = self.coherence * (1.0 - support.min(8) as f32 / 8.0);
        ((alone * ALONE[1] * PATCH_UNIT) as i32, 1.0 + alone * ALONE[0])
    }

    /// Cost of a source whose offset misses the periods of its page.
    #[inline]
    fn off_period_cost(&self, source: u32) -> i32 {
        let Some(&phase) = self.atlas.phases.get(source as usize) else { return 0 };
        let page = self.atlas.page(source);
        let Some(periods) = &self.atlas.pages[page].periods else { return 0 };
        let own = if page == 0 { self.phase } else { periods.on_canvas(self.at) };
        // A source far from any period is excluded by its cost, which is limited so that sums do not
        // overflow.
        const MOST: f32 = 1e8;
        (periods.cost(phase, own) * PATCH_UNIT).min(MOST) as i32
    }

    #[inline]
    fn compare(&mut self, source: u32, extra: i32, factor: f32) {
        let extra = self.extra[source as usize] + extra + self.off_period_cost(source);
        let limit = self.cost.saturating_sub(extra);
        if limit <= 0 {
            return;
        }
        let there = &self.atlas.features[self.atlas.patch(source)..];
        let row = self.atlas.stride * LANES;
        let distance = distance(self.values, self.row, there, row, limit);
        if distance >= limit {
            return;
        }
        let cost = extra.saturating_add((distance as f32 * factor) as i32);
        if cost >= self.cost {
            return;
        }
        // Evaluated last, because it takes longest.
        let copy = self.copies.map_or(0.0, |(copies, cell, cost)| cost * copies.nearness(source, cell));
        let cost = cost.saturating_add((copy * PATCH_UNIT) as i32);
        if cost < self.cost {
            (self.source, self.cost) = (source, cost);
        }
    }
}
