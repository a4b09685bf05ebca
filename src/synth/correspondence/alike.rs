//! Primaries of like colour and size.

use crate::library::Library;
use crate::parallel;
use crate::synth::model::Model;
use std::ops::Range;

/// Largest distance of colours that are alike, in Oklab.
const COLOUR: f32 = 0.07;

/// For each primary the placeable ones of its library whose colour is like its own.
pub(super) struct Alike {
    /// Area and index, the smallest first.
    of: Vec<Vec<(u32, u32)>>,
}

impl Alike {
    pub(super) fn new(libraries: &[Library], model: &Model) -> Self {
        let colour = |p: u32| {
            let known = &model.primaries[p as usize];
            libraries[known.library].primaries[known.index as usize].colour.to_oklab()
        };
        let all: Vec<u32> = (0..model.primaries.len() as u32).collect();
        let colours: Vec<[f32; 3]> = all.iter().map(|&p| colour(p)).collect();
        let of = parallel::map(&all, |&p| {
            let (own, library) = (&colours[p as usize], model.primaries[p as usize].library);
            let like = |&other: &u32| {
                let (known, theirs) = (&model.primaries[other as usize], &colours[other as usize]);
                let apart: f32 = (0..3).map(|c| (own[c] - theirs[c]) * (own[c] - theirs[c])).sum();
                other != p && known.placeable && known.library == library && apart <= COLOUR * COLOUR
            };
            let mut list: Vec<(u32, u32)> =
                all.iter().copied().filter(like).map(|other| (model.plain(other).area, other)).collect();
            list.sort_unstable();
            list
        });
        Self { of }
    }

    /// Those like a primary with an area in a range, in pixels: at most `most`, evenly chosen, beginning
    /// at a share of them.
    pub(super) fn of(
        &self,
        primary: u32,
        areas: Range<f64>,
        most: usize,
        first: f64,
    ) -> impl Iterator<Item = u32> + '_ {
        let list = &self.of[primary as usize];
        let bound = |area: f64| list.partition_point(|l| f64::from(l.0) < area);
        let list = &list[bound(areas.start)..bound(areas.end).max(bound(areas.start))];
        let first = (first * list.len() as f64) as usize;
        list.iter().cycle().skip(first).take(list.len().min(most)).map(|l| l.1)
    }
}
