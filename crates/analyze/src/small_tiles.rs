//! Small tiles: pictures of one period, repeated until there is enough to see.
//!
//! Segmentation sees little in a picture of a few pixels, and nothing beyond its borders. A tile is therefore repeated
//! before anything else, and what comes of it keeps the period. Its elements are of a few pixels, so it is analysed
//! enlarged, and the masks of one copy serve for all.

use super::borders;
use image::RgbImage;
use image::imageops::crop_imm;
use vtex_base::raster::{Filter, Mask, resized};
use vtex_scene::lattice::Lattice;
use vtex_segment::segment::ScoredMask;

/// Side from which a picture is no small tile, in pixels: one of any structure, and one of fine structure.
const SMALL: [u32; 2] = [64, 128];
/// Side below which a picture is repeated whether or not its borders join, in pixels.
const TINY: u32 = 32;
/// Factor by which a tile is enlarged for its analysis. Even, so that periods are whole numbers of the guide's cells.
const ENLARGED: u32 = 2;
/// Least side of what is made of a tile, in pixels, and its least number of copies along a side.
const ENOUGH: [u32; 2] = [96, 3];

/// How often a picture is repeated along x and y before it is looked at: once each if it is no small tile.
pub(super) fn copies(image: &RgbImage) -> [u32; 2] {
    let size = [image.width(), image.height()];
    let least = size[0].min(size[1]);
    let [small, fine] = SMALL;
    if least >= fine || (least >= TINY && !borders::small_borders_join(image, least >= small)) {
        return [1; 2];
    }
    let [side, count] = ENOUGH;
    size.map(|own| if own >= fine { 1 } else { side.div_ceil(own).max(count) })
}

/// The picture repeated.
pub(super) fn repeated(image: &RgbImage, [across, down]: [u32; 2]) -> RgbImage {
    let (width, height) = image.dimensions();
    RgbImage::from_fn(across * width, down * height, |x, y| *image.get_pixel(x % width, y % height))
}

/// A picture made of copies, enlarged for its analysis. It stays periodic.
pub(super) fn enlarged(image: &RgbImage, copies: [u32; 2]) -> RgbImage {
    let [width, height] = period(image.dimensions().into(), copies);
    // Copies beside one hide the borders of the filter.
    let beside = repeated(&crop_imm(image, 0, 0, width, height).to_image(), [3; 2]);
    let [width, height] = [width, height].map(|side| ENLARGED * side);
    let large = resized(&beside, 3 * width, 3 * height, Filter::Lanczos);
    repeated(&crop_imm(&large, width, height, width, height).to_image(), copies)
}

/// The size of a tile of which copies make a picture of `size` pixels.
fn period(size: [u32; 2], copies: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|k| size[k] / copies[k])
}

/// The masks of one copy, for all copies in a picture of `size` pixels. Larger ones than a tile, which would overlap
/// their own copies, are left out.
pub(super) fn of_all_copies(masks: Vec<ScoredMask>, size: [u32; 2], copies: [u32; 2]) -> Vec<ScoredMask> {
    let period = period(size, copies).map(|side| side as i32);
    let counts = copies.map(|count| count as i32);
    let is_own = |mask: &Mask| {
        let Some((x, y)) = mask.centroid() else { return false };
        let is_middle = |k: usize| ([x, y][k] as i32).div_euclid(period[k]) == counts[k] / 2;
        is_middle(0) && is_middle(1) && i64::from(mask.area()) <= i64::from(period[0]) * i64::from(period[1])
    };
    let own: Vec<ScoredMask> = masks.into_iter().filter(|m| is_own(&m.mask)).collect();
    let shifts = |k: usize| -counts[k]..=counts[k];
    let places = shifts(1).flat_map(|y| shifts(0).map(move |x| [x * period[0], y * period[1]]));
    let high = size.map(|side| side as i32);
    let copy = |[dx, dy]: [i32; 2]| {
        let moved = own.iter().map(move |m| (m.mask.shifted(dx, dy).within([0; 2], high), m.score));
        moved.filter(|(mask, _)| !mask.is_empty()).map(|(mask, score)| ScoredMask { mask, score })
    };
    places.flat_map(copy).collect()
}

/// The lattice of a picture of `size` pixels that is made of copies.
pub(super) fn lattice(size: [u32; 2], copies: [u32; 2]) -> Option<Lattice> {
    let [width, height] = [0, 1].map(|k| f64::from(size[k]) / f64::from(copies[k]));
    Lattice::new(&[[width, 0.0], [0.0, height]]).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn tiles_are_repeated_until_they_are_large_enough() {
        let grey = |w: u32, h: u32| RgbImage::from_fn(w, h, |x, y| Rgb([(x * 7 + y * 31) as u8; 3]));
        assert_eq!(copies(&grey(9, 4)), [11, 24]);
        assert_eq!(copies(&grey(31, 500)), [4, 1]);
        assert_eq!(copies(&grey(40, 40)), [1, 1], "no tile");
        let waves = |w: u32, h: u32| {
            RgbImage::from_fn(w, h, |x, y| {
                let at =
                    |v: u32, side: u32| libm::sin(std::f64::consts::TAU * f64::from(v) / f64::from(side));
                Rgb([(120.0 + 50.0 * (at(x, w) + at(y, h))) as u8; 3])
            })
        };
        assert_eq!(copies(&waves(40, 40)), [3, 3]);
        assert_eq!(copies(&waves(127, 60)), [3, 3]);
        assert_eq!(copies(&waves(64, 64)), [1, 1], "large enough");
        let weave = |side: u32| {
            RgbImage::from_fn(side, side, |x, y| Rgb([if (x + y) % 5 == 0 { 60 } else { 90 }; 3]))
        };
        assert_eq!([weave(100), weave(101), weave(130)].map(|w| copies(&w)), [[3, 3], [1, 1], [1, 1]]);
        let tile = grey(9, 4);
        let whole = repeated(&tile, [12, 24]);
        assert_eq!(whole.dimensions(), (108, 96));
        assert!(whole.enumerate_pixels().all(|(x, y, p)| p == tile.get_pixel(x % 9, y % 4)));
        assert_eq!(lattice([108, 96], [12, 24]).unwrap().vectors, [[9.0, 0.0], [0.0, 4.0]]);
        let large = enlarged(&whole, [12, 24]);
        assert_eq!(large.dimensions(), (216, 192));
        assert!(large.enumerate_pixels().all(|(x, y, p)| p == large.get_pixel(x % 18, y % 8)));
    }

    #[test]
    fn all_copies_have_the_masks_of_one() {
        let square = |x: i32, y: i32, side: i32| {
            let spans = (y..y + side).map(|y| vtex_base::raster::Span { y, x0: x, x1: x + side }).collect();
            ScoredMask { mask: Mask::from_spans(spans), score: 1.0 }
        };
        // One of another copy, one that reaches out of the middle copy, and one larger than a copy.
        let masks = vec![square(1, 1, 4), square(12, 12, 4), square(17, 13, 4), square(9, 9, 12)];
        let all = of_all_copies(masks, [30, 30], [3, 3]);
        let has = |x, y| all.contains(&square(x, y, 4));
        assert!(has(12, 12) && has(2, 2) && has(22, 12) && has(7, 3) && has(17, 13) && !has(1, 1));
        // Nine of the first. Of the second three rows: two whole, and the two parts of the one that the border cuts.
        assert_eq!(all.len(), 9 + 3 * 4);
    }
}
