//! Backgrounds with fewer control points, and scenes with fewer colours.

use std::collections::BTreeMap;
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{ControlPoint, Element, Field, Scene, Shape};

/// A field whose control points lie `factor` times as far apart: one for each cell of a grid that divides the canvas, at
/// the mean of the points within, with their mean colour.
pub(super) fn coarser(field: &Field, size: [f64; 2], factor: f64) -> Field {
    let spacing = (field.spacing * factor).max(1.0);
    // A whole number of cells, so that a field that tiles stays even across the seam.
    let side = size.map(|length| length / libm::round(length / spacing).max(1.0));
    let mut cells: BTreeMap<[i64; 2], ([f64; 5], f64)> = BTreeMap::new();
    for point in &field.points {
        let cell = [point.x / side[0], point.y / side[1]].map(|v| libm::floor(v) as i64);
        let [r, g, b] = point.colour.to_f64();
        let (sums, count) = cells.entry(cell).or_default();
        sums.iter_mut().zip([point.x, point.y, r, g, b]).for_each(|(sum, v)| *sum += v);
        *count += 1.0;
    }
    let mean = |(sums, count): ([f64; 5], f64)| {
        let [x, y, r, g, b] = sums.map(|sum| sum / count);
        ControlPoint { x, y, colour: Colour::from_f64([r, g, b]) }
    };
    Field { spacing, points: cells.into_values().map(mean).collect(), ..field.clone() }
}

/// The scene with colours of elements rounded to multiples of `step` along the axes of Oklab, and one colour in place of
/// each gradient.
pub(super) fn rounded(mut scene: Scene, step: f32) -> Scene {
    let round = |colour: Colour| Colour::from_oklab(colour.to_oklab().map(|v| libm::roundf(v / step) * step));
    let plain = |shape: &Shape| Shape { gradient: None, ..shape.recoloured(round) };
    scene.elements = parallel::map(&scene.elements, |element| Element {
        silhouette: element.silhouette.clone(),
        shapes: element.shapes.iter().map(plain).collect(),
        ..*element
    });
    for instance in scene.instances_mut() {
        instance.colour = instance.colour.map(round);
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use std::collections::BTreeSet;

    #[test]
    fn coarser_fields_keep_their_mean_and_have_fewer_points() {
        let scene = testing::scene(300, 200, 1);
        let field = scene.layers.iter().find_map(|layer| layer.field.as_ref()).unwrap();
        let coarse = coarser(field, [300.0, 200.0], 3.0);
        let ratio = field.points.len() as f64 / coarse.points.len() as f64;
        assert!((4.0..14.0).contains(&ratio), "{ratio}");
        let mean = |field: &Field| {
            field.points.iter().map(|p| p.colour.to_f64()[0]).sum::<f64>() / field.points.len() as f64
        };
        assert!((mean(field) - mean(&coarse)).abs() < 4.0);
        let flat = Field { points: Vec::new(), ..field.clone() };
        assert!(coarser(&flat, [300.0, 200.0], 3.0).points.is_empty());
    }

    #[test]
    fn rounded_colours_are_few_and_near() {
        let scene = testing::scene(300, 200, 2);
        let colours = |scene: &Scene| -> Vec<Colour> {
            scene.elements.iter().flat_map(|e| &e.shapes).map(|shape| shape.colour).collect()
        };
        let round = rounded(scene.clone(), 0.06);
        let count = |all: Vec<Colour>| all.iter().map(|c| c.0).collect::<BTreeSet<_>>().len();
        assert!(count(colours(&round)) * 3 < count(colours(&scene)));
        for (a, b) in colours(&scene).into_iter().zip(colours(&round)) {
            let [a, b] = [a, b].map(Colour::to_oklab);
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 0.04), "{a:?} {b:?}");
        }
        assert!(round.check().is_ok());
    }
}
