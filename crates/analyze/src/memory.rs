//! What an analysis leaves for the next one of the same photograph.
//!
//! A result is taken over where all that it was made from is the same. This is compared in full, pixel by pixel and
//! run by run, so an analysis with a memory gives the same library as one without. After a change of one mask, the
//! photograph is not enlarged again, its lattice and the clusters of its colours are not sought again, and only
//! elements near that mask are divided and shaded again.

use super::grid::Cells;
use super::partition::{EnlargedMemory, Partition};
use super::shading::ElementParts;
use super::strata::LayersMemory;
use image::RgbImage;
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex_base::raster::{Mask, Span};
use vtex_scene::lattice::{self, Lattice};
use vtex_scene::library::AnalyzeParams;

/// Results of the last analysis that the next one may take over; see [`analyze_again`](crate::analyze_again).
///
/// It holds about 80 bytes for each pixel of the photograph at the size at which it is analysed.
#[derive(Default)]
pub struct AnalysisMemory {
    pub(super) enlarged: EnlargedMemory,
    pub(super) layers: LayersMemory,
    pub(super) lattice: LatticeMemory,
    pub(super) elements: ElementsMemory,
}

/// The lattice of a photograph.
#[derive(Default)]
pub(super) struct LatticeMemory(Option<(RgbImage, Option<Lattice>)>);

impl LatticeMemory {
    pub(super) fn of(&mut self, image: &RgbImage) -> Option<Lattice> {
        let kept = self.0.take().filter(|(known, _)| known == image);
        self.0.insert(kept.unwrap_or_else(|| (image.clone(), lattice::find(image)))).1.clone()
    }
}

/// The parts of elements, by their masks, and what else they were made of.
#[derive(Default)]
pub(super) struct ElementsMemory(Option<KnownElements>);

struct KnownElements {
    params: AnalyzeParams,
    /// Cells along a pixel.
    cells: u32,
    clean: Cells<RgbImage>,
    parts: BTreeMap<Vec<Span>, Arc<ElementParts>>,
}

impl ElementsMemory {
    /// The parts of each primary of which the mask and all colours within `reach` cells of its bounds are the same.
    pub(super) fn of(&self, partition: &Partition<'_>, reach: usize) -> Vec<Option<Arc<ElementParts>>> {
        let clean = &partition.clean;
        let known = self.0.as_ref().filter(|known| {
            known.params == *partition.params
                && known.cells == partition.grid.cells
                && known.clean.dimensions() == clean.dimensions()
        });
        let Some(known) = known else { return vec![None; partition.primaries.len()] };
        let part = |mask: &Cells<Mask>| {
            let found = known.parts.get(mask.spans())?;
            is_same_around(&known.clean, clean, mask, reach as i32).then(|| Arc::clone(found))
        };
        partition.primaries.iter().map(part).collect()
    }

    /// Keeps the parts of the primaries.
    pub(super) fn put(&mut self, partition: &Partition<'_>, parts: Vec<Arc<ElementParts>>) {
        let spans = partition.primaries.iter().map(|mask| mask.spans().to_vec());
        self.0 = Some(KnownElements {
            params: partition.params.clone(),
            cells: partition.grid.cells,
            clean: partition.clean.clone(),
            parts: spans.zip(parts).collect(),
        });
    }
}

/// Whether two pictures of one size are the same within `reach` of the bounds of a mask.
fn is_same_around(one: &RgbImage, other: &RgbImage, mask: &Mask, reach: i32) -> bool {
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return true };
    let [width, height] = [one.width(), one.height()].map(|side| side as i32);
    let [x0, x1] = [x0 - reach, x1 + reach].map(|x| x.clamp(0, width) as usize);
    let [y0, y1] = [y0 - reach, y1 + reach].map(|y| y.clamp(0, height) as usize);
    (y0..y1).all(|y| {
        let row = 3 * (y * width as usize + x0)..3 * (y * width as usize + x1);
        one.as_raw()[row.clone()] == other.as_raw()[row]
    })
}

#[cfg(test)]
mod tests {
    use crate::{AnalysisMemory, Exemplar, analyze, analyze_again};
    use image::{Rgb, RgbImage};
    use vtex_base::raster::{Mask, Span};
    use vtex_scene::library::{AnalyzeParams, Shading};
    use vtex_segment::segment::{ScoredMask, Segmenter};

    struct Given(Vec<ScoredMask>);

    impl Segmenter for Given {
        fn name(&self) -> String {
            "given".into()
        }

        fn segment(
            &self,
            _: &RgbImage,
            _: &dyn vtex_base::progress::Progress,
        ) -> vtex_base::error::Result<Vec<ScoredMask>> {
            Ok(self.0.clone())
        }
    }

    /// Stones with a lit side, six in a row, some of which touch.
    fn stones(side: u32, hue: u8) -> (Exemplar, Vec<ScoredMask>) {
        let step = 22;
        let inside = |x: u32, y: u32| {
            let [u, v] = [x, y].map(|v| f64::from(v % step) + 0.5 - f64::from(step) / 2.0);
            let radius = 8.0 + f64::from((x / step * 7 + y / step * 5) % 4);
            (u * u + v * v < radius * radius).then_some(u + v)
        };
        let image = RgbImage::from_fn(side, side, |x, y| match inside(x, y) {
            Some(light) => Rgb([(120.0 + 5.0 * light) as u8, hue, (90.0 - 3.0 * light) as u8]),
            None => Rgb([(200 + (x * 7 + y * 13) % 9) as u8, 195, (170 + (x + y) % 5) as u8]),
        });
        let count = side / step;
        let cells = (0..count * count).map(|k| [k % count * step, k / count * step]);
        let mask = |[x0, y0]: [u32; 2]| {
            let pixels = (y0..y0 + step).flat_map(|y| (x0..x0 + step).map(move |x| (x, y)));
            let inside = pixels.filter(|&(x, y)| inside(x, y).is_some());
            Mask::from_spans(
                inside.map(|(x, y)| Span { y: y as i32, x0: x as i32, x1: x as i32 + 1 }).collect(),
            )
        };
        let masks = cells.map(|cell| ScoredMask { mask: mask(cell), score: 1.0 }).collect();
        let exemplar = Exemplar {
            image,
            copies: [1; 2],
            file: "stones.png".into(),
            sha256: "0".repeat(64),
            layers: None,
            warnings: Vec::new(),
        };
        (exemplar, masks)
    }

    #[test]
    fn a_library_does_not_depend_on_what_was_analysed_before() {
        let (exemplar, masks) = stones(132, 80);
        let (other, _) = stones(132, 140);
        let plain = AnalyzeParams { minimum_area: 20, ..AnalyzeParams::default() };
        let flat = AnalyzeParams { shading: Shading::Flat, layers: 2, ..plain.clone() };
        let wrapped = AnalyzeParams { wrap: true, ..plain.clone() };
        let seeded = AnalyzeParams { seed: 9, ..plain.clone() };
        let without = |k: usize| {
            let mut left = masks.clone();
            left.remove(k);
            left
        };
        let merged = {
            let mut left = without(20);
            let spans = [&left[8], &masks[20]].map(|m| m.mask.spans().to_vec()).concat();
            left[8].mask = Mask::from_spans(spans);
            left
        };
        let shrunk = {
            let mut left = masks.clone();
            left[14].mask = left[14].mask.interior();
            left
        };
        let mut memory = AnalysisMemory::default();
        let all = [
            (&exemplar, &masks, &plain),
            (&exemplar, &without(9), &plain),
            (&exemplar, &merged, &plain),
            (&exemplar, &masks, &plain),
            (&exemplar, &shrunk, &plain),
            (&exemplar, &shrunk, &flat),
            (&exemplar, &without(3), &flat),
            (&exemplar, &masks, &wrapped),
            (&exemplar, &without(0), &wrapped),
            (&exemplar, &without(0), &seeded),
            (&other, &without(0), &seeded),
            (&exemplar, &Vec::new(), &seeded),
            (&exemplar, &masks, &plain),
        ];
        for (k, (exemplar, masks, params)) in all.into_iter().enumerate() {
            let segmenter = Given(masks.clone());
            let again = analyze_again(exemplar, &segmenter, params, &mut memory, &()).unwrap();
            let fresh = analyze(exemplar, &segmenter, params, &()).unwrap();
            assert!(masks.is_empty() || again.primaries().len() > 10, "{k}: {}", again.primaries().len());
            assert!(again.to_json() == fresh.to_json(), "{k}");
        }
    }

    #[test]
    fn what_did_not_change_is_taken_over() {
        let (exemplar, masks) = stones(132, 80);
        let params = AnalyzeParams { minimum_area: 20, ..AnalyzeParams::default() };
        let mut memory = AnalysisMemory::default();
        analyze_again(&exemplar, &Given(masks.clone()), &params, &mut memory, &()).unwrap();
        let before = memory.elements.0.as_ref().unwrap().parts.clone();
        analyze_again(&exemplar, &Given(masks[1..].to_vec()), &params, &mut memory, &()).unwrap();
        let after = &memory.elements.0.as_ref().unwrap().parts;
        let is_same = |spans, parts| before.get(spans).is_some_and(|old| std::sync::Arc::ptr_eq(old, parts));
        let taken_over = after.iter().filter(|(spans, parts)| is_same(*spans, *parts)).count();
        assert!(taken_over >= 30 && taken_over < masks.len(), "{taken_over} of {}", after.len());
    }

    #[test]
    fn what_was_stopped_leaves_a_memory_that_is_right() {
        let (exemplar, masks) = stones(132, 80);
        let params = AnalyzeParams { minimum_area: 20, ..AnalyzeParams::default() };
        let mut memory = AnalysisMemory::default();
        let segmenter = Given(masks);
        analyze_again(&exemplar, &segmenter, &params, &mut memory, &()).unwrap();
        let stopped = analyze_again(&exemplar, &segmenter, &params, &mut memory, &vtex_testing::StopAtOnce);
        assert!(matches!(stopped, Err(vtex_base::Error::Interrupted)));
        let again = analyze_again(&exemplar, &segmenter, &params, &mut memory, &()).unwrap();
        assert!(again.to_json() == analyze(&exemplar, &segmenter, &params, &()).unwrap().to_json());
    }
}
