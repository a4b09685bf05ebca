//! The built-in segmenter: a tree of merged regions, whose texton-like nodes are selected.
//!
//! Basins of the colour gradient (shallow ones are joined to others first) are merged in the order of their
//! difference and of the strength of the border between them. Each node of the tree is measured: size, shape,
//! contrast to its surroundings, strength and consistency of its rim, homogeneity up to shading, lifetime in
//! the tree. A small network fitted to procedural scenes scores it, and the disjoint set of nodes with the
//! largest total worth is selected. The rest is background. There are no parameters.
//!
//! Works badly for elements without borders of their own: grass, fur, crumpled leaves on leaves.

mod features;
mod merge_tree;
mod oversegmentation;
mod select;
mod weights;

pub use features::FEATURES;
pub(super) use select::worth;
pub use select::{HIDDEN, Network};

use super::{ScoredMask, Segmenter, courses::whole_cells, disjoint::by_worth, tiles};
use features::NodeFeatureContext;
use image::RgbImage;
use merge_tree::{MergedRegion, PixelSums, Tree, Union};
use oversegmentation::{GradientImage, ScaledOklabImage};
use vtex_base::error::Result;
use vtex_base::parallel::map;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::{Connectivity, LabelMap, Mask, components};

/// Area of the smallest mask, in pixels. Smaller ones have no shape to judge.
const SMALLEST: f32 = 16.0;
/// Area of the largest mask, as a share of the image.
const LARGEST: f32 = 0.2;

/// For each tree, its smoothing (pixels) and the share of the border in a merge's weight.
const LAYERS: [(f64, f32); 3] = [(0.5, 0.9), (1.0, 0.5), (2.0, 0.7)];
/// Largest share of its pixels that a mask may lose to masks of higher worth.
const MOST_LOST: f32 = 0.1;
/// Number of searches; each covers the pixels that the previous ones left.
const ROUNDS: usize = 3;

/// The built-in segmenter by region merging. It needs no neural network file. Its masks are disjoint
/// and 4-connected.
#[derive(Clone, Copy, Debug, Default)]
pub struct Regions;

/// A node that may be a texton, as training data for [`Network`].
#[derive(Clone, Debug, PartialEq)]
pub struct NodeCandidate {
    /// Its pixels.
    pub mask: Mask,
    /// The network's input.
    pub features: [f32; FEATURES],
}

/// A tree over the whole image, with a value for each node that may be a texton.
struct ScoredTree<T> {
    labels: Vec<u32>,
    tree: Tree,
    nodes: Vec<Option<T>>,
}

/// The score of a node's features.
fn score(features: [f32; FEATURES]) -> f32 {
    weights::NETWORK.score(&features)
}

/// Builds one tree for each smoothing and share of the border, and maps it with `then`; trees are dropped
/// afterwards. `f` maps the features of a node to its value.
fn layers<T: Send, R: Send>(
    image: &RgbImage,
    layers: &[(f64, f32)],
    progress: &dyn Progress,
    f: fn([f32; FEATURES]) -> T,
    then: impl Fn(ScoredTree<T>) -> R + Sync + Send,
) -> Result<Vec<R>> {
    let colours = ScaledOklabImage::new(image);
    let made = map(layers, |&(sigma, share)| ScoredTree::new(&colours, sigma, share, progress, f).map(&then));
    made.into_iter().collect()
}

/// Whether a region may be a texton. Those that touch opposite borders are background.
fn eligible(field: &GradientImage, sums: &PixelSums) -> bool {
    let [left, top, right, bottom] = sums.border;
    let all = field.width as f32 * field.height as f32;
    let spans = left > 0 && right > 0 || top > 0 && bottom > 0;
    sums.area >= SMALLEST && sums.area <= LARGEST * all && !spans
}

impl<T> ScoredTree<T> {
    fn new(
        image: &ScaledOklabImage,
        sigma: f64,
        share: f32,
        progress: &dyn Progress,
        f: fn([f32; FEATURES]) -> T,
    ) -> Result<Self> {
        advance(progress, "merging regions", 0, 0)?;
        let field = GradientImage::new(image, sigma);
        let (labels, counts) = field.deep_basins();
        let context = NodeFeatureContext::new(&field);
        let mut nodes: Vec<Option<T>> = Vec::new();
        nodes.resize_with(2 * counts.len() - 1, || None);
        let mut see = |node: usize, region: &MergedRegion, union: Option<Union>| {
            nodes[node] = eligible(&field, &region.sums).then(|| f(context.features(region, union)));
        };
        let tree = Tree::new(&field, &labels, &counts, share, progress, &mut see)?;
        Ok(Self { labels, tree, nodes })
    }

    /// The masks of disjoint nodes.
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

    /// The masks of the tree's leaves, in the order of the nodes.
    fn basins(&self, image: &RgbImage) -> Vec<Mask> {
        let count = self.tree.nodes.iter().filter(|n| n.children.is_none()).count();
        let map = LabelMap { width: image.width(), height: image.height(), labels: self.labels.clone() };
        Mask::all_of_labels(&map, count)
    }

    /// The mask of a node, composed of its leaves'.
    fn mask(&self, basins: &[Mask], node: usize) -> Mask {
        let (mut spans, mut open) = (Vec::new(), vec![node]);
        while let Some(k) = open.pop() {
            match self.tree.nodes[k].children {
                Some(children) => open.extend(children.map(|c| c as usize)),
                None => spans.extend_from_slice(basins[k].spans()),
            }
        }
        Mask::from_spans(spans)
    }

    /// The nodes that may be textons.
    fn eligible(&self) -> impl Iterator<Item = (usize, &T)> {
        self.nodes.iter().enumerate().filter_map(|(i, node)| Some((i, node.as_ref()?)))
    }
}

impl ScoredTree<f32> {
    /// Removes the scores of nodes that lost too many pixels to selected masks.
    fn block(&mut self, taken: &LabelMap) {
        let mut lost = vec![0u32; self.nodes.len()];
        for (&label, &t) in self.labels.iter().zip(&taken.labels) {
            lost[label as usize] += u32::from(t != 0);
        }
        for (i, node) in self.tree.nodes.iter().enumerate() {
            if let Some([a, b]) = node.children {
                lost[i] = lost[a as usize] + lost[b as usize];
            }
            if lost[i] as f32 > MOST_LOST * node.area {
                self.nodes[i] = None;
            }
        }
    }

    /// The nodes that score at least `least`.
    #[cfg(feature = "onnx")]
    fn best(&self, image: &RgbImage, least: f32) -> Vec<ScoredMask> {
        let basins = self.basins(image);
        let good = self.eligible().filter(|(_, score)| **score >= least);
        good.map(|(i, &score)| ScoredMask { mask: self.mask(&basins, i), score }).collect()
    }
}

impl ScoredTree<[f32; FEATURES]> {
    fn candidates(&self, image: &RgbImage) -> Vec<NodeCandidate> {
        let basins = self.basins(image);
        let candidate = |(i, &features)| NodeCandidate { mask: self.mask(&basins, i), features };
        self.eligible().map(candidate).collect()
    }
}

/// Nodes of all trees that score at least `least` (0 to 1), with their scores. They may contain one
/// another.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
#[cfg(feature = "onnx")]
pub(super) fn nodes(image: &RgbImage, least: f32, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
    if image.width() == 0 || image.height() == 0 {
        return Ok(Vec::new());
    }
    Ok(layers(image, &LAYERS, progress, score, |layer| layer.best(image, least))?.concat())
}

/// All nodes of the trees that may be textons. They may contain one another.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub fn candidates(image: &RgbImage, progress: &dyn Progress) -> Result<Vec<NodeCandidate>> {
    Ok(layers(image, &LAYERS, progress, |features| features, |layer| layer.candidates(image))?.concat())
}

impl Segmenter for Regions {
    fn name(&self) -> String {
        "regions".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        let masks = tiles::segment(image, &|image| search(image, &LAYERS, progress))?;
        Ok(whole_cells(masks, image))
    }
}

/// The built-in segmenter with the middle one of its trees only: it finds fewer elements in half the time. It
/// is used by `vectorize`, whose pictures are drawn but not edited.
#[derive(Clone, Copy, Debug, Default)]
pub struct OneTree;

impl Segmenter for OneTree {
    fn name(&self) -> String {
        "one-tree".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        tiles::segment(image, &|image| search(image, &LAYERS[1..2], progress))
    }

    fn seeks_elements(&self) -> bool {
        false
    }
}

/// The disjoint nodes of the trees with the largest total worth.
fn search(image: &RgbImage, trees: &[(f64, f32)], progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
    if image.width() == 0 || image.height() == 0 {
        return Ok(Vec::new());
    }
    let mut layers = layers(image, trees, progress, score, |layer| layer)?;
    let mut taken = LabelMap::filled(image.width(), image.height(), 0);
    let mut taken_scores = vec![0.0];
    for _ in 0..ROUNDS {
        let mut offers = Vec::new();
        for layer in &mut layers {
            layer.block(&taken);
            let chosen = select::best_cut(&layer.tree, &layer.nodes);
            let masks = layer.masks(image, &chosen);
            let scores = chosen.iter().map(|&i| layer.nodes[i].unwrap_or(0.0));
            offers.extend(masks.into_iter().zip(scores).map(|(mask, score)| ScoredMask { mask, score }));
        }
        for k in by_worth(&offers) {
            let ScoredMask { mask, score } = &offers[k];
            let free = |&(x, y): &(i32, i32)| taken.get(x as u32, y as u32) == 0;
            let left = mask.pixels().filter(free).count() as f32;
            if left >= (1.0 - MOST_LOST) * mask.area() as f32 {
                let label = taken_scores.len() as u32;
                taken_scores.push(*score);
                for (x, y) in mask.pixels() {
                    if taken.get(x as u32, y as u32) == 0 {
                        taken.set(x as u32, y as u32, label);
                    }
                }
            }
        }
    }
    // Fragments cut off by masks of higher worth are dropped.
    let (pieces, owners) = components(&taken, Connectivity::Four);
    let masks = Mask::all_of_labels(&pieces, owners.len());
    let mut best: Vec<Option<Mask>> = vec![None; taken_scores.len()];
    for (mask, &owner) in masks.into_iter().zip(&owners).skip(1) {
        let held = &mut best[owner as usize];
        if held.as_ref().is_none_or(|h| h.area() < mask.area()) {
            *held = Some(mask);
        }
    }
    let scored = best.into_iter().zip(taken_scores);
    Ok(scored.filter_map(|(mask, score)| Some(ScoredMask { mask: mask?, score })).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vtex_base::raster::components_of_mask;
    use vtex_testing::{SceneKind, SceneParams, generate};

    fn sound(masks: &[ScoredMask], width: u32, height: u32) -> Result<(), TestCaseError> {
        let mut seen = LabelMap::filled(width, height, 0);
        for scored in masks {
            prop_assert!((0.0..=1.0).contains(&scored.score));
            prop_assert_eq!(components_of_mask(&scored.mask, Connectivity::Four).len(), 1);
            for (x, y) in scored.mask.pixels() {
                prop_assert_eq!(seen.at(i64::from(x), i64::from(y)), Some(0));
                seen.set(x as u32, y as u32, 1);
            }
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn masks_are_disjoint_and_connected(
            (width, height) in (1..40u32, 1..40u32),
            values in prop::collection::vec(any::<[u8; 3]>(), 1..64),
            block in 1..9u32,
        ) {
            let image = RgbImage::from_fn(width, height, |x, y| {
                image::Rgb(values[(x / block + y / block * 7) as usize % values.len()])
            });
            sound(&Regions.segment(&image, &()).unwrap(), width, height)?;
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        for (w, h) in [(0, 0), (1, 1), (1, 50), (64, 48)] {
            let image = RgbImage::from_pixel(w, h, image::Rgb([120, 90, 30]));
            assert_eq!(Regions.segment(&image, &()).unwrap(), [], "{w} x {h}");
        }
    }

    #[test]
    fn discs_are_found_whole() {
        // Discs of four sizes under a gradient of light, with a little noise.
        let discs = [(40.0, 40.0, 22.0), (110.0, 50.0, 12.0), (60.0, 110.0, 16.0), (120.0, 115.0, 8.0)];
        let inside = |x: u32, y: u32, (cx, cy, r): (f64, f64, f64)| {
            let (dx, dy) = (f64::from(x) + 0.5 - cx, f64::from(y) + 0.5 - cy);
            dx * dx + dy * dy < r * r
        };
        let image = RgbImage::from_fn(150, 150, |x, y| {
            let light = 0.9 + f64::from(x) / 1000.0 + f64::from((x * 7919 + y * 104_729) % 17) / 400.0;
            let disc = discs.iter().any(|&d| inside(x, y, d));
            let colour: [f64; 3] = if disc { [120.0, 60.0, 50.0] } else { [190.0, 180.0, 160.0] };
            image::Rgb(colour.map(|c| (c * light) as u8))
        });
        let found = [&Regions as &dyn Segmenter, &OneTree].map(|s| s.segment(&image, &()).unwrap());
        for (disc, masks) in discs.into_iter().flat_map(|disc| found.iter().map(move |masks| (disc, masks))) {
            let best = masks.iter().map(|m| {
                let both = m.mask.pixels().filter(|&(x, y)| inside(x as u32, y as u32, disc)).count() as f64;
                both / (std::f64::consts::PI * disc.2 * disc.2 + f64::from(m.mask.area()) - both)
            });
            let best = best.fold(0.0, f64::max);
            assert!(best > 0.9, "{disc:?}: {best}");
        }
    }

    #[test]
    fn most_chips_of_a_terrazzo_are_found() {
        let parameters = SceneParams {
            width: 200,
            height: 200,
            seed: 77,
            kind: SceneKind::Terrazzo,
            ..SceneParams::default()
        };
        let scene = generate(&parameters).unwrap();
        let masks = Regions.segment(&scene.image, &()).unwrap();
        let areas = scene.instances.areas();
        let truth = Mask::all_of_labels(&scene.instances, areas.len());
        let large: Vec<&Mask> = truth.iter().skip(1).filter(|m| m.area() >= 100).collect();
        let found = large.iter().filter(|t| {
            masks.iter().any(|m| {
                let both = t.overlap(&m.mask);
                f64::from(both) >= 0.7 * f64::from(t.area() + m.mask.area() - both)
            })
        });
        let (found, all) = (found.count(), large.len());
        assert!(all > 10 && 10 * found >= 6 * all, "{found} of {all}");
    }

    #[test]
    fn work_can_be_interrupted() {
        let answer = Regions.segment(&RgbImage::new(20, 20), &vtex_testing::StopAtOnce);
        assert!(matches!(answer, Err(vtex_base::Error::Interrupted)));
    }
}
