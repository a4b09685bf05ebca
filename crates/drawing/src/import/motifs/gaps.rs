//! Distances between the outlines of neighbouring elements, on a plane or a torus.

use super::features::MotifElement;
use crate::import::offsets::{Shift, minus};
use std::collections::BTreeMap;
use std::ops::Range;
use vtex_base::error::Result;
use vtex_base::geometry::{NearPoints, Point, Rect, Vec2, inside, nearest, shortest_offset};
use vtex_base::parallel;

/// Distance of the places of an outline at which neighbours are looked for, as a share of the reach.
const STEP: f64 = 0.5;
/// Most places of one element.
const MOST_PLACES: usize = 64;
/// Most neighbours of one element, nearest boxes first.
const MOST_NEIGHBOURS: usize = 12;
/// Most places looked at around a place: in a crowd, elements beyond are not measured.
const MOST_LOOKED: usize = 1024;
/// Elements measured at a time.
const AT_ONCE: usize = 512;

/// Two elements and the distance of their outlines.
#[derive(Clone, Copy)]
pub(super) struct ElementGap {
    /// In pixels; 0 where they touch or one contains the other.
    pub(super) distance: f64,
    pub(super) a: usize,
    pub(super) b: usize,
    /// Periods by which `b` is moved to be near `a`.
    pub(super) shift: Shift,
}

/// The gaps of at most `reach` between free elements of one layer, the smallest first.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn gaps(
    elements: &[MotifElement],
    periods: Option<[f64; 2]>,
    reach: f64,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<ElementGap>> {
    let (mut places, mut owners) = (Vec::new(), Vec::new());
    for (k, element) in elements.iter().enumerate().filter(|(_, e)| e.is_free) {
        let before = places.len();
        places_of(element, STEP * reach, &mut places);
        owners.extend(std::iter::repeat_n(k, places.len() - before));
    }
    let axes = [0, 1].map(|k| periods.map(|p| p[k]));
    let index = NearPoints::new(&places, axes, (1.0 + STEP) * reach);
    go_on()?;
    let search =
        GapSearch { elements, periods, reach, places: &places, owners: &owners, axes, index: &index };
    let mut runs = Vec::new();
    let mut first = 0;
    for run in owners.chunk_by(|a, b| a == b) {
        runs.push(first..first + run.len());
        first += run.len();
    }
    let mut pairs = Vec::new();
    for chunk in runs.chunks(AT_ONCE) {
        go_on()?;
        pairs.extend(parallel::map(chunk, |run| search.neighbours(run.clone())).into_iter().flatten());
    }
    // Both members may list a pair.
    pairs.sort_unstable();
    pairs.dedup();
    let mut found = Vec::new();
    for chunk in pairs.chunks(AT_ONCE) {
        go_on()?;
        found.extend(parallel::map(chunk, |pair| search.gap(*pair)).into_iter().flatten());
    }
    found.sort_by(|p: &ElementGap, q| {
        p.distance.total_cmp(&q.distance).then((p.a, p.b, p.shift).cmp(&(q.a, q.b, q.shift)))
    });
    Ok(found)
}

/// Places along the outlines of an element, at most `step` apart.
fn places_of(element: &MotifElement, step: f64, places: &mut Vec<Point>) {
    let length = |ring: &[Point]| -> f64 {
        (0..ring.len()).map(|i| ring[i].distance(ring[(i + 1) % ring.len()])).sum()
    };
    let total: f64 = element.rings.iter().map(|ring| length(ring)).sum();
    let step = step.max(total / MOST_PLACES as f64);
    for ring in &element.rings {
        let mut left = 0.0;
        for i in 0..ring.len() {
            let (p, q) = (ring[i], ring[(i + 1) % ring.len()]);
            let side = p.distance(q);
            while left < side {
                places.push(p.lerp(q, left / side));
                left += step;
            }
            left -= side;
        }
    }
}

struct GapSearch<'a> {
    elements: &'a [MotifElement],
    periods: Option<[f64; 2]>,
    reach: f64,
    places: &'a [Point],
    owners: &'a [usize],
    axes: [Option<f64>; 2],
    index: &'a NearPoints,
}

impl GapSearch<'_> {
    /// The pairs of an element, with its range of places, and its nearest neighbours: lower member, higher
    /// member, periods by which the second is moved.
    fn neighbours(&self, own: Range<usize>) -> Vec<(usize, usize, Shift)> {
        let a = self.owners[own.start];
        let most = (1.0 + STEP) * self.reach;
        // Least distance of two places, by neighbour.
        let mut near: BTreeMap<(usize, Shift), f64> = BTreeMap::new();
        for p in self.places[own].iter().copied() {
            let mut left = MOST_LOOKED;
            self.index.each_while(p, |k| {
                let b = self.owners[k];
                left -= 1;
                if b != a && self.elements[b].layer == self.elements[a].layer {
                    let q = self.places[k];
                    let offset = shortest_offset(p, q, self.axes);
                    let distance = offset.hypot();
                    if distance <= most {
                        let shift = self.periods.map_or([0; 2], |[w, h]| {
                            let moved = p + offset - q;
                            [libm::round(moved.x / w) as i32, libm::round(moved.y / h) as i32]
                        });
                        let known = near.entry((b, shift)).or_insert(distance);
                        *known = known.min(distance);
                    }
                }
                left > 0
            });
        }
        let mut near: Vec<(f64, usize, Shift)> = near.into_iter().map(|((b, s), d)| (d, b, s)).collect();
        near.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
        near.truncate(MOST_NEIGHBOURS);
        let pair =
            |(_, b, shift): (f64, usize, Shift)| if a < b { (a, b, shift) } else { (b, a, minus(shift)) };
        near.into_iter().map(pair).collect()
    }

    /// The gap of a pair; `None` beyond the reach.
    fn gap(&self, (a, b, shift): (usize, usize, Shift)) -> Option<ElementGap> {
        let [w, h] = self.periods.unwrap_or_default();
        let by = Vec2::new(f64::from(shift[0]) * w, f64::from(shift[1]) * h);
        Some(ElementGap { distance: self.distance(a, b, by)?, a, b, shift })
    }

    /// The distance of two outlines, the second moved; `None` beyond the reach.
    fn distance(&self, a: usize, b: usize, by: Vec2) -> Option<f64> {
        let (first, second) = (&self.elements[a], &self.elements[b]);
        if apart(first.bounds, second.bounds + by) > self.reach {
            return None;
        }
        let holds = |outer: &MotifElement, p: Point| outer.rings.iter().any(|ring| inside(ring, p));
        let start = |own: &MotifElement| own.rings[0][0];
        let within = holds(first, start(second) + by) || holds(second, start(first) - by);
        if within || first.bounds.overlaps(second.bounds + by) && cross(first, second, by) {
            return Some(0.0);
        }
        let mut least = f64::INFINITY;
        for (own, other, by) in [(first, second, -by), (second, first, by)] {
            // Points of `own`, in the frame of `other`.
            for p in own.rings.iter().flatten().map(|p| *p + by) {
                if box_distance(other.bounds, p) < least {
                    for ring in &other.rings {
                        least = least.min(nearest(ring, p).distance(p));
                    }
                }
            }
        }
        (least <= self.reach).then_some(least)
    }
}

/// Whether the outlines of two elements cross, the second moved.
fn cross(first: &MotifElement, second: &MotifElement, by: Vec2) -> bool {
    let sides = |own: &MotifElement, by: Vec2| -> Vec<[Point; 2]> {
        let of = |ring: &Vec<Point>| -> Vec<[Point; 2]> {
            (0..ring.len()).map(|i| [ring[i] + by, ring[(i + 1) % ring.len()] + by]).collect()
        };
        own.rings.iter().flat_map(of).collect()
    };
    let others = sides(second, by);
    let side_of = |[p, q]: [Point; 2], r: Point| (q - p).cross(r - p) > 0.0;
    let parted = |s: [Point; 2], t: [Point; 2]| side_of(s, t[0]) != side_of(s, t[1]);
    sides(first, Vec2::ZERO).iter().any(|&s| others.iter().any(|&t| parted(s, t) && parted(t, s)))
}

/// Distance of two boxes.
fn apart(a: Rect, b: Rect) -> f64 {
    let along = |a0: f64, a1: f64, b0: f64, b1: f64| (b0 - a1).max(a0 - b1).max(0.0);
    libm::hypot(along(a.x0, a.x1, b.x0, b.x1), along(a.y0, a.y1, b.y0, b.y1))
}

/// Distance of a point from a box.
fn box_distance(b: Rect, p: Point) -> f64 {
    let along = |low: f64, high: f64, v: f64| (low - v).max(v - high).max(0.0);
    libm::hypot(along(b.x0, b.x1, p.x), along(b.y0, b.y1, p.y))
}
