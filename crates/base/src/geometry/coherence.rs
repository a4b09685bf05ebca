//! Search by coherence: for each point of a result the point of an exemplar with the most similar neighbourhood, and
//! what the neighbourhoods so matched ask for.
//!
//! Candidates come from coherence (Ashikhmin 2001; Tong et al. 2002): where the sources of neighbours put a point, and
//! points of the exemplar with surroundings similar to the best of these. All points are searched at once from the
//! sources before, so the result does not depend on an order.

use super::dense::{DenseAssignment, NONE};
use super::displace::WantedWays;
use super::plane::{PeriodicPlane, PointIndex, Vicinity, length};
use crate::error::Result;
use crate::parallel;
use std::cmp::Reverse;

/// Candidates from neighbours, and similar points tried for the best of them.
const FROM_NEIGHBOURS: usize = 3;
const SIMILAR_TRIED: usize = 2;
/// Points searched as one piece of work, and pieces between two questions whether to go on.
const PIECE: usize = 32;
const PIECES: usize = 32;
/// Share of the neighbourhoods around a place that must miss a point there.
const MAJORITY: f64 = 0.5;

/// The points among which sources are sought.
#[derive(Clone, Copy, Debug)]
pub struct SourcePoints<'a> {
    /// The plane of the exemplar.
    pub plane: PeriodicPlane,
    /// Their places.
    pub points: &'a [[f64; 2]],
    /// The points by place.
    pub index: &'a PointIndex,
    /// The neighbourhood of each.
    pub near: &'a Vicinity,
    /// Mean distance between adjacent points.
    pub distance: f64,
}

/// Compares neighbourhoods, with work space of its own.
pub trait CompareNeighbourhoods {
    /// The distance of the neighbourhoods of `point` and `source`, if it is less than `bound`; the matches of the
    /// neighbours are then in the assignment.
    fn distance(&mut self, point: usize, source: u32, bound: f64) -> Option<f64>;

    /// The assignment that was solved last.
    fn assignment(&self) -> &DenseAssignment;

    /// Points of the exemplar with surroundings similar to those of `source`, the most similar first.
    fn similar(&self, source: u32) -> &[u32];

    /// Number of points whose costs make the distance of the neighbourhood of `point`.
    fn compared(&self, point: usize) -> usize;
}

/// Neighbourhoods of a result, and the points of the exemplar that they are matched with.
#[derive(Debug)]
pub struct NeighbourhoodMatches {
    /// The neighbourhood of each point.
    pub near: Vicinity,
    /// For each listed neighbour its match, or [`NONE`].
    pub matched: Vec<u32>,
    /// Distance of each neighbourhood to its match.
    pub cost: Vec<f64>,
}

/// A point that the neighbourhood of another misses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissedPoint {
    /// Its place on the result.
    pub at: [f64; 2],
    /// The point of the exemplar that it would come from.
    pub source: u32,
}

/// A search, all but what is compared.
struct CoherenceSearch<'a> {
    from: SourcePoints<'a>,
    near: &'a Vicinity,
    source: &'a [u32],
    /// Neighbours whose sources are asked.
    asked: usize,
}

impl CoherenceSearch<'_> {
    /// The best source of a point, its distance, and the matches of the neighbours.
    fn best(&self, compare: &mut impl CompareNeighbourhoods, point: usize) -> (u32, f64, Vec<u32>) {
        let mut candidates = self.candidates(point);
        let mut best = (self.source[point], f64::INFINITY, Vec::new());
        let (mut tried, mut extended) = (0, false);
        let scale = compare.compared(point) as f64;
        while tried < candidates.len() {
            let source = candidates[tried];
            if let Some(found) = compare.distance(point, source, best.1) {
                let ids = &self.from.near.ids[self.from.near.range(source as usize)];
                let of = |c: &u32| if *c == NONE { NONE } else { ids[*c as usize] };
                best = (source, found, compare.assignment().of_row().iter().map(of).collect());
            }
            tried += 1;
            // As good as a copy.
            if best.1 <= 0.01 * self.from.distance * scale {
                break;
            }
            if tried == candidates.len() && !extended && best.1 > 0.05 * self.from.distance * scale {
                extended = true;
                for &similar in compare.similar(best.0).iter().take(SIMILAR_TRIED) {
                    if !candidates.contains(&similar) {
                        candidates.push(similar);
                    }
                }
            }
        }
        // Without any finite distance nothing is matched.
        best.2.resize(self.near.range(point).len(), NONE);
        best
    }

    /// The source so far, and where the sources of neighbours put the point.
    fn candidates(&self, point: usize) -> Vec<u32> {
        let mut votes: Vec<(u32, u32)> = Vec::new();
        for k in self.near.range(point).take(self.asked) {
            let from = self.from.points[self.source[self.near.ids[k] as usize] as usize];
            let way = self.near.ways[k];
            let at = [from[0] - way[0], from[1] - way[1]];
            if let Some((found, _)) = self.from.index.nearest(at, 0.75 * self.from.distance) {
                match votes.iter_mut().find(|v| v.1 == found as u32) {
                    Some(vote) => vote.0 += 1,
                    None => votes.push((1, found as u32)),
                }
            }
        }
        votes.sort_by_key(|&(count, id)| (Reverse(count), id));
        let own = self.source[point];
        let mut all = vec![own];
        all.extend(votes.iter().map(|v| v.1).filter(|v| *v != own).take(FROM_NEIGHBOURS));
        all
    }
}

/// The sources of the points of a result.
#[derive(Debug)]
pub struct FoundSources {
    /// The source of each point.
    pub source: Vec<u32>,
    /// For each listed neighbour its match, or [`NONE`].
    pub matched: Vec<u32>,
    /// Distance of each neighbourhood to its match.
    pub cost: Vec<f64>,
}

/// Searches the sources of all points, whose neighbourhoods are `near`, from the sources before. The sources of `asked`
/// neighbours say where a point may come from. `compare` gives a comparison for each piece of work; `go_on` is asked in
/// between.
///
/// # Errors
/// Those of `go_on`.
pub fn search<C: CompareNeighbourhoods>(
    from: SourcePoints<'_>,
    near: &Vicinity,
    (source, asked): (&[u32], usize),
    compare: impl Fn() -> C + Sync,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<FoundSources> {
    let search = CoherenceSearch { from, near, source, asked };
    let pieces: Vec<usize> = (0..source.len()).step_by(PIECE).collect();
    let (of_points, of_neighbours) = (source.len(), near.ids.len());
    let mut found = FoundSources {
        source: Vec::with_capacity(of_points),
        matched: Vec::with_capacity(of_neighbours),
        cost: Vec::with_capacity(of_points),
    };
    for pieces in pieces.chunks(PIECES) {
        let of_piece = |&first: &usize| {
            let mut compare = compare();
            let points = first..(first + PIECE).min(source.len());
            points.map(|point| search.best(&mut compare, point)).collect::<Vec<_>>()
        };
        for (best, distance, of) in parallel::map(pieces, of_piece).into_iter().flatten() {
            found.source.push(best);
            found.cost.push(distance);
            found.matched.extend(of);
        }
        go_on()?;
    }
    Ok(found)
}

impl NeighbourhoodMatches {
    /// Sum of the distances, for each neighbourhood and each point in one.
    pub fn energy(&self) -> f64 {
        let points = self.matched.len() + self.cost.len();
        self.cost.iter().sum::<f64>() / points.max(1) as f64
    }

    /// The changes of ways that neighbourhoods want: each matched pair asks for the way between its matches. `source` is
    /// that of each point; `adapted` is what counts of the change that the neighbourhood of a point wants of the way to
    /// another; `also` adds what else point i wants.
    pub fn wanted_ways(
        &self,
        source: &[u32],
        from: SourcePoints<'_>,
        adapted: impl Fn(usize, u32, [f64; 2]) -> [f64; 2],
        also: impl Fn(usize, &mut WantedWays),
    ) -> WantedWays {
        let near = &self.near;
        let mut ways = WantedWays::new(near.len());
        for s in 0..near.len() {
            ways.next_point();
            let own = from.points[source[s] as usize];
            for k in near.range(s).filter(|&k| self.matched[k] != NONE) {
                let way = near.ways[k];
                let wanted = from.plane.between(own, from.points[self.matched[k] as usize]);
                let change = [wanted[0] - way[0], wanted[1] - way[1]];
                ways.add(near.ids[k], adapted(s, near.ids[k], change));
            }
            also(s, &mut ways);
        }
        ways
    }
}

/// A place where most neighbourhoods miss a point.
#[derive(Clone, Debug, PartialEq)]
pub struct MissedGroup {
    /// The mean of the places.
    pub at: [f64; 2],
    /// The point of the exemplar that the commonest place would come from.
    pub source: u32,
    /// The missed points that make it, in their order.
    pub members: Vec<usize>,
}

/// The points of a result, by place and kind.
pub struct StandingPoints<'a, A, S> {
    /// The plane of the result.
    pub plane: PeriodicPlane,
    /// Their places.
    pub points: &'a [[f64; 2]],
    /// Whether two points of the exemplar are of one kind.
    pub alike: A,
    /// Whether a point of the result is of the kind of a point of the exemplar.
    pub is_of_kind: S,
}

impl<A: Fn(u32, u32) -> bool + Sync, S: Fn(usize, u32) -> bool + Sync> StandingPoints<'_, A, S> {
    /// Where most of the neighbourhoods within `rim` of a place miss a point of one kind (algorithm 1 of *Continuous
    /// Curve Textures*): the commonest first, none beside another or beside a point that stands there already.
    pub fn missed(&self, missed: &[MissedPoint], distance: f64, rim: f64) -> Vec<MissedGroup> {
        if missed.is_empty() {
            return Vec::new();
        }
        let places: Vec<[f64; 2]> = missed.iter().map(|m| m.at).collect();
        let index = PointIndex::new(self.plane, 0.5 * distance, &places);
        let standing = PointIndex::new(self.plane, rim, self.points);
        let together = |m: usize| {
            let mut group = Vec::new();
            index.within(places[m], 0.5 * distance, |k, way| {
                if (self.alike)(missed[k].source, missed[m].source) {
                    group.push((k, way));
                }
            });
            group.sort_by_key(|g| g.0);
            group
        };
        let counted: Vec<usize> = (0..missed.len()).collect();
        let counts = parallel::map(&counted, |&m| together(m).len());
        let mut order = counted;
        order.sort_by_key(|&m| (Reverse(counts[m]), m));
        let mut taken = vec![false; missed.len()];
        let mut added: Vec<MissedGroup> = Vec::new();
        for m in order {
            if taken[m] {
                continue;
            }
            let (source, group) = (missed[m].source, together(m));
            group.iter().for_each(|g| taken[g.0] = true);
            let (mut around, mut occupied) = (0u32, false);
            standing.within(places[m], rim, |s, way| {
                around += 1;
                occupied |= length(way) < 0.5 * distance && (self.is_of_kind)(s, source);
            });
            let is_close = |other: &MissedGroup| {
                (self.alike)(other.source, source)
                    && length(self.plane.between(other.at, places[m])) < 0.7 * distance
            };
            if occupied || (group.len() as f64) <= MAJORITY * f64::from(around) || added.iter().any(is_close)
            {
                continue;
            }
            let part = 1.0 / group.len() as f64;
            let off = group.iter().fold([0.0; 2], |sum, (_, w)| [sum[0] + part * w[0], sum[1] + part * w[1]]);
            let at = [places[m][0] + off[0], places[m][1] + off[1]];
            added.push(MissedGroup { at, source, members: group.into_iter().map(|g| g.0).collect() });
        }
        added
    }
}
