//! Layer maps whose borders go around elements.

use super::map::LayerMap;
use vtex_base::raster::{LabelMap, Mask};

/// Least share of a layer that elements leave free. In photographs of layers it was .4 or more, in one of flowers .24.
const LEAST_FREE: f64 = 1.0 / 3.0;

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

    /// The layer that holds most pixels of a mask; of equals the highest. `None` if no pixel lies on the map.
    pub fn layer_of(&self, mask: &Mask) -> Option<u8> {
        let mut areas = vec![0usize; self.layers.len()];
        for (x, y) in mask.pixels() {
            if let Some(layer) = self.labels.at(x.into(), y.into()) {
                areas[layer as usize] += 1;
            }
        }
        let most = (0..areas.len()).max_by_key(|&k| areas[k]).filter(|&k| areas[k] > 0);
        most.map(|k| k as u8)
    }

    /// The map with each element in one layer. `elements` gives the layer of the element at a pixel, or
    /// `None` to keep the pixel's own.
    pub fn with_whole_elements(mut self, elements: impl Fn(usize) -> Option<u8>) -> Self {
        for (i, label) in self.labels.labels.iter_mut().enumerate() {
            *label = elements(i).map_or(*label, u32::from);
        }
        self
    }

    /// The map without layers above the lowest that elements cover almost wholly, and the names of these layers.
    /// Their pixels belong to the layer below. `elements` is above 0 in elements.
    ///
    /// Such a layer is no surface but the elements themselves, as white flowers on dark leaves are. What shows
    /// between its elements is the layer below.
    pub fn without_layers_of_elements(mut self, elements: &LabelMap) -> (Self, Vec<String>) {
        let mut areas = vec![[0usize; 2]; self.layers.len()];
        for (&element, &layer) in elements.labels.iter().zip(&self.labels.labels) {
            let [whole, free] = &mut areas[layer as usize];
            *whole += 1;
            *free += usize::from(element == 0);
        }
        let is_surface = |k: usize| k == 0 || areas[k][1] as f64 >= LEAST_FREE * areas[k][0] as f64;
        // The nearest surface below each layer.
        let below: Vec<u32> =
            (0..areas.len()).map(|k| (0..=k).rev().find(|&k| is_surface(k)).unwrap_or(0) as u32).collect();
        self.labels.labels.iter_mut().for_each(|label| *label = below[*label as usize]);
        let names = (0..areas.len()).filter(|&k| !is_surface(k)).map(|k| self.layers[k].name.clone());
        let names = names.collect();
        (self.without_unused(), names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::MapLayer;
    use vtex_base::raster::Span;
    use vtex_base::raster::colour::Colour;

    #[test]
    fn a_mask_lies_in_the_layer_of_most_of_its_pixels() {
        let layer = |name: &str| MapLayer { name: name.into(), colour: Colour([name.len() as u8; 3]) };
        let labels =
            LabelMap { labels: (0..100).map(|i| i % 10 / 5).collect(), ..LabelMap::filled(10, 10, 0) };
        let map = LayerMap { labels, layers: ["low", "higher"].map(layer).to_vec() };
        let of = |[x0, x1, y0, y1]: [i32; 4]| {
            map.layer_of(&Mask::from_spans((y0..y1).map(|y| Span { y, x0, x1 }).collect()))
        };
        let found = [[1, 7, 1, 4], [3, 9, 1, 4], [2, 8, 2, 5], [-2, 3, 8, 13], [-9, -5, 1, 5]].map(of);
        assert_eq!(found, [Some(0), Some(1), Some(1), Some(0), None]);
        assert_eq!(map.layer_of(&Mask::default()), None);
    }

    #[test]
    fn what_elements_cover_is_no_layer() {
        // Three layers of ten columns. Elements cover all of the second but two columns, and half of the third.
        let labels =
            LabelMap { labels: (0..300).map(|i| i % 30 / 10).collect(), ..LabelMap::filled(30, 10, 0) };
        let layer = |name: &str| MapLayer { name: name.into(), colour: Colour([name.len() as u8; 3]) };
        let map = LayerMap { labels, layers: ["dark", "white", "yellow"].map(layer).to_vec() };
        let elements = |columns: [std::ops::Range<u32>; 2]| LabelMap {
            labels: (0..300).map(|i| u32::from(columns.iter().any(|c| c.contains(&(i % 30))))).collect(),
            ..LabelMap::filled(30, 10, 0)
        };
        let (kept, names) = map.clone().without_layers_of_elements(&elements([12..20, 20..25]));
        assert_eq!(names, ["white"]);
        assert_eq!(kept.layers, ["dark", "yellow"].map(layer));
        assert_eq!(kept.labels.labels[..30], [[0; 10], [0; 10], [1; 10]].concat());
        let (kept, names) = map.clone().without_layers_of_elements(&elements([14..20, 0..10]));
        assert_eq!((kept, names.len()), (map, 0));
    }
}
