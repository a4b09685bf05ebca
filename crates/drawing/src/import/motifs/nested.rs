//! Motifs of motifs: sets of motifs that stand out as sets of elements do.

use super::features::MotifElement;
use super::layout::MotifLayout;
use super::tree::MotifPlane;
use crate::import::offsets::{Shift, plus};
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::geometry::{Point, Vec2};

/// Least share of the motifs that take part: among many, a few are near each other by chance.
const SHARE: f64 = 0.8;
/// Least number of sets of one composition, and of motifs in each.
const COPIES: usize = 2;
const MOTIFS: usize = 2;
/// Most elements of a set.
const MOST_PARTS: usize = 128;
/// Points of the polygons of a motif above which longer ones are thinned.
const MOST_POINTS: usize = 128;

/// Motifs, and elements of none, each as one element.
struct UnitElements {
    elements: Vec<MotifElement>,
    /// The elements of each.
    members: Vec<Vec<(usize, Shift)>>,
}

impl UnitElements {
    /// The motifs come first.
    fn new(motifs: &[MotifLayout], elements: &[MotifElement], plane: MotifPlane) -> Self {
        let mut members: Vec<Vec<(usize, Shift)>> = motifs
            .iter()
            .map(|motif| motif.parts.iter().map(|part| (part.element, part.shift)).collect())
            .collect();
        let mut is_part = vec![false; elements.len()];
        members.iter().flatten().for_each(|member| is_part[member.0] = true);
        // Labels beyond those of elements.
        let first = elements.iter().map(|e| e.label + 1).max().unwrap_or(0);
        let mut labels = BTreeMap::new();
        let unit = |(motif, members): (&MotifLayout, &Vec<(usize, Shift)>)| {
            let count = labels.len();
            let label = first + *labels.entry(motif.composition()).or_insert(count);
            MotifElement { label, ..as_one(members, elements, plane) }
        };
        let mut units: Vec<MotifElement> = motifs.iter().zip(&members).map(unit).collect();
        for k in (0..elements.len()).filter(|k| !is_part[*k]) {
            units.push(elements[k].clone());
            members.push(vec![(k, [0; 2])]);
        }
        Self { elements: units, members }
    }
}

/// Elements as one.
fn as_one(members: &[(usize, Shift)], elements: &[MotifElement], plane: MotifPlane) -> MotifElement {
    let (first, shift) = members[0];
    let mut one = MotifElement {
        bounds: elements[first].bounds + plane.vector(shift),
        rings: Vec::new(),
        axis: None,
        is_free: true,
        ..elements[first].clone()
    };
    let mut sum = Vec2::ZERO;
    for &(k, shift) in members {
        let (own, by) = (&elements[k], plane.vector(shift));
        sum += own.centre.to_vec2() + by;
        one.bounds = one.bounds.union(own.bounds + by);
        one.rings.extend(own.rings.iter().map(|ring| ring.iter().map(|p| *p + by).collect::<Vec<Point>>()));
    }
    one.centre = (sum / members.len() as f64).to_point();
    let step = one.rings.iter().map(Vec::len).sum::<usize>().div_ceil(MOST_POINTS).max(1);
    for ring in one.rings.iter_mut().filter(|ring| ring.len() >= 3 * step) {
        *ring = ring.iter().step_by(step).copied().collect();
    }
    one
}

/// The motifs, joined where sets of them stand out; `None` if none do. `grouped` finds the sets of elements that
/// stand out.
///
/// # Errors
/// Those of `grouped`.
pub(super) fn joined(
    motifs: &[MotifLayout],
    elements: &[MotifElement],
    plane: MotifPlane,
    grouped: impl Fn(&[MotifElement]) -> Result<Vec<MotifLayout>>,
) -> Result<Option<Vec<MotifLayout>>> {
    if motifs.len() < COPIES * MOTIFS {
        return Ok(None);
    }
    let units = UnitElements::new(motifs, elements, plane);
    let mut sets = grouped(&units.elements)?;
    let count = |set: &MotifLayout| set.parts.iter().filter(|part| part.element < motifs.len()).count();
    let size =
        |set: &MotifLayout| set.parts.iter().map(|part| units.members[part.element].len()).sum::<usize>();
    sets.retain(|set| count(set) >= MOTIFS && size(set) <= MOST_PARTS);
    let mut copies: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    sets.iter().for_each(|set| *copies.entry(set.composition()).or_default() += 1);
    sets.retain(|set| copies[&set.composition()] >= COPIES);
    let in_sets: usize = sets.iter().map(count).sum();
    if (in_sets as f64) < SHARE * motifs.len() as f64 {
        return Ok(None);
    }
    let mut is_joined = vec![false; units.elements.len()];
    sets.iter().flat_map(|set| &set.parts).for_each(|part| is_joined[part.element] = true);
    let whole = |set: &MotifLayout| {
        let members = set.parts.iter().flat_map(|part| {
            units.members[part.element].iter().map(|(element, shift)| (*element, plus(*shift, part.shift)))
        });
        MotifLayout::new(&members.collect::<Vec<_>>(), elements, plane)
    };
    let alone =
        motifs.iter().zip(&is_joined).filter(|(_, is_joined)| !**is_joined).map(|(motif, _)| motif.clone());
    Ok(Some(sets.iter().map(whole).chain(alone).collect()))
}
