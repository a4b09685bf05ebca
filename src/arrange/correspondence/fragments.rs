//! Fragments: primaries cut along the pixels of them that arrived.
//!
//! Where islands meet, parts of primaries are left of which no whole one stands. Each is traced along
//! its pixels and painted as its primary is, beneath the whole ones around it, so that nothing shows
//! through between primaries that interlock.

use super::arrivals::{Arrival, Plan};
use super::holes::Hole;
use crate::arrange::grid::Grid;
use crate::arrange::model::{Model, VariantId};
use crate::geometry::{Affine, FittedMap, Outline, PlanarMap};
use crate::library::{self, Library, SourceKind};
use crate::parallel;
use crate::raster::{LabelMap, Mask, Span};
use crate::scene::{Element, ElementId, LibraryId, Shape, pixels};

/// How packed an exemplar is, from 0 to 1, in which fragments may touch other primaries.
const PACKED: f64 = 0.65;
/// Most of a fragment that lies on others, in an exemplar that is not.
const TOUCHING: f64 = 0.02;
/// Fewest pixels of a fragment that has details.
const DETAILED: u32 = 60;
/// Largest distance of an outline to the pixels, in cells.
const TOLERANCE: f64 = 0.5;
/// How far a detail reaches beneath those painted later, in pixels.
const BENEATH: f64 = 0.6;

/// A part of a primary where it is to stand.
pub(super) struct Fragment {
    /// The variant that it is a part of.
    pub(super) variant: VariantId,
    /// Place of that variant's origin on the map.
    pub(super) at: [i32; 2],
    /// Its pixels, relative to the origin.
    pub(super) mask: Mask,
    /// Pixels that nothing else fills.
    pub(super) fills: u32,
    /// What is painted, varied already.
    pub(super) painted: Element,
}

/// The fragments that close the holes of a plan. Where primaries hardly touch in the exemplar, none is
/// made that would touch another.
pub(super) fn find(
    holes: &[Hole],
    plan: &Plan<'_>,
    libraries: &[Library],
    model: &Model,
    cell: i32,
) -> Vec<Fragment> {
    let made = parallel::map(holes, |hole| {
        let a = &plan.arrivals[hole.arrival as usize];
        // Half a motif would be seen at once.
        if libraries[model.element(a.variant).library].source.kind == SourceKind::Drawing {
            return None;
        }
        let wide = widened(plan, &hole.mask, (cell / 2).max(1));
        if plan.packing(model, a.variant) < PACKED && touches(plan, &wide) > TOUCHING * f64::from(wide.area())
        {
            return None;
        }
        let found = fragment(a, &wide, libraries, model, plan.grid, f64::from(cell))?;
        Some(Fragment { fills: hole.mask.area(), ..found })
    });
    made.into_iter().flatten().collect()
}

/// Pixels of a mask on which primaries stand.
fn touches(plan: &Plan<'_>, mask: &Mask) -> f64 {
    let taken = |&(x, y): &(i32, i32)| plan.grid.cell([x, y]).is_some_and(|i| plan.is_taken(i));
    mask.pixels().filter(taken).count() as f64
}

/// A mask with the pixels around it on which primaries are wanted or stand.
fn widened(plan: &Plan<'_>, mask: &Mask, reach: i32) -> Mask {
    let grid = plan.grid;
    let mut spans = mask.spans().to_vec();
    for &Span { y, x0, x1 } in mask.spans() {
        for dy in -reach..=reach {
            let mut run = None;
            for x in x0 - reach..=x1 + reach {
                let there = grid.cell([x, y + dy]);
                let covered = x < x1 + reach && there.is_some_and(|i| plan.is_taken(i) || plan.is_wanted(i));
                match (run, covered) {
                    (None, true) => run = Some(x),
                    (Some(start), false) => {
                        spans.push(Span { y: y + dy, x0: start, x1: x });
                        run = None;
                    }
                    _ => {}
                }
            }
        }
    }
    Mask::from_spans(spans)
}

/// The part of an arrival that a mask of the map holds; none if nothing is left of it once traced.
fn fragment(
    a: &Arrival,
    mask: &Mask,
    libraries: &[Library],
    model: &Model,
    grid: &Grid,
    cell: f64,
) -> Option<Fragment> {
    let (x0, y0, x1, y1) = mask.bounds()?;
    // The place of the origin that is on the same side of seams.
    let middle = [(x0 + x1) / 2, (y0 + y1) / 2];
    let way = grid.offset(middle, a.at);
    let at = [middle[0] + way[0], middle[1] + way[1]];
    let known = model.element(a.variant);
    let primary = &libraries[known.library].primaries()[known.index as usize];
    let [a0, b0, c0, d0] = model.variation(a.variant).matrix;
    let [ox, oy] = primary.origin().map(f64::from);
    // From the exemplar to the place, relative to the origin.
    let to_place = Affine::new([a0, b0, c0, d0, 0.0, 0.0]) * Affine::translate((-ox, -oy));
    let own = mask.shifted(-at[0], -at[1]);

    let details = if mask.area() >= DETAILED { details_within(primary, &own, to_place) } else { Vec::new() };
    // A frame of a pixel around the box.
    let corner = [x0 - at[0] - 1, y0 - at[1] - 1];
    let mut labels = LabelMap::filled((x1 - x0 + 2) as u32, (y1 - y0 + 2) as u32, 0);
    labels.fill(&own.shifted(-corner[0], -corner[1]), 1);
    for (k, (_, pixels)) in details.iter().enumerate() {
        labels.fill(&pixels.shifted(-corner[0], -corner[1]), k as u32 + 2);
    }
    let count = details.len() + 1;
    let planar = PlanarMap::trace(labels.width, labels.height, &labels.labels);
    let fitted = FittedMap::new(planar, TOLERANCE * cell, count, 1, |label| label.min(1));
    let back = Affine::translate((f64::from(corner[0]), f64::from(corner[1])));
    let moved = |outline: &Outline| Outline::new(&(back * outline.path())).unwrap_or_default();
    let whole = moved(&fitted.outlines(1, |label| label.min(1))[1]);
    if whole.is_empty() {
        return None;
    }
    let painted = |shape: &Shape, outline: Outline| Shape {
        gradient: shape.gradient.as_ref().map(|g| Box::new(g.moved(to_place))),
        ..shape.with_outline(outline)
    };
    let patch = |(own, (detail, _)): (u32, &(&Shape, Mask))| {
        let stacked = fitted.stacked_outline(own, |other| if own < other { BENEATH } else { 0.0 });
        painted(detail, moved(&stacked))
    };
    let patches = (2..).zip(&details).map(patch).filter(|p| !p.outline.is_empty());
    let painted = Element {
        library: LibraryId(known.library as u32),
        source: Some(ElementId(known.index)),
        category: primary.category,
        fragment: true,
        silhouette: None,
        shapes: std::iter::once(painted(primary.base(), whole)).chain(patches).collect(),
    };
    Some(Fragment { variant: a.variant, at, mask: own, fills: 0, painted })
}

/// The details of a primary that show within a mask around its origin, each with its pixels there; of
/// overlapping ones the later has them.
fn details_within<'p>(
    primary: &'p library::Element,
    mask: &Mask,
    to_place: Affine,
) -> Vec<(&'p Shape, Mask)> {
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return Vec::new() };
    let mut shown = Vec::new();
    for detail in primary.details() {
        let Some(outline) = Outline::new(&(to_place * detail.outline.path())) else { continue };
        let b = outline.bounds();
        if b.x1 < f64::from(x0) || b.x0 > f64::from(x1) || b.y1 < f64::from(y0) || b.y0 > f64::from(y1) {
            continue;
        }
        let inside = pixels::mask(&outline);
        let spans: Vec<Span> = mask
            .pixels()
            .filter(|&(x, y)| inside.contains(x, y))
            .map(|(x, y)| Span { y, x0: x, x1: x + 1 })
            .collect();
        if !spans.is_empty() {
            shown.push((detail, Mask::from_spans(spans)));
        }
    }
    shown
}
