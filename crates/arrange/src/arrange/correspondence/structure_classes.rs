//! Classes of the large structure. A cell of the canvas takes its source from pixels of the exemplar of its
//! own class. Classes are the strata of a given map, or six bands of lightness by rank.

use crate::arrange::controls::{self, Controls};
use vtex_base::raster::blur::Plane;
use vtex_base::raster::colour::oklab;
use vtex_base::raster::{ControlMap, LabelMap};
use vtex_scene::library::Library;

/// Classes of lightness.
const BANDS: usize = 6;
/// Blur of the exemplar's lightness before it is divided into classes, in cells of the guide.
const BLUR: f32 = 2.0;

/// Classes of the exemplar and of the canvas.
pub(super) struct StructureClasses<'a> {
    exemplar: LabelMap,
    canvas: ClassSource<'a>,
}

/// The map that gives the class of a place of the canvas.
enum ClassSource<'a> {
    Strata(&'a LabelMap),
    Lightness(&'a ControlMap),
}

impl<'a> StructureClasses<'a> {
    /// The classes of a single library; `None` if the controls give no structure.
    pub(super) fn new(libraries: &[Library], controls: &'a Controls) -> Option<Self> {
        let [library] = libraries else { return None };
        let (exemplar, canvas) = match controls.structure.as_ref()? {
            controls::StructureGuide::Strata(map) => (library.strata_labels(), ClassSource::Strata(map)),
            controls::StructureGuide::Lightness(map) => (bands_of(library)?, ClassSource::Lightness(map)),
        };
        Some(Self { exemplar, canvas })
    }

    /// The class of each pixel of the exemplar.
    pub(super) fn of_exemplar(&self) -> &LabelMap {
        &self.exemplar
    }

    /// The class of each cell of a field of `size` cells, given the middle of each in pixels of the canvas.
    pub(super) fn of_cells(
        &self,
        canvas: [u32; 2],
        size: [usize; 2],
        place: impl Fn(usize, usize) -> [i32; 2],
    ) -> Vec<u8> {
        let cells = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let places = cells.map(|(x, y)| [0, 1].map(|k| place(x, y)[k].clamp(0, canvas[k] as i32 - 1)));
        match self.canvas {
            ClassSource::Strata(map) => {
                places.map(|p| map.under(p.map(|v| v as u32), canvas) as u8).collect()
            }
            ClassSource::Lightness(map) => {
                let canvas = canvas.map(f64::from);
                let values: Vec<f32> = places.map(|p| map.at(p.map(f64::from), canvas) as f32).collect();
                bands(&values).into_iter().map(|band| band as u8).collect()
            }
        }
    }
}

/// Classes of lightness of an exemplar, pixel by pixel; `None` without a guide.
fn bands_of(library: &Library) -> Option<LabelMap> {
    let guide = library.guide.as_ref()?;
    let picture = &guide.picture.0;
    let size = [picture.width() as usize, picture.height() as usize];
    let values = picture.pixels().map(|p| oklab(p.0)[0]).collect();
    let wrap = [library.arrangement.periodic; 2];
    let classes = bands(&Plane { size, values }.blurred(BLUR, wrap).values);
    let (width, height) = (library.source.width, library.source.height);
    let of = |i: usize| {
        let [x, y] = [i % width as usize, i / width as usize].map(|v| v / guide.cell as usize);
        classes[y * size[0] + x]
    };
    Some(LabelMap { width, height, labels: (0..width as usize * height as usize).map(of).collect() })
}

/// The class of each value, by its rank. Classes have equally many values, except that equal values share a
/// class.
fn bands(values: &[f32]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut classes = vec![0; values.len()];
    let mut before = 0;
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        // The middle rank, doubled.
        let rank = 2 * before + equal.len();
        let class = (rank * BANDS / (2 * values.len())).min(BANDS - 1);
        equal.iter().for_each(|&i| classes[i] = class as u32);
        before += equal.len();
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_of_equal_size_and_equal_values_stay_together() {
        let values: Vec<f32> = (0..600).map(|i| ((i * 7) % 600) as f32).collect();
        let classes = bands(&values);
        for class in 0..BANDS as u32 {
            assert_eq!(classes.iter().filter(|&&c| c == class).count(), 100);
        }
        assert!(classes.iter().zip(&values).all(|(&c, &v)| c == v as u32 / 100));
        let flat = bands(&[0.5; 40]);
        assert!(flat.iter().all(|&c| c == flat[0]));
    }
}
