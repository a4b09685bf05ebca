//! New layer maps whose labels are copied along a correspondence field.
//!
//! The features of the exemplar's cells, a 128th of its shorter side wide, are the colours of the
//! photograph and the labels of its layers. The field gives the source of each cell of the canvas. The
//! cells around a place vote on its depth in each region. Labels follow from depths by rank, so regions are
//! nested and their areas exact.

use super::carrier::{Carrier, pixel_of};
use super::map::{Contacts, LayerMap};
use super::regions::{Depths, depth};
use crate::correspondence::{CHANNELS, CanvasRequest, ExemplarPage, find};
use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_base::raster::blur::oklab_planes;
use vtex_base::raster::check_size;

/// Cells along the shorter side of an exemplar.
pub(super) const CELLS: usize = 128;
/// Weight of one layer relative to one standard deviation of colour.
const LABEL_WEIGHT: f32 = 0.7;
/// Half the width of the soft transition between layers in the features, in cells.
const SOFT: f32 = 1.5;
/// Depths are clamped to this many cells where they replace colours.
const DEEP: f32 = 6.0;

/// The model of new maps.
#[derive(Clone, Copy, Debug)]
pub struct LayerExemplar<'a> {
    /// Its layers.
    pub map: &'a LayerMap,
    /// The photograph of these layers, if there is one. Its colours keep structure that labels do not show.
    pub photograph: Option<&'a RgbImage>,
}

impl LayerExemplar<'_> {
    /// Side of a cell, in pixels.
    pub(super) fn cell(&self) -> usize {
        let [w, h] = self.map.size();
        (w.min(h) as f64 / CELLS as f64).round().max(1.0) as usize
    }

    /// Checks that the photograph has the size of the map and that the map has a border.
    pub(super) fn check(&self) -> Result<()> {
        self.map.check_layered()?;
        self.photograph.map_or(Ok(()), |photo| self.map.check_photograph(photo.dimensions()))
    }

    /// Largest permitted share of borders between non-consecutive layers: that of the exemplar
    /// plus 1 %.
    pub(super) fn most_distant(&self) -> f64 {
        Contacts::new(&self.map.labels, self.map.layers.len(), [false; 2]).distant() + 0.01
    }

    /// Area in pixels below which a piece is removed: a quarter of the least that [`super::find`] leaves.
    pub(super) fn speck(&self) -> usize {
        let [w, h] = self.map.size();
        (w.min(h) * w.min(h)) / 10_000
    }

    /// Makes a new map of `size` pixels along a correspondence field. The map repeats along the axes of
    /// `wrap`. Areas are those of the exemplar.
    ///
    /// # Errors
    /// [`vtex_base::Error::Control`] if the map has one layer or another size than the photograph; a size out
    /// of range; [`vtex_base::Error::Interrupted`].
    pub fn carried(
        &self,
        size: [usize; 2],
        wrap: [bool; 2],
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<LayerMap> {
        self.check()?;
        check_size(size)?;
        let cell = self.cell();
        let depths = self.depths();
        let page = self.page(&depths, cell);
        let cells = size.map(|v| v.div_ceil(cell));
        let request = CanvasRequest { pages: &[page], size: cells, wrap, groups: None, active: None, seed };
        let field = find(&request, progress)?;
        let carrier = Carrier::filling(&field, cell, size, pixel_of(self.map.size()));
        Ok(self.copied(&carrier, depths))
    }

    /// Makes a new map along a given field, with the areas of the exemplar. It repeats along the axes of the field.
    ///
    /// # Errors
    /// [`vtex_base::Error::Control`] if the exemplar's map has one layer.
    pub fn along(
        &self,
        carrier: &Carrier<'_, impl Fn(usize, [i64; 2]) -> Option<usize> + Sync>,
    ) -> Result<LayerMap> {
        self.check()?;
        Ok(self.copied(carrier, self.depths()))
    }

    /// A map of the exemplar's depths, copied along a field.
    fn copied(
        &self,
        carrier: &Carrier<'_, impl Fn(usize, [i64; 2]) -> Option<usize> + Sync>,
        depths: Vec<Vec<f32>>,
    ) -> LayerMap {
        let (size, wrap) = (carrier.canvas, carrier.field.wrap);
        let planes = carrier.voted(&depths, size, 1, 0.6);
        let depths = Depths { size, wrap, grid: size, planes };
        self.map.with(depths.labels(&self.map.shares(), self.most_distant(), self.speck()))
    }

    /// The depth of each pixel of the exemplar in each region above the bottom.
    fn depths(&self) -> Vec<Vec<f32>> {
        (1..self.map.layers.len()).map(|k| depth(&self.map.region(k, [false; 2]))).collect()
    }

    /// The features of the exemplar for the search.
    fn page(&self, depths: &[Vec<f32>], cell: usize) -> ExemplarPage {
        let [w, h] = self.map.size();
        let size = [(w / cell).max(1), (h / cell).max(1)];
        let mean = |i: usize, value: &dyn Fn(usize) -> f32| {
            let [x0, y0] = [i % size[0] * cell, i / size[0] * cell];
            let mut sum = (0.0, 0.0);
            for y in y0..(y0 + cell).min(h) {
                for x in x0..(x0 + cell).min(w) {
                    sum = (sum.0 + value(y * w + x), sum.1 + 1.0);
                }
            }
            sum.0 / sum.1
        };
        let level = |i: usize| {
            let soft = |d: &Vec<f32>| 0.5 + 0.5 * (d[i] / (SOFT * cell as f32)).clamp(-1.0, 1.0);
            depths.iter().map(soft).sum::<f32>()
        };
        let cells = size[0] * size[1];
        let mut channels: [Vec<f32>; CHANNELS] = std::array::from_fn(|_| vec![0.0; cells]);
        channels[3] = (0..cells).map(|i| mean(i, &level)).collect();
        let middle = channels[3].iter().sum::<f32>() / cells as f32;
        channels[3].iter_mut().for_each(|v| *v = LABEL_WEIGHT * (*v - middle));
        if let Some(photo) = self.photograph {
            let planes = oklab_planes(photo, cell);
            let unit = 1.0 / deviation(planes.iter().map(|p| &p.values)).max(1e-3);
            for (channel, plane) in channels.iter_mut().zip(&planes) {
                // A photograph narrower than a cell still has one cell.
                if plane.values.len() == cells {
                    *channel = plane.values.iter().map(|v| v * unit).collect();
                }
            }
        } else {
            // Depths in the first three regions replace colours.
            for (channel, depth) in channels.iter_mut().zip(depths.iter().take(3)) {
                let value = |i: usize| (depth[i] / cell as f32).clamp(-DEEP, DEEP);
                *channel = (0..cells).map(|i| mean(i, &value)).collect();
            }
            let used = depths.len().min(3);
            let unit = 1.0 / deviation(channels[..used].iter()).max(1e-3);
            channels[..used].iter_mut().flatten().for_each(|v| *v *= unit);
        }
        let features = (0..cells).map(|i| std::array::from_fn(|c| channels[c][i])).collect();
        ExemplarPage { group: 0, groups: None, size, features, inside: None, periods: None }
    }
}

/// Square root of the summed variances of several channels.
pub(super) fn deviation<'v>(channels: impl Iterator<Item = &'v Vec<f32>>) -> f32 {
    let variance = |values: &Vec<f32>| {
        let count = values.len().max(1) as f64;
        let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / count;
        values.iter().map(|&v| (f64::from(v) - mean) * (f64::from(v) - mean)).sum::<f64>() / count
    };
    libm::sqrt(channels.map(variance).sum::<f64>()) as f32
}

#[cfg(test)]
mod tests {
    use super::super::names::named;
    use super::super::testing::{nested, surface};
    use super::*;
    use vtex_base::error::Error;
    use vtex_base::raster::LabelMap;
    use vtex_base::raster::colour::Colour;

    fn layered(labels: LabelMap, count: u8) -> LayerMap {
        let colours: Vec<Colour> = (0..count).map(|k| Colour([40 + 60 * k, 90, 60])).collect();
        LayerMap { labels, layers: named(&colours) }
    }

    #[test]
    fn areas_and_contacts_are_the_exemplars() {
        for (count, seed) in [(2u8, 1), (3, 2), (4, 3)] {
            let map = layered(nested([160, 140], usize::from(count), seed), count);
            let exemplar = LayerExemplar { map: &map, photograph: None };
            let made = exemplar.carried([240, 210], [false; 2], seed, &()).unwrap();
            assert_eq!(made.size(), [240, 210]);
            for (own, theirs) in made.shares().iter().zip(map.shares()) {
                assert!((own - theirs).abs() < 1e-3, "{:?} {:?}", made.shares(), map.shares());
            }
            let distant = Contacts::new(&made.labels, usize::from(count), [false; 2]).distant();
            assert!(distant <= exemplar.most_distant(), "{distant}");
            let same = exemplar.carried([240, 210], [false; 2], seed, &()).unwrap();
            assert_eq!(same, made);
            assert_ne!(exemplar.carried([240, 210], [false; 2], seed + 9, &()).unwrap(), made);
        }
    }

    #[test]
    fn borders_are_as_long_as_the_exemplars() {
        let (photo, labels) = surface([200, 200], 2, 4);
        let map = layered(labels, 2);
        let made = LayerExemplar { map: &map, photograph: Some(&photo) }
            .carried([400, 400], [true; 2], 1, &())
            .unwrap();
        let [own, theirs] = [&made, &map].map(|m| Contacts::new(&m.labels, 2, [false; 2]).total() as f64);
        let ratio = own / theirs / 4.0;
        assert!((0.7..1.3).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_map_that_repeats_has_no_seam() {
        let map = layered(nested([150, 150], 3, 5), 3);
        let made =
            LayerExemplar { map: &map, photograph: None }.carried([211, 173], [true; 2], 2, &()).unwrap();
        let [w, h] = made.size();
        let changes = |x: usize| {
            (0..h)
                .filter(|y| made.labels.labels[y * w + x] != made.labels.labels[y * w + (x + 1) % w])
                .count()
        };
        let inside = (0..w - 1).map(changes).sum::<usize>() as f64 / (w - 1) as f64;
        let most = (0..w - 1).map(changes).max().unwrap();
        assert!(changes(w - 1) <= most.max(2 * inside as usize + 4), "{} {inside} {most}", changes(w - 1));
    }

    #[test]
    fn any_size_is_filled_and_what_cannot_be_is_refused() {
        let map = layered(nested([40, 33], 2, 6), 2);
        let exemplar = LayerExemplar { map: &map, photograph: None };
        for size in [[1, 1], [3, 200], [50, 1]] {
            assert_eq!(exemplar.carried(size, [true, false], 1, &()).unwrap().size(), size);
        }
        let refused = |size| exemplar.carried(size, [false; 2], 1, &());
        assert!(matches!(refused([0, 5]), Err(Error::Parameter { name: "size", .. })));
        assert!(matches!(refused([20_000, 5]), Err(Error::TooLarge { .. })));
        let flat = layered(LabelMap::filled(40, 40, 0), 2);
        let one = LayerExemplar { map: &flat, photograph: None }.carried([9, 9], [false; 2], 1, &());
        assert!(matches!(one, Err(Error::Control { .. })));
        let (photo, _) = surface([64, 64], 2, 1);
        let other = LayerExemplar { map: &map, photograph: Some(&photo) }.carried([9, 9], [false; 2], 1, &());
        assert!(matches!(other, Err(Error::Control { .. })));
    }
}
