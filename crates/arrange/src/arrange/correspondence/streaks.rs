//! Streaks along rows: joints that are primaries themselves, such as the gaps between planks.
//!
//! The islands of a field meet somewhere along each joint, and a gap that is dark in one of them and bright in the
//! next, or a few pixels lower, ends there. Where the rows of an exemplar have such joints, the field around each joint
//! of the canvas is therefore taken from one joint of the exemplar, all along: from the joint, and the place on it, that
//! are most like what the field has found. Where the canvas is longer than the exemplar, runs meet where they look most
//! alike.

use super::pages::Pages;
use super::rows::{Ends, Rows};
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_field::correspondence::{CellSource, CorrespondenceField, ExemplarPage};
use vtex_scene::lattice::{Lattice, Phases};

/// A primary is a streak if it is so many times as long as it is thick, at least this long, and within a band at
/// most this wide; the last two in periods.
const SLENDER: f64 = 6.0;
const LEAST_LENGTH: f64 = 0.25;
const WIDEST: f64 = 0.25;
/// Least share of the rows' length along which there are streaks.
const LEAST_COVERED: f64 = 0.7;
/// Number of phases that are told apart.
const BINS: usize = 64;
/// A phase belongs to the joint if streaks are there at least this often, as a share of the most frequent phase.
const OFTEN: f64 = 0.1;
/// Most that a joint reaches from its middle, in periods.
const FARTHEST: f64 = 0.12;
/// Cells beside a joint that follow it.
const BESIDE: f64 = 1.5;
/// Share of a run, at its end, within which the next one may begin.
const OVERLAP: f64 = 0.2;
/// Weight of a difference where two runs meet, beside the mean difference from what the field has found.
const MEETING: f32 = 2.0;
/// Farthest that a source may be from the joint's phase, in cells.
const ASTRAY: f64 = 1.0;
/// One of so many cells is looked at where all would take long.
const LOOKED_AT: usize = 8;

/// The joints of rows, as phases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Streaks {
    /// Phase of their middle, 0 to 1.
    middle: f64,
    /// How far they reach to either side, in periods.
    reach: f64,
}

impl Streaks {
    /// The joints of an exemplar's rows; `None` if these have none that are streaks.
    pub(super) fn find(labels: &LabelMap, lattice: &Lattice) -> Option<Self> {
        let rows = Rows::of(lattice, 1.0)?;
        let width = labels.width as usize;
        let place = |i: usize| rows.place([i % width, i / width].map(|v| v as f64 + 0.5));
        let period = rows.period;
        let is_streak = streaks(labels, period, place);
        let on_streaks = || {
            let all = labels.labels.iter().enumerate().filter(|(_, label)| is_streak[**label as usize]);
            all.map(|(i, _)| place(i))
        };
        let mut counts = [0u32; BINS];
        let bin = |phase: f64| (((phase - libm::floor(phase)) * BINS as f64) as usize).min(BINS - 1);
        on_streaks().for_each(|[_, phase]| counts[bin(phase)] += 1);
        let near = |k: usize| (0..5).map(|d| counts[(k + BINS + d - 2) % BINS]).sum::<u32>();
        let peak = (0..BINS).max_by_key(|&k| (near(k), BINS - k))?;
        // Bins on either side that belong to it.
        let often = OFTEN * f64::from((0..BINS).map(near).max()?) / 5.0;
        let farthest = (FARTHEST * BINS as f64) as usize;
        let belongs = |k: usize| f64::from(counts[k % BINS]) >= often;
        let right = (0..farthest).take_while(|d| belongs(peak + d)).count();
        let left = (1..farthest).take_while(|d| belongs(peak + BINS - d)).count();
        let middle = (peak as f64 + 0.5 * (right as f64 - left as f64)) / BINS as f64;
        let reach = 0.5 * (right + left) as f64 / BINS as f64;
        // Pieces of the rows' length, of a few pixels each, that have a streak.
        const PIECE: f64 = 4.0;
        let piece = |t: f64, phase: f64| (libm::round(phase - middle) as i64, libm::floor(t / PIECE) as i64);
        let inside = on_streaks().filter(|[_, phase]| {
            let off = phase - middle;
            (off - libm::round(off)).abs() <= reach
        });
        let mut found: Vec<(i64, i64)> = inside.map(|[t, phase]| piece(t, phase)).collect();
        found.sort_unstable();
        found.dedup();
        let area = f64::from(labels.width) * f64::from(labels.height);
        (found.len() as f64 >= LEAST_COVERED * area / (period * PIECE)).then_some(Self { middle, reach })
    }

    /// Takes the field around each joint from a joint of the exemplar. `phases` are those of the canvas, of which
    /// `margin` cells lie before the first pixel. Only fields without groups; a field that repeats must have level or
    /// upright rows.
    pub(super) fn run_on(
        self,
        field: &mut CorrespondenceField,
        pages: &Pages,
        (lattice, phases): (&Lattice, &Phases),
        margin: [i32; 2],
    ) {
        let cell = f64::from(pages.cell);
        let (Some(rows), [wave], [page]) = (Rows::of(lattice, cell), &phases.waves[..], &pages.pages[..])
        else {
            return;
        };
        let sheet = &pages.sheets[0];
        let exemplar = Exemplar {
            page,
            size: [0, 1].map(|k| (sheet.size[k] / pages.cell) as i64),
            repeats: !sheet.is_exemplar() && (0..2).all(|k| sheet.size[k] % pages.cell == 0),
            rows,
            middle: self.middle,
        };
        let wave = wave.map(|w| w * cell);
        let Some(ends) = Ends::of(&rows, wave, field.size.map(|v| v as f64), field.wrap) else { return };
        let spacing = 1.0 / libm::hypot(wave[0], wave[1]);
        let reach = self.reach + BESIDE / rows.period;
        let mut joints: Vec<JointCell> = Vec::new();
        for y in 0..field.size[1] {
            for x in 0..field.size[0] {
                let at = [0, 1].map(|k| [x, y][k] as f64 + 0.5 - f64::from(margin[k]));
                let phase = at[0] * wave[0] + at[1] * wave[1] - self.middle;
                let row = libm::round(phase);
                if (phase - row).abs() <= reach {
                    let [along, _] = rows.place(at);
                    let own = ends.row(row);
                    // A joint at the border that repeats has cells at both ends of the canvas.
                    let beyond = (own - row as i64) as f64 * spacing;
                    joints.push(JointCell { row: own, along, beyond, off: phase - row, at: [x, y] });
                }
            }
        }
        joints.sort_by(|a, b| {
            a.row.cmp(&b.row).then(a.along.total_cmp(&b.along)).then(a.off.total_cmp(&b.off))
        });
        let extent =
            |by: [f64; 2]| exemplar.size[0] as f64 * by[0].abs() + exemplar.size[1] as f64 * by[1].abs();
        let (count, length) =
            (libm::ceil(extent(rows.across) / rows.period) as i64, libm::ceil(extent(rows.along)) as i64);
        let longest = joints.iter().map(|c| c.along.abs()).fold(0.0, f64::max) as i64;
        let steps = if exemplar.repeats { 0..=length } else { -longest - length..=longest + length };
        // Each joint of the exemplar is shown as often as the others, as far as possible.
        let kinds = libm::round(extent(rows.across) / rows.period).max(1.0);
        let mut shown = Shown { cells: Vec::new(), most: (joints.len() as f64 / kinds) as usize };
        for joint in joints.chunk_by(|a, b| a.row == b.row) {
            let run = Runs { exemplar: &exemplar, field, margin, closes: ends.around.is_some(), joint };
            // Offsets from the canvas to joints of the exemplar.
            let offsets = (-count..=count).flat_map(|k| {
                let over =
                    (self.middle + k as f64) * rows.period - (self.middle + joint[0].row as f64) * spacing;
                let offset = move |s: i64| [0, 1].map(|i| over * rows.across[i] + s as f64 * rows.along[i]);
                steps.clone().map(offset)
            });
            let sources = run.found(&offsets.collect::<Vec<_>>(), &mut shown);
            for (JointCell { at: [x, y], .. }, source) in joint.iter().zip(sources) {
                if let Some(source) = source {
                    field.sources[y * field.size[0] + x] = source;
                }
            }
        }
    }
}

/// A cell of the canvas on a joint.
struct JointCell {
    /// The joint's number.
    row: i64,
    /// Place along it, in cells.
    along: f64,
    /// Distance to its copy on the canvas that offsets are counted from, in cells.
    beyond: f64,
    /// Phase from its middle.
    off: f64,
    /// Column and row on the canvas.
    at: [usize; 2],
}

/// Whether each label of a map is a streak. `place` gives the place of a pixel along the rows, in pixels, and its phase.
fn streaks(labels: &LabelMap, period: f64, place: impl Fn(usize) -> [f64; 2]) -> Vec<bool> {
    let count = labels.labels.iter().max().map_or(0, |&label| label as usize + 1);
    let mut areas = vec![0u32; count];
    let mut bounds = vec![[[f64::INFINITY, f64::NEG_INFINITY]; 2]; count];
    for (i, &label) in labels.labels.iter().enumerate().filter(|(_, label)| **label > 0) {
        areas[label as usize] += 1;
        for (range, v) in bounds[label as usize].iter_mut().zip(place(i)) {
            *range = [range[0].min(v), range[1].max(v)];
        }
    }
    let is_streak = |(area, [along, across]): (&u32, &[[f64; 2]; 2])| {
        let length = along[1] - along[0] + 1.0;
        *area > 0
            && length * length >= SLENDER * f64::from(*area)
            && length >= LEAST_LENGTH * period
            && across[1] - across[0] <= WIDEST
    };
    areas.iter().zip(&bounds).map(is_streak).collect()
}

/// What sources are taken from.
struct Exemplar<'a> {
    page: &'a ExemplarPage,
    /// Size of the exemplar, in cells; the page is larger if it repeats.
    size: [i64; 2],
    repeats: bool,
    /// In cells.
    rows: Rows,
    /// Phase of the joints' middles.
    middle: f64,
}

impl Exemplar<'_> {
    /// The cell of the page at a place, if there is one and its phase from a joint's middle is `off`.
    fn cell(&self, at: [i64; 2], off: f64) -> Option<CellSource> {
        let at = if self.repeats { [0, 1].map(|k| at[k].rem_euclid(self.size[k])) } else { at };
        if (0..2).any(|k| !(0..self.size[k]).contains(&at[k])) {
            return None;
        }
        let [_, phase] = self.rows.place(at.map(|v| v as f64 + 0.5));
        let strays = phase - self.middle - off;
        if (strays - libm::round(strays)).abs() > ASTRAY / self.rows.period {
            return None;
        }
        let source = CellSource { page: 0, at: at.map(|v| v as u16) };
        self.page.inside.as_ref().is_none_or(|inside| inside[self.index(source)]).then_some(source)
    }

    /// The number of the joint that a cell is on.
    fn joint(&self, source: CellSource) -> i64 {
        let [_, phase] = self.rows.place(source.at.map(|v| f64::from(v) + 0.5));
        libm::round(phase - self.middle) as i64
    }

    fn index(&self, source: CellSource) -> usize {
        usize::from(source.at[1]) * self.page.size[0] + usize::from(source.at[0])
    }

    /// Squared distance of the features of two cells.
    fn distance(&self, a: CellSource, b: CellSource) -> f32 {
        let [a, b] = [a, b].map(|source| &self.page.features[self.index(source)]);
        a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
    }
}

/// How often joints of the exemplar are shown.
struct Shown {
    /// Number of cells of the canvas, by joint.
    cells: Vec<(i64, usize)>,
    /// Number from which on others are preferred.
    most: usize,
}

impl Shown {
    fn is_often(&self, joint: i64) -> bool {
        self.cells.iter().any(|(k, cells)| *k == joint && *cells >= self.most)
    }

    fn add(&mut self, joint: i64, cells: usize) {
        match self.cells.iter_mut().find(|(k, _)| *k == joint) {
            Some((_, sum)) => *sum += cells,
            None => self.cells.push((joint, cells)),
        }
    }
}

/// The search for the runs of one joint.
struct Runs<'a> {
    exemplar: &'a Exemplar<'a>,
    field: &'a CorrespondenceField,
    margin: [i32; 2],
    /// Whether its last cells are beside its first ones.
    closes: bool,
    /// Its cells in order of their places along it.
    joint: &'a [JointCell],
}

impl Runs<'_> {
    /// The source of a cell of the joint at an offset.
    fn source(&self, k: usize, offset: [f64; 2]) -> Option<CellSource> {
        let JointCell { at, off, beyond, .. } = self.joint[k];
        let place = [0, 1].map(|i| {
            let moved = libm::round(offset[i] + beyond * self.exemplar.rows.across[i]) as i64;
            at[i] as i64 - i64::from(self.margin[i]) + moved
        });
        self.exemplar.cell(place, off)
    }

    /// How unlike a source is to the one that the field has at a cell.
    fn unlike(&self, k: usize, source: CellSource) -> f32 {
        let [x, y] = self.joint[k].at;
        self.exemplar.distance(self.field.sources[y * self.field.size[0] + x], source)
    }

    /// The end of the run at an offset that begins at a cell.
    fn end(&self, from: usize, offset: [f64; 2]) -> usize {
        let count = self.joint.len();
        let is_none = |k: &usize| self.source(*k, offset).is_none();
        let near = (from..count).step_by(LOOKED_AT).find(is_none).unwrap_or(count);
        (near.saturating_sub(LOOKED_AT).max(from)..near).find(is_none).unwrap_or(near)
    }

    /// A source for each cell of the joint; `None` where the exemplar has none.
    fn found(&self, offsets: &[[f64; 2]], shown: &mut Shown) -> Vec<Option<CellSource>> {
        let count = self.joint.len();
        let mut sources = vec![None; count];
        let (mut from, mut before) = (0, None::<[f64; 2]>);
        while from < count {
            let ends: Vec<usize> = parallel::map(offsets, |&offset| self.end(from, offset));
            let longest = ends.iter().max().map_or(0, |end| end - from);
            if longest == 0 {
                from += 1;
                continue;
            }
            let least = from + longest - (OVERLAP * longest as f64) as usize;
            let cost = |&(&offset, &end): &(&[f64; 2], &usize)| {
                let all = (from..end).step_by(LOOKED_AT);
                let all = all.filter_map(|k| Some(self.unlike(k, self.source(k, offset)?)));
                let mean = all.sum::<f32>() * LOOKED_AT as f32 / (end - from) as f32;
                let meeting = before.map_or(0.0, |other| self.parting(from, other, offset));
                let closing = if self.closes && end == count { self.closing(&sources, offset) } else { 0.0 };
                mean + MEETING * (meeting + closing)
            };
            let mut long: Vec<(&[f64; 2], &usize)> =
                offsets.iter().zip(&ends).filter(|(_, end)| **end >= least).collect();
            let joint =
                |offset: [f64; 2]| self.source(from, offset).map(|source| self.exemplar.joint(source));
            let rare =
                |(offset, _): &(&[f64; 2], &usize)| joint(**offset).is_some_and(|k| !shown.is_often(k));
            if long.iter().any(rare) {
                long.retain(rare);
            }
            let costs = parallel::map(&long, cost);
            let best = long.iter().zip(costs).min_by(|a, b| a.1.total_cmp(&b.1));
            let Some(((offset, end), _)) = best else { return sources };
            for (k, source) in sources.iter_mut().enumerate().take(**end).skip(from) {
                *source = self.source(k, **offset);
            }
            if let Some(joint) = joint(**offset) {
                shown.add(joint, **end - from);
            }
            (before, from) = (Some(**offset), **end);
        }
        sources
    }

    /// How unlike two runs are where one ends, at a cell, and the other begins.
    fn parting(&self, at: usize, before: [f64; 2], after: [f64; 2]) -> f32 {
        let pairs = self.around(at).filter_map(|k| Some((self.source(k, before)?, self.source(k, after)?)));
        self.mean_distance(pairs)
    }

    /// How unlike the joint's last cells, at an offset, and its first cells are.
    fn closing(&self, sources: &[Option<CellSource>], offset: [f64; 2]) -> f32 {
        let count = self.joint.len();
        let first = |k: usize| sources[k].or_else(|| self.source(k, offset));
        let width = self.joint.iter().take_while(|c| c.along < self.joint[0].along + 0.5).count();
        self.mean_distance(
            (0..width).filter_map(|k| Some((self.source(count - width + k, offset)?, first(k)?))),
        )
    }

    fn mean_distance(&self, pairs: impl Iterator<Item = (CellSource, CellSource)>) -> f32 {
        let (sum, count) =
            pairs.fold((0.0, 0), |(sum, count), (a, b)| (sum + self.exemplar.distance(a, b), count + 1));
        if count == 0 { 0.0 } else { sum / count as f32 }
    }

    /// Cells near one along the joint: as many as a few columns have.
    fn around(&self, at: usize) -> std::ops::Range<usize> {
        const CELLS: usize = 24;
        at.saturating_sub(CELLS)..(at + CELLS).min(self.joint.len())
    }
}
