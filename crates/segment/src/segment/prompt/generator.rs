//! "Segment everything": prompts a network on grids from coarse to fine, and filters the masks.
//!
//! A point is skipped if a confident mask explains it or if the network expects nothing there. Of each mask
//! the piece under its point is kept, and nearly equal masks are merged. The generator knows networks only as
//! [`Prompter`].

use super::proposal::Proposal;
use super::{Embedded, PromptMask, Prompter};
use crate::segment::courses::whole_cells;
use crate::segment::similar::{Measured, SimilarMask, SimilarMasks};
use crate::segment::{ScoredMask, Segmenter};
use image::RgbImage;
use vtex_base::error::{Result, check};
use vtex_base::parallel::map;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::{Filter, LabelMap, Mask, resized};

/// Parameters of a [`Generator`].
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratorParams {
    /// Distance between prompts of the finest grid, in pixels. 1 to 256, default 5 (the paper's 10 000
    /// prompts for 500 × 500 pixels).
    pub spacing: f32,
    /// Number of grids, each twice as fine as the previous one. 1 to 6, default 3. A point is skipped if it lies in a
    /// mask of a coarser grid that is confident, or that many points have given.
    pub levels: u32,
    /// Scales at which the image is shown to the network. Each 0.1 to 8, default 1.
    pub scales: Vec<f32>,
    /// Side in pixels above which a scaled image is shown in crops. 64 to 16384, default 1024.
    pub crop: u32,
    /// Least predicted IoU of a mask. 0 to 1, default 0.88 (SAM's own).
    pub predicted_iou: f32,
    /// Least stability of a mask: the IoU of the masks at a raised and at a lowered threshold. 0 to 1,
    /// default 0.9.
    pub stability: f32,
    /// Least product of predicted IoU and stability of a confident mask. 0 to 1, default 0.85.
    pub confident: f32,
    /// Area of the smallest mask, in pixels. 1 or more, default 12.
    pub smallest: f32,
    /// Area of the largest mask, as a share of the image. 0 to 1, default 0.25.
    pub largest: f32,
    /// IoU above which two masks are duplicates. 0.5 to 1, default 0.8.
    pub duplicate: f32,
}

impl Default for GeneratorParams {
    fn default() -> Self {
        Self {
            spacing: 5.0,
            levels: 3,
            scales: vec![1.0],
            crop: 1024,
            predicted_iou: 0.88,
            stability: 0.9,
            confident: 0.85,
            smallest: 12.0,
            largest: 0.25,
            duplicate: 0.8,
        }
    }
}

impl GeneratorParams {
    fn validate(&self) -> Result<()> {
        let share = 0.0..=1.0;
        check((1.0..=256.0).contains(&self.spacing), "point-spacing", self.spacing, "1 to 256 pixels")?;
        check((1..=6).contains(&self.levels), "levels", self.levels, "1 to 6")?;
        for scale in &self.scales {
            check((0.1..=8.0).contains(scale), "scales", scale, "0.1 to 8")?;
        }
        check((64..=16_384).contains(&self.crop), "crop", self.crop, "64 to 16384 pixels")?;
        check(share.contains(&self.predicted_iou), "predicted-iou", self.predicted_iou, "0 to 1")?;
        check(share.contains(&self.stability), "stability", self.stability, "0 to 1")?;
        check(share.contains(&self.confident), "confident", self.confident, "0 to 1")?;
        check(self.smallest >= 1.0, "smallest", self.smallest, "1 pixel or more")?;
        check(share.contains(&self.largest), "largest", self.largest, "0 to 1")?;
        check((0.5..=1.0).contains(&self.duplicate), "duplicate", self.duplicate, "0.5 to 1")
    }
}

/// A mask found by a [`Generator`], with measures of its quality.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMask {
    /// The pixels, in one piece.
    pub mask: Mask,
    /// IoU with the true mask as predicted by the network, 0 to 1.
    pub predicted_iou: f32,
    /// IoU of the masks at a raised and at a lowered threshold, 0 to 1.
    pub stability: f32,
    /// Number of prompts that gave this mask or a duplicate of it.
    pub votes: u32,
    /// Index in [`GeneratorParams::scales`] of the scale at which it was found.
    pub scale: usize,
}

impl FoundMask {
    fn score(&self) -> f32 {
        self.predicted_iou * self.stability
    }
}

/// Cost of a run of a [`Generator`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of points of the finest grids.
    pub grid: u64,
    /// Number of points that the network was prompted with.
    pub prompts: u64,
}

/// Finds all masks that a promptable network gives on a grid of points.
pub struct Generator {
    prompter: Box<dyn Prompter>,
    params: GeneratorParams,
}

/// A part of the image as it is shown to the network.
pub(in crate::segment) struct View {
    /// Left and upper border of the part, and its size, in pixels of the image.
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    /// Factor by which it is enlarged.
    pub(in crate::segment) scale: f32,
    index: usize,
}

impl View {
    /// The whole image.
    pub(in crate::segment) fn whole([width, height]: [u32; 2], scale: f32, index: usize) -> Self {
        Self { x: 0, y: 0, width, height, scale, index }
    }

    /// The part, cut out and enlarged.
    pub(in crate::segment) fn image(&self, image: &RgbImage) -> RgbImage {
        let cut = image::imageops::crop_imm(image, self.x, self.y, self.width, self.height).to_image();
        if self.scale == 1.0 {
            return cut;
        }
        let side = |n: u32| (libm::roundf(n as f32 * self.scale) as u32).max(1);
        resized(&cut, side(self.width), side(self.height), Filter::CatmullRom)
    }

    /// All masks of the part that pass the thresholds, in pixels of the image.
    pub(in crate::segment) fn search(
        &self,
        embedded: &dyn Embedded,
        [width, height]: [u32; 2],
        params: &GeneratorParams,
        progress: &dyn Progress,
        cost: &mut Cost,
    ) -> Result<Vec<FoundMask>> {
        let mut search = ViewSearch { params, view: self, kept: Vec::new() };
        search.run(embedded, progress, cost)?;
        Ok(search.finish(width, height))
    }
}

impl Generator {
    /// A generator for a network.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] if a parameter is out of its range.
    pub fn new(prompter: Box<dyn Prompter>, params: GeneratorParams) -> Result<Self> {
        params.validate()?;
        Ok(Self { prompter, params })
    }

    /// All masks that pass the thresholds, without duplicates at the same scale, sorted by predicted IoU ×
    /// stability in descending order. Also returns the cost.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`] and [`vtex_base::Error::Network`].
    pub fn find(&self, image: &RgbImage, progress: &dyn Progress) -> Result<(Vec<FoundMask>, Cost)> {
        let mut found: Vec<FoundMask> = Vec::new();
        let mut cost = Cost::default();
        for view in self.views(image.width(), image.height()) {
            advance(progress, "reading the image", 0, 0)?;
            let embedded = self.prompter.embed(&view.image(image))?;
            let size = [image.width(), image.height()];
            let here = view.search(embedded.as_ref(), size, &self.params, progress, &mut cost)?;
            self.join(&mut found, here);
        }
        found.sort_by(|a, b| b.score().total_cmp(&a.score()));
        Ok((found, cost))
    }

    /// Merges the masks of another view. Of two duplicates at one scale the better one stays.
    fn join(&self, found: &mut Vec<FoundMask>, here: Vec<FoundMask>) {
        let measure = |f: &FoundMask| Measured::new(f.mask.clone());
        let measured: Vec<Option<Measured>> = found.iter().map(measure).collect();
        let mut index = SimilarMasks::default();
        for (k, m) in measured.iter().enumerate() {
            m.iter().for_each(|m| index.add(m, k));
        }
        for new in here {
            let Some(own) = measure(&new) else { continue };
            let same = |&SimilarMask { index: k, .. }: &SimilarMask| {
                found[k].scale == new.scale
                    && measured[k].as_ref().is_some_and(|m| m.iou(&own) >= self.params.duplicate)
            };
            match index.near(&own, self.params.duplicate).into_iter().find(same) {
                Some(SimilarMask { index: k, .. }) => {
                    let votes = found[k].votes + new.votes;
                    if new.score() > found[k].score() {
                        found[k] = new;
                    }
                    found[k].votes = votes;
                }
                None => found.push(new),
            }
        }
    }

    fn views(&self, width: u32, height: u32) -> Vec<View> {
        let mut views = Vec::new();
        for (index, &scale) in self.params.scales.iter().enumerate() {
            views.push(View::whole([width, height], scale, index));
            let side = (self.params.crop as f32 / scale) as u32;
            if width.max(height) <= side || side == 0 {
                continue;
            }
            for (y, h) in cuts(height, side) {
                for (x, w) in cuts(width, side) {
                    views.push(View { x, y, width: w, height: h, scale, index });
                }
            }
        }
        views.retain(|v| v.width > 0 && v.height > 0);
        views
    }
}

/// Start and length of pieces of at most `side` that cover `length`, overlapping by a quarter.
fn cuts(length: u32, side: u32) -> Vec<(u32, u32)> {
    if length <= side {
        return vec![(0, length)];
    }
    let free = length - side;
    let count = free.div_ceil((side * 3 / 4).max(1));
    (0..=count).map(|k| ((u64::from(free) * u64::from(k) / u64::from(count)) as u32, side)).collect()
}

/// A mask that so many prompts have given is searched no further, even if it is doubtful: large masks take long to
/// compute.
const AGREED: u32 = 16;

/// The search of one view.
struct ViewSearch<'a> {
    params: &'a GeneratorParams,
    view: &'a View,
    kept: Vec<Proposal>,
}

impl ViewSearch<'_> {
    fn run(&mut self, embedded: &dyn Embedded, progress: &dyn Progress, cost: &mut Cost) -> Result<()> {
        let View { width, height, scale, .. } = *self.view;
        let count = |n: u32| (n as f32 / self.params.spacing).max(1.0) as u32;
        let (columns, rows) = (count(width), count(height));
        cost.grid += u64::from(columns) * u64::from(rows);
        let mut explained = LabelMap::filled(width, height, 0);
        for level in (0..self.params.levels).rev() {
            let stride = 1 << level;
            let mut points = Vec::new();
            for j in (stride / 2..rows).step_by(stride as usize) {
                for i in (stride / 2..columns).step_by(stride as usize) {
                    let on = |coarser: u32| {
                        let stride = 1 << coarser;
                        i % stride == stride / 2 && j % stride == stride / 2
                    };
                    let again = (level + 1..self.params.levels).any(on);
                    let place = |k: u32, n: u32, of: u32| (k as f32 + 0.5) * of as f32 / n as f32;
                    let at = [place(i, columns, width), place(j, rows, height)];
                    if !again && explained.get(at[0] as u32, at[1] as u32) == 0 {
                        points.push(at.map(|v| v * scale));
                    }
                }
            }
            if let Some(expected_iou) = embedded.expected_iou(&points) {
                let mut expected_iou = expected_iou.into_iter();
                points.retain(|_| expected_iou.next().is_some_and(|p| p >= self.params.predicted_iou));
            }
            cost.prompts += points.len() as u64;
            self.ask(embedded, &points, level, progress)?;
            if level == 0 {
                break;
            }
            let is_known = |p: &&Proposal| p.score() >= self.params.confident || p.votes >= AGREED;
            let known: Vec<&Proposal> = self.kept.iter().filter(is_known).collect();
            // Pixels are computed on all threads and stored in the proposals.
            map(&known, |proposal| {
                self.mask(proposal);
            });
            known.iter().for_each(|proposal| explained.fill(self.mask(proposal), 1));
        }
        Ok(())
    }

    /// Prompts the network in batches and keeps the best of duplicates.
    fn ask(
        &mut self,
        embedded: &dyn Embedded,
        points: &[[f32; 2]],
        level: u32,
        progress: &dyn Progress,
    ) -> Result<()> {
        const STAGES: [&str; 6] = [
            "finding masks: finest grid",
            "finding masks: fine grid",
            "finding masks: coarse grid",
            "finding masks: coarser grid",
            "finding masks: coarser grid",
            "finding masks: coarsest grid",
        ];
        let mut proposals = std::mem::take(&mut self.kept);
        let mut done = 0;
        for batch in points.chunks(embedded.batch().max(1)) {
            advance(progress, STAGES[level as usize], done, points.len() as u64)?;
            let masks: Vec<(&[f32; 2], Vec<PromptMask>)> = batch.iter().zip(embedded.masks(batch)?).collect();
            let judged = map(&masks, |(point, masks)| -> Vec<Proposal> {
                masks.iter().filter_map(|mask| self.judge(**point, mask)).collect()
            });
            proposals.extend(judged.into_iter().flatten());
            done += batch.len() as u64;
        }
        proposals.sort_by(|a, b| b.score().total_cmp(&a.score()));
        let mut index = SimilarMasks::default();
        for proposal in proposals {
            let same = |near: &SimilarMask| {
                self.kept[near.index].cells.iou(&proposal.cells) >= self.params.duplicate
            };
            match index.near(&proposal.cells, self.params.duplicate).into_iter().find(same) {
                Some(near) => self.kept[near.index].votes += proposal.votes,
                None => {
                    index.add(&proposal.cells, self.kept.len());
                    self.kept.push(proposal);
                }
            }
        }
        Ok(())
    }

    fn judge(&self, point: [f32; 2], mask: &PromptMask) -> Option<Proposal> {
        let proposal = Proposal::new(point, mask)?;
        let View { width, height, scale, .. } = *self.view;
        let area = proposal.area() / (scale * scale);
        // A NaN fails the threshold.
        let good = mask.predicted_iou >= self.params.predicted_iou
            && proposal.stability >= self.params.stability
            && area >= self.params.smallest
            && area <= self.params.largest * (width * height) as f32;
        good.then_some(proposal)
    }

    /// The pixels of a proposal in the view, at the image's scale.
    fn mask<'a>(&self, proposal: &'a Proposal) -> &'a Mask {
        proposal.pixels.get_or_init(|| {
            let by = 1.0 / self.view.scale;
            proposal.logits.rasterise(by, self.view.width, self.view.height)
        })
    }

    /// The masks kept, in pixels of the whole image. Masks cut off by a crop are left to adjacent crops.
    fn finish(self, width: u32, height: u32) -> Vec<FoundMask> {
        let View { x, y, width: w, height: h, index, .. } = *self.view;
        let found = map(&self.kept, |proposal| {
            let mask = self.mask(proposal);
            let (x0, y0, x1, y1) = mask.bounds()?;
            let cut = (x > 0 && x0 <= 0)
                || (y > 0 && y0 <= 0)
                || (x + w < width && x1 >= w as i32)
                || (y + h < height && y1 >= h as i32);
            if cut || (mask.area() as f32) < self.params.smallest {
                return None;
            }
            Some(FoundMask {
                mask: mask.shifted(x as i32, y as i32),
                predicted_iou: proposal.predicted_iou,
                stability: proposal.stability,
                votes: proposal.votes,
                scale: index,
            })
        });
        found.into_iter().flatten().collect()
    }
}

impl Segmenter for Generator {
    fn name(&self) -> String {
        self.prompter.name()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        if image.width() == 0 || image.height() == 0 {
            return Ok(Vec::new());
        }
        let (found, _) = self.find(image, progress)?;
        let masks = found.into_iter().map(|f| ScoredMask { score: f.score(), mask: f.mask }).collect();
        Ok(whole_cells(masks, image))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn crops_cover_a_length_and_overlap(length in 1..5000u32, side in 64..1500u32) {
            let crops = cuts(length, side);
            prop_assert_eq!(crops[0].0, 0);
            prop_assert_eq!(crops.last().map(|c| c.0 + c.1), Some(length));
            for pair in crops.windows(2) {
                prop_assert_eq!(pair[0].1, side);
                let shared = pair[0].0 + side - pair[1].0;
                prop_assert!(pair[1].0 > pair[0].0 && shared + 1 >= side / 4, "{shared} of {side}");
            }
        }
    }
}
