//! Groups of primaries with the same arrangement as in the exemplar, and copies of such groups.
//!
//! Placement by correspondences copies neighbours together, and a repeated group is the most conspicuous
//! fault of a large texture.

use super::{Centre, Layout};
use crate::element::ElementId;
use crate::scene::LibraryId;
use serde::Serialize;
use std::collections::BTreeMap;
use vtex_base::geometry::{NearPoints, Point, shortest_offset};
use vtex_base::parallel;

/// Neighbours that are compared.
const NEIGHBOURS: usize = 5;
/// Largest difference of two offsets that are the same, along each axis, in pixels.
const SAME: f64 = 1.5;
/// Most primaries that two copies may share without being noticed.
const UNSEEN: usize = 6;
/// Number of places along each axis at which windows are tested.
const WINDOWS: usize = 16;

/// Groups with the same arrangement as in the exemplar, and the distances of their copies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Groups {
    /// Share of the primaries placed whose five nearest neighbours are those of the exemplar, at the
    /// same offsets, 0 to 1.
    pub kept: f64,
    /// Number of primaries of the largest connected group of these.
    pub largest: usize,
    /// Pairs of groups that have more than six primaries in common.
    pub copies: usize,
    /// Shortest distance between two such copies, in pixels.
    pub shortest: Option<f64>,
    /// Share of the windows of the exemplar's size in which more than six primaries of one group occur twice,
    /// 0 to 1.
    pub windows: f64,
}

/// A primary placed.
#[derive(Clone, Copy)]
struct PlacedPrimary {
    centre: Centre,
    /// Offset from its place in the exemplar to its place on the canvas, in pixels.
    offset: Point,
}

impl Groups {
    /// Finds the groups in a scene's layout; `exemplars` are the layouts of its libraries.
    pub fn new(layout: &Layout, exemplars: &[Layout]) -> Self {
        let known: Vec<BTreeMap<ElementId, (Point, Vec<ElementId>)>> =
            exemplars.iter().map(surroundings).collect();
        let placed: Vec<PlacedPrimary> = layout
            .centres
            .iter()
            .filter_map(|&centre| {
                let (there, _) = known.get(centre.library.index())?.get(&centre.source)?;
                Some(PlacedPrimary {
                    centre,
                    offset: Point::new(centre.at[0] - there.x, centre.at[1] - there.y),
                })
            })
            .collect();
        if placed.is_empty() {
            return Self::default();
        }
        let period = layout.period();
        let near = nearest(&placed.iter().map(|p| p.centre.at).collect::<Vec<_>>(), period, layout.size);
        let tied = |a: &PlacedPrimary, b: &PlacedPrimary| {
            let apart = shortest_offset(a.offset, b.offset, period);
            a.centre.library == b.centre.library && apart.x.abs() <= SAME && apart.y.abs() <= SAME
        };
        let kept: Vec<bool> = (0..placed.len())
            .map(|i| {
                let (own, others) = (&placed[i], &near[i]);
                let wanted = &known[own.centre.library.index()][&own.centre.source].1;
                others.len() == NEIGHBOURS
                    && others.iter().all(|&j| {
                        tied(own, &placed[j as usize]) && wanted.contains(&placed[j as usize].centre.source)
                    })
            })
            .collect();
        let groups = connected(&near, |i, j| kept[i] && kept[j] && tied(&placed[i], &placed[j]));
        let groups: Vec<Vec<u32>> = groups.into_iter().filter(|g| kept[g[0] as usize]).collect();
        let pairs = copies(&groups, &placed);
        let distance = |pair: &Vec<[u32; 2]>| {
            let [a, b] = pair[0].map(|i| placed[i as usize].offset);
            shortest_offset(a, b, period).hypot()
        };
        let count = kept.iter().filter(|k| **k).count();
        Self {
            kept: count as f64 / placed.len() as f64,
            largest: groups.iter().map(Vec::len).max().unwrap_or(0),
            copies: pairs.len(),
            shortest: pairs.iter().map(distance).reduce(f64::min),
            windows: windows(&pairs, &placed, layout, exemplars),
        }
    }
}

/// For each primary of an exemplar its centre and its nearest neighbours.
fn surroundings(exemplar: &Layout) -> BTreeMap<ElementId, (Point, Vec<ElementId>)> {
    let places: Vec<[f64; 2]> = exemplar.centres.iter().map(|c| c.at).collect();
    let near = nearest(&places, exemplar.period(), exemplar.size);
    let sources = |list: &[u32]| list.iter().map(|&j| exemplar.centres[j as usize].source).collect();
    let entry =
        |(c, list): (&Centre, &Vec<u32>)| (c.source, (Point::from((c.at[0], c.at[1])), sources(list)));
    exemplar.centres.iter().zip(&near).map(entry).collect()
}

/// The nearest neighbours of every place, the nearest first.
fn nearest(places: &[[f64; 2]], period: [Option<f64>; 2], size: [f64; 2]) -> Vec<Vec<u32>> {
    let points: Vec<Point> = places.iter().map(|p| Point::new(p[0], p[1])).collect();
    let typical = libm::sqrt(size[0] * size[1] / points.len().max(1) as f64).max(1.0);
    let near = NearPoints::new(&points, period, 4.0 * typical);
    let all: Vec<usize> = (0..points.len()).collect();
    parallel::map(&all, |&i| {
        let mut found: Vec<(f64, u32)> = Vec::new();
        near.each(points[i], |j| {
            if j != i {
                found.push((shortest_offset(points[i], points[j], period).hypot2(), j as u32));
            }
        });
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.truncate(NEIGHBOURS);
        found.into_iter().map(|f| f.1).collect()
    })
}

/// Sets of places connected by neighbours that are joined, each in order.
fn connected(near: &[Vec<u32>], joined: impl Fn(usize, usize) -> bool) -> Vec<Vec<u32>> {
    let mut links: Vec<Vec<u32>> = vec![Vec::new(); near.len()];
    for (i, list) in near.iter().enumerate() {
        for &j in list.iter().filter(|&&j| joined(i, j as usize)) {
            links[i].push(j);
            links[j as usize].push(i as u32);
        }
    }
    let mut seen = vec![false; near.len()];
    let mut groups = Vec::new();
    for first in 0..near.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let (mut group, mut next) = (vec![first as u32], 0);
        while let Some(&i) = group.get(next) {
            for &j in &links[i as usize] {
                if !std::mem::replace(&mut seen[j as usize], true) {
                    group.push(j);
                }
            }
            next += 1;
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}

/// The primaries that two groups have in common, for all pairs of groups that have more than
/// [`UNSEEN`].
fn copies(groups: &[Vec<u32>], placed: &[PlacedPrimary]) -> Vec<Vec<[u32; 2]>> {
    let mut holders: BTreeMap<(LibraryId, ElementId), Vec<(usize, u32)>> = BTreeMap::new();
    for (g, group) in groups.iter().enumerate().filter(|(_, group)| group.len() > UNSEEN) {
        for &i in group {
            let c = &placed[i as usize].centre;
            holders.entry((c.library, c.source)).or_default().push((g, i));
        }
    }
    let mut common: BTreeMap<[usize; 2], Vec<[u32; 2]>> = BTreeMap::new();
    for list in holders.values() {
        for (k, &(g, i)) in list.iter().enumerate() {
            for &(h, j) in list[k + 1..].iter().filter(|&&(h, _)| h != g) {
                common.entry([g, h]).or_default().push([i, j]);
            }
        }
    }
    common.into_values().filter(|pairs| pairs.len() > UNSEEN).collect()
}

/// Share of the windows of the largest exemplar's size that hold more than [`UNSEEN`] primaries of a
/// pair of groups twice.
fn windows(pairs: &[Vec<[u32; 2]>], placed: &[PlacedPrimary], layout: &Layout, exemplars: &[Layout]) -> f64 {
    let side = |k: usize| exemplars.iter().map(|l| l.size[k]).fold(0.0, f64::max).min(layout.size[k]);
    let size = [side(0), side(1)];
    let places = |k: usize| {
        let room = layout.size[k] - size[k];
        let count = if room > 0.0 { WINDOWS } else { 1 };
        (0..count).map(move |i| room * i as f64 / (count.max(2) - 1) as f64)
    };
    let (mut all, mut with) = (0, 0);
    for y in places(1) {
        for x in places(0) {
            let inside = |i: u32| {
                let at = placed[i as usize].centre.at;
                (x..=x + size[0]).contains(&at[0]) && (y..=y + size[1]).contains(&at[1])
            };
            let twice = |pair: &Vec<[u32; 2]>| pair.iter().filter(|p| p.iter().all(|&i| inside(i))).count();
            all += 1;
            with += usize::from(pairs.iter().any(|pair| twice(pair) > UNSEEN));
        }
    }
    f64::from(with as u32) / f64::from(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::CategoryId;
    use crate::scene::Tile;
    use vtex_base::sampling::stream;

    fn exemplar() -> Layout {
        let mut random = stream(1, "groups test", 0);
        let centre = |source| Centre {
            library: LibraryId(0),
            source: ElementId(source),
            category: CategoryId(0),
            at: [random.range(0.0, 100.0), random.range(0.0, 100.0)],
        };
        Layout { size: [100.0; 2], tile: Tile::default(), centres: (0..60).map(centre).collect() }
    }

    #[test]
    fn an_exemplar_is_one_group_and_beside_itself_a_copy() {
        let exemplar = exemplar();
        let groups = Groups::new(&exemplar, std::slice::from_ref(&exemplar));
        assert_eq!((groups.kept, groups.copies, groups.windows), (1.0, 0, 0.0));
        assert!(groups.largest > 30, "{groups:?}");
        let mut twice = Layout { size: [230.0, 100.0], ..exemplar.clone() };
        let moved = exemplar.centres.iter().map(|c| Centre { at: [c.at[0] + 120.0, c.at[1]], ..*c });
        twice.centres.extend(moved);
        let groups = Groups::new(&twice, std::slice::from_ref(&exemplar));
        assert!(groups.kept > 0.9 && groups.copies >= 1, "{groups:?}");
        assert!(groups.shortest.is_some_and(|d| (d - 120.0).abs() < 1e-6));
        // Copies are further apart than a window is wide.
        assert_eq!(groups.windows, 0.0);
        // If they are nearer, a window holds much of both.
        twice.centres[60..].iter_mut().for_each(|c| c.at[0] -= 60.0);
        twice.centres.retain(|c| c.at[0] < 60.0 || c.at[0] >= 60.0);
        let near: Vec<Centre> =
            exemplar.centres.iter().filter(|c| c.at[0] < 45.0 && c.at[1] < 45.0).copied().collect();
        let beside = near.iter().map(|c| Centre { at: [c.at[0] + 50.0, c.at[1] + 50.0], ..*c });
        let close = Layout { centres: near.iter().copied().chain(beside).collect(), ..exemplar.clone() };
        let groups = Groups::new(&close, &[exemplar]);
        assert!(groups.copies == 0 || groups.windows > 0.0, "{groups:?}");
    }

    #[test]
    fn elements_exchanged_leave_no_group() {
        let exemplar = exemplar();
        let mut shuffled = exemplar.clone();
        let mut random = stream(1, "groups test", 1);
        let mut sources: Vec<u32> = (0..60).collect();
        random.shuffle(&mut sources);
        for (c, s) in shuffled.centres.iter_mut().zip(sources) {
            c.source = ElementId(s);
        }
        let groups = Groups::new(&shuffled, &[exemplar]);
        assert!(groups.kept < 0.05 && groups.largest < 3, "{groups:?}");
    }
}
