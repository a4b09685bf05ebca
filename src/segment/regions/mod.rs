//! The built-in segmenter: a tree of merged regions, and the nodes of it that look like textons.
//!
//! Basins of the colour gradient are merged by how much they differ and by the strength of the
//! border between them. Each node of the tree is measured (size, form, contrast to what surrounds
//! it, strength and consistency of its rim, homogeneity up to shading, lifetime in the tree), a
//! small network fitted to procedural scenes scores it, and the disjoint set worth most is taken.
//! What is in no node taken is ground. One setting serves all images.
//!
//! Works badly where elements have no border of their own: grass, fur, crumpled leaves on leaves.

mod features;
mod merge_tree;
mod oversegmentation;
mod select;
mod weights;

pub use features::FEATURES;
pub use select::{HIDDEN, Network};

use super::{ScoredMask, Segmenter};
use crate::error::Result;
use crate::progress::{Progress, advance};
use crate::raster::{LabelMap, Mask};
use features::Context;
use image::RgbImage;
use merge_tree::Tree;
use oversegmentation::Field;

/// Smallest mask, in pixels. What is smaller has no form to judge.
const SMALLEST: f32 = 16.0;
/// Largest mask, as a share of the image.
const LARGEST: f32 = 0.2;
/// Score below which a node is ground.
const LEAST_SCORE: f32 = 0.3;
/// A node is worth its area to this power times its score above the least.
const AREA_POWER: f32 = 0.5;

/// The hierarchical segmenter. Its masks are disjoint and 4-connected.
#[derive(Clone, Copy, Debug, Default)]
pub struct Regions;

/// A node that might be a texton: for fitting [`Network`].
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Its pixels.
    pub mask: Mask,
    /// What the network is told of it.
    pub features: [f32; FEATURES],
}

struct Analysis {
    labels: Vec<u32>,
    tree: Tree,
    context: Context,
}

impl Analysis {
    fn new(image: &RgbImage, progress: &dyn Progress) -> Result<Self> {
        advance(progress, "merging regions", 0, 0)?;
        let field = Field::new(image);
        let (labels, count) = field.basins();
        let context = Context::new(&field);
        let tree = Tree::new(&field, &labels, count, progress)?;
        Ok(Self { labels, tree, context })
    }

    /// Whether a node may be a texton at all: what touches opposite borders is ground.
    fn eligible(&self, image: &RgbImage, i: usize) -> bool {
        let sums = &self.tree.nodes[i].sums;
        let [left, top, right, bottom] = sums.border;
        let all = image.width() as f32 * image.height() as f32;
        let spans = left > 0 && right > 0 || top > 0 && bottom > 0;
        sums.area >= SMALLEST && sums.area <= LARGEST * all && !spans
    }

    /// The masks of some disjoint nodes.
    fn masks(&self, image: &RgbImage, chosen: &[usize]) -> Vec<Mask> {
        let nodes = &self.tree.nodes;
        let mut number = vec![0u32; nodes.len()];
        for (k, &i) in chosen.iter().enumerate() {
            number[i] = k as u32 + 1;
        }
        for i in (0..nodes.len()).rev() {
            if let Some(p) = nodes[i].parent.filter(|_| number[i] == 0) {
                number[i] = number[p as usize];
            }
        }
        let labels = self.labels.iter().map(|&l| number[l as usize]).collect();
        let map = LabelMap { width: image.width(), height: image.height(), labels };
        Mask::all_of_labels(&map, chosen.len() + 1).into_iter().skip(1).collect()
    }
}

/// All nodes of the tree that may be textons, largest last; they contain one another.
///
/// # Errors
/// [`crate::Error::Interrupted`].
pub fn candidates(image: &RgbImage, progress: &dyn Progress) -> Result<Vec<Candidate>> {
    let analysis = Analysis::new(image, progress)?;
    let nodes = &analysis.tree.nodes;
    let basins = nodes.iter().filter(|n| n.children.is_none()).count();
    let map = LabelMap { width: image.width(), height: image.height(), labels: analysis.labels.clone() };
    let mut masks = Mask::all_of_labels(&map, basins);
    let mut found = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        if let Some(children) = node.children {
            let spans = children.iter().flat_map(|&c| masks[c as usize].spans());
            masks.push(Mask::from_spans(spans.copied().collect()));
        }
        if analysis.eligible(image, i) {
            let features = analysis.context.features(&analysis.tree, i);
            found.push(Candidate { mask: masks[i].clone(), features });
        }
    }
    Ok(found)
}

impl Segmenter for Regions {
    fn name(&self) -> String {
        "regions".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        if image.width() == 0 || image.height() == 0 {
            return Ok(Vec::new());
        }
        let analysis = Analysis::new(image, progress)?;
        let tree = &analysis.tree;
        let scores: Vec<Option<f32>> = (0..tree.nodes.len())
            .map(|i| {
                let eligible = analysis.eligible(image, i);
                eligible.then(|| weights::NETWORK.score(&analysis.context.features(tree, i)))
            })
            .collect();
        let chosen = select::best_cut(tree, &scores, LEAST_SCORE, AREA_POWER);
        let masks = analysis.masks(image, &chosen);
        let scored = masks.into_iter().zip(&chosen);
        Ok(scored.map(|(mask, &i)| ScoredMask { mask, score: scores[i].unwrap_or(0.0) }).collect())
    }
}
