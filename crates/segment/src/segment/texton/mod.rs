//! The texton segmenter: candidates from a promptable network and from the region tree, scored together.
//!
//! The network (`tools/texton`) is shown the image at three scales and prompted on a grid of points. Its
//! masks and the texton-like nodes of the region tree are the candidates. Each is measured in the image and
//! in the network's maps. A small perceptron fitted to procedural scenes and to labelled photographs scores it
//! (`tools/fit_texton.rs`, to be fitted again with every new network), and disjoint candidates of the highest
//! worth are selected greedily.
//!
//! The promptable network was trained only on generated scenes. Works less well on subjects that these do not cover:
//! crumpled litter, fur, grass.

mod convolution;
mod encoder;
mod features;
mod maps;
mod matrix;
mod network;
mod weights;
mod winograd;

pub use features::FEATURES;
pub use network::TextonNetwork;

use super::courses::whole_cells;
use super::prompt::{Cost, FoundMask, GeneratorParams, View};
use super::regions::nodes;
use super::similar::{Measured, SimilarMask, SimilarMasks};
use super::{Perceptron, ScoredMask, Segmenter, disjoint::disjoint, tiles};
use features::{MaskFeatureContext, PREDICTED, REGION, STABILITY, SearchMeasures};
use image::RgbImage;
use std::array;
use vtex_base::error::Result;
use vtex_base::parallel::{join, map};
use vtex_base::progress::{Progress, SideBySide, advance};
use vtex_base::raster::Mask;

/// Units of the hidden layer of the [`Judge`].
pub const HIDDEN: usize = 32;
/// The network that scores candidates: a perceptron whose output is the expected fit of a candidate to
/// a texton, 0 to 1.
pub type Judge = Perceptron<FEATURES, HIDDEN>;

/// Largest factor by which the image is enlarged, and largest number of pixels afterwards.
const ENLARGE: f32 = 2.0;
const PIXELS: f32 = 1.3e6;
/// Number of scales at which masks are sought, each half the previous one.
const SIZES: usize = 3;
/// The stage in which the network sees the image and region trees are made.
const READING: &str = "reading the image";
/// Least score of the region tree's nodes that become candidates.
const LEAST_NODE_SCORE: f32 = 0.2;
/// IoU above which nodes are merged.
const SAME_IOU: f32 = 0.9;
/// Lower bound of a candidate's score, as a share of the region tree's own score. It helps in
/// photographs unlike any generated scene, where the network fails.
const REGION_SHARE: f32 = 0.4;
/// Weight of the network's own estimate beside the judge's. The judge was fitted to no labelled photograph.
const OWN_WEIGHT: f32 = 0.1;

/// The texton segmenter. Its masks are disjoint and 4-connected.
pub struct Texton {
    network: TextonNetwork,
    search: GeneratorParams,
}

/// A mask that may be a texton, with the input of the [`Judge`].
#[derive(Clone, Debug, PartialEq)]
pub struct MaskCandidate {
    /// Its pixels.
    pub mask: Mask,
    /// Its features, in the order of `features.rs`.
    pub features: [f32; FEATURES],
}

impl Texton {
    /// Creates the segmenter with the built-in network.
    ///
    /// # Errors
    /// [`vtex_base::Error::Network`] if it is damaged.
    pub fn new() -> Result<Self> {
        let network = TextonNetwork::built_in()?;
        let search = GeneratorParams {
            predicted_iou: 0.4,
            stability: 0.4,
            confident: 0.82,
            ..GeneratorParams::default()
        };
        Ok(Self { network, search })
    }

    /// All masks that may be textons. They may contain one another.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    pub fn candidates(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<MaskCandidate>> {
        let size = [image.width(), image.height()];
        if size.contains(&0) {
            return Ok(Vec::new());
        }
        let pixels = image.width() as f32 * image.height() as f32;
        let enlarge = (PIXELS / pixels).sqrt().clamp(1.0, ENLARGE);
        let views: [View; SIZES] =
            array::from_fn(|index| View::whole(size, enlarge / (1 << index) as f32, index));
        let tasks = SideBySide::new(progress, READING);
        let see = |(index, view): (usize, &View)| {
            advance(&tasks, READING, index as u64, SIZES as u64)?;
            Ok(self.network.view(&view.image(image), self.search.predicted_iou))
        };
        let (seen, regions) = join(
            || views.iter().enumerate().map(see).collect::<Result<Vec<_>>>(),
            || nodes(image, LEAST_NODE_SCORE, &tasks.silent()).map(distinct),
        );
        let (seen, regions) = (seen?, regions?);
        let tasks = SideBySide::new(progress, "finding masks: coarse grid");
        let searches: Vec<(usize, _)> = views.iter().zip(&seen).enumerate().collect();
        let found = map(&searches, |&(index, (view, seen))| {
            let silent = tasks.silent();
            // The search of the largest view takes the longest, and reports.
            let progress: &dyn Progress = if index == 0 { &tasks } else { &silent };
            view.search(seen, size, &self.search, progress, &mut Cost::default())
        });
        let mut offers = Vec::new();
        for (index, found) in found.into_iter().enumerate() {
            for FoundMask { mask, predicted_iou, stability, votes, .. } in found? {
                let origin = SearchMeasures { predicted_iou, stability, votes, ..SearchMeasures::default() };
                offers.extend(Measured::new(mask).map(|mask| Unmeasured { mask, size: Some(index), origin }));
            }
        }
        advance(progress, "judging masks", 0, 0)?;
        for (mask, region) in regions {
            offers.push(Unmeasured {
                mask,
                size: None,
                origin: SearchMeasures { region, ..SearchMeasures::default() },
            });
        }
        let mut embeddings = views.iter().zip(seen).map(|(view, seen)| (seen.embedding, view.scale));
        let (Some(fine), Some(coarse)) = (embeddings.next(), embeddings.next()) else {
            return Ok(Vec::new());
        };
        drop(embeddings);
        let indexed = || {
            let mut index = SimilarMasks::default();
            offers.iter().enumerate().for_each(|(k, offer)| index.add(&offer.mask, k));
            index
        };
        let (index, context) = join(indexed, || MaskFeatureContext::new(image, [fine, coarse]));
        let features = map(&offers, |offer| {
            let mut origin = offer.origin;
            let mut near = index.near(&offer.mask, 0.0);
            // Candidates with the highest bounds first, so that most others need no comparison.
            near.sort_by(|a, b| b.most.total_cmp(&a.most));
            for SimilarMask { index, most } in near {
                let other = &offers[index];
                let both = offer.size.is_some() && other.size.is_some();
                let region = other.origin.region;
                let known = most <= origin.cross && most * region <= origin.region;
                if offer.size == other.size || if both { most <= origin.agreement } else { known } {
                    continue;
                }
                let iou = offer.mask.iou(&other.mask);
                if both {
                    origin.agreement = origin.agreement.max(iou);
                } else {
                    origin.cross = origin.cross.max(iou);
                    origin.region = origin.region.max(iou * region);
                }
            }
            context.features(&offer.mask.mask, &origin)
        });
        let masks = offers.into_iter().map(|offer| offer.mask.mask);
        Ok(masks.zip(features).map(|(mask, features)| MaskCandidate { mask, features }).collect())
    }
}

/// A candidate before it is measured.
struct Unmeasured {
    mask: Measured,
    /// Index of the scale at which the network gave it; `None` for a node of the region tree.
    size: Option<usize>,
    origin: SearchMeasures,
}

/// Final score of a candidate, 0 to 1: the [`Judge`]'s, combined with those of its sources.
fn score(judged: f32, features: &[f32; FEATURES]) -> f32 {
    let own = features[PREDICTED] * features[STABILITY].max(0.0).sqrt();
    let score = if own > 0.0 { judged + (own - judged) * OWN_WEIGHT } else { judged };
    score.max(REGION_SHARE * features[REGION])
}

/// Nodes without near duplicates; the better one stays.
fn distinct(mut nodes: Vec<ScoredMask>) -> Vec<(Measured, f32)> {
    nodes.sort_by(|a, b| b.score.total_cmp(&a.score));
    let (mut kept, mut index): (Vec<(Measured, f32)>, _) = (Vec::new(), SimilarMasks::default());
    for node in nodes {
        let Some(mask) = Measured::new(node.mask) else { continue };
        let same = |near: SimilarMask| kept[near.index].0.iou(&mask) >= SAME_IOU;
        if !index.near(&mask, SAME_IOU).into_iter().any(same) {
            index.add(&mask, kept.len());
            kept.push((mask, node.score));
        }
    }
    kept
}

impl Segmenter for Texton {
    fn name(&self) -> String {
        "texton".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        let masks = tiles::segment(image, &|image| {
            let candidates = self.candidates(image, progress)?;
            let judged = |c: &MaskCandidate| score(weights::NETWORK.score(&c.features), &c.features);
            let scores = map(&candidates, judged);
            let scored = candidates.into_iter().zip(scores);
            let offers: Vec<ScoredMask> =
                scored.map(|(c, score)| ScoredMask { mask: c.mask, score }).collect();
            Ok(disjoint(&offers, image.width(), image.height()))
        })?;
        Ok(whole_cells(masks, image))
    }
}

#[cfg(test)]
mod tests;
