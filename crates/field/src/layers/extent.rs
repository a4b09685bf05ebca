//! The reach of colour differences: whether a photograph has layers at all.
//!
//! Two properties distinguish layers from elements and grain. Their colours still differ when averaged over
//! an eighth of the photograph, and they are thick. The first is measured by the ratio of the spreads of
//! means over an eighth and over a thirty-second of the shorter side, the second by the thickness of the
//! thinner of two layers. Neither is sufficient: uneven light has the first, large elements the second. The
//! part that known elements would contribute if scattered at random is subtracted from the first.

use super::map::Contacts;
use vtex_base::raster::LabelMap;
use vtex_base::raster::blur::Plane;

/// The shorter side is divided by these for the windows of the means.
const WINDOWS: [usize; 2] = [8, 32];
/// The shorter side is divided by this for the unit of thickness.
const THICKNESS: f64 = 37.0;

/// Long-range differences of colour in a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColourContrast {
    /// Spread of means over an eighth of the shorter side, in Oklab.
    pub(super) contrast: f64,
    /// This spread relative to that over a thirty-second.
    pub(super) reach: f64,
}

/// Measures a picture in Oklab. `elements` has the same size and a label above 0 for each element.
pub(super) fn extent(planes: &[Plane; 3], elements: Option<&LabelMap>) -> ColourContrast {
    let shorter = planes[0].size[0].min(planes[0].size[1]);
    let [wide, narrow] = WINDOWS.map(|part| (shorter / part).max(1));
    let [large, small] = [wide, narrow].map(|window| variance_of_means(planes, window));
    let scattered = elements.map_or(0.0, |map| scattered(planes, map, wide));
    let large = (large - scattered).max(0.0);
    let reach = if small > 0.0 { libm::sqrt(large / small) } else { 0.0 };
    ColourContrast { contrast: libm::sqrt(large), reach }
}

/// Variance of the means over a sliding window, summed over components.
fn variance_of_means(planes: &[Plane; 3], window: usize) -> f64 {
    planes
        .iter()
        .map(|plane| {
            let [w, h] = plane.size;
            let stride = w + 1;
            let mut before = vec![0f64; stride * (h + 1)];
            for y in 0..h {
                let mut row = 0.0;
                for x in 0..w {
                    row += f64::from(plane.at(x, y));
                    before[(y + 1) * stride + x + 1] = before[y * stride + x + 1] + row;
                }
            }
            let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
            for y in window..=h {
                for x in window..=w {
                    let at = |y: usize, x: usize| before[y * stride + x];
                    let all = at(y, x) - at(y - window, x) - at(y, x - window) + at(y - window, x - window);
                    let mean = all / (window * window) as f64;
                    (sum, squares, count) = (sum + mean, squares + mean * mean, count + 1.0);
                }
            }
            if count > 0.0 { (squares / count - (sum / count) * (sum / count)).max(0.0) } else { 0.0 }
        })
        .sum()
}

/// The variance of means that elements of these sizes and colours would cause if scattered independently:
/// shot noise of squares, reduced because elements do not overlap.
fn scattered(planes: &[Plane; 3], map: &LabelMap, window: usize) -> f64 {
    let count = map.labels.iter().copied().max().unwrap_or(0) as usize + 1;
    let mut sums = vec![[0f64; 4]; count];
    for (i, &label) in map.labels.iter().enumerate() {
        let sum = &mut sums[label as usize];
        (0..3).for_each(|c| sum[c] += f64::from(planes[c].values[i]));
        sum[3] += 1.0;
    }
    let pixels = map.labels.len() as f64;
    let background = if sums[0][3] > 0.0 {
        sums[0]
    } else {
        sums.iter().fold([0.0; 4], |a, b| std::array::from_fn(|c| a[c] + b[c]))
    };
    let background: [f64; 3] = std::array::from_fn(|c| background[c] / background[3].max(1.0));
    let window = window as f64;
    let noise: f64 = sums[1..]
        .iter()
        .filter(|s| s[3] > 0.0)
        .map(|s| {
            let contrast: f64 = (0..3).map(|c| s[c] / s[3] - background[c]).map(|d| d * d).sum();
            // Squared overlap of two intervals, integrated over all offsets, for both axes.
            let side = libm::sqrt(s[3]);
            let (short, long) = (side.min(window), side.max(window));
            let overlap = short * short * (long - short / 3.0);
            contrast * overlap * overlap / (window * window * window * window)
        })
        .sum();
    let covered = 1.0 - sums[0][3] / pixels;
    noise / pixels * (1.0 - covered)
}

/// Mean thickness of the thinnest layer of a map, 2 · area / perimeter, in units of a 37th of the shorter
/// side. 0 if a layer is missing.
pub(super) fn thickness(map: &LabelMap, count: usize) -> f64 {
    let contacts = Contacts::new(map, count, [false; 2]);
    let mut areas = vec![0usize; count];
    map.labels.iter().for_each(|&l| areas[l as usize] += 1);
    let unit = f64::from(map.width.min(map.height)) / THICKNESS;
    let each = areas.iter().enumerate().map(|(k, &area)| {
        let around = contacts.around(k);
        if area == 0 || around == 0 { 0.0 } else { 2.0 * area as f64 / around as f64 / unit }
    });
    each.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    /// Random squares of one size on a plain background, as a map and as a picture.
    fn squares(side: usize, count: usize, seed: u64) -> ([Plane; 3], LabelMap) {
        let mut random = stream(seed, "extent test", 0);
        let mut map = LabelMap::filled(256, 256, 0);
        for k in 0..count {
            let at = [random.index(256 - side), random.index(256 - side)];
            for y in 0..side {
                for x in 0..side {
                    map.set((at[0] + x) as u32, (at[1] + y) as u32, k as u32 + 1);
                }
            }
        }
        let values = map.labels.iter().map(|&l| if l > 0 { 0.8 } else { 0.4 }).collect();
        let plane = Plane { size: [256; 2], values };
        let flat = Plane { size: [256; 2], values: vec![0.0; 256 * 256] };
        ([plane, flat.clone(), flat], map)
    }

    #[test]
    fn scattered_elements_are_no_layers() {
        for (side, count) in [(8, 200), (24, 25)] {
            let (planes, map) = squares(side, count, 3);
            let (bare, known) = (extent(&planes, None), extent(&planes, Some(&map)));
            assert!(known.reach < 0.7 * bare.reach, "{side}: {bare:?} {known:?}");
        }
    }

    #[test]
    fn clusters_of_elements_are() {
        let (planes, map) = squares(8, 400, 4);
        // The same elements, but only those in one half.
        let keep = |i: usize| i % 256 < 128;
        let labels = map.labels.iter().enumerate().map(|(i, &l)| if keep(i) { l } else { 0 }).collect();
        let map = LabelMap { labels, ..map };
        let values =
            planes[0].values.iter().enumerate().map(|(i, &v)| if keep(i) { v } else { 0.4 }).collect();
        let planes = [Plane { size: [256; 2], values }, planes[1].clone(), planes[2].clone()];
        let (bare, known) = (extent(&planes, None), extent(&planes, Some(&map)));
        assert!(known.reach > 0.85 * bare.reach, "{bare:?} {known:?}");
    }

    #[test]
    fn thickness_of_stripes() {
        let mut map = LabelMap::filled(74, 74, 0);
        (0..74).for_each(|y| (0..74).filter(|x| x % 8 < 4).for_each(|x| map.set(x, y, 1)));
        assert!((thickness(&map, 2) - 2.0).abs() < 0.2, "{}", thickness(&map, 2));
        assert_eq!(thickness(&map, 3), 0.0);
    }
}
