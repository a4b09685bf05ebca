//! Shape energy: how far a cluster is from the element of the exemplar that it resembles most (equations 14 to 17).

use crate::input::InputSamples;
use crate::output::OutputSamples;
use vtex_base::geometry::assign::{Table, assign};
use vtex_base::geometry::dense::{DenseAssignment, NONE};
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};

/// Elements of the exemplar compared with a cluster, at most: those that most of its samples are matched with.
const COMPARED: usize = 4;
/// Clusters of more samples are compared in a sparse table.
const DENSE: usize = 64;
/// Steps of costs in a sparse table, for each sample distance.
const STEPS: f64 = 1e5;

/// Difference of energies that counts, and a safe distance from what only rounding changes.
const LEAST: f64 = 1e-12;
const CLOSE: f64 = 1e-9;

/// A cluster compared with the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShapeMatch {
    /// The energy: mean distances in units of twice the sample distance, and one for each sample too few or too many.
    pub(crate) energy: f64,
    /// The place of the exemplar whose element is the nearest.
    pub(crate) place: u32,
    /// Where the reference point of the element comes to lie.
    pub(crate) by: [f64; 2],
}

/// Work space of comparisons, and what was done in it.
#[derive(Default)]
pub(crate) struct ClusterWork {
    assignment: DenseAssignment,
    /// Distances of samples measured and compared for shapes, and pairs of samples looked at for links.
    pub(crate) steps: u64,
}

/// The nearest element for a cluster; `None` for a cluster without samples, and where no candidate is `allowed`.
pub(crate) fn shape_match(
    output: &OutputSamples,
    input: &InputSamples,
    members: &[u32],
    allowed: impl Fn(u32) -> bool,
    work: &mut ClusterWork,
) -> Option<ShapeMatch> {
    shape_match_below(output, input, members, (allowed, f64::INFINITY), work)
}

/// As [`shape_match`], for a caller that needs an energy below `bound` only: elements whose numbers of samples differ too
/// much from the cluster's for that are not compared.
pub(crate) fn shape_match_below(
    output: &OutputSamples,
    input: &InputSamples,
    members: &[u32],
    (allowed, bound): (impl Fn(u32) -> bool, f64),
    work: &mut ClusterWork,
) -> Option<ShapeMatch> {
    let points = output.unwrapped(members);
    let origin = *points.first()?;
    let mut places: Vec<(u32, u32, [f64; 2])> = Vec::new();
    for (s, p) in members.iter().zip(&points) {
        let source = output.source[*s as usize];
        let place = input.place[source as usize];
        // Where the cluster's origin lies from the element's first sample, if the source is right.
        let anchor = input.points[input.first[place as usize] as usize];
        let within = input.plane.between(anchor, input.points[source as usize]);
        let by = [p[0] - within[0], p[1] - within[1]];
        match places.iter_mut().find(|known| known.0 == place) {
            Some((_, count, sum)) => {
                *count += 1;
                (0..2).for_each(|k| sum[k] += by[k] - origin[k]);
            }
            None => places.push((place, 1, [by[0] - origin[0], by[1] - origin[1]])),
        }
    }
    places.retain(|p| allowed(p.0));
    places.sort_by_key(|p| (std::cmp::Reverse(p.1), p.0));
    let mut best: Option<ShapeMatch> = None;
    for (place, count, sum) in places.into_iter().take(COMPARED) {
        let figure = &input.of_figure[input.figure[place as usize] as usize];
        let limit = |best: Option<ShapeMatch>| best.map_or(bound, |b| b.energy.min(bound)) + CLOSE;
        if figure.len().abs_diff(points.len()) as f64 >= limit(best) {
            continue;
        }
        let part = 1.0 / f64::from(count);
        // The first sample of the figure lies at its own offset from the reference point.
        let mut by: [f64; 2] = std::array::from_fn(|k| origin[k] + part * sum[k] - figure[0][k]);
        // The translation of the matched samples, improved once by that of the assignment.
        for refined in [false, true] {
            let limit = if refined { limit(best) } else { f64::INFINITY };
            let (placed, distance) = (Placed { figure, by }, input.scale.distance);
            let Some((energy, shift)) = compared(placed, &points, (distance, limit), work) else { break };
            if best.is_none_or(|b| energy < b.energy - LEAST) {
                best = Some(ShapeMatch { energy, place, by });
            }
            if refined || length(shift) < 1e-9 {
                break;
            }
            by = [by[0] + shift[0], by[1] + shift[1]];
        }
    }
    best
}

/// The samples of a figure, moved.
struct Placed<'a> {
    figure: &'a [[f64; 2]],
    by: [f64; 2],
}

/// The distance of a figure at a place from the points of a cluster, and the mean way from its samples to theirs. No
/// distance counts more than four sample distances. `None` if the energy is certainly not below `limit`.
fn compared(
    Placed { figure, by }: Placed<'_>,
    points: &[[f64; 2]],
    (distance, limit): (f64, f64),
    work: &mut ClusterWork,
) -> Option<(f64, [f64; 2])> {
    let placed: Vec<[f64; 2]> = figure.iter().map(|p| [p[0] + by[0], p[1] + by[1]]).collect();
    let turned = placed.len() > points.len();
    let (rows, columns) = if turned { (points, &placed[..]) } else { (&placed[..], points) };
    let most = 4.0 * distance;
    let way = |a: &[f64; 2], b: &[f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let energy = |sum: f64| sum / (2.0 * distance) + (columns.len() - rows.len()) as f64;
    work.steps += rows.len() as u64 * columns.len() as u64;
    let of: Vec<Option<u32>> = if columns.len() <= DENSE {
        let ClusterWork { assignment, steps } = work;
        assignment.begin(columns.len(), most);
        let row = |_, r| assignment.row(columns.iter().map(|c| length(way(r, c))));
        if energy(rows.iter().fold(0.0, row)) >= limit {
            return None;
        }
        let before = assignment.entries;
        assignment.solve();
        *steps += assignment.entries - before;
        assignment.of_row().iter().map(|c| (*c != NONE).then_some(*c)).collect()
    } else {
        let whole = PeriodicPlane { size: [1.0; 2], wraps: [false; 2] };
        let low = [0, 1].map(|k| columns.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| columns.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max));
        let plane = PeriodicPlane { size: [0, 1].map(|k| (high[k] - low[k]).max(most)), ..whole };
        let moved = |p: &[f64; 2]| [p[0] - low[0], p[1] - low[1]];
        let at: Vec<[f64; 2]> = columns.iter().map(moved).collect();
        let index = PointIndex::new(plane, most, &at);
        let entries = |r: &[f64; 2]| {
            let mut near = Vec::new();
            index.within(moved(r), most, |c, way| {
                near.push((c as u32, (length(way) / distance * STEPS) as i64))
            });
            near.sort_unstable();
            near
        };
        let none = (4.0 * STEPS) as i64;
        let table: Vec<Vec<(u32, i64)>> = rows.iter().map(entries).collect();
        let least: i64 = table.iter().map(|row| row.iter().map(|e| e.1).fold(none, i64::min)).sum();
        if energy(least as f64 / STEPS * distance) >= limit {
            return None;
        }
        assign(&Table::new(table), columns.len(), none)
    };
    let (mut sum, mut shift, mut matched) = (0.0, [0.0; 2], 0u32);
    for (r, c) in rows.iter().zip(&of) {
        match c {
            Some(c) => {
                let way = way(r, &columns[*c as usize]);
                sum += length(way);
                matched += 1;
                (0..2).for_each(|k| shift[k] += if turned { -way[k] } else { way[k] });
            }
            None => sum += most,
        }
    }
    Some((energy(sum), shift.map(|v| v / f64::from(matched.max(1)))))
}
