//! What the search needs of pages alone, prepared once for several canvases.

use super::atlas::Atlas;
use super::similar::Similar;
use super::{ExemplarPage, RowProgress};
use std::sync::{Arc, Mutex, PoisonError};
use vtex_base::error::Result;

/// The levels of pages from the finest to the coarsest, and the similar cells of each.
pub(super) struct PreparedPages {
    pub(super) atlases: Vec<Atlas>,
    pub(super) similar: Vec<Similar>,
}

impl PreparedPages {
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    fn new(pages: &[ExemplarPage], watch: &RowProgress<'_>) -> Result<Self> {
        let atlases = Atlas::pyramid(pages);
        let coarsest = atlases.len() - 1;
        let mut similar = vec![Similar::coarsest(&atlases[coarsest], watch)];
        for level in (0..coarsest).rev() {
            watch.check()?;
            let finer = similar[coarsest - level - 1].finer(&atlases[level + 1], &atlases[level], watch);
            similar.push(finer);
        }
        watch.check()?;
        similar.reverse();
        Ok(Self { atlases, similar })
    }
}

/// Remembers the preparation of the last pages, which takes most of the time of a small canvas. Results are the same
/// with and without it: pages are compared in full.
#[derive(Default)]
pub struct PagesMemory(Mutex<Option<KnownPages>>);

/// Pages, and what was prepared of them.
type KnownPages = (Vec<ExemplarPage>, Arc<PreparedPages>);

impl PagesMemory {
    /// The prepared pages, from the memory if there is one and it has them.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    pub(super) fn prepared(
        memory: Option<&Self>,
        pages: &[ExemplarPage],
        watch: &RowProgress<'_>,
    ) -> Result<Arc<PreparedPages>> {
        let Some(Self(memory)) = memory else { return PreparedPages::new(pages, watch).map(Arc::new) };
        let last = || memory.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = last().as_ref().filter(|(of, _)| of == pages) {
            return Ok(Arc::clone(known));
        }
        let prepared = Arc::new(PreparedPages::new(pages, watch)?);
        *last() = Some((pages.to_vec(), Arc::clone(&prepared)));
        Ok(prepared)
    }
}
