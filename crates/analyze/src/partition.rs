//! First stage: the division of pixels into elements.

use super::grid::{Cells, SubpixelGrid};
use super::margin::Margin;
use super::unmix::unmixed;
use super::{Exemplar, candidates, secondaries};
use image::RgbImage;
use std::borrow::Cow;
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::{AnalyzeParams, ExemplarElement};
use vtex_segment::segment::ScoredMask;

/// Fit tolerance (`fidelity`, in pixels) below which mixed pixels along rims keep their colours.
const FINEST_UNMIXED: f64 = 0.2;

/// A photograph divided into elements and the area between them. For a photograph that repeats, all maps
/// include a margin.
pub(super) struct Partition<'a> {
    pub(super) exemplar: &'a Exemplar,
    pub(super) params: &'a AnalyzeParams,
    /// The same in units of cells.
    pub(super) in_cells: Cells<AnalyzeParams>,
    pub(super) margin: Margin,
    pub(super) grid: SubpixelGrid,
    /// The photograph with its margin. Only edges are located in it.
    pub(super) image: Cow<'a, RgbImage>,
    /// Its cells; cells along the borders of primaries have the colour of their own side. Shapes take their
    /// colours from these.
    pub(super) clean: Cells<RgbImage>,
    /// A label for each primary, 0 between them.
    pub(super) labels: LabelMap,
    /// The mask of each primary.
    pub(super) primaries: Vec<Cells<Mask>>,
    /// Labels of primaries that a border cuts and whose other part was not found.
    cut: Vec<u32>,
    /// Small patches between primaries.
    pub(super) patches: Vec<Cells<Mask>>,
}

/// The enlarged photograph, and what it was made of: the photograph, and the number of cells along a pixel.
#[derive(Default)]
pub(super) struct EnlargedMemory(Option<(RgbImage, u32, Cells<RgbImage>)>);

impl EnlargedMemory {
    /// The photograph with `cells` cells along a pixel. If it is not known, `enlarge` makes it.
    pub(super) fn of(
        &mut self,
        image: &RgbImage,
        cells: u32,
        enlarge: impl FnOnce() -> Cells<RgbImage>,
    ) -> &Cells<RgbImage> {
        let is_same =
            |(known, count, _): &(RgbImage, u32, Cells<RgbImage>)| *count == cells && known == image;
        let kept = self.0.take().filter(is_same);
        &self.0.insert(kept.unwrap_or_else(|| (image.clone(), cells, enlarge()))).2
    }
}

/// The elements made from the pieces.
pub(super) struct ElementShapes {
    /// Primaries; their categories are not assigned yet.
    pub(super) primaries: Vec<ExemplarElement>,
    pub(super) secondaries: Vec<ExemplarElement>,
}

/// The elements of a photograph.
pub(super) struct Elements {
    pub(super) primaries: Vec<ExemplarElement>,
    pub(super) secondaries: Vec<ExemplarElement>,
    /// The label of a primary on each pixel, 0 between them.
    pub(super) labels: LabelMap,
}

impl<'a> Partition<'a> {
    pub(super) fn new(
        exemplar: &'a Exemplar,
        masks: &[ScoredMask],
        params: &'a AnalyzeParams,
        memory: Option<&mut EnlargedMemory>,
    ) -> Self {
        let primaries = candidates::select(&exemplar.image, masks, params.minimum_area);
        let size = exemplar.image.dimensions().into();
        let margin = if params.wrap { Margin::new(&primaries) } else { Margin::none(size) };
        let (mut labels, cut) = margin.primaries(primaries);
        let image = margin.image(&exemplar.image);
        let grid = SubpixelGrid::new(&exemplar.image, params);
        let (enlarge, in_cells) = (|| grid.image(&image), grid.params(params));
        let fresh;
        let fine = match memory {
            Some(memory) => memory.of(&image, grid.cells, enlarge),
            None => {
                fresh = enlarge();
                &fresh
            }
        };
        let mut cells = grid.labels(&image, fine, &labels);
        let mut clean = own_colours(fine, &cells, grid, params);
        let patches = secondaries::find(&clean, &cells, &in_cells);
        promote(&mut labels, &mut cells, &patches.promoted, grid);
        if !patches.promoted.is_empty() {
            clean = own_colours(fine, &cells, grid, params);
        }
        let count = cells.labels.iter().max().map_or(0, |m| *m as usize);
        let primaries = Mask::all_of_labels(&cells, count + 1).split_off(1).into_iter().map(Cells).collect();
        let patches = patches.secondaries;
        Self { exemplar, params, in_cells, margin, grid, image, clean, labels, primaries, cut, patches }
    }

    /// A map of the photograph with a label above 0 wherever there is an element.
    pub(super) fn textons(&self) -> LabelMap {
        let mut cells = Cells(LabelMap::filled(self.clean.width(), self.clean.height(), 0));
        for (label, mask) in (1..).zip(&self.primaries) {
            cells.0.fill(mask, label);
        }
        self.patches.iter().for_each(|mask| cells.0.fill(mask, 1));
        self.margin.inner(&self.grid.pixels(&cells)).into_owned()
    }

    /// Whether a mask counts as part of the photograph, not of its margin.
    pub(super) fn counts(&self, mask: &Cells<Mask>) -> bool {
        self.margin.holds(self.grid.centroid(mask))
    }

    /// The elements whose centroid lies in the photograph.
    pub(super) fn elements(self, shapes: ElementShapes) -> Elements {
        let ElementShapes { mut primaries, secondaries } = shapes;
        for (label, (primary, mask)) in (1..).zip(primaries.iter_mut().zip(&self.primaries)) {
            let cut = touches_border(mask, self.clean.width(), self.clean.height());
            primary.clipped = cut || self.cut.contains(&label);
        }
        let (primaries, labels) = self.margin.kept_primaries(primaries, self.labels);
        Elements { primaries, secondaries: self.margin.kept(secondaries), labels }
    }
}

/// The enlarged image, in which cells along the borders of primaries have the colour of their side.
fn own_colours(
    fine: &Cells<RgbImage>,
    cells: &Cells<LabelMap>,
    grid: SubpixelGrid,
    params: &AnalyzeParams,
) -> Cells<RgbImage> {
    if params.fidelity < FINEST_UNMIXED { fine.clone() } else { unmixed(fine, cells, grid) }
}

/// Adds promoted patches to the primaries, on both the pixel and the cell map.
fn promote(
    primaries: &mut LabelMap,
    cells: &mut Cells<LabelMap>,
    promoted: &[Cells<Mask>],
    grid: SubpixelGrid,
) {
    let first = cells.labels.iter().max().map_or(0, |m| *m) + 1;
    for (k, mask) in promoted.iter().enumerate() {
        cells.0.fill(mask, first + k as u32);
    }
    for (label, new) in primaries.labels.iter_mut().zip(grid.pixels(cells).labels) {
        if *label == 0 && new >= first {
            *label = new;
        }
    }
}

fn touches_border(mask: &Cells<Mask>, width: u32, height: u32) -> bool {
    mask.bounds()
        .is_some_and(|(x0, y0, x1, y1)| x0 <= 0 || y0 <= 0 || x1 >= width as i32 || y1 >= height as i32)
}
