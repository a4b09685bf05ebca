//! The background field: linear radial basis functions through coloured points.
//!
//! Components are 8-bit sRGB values as floats (0 to 255), because that is the space in which SVG
//! gradients interpolate: what is evaluated here is what is painted.

use super::Field;

/// A field made ready for evaluation.
pub struct Interpolant {
    field: Field,
}

impl Interpolant {
    /// Prepares a field for a canvas of the given size, in pixels.
    pub fn new(field: &Field, _width: u32, _height: u32) -> Self {
        Self { field: field.clone() }
    }

    /// sRGB components (0 to 255, not rounded) at a point of the canvas, in pixels.
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        // Inverse distance weights stand in until the local solves are here.
        let mut sum = [0.0; 4];
        for p in &self.field.points {
            let d2 = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) + 1e-3;
            let w = 1.0 / (d2 * d2);
            let c = p.colour.to_f64();
            for k in 0..3 {
                sum[k] += w * c[k];
            }
            sum[3] += w;
        }
        if sum[3] > 0.0 { [0, 1, 2].map(|k| sum[k] / sum[3]) } else { self.field.fallback.to_f64() }
    }
}
