//! The score of a candidate for a request: a weighted sum of five areas (paper §3.2.1).

use super::target::TargetMap;
use crate::arrange::model::{EMPTY, UNDEFINED, VariantId};
use crate::arrange::occupancy::{Occupancy, Owner, RequestId};
use vtex_scene::scene::Weights;

/// Four of the five areas of the score, in cells. The fifth, the uncovered part of the region, is the region
/// less `target`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct CandidateAreas {
    /// Cells of the region covered.
    target: u32,
    /// Cells covered that should be empty.
    empty: u32,
    /// Cells covered that hold or should hold another category, or in which the library has no part.
    mismatched: u32,
    /// Cells covered of the same category outside the region.
    same_overlap: u32,
}

/// Scores candidates for one request.
pub(super) struct Scorer<'m, 'a> {
    cells: &'m Occupancy<'a>,
    /// Owner of the cells of the requested region.
    owner: Owner,
    /// State of the cells of the requested category.
    code: u16,
    /// Number of cells of the region.
    region: u32,
    weights: &'m Weights,
    /// Whether every overlap with placed elements is refused.
    strict: bool,
}

impl<'m, 'a> Scorer<'m, 'a> {
    /// For a request whose region has `region` cells; `strict` refuses all overlap.
    pub(super) fn new(
        map: &'m TargetMap<'a>,
        request: RequestId,
        region: u32,
        weights: &'m Weights,
        strict: bool,
    ) -> Self {
        let code = map.model().element(map.get(request).variant).code;
        Self { cells: &map.cells, owner: Owner::request(request), code, region, weights, strict }
    }

    /// The score of a variant at a place: the weighted sum of the five areas, in cells. `-∞` where the
    /// edge of the domain does not allow it.
    pub(super) fn score(&self, variant: VariantId, at: [i32; 2]) -> f64 {
        if !self.cells.allows(variant, at) || (self.strict && self.overlaps(variant, at)) {
            return f64::NEG_INFINITY;
        }
        let a = self.areas(variant, at);
        let w = self.weights;
        w.target * f64::from(a.target)
            + w.uncovered * f64::from(self.region - a.target)
            + w.empty * f64::from(a.empty)
            + w.mismatched * f64::from(a.mismatched)
            + w.same_overlap * f64::from(a.same_overlap)
    }

    /// Upper bound of the score of a variant at any place. The score is linear in the overlap with the region, so
    /// the bound is the larger of the two extremes: as much overlap as possible, and none.
    pub(super) fn bound(&self, variant: VariantId) -> f64 {
        let w = self.weights;
        let area = f64::from(self.cells.model().shape(variant).area);
        let target = area.min(f64::from(self.region));
        // The highest score of a cell outside the region; 0 for an undefined one.
        let outside = w.empty.max(w.mismatched).max(w.same_overlap).max(0.0);
        let on_region =
            w.target * target + w.uncovered * (f64::from(self.region) - target) + outside * (area - target);
        let beside_region = w.uncovered * f64::from(self.region) + outside * area;
        on_region.max(beside_region)
    }

    /// Counts the cells under a variant. Undefined cells count only where the variant's library has no part.
    fn areas(&self, variant: VariantId, at: [i32; 2]) -> CandidateAreas {
        let (mut target, mut empty, mut same, mut defined) = (0, 0, 0, 0);
        let model = self.cells.model();
        for &span in model.shape(variant).mask.spans() {
            for cells in self.cells.grid.cells(span, at) {
                for &owner in &self.cells.owner[cells.clone()] {
                    target += u32::from(owner == self.owner);
                }
                for &state in &self.cells.state[cells] {
                    empty += u32::from(state == EMPTY);
                    same += u32::from(state == self.code);
                    defined += u32::from(state != UNDEFINED);
                }
            }
        }
        let mut areas =
            CandidateAreas { target, empty, mismatched: defined - empty - same, same_overlap: same - target };
        if self.cells.region.is_shared() {
            let library = model.element(variant).library;
            let cells = model
                .shape(variant)
                .mask
                .spans()
                .iter()
                .flat_map(|&s| self.cells.grid.cells(s, at))
                .flatten();
            let not_admitted =
                |i: &usize| self.cells.state[*i] == UNDEFINED && !self.cells.region.admits(*i, library);
            areas.mismatched += cells.filter(not_admitted).count() as u32;
        }
        areas
    }

    /// Whether a variant would overlap a placed one.
    fn overlaps(&self, variant: VariantId, at: [i32; 2]) -> bool {
        let spans = self.cells.model().shape(variant).mask.spans();
        spans.iter().flat_map(|&s| self.cells.grid.cells(s, at)).flatten().any(|i| self.cells.taken(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrange::controls::Controls;
    use crate::arrange::grid::Grid;
    use crate::arrange::model::{PlaceableId, PlacementModel};
    use crate::arrange::region::PlacementRegion;
    use vtex_base::raster::ControlMap;
    use vtex_base::sampling::stream;
    use vtex_scene::library::testing::{library, mosaic};
    use vtex_scene::scene::{Edge, SynthParams, Tile};

    /// The areas from their definitions, for all cells of the grid.
    fn areas_by_definition(
        map: &Occupancy<'_>,
        owner: Owner,
        code: u16,
        variant: VariantId,
        at: [i32; 2],
    ) -> CandidateAreas {
        let mut areas = CandidateAreas::default();
        let library = map.model().element(variant).library;
        let mask = &map.model().shape(variant).mask;
        let (w, h) = (map.grid.width, map.grid.height);
        let copies = |wrap: bool, size: i32| if wrap { vec![-size, 0, size] } else { vec![0] };
        for i in 0..map.grid.len() {
            let [x, y] = map.grid.place(i);
            let covers = copies(map.grid.tile.y, h).into_iter().any(|v| {
                copies(map.grid.tile.x, w).into_iter().any(|u| mask.contains(x + u - at[0], y + v - at[1]))
            });
            if !covers {
                continue;
            }
            match map.state[i] {
                EMPTY => areas.empty += 1,
                UNDEFINED if !map.region.admits(i, library) => areas.mismatched += 1,
                UNDEFINED => {}
                _ if map.owner[i] == owner => areas.target += 1,
                state if state == code => areas.same_overlap += 1,
                _ => areas.mismatched += 1,
            }
        }
        areas
    }

    /// Areas and the best candidate agree with the definitions on random maps: plain, tiled, with variations,
    /// shared by two libraries.
    #[test]
    fn areas_agree_with_their_definitions() {
        let one = library(&mosaic(90, 14.0, 0.8, 1));
        let two = library(&mosaic(90, 10.0, 0.5, 2));
        let map_of = |values: Vec<f32>| ControlMap::new(3, 1, values).unwrap();
        let shared = Controls {
            shares: vec![map_of(vec![1.0, 0.3, 0.0]), map_of(vec![0.0, 0.7, 1.0])],
            ..Controls::default()
        };
        let mut random = stream(1, "score test", 0);
        let (mut scored, mut seen) = (0, [false; 4]);
        for case in 0..16 {
            let tile = Tile { x: case % 2 == 1, y: case % 4 > 1 };
            let rotate = if case % 3 == 2 { 180.0 } else { 0.0 };
            let params = SynthParams {
                width: 70,
                height: 60,
                tile,
                rotate: Some(rotate),
                edge: Edge::Clip,
                ..SynthParams::default()
            };
            let several = case >= 8;
            let libraries = if several { vec![one.clone(), two.clone()] } else { vec![one.clone()] };
            let controls = if several { shared.clone() } else { Controls::default() };
            let model = PlacementModel::new(&libraries, &params);
            let grid = Grid::around(&model, &params);
            let region = PlacementRegion::new(&grid, &controls, params.edge, false);
            let placeable: Vec<PlaceableId> = model.members.iter().flatten().copied().collect();
            let mut map = TargetMap::new(Occupancy::new(&model, region, grid));
            let any = |random: &mut vtex_base::sampling::Stream| {
                let element = placeable[random.index(placeable.len())];
                model.draw_variant(element, random)
            };
            for _ in 0..3 {
                let at = [20, 20].map(|v| random.index(50) as i32 + v);
                let variant = any(&mut random);
                map.place(variant, at, 0.0);
            }
            let Some(request) = map.draw_request(&mut random) else { continue };
            let region = map.cells_of(request).len() as u32;
            let weights = Weights::default();
            let scorer = Scorer::new(&map, request, region, &weights, false);
            let (mut best, mut best_plain) = ((f64::NEG_INFINITY, 0), (f64::NEG_INFINITY, 0));
            for k in 0..20 {
                let variant = any(&mut random);
                let at = [map.grid().width, map.grid().height]
                    .map(|size| random.index(size as usize + 20) as i32 - 10);
                let wanted = areas_by_definition(&map.cells, scorer.owner, scorer.code, variant, at);
                assert_eq!(scorer.areas(variant, at), wanted);
                let w = &weights;
                let score = w.target * f64::from(wanted.target)
                    + w.uncovered * f64::from(region - wanted.target)
                    + w.empty * f64::from(wanted.empty)
                    + w.mismatched * f64::from(wanted.mismatched)
                    + w.same_overlap * f64::from(wanted.same_overlap);
                assert!(scorer.bound(variant) >= score);
                if score > best_plain.0 {
                    best_plain = (score, k);
                }
                if scorer.bound(variant) > best.0 && scorer.score(variant, at) > best.0 {
                    best = (scorer.score(variant, at), k);
                }
                let found = [wanted.target, wanted.empty, wanted.mismatched, wanted.same_overlap];
                (0..4).for_each(|k| seen[k] |= found[k] > 0);
                scored += 1;
            }
            assert_eq!(best, best_plain);
        }
        assert!(scored > 200 && seen == [true; 4], "{scored} {seen:?}");
    }
}
