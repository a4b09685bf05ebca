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

#[cfg(test)]
mod tests {
    use crate::partition::Partition;
    use crate::{AnalyzeParams, Exemplar, parts, pieces};
    use image::{Rgb, RgbImage};
    use vtex_base::raster::{LabelMap, Limits, Mask};
    use vtex_segment::segment::ScoredMask;

    /// A light disc of radius 24 with a shadow on it, in the middle of 80 × 80 px, and a dark speck in each corner.
    fn colour(x: u32, y: u32) -> [f64; 3] {
        let [u, v] = [x, y].map(|v| f64::from(v) - 39.5);
        let corner = libm::hypot(u.abs() - 32.0, v.abs() - 32.0);
        if libm::hypot(u, v) < 24.0 {
            let shadow = 60.0 * libm::exp(-(u * u + (v - 5.0) * (v - 5.0)) / 60.0);
            return [200.0, 180.0, 120.0].map(|own| own - shadow);
        }
        let dark = (3.6 - corner).clamp(0.0, 1.0);
        [70.0, 90.0, 80.0].map(|own| own * (1.0 - 0.7 * dark))
    }

    #[test]
    fn pieces_are_painted_where_and_as_they_are_seen() {
        let image = RgbImage::from_fn(80, 80, |x, y| Rgb(colour(x, y).map(|v| libm::round(v) as u8)));
        let mut png = std::io::Cursor::new(Vec::new());
        image.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let exemplar = Exemplar::from_bytes(&png.into_inner(), "disc.png", &Limits::default()).unwrap();
        let labels = image.pixels().map(|p| u32::from(p.0[0] > 110)).collect();
        let mut masks = Mask::all_of_labels(&LabelMap { width: 80, height: 80, labels }, 2);
        let mask = ScoredMask { mask: masks.pop().unwrap(), score: 1.0 };
        let params = AnalyzeParams::default();
        let partition = Partition::new(&exemplar, &[mask], &params, None);
        let known = vec![None; partition.primaries.len()];
        let (strata, parts) = parts(&partition, &known, None, &()).unwrap();
        let pieces = pieces(&partition, &strata, (parts, &known, None), &mut Vec::new(), &()).unwrap();
        assert_eq!(pieces.details.len(), 1);
        let painted = pieces.painted.unwrap();
        assert_eq!((painted.width, painted.colours.len()), (80, 6400));
        let off = |x: u32, y: u32| {
            let (own, wanted) = (painted.colours[(80 * y + x) as usize], image.get_pixel(x, y).0);
            (0..3).map(|c| (own[c] - f32::from(wanted[c])).abs()).fold(0.0, f32::max)
        };
        // On the shadow, beside it, between elements, on a speck.
        for at in [(39, 44), (25, 30), (40, 4), (5, 60), (7, 7), (72, 7)] {
            assert!(off(at.0, at.1) < 12.0, "{at:?}: {:?}", painted.colours[(80 * at.1 + at.0) as usize]);
        }
        let mean = (0..6400).map(|i| off(i % 80, i / 80)).sum::<f32>() / 6400.0;
        assert!(mean < 5.0, "{mean}");
    }
}
