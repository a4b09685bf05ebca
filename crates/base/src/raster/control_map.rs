//! Scalar maps that control synthesis over a canvas of any size.

/// A scalar map, row by row, stretched over a canvas of any size.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlMap {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

impl ControlMap {
    /// A map of `width` × `height` values. `None` if the number of values does not fit, is 0, or a value
    /// is not finite.
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Option<Self> {
        let count = width as usize * height as usize;
        let sound = count > 0 && values.len() == count && values.iter().all(|v| v.is_finite());
        sound.then_some(Self { width, height, values })
    }

    /// Width and height, in pixels of the map.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The values, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a point of a canvas of the given size, both in pixels. Bilinear between the centres
    /// of the map's pixels, constant beyond the outermost.
    pub fn at(&self, point: [f64; 2], canvas: [f64; 2]) -> f64 {
        let [value] = self.mixed(point, canvas, |v| [v]);
        value
    }

    /// Like [`ControlMap::at`], for values that are shares of a whole turn, 0 to 1. Interpolation takes the
    /// shorter way round.
    pub fn turn_at(&self, point: [f64; 2], canvas: [f64; 2]) -> f64 {
        use std::f64::consts::TAU;
        let direction = |v: f64| {
            let (sine, cosine) = libm::sincos(TAU * v);
            [sine, cosine]
        };
        let [sine, cosine] = self.mixed(point, canvas, direction);
        (libm::atan2(sine, cosine) / TAU).rem_euclid(1.0)
    }

    /// Maps the four nearest values with `of` and interpolates the results.
    fn mixed<const N: usize>(
        &self,
        point: [f64; 2],
        canvas: [f64; 2],
        of: impl Fn(f64) -> [f64; N],
    ) -> [f64; N] {
        let axis = |v: f64, size: f64, count: u32| {
            let v = (v / size * f64::from(count) - 0.5).clamp(0.0, f64::from(count - 1));
            let low = libm::floor(v);
            (low as usize, (low as usize + 1).min(count as usize - 1), v - low)
        };
        let (x0, x1, u) = axis(point[0], canvas[0], self.width);
        let (y0, y1, v) = axis(point[1], canvas[1], self.height);
        let value = |x: usize, y: usize| of(f64::from(self.values[y * self.width as usize + x]));
        let mix = |a: [f64; N], b: [f64; N], t: f64| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t);
        mix(mix(value(x0, y0), value(x1, y0), u), mix(value(x0, y1), value(x1, y1), u), v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretched_over_the_canvas() {
        let map = ControlMap::new(2, 1, vec![0.0, 2.0]).unwrap();
        let at = |x: f64, y: f64| map.at([x, y], [100.0, 40.0]);
        assert_eq!(
            [at(0.0, 0.0), at(25.0, 39.0), at(50.0, 7.0), at(75.0, 1.0), at(100.0, 9.0)],
            [0.0, 0.0, 1.0, 2.0, 2.0]
        );
        assert_eq!(at(-5.0, 900.0), 0.0);
    }

    #[test]
    fn turns_go_the_shorter_way_round() {
        let map = ControlMap::new(2, 1, vec![0.9, 0.1]).unwrap();
        let at = |x: f64| map.turn_at([x, 0.0], [100.0, 40.0]);
        let near = |a: f64, b: f64| (a - b).abs().min(1.0 - (a - b).abs()) < 1e-6;
        assert!(near(at(0.0), 0.9) && near(at(50.0), 0.0) && near(at(100.0), 0.1));
        assert!((0.9..1.0).contains(&at(40.0)) && (0.0..0.1).contains(&at(60.0)));
    }

    #[test]
    fn unsound_maps_are_refused() {
        assert!(ControlMap::new(2, 2, vec![0.0; 3]).is_none() && ControlMap::new(0, 5, vec![]).is_none());
        assert!(ControlMap::new(1, 1, vec![f32::NAN]).is_none());
    }
}
