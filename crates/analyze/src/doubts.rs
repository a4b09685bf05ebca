//! Warnings where a result will differ visibly from its photograph.

use vtex_scene::library::ExemplarElement;
use vtex_segment::segment::ScoredMask;

/// Masks are doubtful if their mean score, weighted by area, is below this. Photographs with elements that
/// a person can distinguish score 0.4 to 0.98; rust, and stones in grass from the air, 0.30 to 0.35.
const DOUBTFUL: f64 = 0.36;
/// With fewer whole elements, repetition is visible.
const FEW: usize = 30;

/// A warning about primaries that are placed anew, of which few or none are whole.
pub(super) fn about_placing(primaries: &[ExemplarElement]) -> Option<String> {
    let whole = whole(primaries);
    match whole {
        _ if primaries.is_empty() => None,
        0 => Some(
            "the border cuts every primary element, so none can be placed whole (use a larger photograph)"
                .into(),
        ),
        1..FEW => Some(format!(
            "only {whole} primary elements can be placed: repetition will show (use a larger photograph)"
        )),
        _ => None,
    }
}

/// A warning about the masks of a photograph and the primaries made of them.
pub(super) fn about_masks(masks: &[ScoredMask], primaries: &[ExemplarElement]) -> Option<String> {
    if primaries.is_empty() {
        return Some(
            "no primary element was found: the result contains background and secondaries only \
             (try another segmenter, masks of your own, or a photograph with distinct elements)"
                .into(),
        );
    }
    let score = mean_score(masks).filter(|&score| score < DOUBTFUL && whole(primaries) > 0)?;
    Some(format!(
        "the masks are doubtful (mean score {score:.2} of 1), so elements may be pieces, or several at once, \
         and the result may look unlike the photograph (look at the masks and correct them, or try another \
         segmenter)"
    ))
}

/// Number of primaries that the border does not cut.
fn whole(primaries: &[ExemplarElement]) -> usize {
    primaries.iter().filter(|p| !p.clipped).count()
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
            about_placing(primaries).into_iter().chain(about_masks(masks, primaries)).collect::<String>()
        };
        assert_eq!(warned(&[mask(10, 0.9), mask(3, 0.1)], &primaries), "");
        // Large masks count for more.
        let doubtful = warned(&[mask(10, 0.2), mask(3, 0.8)], &primaries);
        assert!(doubtful.contains("mean score 0.34 of 1") && doubtful.contains("segmenter"), "{doubtful}");
        let few: Vec<ExemplarElement> = primaries.iter().filter(|p| !p.clipped).take(12).cloned().collect();
        assert!(warned(&[mask(5, 0.9)], &few).contains("only 12 primary elements"));
        let cut: Vec<ExemplarElement> = primaries.iter().filter(|p| p.clipped).cloned().collect();
        assert!(warned(&[mask(5, 0.9)], &cut).contains("the border cuts every primary element"));
        assert!(warned(&[], &[]).contains("no primary element"));
    }
}
