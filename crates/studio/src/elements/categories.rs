//! Categories that a user gives to elements.

use super::ElementMasks;
use vtex_base::raster::Mask;
use vtex_scene::library::Library;
use vtex_segment::segment::GivenCategory;

/// Most categories.
const MOST_CATEGORIES: usize = 200;

/// The categories of a photograph's library, over its pixels.
pub fn categories_of_library(library: &Library) -> Vec<GivenCategory> {
    let map = library.arrangement.to_labels();
    let masks = Mask::all_of_labels(&map, library.primaries().len() + 1);
    let mut spans = vec![Vec::new(); library.categories.len()];
    for (primary, mask) in library.primaries().iter().zip(masks.iter().skip(1)) {
        if let Some(category) = primary.category {
            spans[category.index()].extend_from_slice(mask.spans());
        }
    }
    let (from, to) = ([map.width, map.height], [library.source.width, library.source.height]);
    let masks = spans.into_iter().map(|spans| Mask::from_spans(spans).stretched(from, to));
    library.category_names().into_iter().zip(masks).map(|(name, mask)| GivenCategory { name, mask }).collect()
}

impl ElementMasks {
    /// The elements with categories, each with the one that holds most of it. Categories without elements are left out.
    pub fn with_categories(mut self, categories: &[GivenCategory]) -> Self {
        self.names = categories.iter().map(|category| category.name.clone()).collect();
        self.of = self.categories_among(categories);
        self.drop_unused_names(None);
        self
    }

    /// The category, among some, that holds most of each element.
    pub fn categories_among(&self, categories: &[GivenCategory]) -> Vec<Option<usize>> {
        self.masks.iter().map(|mask| GivenCategory::of(mask, categories)).collect()
    }

    /// The names of the categories that a user has given, in their order; none if they are found by analysis.
    pub fn category_names(&self) -> &[String] {
        &self.names
    }

    /// The categories that a user has given.
    pub fn given_categories(&self) -> Vec<GivenCategory> {
        let of = |index: usize| {
            let own = self.masks.iter().zip(&self.of).filter(|(_, category)| **category == Some(index));
            Mask::from_spans(own.flat_map(|(mask, _)| mask.spans().to_vec()).collect())
        };
        let names = self.names.iter().cloned().enumerate();
        names.map(|(index, name)| GivenCategory { name, mask: of(index) }).collect()
    }

    /// Moves elements to the category of a name, a new one if there is none. All elements of a category moved to a new
    /// name rename it; all of two categories moved to one merge them. `found` are the categories of the analysis, from
    /// which it starts if a user has given none. Gives the names before.
    ///
    /// # Errors
    /// What cannot be done, in a sentence. The elements then stay as they were.
    pub fn categorize(
        &mut self,
        elements: &[usize],
        name: &str,
        found: &[GivenCategory],
    ) -> Result<Vec<String>, String> {
        let all = self.check(elements, 1)?;
        GivenCategory::check_names([name])?;
        if self.names.is_empty() {
            *self = self.clone().with_categories(found);
        }
        let before = self.names.clone();
        let index = before.iter().position(|known| known == name);
        if index.is_none() && before.len() == MOST_CATEGORIES {
            return Err(format!("there are {MOST_CATEGORIES} categories already"));
        }
        let index = index.unwrap_or(before.len());
        if index == before.len() {
            self.names.push(name.to_owned());
        }
        all.iter().for_each(|&element| self.of[element] = Some(index));
        self.drop_unused_names((index == before.len()).then_some(index));
        Ok(before)
    }

    /// Leaves categories to the analysis. Gives the names before.
    pub fn forget_categories(&mut self) -> Vec<String> {
        self.of.fill(None);
        std::mem::take(&mut self.names)
    }

    /// Drops names without elements. The first that is dropped gives its place to a new name.
    pub(super) fn drop_unused_names(&mut self, new: Option<usize>) {
        let is_used: Vec<bool> = (0..self.names.len()).map(|index| self.of.contains(&Some(index))).collect();
        let mut order: Vec<usize> = (0..self.names.len()).collect();
        if let (Some(new), Some(free)) = (new, is_used.iter().position(|is_used| !is_used)) {
            order.retain(|index| *index != new);
            order.insert(free, new);
        }
        order.retain(|&index| is_used[index]);
        let place = |index: usize| order.iter().position(|&known| known == index);
        self.of = self.of.iter().map(|category| category.and_then(place)).collect();
        self.names = order.iter().map(|&index| self.names[index].clone()).collect();
    }
}

/// The new index of each category, given the names before and after a change: that of its name, or of the new name that
/// stands in its place. `None` for one that is gone.
pub fn renumbered(before: &[String], after: &[String]) -> Vec<Option<usize>> {
    let index = |(place, name): (usize, &String)| {
        let renamed = || after.get(place).filter(|new| !before.contains(new)).map(|_| place);
        after.iter().position(|known| known == name).or_else(renamed)
    };
    before.iter().enumerate().map(index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::Mending;
    use vtex_base::raster::Span;

    fn block(x: i32) -> Mask {
        Mask::from_spans((2..12).map(|y| Span { y, x0: x, x1: x + 8 }).collect())
    }

    /// Four elements; the first two are moss, the others stone and clay.
    fn four() -> (ElementMasks, Vec<GivenCategory>) {
        let masks = [0, 10, 20, 30].map(block);
        let moss = Mask::from_spans([masks[0].spans(), masks[1].spans()].concat());
        let given = [("moss", moss), ("stone", masks[2].clone()), ("clay", masks[3].clone())];
        let given = given.map(|(name, mask)| GivenCategory { name: name.into(), mask });
        (ElementMasks::new([40, 20], masks), given.to_vec())
    }

    fn changed(elements: &[usize], name: &str) -> Result<(String, Vec<Option<usize>>), String> {
        let (mut all, found) = four();
        let before = all.categorize(elements, name, &found)?;
        let of = all.of.iter().map(|c| c.map_or("-", |c| &all.names[c])).collect::<Vec<_>>();
        Ok((format!("{} {of:?}", all.names.join(",")), renumbered(&before, &all.names)))
    }

    #[test]
    fn categories_are_renamed_merged_and_filled() {
        let is = |elements: &[usize], name, names: &str, numbers: [Option<usize>; 3]| {
            let (told, found) = changed(elements, name).unwrap();
            assert_eq!((told.as_str(), found), (names, numbers.to_vec()));
        };
        is(
            &[1],
            "stone",
            r#"moss,stone,clay ["moss", "stone", "stone", "clay"]"#,
            [Some(0), Some(1), Some(2)],
        );
        is(&[2], "rock", r#"moss,rock,clay ["moss", "moss", "rock", "clay"]"#, [Some(0), Some(1), Some(2)]);
        is(&[2, 3], "clay", r#"moss,clay ["moss", "moss", "clay", "clay"]"#, [Some(0), None, Some(1)]);
        is(&[0, 1, 3], "all", r#"all,stone ["all", "all", "stone", "all"]"#, [Some(0), Some(1), None]);
        is(
            &[0],
            "new",
            r#"moss,stone,clay,new ["new", "moss", "stone", "clay"]"#,
            [Some(0), Some(1), Some(2)],
        );
        for (elements, name) in [(&[][..], "a"), (&[9], "a"), (&[0], ""), (&[0], "a,b")] {
            assert!(changed(elements, name).is_err(), "{name}");
        }
    }

    #[test]
    fn mending_keeps_categories_with_their_elements() {
        let (all, found) = four();
        let mut all = all.with_categories(&found);
        all.mend(&Mending::Delete { elements: vec![0, 3] }).unwrap();
        assert_eq!((all.names.join(","), &all.of[..]), ("moss,stone".into(), &[Some(0), Some(1)][..]));
        all.mend(&Mending::Draw { path: vec![[32.0, 2.0], [38.0, 2.0], [38.0, 12.0], [32.0, 12.0]] })
            .unwrap();
        all.mend(&Mending::Split { element: 0, path: vec![[14.0, 0.0], [14.0, 19.0]] }).unwrap();
        assert_eq!(all.of, [Some(0), Some(1), None, Some(0)]);
        let saved = all.given_categories();
        assert_eq!(all.categories_among(&saved), [Some(0), Some(1), None, Some(0)]);
        assert_eq!(all.clone().with_categories(&saved), all);
        assert_eq!(all.forget_categories(), ["moss", "stone"]);
        assert!(all.given_categories().is_empty() && all.of.iter().all(Option::is_none));
    }
}
