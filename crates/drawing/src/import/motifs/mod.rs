//! Motifs: elements that belong together, found before any method of synthesis.
//!
//! Elements are joined pair by pair, the nearest outlines first ([`tree`]). A set stands out if the gap to all
//! others is larger than those within it. Sets that are copies of each other up to rotation and reflection
//! are one kind; what recurs needs to stand out less than what occurs once ([`kinds`]). Copies that other
//! elements come too near to are then found by the relative places of their parts ([`matching`]). The
//! author's small groups that recur come first. Then the same is done with the motifs: sets of them that stand out become
//! one motif ([`nested`]). Each element is a part of one motif or of none.
//!
//! Works badly for motifs that are no further from each other than their parts, and for parts of very
//! different looks that occur once.

mod features;
mod gaps;
mod kinds;
mod layout;
mod matching;
mod nested;
#[cfg(test)]
mod swatches;
#[cfg(test)]
mod tests;
mod tree;

use features::{MotifElement, features};
use kinds::choose;
use layout::MotifLayout;
use std::collections::BTreeMap;
use tree::MotifPlane;
use vtex_base::error::Result;
use vtex_scene::library::{ElementId, ExemplarElement, Motif, MotifGrouping, MotifPart};

/// Largest side of a motif, as a share of the page's.
const LARGEST: f64 = 0.55;
/// Largest gap that is looked at, in mean distances between elements.
const REACH: f64 = 1.0;
/// Gap below which differences do not count, in mean distances between elements.
const FINEST: f64 = 0.03;
/// Most elements of a group of the author that is a motif.
const MOST_IN_GROUP: usize = 16;
/// Least number of groups of the author that are alike.
const ALIKE_GROUPS: usize = 2;

/// The elements of a drawing, and what its author says of them.
pub(super) struct MotifSource<'a> {
    pub(super) elements: &'a [ExemplarElement],
    /// The layer of each element.
    pub(super) layers: &'a [usize],
    /// The author's innermost group of each element.
    pub(super) groups: &'a [Option<usize>],
    /// Whether each element runs on from copy to copy.
    pub(super) is_endless: &'a [bool],
    /// Width and height of the page, in pixels, and whether it repeats.
    pub(super) size: [f64; 2],
    pub(super) wrap: bool,
}

/// The motifs, in the order of their first elements.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn motifs(
    source: &MotifSource<'_>,
    how: MotifGrouping,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<Motif>> {
    if how == MotifGrouping::None || source.elements.len() < 2 {
        return Ok(Vec::new());
    }
    let largest = source.size.map(|side| LARGEST * side);
    let mut elements = features(source.elements, source.layers, source.is_endless, largest);
    go_on()?;
    // Gaps are looked at up to the mean distance between elements.
    let plane = |elements: &[MotifElement]| {
        let free = elements.iter().filter(|e| e.is_free).count();
        let reach = REACH * libm::sqrt(source.size[0] * source.size[1] / free.max(1) as f64);
        MotifPlane { periods: source.wrap.then_some(source.size), largest, reach }
    };
    let of_page = plane(&elements);
    let mut found: Vec<MotifLayout> = Vec::new();
    if how == MotifGrouping::Auto {
        found = author_groups(source, &elements, of_page);
        for part in found.iter().flat_map(|layout| &layout.parts) {
            elements[part.element].is_free = false;
        }
    }
    let contact_only = how == MotifGrouping::Contact;
    found.extend(grouped(&elements, of_page, contact_only, go_on)?);
    let of_units = |units: &[MotifElement]| grouped(units, plane(units), false, go_on);
    while !contact_only && let Some(joined) = nested::joined(&found, &elements, of_page, of_units)? {
        found = joined;
    }
    numbered(found, go_on)
}

/// The sets of elements that stand out, and further copies of those that recur.
///
/// # Errors
/// Those of `go_on`.
fn grouped(
    elements: &[MotifElement],
    plane: MotifPlane,
    contact_only: bool,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<MotifLayout>> {
    let gaps = gaps::gaps(elements, plane.periods, plane.reach, go_on)?;
    let nodes = tree::tree(elements, &gaps, plane);
    let finest = FINEST / REACH * plane.reach;
    let chosen = choose(&nodes, elements, plane, finest, contact_only, go_on)?;
    let mut found: Vec<MotifLayout> = chosen.motifs.iter().map(|(_, layout)| layout.clone()).collect();
    if !contact_only {
        let mut counts = vec![0; chosen.kinds.len()];
        chosen.motifs.iter().for_each(|(kind, _)| counts[*kind] += 1);
        let mut is_taken: Vec<bool> = elements.iter().map(|e| !e.is_free).collect();
        for part in found.iter().flat_map(|layout| &layout.parts) {
            is_taken[part.element] = true;
        }
        let further =
            matching::further_copies(&chosen.kinds, &counts, elements, plane, &mut is_taken, go_on)?;
        found.extend(further.into_iter().map(|(_, layout)| layout));
    }
    Ok(found)
}

/// The author's groups that are motifs: of few elements, small, and several of the same composition.
fn author_groups(source: &MotifSource<'_>, elements: &[MotifElement], plane: MotifPlane) -> Vec<MotifLayout> {
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, group) in source.groups.iter().enumerate() {
        if let Some(group) = group {
            members.entry(*group).or_default().push(k);
        }
    }
    let layout = |own: Vec<usize>| {
        let first = own[0];
        let sound = (2..=MOST_IN_GROUP).contains(&own.len())
            && own.iter().all(|&k| elements[k].is_free && elements[k].layer == elements[first].layer);
        // In a page that repeats, the copy of each that is nearest to the first.
        let near = |&k: &usize| {
            let apart = elements[first].centre - elements[k].centre;
            let shift = plane
                .periods
                .map_or([0; 2], |[w, h]| [libm::round(apart.x / w) as i32, libm::round(apart.y / h) as i32]);
            (k, shift)
        };
        let layout = MotifLayout::new(&own.iter().map(near).collect::<Vec<_>>(), elements, plane);
        (sound && 2.0 * layout.extent <= plane.largest[0].min(plane.largest[1])).then_some(layout)
    };
    let layouts: Vec<MotifLayout> = members.into_values().filter_map(layout).collect();
    let mut counts: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    layouts.iter().for_each(|l| *counts.entry(l.composition()).or_default() += 1);
    layouts.into_iter().filter(|l| counts[&l.composition()] >= ALIKE_GROUPS).collect()
}

/// Layouts as motifs: kinds are numbered in the order of the first elements, parts correspond to those of the
/// first copy.
fn numbered(mut layouts: Vec<MotifLayout>, go_on: &dyn Fn() -> Result<()>) -> Result<Vec<Motif>> {
    let first = |layout: &MotifLayout| layout.parts.iter().map(|p| p.element).min().unwrap_or(0);
    layouts.sort_by_key(first);
    let mut templates: Vec<MotifLayout> = Vec::new();
    let mut known: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let mut motifs = Vec::with_capacity(layouts.len());
    for layout in layouts {
        go_on()?;
        let kinds = known.entry(layout.composition()).or_default();
        let copy = kinds.iter().find_map(|&k| {
            let tolerance = kinds::TOLERANCE * templates[k].extent.min(layout.extent);
            layout.as_copy_of(&templates[k], tolerance).map(|found| (k, found.order))
        });
        let (kind, order) = copy.unwrap_or_else(|| {
            kinds.push(templates.len());
            (templates.len(), (0..layout.parts.len()).collect())
        });
        if kind == templates.len() {
            templates.push(layout.clone());
        }
        let part = |&k: &usize| {
            let own = &layout.parts[k];
            MotifPart { element: ElementId::after(own.element), periods: own.shift }
        };
        motifs.push(Motif { kind: kind as u32, parts: order.iter().map(part).collect() });
    }
    Ok(motifs)
}
