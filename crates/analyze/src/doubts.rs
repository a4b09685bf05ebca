//! Warnings where a result will differ visibly from its photograph.

use vtex_scene::library::ExemplarElement;
use vtex_segment::segment::ScoredMask;

/// Masks are doubtful if their mean score, weighted by area, is below this. Photographs with elements that
/// a person can distinguish score 0.4 to 0.98; rust, and stones in grass from the air, 0.30 to 0.35.
const DOUBTFUL: f64 = 0.36;
/// With fewer whole elements, repetition is visible.
const FEW: usize = 30;

/// Adds warnings about the masks of a photograph and the primaries made of them.
pub(super) fn about(masks: &[ScoredMask], primaries: &[ExemplarElement], warnings: &mut Vec<String>) {
    let placed = primaries.iter().filter(|p| !p.clipped).count();
    if primaries.is_empty() {
        warnings.push(
            "no primary element was found: the result holds background and secondaries only \
             (try another segmenter, masks of your own, or a photograph with distinct elements)"
                .into(),
        );
    } else if placed == 0 {
        warnings.push(
            "every primary element is cut by the border: none can be placed (use a larger photograph)".into(),
        );
    } else if placed < FEW {
        warnings.push(format!(
            "only {placed} primary elements can be placed: repetition will show (use a larger photograph)"
        ));
    }
    if let Some(score) = mean_score(masks).filter(|&score| score < DOUBTFUL && placed > 0) {
        warnings.push(format!(
            "the masks are doubtful (mean score {score:.2} of 1), so elements may be pieces, or several at once, \
             and the result may look unlike the photograph (look at the masks and correct them, or try another \
             segmenter)"
        ));
    }
}

/// Mean score of masks, weighted by area; `None` if they are empty.
fn mean_score(masks: &[ScoredMask]) -> Option<f64> {
    let area: f64 = masks.iter().map(|m| f64::from(m.mask.area())).sum();
    let scored: f64 = masks.iter().map(|m| f64::from(m.mask.area()) * f64::from(m.score)).sum();
    (area > 0.0).then(|| scored / area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::{Mask, Span};
    use vtex_scene::library::testing::{library, mosaic};

    #[test]
    fn few_or_doubtful_elements_are_warned_of() {
        let mask = |rows: i32, score| ScoredMask {
            mask: Mask::from_spans((0..rows).map(|y| Span { y, x0: 0, x1: 10 }).collect()),
            score,
        };
        let primaries = library(&mosaic(150, 14.0, 0.8, 1)).primaries().to_vec();
        let warned = |masks: &[ScoredMask], primaries: &[ExemplarElement]| {
            let mut warnings = Vec::new();
            about(masks, primaries, &mut warnings);
            warnings.join("\n")
        };
        assert_eq!(warned(&[mask(10, 0.9), mask(3, 0.1)], &primaries), "");
        // Large masks count for more.
        let doubtful = warned(&[mask(10, 0.2), mask(3, 0.8)], &primaries);
        assert!(doubtful.contains("mean score 0.34 of 1") && doubtful.contains("segmenter"), "{doubtful}");
        let few: Vec<ExemplarElement> = primaries.iter().filter(|p| !p.clipped).take(12).cloned().collect();
        assert!(warned(&[mask(5, 0.9)], &few).contains("only 12 primary elements"));
        assert!(warned(&[], &[]).contains("no primary element"));
    }
}
