//! Pixels: decoding, label maps, run-length masks, components, distances, colour spaces.
//! Knows nothing of curves.

pub mod blur;
mod centre_lines;
pub mod colour;
pub mod colour_names;
mod components;
pub mod contact;
mod control_map;
pub mod css;
pub mod decode;
mod distance;
mod foreign;
mod jpeg;
mod labels;
mod mask;
pub mod oklab_map;
mod over_white;
pub mod picture;
mod profile;
mod resize;
mod tiff_tags;

pub use centre_lines::{CentreLine, Ink, centre_lines};
pub use components::{Connectivity, complement, components, components_of_mask, holes};
pub use control_map::ControlMap;
pub use decode::Limits;
pub use decode::{LARGEST_SIDE, check_size, decode, decode_colours, is_picture};
pub use distance::squared_distance;
pub use labels::LabelMap;
pub use mask::{Mask, Span};
pub use over_white::{decode_over_white, over_white};
pub use resize::{Filter, resized};

/// The index below `n` of the value that continues a row of `n` values at place `i`: that of the opposite end where the
/// row repeats (`wrap`), else mirrored, with the values at the ends twice.
#[inline]
pub fn continued(i: i64, n: usize, wrap: bool) -> usize {
    let size = n as i64;
    if (0..size).contains(&i) {
        return i as usize;
    }
    if wrap {
        return i.rem_euclid(size) as usize;
    }
    let i = i.rem_euclid(2 * size);
    i.min(2 * size - 1 - i) as usize
}

/// The pixels that share an edge with pixel `i` of a picture, counted row by row: left, right, above, below.
#[inline]
pub fn edge_neighbours(i: usize, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let x = i % width;
    let right = (x + 1 < width).then_some(i + 1);
    let below = (i + width < width * height).then_some(i + width);
    [(x > 0).then(|| i - 1), right, i.checked_sub(width), below].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_repeat_or_are_mirrored() {
        let row = |wrap| (-4..7).map(|i| continued(i, 3, wrap)).collect::<Vec<_>>();
        assert_eq!(row(true), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(row(false), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
    }
}
