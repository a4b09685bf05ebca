//! Secondaries: small patches of uniform colour between the primaries.

use super::candidates::{OklabImage, spans_image};
use super::grid::Cells;
use super::neighbours::{edge_lengths, quantile};
use image::RgbImage;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::parallel;
use vtex_base::raster::{LabelMap, Mask, edge_neighbours};
use vtex_scene::library::AnalyzeParams;
use vtex_segment::segment::flood;

/// Result of the flood fill between the primaries.
pub(super) struct FloodedPatches {
    /// Small patches, in the order of their first pixel.
    pub(super) secondaries: Vec<Cells<Mask>>,
    /// Patches as large and as distinct as the primaries, which become primaries.
    pub(super) promoted: Vec<Cells<Mask>>,
}

/// Flood fills the area between the primaries. Patches as large as the median primary, with a rim as
/// strong, are promoted to primaries. Patches within the permitted range of sizes become
/// secondaries. All others are background.
pub(super) fn find(
    image: &Cells<RgbImage>,
    primaries: &Cells<LabelMap>,
    params: &Cells<AnalyzeParams>,
) -> FloodedPatches {
    let (w, h) = (image.width() as i32, image.height() as i32);
    let lab = OklabImage::new(image);
    let between = || {
        let mut regions = flood(image, &|i| primaries.labels[i] != 0, params.secondary_tolerance);
        join_fragments(image, &mut regions, params.secondary_minimum);
        let count = regions.labels.iter().max().map_or(0, |m| *m as usize) + 1;
        Mask::all_of_labels(&regions, count)
    };
    // Areas and rims of the primaries.
    let standing = || {
        let mut masks = Mask::all_of_labels(primaries, primaries.areas().len()).split_off(1);
        masks.retain(|m| m.area() > 0);
        let areas = masks.iter().map(|m| f64::from(m.area())).collect();
        (areas, parallel::map(&masks, |m| f64::from(lab.rim(m).0)))
    };
    let (masks, (areas, rims)) = parallel::join(between, standing);
    let median_area = quantile(areas, 0.5).unwrap_or(f64::INFINITY);
    let typical_rim = quantile(rims, 0.5).unwrap_or(f64::INFINITY);
    let mut patches = FloodedPatches { secondaries: Vec::new(), promoted: Vec::new() };
    for mask in masks.into_iter().skip(1) {
        let area = mask.area();
        if f64::from(area) >= median_area && !spans_image(&mask, w, h) {
            let (rim, cracks) = lab.rim(&mask);
            let length = f64::from(cracks) * std::f64::consts::FRAC_PI_4;
            let compact = 4.0 * std::f64::consts::PI * f64::from(area) > 0.2 * length * length;
            if compact && f64::from(rim) >= 0.8 * typical_rim {
                patches.promoted.push(Cells(mask));
                continue;
            }
        }
        if (params.secondary_minimum..=params.secondary_maximum).contains(&area) {
            patches.secondaries.push(Cells(mask));
        }
    }
    patches
}

/// Typical spacing in pixels: the 40th percentile of the lengths of Delaunay edges between centres
/// (paper §3.1.2). Edges that cross primaries or lie on the hull are left out. 0 if there are too
/// few.
pub(super) fn spacing(centres: &[[f64; 2]], primaries: &LabelMap) -> f64 {
    let across = |a: [f64; 2], b: [f64; 2]| {
        let steps = libm::ceil(libm::hypot(a[0] - b[0], a[1] - b[1])).max(1.0);
        (0..=steps as u32).any(|k| {
            let t = f64::from(k) / steps;
            let (x, y) = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
            primaries.at(libm::floor(x) as i64, libm::floor(y) as i64).is_some_and(|label| label != 0)
        })
    };
    let spacing = quantile(edge_lengths(centres, across), 0.4).unwrap_or(0.0);
    libm::round(spacing * 1000.0) / 1000.0
}

/// Joins regions of fewer than `minimum` pixels to the neighbour of nearest mean colour, as
/// Felzenszwalb and Huttenlocher do. Flood fill leaves many of them. Dropping them would remove
/// the finest grain of the photograph. A fragment without neighbours stays.
fn join_fragments(image: &RgbImage, regions: &mut LabelMap, minimum: u32) {
    let (w, n) = (regions.width as usize, regions.labels.len());
    let count = regions.labels.iter().max().map_or(0, |m| *m as usize) + 1;
    let mut sums = vec![[0.0f32; 4]; count];
    for (&label, pixel) in regions.labels.iter().zip(image.pixels()) {
        let s = &mut sums[label as usize];
        (0..3).for_each(|c| s[c] += f32::from(pixel.0[c]));
        s[3] += 1.0;
    }
    let mut small: Vec<usize> = (0..n)
        .filter(|&i| regions.labels[i] != 0 && sums[regions.labels[i] as usize][3] < minimum as f32)
        .collect();
    let mut joined = DisjointSets::new(count);
    // The nearest neighbour of every fragment that is still too small.
    const NONE: (f32, usize) = (f32::INFINITY, usize::MAX);
    let mut nearest = vec![NONE; count];
    loop {
        let mut fragments = Vec::new();
        small.retain(|&i| {
            let own = joined.root(regions.labels[i] as usize);
            if sums[own][3] >= minimum as f32 {
                return false;
            }
            for j in edge_neighbours(i, [w, n / w]).filter(|&j| regions.labels[j] != 0) {
                let other = joined.root(regions.labels[j] as usize);
                if other != own {
                    let (a, b) = (sums[own], sums[other]);
                    let d: f32 = (0..3).map(|c| a[c] / a[3] - b[c] / b[3]).map(|v| v * v).sum();
                    if nearest[own] == NONE {
                        fragments.push(own);
                    }
                    if (d, other) < nearest[own] {
                        nearest[own] = (d, other);
                    }
                }
            }
            true
        });
        if fragments.is_empty() {
            break;
        }
        fragments.sort_unstable();
        for own in fragments {
            let (_, other) = std::mem::replace(&mut nearest[own], NONE);
            let (a, b) = (joined.root(own), joined.root(other));
            if a != b {
                let (low, high) = (a.min(b), a.max(b));
                joined.attach(low, high);
                (0..4).for_each(|c| sums[low][c] += sums[high][c]);
            }
        }
    }
    for label in &mut regions.labels {
        *label = joined.root(*label as usize) as u32;
    }
}
