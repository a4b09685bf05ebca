//! Removes ragged borders and specks from label maps.

use crate::parallel;
use crate::raster::blur::Plane;
use crate::raster::{Connectivity, LabelMap, components};

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

/// Gives each connected piece below `least` pixels the label that most of its border touches, until none is
/// left or one piece remains. Pieces at a seam continue on the other side and are kept.
pub(super) fn without_specks(map: LabelMap, count: usize, least: usize, wrap: [bool; 2]) -> LabelMap {
    let mut map = map;
    let size = [map.width as usize, map.height as usize];
    loop {
        if least == 0 {
            return map;
        }
        let shifted = LabelMap { labels: map.labels.iter().map(|l| l + 1).collect(), ..map };
        let (pieces, labels) = components(&shifted, Connectivity::Four);
        let mut areas = vec![0usize; labels.len()];
        pieces.labels.iter().for_each(|&p| areas[p as usize] += 1);
        for (k, &repeats) in wrap.iter().enumerate() {
            let along = [1, size[0]][1 - k];
            let first = (0..size[1 - k]).map(|v| v * along);
            let last = [1, size[0]][k] * (size[k] - 1);
            for i in first.filter(|_| repeats).flat_map(|i| [i, i + last]) {
                areas[pieces.labels[i] as usize] = least;
            }
        }
        let small = |p: u32| areas[p as usize] < least;
        let mut touched = vec![0u32; labels.len() * count];
        let w = map.width as usize;
        let mut meet = |i: usize, j: usize| {
            for (a, b) in [(i, j), (j, i)] {
                let piece = pieces.labels[a];
                if piece != pieces.labels[b] && small(piece) {
                    touched[piece as usize * count + map.labels[b] as usize] += 1;
                }
            }
        };
        for i in 0..map.labels.len() {
            if (i + 1) % w != 0 {
                meet(i, i + 1);
            }
            if i + w < map.labels.len() {
                meet(i, i + w);
            }
        }
        let mut changed = false;
        for i in 0..map.labels.len() {
            let piece = pieces.labels[i];
            if small(piece) {
                let around = &touched[piece as usize * count..][..count];
                if around.iter().any(|&n| n > 0) {
                    map.labels[i] = strongest(around.iter().map(|&n| n as f32));
                    changed = true;
                }
            }
        }
        if !changed {
            return map;
        }
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
