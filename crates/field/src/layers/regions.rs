//! Depths to labels: nested regions of exact areas, with thin strips between layers that must not touch.

use super::clean::without_specks;
use super::map::{Contacts, LayerRegion};
use vtex_base::parallel;
use vtex_base::raster::{Connectivity, LabelMap, components, squared_distance};

/// Depths are clamped to this many pixels or cells.
const DEEPEST: f32 = 1e5;
/// Cells by which a repeating region is extended on each side to measure depths.
const CONTINUED: usize = 32;

/// Most rounds of inserting strips.
const STRIPS: usize = 4;

/// The depth of each place in a region: the signed distance to its border in pixels, negative outside.
pub(super) fn depth(region: &LayerRegion) -> Vec<f32> {
    let [w, h] = region.size;
    let margin = [0, 1].map(|k| if region.wrap[k] { region.size[k].min(CONTINUED) } else { 0 });
    let [fw, fh] = [w + 2 * margin[0], h + 2 * margin[1]];
    let inside = |i: usize| {
        let [x, y] = [(i % fw + w - margin[0]) % w, (i / fw + h - margin[1]) % h];
        region.inside[y * w + x]
    };
    let [to_outside, to_inside] = [false, true].map(|side| squared_distance(fw, fh, |i| inside(i) == side));
    let value = |i: usize| {
        let i = (i / w + margin[1]) * fw + i % w + margin[0];
        // Borders lie half a pixel from the centres of adjacent pixels.
        let from = |d: f32| libm::sqrtf(d).min(DEEPEST) - 0.5;
        if to_inside[i] == 0.0 { from(to_outside[i]) } else { -from(to_inside[i]) }
    };
    (0..w * h).map(value).collect()
}

/// Depths of the regions from S_1 up, sampled on a grid over a canvas.
pub(super) struct Depths {
    /// Size of the canvas, in pixels.
    pub(super) size: [usize; 2],
    pub(super) wrap: [bool; 2],
    /// Number of evenly spaced samples along each axis.
    pub(super) grid: [usize; 2],
    /// Depths in each region, sample by sample.
    pub(super) planes: Vec<Vec<f32>>,
}

impl Depths {
    /// Labels whose areas are `shares` of the canvas, without pieces below `speck` pixels. If more than
    /// `distant` of all borders lie between non-consecutive layers, thin strips of the layers between them
    /// are inserted along the shortest such borders.
    pub(super) fn labels(&self, shares: &[f64], distant: f64, speck: usize) -> LabelMap {
        let count = shares.len();
        let values: Vec<Vec<f32>> = self.planes.iter().map(|plane| self.enlarged(plane)).collect();
        let strip = self.size[0].min(self.size[1]).div_ceil(512);
        let mut strips = vec![false; self.size[0] * self.size[1]];
        let mut map = self.ranked(&values, shares, &strips, strip);
        for _ in 0..STRIPS {
            if count < 3 || !self.part(&map, count, distant, strip, &mut strips) {
                break;
            }
            map = self.ranked(&values, shares, &strips, strip);
        }
        without_specks(map, count, speck, self.wrap)
    }

    /// Marks strips around the shortest borders between non-consecutive layers until their share is low
    /// enough. False if it is already.
    fn part(&self, map: &LabelMap, count: usize, distant: f64, strip: usize, strips: &mut [bool]) -> bool {
        let contacts = Contacts::new(map, count, self.wrap);
        let excess = (contacts.distant() - distant) * contacts.total() as f64;
        if excess <= 0.0 {
            return false;
        }
        let [w, h] = self.size;
        let labels = &map.labels;
        let touches = |i: usize| {
            around(i, self.size, self.wrap).into_iter().flatten().any(|j| labels[j] > labels[i] + 1)
        };
        let touching: Vec<u32> = (0..w * h).map(|i| u32::from(touches(i))).collect();
        let touching = LabelMap { width: w as u32, height: h as u32, labels: touching };
        let (pieces, _) = components(&touching, Connectivity::Eight);
        let mut lengths = pieces.areas();
        lengths[0] = 0;
        let mut order: Vec<usize> = (1..lengths.len()).collect();
        order.sort_by_key(|&p| (lengths[p], p));
        let mut parted = vec![false; lengths.len()];
        let mut left = excess;
        for p in order {
            if left <= 0.0 {
                break;
            }
            // A pixel may touch with several sides, so this overestimates the remaining length.
            left -= f64::from(lengths[p]);
            parted[p] = true;
        }
        let chosen: Vec<u32> = pieces.labels.iter().map(|&p| u32::from(parted[p as usize])).collect();
        (0..w * h).filter(|&i| chosen[i] == 1).for_each(|i| strips[i] = true);
        near(&chosen, self.size, self.wrap, strip * (count - 2) + 1)
            .into_iter()
            .for_each(|i| strips[i] = true);
        true
    }

    /// Gives each layer, from the top down, the free pixels of largest depth in its region; before these,
    /// the pixels of `strips` within `strip` steps of the layer above.
    fn ranked(&self, values: &[Vec<f32>], shares: &[f64], strips: &[bool], strip: usize) -> LabelMap {
        let [w, h] = self.size;
        let mut labels = vec![0u32; w * h];
        let mut above = 0.0;
        let mut taken = 0;
        let any = strips.contains(&true);
        for layer in (1..shares.len()).rev() {
            above += shares[layer];
            let wanted = (libm::round(above * (w * h) as f64) as usize).min(w * h);
            let mut left = wanted.saturating_sub(taken);
            if any && taken > 0 {
                for i in near(&labels, self.size, self.wrap, strip).into_iter().filter(|&i| strips[i]) {
                    if left > 0 {
                        labels[i] = layer as u32;
                        (left, taken) = (left - 1, taken + 1);
                    }
                }
            }
            let values = &values[layer - 1];
            let free = labels.iter().map(|&l| l == 0);
            let (limit, mut ties) = limit(values.iter().zip(free).filter(|v| v.1).map(|v| *v.0), left);
            for (label, &value) in labels.iter_mut().zip(values) {
                let key = key(value);
                if *label == 0 && left > 0 && (key > limit || (key == limit && ties > 0)) {
                    ties -= usize::from(key == limit);
                    *label = layer as u32;
                    taken += 1;
                }
            }
        }
        LabelMap { width: w as u32, height: h as u32, labels }
    }

    /// Enlarges a plane to the pixels of the canvas by linear interpolation.
    pub(super) fn enlarged(&self, plane: &[f32]) -> Vec<f32> {
        let [w, h] = self.size;
        if self.grid == self.size {
            return plane.to_vec();
        }
        let axis = |v: usize, k: usize| {
            let v = (v as f64 + 0.5) * self.grid[k] as f64 / self.size[k] as f64 - 0.5;
            let low = libm::floor(v);
            let at = |i: i64| {
                let count = self.grid[k] as i64;
                (if self.wrap[k] { i.rem_euclid(count) } else { i.clamp(0, count - 1) }) as usize
            };
            (at(low as i64), at(low as i64 + 1), (v - low) as f32)
        };
        let columns: Vec<_> = (0..w).map(|x| axis(x, 0)).collect();
        let mut values = vec![0f32; w * h];
        parallel::for_chunks(&mut values, w, |y, row| {
            let (top, low, v) = axis(y, 1);
            let [top, low] = [top, low].map(|y| &plane[y * self.grid[0]..][..self.grid[0]]);
            for (out, &(left, right, u)) in row.iter_mut().zip(&columns) {
                let a = top[left] + (top[right] - top[left]) * u;
                let b = low[left] + (low[right] - low[left]) * u;
                *out = a + (b - a) * v;
            }
        });
        values
    }
}

/// The four pixels adjacent to a pixel, across seams; `None` beyond a border.
pub(super) fn around(i: usize, [w, h]: [usize; 2], wrap: [bool; 2]) -> [Option<usize>; 4] {
    let [x, y] = [i % w, i / w];
    [
        if x > 0 { Some(i - 1) } else { wrap[0].then_some(i + w - 1) },
        if x + 1 < w { Some(i + 1) } else { wrap[0].then_some(i + 1 - w) },
        if y > 0 { Some(i - w) } else { wrap[1].then_some(i + w * (h - 1)) },
        if y + 1 < h { Some(i + w) } else { wrap[1].then_some(x) },
    ]
}

/// Pixels of label 0 within `steps` steps of another label.
fn near(labels: &[u32], [w, h]: [usize; 2], wrap: [bool; 2], steps: usize) -> Vec<usize> {
    let mut found = Vec::new();
    let mut seen: Vec<bool> = labels.iter().map(|&l| l > 0).collect();
    let mut rim: Vec<usize> = (0..labels.len()).filter(|&i| seen[i]).collect();
    for _ in 0..steps {
        let mut next = Vec::new();
        for i in rim {
            for j in around(i, [w, h], wrap).into_iter().flatten() {
                if !std::mem::replace(&mut seen[j], true) {
                    next.push(j);
                }
            }
        }
        next.sort_unstable();
        found.extend(&next);
        rim = next;
    }
    found
}

/// An integer that sorts like the value.
fn key(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// The smallest key among the `count` largest values, and how many values of that key are among them.
fn limit(values: impl Iterator<Item = f32> + Clone, count: usize) -> (u32, usize) {
    let mut left = count;
    let mut find = |counts: &[usize]| {
        let mut bin = counts.len() - 1;
        while bin > 0 && counts[bin] < left {
            left -= counts[bin];
            bin -= 1;
        }
        bin as u32
    };
    let mut counts = vec![0usize; 1 << 16];
    values.clone().for_each(|v| counts[(key(v) >> 16) as usize] += 1);
    let high = find(&counts);
    counts.fill(0);
    values.map(key).filter(|k| k >> 16 == high).for_each(|k| counts[(k & 0xffff) as usize] += 1);
    let low = find(&counts);
    (high << 16 | low, left)
}

#[cfg(test)]
mod tests {
    use super::super::map::shares;
    use super::super::testing::nested;
    use super::*;
    use proptest::prelude::*;

    fn depths(map: &LabelMap, count: usize) -> Depths {
        let size = [map.width as usize, map.height as usize];
        let region = |k: usize| LayerRegion {
            size,
            wrap: [false; 2],
            inside: map.labels.iter().map(|&l| l as usize >= k).collect(),
        };
        let planes = (1..count).map(|k| depth(&region(k))).collect();
        Depths { size, wrap: [false; 2], grid: size, planes }
    }

    #[test]
    fn a_map_comes_back() {
        let map = nested([90, 70], 4, 2);
        assert_eq!(depths(&map, 4).labels(&shares(&map, 4), 1.0, 0), map);
    }

    #[test]
    fn strips_part_what_must_not_touch() {
        let mut map = LabelMap::filled(60, 60, 0);
        (20..40).for_each(|y| (20..40).for_each(|x| map.set(x, y, 2)));
        (0..60).for_each(|y| (50..60).for_each(|x| map.set(x, y, 1)));
        let parted = depths(&map, 3).labels(&shares(&map, 3), 0.01, 0);
        assert_eq!(parted.areas(), map.areas());
        assert!(Contacts::new(&parted, 3, [false; 2]).distant() <= 0.01);
    }

    #[test]
    fn depth_across_the_seam() {
        let inside = (0..100).map(|i| i % 10 < 2 || i % 10 > 7).collect();
        let mut region = LayerRegion { size: [10, 10], wrap: [true; 2], inside };
        assert_eq!(depth(&region)[0], 1.5);
        region.wrap = [false; 2];
        assert_eq!(depth(&region)[..3], [1.5, 0.5, -0.5]);
    }

    proptest! {
        #[test]
        fn the_largest_are_taken(values in prop::collection::vec(-3.0..3.0f32, 1..60), share in 0.0..1.0f64) {
            let count = (share * values.len() as f64) as usize;
            prop_assume!(count > 0);
            let mut sorted = values.clone();
            sorted.sort_by(|a, b| b.total_cmp(a));
            let (limit, ties) = limit(values.iter().copied(), count);
            let above = values.iter().filter(|v| key(**v) > limit).count();
            prop_assert_eq!(above + ties, count);
            prop_assert_eq!(key(sorted[count - 1]), limit);
        }
    }
}
