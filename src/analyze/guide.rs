//! The guide: mean colours over coarse cells, which synthesis by correspondences follows.

use crate::lattice;
use crate::library::{Guide, Lattice, Picture};
use crate::raster::colour::{encoded, linear};
use image::{Rgb, RgbImage};

/// The guide of an exemplar. Colours are averaged in linear light, as seen from far away.
pub(crate) fn guide(image: &RgbImage) -> Guide {
    let (width, height) = image.dimensions();
    let cell = Guide::cell_for(width, height);
    let mean = |column: u32, row: u32| {
        let mut sum = [0f32; 3];
        let mut count = 0;
        for y in row * cell..((row + 1) * cell).min(height) {
            for x in column * cell..((column + 1) * cell).min(width) {
                let colour = image.get_pixel(x, y).0.map(linear);
                (0..3).for_each(|k| sum[k] += colour[k]);
                count += 1;
            }
        }
        Rgb(sum.map(|v| encoded(v / count as f32)))
    };
    Guide { cell, picture: Picture(RgbImage::from_fn(width.div_ceil(cell), height.div_ceil(cell), mean)) }
}

/// The lattice of an exemplar, found in its guide. `repeated` if the exemplar is one period of a drawing.
pub(crate) fn lattice(guide: &Guide, repeated: bool) -> Option<Lattice> {
    let found = lattice::find(&guide.picture.0, repeated)?;
    Some(found.scaled([f64::from(guide.cell); 2])).filter(|l| l.fault().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_the_mean_of_their_pixels() {
        let image = RgbImage::from_fn(5, 4, |x, _| if x < 2 { Rgb([200, 40, 40]) } else { Rgb([9, 9, 90]) });
        let guide = guide(&image);
        assert_eq!((guide.cell, guide.picture.0.dimensions()), (2, (3, 2)));
        let cells: Vec<_> = guide.picture.0.pixels().map(|p| p.0).collect();
        assert_eq!(cells[..3], [[200, 40, 40], [9, 9, 90], [9, 9, 90]]);
    }
}
