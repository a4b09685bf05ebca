//! Selection of textons among the nodes: a small network scores each, and dynamic programming finds
//! the disjoint set with the largest total worth.

use super::features::FEATURES;
use super::merge_tree::Tree;
use crate::segment::Perceptron;

/// Units of the hidden layer.
pub const HIDDEN: usize = 32;

/// The network that scores nodes: a perceptron whose output is the expected fit of a node to a texton,
/// 0 to 1.
pub type Network = Perceptron<FEATURES, HIDDEN>;

/// Score below which a node is background: for areas up to `SIZES[0]` pixels, and from `SIZES[1]`
/// pixels. Large textons are few and prominent, so their threshold is lower.
const LEAST: [f32; 2] = [0.32, 0.18];
const SIZES: [f32; 2] = [50.0, 1000.0];

/// Worth of a node of the given area (pixels) and score; negative for background.
pub(in crate::segment) fn worth(area: f32, score: f32) -> f32 {
    let place = libm::logf(area / SIZES[0]) / libm::logf(SIZES[1] / SIZES[0]);
    let least = LEAST[0] + (LEAST[1] - LEAST[0]) * place.clamp(0.0, 1.0);
    (score - least) * area.sqrt()
}

/// The disjoint nodes with the largest total worth, in the order of the tree. Nodes whose score is
/// `None` are never selected.
pub(super) fn best_cut(tree: &Tree, scores: &[Option<f32>]) -> Vec<usize> {
    let mut best = vec![0.0f32; tree.nodes.len()];
    let mut take = vec![false; tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate() {
        let below = node.children.map_or(0.0, |c| c.iter().map(|&c| best[c as usize]).sum());
        let own = scores[i].map_or(0.0, |s| worth(node.area, s));
        take[i] = own > 0.0 && own >= below;
        best[i] = below.max(own);
    }
    let mut covered = vec![false; tree.nodes.len()];
    let mut taken = Vec::new();
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        covered[i] = node.parent.is_some_and(|p| covered[p as usize] || take[p as usize]);
        if take[i] && !covered[i] {
            taken.push(i);
        }
    }
    taken.reverse();
    taken
}

#[cfg(test)]
mod tests {
    use super::super::merge_tree::RegionNode;
    use super::*;

    /// Basins 0, 1, 2 of 100 px each; 3 = 0 + 1, 4 = 3 + 2.
    fn tree() -> Tree {
        let node = |area: f32, children, parent| RegionNode { area, children, parent };
        Tree {
            nodes: vec![
                node(100.0, None, Some(3)),
                node(100.0, None, Some(3)),
                node(100.0, None, Some(4)),
                node(200.0, Some([0, 1]), Some(4)),
                node(300.0, Some([3, 2]), None),
            ],
        }
    }

    #[test]
    fn the_set_worth_most_is_taken() {
        let cut = |scores: [f32; 5]| best_cut(&tree(), &scores.map(Some));
        assert_eq!(cut([0.9, 0.9, 0.1, 0.5, 0.1]), [0, 1]);
        assert_eq!(cut([0.5, 0.5, 0.5, 0.9, 0.4]), [2, 3]);
        assert_eq!(cut([0.5, 0.1, 0.1, 0.4, 0.9]), [4]);
        assert!(cut([0.1; 5]).is_empty());
        assert_eq!(best_cut(&tree(), &[None, None, Some(0.4), None, None]), [2]);
    }
}
