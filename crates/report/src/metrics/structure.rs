//! Structure larger than a few elements: the spread of block means.

use image::RgbImage;
use serde::Serialize;
use vtex_base::raster::colour::oklab;

/// Sides of the blocks, in pixels.
const BLOCKS: [u32; 4] = [16, 32, 64, 128];
/// Least number of blocks along each side.
const FEWEST: u32 = 3;

/// Spread of the mean colours of square blocks: the contrast that remains from afar.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Side of the blocks, in pixels.
    pub block: u32,
    /// Standard deviation of the exemplar's block means in Oklab, over all components.
    pub exemplar: f64,
    /// Standard deviation of the result's block means in Oklab, over all components.
    pub result: f64,
    /// Result over exemplar. Below 1 the result is too even, above 1 too patchy. `None` if the exemplar
    /// has no spread.
    pub ratio: Option<f64>,
}

/// The spread at each block size for which both pictures hold at least three by three blocks.
pub(super) fn spreads(exemplar: &RgbImage, result: &RgbImage) -> Vec<Spread> {
    let of = |block: u32| {
        let (exemplar, result) = (spread(exemplar, block)?, spread(result, block)?);
        let ratio = (exemplar > 0.0).then(|| result / exemplar);
        Some(Spread { block, exemplar, result, ratio })
    };
    BLOCKS.into_iter().filter_map(of).collect()
}

fn spread(image: &RgbImage, block: u32) -> Option<f64> {
    let (columns, rows) = (image.width() / block, image.height() / block);
    if columns < FEWEST || rows < FEWEST {
        return None;
    }
    let mut means = vec![[0f64; 3]; (columns * rows) as usize];
    for y in 0..rows * block {
        for x in 0..columns * block {
            let mean = &mut means[(y / block * columns + x / block) as usize];
            let colour = oklab(image.get_pixel(x, y).0);
            (0..3).for_each(|c| mean[c] += f64::from(colour[c]) / f64::from(block * block));
        }
    }
    let count = means.len() as f64;
    let variance = |c: usize| {
        let mean = means.iter().map(|m| m[c]).sum::<f64>() / count;
        means.iter().map(|m| (m[c] - mean) * (m[c] - mean)).sum::<f64>() / count
    };
    Some(libm::sqrt((0..3).map(variance).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn a_checkerboard_is_even_in_blocks_that_hold_several_of_its_squares() {
        let board = |side: u32| {
            RgbImage::from_fn(384, 192, |x, y| {
                Rgb([if (x / side + y / side).is_multiple_of(2) { 220 } else { 60 }; 3])
            })
        };
        let found = spreads(&board(32), &board(8));
        assert_eq!(found.iter().map(|s| s.block).collect::<Vec<_>>(), [16, 32, 64]);
        assert!(found[0].exemplar > 0.2 && (found[0].exemplar - found[1].exemplar).abs() < 1e-9);
        assert!(found[2].exemplar < 1e-9 && found.iter().all(|s| s.result < 1e-9));
        let same = spreads(&board(32), &board(32));
        assert!(same[..2].iter().all(|s| s.ratio == Some(1.0)));
    }
}
