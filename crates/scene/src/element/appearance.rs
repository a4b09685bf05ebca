//! Statistics of the colours of an element.

use super::Shape;
use vtex_base::raster::colour::Colour;

/// The distribution of an element's visible colours, in Oklab, weighted by area. Shapes painted later hide
/// the first one; gradients count as their two ends, half each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Median of each component.
    pub median: [f32; 3],
    /// Mean of each component.
    pub mean: [f32; 3],
    /// Covariance LL, La, Lb, aa, ab, bb.
    pub covariance: [f32; 6],
}

impl Appearance {
    /// The appearance of an element's shapes. Its outline encloses `whole` pixels²; `own` replaces the paint
    /// of the first shape, if given.
    pub fn new(shapes: &[Shape], whole: f64, own: Option<Colour>) -> Self {
        let mut parts: Vec<([[f32; 3]; 2], f64)> = Vec::with_capacity(shapes.len());
        let mut covered = 0.0;
        for detail in &shapes[1..] {
            let area = detail.area();
            parts.push((ends(detail, None), area));
            covered += area;
        }
        parts.push((ends(&shapes[0], own), (whole - covered).max(0.0)));
        let all: f64 = covered + (whole - covered).max(0.0);
        if all <= 0.0 {
            let colour = own.unwrap_or(shapes[0].colour).to_oklab();
            return Self { median: colour, mean: colour, covariance: [0.0; 6] };
        }
        let mut sum = [0.0; 3];
        for ([a, b], area) in &parts {
            (0..3).for_each(|i| sum[i] += area * f64::from(a[i] + b[i]) / 2.0);
        }
        let mean = sum.map(|v| v / all);
        let mut squares = [0.0; 6];
        for (lab, area) in parts.iter().flat_map(|(ends, area)| ends.map(|lab| (lab, area / 2.0))) {
            let [l, a, b]: [f64; 3] = std::array::from_fn(|i| f64::from(lab[i]) - mean[i]);
            let products = [l * l, l * a, l * b, a * a, a * b, b * b];
            squares.iter_mut().zip(products).for_each(|(sum, v)| *sum += area * v);
        }
        Self {
            median: std::array::from_fn(|i| median(&parts, i, all)),
            mean: mean.map(|v| v as f32),
            covariance: squares.map(|v| (v / all) as f32),
        }
    }
}

/// The colours at both ends of a shape's paint.
fn ends(shape: &Shape, own: Option<Colour>) -> [[f32; 3]; 2] {
    let gradient = shape.gradient.as_ref().filter(|_| own.is_none());
    let plain = own.unwrap_or(shape.colour);
    gradient.map_or([plain; 2], |g| [g.start, g.end]).map(Colour::to_oklab)
}

/// Median of a component, by area.
fn median(parts: &[([[f32; 3]; 2], f64)], component: usize, all: f64) -> f32 {
    let values = parts.iter().flat_map(|(ends, area)| ends.map(|lab| (lab[component], area / 2.0)));
    let mut values: Vec<(f32, f64)> = values.collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    let middle = values.iter().find(|(_, area)| {
        below += area;
        below * 2.0 >= all
    });
    middle.or(values.last()).map_or(0.0, |(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Gradient;
    use vtex_base::geometry::{Outline, parse_path};

    fn shape(text: &str, grey: u8) -> Shape {
        Shape::new(Outline::new(&parse_path(text).unwrap()).unwrap(), Colour([grey; 3]))
    }

    #[test]
    fn the_largest_part_is_the_median_and_all_make_the_mean() {
        let shapes = [shape("M0 0h10v10h-10z", 60), shape("M1 1h5v5h-5z", 240)];
        let of = Appearance::new(&shapes, 100.0, None);
        let (dark, light) = (Colour([60; 3]).to_oklab()[0], Colour([240; 3]).to_oklab()[0]);
        assert_eq!(of.median[0], dark);
        assert!((of.mean[0] - (0.75 * dark + 0.25 * light)).abs() < 1e-6);
        let variance = 0.1875 * (light - dark) * (light - dark);
        assert!((of.covariance[0] - variance).abs() < 1e-6 && of.covariance[3].abs() < 1e-6);
        // The colour of an instance replaces that of the first shape.
        assert_eq!(Appearance::new(&shapes, 100.0, Some(Colour([9; 3]))).median, Colour([9; 3]).to_oklab());
        let mut shaded = shapes[0].clone();
        shaded.gradient =
            Some(Box::new(Gradient::linear([0.0; 2], [9.0, 0.0], [Colour([60; 3]), Colour([240; 3])])));
        let of = Appearance::new(&[shaded], 100.0, None);
        assert!((of.mean[0] - (dark + light) / 2.0).abs() < 1e-6 && of.covariance[0] > 0.01);
        let nothing = Appearance::new(&[shape("M0 0h9z", 60)], 0.0, None);
        assert_eq!((nothing.median[0], nothing.covariance), (dark, [0.0; 6]));
    }
}
