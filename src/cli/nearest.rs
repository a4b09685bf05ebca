//! The most similar word, for corrections of typing errors.

/// The candidate nearest to a text by edit distance, adjacent letters swapped included; the first of
/// several. Empty only if there are no candidates.
pub(crate) fn nearest<'a>(text: &str, candidates: &[&'a str]) -> &'a str {
    // Limits the work on very long texts.
    let text: String = text.chars().take(40).collect();
    let distance = |name: &&&str| strsim::osa_distance(&text, name);
    candidates.iter().min_by_key(distance).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swapped_letters_count_once_and_ties_go_to_the_first() {
        assert_eq!(nearest("tnit", &["tilt", "tint"]), "tint");
        assert_eq!(nearest("rotat", &["move", "rotate", "rotato"]), "rotate");
        assert_eq!(nearest("x", &[]), "");
    }
}
