//! Outlines of the regions of a layer map.

use super::map::LayerMap;
use vtex_base::geometry::{Affine, FittedMap, Outline, PlanarMap};

/// Largest distance of an outline from the pixel border, in pixels.
const TOLERANCE: f64 = 0.5;
/// Overlap of outlines beyond an edge at which the map repeats, in pixels.
const MARGIN: usize = 24;

impl LayerMap {
    /// The outlines of the regions of all layers except the bottom one, in pixels. Region i holds the
    /// layers from i + 1 up. Borders are traced once and shared. Outlines extend a little beyond the edges
    /// along the axes of `wrap`.
    pub fn outlines(&self, wrap: [bool; 2]) -> Vec<Outline> {
        let [w, h] = self.size();
        let margin = [0, 1].map(|k| if wrap[k] { MARGIN } else { 0 });
        let [fw, fh] = [w + 2 * margin[0], h + 2 * margin[1]];
        // Label 0 has no outline in a planar map, so labels are counted from 1.
        let label = |i: usize| {
            let [x, y] = [(i % fw + margin[0] * w - margin[0]) % w, (i / fw + margin[1] * h - margin[1]) % h];
            self.labels.labels[y * w + x] + 1
        };
        let labels: Vec<u32> = (0..fw * fh).map(label).collect();
        let planar = PlanarMap::trace(fw as u32, fh as u32, &labels);
        let fitted = FittedMap::new(planar, TOLERANCE, self.layers.len(), self.layers.len(), |l| l);
        let back = Affine::translate((-(margin[0] as f64), -(margin[1] as f64)));
        let region = |k: usize| {
            let outline = fitted.outlines(1, |l| u32::from(l > k as u32)).swap_remove(1);
            Outline::new(&(back * outline.path())).unwrap_or_default()
        };
        (1..self.layers.len()).map(region).collect()
    }
}
