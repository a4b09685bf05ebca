//! Layer maps whose borders go around elements.

use super::carried::LayerExemplar;
use super::map::LayerMap;
use super::optimised::{on_canvas, regions_of};
use vtex_base::error::Result;
use vtex_base::raster::LabelMap;

impl LayerMap {
    /// Area in pixels from which borders go around an element: a 10,000th of the squared shorter side of
    /// the exemplar. Smaller elements would make borders ragged.
    pub fn least_element([w, h]: [u32; 2]) -> u32 {
        let shorter = w.min(h);
        (shorter * shorter / 10_000).max(1)
    }

    /// The layer that holds most pixels of each element. `elements` has the size of the map and the label k
    /// + 1 for element k.
    pub fn layers_of(&self, elements: &LabelMap, count: usize) -> Vec<u8> {
        let layers = self.layers.len();
        let mut areas = vec![0u32; count * layers];
        for (&element, &layer) in elements.labels.iter().zip(&self.labels.labels) {
            if let Some(element) = (element as usize).checked_sub(1) {
                areas[element * layers + layer as usize] += 1;
            }
        }
        // Ties go to the lowest.
        let most = |own: &[u32]| (0..layers).rev().max_by_key(|&k| own[k]).unwrap_or(0) as u8;
        areas.chunks(layers).map(most).collect()
    }

    /// The map with each element in one layer. `elements` gives the layer of the element at a pixel, or
    /// `None` to keep the pixel's own.
    pub fn with_whole_elements(mut self, elements: impl Fn(usize) -> Option<u8>) -> Self {
        for (i, label) in self.labels.labels.iter_mut().enumerate() {
            *label = elements(i).map_or(*label, u32::from);
        }
        self
    }
}

impl LayerExemplar<'_> {
    /// Makes a new map of `size` pixels from the labels of coarse cells, smooth and with the areas of the
    /// exemplar. The map repeats along the axes of `wrap`.
    ///
    /// # Errors
    /// [`vtex_base::Error::Control`] if the exemplar's map has one layer.
    pub fn smoothed_cells(&self, cells: &LabelMap, size: [usize; 2], wrap: [bool; 2]) -> Result<LayerMap> {
        self.check()?;
        let count = self.map.layers.len();
        let grid = [cells.width as usize, cells.height as usize];
        let depths = on_canvas(&regions_of(cells, count, grid, wrap), size, wrap);
        Ok(self.map.with(depths.labels(&self.map.shares(), self.most_distant(), self.speck())))
    }
}
