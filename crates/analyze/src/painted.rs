//! The picture that pieces make, before borders that are out of focus are drawn so.

use super::grid::Cells;
use super::ground::{self, GroundSpot};
use super::partition::Partition;
use super::patches::FlatPatch;
use super::pursuit::{PaintedWindow, Shade};
use super::rate_distortion::RateDistortion;
use super::shading;
use super::strata::BehindElements;
use vtex_base::parallel;
use vtex_base::raster::Mask;

/// The picture of all pieces in the pixels of a photograph. Along crisp borders, pixels have the colours of both sides
/// by their shares.
pub(super) struct PaintedPicture {
    pub(super) width: usize,
    /// Components 0 to 255, row by row.
    pub(super) colours: Vec<[f32; 3]>,
}

impl PaintedPicture {
    /// Paints the background, spots and patches, and the pieces and soft ellipses of each element.
    pub(super) fn new(
        partition: &Partition<'_>,
        behind: &BehindElements<'_>,
        cost: RateDistortion,
        elements: &[(&[Cells<Mask>], &[Shade])],
        (patches, spots): (&[FlatPatch], &[GroundSpot]),
    ) -> Self {
        let grid = partition.grid;
        let (ground, elements) = parallel::join(
            || ground::painted(partition, behind, patches, spots),
            || {
                parallel::map(elements, |(details, shades)| {
                    let mut window = shading::window(&partition.clean, details, cost, grid);
                    window.draw(shades);
                    window
                })
            },
        );
        let width = ground.width;
        let shares = ground.painted.iter().zip(&ground.weight).map(|(p, w)| p.map(|v| v * w));
        let mut picture = Self { width, colours: shares.collect() };
        elements.iter().for_each(|window| picture.add(window));
        let share = 1.0 / grid.area() as f32;
        for patch in patches {
            let own = patch.colour.0.map(|v| share * f32::from(v));
            for (x, y) in patch.mask.pixels() {
                let colour = &mut picture.colours[ground::pixel(x, y, grid.cells, width)];
                (0..3).for_each(|c| colour[c] += own[c]);
            }
        }
        picture
    }

    /// Adds what is painted in a window, by its shares of pixels.
    fn add(&mut self, window: &PaintedWindow) {
        let [left, top] = window.corner.map(|v| v as i64);
        for (i, (painted, weight)) in window.painted.iter().zip(&window.weight).enumerate() {
            // Pixels beyond the border have no weight.
            if *weight > 0.0 {
                let (x, y) = (left + (i % window.width) as i64, top + (i / window.width) as i64);
                let colour = &mut self.colours[y as usize * self.width + x as usize];
                (0..3).for_each(|c| colour[c] += weight * painted[c]);
            }
        }
    }
}
