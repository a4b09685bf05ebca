//! Removes ragged borders and specks from label maps.

use std::collections::BTreeSet;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::parallel;
use vtex_base::raster::blur::Plane;
use vtex_base::raster::{Connectivity, LabelMap, components};

/// Gives each pixel the label with the largest weight under a Gaussian of standard deviation `sigma`
/// pixels. Ties go to the lower label.
pub(super) fn smoothed(map: &LabelMap, count: usize, sigma: f32) -> LabelMap {
    let size = [map.width as usize, map.height as usize];
    let soft = soft(map, count, sigma);
    let label = |i: usize| strongest((0..count).map(|k| soft[k].values[i]));
    let labels = (0..size[0] * size[1]).map(label).collect();
    LabelMap { labels, ..*map }
}

/// The blurred share of each label around each pixel.
fn soft(map: &LabelMap, count: usize, sigma: f32) -> Vec<Plane> {
    let size = [map.width as usize, map.height as usize];
    let one = |k: usize| {
        let values = map.labels.iter().map(|&l| if l as usize == k { 1.0 } else { 0.0 }).collect();
        Plane { size, values }.blurred(sigma, [false; 2])
    };
    (0..count).map(one).collect()
}

/// Index of the largest value; ties go to the first.
fn strongest(values: impl Iterator<Item = f32>) -> u32 {
    let mut best = (0, f32::NEG_INFINITY);
    for (k, v) in values.enumerate() {
        if v > best.1 {
            best = (k as u32, v);
        }
    }
    best.0
}

/// Most rounds in which all specks change at once.
const ROUNDS: usize = 16;

/// Gives each connected piece below `least` pixels the label that most of its border touches, until none is
/// left or one piece remains. Pieces at a seam continue on the other side and are kept.
///
/// All specks change at once, round by round. Specks of a checkerboard would exchange their labels for ever:
/// from the first round that leaves as many pieces as there were, they change one after the other.
pub(super) fn without_specks(map: LabelMap, count: usize, least: usize, wrap: [bool; 2]) -> LabelMap {
    let mut map = map;
    let mut before = usize::MAX;
    for round in 0.. {
        let pieces = MapPieces::new(&map, least, wrap);
        if !pieces.areas.iter().any(|&a| a < least) {
            break;
        }
        if pieces.areas.len() >= before || round == ROUNDS {
            return pieces.joined(map, count, least);
        }
        before = pieces.areas.len();
        let mut touched = vec![0u32; before * count];
        pieces.each_border(map.width, |[a, _], [_, j]| {
            if pieces.areas[a] < least {
                touched[a * count + map.labels[j] as usize] += 1;
            }
        });
        let mut changed = false;
        for i in 0..map.labels.len() {
            let piece = pieces.of[i] as usize;
            let around = &touched[piece * count..][..count];
            if pieces.areas[piece] < least && around.iter().any(|&n| n > 0) {
                map.labels[i] = strongest(around.iter().map(|&n| n as f32));
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    map
}

/// The connected pieces of a map.
struct MapPieces {
    /// The piece of each pixel.
    of: Vec<u32>,
    /// Number of pixels of each piece; for pieces at a seam a number that is too large for a speck.
    areas: Vec<usize>,
}

impl MapPieces {
    fn new(map: &LabelMap, least: usize, wrap: [bool; 2]) -> Self {
        let size = [map.width as usize, map.height as usize];
        let shifted = LabelMap { labels: map.labels.iter().map(|l| l + 1).collect(), ..*map };
        let (pieces, labels) = components(&shifted, Connectivity::Four);
        let of: Vec<u32> = pieces.labels.iter().map(|&p| p - 1).collect();
        let mut areas = vec![0usize; labels.len() - 1];
        of.iter().for_each(|&p| areas[p as usize] += 1);
        for (k, &repeats) in wrap.iter().enumerate() {
            let along = [1, size[0]][1 - k];
            let first = (0..size[1 - k]).map(|v| v * along);
            let last = [1, size[0]][k] * (size[k] - 1);
            for i in first.filter(|_| repeats).flat_map(|i| [i, i + last]) {
                areas[of[i] as usize] = least;
            }
        }
        Self { of, areas }
    }

    /// Calls `meet` for each pixel edge between two pieces, once from each side, with the pieces and the
    /// pixels.
    fn each_border(&self, width: u32, mut meet: impl FnMut([usize; 2], [usize; 2])) {
        let w = width as usize;
        let mut both = |i: usize, j: usize| {
            let [a, b] = [i, j].map(|i| self.of[i] as usize);
            if a != b {
                meet([a, b], [i, j]);
                meet([b, a], [j, i]);
            }
        };
        for i in 0..self.of.len() {
            if (i + 1) % w != 0 {
                both(i, i + 1);
            }
            if i + w < self.of.len() {
                both(i, i + w);
            }
        }
    }

    /// Joins specks to the piece that shares most of their border, one at a time, the smallest first.
    fn joined(self, mut map: LabelMap, count: usize, least: usize) -> LabelMap {
        let pieces = self.areas.len();
        let mut labels = vec![0u32; pieces];
        self.of.iter().zip(&map.labels).for_each(|(&p, &l)| labels[p as usize] = l);
        // The pixel across each edge of a speck. A speck has few edges, so lists are short.
        let mut borders = vec![Vec::new(); pieces];
        self.each_border(map.width, |[a, b], _| {
            if self.areas[a] < least {
                borders[a].push(b as u32);
            }
        });
        let Self { of, mut areas } = self;
        let mut sets = DisjointSets::new(pieces);
        let mut specks: BTreeSet<(usize, usize)> =
            areas.iter().enumerate().filter(|(_, a)| **a < least).map(|(p, &a)| (a, p)).collect();
        while let Some((_, speck)) = specks.pop_first() {
            let mut sides = std::mem::take(&mut borders[speck]);
            sides.iter_mut().for_each(|p| *p = sets.root(*p as usize) as u32);
            sides.retain(|&p| p as usize != speck);
            if sides.is_empty() {
                continue;
            }
            let mut around = vec![0u32; count];
            sides.iter().for_each(|&p| around[labels[p as usize] as usize] += 1);
            let label = strongest(around.iter().map(|&n| n as f32));
            let mut area = areas[speck];
            let alike: BTreeSet<u32> =
                sides.iter().copied().filter(|&p| labels[p as usize] == label).collect();
            for other in alike.into_iter().map(|p| p as usize) {
                specks.remove(&(areas[other], other));
                area += areas[other];
                sides.append(&mut borders[other]);
                sets.join(speck, other);
            }
            let root = sets.root(speck);
            (labels[root], areas[root]) = (label, area);
            if area < least {
                borders[root] = sides;
                specks.insert((area, root));
            }
        }
        map.labels.iter_mut().zip(of).for_each(|(l, p)| *l = labels[sets.root(p as usize)]);
        map
    }
}

/// Enlarges the map to `size` pixels, by `factor`, with smooth borders.
pub(super) fn enlarged(map: &LabelMap, count: usize, size: [usize; 2], factor: usize) -> LabelMap {
    if factor == 1 {
        return map.clone();
    }
    let soft = soft(map, count, 0.7);
    let small = [map.width as usize, map.height as usize];
    let axis = |v: usize, k: usize| {
        let v = ((v as f32 + 0.5) / factor as f32 - 0.5).clamp(0.0, (small[k] - 1) as f32);
        let low = v as usize;
        (low, (low + 1).min(small[k] - 1), v - low as f32)
    };
    let mut labels = vec![0; size[0] * size[1]];
    parallel::for_chunks(&mut labels, size[0], |y, row| {
        let (y0, y1, v) = axis(y, 1);
        for (x, label) in row.iter_mut().enumerate() {
            let (x0, x1, u) = axis(x, 0);
            let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)];
            let own = map.labels[y0 * small[0] + x0];
            if corners.iter().all(|c| map.labels[c.1 * small[0] + c.0] == own) {
                *label = own;
                continue;
            }
            let at = |plane: &Plane| {
                let top = plane.at(x0, y0) * (1.0 - u) + plane.at(x1, y0) * u;
                let low = plane.at(x0, y1) * (1.0 - u) + plane.at(x1, y1) * u;
                top * (1.0 - v) + low * v
            };
            *label = strongest(soft.iter().map(at));
        }
    });
    LabelMap { width: size[0] as u32, height: size[1] as u32, labels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specks_join_what_surrounds_them() {
        let mut map = LabelMap::filled(20, 20, 0);
        (0..20).for_each(|y| (10..20).for_each(|x| map.set(x, y, 1)));
        map.set(4, 4, 2);
        map.set(15, 4, 0);
        map.set(16, 4, 2);
        let clean = without_specks(map.clone(), 3, 6, [false; 2]);
        assert_eq!(clean.areas(), [200, 200]);
        map.set(4, 4, 0);
        map.set(0, 9, 2);
        assert_eq!(without_specks(map.clone(), 3, 6, [false; 2]).areas(), [200, 200]);
        assert_eq!(without_specks(map.clone(), 3, 6, [true, false]).areas(), [199, 200, 1]);
        assert_eq!(without_specks(map, 3, 6, [false, true]).areas(), [200, 200]);
    }

    #[test]
    fn specks_that_would_exchange_their_labels_for_ever_are_joined() {
        let (side, least) = (40, 9);
        let none_is_left = |map: &LabelMap, wrap| {
            let clean = without_specks(map.clone(), 3, least, wrap);
            let pieces = MapPieces::new(&clean, least, wrap);
            assert!(pieces.areas.len() == 1 || pieces.areas.iter().all(|&a| a >= least));
        };
        let map_of = |label: &dyn Fn(u32, u32) -> u32| {
            let labels = (0..side * side).map(|i| label(i % side, i / side)).collect();
            LabelMap { width: side, height: side, labels }
        };
        let checkers = map_of(&|x, y| (x + y) % 2);
        let diagonal = map_of(&|x, y| (x + 2 * y) % 3);
        // In each round one strip of the checkerboard joins the region, which would take many rounds.
        let beside = map_of(&|x, y| if x < 3 { 2 } else { (x + y) % 2 });
        for map in [checkers, diagonal, beside] {
            for wrap in [[false; 2], [true, false], [true; 2]] {
                none_is_left(&map, wrap);
            }
        }
    }

    #[test]
    fn one_colour_stays() {
        let map = LabelMap::filled(3, 3, 1);
        assert_eq!(without_specks(map.clone(), 2, 100, [true; 2]), map);
    }

    #[test]
    fn enlarging_keeps_areas() {
        let mut map = LabelMap::filled(30, 30, 0);
        (0..30).for_each(|y| {
            (0..30).for_each(|x| {
                if (x + y) % 40 > 14 && x > 6 {
                    map.set(x, y, 1)
                }
            })
        });
        let large = enlarged(&map, 2, [61, 60], 2);
        let share = |m: &LabelMap| f64::from(m.areas()[1]) / m.labels.len() as f64;
        assert!((share(&map) - share(&large)).abs() < 0.02, "{} {}", share(&map), share(&large));
    }
}
