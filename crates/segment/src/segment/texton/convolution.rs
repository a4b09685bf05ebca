//! Convolutions of maps with several channels.
//!
//! A library for networks in general copies the surroundings of each cell into a matrix first
//! ("im2col"), which for a network of few channels takes as long as the multiplications. Here the
//! multiplications read the maps themselves. For kernels of 3 × 3 weights applied to every cell, which
//! are most, a quarter of them is enough (`winograd.rs`).
//!
//! All sums have a fixed order, so results depend neither on threads nor on the width of vectors, given a
//! processor with fused multiply-add.

use super::maps::FeatureMaps;
use super::matrix::{Matrix, SumStorage, TOGETHER, multiply};
use super::winograd::{self, Tiles};
use rten_simd::ops::BitOps;
use rten_simd::{Isa, SimdOp};
use std::ops::Range;

/// How a convolution is computed.
enum ConvolutionForm {
    /// By one matrix for each weight of the kernel: `side`² of them, applied to every cell or every other.
    Direct { side: usize, step: usize },
    /// A kernel of 3 × 3, `dilation` cells apart, by the matrices of [`winograd`].
    Tiles { dilation: usize },
}

/// A convolution with zeros around its input.
pub(super) struct Convolution {
    form: ConvolutionForm,
    matrices: Vec<Matrix>,
    bias: Vec<f32>,
    /// Whether negative sums become 0.
    rectified: bool,
}

impl Convolution {
    /// Prepares a convolution from weights of shape outputs × inputs × `side` × `side` (`side` 1 or 3) and a
    /// bias for each output. The number of outputs is a multiple of the length of a vector. The convolution
    /// is applied at every `step`-th cell and row, with weights `dilation` cells apart. Direct convolutions
    /// have a dilation of 1.
    pub(super) fn new(weights: &[f32], bias: &[f32], side: usize, step: usize, dilation: usize) -> Self {
        let (outputs, taps) = (bias.len(), side * side);
        let inputs = weights.len() / (outputs * taps);
        let (form, matrices) = if side == 3 && step == 1 {
            (ConvolutionForm::Tiles { dilation }, winograd::matrices(weights, inputs, outputs))
        } else {
            let matrix = |tap| Matrix::new(inputs, outputs, |k, m| weights[(m * inputs + k) * taps + tap]);
            (ConvolutionForm::Direct { side, step }, (0..taps).map(matrix).collect())
        };
        Self { form, matrices, bias: bias.to_vec(), rectified: true }
    }

    /// The same convolution without rectification.
    pub(super) fn linear(self) -> Self {
        Self { rectified: false, ..self }
    }

    pub(super) fn of(&self, input: &FeatureMaps) -> FeatureMaps {
        let step = if let ConvolutionForm::Direct { step, .. } = self.form { step } else { 1 };
        let mut output = FeatureMaps::zeros(self.bias.len(), input.width / step, input.height / step);
        self.run(input, &mut output, 0, false);
        output
    }

    /// Some rows of a convolution that is applied at every cell. The sums equal those of [`Convolution::of`]
    /// if the first row is a multiple of [`winograd::TILE`] times the dilation.
    pub(super) fn of_rows(&self, input: &FeatureMaps, rows: Range<usize>) -> FeatureMaps {
        let mut output = FeatureMaps::zeros(self.bias.len(), input.width, rows.len());
        self.run(input, &mut output, rows.start, false);
        output
    }

    /// Adds the sums to the values of `output`.
    pub(super) fn add_to(&self, input: &FeatureMaps, output: &mut FeatureMaps) {
        self.run(input, output, 0, true);
    }

    /// `first` is the row of the output that is the first of those to compute.
    fn run(&self, input: &FeatureMaps, output: &mut FeatureMaps, first: usize, add: bool) {
        let least = if self.rectified { 0.0 } else { f32::NEG_INFINITY };
        let store = SumStorage { bias: &self.bias, add, least };
        let matrices = &self.matrices;
        match self.form {
            ConvolutionForm::Direct { side, step } => {
                let zeros = vec![0.0; input.channels];
                output.for_rows(1, |y, row| {
                    let y = first + y;
                    Row { matrices, side, step, input, zeros: &zeros, store, y, row }.dispatch();
                });
            }
            ConvolutionForm::Tiles { dilation } => {
                Tiles { matrices, dilation, input, top: first, store }.run(output)
            }
        }
    }
}

/// The work of one row of a direct convolution.
struct Row<'a> {
    matrices: &'a [Matrix],
    side: usize,
    step: usize,
    input: &'a FeatureMaps,
    /// A cell outside the input.
    zeros: &'a [f32],
    store: SumStorage<'a>,
    y: usize,
    row: &'a mut [f32],
}

impl SimdOp for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn eval<I: Isa>(self, isa: I) {
        match self.matrices[0].vectors {
            1 => self.sums::<I, 1>(isa),
            2 => self.sums::<I, 2>(isa),
            3 => self.sums::<I, 3>(isa),
            _ => self.sums::<I, 4>(isa),
        }
    }
}

impl Row<'_> {
    #[inline(always)]
    fn sums<I: Isa, const V: usize>(self, isa: I) {
        let ops = isa.f32();
        let Self { matrices, side, step, input, zeros, store, y, row } = self;
        let channels = store.bias.len();
        let size = V * ops.len();
        for (group, cells) in row.chunks_mut(TOGETHER * channels).enumerate() {
            for strip in 0..channels / size {
                let mut sums = [[ops.zero(); V]; TOGETHER];
                for (tap, matrix) in matrices.iter().enumerate() {
                    let at = |v: usize, tap: usize| (v * step + tap) as isize - (side / 2) as isize;
                    let row = at(y, tap / side);
                    let mut inputs = [zeros; TOGETHER];
                    for (k, inputs) in inputs.iter_mut().enumerate() {
                        *inputs = input.cell_or(at(group * TOGETHER + k, tap % side), row, zeros);
                    }
                    multiply(isa, inputs, matrix.strip(strip), &mut sums);
                }
                let bias = &store.bias[strip * size..][..size];
                for (cell, sums) in cells.chunks_exact_mut(channels).zip(sums) {
                    let to = cell[strip * size..][..size].chunks_exact_mut(ops.len());
                    for ((to, bias), sum) in to.zip(bias.chunks_exact(ops.len())).zip(sums) {
                        store.store(isa, sum, bias, to);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::maps::WIDE;
    use super::*;
    use proptest::prelude::*;

    /// Some numbers between -1 and 1.
    fn values(count: usize, seed: u32) -> Vec<f32> {
        let value = |k: u32| ((k ^ seed).wrapping_mul(2_654_435_761) >> 16) as f32 / 32_768.0 - 1.0;
        (0..count as u32).map(value).collect()
    }

    fn maps(channels: usize, width: usize, height: usize, seed: u32) -> FeatureMaps {
        FeatureMaps::of(channels, width, height, values(channels * width * height, seed))
    }

    /// The sums of a cell by definition, in double precision.
    fn sums(
        weights: &[f32],
        input: &FeatureMaps,
        [x, y]: [usize; 2],
        [side, step, dilation]: [usize; 3],
    ) -> Vec<f64> {
        let zeros = vec![0.0; input.channels];
        let at = |v: usize, k: usize| (v * step + k * dilation) as isize - (side / 2 * dilation) as isize;
        let mut sums = Vec::new();
        for weights in weights.chunks_exact(input.channels * side * side) {
            let mut sum = 0.0;
            for (ky, kx) in (0..side).flat_map(|ky| (0..side).map(move |kx| (ky, kx))) {
                let cell = input.cell_or(at(x, kx), at(y, ky), &zeros);
                let weight = |channel: usize| weights[(channel * side + ky) * side + kx];
                sum += (0..input.channels).map(|k| f64::from(weight(k)) * f64::from(cell[k])).sum::<f64>();
            }
            sums.push(sum);
        }
        sums
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn sums_are_those_of_the_definition(
            inputs in 1..3usize,
            outputs in prop::sample::select(vec![1, 2, 3, 5, 8]),
            (width, height) in (1..40usize, 1..20usize),
            (side, step, dilation) in
                prop::sample::select(vec![(1, 1, 1), (3, 2, 1), (3, 1, 1), (3, 1, 2), (3, 1, 4)]),
            seed in any::<u32>(),
        ) {
            let [inputs, outputs] = [inputs, outputs].map(|n| n * WIDE);
            // Weights are small, like trained ones, so that sums are about 1.
            let weights: Vec<f32> =
                values(outputs * inputs * side * side, seed).iter().map(|v| v / 8.0).collect();
            let bias = values(outputs, !seed);
            let input = maps(inputs, width * step, height * step, seed / 2);
            let convolution = Convolution::new(&weights, &bias, side, step, dilation);
            let rectified = convolution.of(&input);
            prop_assert_eq!([rectified.width, rectified.height], [width, height]);
            let before = maps(outputs, width, height, 7);
            let mut added = maps(outputs, width, height, 7);
            convolution.linear().add_to(&input, &mut added);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let sums = sums(&weights, &input, [x, y], [side, step, dilation]);
                for (channel, sum) in sums.into_iter().enumerate() {
                    let sum = f64::from(bias[channel]) + sum;
                    prop_assert!((f64::from(rectified.cell(x, y)[channel]) - sum.max(0.0)).abs() < 1e-4);
                    let sum = sum + f64::from(before.cell(x, y)[channel]);
                    prop_assert!((f64::from(added.cell(x, y)[channel]) - sum).abs() < 1e-4);
                }
            }
        }
    }

    #[test]
    fn bands_of_rows_are_those_of_the_whole() {
        for (side, dilation) in [(1, 1), (3, 1), (3, 2)] {
            let convolution =
                Convolution::new(&values(WIDE * WIDE * side * side, 3), &values(WIDE, 4), side, 1, dilation);
            let input = maps(WIDE, 21, 37, 5);
            let whole = convolution.of(&input).into_values();
            let mut all = FeatureMaps::zeros(WIDE, 21, 37);
            let band = 2 * winograd::TILE * dilation;
            for first in (0..37).step_by(band) {
                all.set_rows(first, convolution.of_rows(&input, first..37.min(first + band)));
            }
            assert_eq!(all.into_values(), whole, "{side}, {dilation}");
        }
    }

    #[test]
    fn inputs_that_do_not_fill_a_vector_count_as_zeros() {
        let weights = values(WIDE * 3, 5);
        let convolution = Convolution::new(&weights, &[0.0; WIDE], 1, 1, 1).linear();
        let mut inputs = values(2 * WIDE, 9);
        let of = |inputs: &[f32]| convolution.of(&FeatureMaps::of(WIDE, 2, 1, inputs.to_vec())).into_values();
        let sums = of(&inputs);
        inputs[WIDE + 3..].fill(0.0);
        assert_eq!(sums, of(&inputs));
        let expected: f32 = (0..3).map(|k| weights[k] * inputs[k]).sum();
        assert!((sums[0] - expected).abs() < 1e-6);
    }
}
