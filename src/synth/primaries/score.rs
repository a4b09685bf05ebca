//! How well a texton answers a request (paper §3.2.1, the five areas).

use crate::scene::Weights;
use crate::synth::model::{EMPTY, UNDEFINED};
use crate::synth::target::TargetMap;

/// The areas of the score that depend on the candidate, in cells. The fifth, what stays uncovered,
/// is the rest of the region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Areas {
    /// Cells of the region covered.
    target: u32,
    /// Cells covered that should be empty.
    empty: u32,
    /// Cells covered that hold or should hold another category.
    mismatched: u32,
    /// Cells covered of the same category outside the region.
    same_overlap: u32,
}

/// Scores candidates for one request.
pub(super) struct Scorer<'m, 'a> {
    map: &'m TargetMap<'a>,
    owner: u32,
    code: u16,
    region: u32,
    weights: &'m Weights,
}

impl<'m, 'a> Scorer<'m, 'a> {
    /// For a request whose region has `region` cells.
    pub(super) fn new(map: &'m TargetMap<'a>, request: u32, region: u32, weights: &'m Weights) -> Self {
        let code = map.model().shapes[map.request_of(request).primary as usize].code;
        Self { map, owner: TargetMap::request_owner(request), code, region, weights }
    }

    /// The score of a texton at a place: the weighted sum of the five areas, in cells.
    pub(super) fn score(&self, primary: u32, at: [i32; 2]) -> f64 {
        let a = self.areas(primary, at);
        let w = self.weights;
        w.target * f64::from(a.target)
            + w.uncovered * f64::from(self.region - a.target)
            + w.empty * f64::from(a.empty)
            + w.mismatched * f64::from(a.mismatched)
            + w.same_overlap * f64::from(a.same_overlap)
    }

    /// Counts cells span by span. Undefined cells count for nothing.
    fn areas(&self, primary: u32, at: [i32; 2]) -> Areas {
        let (mut target, mut empty, mut same, mut defined) = (0, 0, 0, 0);
        for &span in self.map.model().shapes[primary as usize].mask.spans() {
            let cells = self.map.cells(span, at);
            for &owner in &self.map.owner[cells.clone()] {
                target += u32::from(owner == self.owner);
            }
            for &state in &self.map.state[cells] {
                empty += u32::from(state == EMPTY);
                same += u32::from(state == self.code);
                defined += u32::from(state != UNDEFINED);
            }
        }
        Areas { target, empty, mismatched: defined - empty - same, same_overlap: same - target }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;
    use crate::synth::model::Model;
    use crate::synth::testing::{library, mosaic};

    /// The areas cell by cell, from the definitions.
    fn plain(map: &TargetMap<'_>, owner: u32, code: u16, primary: u32, at: [i32; 2]) -> Areas {
        let mut areas = Areas::default();
        for y in 0..map.height {
            for x in 0..map.width {
                if !map.model().shapes[primary as usize].mask.contains(x - at[0], y - at[1]) {
                    continue;
                }
                let i = map.index(x, y);
                match map.state[i] {
                    EMPTY => areas.empty += 1,
                    UNDEFINED => {}
                    _ if map.owner[i] == owner => areas.target += 1,
                    state if state == code => areas.same_overlap += 1,
                    _ => areas.mismatched += 1,
                }
            }
        }
        areas
    }

    #[test]
    fn spans_count_what_cells_count() {
        let library = library(&mosaic(90, 14.0, 0.8, 1));
        let model = Model::new(&library);
        let placeable: Vec<u32> = model.members.iter().flatten().copied().collect();
        let mut random = stream(1, "score test", 0);
        let (mut scored, mut seen) = (0, [false; 4]);
        for _ in 0..12 {
            let mut map = TargetMap::new(&model, 50, 40);
            for _ in 0..3 {
                let at = [20, 20].map(|v| random.index(50) as i32 + v);
                map.place(placeable[random.index(placeable.len())], at);
            }
            let Some(request) = map.draw_request(&mut random) else { continue };
            let region = map.region(request).cells.len() as u32;
            let weights = Weights::default();
            let scorer = Scorer::new(&map, request, region, &weights);
            for _ in 0..20 {
                let primary = placeable[random.index(placeable.len())];
                let at = [map.width, map.height].map(|size| random.index(size as usize + 20) as i32 - 10);
                let wanted = plain(&map, scorer.owner, scorer.code, primary, at);
                assert_eq!(scorer.areas(primary, at), wanted);
                let found = [wanted.target, wanted.empty, wanted.mismatched, wanted.same_overlap];
                (0..4).for_each(|k| seen[k] |= found[k] > 0);
                scored += 1;
            }
        }
        assert!(scored > 100 && seen == [true; 4], "{scored} {seen:?}");
    }
}
