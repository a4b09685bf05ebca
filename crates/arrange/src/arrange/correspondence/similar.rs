//! Elements of similar colour and size.

use crate::arrange::model::{PlaceableId, PlacementModel};
use std::ops::Range;
use vtex_base::parallel;
use vtex_scene::library::Library;

/// Largest distance of similar colours, in Oklab.
const COLOUR: f32 = 0.07;

/// For each element, the placeable elements of its library and stratum with a similar colour.
pub(super) struct Substitutes {
    /// Area and index of the similar elements of each, the smallest first.
    of: Vec<Vec<(u32, PlaceableId)>>,
}

impl Substitutes {
    pub(super) fn new(libraries: &[Library], model: &PlacementModel) -> Self {
        let colour = |element: PlaceableId| {
            let known = &model[element];
            libraries[known.library].primaries()[known.index as usize].colour.to_oklab()
        };
        let strata: Vec<Vec<u8>> = libraries.iter().map(Library::strata_of_elements).collect();
        let stratum = |element: PlaceableId| {
            let known = &model[element];
            strata[known.library][known.index as usize]
        };
        let all: Vec<PlaceableId> = (0..model.elements.len() as u32).map(PlaceableId).collect();
        let colours: Vec<[f32; 3]> = all.iter().map(|&element| colour(element)).collect();
        let of = parallel::map(&all, |&element| {
            let (own, library) = (&colours[element.0 as usize], model[element].library);
            let like = |&other: &PlaceableId| {
                let (known, theirs) = (&model[other], &colours[other.0 as usize]);
                let apart: f32 = (0..3).map(|c| (own[c] - theirs[c]) * (own[c] - theirs[c])).sum();
                let same = known.library == library && stratum(other) == stratum(element);
                other != element && known.placeable && same && apart <= COLOUR * COLOUR
            };
            let mut list: Vec<(u32, PlaceableId)> =
                all.iter().copied().filter(like).map(|other| (model.plain(other).area, other)).collect();
            list.sort_unstable();
            list
        });
        Self { of }
    }

    /// Elements similar to `element` with an area in a range, in pixels: at most `most`, beginning at the
    /// share `first` of the list.
    pub(super) fn of(
        &self,
        element: PlaceableId,
        areas: Range<f64>,
        most: usize,
        first: f64,
    ) -> impl Iterator<Item = PlaceableId> + '_ {
        let list = &self.of[element.0 as usize];
        let bound = |area: f64| list.partition_point(|l| f64::from(l.0) < area);
        let list = &list[bound(areas.start)..bound(areas.end).max(bound(areas.start))];
        let first = (first * list.len() as f64) as usize;
        list.iter().cycle().skip(first).take(list.len().min(most)).map(|l| l.1)
    }
}
