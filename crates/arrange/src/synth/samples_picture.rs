//! Pictures of the samples that an optimisation arranges, for people who inspect it.

use image::{Rgb, RgbImage};
#[cfg(feature = "clustered")]
use vtex_base::raster::picture::label_colour;
#[cfg(feature = "clustered")]
use vtex_cluster::LevelReport;
#[cfg(feature = "curves")]
use vtex_curves::CurveLevel;

/// Longest side of the picture, in pixels.
const LONGEST: f64 = 1024.0;
/// Half the width of lines, in pixels.
#[cfg(feature = "curves")]
const LINE: f64 = 1.2;
/// Colour of the lines between samples.
#[cfg(feature = "curves")]
const LINE_COLOUR: [u8; 3] = [150; 3];

/// The samples of a level, those of one cluster in one colour.
#[cfg(feature = "clustered")]
pub(super) fn cluster_picture(level: &LevelReport, size: [u32; 2]) -> RgbImage {
    let mut picture = SamplesPicture::new(size);
    for sample in &level.output {
        picture.dot(sample.at, 0.35 * level.distance, label_colour(sample.cluster + 1));
    }
    picture.image
}

/// The graph of a level: its edges, and its samples, ends orange, crossings green, others blue.
#[cfg(feature = "curves")]
pub(super) fn graph_picture(level: &CurveLevel, size: [u32; 2]) -> RgbImage {
    let mut picture = SamplesPicture::new(size);
    for [at, way] in &level.edges {
        picture.line(*at, [at[0] + way[0], at[1] + way[1]]);
    }
    for (at, edges) in &level.output {
        let colour = match edges {
            0 | 1 => [225, 87, 32],
            2 => [64, 110, 190],
            _ => [30, 130, 80],
        };
        picture.dot(*at, 0.12 * level.distance, colour);
    }
    picture.image
}

/// Lines and dots on white, over a canvas. Places are in its unit; parts beside it are cut off.
struct SamplesPicture {
    image: RgbImage,
    scale: f64,
}

impl SamplesPicture {
    fn new(size: [u32; 2]) -> Self {
        let scale = (LONGEST / f64::from(size[0].max(size[1]))).min(1.0);
        let [width, height] = size.map(|v| (libm::round(f64::from(v) * scale) as u32).max(1));
        Self { image: RgbImage::from_pixel(width, height, Rgb([255; 3])), scale }
    }

    /// Draws a line.
    #[cfg(feature = "curves")]
    fn line(&mut self, a: [f64; 2], b: [f64; 2]) {
        self.stroke(a, b, LINE, LINE_COLOUR);
    }

    /// Draws a dot of a radius in the canvas's unit, at least 1.5 pixels.
    fn dot(&mut self, at: [f64; 2], radius: f64, colour: [u8; 3]) {
        self.stroke(at, at, (radius * self.scale).max(1.5), colour);
    }

    /// Paints all that is within `reach` pixels of a segment, with a soft edge.
    fn stroke(&mut self, a: [f64; 2], b: [f64; 2], reach: f64, colour: [u8; 3]) {
        let [a, b] = [a, b].map(|p| p.map(|v| v * self.scale));
        let way = [b[0] - a[0], b[1] - a[1]];
        let square = way[0] * way[0] + way[1] * way[1];
        let along = |k: usize, end: u32| {
            let first = (a[k].min(b[k]) - reach - 1.0).clamp(0.0, f64::from(end)) as u32;
            first..(a[k].max(b[k]) + reach + 1.0).clamp(0.0, f64::from(end)) as u32
        };
        for y in along(1, self.image.height()) {
            for x in along(0, self.image.width()) {
                let p = [f64::from(x) + 0.5 - a[0], f64::from(y) + 0.5 - a[1]];
                let t = ((p[0] * way[0] + p[1] * way[1]) / square.max(1e-12)).clamp(0.0, 1.0);
                let off = [p[0] - t * way[0], p[1] - t * way[1]];
                let far = libm::sqrt(off[0] * off[0] + off[1] * off[1]);
                let share = (reach + 0.5 - far).clamp(0.0, 1.0);
                let pixel = &mut self.image.get_pixel_mut(x, y).0;
                for c in 0..3 {
                    let old = f64::from(pixel[c]);
                    pixel[c] = libm::round(old + share * (f64::from(colour[c]) - old)) as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "curves")]
    #[test]
    fn a_graph_is_drawn_where_it_is() {
        let level = CurveLevel {
            distance: 40.0,
            output: vec![([10.0, 25.0], 1), ([60.0, 25.0], 3), ([-40.0, 900.0], 2)],
            edges: vec![[[10.0, 25.0], [50.0, 0.0]]],
            ..CurveLevel::default()
        };
        let image = graph_picture(&level, [100, 50]);
        assert_eq!(image.dimensions(), (100, 50));
        let at = |x, y| image.get_pixel(x, y).0;
        assert_eq!([at(30, 24), at(10, 25), at(62, 25)], [LINE_COLOUR, [225, 87, 32], [30, 130, 80]]);
        assert_eq!([at(30, 20), at(70, 25), at(0, 49)], [[255; 3]; 3]);
    }

    #[cfg(feature = "clustered")]
    #[test]
    fn samples_of_large_canvases_are_drawn_smaller() {
        let output = vec![vtex_cluster::ClusterSample { at: [2048.0, 1024.0], cluster: 4 }];
        let level = LevelReport { distance: 100.0, output, ..LevelReport::default() };
        let image = cluster_picture(&level, [4096, 2048]);
        assert_eq!(image.dimensions(), (1024, 512));
        assert_eq!(image.get_pixel(512, 256).0, label_colour(5));
        assert_eq!(image.get_pixel(530, 256).0, [255; 3]);
    }
}
