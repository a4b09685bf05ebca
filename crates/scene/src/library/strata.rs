//! Strata: the nested layers of a weathered surface.
//!
//! A stratum is stored as three layers named after its colour, such as *moss green* (with region, field and
//! colour), *moss green secondary* and *moss green primary*. Labels are computed from the regions. An
//! operation for the layer *moss green* applies to all three.

use super::{ExemplarLayer, Library, Role};
use crate::element::ElementId;
use crate::scene::{Field, joined};
use std::borrow::Cow;
use vtex_base::geometry::{Interior, Outline};
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;

/// A layer of a weathered surface: a background and the elements on it. Homogeneous exemplars have a single
/// stratum.
#[derive(Clone, Copy, Debug)]
pub struct Stratum<'a> {
    /// Its layers: the background first, then those of its elements.
    pub layers: &'a [ExemplarLayer],
    /// The colours of its background.
    pub field: &'a Field,
}

impl<'a> Stratum<'a> {
    /// Its name: that of its background.
    pub fn name(&self) -> &'a str {
        &self.layers[0].name
    }

    /// Its colour in layer maps.
    pub fn colour(&self) -> Colour {
        self.layers[0].colour.unwrap_or(self.field.fallback)
    }

    /// The part of the exemplar that it and all strata above fill; `None` for all of it.
    pub fn region(&self) -> Option<&'a Outline> {
        self.layers[0].region.as_ref()
    }

    /// Its elements.
    pub fn elements(&self) -> impl Iterator<Item = ElementId> + use<'a> {
        self.layers.iter().flat_map(|layer| &layer.instances).map(|instance| instance.element)
    }
}

impl Library {
    /// The strata, from bottom to top.
    pub fn strata(&self) -> Vec<Stratum<'_>> {
        let starts: Vec<usize> =
            (0..self.layers.len()).filter(|&k| self.layers[k].role == Role::Background).collect();
        let of = |(n, &start): (usize, &usize)| {
            let layers = &self.layers[start..starts.get(n + 1).copied().unwrap_or(self.layers.len())];
            layers[0].field.as_ref().map(|field| Stratum { layers, field })
        };
        starts.iter().enumerate().filter_map(of).collect()
    }

    /// Whether there are several strata.
    pub fn is_layered(&self) -> bool {
        self.layers.iter().filter(|layer| layer.role == Role::Background && layer.field.is_some()).count() > 1
    }

    /// The number of the stratum at each pixel of the exemplar, 0 at the bottom.
    pub fn strata_labels(&self) -> LabelMap {
        let (width, height) = (self.source.width, self.source.height);
        let mut labels = LabelMap::filled(width, height, 0);
        for (k, stratum) in (0..).zip(self.strata()) {
            let Some(region) = stratum.region().map(Interior::new) else { continue };
            for y in 0..height as usize {
                for [a, b] in region.intervals(y as f64 + 0.5) {
                    // The pixels whose middles lie inside.
                    let [x0, x1] = [a, b].map(|x| libm::ceil(x - 0.5).clamp(0.0, f64::from(width)) as usize);
                    labels.labels[y * width as usize..][x0..x1.max(x0)].fill(k);
                }
            }
        }
        labels
    }

    /// The number of the stratum of each element.
    pub fn strata_of_elements(&self) -> Vec<u8> {
        let mut strata = vec![0; self.elements.len()];
        for (k, stratum) in (0..).zip(self.strata()) {
            stratum.elements().for_each(|element| strata[element.index()] = k);
        }
        strata
    }

    /// Colours sampled between the elements. With several strata, each stratum contributes the colours where
    /// it is on top.
    ///
    /// # Panics
    /// If no layer has a field, which [`Library::read`] excludes.
    pub fn background(&self) -> Cow<'_, Field> {
        let strata: Vec<_> = self.strata().into_iter().map(|s| (s.region(), s.field)).collect();
        joined(&strata).expect("a library has a background")
    }
}

#[cfg(test)]
mod tests {
    use crate::library::testing::{guided, layered, mosaic};
    use vtex_base::document::Document as _;
    use vtex_base::raster::colour::Colour;

    #[test]
    fn strata_are_what_their_layers_say() {
        let map = mosaic(120, 14.0, 0.6, 1);
        let (plain, library) = (guided(&map), layered(&map));
        assert_eq!((library.validate(), library.is_layered(), plain.is_layered()), (Ok(()), true, false));
        assert_eq!(plain.strata().len(), 1);
        assert!(plain.strata_labels().labels.iter().all(|&l| l == 0));
        let strata = library.strata();
        let names: Vec<&str> = strata.iter().map(|s| s.name()).collect();
        assert_eq!((names, strata[1].colour()), (vec!["paint", "rust"], Colour([180; 3])));
        let labels = library.strata_labels();
        assert!((0..120).all(|y| (0..120).all(|x| labels.get(x, y) == u32::from(x >= 60))));
        for (element, stratum) in library.elements.iter().zip(library.strata_of_elements()) {
            assert_eq!(element.centroid[0] >= 60.0, stratum == 1);
        }
        let background = library.background();
        assert!(background.points.iter().all(|p| (p.x >= 60.0) == (p.colour == Colour([180; 3]))));
        assert_eq!(background.points.len(), 4);
    }
}
