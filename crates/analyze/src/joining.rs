//! Region merging: joins details of a primary, or secondaries, where their union is cheaper.
//!
//! Each set of regions has an error, the squared difference to the photograph, and a rate, the bytes
//! that it takes in a file: a constant for each shape and its fill, plus a term for the length of
//! the border between two. The pair of neighbours whose union reduces the total cost most is joined
//! first, until no union reduces it. This is region merging after Mumford and Shah (Koepfler, Lopez
//! and Morel 1994), with bytes in place of border lengths and with flat or linear-gradient fills.

use super::grid::{Cells, SubpixelGrid};
use super::moments::PixelMoments;
use super::rate_distortion::{GRADIENT_BYTES, RateDistortion, SECONDARY_BYTES};
use image::RgbImage;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::raster::Mask;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::Gradient;

/// Bytes of a detail, not counting its border.
const DETAIL_BYTES: f64 = 45.0;

/// The linear gradient that fills a region (coordinates in pixels), or `None` if a flat fill is
/// cheaper.
pub(super) fn gradient(
    image: &Cells<RgbImage>,
    mask: &Cells<Mask>,
    cost: RateDistortion,
    grid: SubpixelGrid,
) -> Option<Gradient> {
    let origin = mask.centroid()?.into();
    let sums = PixelMoments::new(image, mask, origin);
    if cost.of_region(&sums).1 { sums.gradient(mask, origin, grid) } else { None }
}

/// Bytes of the details of one primary, beyond those of its outline.
pub(super) fn bytes(image: &Cells<RgbImage>, details: &[Cells<Mask>], cost: RateDistortion) -> f64 {
    let origin = details.first().and_then(|m| m.centroid()).map_or([0.0; 2], Into::into);
    let gradients = details.iter().filter(|m| cost.of_region(&PixelMoments::new(image, m, origin)).1).count();
    let border: u32 = borders(details).iter().flat_map(|b| b.values()).sum();
    DETAIL_BYTES * details.len().saturating_sub(1) as f64
        + cost.border_bytes * f64::from(border) / 2.0
        + GRADIENT_BYTES * gradients as f64
}

/// Joins the details of one primary; the result still tiles it.
pub(super) fn join(
    image: &Cells<RgbImage>,
    details: &[Cells<Mask>],
    cost: RateDistortion,
) -> Vec<Cells<Mask>> {
    unite(image, details, cost, DETAIL_BYTES, u32::MAX)
}

/// Joins secondaries, which have flat fills, up to unions of `largest` cells.
pub(super) fn join_secondaries(
    image: &Cells<RgbImage>,
    secondaries: &[Cells<Mask>],
    cost: RateDistortion,
    largest: u32,
) -> Vec<Cells<Mask>> {
    unite(
        image,
        secondaries,
        RateDistortion { gradient_area: f64::INFINITY, ..cost },
        SECONDARY_BYTES,
        largest,
    )
}

/// Joins disjoint masks while this reduces the cost. `shape` is the bytes of one shape, not counting
/// its border.
fn unite(
    image: &Cells<RgbImage>,
    masks: &[Cells<Mask>],
    cost: RateDistortion,
    shape: f64,
    largest: u32,
) -> Vec<Cells<Mask>> {
    if masks.len() < 2 {
        return masks.to_vec();
    }
    let origin = masks[0].centroid().map_or([0.0; 2], Into::into);
    let mut areas: Vec<u32> = masks.iter().map(|m| m.area()).collect();
    let mut regions: Vec<Option<PixelMoments>> =
        masks.iter().map(|m| Some(PixelMoments::new(image, m, origin))).collect();
    let mut borders = borders(masks);
    let mut version = vec![0u32; masks.len()];
    let saved = |regions: &[Option<PixelMoments>], a: usize, b: usize, border: u32| {
        let (x, y) = (regions[a].as_ref()?, regions[b].as_ref()?);
        let bytes = shape + cost.border_bytes * f64::from(border);
        let saved = cost.of_region(x).0 + cost.of_region(y).0 + bytes * cost.error_per_byte
            - cost.of_region(&x.with(y)).0;
        // Integers sort exactly.
        (saved > 0.0).then_some(libm::round(saved * 16.0) as u64)
    };
    let mut queue = BinaryHeap::new();
    for (a, neighbours) in borders.iter().enumerate() {
        for (&b, &border) in neighbours.range(a + 1..) {
            queue.extend(saved(&regions, a, b, border).map(|s| (s, Reverse((a, b)), 0, 0)));
        }
    }
    let mut sets = DisjointSets::new(masks.len());
    while let Some((_, Reverse((a, b)), at_a, at_b)) = queue.pop() {
        let stale = (version[a], version[b]) != (at_a, at_b);
        if stale || areas[a].saturating_add(areas[b]) > largest {
            continue;
        }
        let (Some(x), Some(y)) = (regions[a], regions[b].take()) else { continue };
        regions[a] = Some(x.with(&y));
        areas[a] += areas[b];
        sets.attach(a, b);
        version[a] += 1;
        version[b] += 1;
        for (c, border) in std::mem::take(&mut borders[b]) {
            borders[c].remove(&b);
            if c != a {
                *borders[a].entry(c).or_default() += border;
                *borders[c].entry(a).or_default() += border;
            }
        }
        for (&c, &border) in &borders[a] {
            let (low, high) = (a.min(c), a.max(c));
            let entry = saved(&regions, low, high, border);
            queue.extend(entry.map(|s| (s, Reverse((low, high)), version[low], version[high])));
        }
    }
    united(masks, sets)
}

/// Joins neighbours of the same colour.
pub(super) fn join_alike(
    details: &[Cells<Mask>],
    colour: impl Fn(&Cells<Mask>) -> Colour,
) -> Vec<Cells<Mask>> {
    let colours: Vec<Colour> = details.iter().map(colour).collect();
    let mut sets = DisjointSets::new(details.len());
    for (a, neighbours) in borders(details).iter().enumerate() {
        for &b in neighbours.keys().filter(|&&b| b > a && colours[a] == colours[b]) {
            sets.join(a, b);
        }
    }
    united(details, sets)
}

/// The unions, in the order of their first masks.
fn united(masks: &[Cells<Mask>], mut sets: DisjointSets) -> Vec<Cells<Mask>> {
    let (of, count) = sets.indices();
    let mut spans = vec![Vec::new(); count];
    for (mask, set) in masks.iter().zip(of) {
        spans[set as usize].extend_from_slice(mask.spans());
    }
    spans.into_iter().map(|spans| Cells(Mask::from_spans(spans))).collect()
}

/// For each mask, the neighbouring masks and the length of their common border, in cells.
fn borders(masks: &[Cells<Mask>]) -> Vec<BTreeMap<usize, u32>> {
    let mut rows: BTreeMap<i32, Vec<(i32, i32, usize)>> = BTreeMap::new();
    for (i, mask) in masks.iter().enumerate() {
        for s in mask.spans() {
            rows.entry(s.y).or_default().push((s.x0, s.x1, i));
        }
    }
    rows.values_mut().for_each(|row| row.sort_unstable());
    let mut found = vec![BTreeMap::new(); masks.len()];
    let mut meet = |a: usize, b: usize, length: i32| {
        if a != b {
            *found[a].entry(b).or_insert(0) += length as u32;
            *found[b].entry(a).or_insert(0) += length as u32;
        }
    };
    for (y, row) in &rows {
        for pair in row.windows(2).filter(|pair| pair[0].1 == pair[1].0) {
            meet(pair[0].2, pair[1].2, 1);
        }
        let below = rows.get(&(y + 1)).map_or(&[][..], Vec::as_slice);
        let mut k = 0;
        for &(x0, x1, a) in row {
            while k > 0 && below[k - 1].1 > x0 {
                k -= 1;
            }
            while k < below.len() && below[k].0 < x1 {
                meet(a, below[k].2, (x1.min(below[k].1) - x0.max(below[k].0)).max(0));
                k += 1;
            }
        }
    }
    found.into_iter().map(|all| all.into_iter().filter(|&(_, n)| n > 0).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::raster::Span;

    /// Columns of a picture 40 pixels wide and 30 high.
    fn column(x0: i32, x1: i32) -> Cells<Mask> {
        Cells(Mask::from_spans((0..30).map(|y| Span { y, x0, x1 }).collect()))
    }

    fn columns(width: i32) -> Vec<Cells<Mask>> {
        (0..40 / width).map(|k| column(k * width, (k + 1) * width)).collect()
    }

    const COST: RateDistortion =
        RateDistortion { gradient_area: 40.0, error_per_byte: 10.0, border_bytes: 9.0 };

    #[test]
    fn equal_neighbours_become_one_and_unlike_ones_stay() {
        let image =
            Cells(RgbImage::from_fn(40, 30, |x, _| Rgb(if x < 20 { [200, 40, 40] } else { [30, 60, 190] })));
        let joined = join(&image, &columns(5), COST);
        assert_eq!(joined, [column(0, 20), column(20, 40)]);
        assert_eq!(join(&image, &columns(5), RateDistortion { error_per_byte: 0.0, ..COST }).len(), 8);
        assert_eq!(join(&image, &columns(5), RateDistortion { error_per_byte: 1e9, ..COST }).len(), 1);
    }

    #[test]
    fn steps_of_a_slope_become_one_gradient() {
        let image = Cells(RgbImage::from_fn(40, 30, |x, _| Rgb([(x * 5) as u8, (200 - x * 3) as u8, 90])));
        let joined = join(&image, &columns(5), COST);
        assert_eq!(joined, [column(0, 40)]);
        let g = gradient(&image, &joined[0], COST, SubpixelGrid { cells: 1 }).unwrap();
        assert!((g.from[0] - g.to[0]).abs() > 38.0 && g.from[1] == g.to[1], "{g:?}");
        let flat = join(&image, &columns(5), RateDistortion { gradient_area: f64::INFINITY, ..COST });
        assert!(flat.len() > 3, "{}", flat.len());
        assert!(
            gradient(
                &image,
                &joined[0],
                RateDistortion { gradient_area: f64::INFINITY, ..COST },
                SubpixelGrid { cells: 1 }
            )
            .is_none()
        );
    }

    #[test]
    fn secondaries_stay_flat_and_within_the_largest_area() {
        let image = Cells(RgbImage::from_fn(40, 30, |x, _| Rgb([(x * 5) as u8, (200 - x * 3) as u8, 90])));
        let count = |error_per_byte, largest| {
            let joined =
                join_secondaries(&image, &columns(5), RateDistortion { error_per_byte, ..COST }, largest);
            assert!(joined.iter().all(|m| m.area() <= largest));
            joined.len()
        };
        assert_eq!([count(10.0, 300), count(200.0, 300), count(1e9, 299), count(1e9, 1200)], [8, 4, 8, 1]);
    }

    #[test]
    fn neighbours_of_one_colour_become_one() {
        let colour =
            |m: &Cells<Mask>| Colour([if m.contains(12, 0) || m.contains(17, 0) { 9 } else { 200 }; 3]);
        let joined = join_alike(&columns(5), colour);
        assert_eq!(joined, [column(0, 10), column(10, 20), column(20, 40)]);
    }

    #[test]
    fn borders_are_counted_along_both_axes() {
        let ring: Vec<Span> = (0..5)
            .flat_map(|y| {
                let inner = (1..4).contains(&y);
                if inner {
                    vec![Span { y, x0: 0, x1: 1 }, Span { y, x0: 4, x1: 5 }]
                } else {
                    vec![Span { y, x0: 0, x1: 5 }]
                }
            })
            .collect();
        let inside = (1..4).map(|y| Span { y, x0: 1, x1: 4 }).collect();
        let far = vec![Span { y: 9, x0: 0, x1: 5 }];
        let found = borders(&[ring, inside, far].map(|spans| Cells(Mask::from_spans(spans))));
        assert_eq!(found, [BTreeMap::from([(1, 12)]), BTreeMap::from([(0, 12)]), BTreeMap::new()]);
    }
}
