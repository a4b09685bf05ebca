//! The choice of the next element of a category: each use of an element halves its probability.

use super::model::{PlaceableId, PlacementModel, VariantId};
use vtex_base::sampling::{Stream, WeightTree};

/// Number of halvings that are distinguished. With more, sizes within a category would be closer to the
/// exemplar's on large canvases, but then only elements that fit nowhere would be drawn, because these are
/// never used.
const HALVINGS: u32 = 5;

/// Selection weights of the members of every category (paper §3.3, duplication reduction).
#[derive(Clone)]
pub(super) struct MemberWeights {
    categories: Vec<UseWeights>,
    /// Place of each element among the members of its category.
    slot: Vec<u32>,
    decay: bool,
}

/// Weights 2^-uses, renormalised: the least used member has the largest.
#[derive(Clone)]
struct UseWeights {
    uses: Vec<u32>,
    /// Uses of the least used member, and the number of members with so few uses.
    least: u32,
    at_least: u32,
    sums: WeightTree,
}

impl MemberWeights {
    /// Equal weights for all members of a category. Without `decay` they stay equal.
    pub(super) fn new(model: &PlacementModel, decay: bool) -> Self {
        let mut slot = vec![0; model.elements.len()];
        let categories = model.members.iter().map(|members| {
            for (i, &m) in members.iter().enumerate() {
                slot[m.0 as usize] = i as u32;
            }
            let mut sums = WeightTree::zeros(members.len());
            (0..members.len()).for_each(|i| sums.set(i, 1 << HALVINGS));
            UseWeights { uses: vec![0; members.len()], least: 0, at_least: members.len() as u32, sums }
        });
        Self { categories: categories.collect(), slot, decay }
    }

    /// A member of a category, drawn by weight; `None` if it has none.
    pub(super) fn draw(
        &self,
        model: &PlacementModel,
        category: usize,
        random: &mut Stream,
    ) -> Option<PlaceableId> {
        let slot = self.categories[category].sums.draw(random)?;
        Some(model.members[category][slot])
    }

    /// Halves the weight of the element of a variant.
    pub(super) fn used(&mut self, model: &PlacementModel, variant: VariantId) {
        if !self.decay {
            return;
        }
        let w = &mut self.categories[model.element(variant).category];
        let slot = self.slot[model.element_of(variant).0 as usize] as usize;
        if w.uses[slot] == w.least {
            w.at_least -= 1;
        }
        w.uses[slot] += 1;
        let weight = |uses: u32, least: u32| 1u64 << (HALVINGS - (uses - least).min(HALVINGS));
        w.sums.set(slot, weight(w.uses[slot], w.least));
        if w.at_least == 0 {
            w.least = w.uses.iter().copied().min().unwrap_or(0);
            w.at_least = w.uses.iter().filter(|&&u| u == w.least).count() as u32;
            for (i, &uses) in w.uses.iter().enumerate() {
                w.sums.set(i, weight(uses, w.least));
            }
        }
    }
}
