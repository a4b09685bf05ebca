//! Segments images of more than 4.8 megapixels: small elements from overlapping tiles, large ones from the
//! image at half its size, which may be tiled again. Memory is bounded.

use super::ScoredMask;
use super::disjoint::disjoint;
use image::RgbImage;
use image::imageops::crop_imm;
use vtex_base::error::Result;
use vtex_base::raster::{Filter, Mask, Span, resized};

/// Largest side of a square that is segmented at once, in pixels.
const LARGEST: u32 = 2200;
/// Overlap of tiles, in pixels. Longer elements are searched in the image at half its size.
const OVERLAP: u32 = 192;

/// The masks of an image of any size, given a method for images of up to [`LARGEST`]² pixels. Masks of larger
/// images are disjoint; borders of elements longer than [`OVERLAP`] are exact to two pixels.
///
/// # Errors
/// Those of the method.
pub(super) fn segment(
    image: &RgbImage,
    method: &dyn Fn(&RgbImage) -> Result<Vec<ScoredMask>>,
) -> Result<Vec<ScoredMask>> {
    let (width, height) = image.dimensions();
    if u64::from(width) * u64::from(height) <= u64::from(LARGEST) * u64::from(LARGEST) {
        return method(image);
    }
    let half = resized(image, width.div_ceil(2), height.div_ceil(2), Filter::Triangle);
    let mut offers = segment(&half, method)?;
    drop(half);
    for offer in &mut offers {
        offer.mask = twice(&offer.mask, width, height);
    }
    offers.retain(|offer| length(&offer.mask) > OVERLAP / 2);
    for (y, tall) in tiles(height) {
        for (x, wide) in tiles(width) {
            let tile = crop_imm(image, x, y, wide, tall).to_image();
            let cut = |mask: &Mask| {
                mask.bounds().is_none_or(|(x0, y0, x1, y1)| {
                    (x0 == 0 && x > 0)
                        || (y0 == 0 && y > 0)
                        || (x1 as u32 == wide && x + wide < width)
                        || (y1 as u32 == tall && y + tall < height)
                })
            };
            let found = method(&tile)?.into_iter();
            let whole = found.filter(|found| length(&found.mask) <= OVERLAP && !cut(&found.mask));
            offers.extend(whole.map(|found| {
                let moved = |s: &Span| Span { y: s.y + y as i32, x0: s.x0 + x as i32, x1: s.x1 + x as i32 };
                let mask = Mask::from_spans(found.mask.spans().iter().map(moved).collect());
                ScoredMask { mask, ..found }
            }));
        }
    }
    Ok(disjoint(&offers, width, height))
}

/// Width and height of each image that [`segment`] passes to its method, in their order: one, or the image at half its
/// size or less, and then its tiles.
pub fn pieces([width, height]: [u32; 2]) -> Vec<[u32; 2]> {
    if u64::from(width) * u64::from(height) <= u64::from(LARGEST) * u64::from(LARGEST) {
        return vec![[width, height]];
    }
    let mut all = pieces([width.div_ceil(2), height.div_ceil(2)]);
    all.extend(
        tiles(height).iter().flat_map(|(_, tall)| tiles(width).into_iter().map(|(_, wide)| [wide, *tall])),
    );
    all
}

/// Start and length of each tile of a side.
fn tiles(side: u32) -> Vec<(u32, u32)> {
    if side <= LARGEST {
        return vec![(0, side)];
    }
    let count = (side - OVERLAP).div_ceil(LARGEST - OVERLAP);
    let length = (side + (count - 1) * OVERLAP).div_ceil(count);
    (0..count).map(|k| ((side - length) * k / (count - 1), length)).collect()
}

/// The longer side of a mask's box.
fn length(mask: &Mask) -> u32 {
    mask.bounds().map_or(0, |(x0, y0, x1, y1)| (x1 - x0).max(y1 - y0) as u32)
}

/// A mask at twice its size, within an image.
fn twice(mask: &Mask, width: u32, height: u32) -> Mask {
    let mut spans = Vec::with_capacity(2 * mask.spans().len());
    for s in mask.spans() {
        let (x0, x1) = (2 * s.x0, (2 * s.x1).min(width as i32));
        spans.extend((2 * s.y..(2 * s.y + 2).min(height as i32)).map(|y| Span { y, x0, x1 }));
    }
    Mask::from_spans(spans)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::raster::{Connectivity, LabelMap, components};

    /// Every piece of white pixels.
    fn white(image: &RgbImage) -> Result<Vec<ScoredMask>> {
        assert!(image.width() * image.height() <= LARGEST * LARGEST);
        let labels = image.pixels().map(|p| u32::from(p.0[0] > 127)).collect();
        let map = LabelMap { width: image.width(), height: image.height(), labels };
        let (pieces, owners) = components(&map, Connectivity::Four);
        let masks = Mask::all_of_labels(&pieces, owners.len()).into_iter().zip(owners);
        let white = masks.filter(|(_, owner)| *owner == 1);
        Ok(white.map(|(mask, _)| ScoredMask { mask, score: 0.9 }).collect())
    }

    #[test]
    fn elements_of_any_size_and_place_are_found_once() {
        // Discs of radius 3 to 700, among them some on the borders of tiles.
        let mut discs = vec![(900.0, 1000.0, 700.0), (2150.0, 300.0, 90.0), (2400.0, 1500.0, 150.0)];
        discs.extend((0..40).map(|k| (1800.0 + 40.0 * f64::from(k), 2000.0, 3.0 + f64::from(k % 5))));
        let (width, height) = (4001, 2103);
        let image = RgbImage::from_fn(width, height, |x, y| {
            let inside = |&(cx, cy, r): &(f64, f64, f64)| {
                let (dx, dy) = (f64::from(x) + 0.5 - cx, f64::from(y) + 0.5 - cy);
                dx * dx + dy * dy < r * r
            };
            Rgb([if discs.iter().any(inside) { 255 } else { 0 }; 3])
        });
        let found = segment(&image, &white).unwrap();
        assert_eq!(found.len(), discs.len());
        for (cx, cy, r) in discs {
            let holds = |m: &&ScoredMask| m.mask.contains(cx as i32, cy as i32);
            let [mask] = found.iter().filter(holds).collect::<Vec<_>>()[..] else { panic!("{cx} {cy}") };
            let area = std::f64::consts::PI * r * r;
            assert!((f64::from(mask.mask.area()) - area).abs() < 4.0 * r + 4.0, "{cx} {cy}");
        }
    }

    #[test]
    fn pieces_are_what_is_segmented_one_after_the_other() {
        for size in [[500, 400], [2500, 2000], [9000, 500]] {
            let seen = std::cell::RefCell::new(Vec::new());
            let method = |image: &RgbImage| {
                seen.borrow_mut().push(<[u32; 2]>::from(image.dimensions()));
                Ok(Vec::new())
            };
            segment(&RgbImage::new(size[0], size[1]), &method).unwrap();
            assert_eq!(seen.into_inner(), pieces(size));
        }
        assert_eq!(pieces([4000, 3000]).len(), 5);
    }

    #[test]
    fn tiles_cover_a_side_and_overlap() {
        for side in [1, LARGEST, LARGEST + 1, 4096, 5000, 9999] {
            let tiles = tiles(side);
            assert_eq!((tiles[0].0, tiles.last().map(|t| t.0 + t.1)), (0, Some(side)));
            assert!(tiles.iter().all(|t| t.1 <= LARGEST));
            assert!(tiles.windows(2).all(|t| t[0].0 + t[0].1 >= t[1].0 + OVERLAP), "{side}");
        }
    }
}
