//! Whether the opposite borders of a picture join.

use super::clip::page;
use super::pieces::{DrawingPiece, PieceShape};
use image::RgbImage;
use kurbo::Shape as _;
use vtex_base::geometry::BezPath;

/// Largest share of the contrast at the borders that does not continue at the opposite ones.
const LOOSE: f64 = 0.5;
/// Largest shift along a border of a line that crosses it, in pixels, because lines may be slanted.
const SLANT: i64 = 3;
/// Least contrast assumed at an empty border, in 8-bit steps.
const LEAST: f64 = 0.5;
/// A line along a border is at least as long as this share of the border, and no wider than that one.
const LONG: f64 = 0.05;
const THIN: f64 = 0.02;
/// Least contrast of a line along a border.
const MARKED: f64 = 24.0;
/// Least distance of the middle of a line from the border beside which it stands whole, in widths of the line.
const BESIDE: f64 = 0.25;
/// Farthest that whole areas reach beyond the border, and longest edge of theirs along it, as shares of their shorter side.
const BEYOND: f64 = 0.2;
const EDGE: f64 = 0.1;
/// Largest distance from the border at which an edge lies along it, as a share of the page's shorter side.
const ALONG: f64 = 1e-3;

/// Whether the border may cut a piece. Those that stand beside it or touch it are whole, and say nothing of whether
/// opposite borders join.
pub(super) fn is_cut(piece: &DrawingPiece, size: [f64; 2]) -> bool {
    let is_cut = |part: &PieceShape| {
        let bounds = part.path.bounding_box();
        let side = bounds.width().min(bounds.height());
        let inside = part.stroke.as_ref().map_or(-BEYOND * side, |stroke| BESIDE * stroke.width);
        let leaves = !page(size).inflate(-inside, -inside).contains_rect(bounds);
        leaves || part.stroke.is_none() && lies_along(&part.path, size, EDGE * side)
    };
    piece.parts.iter().any(is_cut)
}

/// Whether an edge of at least this length lies along a border.
fn lies_along(path: &BezPath, size: [f64; 2], least: f64) -> bool {
    let near = ALONG * size[0].min(size[1]);
    path.segments().any(|segment| {
        let bounds = segment.bounding_box();
        let [across, along] = [[bounds.x0, bounds.x1], [bounds.y0, bounds.y1]];
        let lies = |[low, high]: [f64; 2], size: f64| {
            high.abs().max(low.abs()) <= near || (low - size).abs().max((high - size).abs()) <= near
        };
        lies(across, size[0]) && bounds.height() >= least || lies(along, size[1]) && bounds.width() >= least
    })
}

/// Whether opposite borders continue each other. Pictures with empty borders are periodic too.
pub(super) fn is_periodic(picture: &RgbImage) -> bool {
    let median = median(picture);
    let [across_x, across_y] = [true, false].map(|axis| border(picture, axis, median));
    let (off, seen) = (across_x[0] + across_y[0], across_x[1] + across_y[1]);
    off <= LOOSE * seen.max(LEAST * f64::from(picture.width() + picture.height()))
}

/// The median of each component, an estimate of the background.
fn median(picture: &RgbImage) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let mut counts = [0u64; 256];
        picture.pixels().for_each(|p| counts[usize::from(p.0[k])] += 1);
        let half = counts.iter().sum::<u64>() / 2;
        let mut sum = 0;
        counts
            .iter()
            .position(|n| {
                sum += n;
                sum > half
            })
            .unwrap_or(0) as u8
    })
}

/// Difference of two opposite borders, and their difference from the background, summed along them. Lines that lie along a
/// border do not cross it, and are left out.
fn border(picture: &RgbImage, across_x: bool, background: [u8; 3]) -> [f64; 2] {
    let (w, h) = picture.dimensions();
    let (last, length) = if across_x { (w - 1, h) } else { (h - 1, w) };
    let pixel = |v: u32, t: i64| {
        let t = t.rem_euclid(i64::from(length)) as u32;
        picture.get_pixel(if across_x { v } else { t }, if across_x { t } else { v }).0
    };
    let apart = |a: [u8; 3], b: [u8; 3]| (0..3).map(|k| f64::from(a[k].abs_diff(b[k]))).sum::<f64>() / 3.0;
    // On a page of one pixel, both borders are one.
    let depth = ((THIN * f64::from(length)) as u32).max(1).min(last);
    let is_marked = |v: u32, t: usize| apart(pixel(v, t as i64), background) >= MARKED;
    let mut is_along = vec![false; length as usize];
    for [edge, inside] in [[0, depth], [last, last - depth]] {
        let marked: Vec<bool> = (0..length as usize).map(|t| is_marked(edge, t)).collect();
        let mut start = 0;
        for run in marked.chunk_by(|a, b| a == b) {
            let places = start..start + run.len();
            start = places.end;
            let deep = places.clone().filter(|t| is_marked(inside, *t)).count();
            if run[0] && run.len() as f64 > LONG * f64::from(length) && 2 * deep < run.len() {
                is_along[places].fill(true);
            }
        }
    }
    let places = || (0..i64::from(length)).filter(|t| !is_along[*t as usize]);
    let off = |t: i64| {
        let near = (-SLANT..=SLANT).map(|s| apart(pixel(last, t), pixel(0, t + s)));
        near.fold(f64::INFINITY, f64::min)
    };
    let seen = |t: i64| (apart(pixel(last, t), background) + apart(pixel(0, t), background)) / 2.0;
    [places().map(off).sum(), places().map(seen).sum()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn pages_of_one_pixel_are_looked_at_too() {
        for size in [[1, 1], [90, 1], [1, 90]] {
            assert!(is_periodic(&RgbImage::from_pixel(size[0], size[1], Rgb([7; 3]))), "{size:?}");
        }
    }

    #[test]
    fn borders_that_go_on_join() {
        // Slanted bands whose period fits the width, or does not.
        let of = |periods: f64| {
            RgbImage::from_fn(120, 80, |x, y| {
                let phase = f64::from(x) / 120.0 * periods + f64::from(y) / 80.0;
                Rgb([if libm::sin(phase * std::f64::consts::TAU) > 0.5 { 30 } else { 200 }; 3])
            })
        };
        assert!(is_periodic(&of(2.0)));
        assert!(!is_periodic(&of(2.5)));
        // A line along one border says nothing; a wide area at one border does.
        let with = |thick: u32| {
            let bands = of(2.0);
            RgbImage::from_fn(120, 80, |x, y| {
                let is_dark = y >= 80 - thick && (5..95).contains(&x);
                if is_dark { Rgb([0; 3]) } else { *bands.get_pixel(x, y) }
            })
        };
        assert!(is_periodic(&with(1)));
        assert!(!is_periodic(&with(20)));
        assert!(is_periodic(&RgbImage::from_pixel(9, 9, Rgb([7; 3]))));
    }
}
