//! Correspondence fields: for each place of a canvas, the place in an exemplar that it is taken from.
//!
//! Texture optimisation (Kwatra et al. 2005) from coarse to fine. Every cell of the canvas has a source, the
//! exemplar cell with the most similar neighbourhood. Overlapping neighbourhoods vote on the features of
//! each cell, and sources are searched again: among all cells at the coarsest levels, then among the sources
//! that continue those of adjacent cells, and among cells similar to these (k-coherence: Tong et al. 2002).
//! A source that is used often costs more (Kaspar et al. 2015), and colours are matched to the exemplar's
//! histogram (Kopf et al. 2007), so no part of the exemplar is lost or preferred. In the last passes the
//! canvas is a mosaic of whole islands, and only their borders move, to where they are least visible
//! (Lefebvre and Hoppe 2005).
//!
//! The search starts from several random canvases and goes on with the one whose block means spread most
//! like the exemplar's. A source with a copy nearby costs more (`copies`), and so does an offset that
//! misses the exemplar's lattice (`periods`). On the finest level cells inside islands are settled, so the
//! cost is that of the borders.
//!
//! Results are the same on every machine and any number of threads. Features are 16-bit integers, so
//! distances of patches are exact. Each step reads one state and writes another. Passes of a search, and those
//! that move borders, take a part of the cells, none adjacent, so each sees what the others have changed. Nothing depends on the order of visits.
//!
//! Knows no elements: cells have features, and features are numbers.
//!
//! Works badly where the exemplar holds a single structure of its own size, such as one border between two
//! surfaces.

mod atlas;
mod canvas;
mod copies;
mod islands;
mod memory;
mod periods;
mod search;
mod similar;
mod vote;

use atlas::Atlas;
use canvas::LevelCanvas;
use memory::PreparedPages;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;
use vtex_base::sampling::stream;

pub use islands::Islands;
pub use memory::PagesMemory;
pub use periods::Periods;

/// Features of a cell: three of colour, one of the element that covers it, two of its place within that
/// element.
pub const CHANNELS: usize = 6;
/// Stored values of a cell: its features and zeros, so that rows of a patch fill whole vectors.
const LANES: usize = 8;
/// Side of the neighbourhoods that are compared, in cells.
const PATCH: usize = 5;
/// Radius of a neighbourhood, in cells.
const REACH: usize = PATCH / 2;
/// Largest feature, of either sign; larger ones are clamped.
pub const LARGEST_FEATURE: f32 = 16.0;
/// Stored value of a feature of 1.
const UNIT: f32 = 64.0;

/// Cost of a source used with average frequency, as a share of the squared standard deviation.
const OCCURRENCE: f32 = 0.03;
/// Extra cost of a source that continues no adjacent cell: a share of its distance, and a share of the
/// squared standard deviation. Each of the eight adjacent cells that it continues takes off an eighth.
const ALONE: [f32; 2] = [0.3, 0.04];
/// Levels, from the finest, that apply this cost; on coarser ones structure is still being formed.
const COHERENT: usize = 2;
/// Extra cost of a source with a copy nearby, as a share of the squared standard deviation, in exhaustive
/// searches and in others; it falls with distance.
const COPY: [f32; 2] = [0.3, 0.12];
/// Shortest side of the coarsest level of the smallest page, in cells.
const COARSEST: usize = 14;
/// Most cells in an exhaustive comparison. More are sampled evenly.
const MOST_COMPARED: usize = 4096;
/// Most levels.
const MOST_LEVELS: usize = 8;
/// Random initialisations, of which the best is kept.
const STARTS: u64 = 6;
/// Most pairs of a cell and a source that are compared on the coarsest level. Where the canvas is so large
/// that there would be more, the number of initialisations is reduced, then the number of exhaustive
/// searches.
const MOST_PAIRS: u64 = 200_000_000;
/// Initialisations that are refined on the second level before the best is chosen.
const CARRIED_ON: usize = 2;
/// Iterations on the coarsest level, on the levels between, and on the finest.
const ITERATIONS: [usize; 3] = [5, 4, 2];
/// Passes on the finest level in which islands only move their borders.
const MOSAIC: usize = 4;
/// Least number of cells of an island.
const LEAST_ISLAND: u32 = 10;

/// An exemplar, as it is, rotated or mirrored, cell by cell.
#[derive(Clone, PartialEq)]
pub struct ExemplarPage {
    /// The group of its cells. Cells of the canvas may be restricted to a group.
    pub group: u8,
    /// The group of each cell, in place of `group`. Either all pages have these or none.
    pub groups: Option<Vec<u8>>,
    /// Size in cells.
    pub size: [usize; 2],
    /// Features row by row, each with a standard deviation of about 1 and at most [`LARGEST_FEATURE`].
    pub features: Vec<[f32; CHANNELS]>,
    /// Cells that can be sources; `None` if all can.
    pub inside: Option<Vec<bool>>,
    /// Periods that offsets from the canvas to the page keep to; `None` if they are free.
    pub periods: Option<Periods>,
}

/// The canvas to be filled.
pub struct CanvasRequest<'a> {
    /// The exemplars, in all their variations.
    pub pages: &'a [ExemplarPage],
    /// Size in cells.
    pub size: [usize; 2],
    /// Along which axes the canvas repeats.
    pub wrap: [bool; 2],
    /// The group that each cell takes its source from; `None` if there is one group.
    pub groups: Option<Vec<u8>>,
    /// Cells that need a source; `None` if all do.
    pub active: Option<Vec<bool>>,
    /// Seed of all random choices.
    pub seed: u64,
}

/// The place that a cell is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CellSource {
    /// Index of the page.
    pub page: u16,
    /// Cell of the page: column, row.
    pub at: [u16; 2],
}

/// A source for each cell of a canvas.
pub struct CorrespondenceField {
    /// Size in cells.
    pub size: [usize; 2],
    /// Along which axes the canvas repeats.
    pub wrap: [bool; 2],
    /// Row by row.
    pub sources: Vec<CellSource>,
}

/// Name of the stage.
const STAGE: &str = "structure";

/// Finds the field of a canvas. Each requested group needs a cell that can be a source.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub fn find(request: &CanvasRequest<'_>, progress: &dyn Progress) -> Result<CorrespondenceField> {
    find_again(request, None, progress)
}

/// [`find`] with what is remembered of pages. The field is that of [`find`].
///
/// # Errors
/// Those of [`find`].
pub fn find_again(
    request: &CanvasRequest<'_>,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<CorrespondenceField> {
    let prepared = PagesMemory::prepared(memory, request.pages, &RowProgress::new(progress, 1))?;
    let PreparedPages { atlases, similar } = &*prepared;
    let coarsest = atlases.len() - 1;
    let sizes = canvas::sizes(request.size, atlases.len());
    // Each pass over a level counts. Those over the finest are most of the work.
    let cells = |level: usize| (sizes[level][0] * sizes[level][1]) as u64;
    let passes = |level: usize| if level == 0 { 2 * ITERATIONS[2] + 5 } else { 4 * ITERATIONS[1] } as u64;
    let work: u64 = (0..sizes.len()).map(|level| passes(level) * cells(level)).sum();
    let watch = RowProgress::new(progress, work);
    watch.check()?;
    let constraints = |level: usize| {
        let groups = request.groups.as_ref().map(|g| canvas::reduced(g, request.size, sizes[level]));
        let groups = groups.map(|groups| atlases[level].with_sources(groups));
        let active = request.active.as_ref().map(|a| canvas::any_within(a, request.size, sizes[level]));
        (groups, active)
    };

    // The best initialisation keeps most of the exemplar's large-scale contrast.
    let sources = atlases[coarsest].inside.iter().filter(|inside| **inside).count() as u64;
    let searches = MOST_PAIRS / (cells(coarsest) * sources).max(1);
    let starts = (searches / ITERATIONS[0] as u64).clamp(1, STARTS);
    let exhaustive = (searches as usize).clamp(1, ITERATIONS[0]);
    let begin = |start: u64| {
        let mut random = stream(request.seed, "correspondence/start", start);
        let block = 1 + 2 * (start as usize % 2);
        let empty = LevelCanvas::new(sizes[coarsest], request.wrap, constraints(coarsest));
        let mut canvas = empty.random(&atlases[coarsest], block, &mut random);
        canvas.optimise(&atlases[coarsest], &similar[coarsest], exhaustive, ITERATIONS[0], &watch);
        canvas
    };
    let mut canvases: Vec<LevelCanvas> = (0..starts).map(begin).collect();
    keep_best(&mut canvases, &atlases[coarsest], CARRIED_ON);
    for level in (0..coarsest).rev() {
        watch.check()?;
        let (coarse, fine, similar) = (&atlases[level + 1], &atlases[level], &similar[level]);
        for canvas in &mut canvases {
            *canvas =
                canvas.finer(coarse, fine, LevelCanvas::new(sizes[level], request.wrap, constraints(level)));
            canvas.coherence = if level < COHERENT { 1.0 } else { 0.0 };
            if level > 0 {
                let exhaustive = usize::from(coarsest - level == 1);
                canvas.optimise(fine, similar, exhaustive, ITERATIONS[1], &watch);
            } else {
                canvas.refine(fine, similar, ITERATIONS[2], &watch);
            }
        }
        keep_best(&mut canvases, fine, 1);
    }
    keep_best(&mut canvases, &atlases[0], 1);
    let mut canvas = canvases.swap_remove(0);
    canvas.mosaic(&atlases[0], &similar[0], MOSAIC, &watch);
    canvas.absorb_small_islands(&atlases[0], LEAST_ISLAND);
    canvas.mosaic(&atlases[0], &similar[0], 1, &watch);
    watch.finish()?;
    Ok(CorrespondenceField {
        size: request.size,
        wrap: request.wrap,
        sources: canvas.sources.iter().map(|&s| atlases[0].source(s)).collect(),
    })
}

/// Reports progress row by row, and remembers whether the work was stopped.
struct RowProgress<'p> {
    progress: &'p dyn Progress,
    done: AtomicU64,
    work: u64,
    stopped: AtomicBool,
}

impl<'p> RowProgress<'p> {
    fn new(progress: &'p dyn Progress, work: u64) -> Self {
        Self { progress, done: AtomicU64::new(0), work, stopped: AtomicBool::new(false) }
    }

    /// Reports a row of cells; false once the work was stopped.
    fn keep_going(&self, cells: usize) -> bool {
        let done = self.done.fetch_add(cells as u64, Ordering::Relaxed) + cells as u64;
        // Cells between two reports.
        const EVERY: u64 = 1 << 14;
        if done / EVERY != (done - cells as u64) / EVERY
            && !self.progress.advance(STAGE, done.min(self.work), self.work)
        {
            self.stopped.store(true, Ordering::Relaxed);
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    /// An error if the work was stopped.
    fn check(&self) -> Result<()> {
        let done = self.done.load(Ordering::Relaxed).min(self.work);
        let stopped = self.stopped.load(Ordering::Relaxed);
        if stopped || !self.progress.advance(STAGE, done, self.work) {
            Err(Error::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Reports that all work is done.
    fn finish(&self) -> Result<()> {
        self.done.store(self.work, Ordering::Relaxed);
        self.check()
    }
}

/// Keeps the canvases with the smallest contrast error; ties go to the first. Errors are not negative, so
/// their bits sort like their values.
fn keep_best(canvases: &mut Vec<LevelCanvas>, atlas: &Atlas, count: usize) {
    if canvases.len() > count {
        canvases.sort_by_cached_key(|canvas| canvas.contrast_error(atlas).to_bits());
        canvases.truncate(count);
    }
}

#[cfg(test)]
mod tests;
