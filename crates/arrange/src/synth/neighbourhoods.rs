//! Small neighbourhoods of secondaries in the exemplar.

use crate::arrange::sites::Buckets;
use crate::arrange::variation::Variation;
use vtex_base::raster::LabelMap;
use vtex_base::sampling::Stream;
use vtex_scene::library::{ExemplarElement, Library};

/// The exemplar's secondaries and its map of primaries.
pub(super) struct ExemplarSecondaries {
    primaries: LabelMap,
    origins: Vec<[i32; 2]>,
    buckets: Buckets,
    /// Secondaries at least a neighbourhood's radius from the border.
    sources: Vec<u32>,
    reach: f64,
}

impl ExemplarSecondaries {
    /// Prepares neighbourhoods of radius `reach`, in pixels.
    pub(super) fn new(library: &Library, reach: f64) -> Self {
        let origins: Vec<[i32; 2]> = library.secondaries().iter().map(ExemplarElement::origin).collect();
        let (w, h) = (f64::from(library.source.width), f64::from(library.source.height));
        let inside = |v: i32, size: f64| f64::from(v) >= reach && f64::from(v) <= size - reach;
        let mut sources: Vec<u32> = (0..origins.len() as u32)
            .filter(|&i| inside(origins[i as usize][0], w) && inside(origins[i as usize][1], h))
            .collect();
        if sources.is_empty() {
            sources = (0..origins.len() as u32).collect();
        }
        let buckets = Buckets::new(&origins, reach);
        Self { primaries: library.arrangement.to_labels(), origins, buckets, sources, reach }
    }

    /// Draws `candidates` secondaries and returns the one whose surroundings, after the variation, best
    /// match those of `here` in background and primaries. `free` tells background on the canvas.
    pub(super) fn best_source(
        &self,
        here: [i32; 2],
        candidates: usize,
        variation: &Variation,
        free: impl Fn(i32, i32) -> bool,
        random: &mut Stream,
    ) -> u32 {
        const PROBES: i32 = 3;
        let step = self.reach / f64::from(PROBES);
        let probes: Vec<[i32; 2]> = (-PROBES..=PROBES)
            .flat_map(|v| (-PROBES..=PROBES).map(move |u| [u, v]))
            .filter(|[u, v]| u * u + v * v <= PROBES * PROBES)
            .map(|p| p.map(|k| libm::round(f64::from(k) * step) as i32))
            .collect();
        let wanted: Vec<bool> = probes.iter().map(|p| free(here[0] + p[0], here[1] + p[1])).collect();
        let mut best = (usize::MAX, 0);
        for _ in 0..candidates {
            let source = self.sources[random.index(self.sources.len())];
            let [x, y] = self.origins[source as usize].map(i64::from);
            let background = |p: &[i32; 2]| {
                let [u, v] = variation.source_pixel(*p).map(i64::from);
                self.primaries.at(x + u, y + v).is_none_or(|label| label == 0)
            };
            let unlike = probes.iter().zip(&wanted).filter(|(p, w)| background(p) != **w).count();
            // Ties go to the first, so a plain background takes the first draw.
            if unlike < best.0 {
                best = (unlike, source);
            }
        }
        best.1
    }

    /// Calls `visit` with every secondary near a source and its offset from the source.
    pub(super) fn around(&self, source: u32, mut visit: impl FnMut(u32, [i32; 2])) {
        let centre = self.origins[source as usize];
        self.buckets.near(centre, 2, |i| {
            let p = self.origins[i as usize];
            visit(i, [p[0] - centre[0], p[1] - centre[1]]);
        });
    }
}
