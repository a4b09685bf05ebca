//! Libraries of which some categories are not placed.

use super::{Arrangement, CategoryId, Library};
use vtex_base::raster::LabelMap;

impl Library {
    /// The library as if the elements of some categories were background: they stand nowhere in its
    /// arrangement and its layers, and cover nothing. The arrangement says where they stood. Elements and categories
    /// keep their numbers. Such a library is for synthesis, not to be stored. `names` are names or numbers of categories
    /// ([`CategoryId::find`]). `None` if it has none of them.
    pub fn excluding(&self, names: &[String]) -> Option<Self> {
        let known = self.category_names();
        let mut is_out = vec![false; known.len()];
        names.iter().filter_map(|name| CategoryId::find(&known, name)).for_each(|c| is_out[c.index()] = true);
        if !is_out.contains(&true) {
            return None;
        }
        let leaves: Vec<bool> =
            self.elements.iter().map(|e| e.category.is_some_and(|c| is_out[c.index()])).collect();
        let mut library = self.clone();
        let mut map = self.arrangement.to_labels();
        let mut vacated = self
            .arrangement
            .vacated_labels()
            .unwrap_or_else(|| LabelMap { labels: vec![0; map.labels.len()], ..map });
        for (label, vacated) in map.labels.iter_mut().zip(&mut vacated.labels) {
            if label.checked_sub(1).is_some_and(|primary| leaves[primary as usize]) {
                (*label, *vacated) = (0, 1);
            }
        }
        library.arrangement =
            Arrangement { periodic: self.arrangement.periodic, ..Arrangement::from_labels(&map) }
                .with_vacated(Some(&vacated));
        for layer in &mut library.layers {
            layer.instances.retain(|instance| !leaves[instance.element.index()]);
        }
        library.motifs.retain(|motif| !motif.parts.iter().any(|part| leaves[part.element.index()]));
        for (category, _) in library.categories.iter_mut().zip(&is_out).filter(|(_, is_out)| **is_out) {
            category.coverage = 0.0;
        }
        library.coverage = library.categories.iter().fold(0.0, |sum, c| sum + c.coverage).min(1.0);
        Some(library)
    }
}

#[cfg(test)]
mod tests {
    use crate::library::testing::{library, mosaic};
    use vtex_base::raster::Mask;

    #[test]
    fn excluded_elements_are_background_and_others_stay() {
        let whole = library(&mosaic(96, 12.0, 0.7, 3));
        let names = whole.category_names();
        assert!(whole.excluding(&["no such".into()]).is_none() && whole.excluding(&[]).is_none());
        let without = whole.excluding(&names[1..2]).unwrap();
        for other in [names[1].to_uppercase(), "2".into()] {
            assert_eq!(whole.excluding(&[other]).unwrap(), without);
        }
        assert_eq!((&without.elements, without.category_names()), (&whole.elements, names));
        let count = whole.primaries().len() + 1;
        let [before, after] =
            [&whole, &without].map(|l| Mask::all_of_labels(&l.arrangement.to_labels(), count));
        for (k, primary) in whole.primaries().iter().enumerate() {
            let is_out = primary.category.is_some_and(|c| c.index() == 1);
            assert_eq!(after[k + 1], if is_out { Mask::default() } else { before[k + 1].clone() });
        }
        let [before, after] = [&whole, &without].map(|l| l.arrangement.to_labels().labels);
        let stood = before.iter().zip(&after).map(|(b, a)| u32::from(b != a)).collect::<Vec<_>>();
        assert_eq!(without.arrangement.vacated_labels().unwrap().labels, stood);
        assert_eq!(whole.arrangement.vacated_labels(), None);
        let expected = whole.categories[0].coverage + whole.categories[2].coverage;
        assert!((without.coverage - expected).abs() < 1e-12);
        let placed =
            |l: &crate::library::Library| l.layers.iter().map(|layer| layer.instances.len()).sum::<usize>();
        assert_eq!(placed(&whole) - placed(&without), whole.categories[1].members as usize);
    }
}
