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
