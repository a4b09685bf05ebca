//! Pictures of the target map, for people who inspect placement.

use super::model::{EMPTY, UNDEFINED};
use super::occupancy::Occupancy;
use image::{Rgb, RgbImage};
use vtex_base::raster::picture::label_colour;

/// States by category: placed textons in full colour, requests pale, empty cells white,
/// undefined ones grey.
pub(super) fn target(map: &Occupancy<'_>) -> RgbImage {
    canvas(map, |i| match map.state[i] {
        UNDEFINED => [150; 3],
        EMPTY => [255; 3],
        code if map.taken(i) => label_colour(u32::from(code)),
        code => label_colour(u32::from(code)).map(|v| v / 4 + 191),
    })
}

/// The placed textons, each in a colour of its own.
pub(super) fn placed(map: &Occupancy<'_>) -> RgbImage {
    canvas(map, |i| map.owner[i].as_placed().map_or([0; 3], |id| label_colour(id.0 + 1)))
}

fn canvas(map: &Occupancy<'_>, colour: impl Fn(usize) -> [u8; 3]) -> RgbImage {
    let [mx, my] = map.grid.margin;
    let [width, height] = map.grid.canvas();
    RgbImage::from_fn(width as u32, height as u32, |x, y| {
        Rgb(colour(map.grid.index(x as i32 + mx, y as i32 + my)))
    })
}
