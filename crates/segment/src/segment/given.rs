//! Categories that a user has given to masks.

use super::ScoredMask;
use vtex_base::document::is_category_name;
use vtex_base::error::clip;
use vtex_base::raster::Mask;

/// A category that a user has given to elements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenCategory {
    /// Its name: 1 to 100 letters, digits, blanks and hyphens.
    pub name: String,
    /// The pixels of its elements. Those of different categories do not overlap.
    pub mask: Mask,
}

impl GivenCategory {
    /// The category that most pixels of a mask are in, the first of several; `None` if no pixel is in any.
    pub fn of(mask: &Mask, categories: &[Self]) -> Option<usize> {
        let shares = categories.iter().map(|category| category.mask.overlap(mask)).enumerate();
        let most = shares.rev().max_by_key(|(_, share)| *share);
        most.filter(|(_, share)| *share > 0).map(|(category, _)| category)
    }

    /// Checks names: each can be one, and all are different.
    ///
    /// # Errors
    /// What is wrong with the first that is.
    pub fn check_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<(), String> {
        let mut known: Vec<&str> = Vec::new();
        for name in names {
            if !is_category_name(name) {
                return Err(format!(
                    "'{}' is no name of a category: it takes 1 to 100 letters, digits, blanks and hyphens",
                    clip(name)
                ));
            }
            if known.contains(&name) {
                return Err(format!("two categories are named '{name}'"));
            }
            known.push(name);
        }
        Ok(())
    }

    /// The category of each mask.
    pub(super) fn of_all(masks: &[ScoredMask], categories: &[Self]) -> Vec<Option<usize>> {
        masks.iter().map(|scored| Self::of(&scored.mask, categories)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::Span;

    fn row(y: i32, x0: i32, x1: i32) -> Mask {
        Mask::from_spans(vec![Span { y, x0, x1 }])
    }

    #[test]
    fn a_mask_is_of_the_category_that_holds_most_of_it() {
        let given = [("moss", row(2, 0, 10)), ("stone", row(2, 10, 30)), ("gone", Mask::default())];
        let given = given.map(|(name, mask)| GivenCategory { name: name.into(), mask });
        let of = |mask: &Mask| GivenCategory::of(mask, &given);
        assert_eq!(of(&row(2, 4, 14)), Some(0));
        assert_eq!(of(&row(2, 8, 30)), Some(1));
        assert_eq!(of(&row(2, 5, 15)), Some(0));
        assert_eq!(of(&row(3, 0, 40)), None);
    }

    #[test]
    fn names_are_plain_and_different() {
        let check = |names: &[&str]| GivenCategory::check_names(names.iter().copied());
        assert_eq!(check(&["dark brown", "Moos", "石-2"]), Ok(()));
        for bad in [&[""][..], &["a,b"], &["a\nb"], &["<a>"], &["a", "a"], &[&"x".repeat(101)]] {
            assert!(check(bad).is_err(), "{bad:?}");
        }
        assert_eq!(check(&[&"x".repeat(100)]), Ok(()));
    }
}
