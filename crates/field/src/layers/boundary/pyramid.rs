//! Regions on coarser levels.

use super::super::map::LayerRegion;
use super::shape::{Bounds, fill};

/// A region at half the resolution, with the same share: the cells with most of their 2 × 2 pixels inside.
pub(super) fn halved(region: &LayerRegion) -> LayerRegion {
    let [w, h] = region.size;
    let size = region.size.map(|v| v.div_ceil(2));
    let mut values = vec![0f32; size[0] * size[1]];
    for (i, &inside) in region.inside.iter().enumerate() {
        if inside {
            values[i / w / 2 * size[0] + i % w / 2] += 1.0;
        }
    }
    let mut coarse = LayerRegion { size, wrap: region.wrap, inside: vec![false; values.len()] };
    let share = region.area() as f64 / (w * h) as f64;
    let area = libm::round(share * values.len() as f64) as usize;
    fill(&mut coarse, &values, &Bounds { free: None, area });
    coarse
}

/// A region at twice the resolution, of the given size.
pub(super) fn doubled(region: &LayerRegion, size: [usize; 2]) -> LayerRegion {
    let inside = (0..size[0] * size[1])
        .map(|i| {
            let at = [i % size[0] / 2, i / size[0] / 2];
            region.inside[at[1].min(region.size[1] - 1) * region.size[0] + at[0].min(region.size[0] - 1)]
        })
        .collect();
    LayerRegion { size, wrap: region.wrap, inside }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::nested;
    use super::*;

    #[test]
    fn shares_are_kept() {
        let inside = nested([61, 50], 2, 1).labels.iter().map(|&l| l == 1).collect();
        let region = LayerRegion { size: [61, 50], wrap: [false; 2], inside };
        let coarse = halved(&region);
        assert_eq!(coarse.size, [31, 25]);
        let share = |r: &LayerRegion| r.area() as f64 / r.inside.len() as f64;
        assert!((share(&coarse) - share(&region)).abs() < 1e-2);
        let same =
            doubled(&coarse, [61, 50]).inside.iter().zip(&region.inside).filter(|(a, b)| a == b).count();
        assert!(same > 61 * 50 * 9 / 10, "{same}");
    }
}
