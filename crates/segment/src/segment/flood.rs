//! Flood fill of the uncovered pixels into regions of uniform colour.

use image::RgbImage;
use vtex_base::raster::{LabelMap, edge_neighbours};

/// 4-connected regions of the pixels for which `inside(index)` is false (indices row by row). A region
/// grows from its seed, its first pixel in reading order, over free pixels whose colour differs from
/// the *seed's* by at most `tolerance`: the Euclidean distance of 8-bit sRGB colours divided by the
/// largest possible one, 255 · √3 (0 to 1).
///
/// Regions of all sizes are numbered from 1 in the order of their seeds; pixels inside are 0.
pub fn flood(image: &RgbImage, inside: &dyn Fn(usize) -> bool, tolerance: f64) -> LabelMap {
    let (width, height) = image.dimensions();
    let (w, count) = (width as usize, width as usize * height as usize);
    let bytes = image.as_raw();
    let colour = |i: usize| [bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]].map(i32::from);
    let limit = 3.0 * 255.0 * 255.0 * tolerance.max(0.0) * tolerance.max(0.0);
    let within = |a: [i32; 3], b: [i32; 3]| {
        let square: i32 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        // Allows for the rounding of a tolerance such as 0.1.
        f64::from(square) <= limit + 1e-6
    };
    let mut map = LabelMap::filled(width, height, 0);
    let covered: Vec<bool> = (0..count).map(inside).collect();
    let mut stack = Vec::new();
    let mut label = 0;
    for start in 0..count {
        if covered[start] || map.labels[start] != 0 {
            continue;
        }
        label += 1;
        let seed = colour(start);
        map.labels[start] = label;
        stack.push(start);
        while let Some(i) = stack.pop() {
            for j in edge_neighbours(i, [w, count / w]) {
                if !covered[j] && map.labels[j] == 0 && within(colour(j), seed) {
                    map.labels[j] = label;
                    stack.push(j);
                }
            }
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vtex_base::raster::{Connectivity, components};

    proptest! {
        #[test]
        fn regions_obey_the_tolerance(
            values in prop::collection::vec(any::<[u8; 3]>(), 12 * 9),
            covered in prop::collection::vec(prop::bool::weighted(0.2), 12 * 9),
            tolerance in 0.0..0.6f64,
        ) {
            let image = RgbImage::from_fn(12, 9, |x, y| image::Rgb(values[(y * 12 + x) as usize]));
            let map = flood(&image, &|i| covered[i], tolerance);
            let mut seeds = vec![[0u8; 3]];
            for (i, &label) in map.labels.iter().enumerate() {
                prop_assert_eq!(label == 0, covered[i]);
                if label as usize == seeds.len() {
                    seeds.push(values[i]);
                }
                prop_assert!((label as usize) < seeds.len());
                if label > 0 {
                    let seed = seeds[label as usize];
                    let square: f64 = (0..3)
                        .map(|c| f64::from(values[i][c].abs_diff(seed[c])))
                        .map(|d| d * d)
                        .sum();
                    prop_assert!(square.sqrt() / (255.0 * 3f64.sqrt()) <= tolerance + 1e-9);
                }
            }
            let (_, pieces) = components(&map, Connectivity::Four);
            prop_assert_eq!(pieces.len(), seeds.len());
        }
    }

    #[test]
    fn a_constant_image_is_one_region() {
        let image = RgbImage::from_pixel(7, 5, image::Rgb([40, 50, 60]));
        assert!(flood(&image, &|_| false, 0.1).labels.iter().all(|&l| l == 1));
        assert!(flood(&RgbImage::new(0, 0), &|_| false, 0.1).labels.is_empty());
    }
}
