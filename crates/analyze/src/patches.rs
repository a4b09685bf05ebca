//! Flat patches between the primaries, and the colours of masks.

use super::grid::{Cells, SubpixelGrid};
use super::strata::BehindElements;
use image::RgbImage;
use vtex_base::parallel;
use vtex_base::raster::Mask;
use vtex_base::raster::colour::{self, Colour};

/// A flat patch between the primaries.
#[derive(Clone)]
pub(super) struct FlatPatch {
    pub(super) mask: Cells<Mask>,
    /// Median colour of its pixels.
    pub(super) colour: Colour,
    /// Its colour minus the background's at its centroid, per component.
    pub(super) difference: [i16; 3],
}

/// Patches with their median colours, and these relative to the background's at their centroids, `behind`.
pub(super) fn flat_patches(
    image: &Cells<RgbImage>,
    masks: Vec<Cells<Mask>>,
    grid: SubpixelGrid,
    behind: &BehindElements<'_>,
) -> Vec<FlatPatch> {
    let found = parallel::map(&masks, |mask| {
        let colour = median(image, mask);
        (colour, difference(colour, behind.colour(grid.centroid(mask))))
    });
    masks
        .into_iter()
        .zip(found)
        .map(|(mask, (colour, difference))| FlatPatch { mask, colour, difference })
        .collect()
}

/// A colour minus the background's, per component.
pub(super) fn difference(colour: Colour, behind: [f64; 3]) -> [i16; 3] {
    let own = colour.to_f64();
    std::array::from_fn(|i| libm::round(own[i] - behind[i].clamp(0.0, 255.0)) as i16)
}

/// Median colour of the pixels of a mask.
pub(super) fn median(image: &Cells<RgbImage>, mask: &Cells<Mask>) -> Colour {
    colour::median(mask.pixels().map(|(x, y)| image.get_pixel(x as u32, y as u32).0)).unwrap_or_default()
}
