//! The units of a library, and its pixels.
//!
//! A library has the size of its exemplar: the pixels of a photograph as it was taken, the units of a
//! drawing's page. All of its geometry is in these units, and so are canvases and scenes, so that sizes seen
//! by users do not depend on the resolution of the analysis. The arrangement and the guide are maps; they
//! have [`Source::scale`](super::Source::scale) pixels for each unit. A photograph that was reduced has fewer
//! than one, a small drawing several. Areas of elements and the windows of descriptors are counted in pixels
//! of the arrangement, because they are read from it.
//!
//! Placement works on pixels. [`Library::at_scale`] gives it a library whose units are pixels.

use super::{Arrangement, ExemplarElement, ExemplarInstance, ExemplarLayer, Guide, Library, Picture};
use crate::scene::scaling::{conjugate, place};
use std::borrow::Cow;
use vtex_base::geometry::{Affine, Outline};
use vtex_base::raster::{Filter, resized};

impl Library {
    /// Whether a unit of the exemplar is a pixel of the arrangement.
    pub fn is_in_pixels(&self) -> bool {
        self.source.scale == [1.0; 2]
    }

    /// Pixels of the arrangement for each unit, the mean of both axes.
    pub fn pixels_per_unit(&self) -> f64 {
        libm::sqrt(self.source.scale[0] * self.source.scale[1])
    }

    /// Width and height of the exemplar in its units. Those of a drawing's page need not be whole.
    pub fn page(&self) -> [f64; 2] {
        let pixels = [self.arrangement.width, self.arrangement.height].map(f64::from);
        [0, 1].map(|k| pixels[k] / self.source.scale[k])
    }

    /// The library with `pixels` pixels of the arrangement for each unit, and these pixels as its units. The
    /// maps are resampled unless they have this resolution already.
    pub fn at_scale(&self, pixels: [f64; 2]) -> Cow<'_, Self> {
        if self.is_in_pixels() && pixels == [1.0; 2] {
            return Cow::Borrowed(self);
        }
        let by = [0, 1].map(|k| pixels[k] / self.source.scale[k]);
        let own = [self.arrangement.width, self.arrangement.height];
        let size = [0, 1].map(|k| (libm::round(f64::from(own[k]) * by[k]) as u32).max(1));
        let mut library = self.scaled(pixels);
        if size != own {
            library.resample(size, by[0] * by[1]);
        }
        [library.source.width, library.source.height] = size;
        library.source.scale = [1.0; 2];
        Cow::Owned(library)
    }

    /// The library with all its geometry scaled along x and y; the maps stay as they are.
    pub fn scaled(&self, by: [f64; 2]) -> Self {
        let mean = libm::sqrt(by[0] * by[1]);
        let affine = Affine::scale_non_uniform(by[0], by[1]);
        let moved = |outline: &Outline| outline.moved(affine);
        let instance =
            |i: &ExemplarInstance| ExemplarInstance { transform: conjugate(i.transform, by, by), ..*i };
        let element = |e: &ExemplarElement| ExemplarElement {
            centroid: place(e.centroid, by),
            silhouette: e.silhouette.as_ref().map(moved),
            shapes: e.shapes.iter().map(|shape| shape.moved(affine)).collect(),
            ..*e
        };
        let layer = |l: &ExemplarLayer| ExemplarLayer {
            name: l.name.clone(),
            region: l.region.as_ref().map(moved),
            field: l.field.as_ref().map(|field| field.scaled(by)),
            spacing: l.spacing.map(|spacing| spacing * mean),
            instances: l.instances.iter().map(instance).collect(),
            ..*l
        };
        Self {
            format: self.format.clone(),
            source: self.source.clone(),
            elements: self.elements.iter().map(element).collect(),
            layers: self.layers.iter().map(layer).collect(),
            categories: self.categories.clone(),
            arrangement: self.arrangement.clone(),
            guide: self.guide.clone(),
            lattice: self.lattice.as_ref().map(|lattice| lattice.scaled(by)),
            motifs: self.motifs.clone(),
            ..*self
        }
    }

    /// Resamples the maps; `area` is the resulting factor of areas in pixels.
    fn resample(&mut self, size: [u32; 2], area: f64) {
        let [width, height] = size;
        let labels = self.arrangement.to_labels().resized(width, height);
        let vacated = self.arrangement.vacated_labels().map(|map| map.resized(width, height));
        let periodic = self.arrangement.periodic;
        self.arrangement =
            Arrangement { periodic, ..Arrangement::from_labels(&labels) }.with_vacated(vacated.as_ref());
        for element in &mut self.elements {
            element.area = (libm::round(f64::from(element.area) * area) as u32).max(1);
        }
        self.categories.iter_mut().for_each(|category| category.centre[3] *= area);
        let half = libm::round(f64::from(self.descriptor_half) * libm::sqrt(area)) as u32;
        self.descriptor_half = half.clamp(1, (width.min(height) / 2).max(1));
        if let Some(guide) = &mut self.guide {
            let cell = Guide::cell_for(width, height);
            let [columns, rows] = size.map(|side| side.div_ceil(cell));
            let picture = resized(&guide.picture.0, columns, rows, Filter::Triangle);
            *guide = Guide { cell, picture: Picture(picture) };
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::library::testing::{guided, layered, mosaic};
    use crate::library::{AnalyzeParams, Library};
    use vtex_base::document::Document as _;

    /// A library of which each unit is half a pixel of the arrangement.
    fn reduced(library: &Library) -> Library {
        let mut reduced = library.scaled([2.0; 2]);
        reduced.source.scale = [0.5; 2];
        reduced.source.width *= 2;
        reduced.source.height *= 2;
        reduced
    }

    #[test]
    fn a_library_comes_back_from_its_pixels() {
        for library in [guided(&mosaic(120, 14.0, 0.6, 1)), layered(&mosaic(120, 14.0, 0.6, 1))] {
            // Scaled places are rounded.
            let library = library.scaled([1.0; 2]);
            let reduced = reduced(&library);
            assert_eq!(reduced.validate(), Ok(()));
            let outline = |l: &Library| l.elements[3].outline().bounds();
            assert!((outline(&reduced).width() - 2.0 * outline(&library).width()).abs() < 0.02);
            assert_eq!(*reduced.at_scale([0.5; 2]), library);
            assert!(matches!(library.at_scale([1.0; 2]), std::borrow::Cow::Borrowed(_)));
        }
    }

    #[test]
    fn maps_are_resampled_to_the_units() {
        let library = reduced(&guided(&mosaic(120, 14.0, 0.6, 1)));
        let fine = library.at_scale([1.0; 2]);
        assert_eq!((fine.validate(), fine.source.width, fine.arrangement.width), (Ok(()), 240, 240));
        let areas = [&library, &*fine].map(|l| l.arrangement.to_labels().areas());
        assert!(areas[0].iter().zip(&areas[1]).all(|(a, b)| 4 * a == *b));
        assert_eq!((fine.elements[2].area, fine.descriptor_half), {
            (4 * library.elements[2].area, 2 * library.descriptor_half)
        });
        assert_eq!(fine.source.parameters, AnalyzeParams::default());
    }
}
