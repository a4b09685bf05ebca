//! Sets of elements that are copies of each other, and the evidence that they are motifs.
//!
//! A set stands out by the ratio of its outer to its inner gap. How large that ratio must be depends on how
//! often the set recurs, on how much of what is like its parts is in its copies, and on whether its parts are
//! parallel, mirrored or in a ring.

use super::features::MotifElement;
use super::layout::MotifLayout;
use super::tree::{GapNode, MotifPlane};
use std::collections::{BTreeMap, BTreeSet};
use vtex_base::error::Result;

/// Share of the extent by which parts of copies may differ in place.
pub(super) const TOLERANCE: f64 = 0.16;
/// Least ratio of the gaps of a set that is looked at.
const LEAST_RATIO: f64 = 1.12;
/// Ratios that sets need which occur once, twice, and three times or more: of two parts, and of more; in no
/// order, and in order.
const NEEDED: [[[f64; 2]; 2]; 3] =
    [[[3.2, 2.4], [2.4, 1.8]], [[2.6, 2.1], [2.0, 1.5]], [[1.5, 1.5], [1.25, 1.25]]];
/// Share of the elements like its parts that is in copies of a kind, below which more is needed: some are near
/// each other by chance. For kinds that occur once or twice, and more often.
const SHARE: [f64; 2] = [0.8, 0.5];
/// Increase of the needed ratio for each unit of share that is missing.
const RARITY: f64 = 1.2;
/// Largest inner gap of a kind that occurs once or twice, in usual gaps between units.
const ORDINARY: f64 = 0.5;
/// Most kinds of one composition that a set is compared with.
const MOST_KINDS: usize = 48;

/// Sets that are copies of each other.
pub(super) struct MotifKind {
    /// The layout of the first.
    pub(super) template: MotifLayout,
    /// Indices of its nodes.
    nodes: Vec<usize>,
    /// Largest distance of a part of a copy from its place in the template, in pixels.
    pub(super) residual: f64,
    /// Value of one element in it; `None` if it is no motif.
    value: Option<f64>,
    /// Largest inner gap of its copies, in pixels.
    pub(super) inner: f64,
}

/// The chosen motifs: number of the kind, and the parts in the order of its template.
pub(super) struct ChosenMotifs {
    pub(super) kinds: Vec<MotifKind>,
    pub(super) motifs: Vec<(usize, MotifLayout)>,
}

/// Chooses the nodes of a tree that are motifs, each element in one at most. `finest` is the gap, in pixels,
/// below which differences do not count.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn choose(
    nodes: &[GapNode],
    elements: &[MotifElement],
    plane: MotifPlane,
    finest: f64,
    contact_only: bool,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<ChosenMotifs> {
    let ratio = |node: &GapNode| (node.outer + finest) / (node.inner + finest);
    let mut by_composition: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let mut kinds: Vec<MotifKind> = Vec::new();
    let mut of_node: Vec<Option<(usize, MotifLayout)>> = Vec::with_capacity(nodes.len());
    for (n, node) in nodes.iter().enumerate() {
        go_on()?;
        let touching = node.inner < CONTACT;
        if node.members.len() < 2 || ratio(node) < LEAST_RATIO || contact_only && !touching {
            of_node.push(None);
            continue;
        }
        let mut layout = MotifLayout::new(&node.members, elements, plane);
        let known = by_composition.entry(layout.composition()).or_default();
        let found = known.iter().take(MOST_KINDS).find_map(|&k| {
            let template = &kinds[k].template;
            let tolerance = TOLERANCE * template.extent.min(layout.extent);
            layout.as_copy_of(template, tolerance).map(|found| (k, found))
        });
        let kind = match found {
            Some((k, found)) => {
                layout.parts = found.order.iter().map(|&k| layout.parts[k]).collect();
                kinds[k].residual = kinds[k].residual.max(found.residual);
                kinds[k].inner = kinds[k].inner.max(node.inner);
                kinds[k].nodes.push(n);
                k
            }
            None => {
                known.push(kinds.len());
                let template = layout.clone();
                kinds.push(MotifKind {
                    template,
                    nodes: vec![n],
                    residual: 0.0,
                    value: None,
                    inner: node.inner,
                });
                kinds.len() - 1
            }
        };
        of_node.push(Some((kind, layout)));
    }
    let mut like: BTreeMap<usize, usize> = BTreeMap::new();
    elements.iter().for_each(|e| *like.entry(e.label).or_default() += 1);
    for kind in &mut kinds {
        go_on()?;
        let mut ratios: Vec<f64> = kind.nodes.iter().map(|&n| ratio(&nodes[n])).collect();
        ratios.sort_by(f64::total_cmp);
        kind.value = kind.worth(ratios[ratios.len() / 2], &like);
    }
    let kind_of: Vec<Option<usize>> = of_node.iter().map(|own| own.as_ref().map(|(kind, _)| *kind)).collect();
    let mut chosen = best(nodes, &kinds, &kind_of);
    go_on()?;
    if drop_ordinary(nodes, &mut kinds, &kind_of, &chosen, elements) {
        chosen = best(nodes, &kinds, &kind_of);
    }
    Ok(ChosenMotifs { motifs: chosen.iter().filter_map(|&n| of_node[n].take()).collect(), kinds })
}

/// Gap below which elements touch, in pixels.
const CONTACT: f64 = 0.75;

impl MotifKind {
    /// The value of one element of the kind, given the median ratio of its gaps and the number of elements of
    /// each label; `None` if it does not stand out enough.
    fn worth(&self, ratio: f64, like: &BTreeMap<usize, usize>) -> Option<f64> {
        let parts = &self.template.parts;
        let orderly = usize::from(self.template.is_orderly());
        let labels: BTreeSet<usize> = parts.iter().map(|p| p.label).collect();
        // Largest share of the elements of a label that are in copies of this kind.
        let share = |label: &usize| {
            let own = parts.iter().filter(|p| p.label == *label).count() * self.nodes.len();
            own as f64 / like.get(label).copied().unwrap_or(1).max(1) as f64
        };
        let share = labels.iter().map(share).fold(0.0, f64::max).min(1.0);
        let often = self.nodes.len().min(3) - 1;
        let least = NEEDED[often][usize::from(parts.len() > 2)][orderly];
        let lacking = (SHARE[usize::from(often == 2)] - share).max(0.0);
        let needed = least * (1.0 + RARITY * lacking);
        (ratio >= needed).then(|| 0.5 + libm::log(ratio / needed))
    }
}

/// The nodes of greatest total value of which none holds another, given the kind of each node.
fn best(nodes: &[GapNode], kinds: &[MotifKind], kind_of: &[Option<usize>]) -> Vec<usize> {
    let mut values: Vec<f64> = Vec::with_capacity(nodes.len());
    let mut is_chosen = vec![false; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        let below = node.children.map_or(0.0, |c| c.iter().map(|&k| values[k]).sum());
        let own = kind_of[n].and_then(|k| kinds[k].value);
        let here = own.map_or(0.0, |value| value * node.members.len() as f64);
        is_chosen[n] = here > below;
        values.push(here.max(below));
    }
    let mut covered = vec![false; nodes.len()];
    let mut found = Vec::new();
    for n in (0..nodes.len()).rev() {
        if let Some(children) = nodes[n].children {
            children.iter().for_each(|&k| covered[k] = covered[n] || is_chosen[n]);
        }
        if is_chosen[n] && !covered[n] {
            found.push(n);
        }
    }
    found.reverse();
    found
}

/// Takes away the value of chosen kinds that occur once or twice and whose inner gaps are ordinary: not much
/// smaller than the usual gap between units, if the parts of the kind were units themselves. Says whether there
/// are any. What has order and three parts or more stays.
fn drop_ordinary(
    nodes: &[GapNode],
    kinds: &mut [MotifKind],
    kind_of: &[Option<usize>],
    chosen: &[usize],
    elements: &[MotifElement],
) -> bool {
    let mut is_part = vec![false; elements.len()];
    chosen.iter().flat_map(|&n| &nodes[n].members).for_each(|m| is_part[m.0] = true);
    let alone = (0..elements.len()).filter(|&e| elements[e].is_free && !is_part[e]);
    let mut outer: Vec<f64> = alone.map(|e| nodes[e].outer).collect();
    outer.extend(chosen.iter().map(|&n| nodes[n].outer));
    outer.sort_by(f64::total_cmp);
    let mut dropped = false;
    for &n in chosen {
        let Some(k) = kind_of[n] else { continue };
        let layout = &kinds[k].template;
        if kinds[k].nodes.len() >= 3 || layout.parts.len() > 2 && layout.is_orderly() {
            continue;
        }
        // The median of the other gaps and of those of the parts, of which each is at most the inner gap.
        let parts = kinds[k].nodes.len() * layout.parts.len();
        let rank = (outer.len() + parts) / 2;
        let usual = rank.checked_sub(parts).and_then(|rank| outer.get(rank)).copied().unwrap_or(0.0);
        if kinds[k].inner > ORDINARY * usual && kinds[k].value.take().is_some() {
            dropped = true;
        }
    }
    dropped
}
