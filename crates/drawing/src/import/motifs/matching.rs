//! Copies of known motifs among the elements that are left: those that other elements come nearer to than
//! their own parts are to each other.

use super::features::MotifElement;
use super::kinds::{MotifKind, TOLERANCE};
use super::layout::{LaidPart, MotifLayout};
use super::tree::MotifPlane;
use std::cell::Cell;
use vtex_base::error::Result;
use vtex_base::geometry::{NearPoints, Point, rigid_map, shortest_offset};

/// Least number of copies of a kind that is looked for.
const COPIES: usize = 3;
/// Least tolerance of a part's place, as a share of the extent, and the factor of the largest deviation seen.
const PLACE: f64 = 0.05;
const DEVIATION: f64 = 1.3;
/// Most neighbours of an element that are tried as its partner.
const MOST_PARTNERS: usize = 48;

/// Most elements looked at in all: in a crowd the search ends early.
const MOST_LOOKED: u64 = 50_000_000;

/// The free elements that belong to no motif, and where they are.
struct LeftElements<'a> {
    elements: &'a [MotifElement],
    plane: MotifPlane,
    is_taken: &'a mut [bool],
    near: NearPoints,
    /// Elements that may still be looked at.
    left: &'a Cell<u64>,
}

/// Finds further copies of the kinds that `counts` says occur often; marks their elements as taken.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn further_copies(
    kinds: &[MotifKind],
    counts: &[usize],
    elements: &[MotifElement],
    plane: MotifPlane,
    is_taken: &mut [bool],
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<(usize, MotifLayout)>> {
    let mut wanted: Vec<usize> = (0..kinds.len()).filter(|&k| counts[k] >= COPIES).collect();
    // Those of many parts are found by chance least.
    wanted.sort_by_key(|&k| (std::cmp::Reverse(kinds[k].template.parts.len()), k));
    let mut found = Vec::new();
    let looks = Cell::new(MOST_LOOKED);
    let places: Vec<Point> = elements.iter().map(|e| e.centre).collect();
    for k in wanted {
        go_on()?;
        let template = &kinds[k].template;
        let directed = template.parts.iter().filter(|p| p.axis.is_some()).count();
        // Two discs are at any distance by chance.
        if template.parts.len() == 2 && directed < 2 {
            continue;
        }
        let deviation = (DEVIATION * kinds[k].residual).max(PLACE * template.extent);
        let tolerance = deviation.min(TOLERANCE * template.extent);
        let axes = [0, 1].map(|axis| plane.periods.map(|p| p[axis]));
        let near = NearPoints::new(&places, axes, 2.0 * template.extent + tolerance);
        let left = LeftElements { elements, plane, is_taken: &mut *is_taken, near, left: &looks };
        let (first, second) = template.base();
        for e in 0..elements.len() {
            if left.is_taken[e] || !elements[e].is_free || elements[e].label != template.parts[first].label {
                continue;
            }
            go_on()?;
            if looks.get() == 0 {
                return Ok(found);
            }
            if let Some(copy) = left.copy_at(e, template, [first, second], tolerance) {
                copy.parts.iter().for_each(|p| left.is_taken[p.element] = true);
                found.push((k, copy));
            }
        }
    }
    Ok(found)
}

impl MotifLayout {
    /// The two parts by which copies are looked for: furthest apart, so that the angle is exact.
    fn base(&self) -> (usize, usize) {
        let pairs = (0..self.parts.len()).flat_map(|a| (a + 1..self.parts.len()).map(move |b| (a, b)));
        let apart = |&(a, b): &(usize, usize)| self.parts[a].at.distance(self.parts[b].at);
        pairs.max_by(|p, q| apart(p).total_cmp(&apart(q))).unwrap_or((0, 0))
    }
}

impl LeftElements<'_> {
    /// A copy of a template of which element `e` is the first of the `base` parts.
    fn copy_at(
        &self,
        e: usize,
        template: &MotifLayout,
        base: [usize; 2],
        tolerance: f64,
    ) -> Option<MotifLayout> {
        let [first, second] = base.map(|k| template.parts[k]);
        let apart = first.at.distance(second.at);
        let mut partners = Vec::new();
        self.each_left(self.elements[e].centre, |part| {
            let distance = part.at.distance(self.elements[e].centre);
            let same =
                part.label == second.label && self.elements[part.element].layer == self.elements[e].layer;
            if part.element != e && same && (distance - apart).abs() <= 2.0 * tolerance {
                partners.push(part);
            }
        });
        partners.truncate(MOST_PARTNERS);
        let mut best: Option<(f64, MotifLayout)> = None;
        for partner in partners {
            for mirrored in [false, true] {
                let to = [self.elements[e].centre, partner.at];
                let map = rigid_map(&[first.at, second.at], &to, mirrored);
                let members: Option<Vec<LaidPart>> = template
                    .parts
                    .iter()
                    .map(|part| self.nearest_left(map * part.at, part.label, tolerance))
                    .collect();
                let Some(parts) = members else { continue };
                let members: Vec<_> = parts.iter().map(|p| (p.element, p.shift)).collect();
                let mut copy = MotifLayout::new(&members, self.elements, self.plane);
                let Some(found) = copy.as_copy_of(template, tolerance) else { continue };
                let mut elements: Vec<usize> = members.iter().map(|m| m.0).collect();
                elements.sort_unstable();
                elements.dedup();
                if elements.len() == members.len() && best.as_ref().is_none_or(|b| found.residual < b.0) {
                    copy.parts = found.order.iter().map(|&k| copy.parts[k]).collect();
                    best = Some((found.residual, copy));
                }
            }
        }
        best.map(|(_, copy)| copy)
    }

    /// Calls `f` with each free element near a place that is in no motif, as the copy nearest to the place.
    fn each_left(&self, at: Point, mut f: impl FnMut(LaidPart)) {
        let axes = [0, 1].map(|axis| self.plane.periods.map(|p| p[axis]));
        let wrapped = Point::new(
            vtex_base::geometry::wrapped(at.x, axes[0]),
            vtex_base::geometry::wrapped(at.y, axes[1]),
        );
        self.near.each_while(wrapped, |k| {
            let own = &self.elements[k];
            let left = self.left.get().saturating_sub(1);
            self.left.set(left);
            if left > 0 && !self.is_taken[k] && own.is_free {
                let place = at + shortest_offset(at, own.centre, axes);
                let by = place - own.centre;
                let shift = self
                    .plane
                    .periods
                    .map_or([0; 2], |[w, h]| [libm::round(by.x / w) as i32, libm::round(by.y / h) as i32]);
                f(LaidPart { element: k, shift, label: own.label, at: place, axis: own.axis });
            }
            left > 0
        });
    }

    fn nearest_left(&self, at: Point, label: usize, tolerance: f64) -> Option<LaidPart> {
        let mut best: Option<(f64, LaidPart)> = None;
        self.each_left(at, |part| {
            let distance = part.at.distance(at);
            if part.label == label
                && distance <= 2.0 * tolerance
                && best.as_ref().is_none_or(|b| distance < b.0)
            {
                best = Some((distance, part));
            }
        });
        best.map(|(_, part)| part)
    }
}
