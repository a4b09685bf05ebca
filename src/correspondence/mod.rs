//! From where in its exemplars each place of a canvas comes: a field of correspondences.
//!
//! Texture optimisation (Kwatra et al. 2005) from coarse to fine: every cell of the canvas has a
//! source, the cell of an exemplar whose surroundings look most like its own; what overlapping
//! surroundings say of a cell is averaged, and sources are sought again. Sources are sought among all
//! cells at the coarsest levels, then among those of the neighbours, continued, and among cells like
//! them (k-coherence: Tong et al. 2002). A cell that has been taken often costs more (Kaspar et al.
//! 2015), and colours are brought to the exemplar's histogram (Kopf et al. 2007), so nothing is lost
//! or preferred. In the last passes the canvas is a mosaic of whole islands of its exemplars and only
//! their borders move, to where they are seen least (Lefebvre and Hoppe 2005).
//!
//! Knows no textons: cells have features, and features are numbers.
//!
//! Works badly where the exemplar holds a thing once that is as large as itself, such as a single
//! border between two surfaces.

mod atlas;
mod canvas;
mod copies;
mod islands;
mod search;
mod similar;
mod vote;

use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::sampling::stream;
use atlas::Atlas;
use canvas::Canvas;
use similar::Similar;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub(crate) use islands::Islands;

/// Features of a cell: three of colour, one of what stands there.
pub(crate) const CHANNELS: usize = 4;
/// Cells along the side of the surroundings that are compared.
const PATCH: usize = 5;
/// Cells from the middle of the surroundings to their border.
const REACH: usize = PATCH / 2;
/// A feature of 1 as it is stored.
const UNIT: f32 = 64.0;

/// The cost of a source taken as often as all others on average, as a share of the squared deviation.
const OCCURRENCE: f32 = 0.03;
/// The extra cost of a source that no cell around continues: a share of its distance, and a share of the
/// squared deviation. One that some of the eight continue costs as much less.
const ALONE: [f32; 2] = [0.3, 0.04];
/// Levels, from the finest, on which it costs that; on coarser ones structure is still to be found.
const COHERENT: usize = 2;
/// The extra cost of a source with a copy beside it, as a share of the squared deviation; less with
/// distance. Only where all sources are compared: later, islands are too large to make way.
const COPY: f32 = 0.3;
/// Shortest side of the coarsest level of the smallest page, in cells.
const COARSEST: usize = 14;
/// Most cells that are all compared: of more, so many evenly chosen.
const MOST_COMPARED: usize = 4096;
/// Most levels.
const MOST_LEVELS: usize = 8;
/// Random beginnings, of which the best is carried on.
const STARTS: u64 = 6;
/// Beginnings that are carried on to the second level before one is chosen.
const CARRIED_ON: usize = 2;
/// Iterations on the coarsest level, on those between, and on the finest.
const ITERATIONS: [usize; 3] = [5, 4, 2];
/// Passes on the finest level in which islands only move their borders.
const MOSAIC: usize = 4;
/// Fewest cells of an island.
const LEAST_ISLAND: u32 = 10;

/// An exemplar, or an exemplar turned or mirrored, cell by cell.
pub(crate) struct Page {
    /// The group that its cells belong to; cells of the canvas may be restricted to a group.
    pub(crate) group: u8,
    /// The group of each cell, in place of one for all. All pages have them, or none has.
    pub(crate) groups: Option<Vec<u8>>,
    /// Size in cells.
    pub(crate) size: [usize; 2],
    /// Features row by row, each of deviation about 1.
    pub(crate) features: Vec<[f32; CHANNELS]>,
    /// Cells that can be sources; none if all can.
    pub(crate) inside: Option<Vec<bool>>,
}

/// The canvas to be filled.
pub(crate) struct Request<'a> {
    pub(crate) pages: &'a [Page],
    /// Size in cells.
    pub(crate) size: [usize; 2],
    /// Along which axes the canvas repeats.
    pub(crate) wrap: [bool; 2],
    /// The group that each cell takes its source from; none if there is one group.
    pub(crate) groups: Option<Vec<u8>>,
    /// Cells that need a source; none if all do.
    pub(crate) active: Option<Vec<bool>>,
    pub(crate) seed: u64,
}

/// Where a cell comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Source {
    pub(crate) page: u16,
    pub(crate) at: [u16; 2],
}

/// A source for each cell of a canvas.
pub(crate) struct Field {
    /// Size in cells.
    pub(crate) size: [usize; 2],
    pub(crate) wrap: [bool; 2],
    /// Row by row.
    pub(crate) sources: Vec<Source>,
}

/// Name of the stage.
const STAGE: &str = "structure";

/// The field of a canvas. Needs a cell inside of each group that is asked for.
///
/// # Errors
/// [`crate::Error::Interrupted`].
pub(crate) fn find(request: &Request<'_>, progress: &dyn Progress) -> Result<Field> {
    let atlases = Atlas::pyramid(request.pages);
    let coarsest = atlases.len() - 1;
    let sizes = canvas::sizes(request.size, atlases.len());
    let what = |level: usize| {
        let groups = request.groups.as_ref().map(|g| canvas::reduced(g, request.size, sizes[level]));
        let groups = groups.map(|groups| atlases[level].with_sources(groups));
        let active = request.active.as_ref().map(|a| canvas::any_within(a, request.size, sizes[level]));
        (groups, active)
    };
    // Each pass over a level counts; those of the finest are most of the work.
    let cells = |level: usize| (sizes[level][0] * sizes[level][1]) as u64;
    let passes = |level: usize| if level == 0 { 2 * ITERATIONS[2] + 5 } else { 4 * ITERATIONS[1] } as u64;
    let work: u64 = (0..sizes.len()).map(|level| passes(level) * cells(level)).sum();
    let watch = Watch { progress, done: AtomicU64::new(0), work, stopped: AtomicBool::new(false) };
    watch.check()?;

    // The best of several beginnings, by how much of the exemplar's large contrast they keep.
    let mut similar = Similar::coarsest(&atlases[coarsest], &watch);
    let begin = |start: u64| {
        let mut random = stream(request.seed, "correspondence/start", start);
        let block = 1 + 2 * (start as usize % 2);
        let empty = Canvas::new(sizes[coarsest], request.wrap, what(coarsest));
        let mut canvas = empty.random(&atlases[coarsest], block, &mut random);
        canvas.optimise(&atlases[coarsest], &similar, ITERATIONS[0], ITERATIONS[0], &watch);
        canvas
    };
    let mut canvases: Vec<Canvas> = (0..STARTS).map(begin).collect();
    keep_best(&mut canvases, &atlases[coarsest], CARRIED_ON);
    for level in (0..coarsest).rev() {
        watch.check()?;
        let (coarse, fine) = (&atlases[level + 1], &atlases[level]);
        similar = similar.finer(coarse, fine, &watch);
        for canvas in &mut canvases {
            *canvas = canvas.finer(coarse, fine, Canvas::new(sizes[level], request.wrap, what(level)));
            canvas.coherence = if level < COHERENT { 1.0 } else { 0.0 };
            if level > 0 {
                let exhaustive = usize::from(coarsest - level == 1);
                canvas.optimise(fine, &similar, exhaustive, ITERATIONS[1], &watch);
            } else {
                canvas.refine(fine, &similar, ITERATIONS[2], &watch);
            }
        }
        keep_best(&mut canvases, fine, 1);
    }
    keep_best(&mut canvases, &atlases[0], 1);
    let mut canvas = canvases.swap_remove(0);
    canvas.mosaic(&atlases[0], &similar, MOSAIC, &watch);
    canvas.absorb_small_islands(&atlases[0], LEAST_ISLAND);
    canvas.mosaic(&atlases[0], &similar, 1, &watch);
    watch.finish()?;
    Ok(Field {
        size: request.size,
        wrap: request.wrap,
        sources: canvas.sources.iter().map(|&s| atlases[0].source(s)).collect(),
    })
}

/// Reports of the work, row by row; the answer says whether it is to stop.
struct Watch<'p> {
    progress: &'p dyn Progress,
    done: AtomicU64,
    work: u64,
    stopped: AtomicBool,
}

impl Watch<'_> {
    /// Tells of a row of cells that is about to be done; false if nothing is to be done any more.
    fn goes_on(&self, cells: usize) -> bool {
        let done = self.done.fetch_add(cells as u64, Ordering::Relaxed) + cells as u64;
        // Reported after every few cells only.
        const EVERY: u64 = 1 << 14;
        if done / EVERY != (done - cells as u64) / EVERY
            && !self.progress.advance(STAGE, done.min(self.work), self.work)
        {
            self.stopped.store(true, Ordering::Relaxed);
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    /// An error if the work is to stop.
    fn check(&self) -> Result<()> {
        let done = self.done.load(Ordering::Relaxed).min(self.work);
        let stopped = self.stopped.load(Ordering::Relaxed);
        if stopped || !self.progress.advance(STAGE, done, self.work) {
            Err(Error::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Tells that all is done.
    fn finish(&self) -> Result<()> {
        self.done.store(self.work, Ordering::Relaxed);
        self.check()
    }
}

/// Keeps those of several canvases whose contrast is nearest to the exemplar's, of equals the first.
/// Errors are from 0 on, so their bits are in their order.
fn keep_best(canvases: &mut Vec<Canvas>, atlas: &Atlas, count: usize) {
    if canvases.len() > count {
        canvases.sort_by_cached_key(|canvas| canvas.contrast_error(atlas).to_bits());
        canvases.truncate(count);
    }
}

#[cfg(test)]
mod tests;
