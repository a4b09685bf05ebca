//! The tree of gaps: elements joined pair by pair, the nearest first (single linkage).

use super::features::MotifElement;
use super::gaps::ElementGap;
use crate::import::offsets::{Shift, minus, plus};
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::geometry::{Rect, Vec2};

/// Most parts of a set.
const MOST_PARTS: usize = 32;

/// The plane that elements lie on.
#[derive(Clone, Copy)]
pub(super) struct MotifPlane {
    /// Width and height of the period, if the page repeats.
    pub(super) periods: Option<[f64; 2]>,
    /// Largest sides of a motif.
    pub(super) largest: [f64; 2],
    /// Largest gap that is known.
    pub(super) reach: f64,
}

impl MotifPlane {
    /// The vector of a number of periods.
    pub(super) fn vector(&self, shift: Shift) -> Vec2 {
        let [w, h] = self.periods.unwrap_or_default();
        Vec2::new(f64::from(shift[0]) * w, f64::from(shift[1]) * h)
    }
}

/// A set of elements that are nearer to each other than to all others.
pub(super) struct GapNode {
    /// Largest gap that joins them, in pixels.
    pub(super) inner: f64,
    /// Least gap to another element, in pixels; at most the reach of the search.
    pub(super) outer: f64,
    /// The sets joined, as indices of nodes; a single element has none.
    pub(super) children: Option<[usize; 2]>,
    /// Its elements with their shifts in a common frame. Empty for a set that can be no motif: too many, too
    /// large, or joined to its own copy.
    pub(super) members: Vec<(usize, Shift)>,
    bounds: Rect,
    /// Whether it was found to be joined to its own copy.
    is_endless: bool,
}

impl GapNode {
    fn shift_of(&self, element: usize) -> Option<Shift> {
        self.members.iter().find(|m| m.0 == element).map(|m| m.1)
    }
}

/// The nodes, children before parents; the first are the elements.
pub(super) fn tree(elements: &[MotifElement], gaps: &[ElementGap], plane: MotifPlane) -> Vec<GapNode> {
    let leaf = |(k, element): (usize, &MotifElement)| GapNode {
        inner: 0.0,
        outer: plane.reach,
        children: None,
        members: vec![(k, [0; 2])],
        bounds: element.bounds,
        is_endless: false,
    };
    let mut nodes: Vec<GapNode> = elements.iter().enumerate().map(leaf).collect();
    let mut sets = DisjointSets::new(elements.len());
    // The node of each set, by its root.
    let mut top: Vec<usize> = (0..elements.len()).collect();
    for gap in gaps {
        let (first, second) = (sets.root(gap.a), sets.root(gap.b));
        let [a, b] = [top[first], top[second]];
        for k in [a, b] {
            let joins_copy =
                a == b && nodes[k].shift_of(gap.a).map(|s| plus(s, gap.shift)) != nodes[k].shift_of(gap.b);
            if a != b || joins_copy {
                nodes[k].outer = nodes[k].outer.min(gap.distance);
                nodes[k].is_endless |= joins_copy;
            }
        }
        if a == b {
            continue;
        }
        let node = joined(&nodes, [a, b], gap, plane);
        nodes.push(node);
        sets.join(first, second);
        let root = sets.root(first);
        top[root] = nodes.len() - 1;
    }
    nodes
}

/// Two sets as one.
fn joined(nodes: &[GapNode], [a, b]: [usize; 2], gap: &ElementGap, plane: MotifPlane) -> GapNode {
    let (first, second) = (&nodes[a], &nodes[b]);
    let mut node = GapNode {
        inner: gap.distance,
        outer: plane.reach,
        children: Some([a, b]),
        members: Vec::new(),
        bounds: first.bounds,
        is_endless: first.is_endless || second.is_endless,
    };
    let (Some(own), Some(other)) = (first.shift_of(gap.a), second.shift_of(gap.b)) else { return node };
    if node.is_endless || first.members.len() + second.members.len() > MOST_PARTS {
        return node;
    }
    let between = plus(plus(own, gap.shift), minus(other));
    node.bounds = first.bounds.union(second.bounds + plane.vector(between));
    if node.bounds.width() <= plane.largest[0] && node.bounds.height() <= plane.largest[1] {
        let moved = second.members.iter().map(|&(k, shift)| (k, plus(shift, between)));
        node.members = first.members.iter().copied().chain(moved).collect();
    }
    node
}
