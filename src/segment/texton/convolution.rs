//! Convolutions of maps with several channels.
//!
//! A library for networks in general copies the surroundings of each cell into a matrix first
//! ("im2col"), which for a network of few channels takes as long as the multiplications. Here the
//! multiplications read the maps themselves, and a kernel of 3 × 3 weights needs a quarter of them
//! (`winograd.rs`).
//!
//! Every sum is taken in the same order, so results do not depend on threads, nor, among processors that
//! multiply and add in one step, on the width of their vectors.

use super::winograd::{self, Tiles};
use crate::parallel::for_chunks;
use rten_simd::ops::{BitOps, NumOps};
use rten_simd::{Isa, SimdOp};

/// Number of which channels are a multiple: the values of the widest vectors.
pub(super) const WIDE: usize = 16;
/// Number of cells computed together: as many as fit the registers.
pub(super) const TOGETHER: usize = 4;

/// Maps of the same size, one for each channel.
pub(super) struct Maps {
    /// A multiple of [`WIDE`].
    pub(super) channels: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    /// The channels of each cell, cells in rows.
    values: Vec<f32>,
}

impl Maps {
    pub(super) fn zeros(channels: usize, width: usize, height: usize) -> Self {
        assert!(channels.is_multiple_of(WIDE), "{channels} channels");
        Self { channels, width, height, values: vec![0.0; channels * width * height] }
    }

    /// The channels of each cell, cells in rows.
    pub(super) fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// The channels of a cell.
    pub(super) fn cell(&self, x: usize, y: usize) -> &[f32] {
        &self.values[(y * self.width + x) * self.channels..][..self.channels]
    }

    /// The channels of a cell, or `outside` where there is none.
    pub(super) fn cell_or<'a>(&'a self, x: isize, y: isize, outside: &'a [f32]) -> &'a [f32] {
        match (usize::try_from(x), usize::try_from(y)) {
            (Ok(x), Ok(y)) if x < self.width && y < self.height => self.cell(x, y),
            _ => outside,
        }
    }

    /// Does `f(k, rows)` for each `count` rows (fewer at the end), on several threads.
    pub(super) fn for_rows(&mut self, count: usize, f: impl Fn(usize, &mut [f32]) + Sync + Send) {
        for_chunks(&mut self.values, count * self.width * self.channels, f);
    }

    /// Adds maps of half the size, enlarged by linear interpolation.
    pub(super) fn add_enlarged(&mut self, half: &Self) {
        // The cell that is nearest, and the one that is next to it on the other side.
        let next = |v: usize, n: usize| {
            if v.is_multiple_of(2) { (v / 2).saturating_sub(1) } else { (v / 2 + 1).min(n - 1) }
        };
        let channels = self.channels;
        self.for_rows(1, |y, row| {
            let (near, far) = (y / 2, next(y, half.height));
            for (x, cell) in row.chunks_exact_mut(channels).enumerate() {
                let (here, beside) = (x / 2, next(x, half.width));
                let corners = half.cell(here, near).iter().zip(half.cell(here, far));
                let others = half.cell(beside, near).iter().zip(half.cell(beside, far));
                for ((value, (a, b)), (c, d)) in cell.iter_mut().zip(corners).zip(others) {
                    *value += 0.75 * (0.75 * a + 0.25 * b) + 0.25 * (0.75 * c + 0.25 * d);
                }
            }
        });
    }
}

/// A matrix of weights, inputs × outputs.
pub(super) struct Matrix {
    inputs: usize,
    /// Number of vectors of outputs computed together.
    pub(super) vectors: usize,
    /// For each strip of as many outputs as these vectors hold, and each input, their weights.
    weights: Vec<f32>,
}

impl Matrix {
    /// From the weight of each input and output. There are as many inputs as make whole vectors.
    pub(super) fn new(inputs: usize, outputs: usize, weight: impl Fn(usize, usize) -> f32) -> Self {
        let lanes = Lanes.dispatch();
        // AVX2 has half as many registers as the others have.
        let most = if lanes == 8 { 3 } else { 4 };
        let vectors = (1..=most).rev().find(|n| outputs.is_multiple_of(n * lanes)).unwrap_or(1);
        let size = vectors * lanes;
        let mut weights = Vec::with_capacity(inputs.next_multiple_of(WIDE) * outputs);
        for first in (0..outputs).step_by(size) {
            for k in 0..inputs.next_multiple_of(WIDE) {
                weights.extend((first..first + size).map(|m| if k < inputs { weight(k, m) } else { 0.0 }));
            }
        }
        Self { inputs: inputs.next_multiple_of(WIDE), vectors, weights }
    }

    /// The weights of each strip of outputs.
    pub(super) fn strips<const V: usize>(&self, lanes: usize) -> impl Iterator<Item = &[f32]> {
        self.weights.chunks_exact(self.inputs * V * lanes)
    }
}

/// The number of values of a vector.
struct Lanes;

impl SimdOp for Lanes {
    type Output = usize;

    fn eval<I: Isa>(self, isa: I) -> usize {
        isa.f32().len()
    }
}

/// Adds to `sums`, for each cell, the products of its inputs with a strip of weights.
// No closures here: where one is not inlined, it knows nothing of the vectors.
#[inline(always)]
pub(super) fn multiply<I: Isa, const V: usize>(
    isa: I,
    cells: [&[f32]; TOGETHER],
    strip: &[f32],
    sums: &mut [[I::F32; V]; TOGETHER],
) {
    let ops = isa.f32();
    for (k, weights) in strip.chunks_exact(V * ops.len()).enumerate() {
        let weights: [I::F32; V] = ops.load_many(weights);
        for (sums, cell) in sums.iter_mut().zip(cells) {
            let value = ops.splat(cell[k]);
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum = ops.mul_add(value, weight, *sum);
            }
        }
    }
}

/// How a convolution is computed.
enum Form {
    /// By one matrix for each weight of the kernel: `side`² of them, applied to every cell or every other.
    Direct { side: usize, step: usize },
    /// A kernel of 3 × 3, `dilation` cells apart, by the matrices of [`winograd`].
    Tiles { dilation: usize },
}

/// A convolution with zeros around its input.
pub(super) struct Convolution {
    form: Form,
    matrices: Vec<Matrix>,
    pub(super) bias: Vec<f32>,
    /// Whether negative sums become 0.
    rectified: bool,
}

impl Convolution {
    /// From weights of shape outputs × inputs × `side` × `side` (`side` 1 or 3) and a bias for each output, a
    /// multiple of [`WIDE`]. It is applied at every `step`-th cell and row; its weights are `dilation` cells
    /// apart, 1 where they are applied directly.
    pub(super) fn new(weights: &[f32], bias: &[f32], side: usize, step: usize, dilation: usize) -> Self {
        let (outputs, taps) = (bias.len(), side * side);
        let inputs = weights.len() / (outputs * taps);
        let (form, matrices) = if side == 3 && step == 1 {
            (Form::Tiles { dilation }, winograd::matrices(weights, inputs, outputs))
        } else {
            let matrix = |tap| Matrix::new(inputs, outputs, |k, m| weights[(m * inputs + k) * taps + tap]);
            (Form::Direct { side, step }, (0..taps).map(matrix).collect())
        };
        Self { form, matrices, bias: bias.to_vec(), rectified: true }
    }

    /// The same, but negative sums stay.
    pub(super) fn linear(self) -> Self {
        Self { rectified: false, ..self }
    }

    pub(super) fn of(&self, input: &Maps) -> Maps {
        let step = if let Form::Direct { step, .. } = self.form { step } else { 1 };
        let mut output = Maps::zeros(self.bias.len(), input.width / step, input.height / step);
        self.run(input, &mut output, false);
        output
    }

    /// Adds to the sums what `output` holds.
    pub(super) fn add_to(&self, input: &Maps, output: &mut Maps) {
        self.run(input, output, true);
    }

    fn run(&self, input: &Maps, output: &mut Maps, add: bool) {
        let least = if self.rectified { 0.0 } else { f32::NEG_INFINITY };
        let store = Store { bias: &self.bias, add, least };
        let matrices = &self.matrices;
        match self.form {
            Form::Direct { side, step } => {
                let zeros = vec![0.0; input.channels];
                output.for_rows(1, |y, row| {
                    Row { matrices, side, step, input, zeros: &zeros, store, y, row }.dispatch();
                });
            }
            Form::Tiles { dilation } => Tiles { matrices, dilation, input, store }.run(output),
        }
    }
}

/// What becomes of the sums of a convolution.
#[derive(Clone, Copy)]
pub(super) struct Store<'a> {
    pub(super) bias: &'a [f32],
    /// Whether they are added to what is there.
    add: bool,
    /// Smaller values become this.
    least: f32,
}

impl Store<'_> {
    /// Stores the sums of some channels of a cell, without their bias.
    #[inline(always)]
    pub(super) fn store<I: Isa>(&self, isa: I, sum: I::F32, bias: &[f32], to: &mut [f32]) {
        let ops = isa.f32();
        let sum = ops.add(sum, ops.load(bias));
        let sum = if self.add { ops.add(sum, ops.load(to)) } else { sum };
        ops.store(ops.max(sum, ops.splat(self.least)), to);
    }
}

/// The work of one row of a direct convolution.
struct Row<'a> {
    matrices: &'a [Matrix],
    side: usize,
    step: usize,
    input: &'a Maps,
    /// A cell outside the input.
    zeros: &'a [f32],
    store: Store<'a>,
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
                    let length = matrix.inputs * size;
                    multiply(isa, inputs, &matrix.weights[strip * length..][..length], &mut sums);
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
    use super::*;
    use proptest::prelude::*;

    /// Some numbers between -1 and 1.
    fn values(count: usize, seed: u32) -> Vec<f32> {
        let value = |k: u32| ((k ^ seed).wrapping_mul(2_654_435_761) >> 16) as f32 / 32_768.0 - 1.0;
        (0..count as u32).map(value).collect()
    }

    fn maps(channels: usize, width: usize, height: usize, seed: u32) -> Maps {
        Maps { channels, width, height, values: values(channels * width * height, seed) }
    }

    /// The sums of a cell as the definition has them.
    fn sums(
        weights: &[f32],
        input: &Maps,
        [x, y]: [usize; 2],
        [side, step, dilation]: [usize; 3],
    ) -> Vec<f32> {
        let zeros = vec![0.0; input.channels];
        let at = |v: usize, k: usize| (v * step + k * dilation) as isize - (side / 2 * dilation) as isize;
        let mut sums = Vec::new();
        for weights in weights.chunks_exact(input.channels * side * side) {
            let mut sum = 0.0;
            for (ky, kx) in (0..side).flat_map(|ky| (0..side).map(move |kx| (ky, kx))) {
                let cell = input.cell_or(at(x, kx), at(y, ky), &zeros);
                let weight = |channel: usize| weights[(channel * side + ky) * side + kx];
                sum += (0..input.channels).map(|k| weight(k) * cell[k]).sum::<f32>();
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
            let weights = values(outputs * inputs * side * side, seed);
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
                    let sum = bias[channel] + sum;
                    prop_assert!((rectified.cell(x, y)[channel] - sum.max(0.0)).abs() < 2e-4);
                    let sum = sum + before.cell(x, y)[channel];
                    prop_assert!((added.cell(x, y)[channel] - sum).abs() < 2e-4);
                }
            }
        }
    }

    #[test]
    fn inputs_that_do_not_fill_a_vector_count_as_zeros() {
        let weights = values(WIDE * 3, 5);
        let convolution = Convolution::new(&weights, &[0.0; WIDE], 1, 1, 1).linear();
        let mut input = maps(WIDE, 2, 1, 9);
        let sums = convolution.of(&input);
        input.values[WIDE + 3..].fill(0.0);
        assert_eq!(sums.values, convolution.of(&input).values);
        let expected: f32 = (0..3).map(|k| weights[k] * input.cell(0, 0)[k]).sum();
        assert!((sums.cell(0, 0)[0] - expected).abs() < 1e-6);
    }

    #[test]
    fn what_is_linear_stays_so_enlarged() {
        let mut half = Maps::zeros(WIDE, 6, 4);
        for (k, value) in half.values.iter_mut().enumerate() {
            let (channel, x, y) = (k % WIDE, k / WIDE % 6, k / WIDE / 6);
            *value = (x + 10 * y + 100 * channel) as f32;
        }
        let mut whole = Maps::zeros(WIDE, 12, 8);
        whole.add_enlarged(&half);
        for (y, x) in (1..7).flat_map(|y| (1..11).map(move |x| (y, x))) {
            let expected = 100.0 + (x as f32 - 0.5) / 2.0 + 10.0 * (y as f32 - 0.5) / 2.0;
            assert!((whole.cell(x, y)[1] - expected).abs() < 1e-4, "{x} {y}");
        }
        assert_eq!(whole.cell(0, 0)[0], 0.0);
    }
}
