//! Categories that are left out, and textures without elements.

use vtex_base::progress::Progress;
use vtex_scene::library::{CategoryId, Library};
use vtex_scene::scene::Scene;

/// The libraries without the categories of some names; `None` if all stay as they are.
pub(super) fn excluding(
    libraries: &[Library],
    names: &[String],
    progress: &dyn Progress,
) -> Option<Vec<Library>> {
    let known: Vec<Vec<String>> = libraries.iter().map(Library::category_names).collect();
    let is_known = |name: &String| known.iter().any(|own| CategoryId::find(own, name).is_some());
    for name in names.iter().filter(|name| !is_known(name)) {
        progress.warn(&format!("there is no category '{name}' to exclude; {}", those_known(&known.concat())));
    }
    let kept = |library: &Library| library.excluding(names).unwrap_or_else(|| library.clone());
    names.iter().any(is_known).then(|| libraries.iter().map(kept).collect())
}

/// The names of categories, in a sentence.
fn those_known(names: &[String]) -> String {
    const MOST: usize = 20;
    let shown = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len() {
        0 => "the library has none".into(),
        1..=MOST => format!("known are {shown}"),
        all => format!("known are {shown} and {} more", all - MOST),
    }
}

/// A warning about a texture without elements, of libraries that have some; `None` otherwise.
pub(super) fn no_elements(libraries: &[Library], scene: &Scene) -> Option<String> {
    let elements = libraries.iter().flat_map(Library::primaries);
    let (all, cut) = elements.fold((0, 0), |(all, cut), e| (all + 1, cut + usize::from(e.clipped)));
    if all == 0 || scene.individuals().next().is_some() {
        return None;
    }
    let why = if cut == all {
        ": the border cuts all of them, and this method places whole ones only"
    } else {
        ", and none has been placed"
    };
    Some(format!("the texture has no elements; the library has {all}{why}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::testing::Warnings;
    use crate::synth::{Controls, synthesize_with};
    use vtex_base::document::Document;
    use vtex_scene::library::testing::{guided, mosaic};
    use vtex_scene::scene::{Method, SynthParams};

    #[test]
    fn excluded_categories_are_not_placed_and_others_cover_about_as_much() {
        let whole = guided(&mosaic(140, 14.0, 0.6, 2));
        let names = whole.category_names();
        for method in [Method::Correspondence, Method::Descriptor] {
            let params = |exclude: &[String]| {
                let exclude = exclude.to_vec();
                SynthParams { width: 200, height: 160, seed: 3, method, exclude, ..SynthParams::default() }
            };
            let made = |exclude: &[String], progress: &dyn Progress| {
                let libraries = std::slice::from_ref(&whole);
                synthesize_with(libraries, &params(exclude), &Controls::default(), progress).unwrap()
            };
            let (scene, report) = made(&names[1..2], &());
            assert_eq!(
                (scene.validate(), &scene.parameters.as_ref().unwrap().exclude[..]),
                (Ok(()), &names[1..2])
            );
            let placed = |category: usize| {
                let of = |i: &&_| scene.element(i).category.is_some_and(|c| c.index() == category);
                scene.primary().iter().filter(of).count()
            };
            assert!(placed(1) == 0 && placed(0) > 5 && placed(2) > 5, "{method:?}");
            let [first, second, third] = [0, 1, 2].map(|c| &report.categories[c]);
            assert_eq!((second.wanted, second.got), (0.0, 0.0));
            let cover = (first.got + third.got) / (first.wanted + third.wanted);
            assert!((0.65..1.3).contains(&cover), "{method:?}: {first:?} {third:?}");
            // A name that no category has changes nothing, and is told.
            let warnings = Warnings::default();
            let (plain, _) = made(&[], &());
            let (other, _) = made(&["no such".into()], &warnings);
            assert_eq!(other.elements, plain.elements);
            let said = warnings.0.lock().unwrap().concat();
            assert!(said.starts_with("there is no category 'no such' to exclude; known are "), "{said}");
            assert!(names.iter().all(|name| said.contains(name.as_str())), "{said}");
            let (empty, _) = made(&names, &());
            assert!(empty.primary().is_empty());
        }
    }
}
