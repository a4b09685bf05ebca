//! Masks that overlap → disjoint masks.

use super::ScoredMask;
use super::regions::worth;
use vtex_base::raster::{Connectivity, LabelMap, Mask, Span, components_of_mask};

/// Largest share of its pixels that a mask may lose to masks of higher worth.
const MOST_LOST: f32 = 0.25;

/// Indices of the masks with a score above 0, best first; ties go to the first.
pub(super) fn by_worth(offers: &[ScoredMask]) -> Vec<usize> {
    let worth = |offer: &ScoredMask| worth(offer.mask.area() as f32, offer.score);
    let mut order: Vec<(f32, usize)> = offers.iter().map(worth).zip(0..).collect();
    order.retain(|(worth, _)| *worth > 0.0);
    order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, k)| k).collect()
}

/// Disjoint masks, chosen greedily in order of worth. Each is what earlier masks leave of one of `offers`, in
/// one piece.
pub(super) fn disjoint(offers: &[ScoredMask], width: u32, height: u32) -> Vec<ScoredMask> {
    let mut taken = LabelMap::filled(width, height, 0);
    let mut found = Vec::new();
    for k in by_worth(offers) {
        let ScoredMask { mask, score } = &offers[k];
        let labels =
            |s: &Span| &taken.labels[taken.index(s.x0 as u32, s.y as u32)..][..(s.x1 - s.x0) as usize];
        let left: usize = mask.spans().iter().map(|s| labels(s).iter().filter(|&&l| l == 0).count()).sum();
        if (left as f32) < (1.0 - MOST_LOST) * mask.area() as f32 {
            continue;
        }
        let mut spans = Vec::new();
        for s in mask.spans() {
            let mut x0 = s.x0;
            for run in labels(s).chunk_by(|a, b| a == b) {
                let x1 = x0 + run.len() as i32;
                if run[0] == 0 {
                    spans.push(Span { x0, x1, ..*s });
                }
                x0 = x1;
            }
        }
        let pieces = components_of_mask(&Mask::from_spans(spans), Connectivity::Four);
        let Some(mask) = pieces.into_iter().rev().max_by_key(Mask::area) else { continue };
        taken.fill(&mask, 1);
        found.push(ScoredMask { mask, score: *score });
    }
    found
}
