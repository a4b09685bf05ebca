//! Copies that stand near each other, exchanged for primaries like them.
//!
//! An island brings its primaries side by side as they are in the exemplar. Where two islands from one
//! place lie near each other, the same group is seen twice. Exchanging some of its members for others
//! of like shape, size and colour leaves the structure and hides the copy.

use super::alike::Alike;
use super::arrivals::Plan;
use crate::arrange::model::{Model, PlaceableId, VariantId};
use crate::geometry::{Point, shortest_offset};
use crate::library::Library;
use crate::raster::Mask;
use crate::sampling::stream;
use crate::scene::SynthParams;
use std::collections::BTreeMap;

/// Share of the primaries with a copy near that are exchanged, if there are others like them.
const SHARE: f64 = 0.4;
/// Primaries compared with each.
const CANDIDATES: usize = 40;
/// Least area of one like another, as a share of the larger.
const AREA: f64 = 0.75;
/// Least share of the pixels of both that both have, centre on centre, where others stand around them.
const OVERLAP: f64 = 0.72;
/// Most of one exchanged that may lie on others, where the one before did not.
const ON_OTHERS: f64 = 0.08;

/// Exchanges elements in place; the plan learns where they stand. Gives their number.
pub(super) fn exchange(
    elements: &mut [(VariantId, [i32; 2])],
    plan: &mut Plan<'_>,
    alike: &Alike,
    libraries: &[Library],
    model: &Model,
    params: &SynthParams,
) -> usize {
    let period = plan.grid.tile.periods([plan.grid.width, plan.grid.height].map(f64::from));
    // Where each primary stands.
    let mut places: BTreeMap<PlaceableId, Vec<[i32; 2]>> = BTreeMap::new();
    for &(variant, at) in elements.iter() {
        places.entry(model.element_of(variant)).or_default().push(at);
    }
    let point = |at: [i32; 2]| Point::new(f64::from(at[0]), f64::from(at[1]));
    let near = |places: Option<&Vec<[i32; 2]>>, at: [i32; 2], reach: f64| {
        let others = places.into_iter().flatten().filter(|&&p| p != at);
        others.filter(|p| shortest_offset(point(at), point(**p), period).hypot() < reach).count()
    };
    let mut exchanged = 0;
    for (i, element) in elements.iter_mut().enumerate() {
        let (variant, at) = *element;
        let own = model.element_of(variant);
        let known = model.element(variant);
        let library = &libraries[known.library];
        let window = f64::from(library.source.width.max(library.source.height));
        let mut random = stream(params.seed, "correspondence/exchange", i as u64);
        if !random.chance(SHARE) || near(places.get(&own), at, window) == 0 {
            continue;
        }
        let mask = &model.shape(variant).mask;
        let first = random.unit();
        let fits = |candidate: PlaceableId| {
            let other = model.varied(candidate, variant);
            let there = &model.shape(other).mask;
            let both = f64::from(mask.overlap(there));
            let either = f64::from(mask.area() + there.area()) - both;
            if both < OVERLAP * either || near(places.get(&candidate), at, window * 0.5) > 0 {
                return None;
            }
            let others = plan.taken_beside(there, mask, at);
            let most = if plan.closeness(model, variant) > 0.0 { ON_OTHERS } else { 0.0 };
            (f64::from(others) <= most * f64::from(there.area())).then_some((both / either, other))
        };
        let area = f64::from(model.plain(own).area);
        let candidates = alike.of(own, AREA * area..area / AREA, CANDIDATES, first);
        let best = candidates.filter_map(fits).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, other)) = best else { continue };
        plan.stand(model, other, at);
        if let Some(list) = places.get_mut(&own) {
            list.retain(|&p| p != at);
        }
        places.entry(model.element_of(other)).or_default().push(at);
        element.0 = other;
        exchanged += 1;
    }
    exchanged
}

impl Plan<'_> {
    /// Pixels of a mask at a place that others take: those of `own` there are not counted.
    fn taken_beside(&self, mask: &Mask, own: &Mask, at: [i32; 2]) -> u32 {
        let spans = mask.spans().iter();
        spans
            .flat_map(|&s| self.grid.parts(s, at))
            .map(|part| {
                let [x, y] = [part.at[0] - at[0], part.at[1] - at[1]];
                let taken = |(k, i): (i32, usize)| self.is_taken(i) && !own.contains(x + k, y);
                (0..).zip(part.cells).filter(|&p| taken(p)).count() as u32
            })
            .sum()
    }
}
