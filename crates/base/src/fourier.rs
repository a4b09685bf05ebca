//! Two-dimensional Fourier transform of planes.

use crate::parallel;
use rustfft::num_complex::Complex;
use rustfft::{FftDirection, FftPlanner};

/// Complex values on a grid, row by row.
pub struct Spectrum {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The values.
    pub data: Vec<Complex<f64>>,
}

impl Spectrum {
    /// A spectrum's input: real values, row by row.
    pub fn new(width: usize, height: usize, values: impl Fn(usize, usize) -> f64) -> Self {
        let at = |i: usize| Complex::new(values(i % width, i / width), 0.0);
        Self { width, height, data: (0..width * height).map(at).collect() }
    }

    /// The unscaled transform, transposed. A second transform restores the order of columns and rows.
    pub fn transformed(self, direction: FftDirection) -> Self {
        self.rows(direction).transposed().rows(direction)
    }

    fn rows(mut self, direction: FftDirection) -> Self {
        let transform = FftPlanner::new().plan_fft(self.width, direction);
        // Several rows share one scratch buffer.
        parallel::for_chunks(&mut self.data, self.width * 16, |_, rows| transform.process(rows));
        self
    }

    fn transposed(self) -> Self {
        let mut data = vec![Complex::default(); self.data.len()];
        // Transposed in strips, which keeps memory accesses local.
        parallel::for_chunks(&mut data, self.height * 16, |strip, columns| {
            for y in 0..self.height {
                for (k, column) in columns.chunks_exact_mut(self.height).enumerate() {
                    column[y] = self.data[y * self.width + strip * 16 + k];
                }
            }
        });
        Self { width: self.height, height: self.width, data }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_again() {
        let value = |x: usize, y: usize| ((x * 7 + y * 13) % 11) as f64;
        let back = Spectrum::new(37, 20, value)
            .transformed(FftDirection::Forward)
            .transformed(FftDirection::Inverse);
        assert_eq!((back.width, back.height), (37, 20));
        for (i, found) in back.data.iter().enumerate() {
            assert!((found.re / 740.0 - value(i % 37, i / 37)).abs() < 1e-9 && found.im.abs() < 1e-6);
        }
    }

    #[test]
    fn a_wave_is_one_frequency() {
        let wave = |x: usize, _: usize| libm::cos(std::f64::consts::TAU * 3.0 * x as f64 / 24.0);
        let found = Spectrum::new(24, 10, wave).transformed(FftDirection::Forward);
        for (i, value) in found.data.iter().enumerate() {
            let (y, x) = (i % 10, i / 10);
            let wanted = if y == 0 && (x == 3 || x == 21) { 120.0 } else { 0.0 };
            assert!((value.re - wanted).abs() < 1e-9, "{x} {y} {value}");
        }
    }
}
