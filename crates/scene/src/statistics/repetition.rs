//! Repetition of the same textons, and the distances of their copies.

use super::{Layout, neighbour_distance};
use crate::element::ElementId;
use crate::library::Library;
use crate::scene::LibraryId;
use crate::scene::Scene;
use serde::Serialize;
use vtex_base::geometry::wrapped;

/// Copies nearer than this, in mean neighbour distances, are noticeable.
const NEAR: f64 = 2.0;

/// Repetition of the same primaries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Repetition {
    /// Different primaries that were placed.
    pub textons: usize,
    /// Number of primaries that may be placed.
    pub placeable: usize,
    /// Share of the most frequent primary among all placed ones, 0 to 1.
    pub largest_share: f64,
    /// Share of the placed primaries with a copy nearer than two mean neighbour distances, 0 to 1.
    pub near: f64,
    /// Distances of copies; `None` if no primary was placed twice.
    pub copies: Option<CopyDistances>,
}

/// Distances of copies of one primary, from centre to centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CopyDistances {
    /// The shortest distance, in pixels.
    pub shortest: f64,
    /// The shortest distance, in mean distances between neighbours in the exemplar.
    pub shortest_neighbours: f64,
    /// Median distance to the nearest copy of those that have one, in pixels.
    pub median: f64,
    /// Median distance to the nearest copy, in mean distances between neighbours in the exemplar.
    pub median_neighbours: f64,
}

impl Repetition {
    /// Measures the primaries of a scene made from `libraries`.
    pub fn of_scene(scene: &Scene, libraries: &[Library]) -> Self {
        let units: Vec<f64> = libraries.iter().map(neighbour_distance).collect();
        let placeable = |l: &Library| l.primaries().iter().filter(|p| !p.clipped).count();
        Self::new(&Layout::of_scene(scene), libraries.iter().map(placeable).sum(), &units)
    }

    /// Measures an arrangement; `units` are the mean neighbour distances of the libraries, in pixels.
    pub fn new(layout: &Layout, placeable: usize, units: &[f64]) -> Self {
        let period = layout.period();
        let mut placed: Vec<((LibraryId, ElementId), [f64; 2])> = layout
            .centres
            .iter()
            .map(|c| ((c.library, c.source), [0, 1].map(|k| wrapped(c.at[k], period[k]))))
            .collect();
        placed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])).then(a.1[1].total_cmp(&b.1[1])));
        let mut found = Self { placeable, ..Self::default() };
        let mut most = 0;
        // Distances in pixels and in neighbour distances.
        let (mut pixels, mut relative) = (Vec::new(), Vec::new());
        for copies in placed.chunk_by(|a, b| a.0 == b.0) {
            found.textons += 1;
            most = most.max(copies.len());
            let places: Vec<[f64; 2]> = copies.iter().map(|c| c.1).collect();
            let unit = units.get(copies[0].0.0.index()).copied().unwrap_or(1.0);
            let nearest = nearest(&places, period);
            relative.extend(nearest.iter().map(|d| d / unit));
            pixels.extend(nearest);
        }
        if placed.is_empty() {
            return found;
        }
        let all = placed.len() as f64;
        found.largest_share = most as f64 / all;
        found.near = relative.iter().filter(|d| **d < NEAR).count() as f64 / all;
        for distances in [&mut pixels, &mut relative] {
            distances.sort_by(f64::total_cmp);
        }
        found.copies = pixels.first().zip(relative.first()).map(|(&shortest, &near)| CopyDistances {
            shortest,
            shortest_neighbours: near,
            median: pixels[pixels.len() / 2],
            median_neighbours: relative[relative.len() / 2],
        });
        found
    }
}

/// Distance from each place to the nearest other one; empty for fewer than two. `places` are
/// sorted by x.
fn nearest(places: &[[f64; 2]], period: [Option<f64>; 2]) -> Vec<f64> {
    if places.len() < 2 {
        return Vec::new();
    }
    // Copies around the torus are listed along x; distances wrap along y.
    let shifted = |by: f64| places.iter().enumerate().map(move |(i, p)| (i, [p[0] + by, p[1]]));
    let images: Vec<(usize, [f64; 2])> = match period[0] {
        Some(w) => shifted(-w).chain(shifted(0.0)).chain(shifted(w)).collect(),
        None => shifted(0.0).collect(),
    };
    let middle = if period[0].is_some() { places.len() } else { 0 };
    let one = |i: usize| {
        let p = places[i];
        let mut best = f64::INFINITY;
        let mut look = |&(other, q): &(usize, [f64; 2])| {
            let (dx, dy) = ((q[0] - p[0]).abs(), (q[1] - p[1]).abs());
            let dy = period[1].map_or(dy, |h| dy.min(h - dy));
            if other != i {
                best = best.min(dx * dx + dy * dy);
            }
            // Whether a place farther along x can be nearer.
            dx * dx < best
        };
        let (before, after) = images.split_at(middle + i);
        // `all` stops at the first place that cannot be nearer.
        before.iter().rev().all(&mut look);
        after.iter().all(&mut look);
        libm::sqrt(best)
    };
    (0..places.len()).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Centre;
    use super::*;
    use crate::element::CategoryId;
    use crate::scene::Tile;
    use vtex_base::sampling::stream;

    fn layout(tile: Tile, centres: &[(u32, u32, f64, f64)]) -> Layout {
        let centre = |&(library, source, x, y): &(u32, u32, f64, f64)| Centre {
            library: LibraryId(library),
            source: ElementId(source),
            category: CategoryId(0),
            at: [x, y],
        };
        Layout { size: [100.0, 80.0], tile, centres: centres.iter().map(centre).collect() }
    }

    #[test]
    fn copies_are_counted_and_their_distances_measured() {
        let plane = Tile::default();
        assert_eq!(Repetition::new(&layout(plane, &[]), 7, &[1.0]).largest_share, 0.0);
        let centres = [
            (0, 3, 10.0, 10.0),
            (0, 3, 13.0, 14.0),
            (0, 3, 90.0, 14.0),
            (0, 1, 50.0, 50.0),
            (1, 3, 11.0, 10.0),
        ];
        let r = Repetition::new(&layout(plane, &centres), 7, &[2.0, 1.0]);
        assert_eq!((r.textons, r.placeable, r.largest_share), (3, 7, 0.6));
        let copies = r.copies.unwrap();
        assert_eq!((copies.shortest, copies.shortest_neighbours), (5.0, 2.5));
        assert_eq!((copies.median, copies.median_neighbours), (5.0, 2.5));
        assert_eq!(r.near, 0.0);
        assert_eq!(Repetition::new(&layout(plane, &centres), 7, &[3.0, 1.0]).near, 0.4);
        // A scene in which no primary occurs twice.
        assert_eq!(Repetition::new(&layout(plane, &centres[2..]), 7, &[1.0, 1.0]).copies, None);
    }

    #[test]
    fn on_a_torus_the_nearest_way_may_lead_around_it() {
        let centres = [(0, 0, 2.0, 40.0), (0, 0, 99.0, 40.0), (0, 1, 5.0, 1.0), (0, 1, 5.0, 79.0)];
        let shortest = |x, y| {
            let found = Repetition::new(&layout(Tile { x, y }, &centres), 2, &[1.0]);
            found.copies.unwrap().shortest
        };
        assert_eq!(shortest(false, false), 78.0);
        assert_eq!(shortest(true, false), 3.0);
        assert_eq!(shortest(false, true), 2.0);
    }

    #[test]
    fn nearest_distances_are_those_of_all_pairs() {
        let mut random = stream(1, "repetition test", 0);
        for tile in 0..4 {
            let period = [(tile & 1 > 0).then_some(100.0), (tile & 2 > 0).then_some(80.0)];
            let mut places: Vec<[f64; 2]> =
                (0..60).map(|_| [random.range(0.0, 100.0), random.range(0.0, 80.0)]).collect();
            places.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let along = |d: f64, p: Option<f64>| p.map_or(d.abs(), |p| d.abs().min(p - d.abs()));
            let distance = |a: &[f64; 2], b: &[f64; 2]| {
                libm::hypot(along(a[0] - b[0], period[0]), along(a[1] - b[1], period[1]))
            };
            for (i, found) in nearest(&places, period).into_iter().enumerate() {
                let others = places.iter().enumerate().filter(|(j, _)| *j != i);
                let wanted = others.map(|(_, q)| distance(&places[i], q)).fold(f64::INFINITY, f64::min);
                assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
            }
        }
    }
}
