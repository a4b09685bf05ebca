//! Products of cells with matrices of weights, and the storage of the sums.

use super::maps::WIDE;
use rten_simd::ops::{BitOps, NumOps};
use rten_simd::{Isa, SimdOp};

/// Number of cells computed together: as many as fit the registers.
pub(super) const TOGETHER: usize = 4;

/// A matrix of weights, inputs × outputs.
pub(super) struct Matrix {
    /// Number of vectors of outputs computed together, a strip.
    pub(super) vectors: usize,
    /// For each strip and each input, the weights of the outputs.
    weights: Vec<f32>,
    /// Number of weights of a strip.
    strip: usize,
}

impl Matrix {
    /// Prepares a matrix from the weight of each input and output. Inputs are padded to a multiple of
    /// [`WIDE`] with weight 0.
    pub(super) fn new(inputs: usize, outputs: usize, weight: impl Fn(usize, usize) -> f32) -> Self {
        let lanes = Lanes.dispatch();
        // AVX2 has half as many registers as the other instruction sets.
        let most = if lanes == 8 { 3 } else { 4 };
        let vectors = (1..=most).rev().find(|n| outputs.is_multiple_of(n * lanes)).unwrap_or(1);
        let size = vectors * lanes;
        let whole = inputs.next_multiple_of(WIDE);
        let mut weights = Vec::with_capacity(whole * outputs);
        for first in (0..outputs).step_by(size) {
            for k in 0..whole {
                weights.extend((first..first + size).map(|m| if k < inputs { weight(k, m) } else { 0.0 }));
            }
        }
        Self { vectors, weights, strip: whole * size }
    }

    /// The weights of each strip of outputs.
    pub(super) fn strips(&self) -> impl Iterator<Item = &[f32]> {
        self.weights.chunks_exact(self.strip)
    }

    /// The weights of a strip of outputs.
    pub(super) fn strip(&self, index: usize) -> &[f32] {
        &self.weights[index * self.strip..][..self.strip]
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
// No closures, because a closure that is not inlined is not vectorized.
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

/// How the sums of a convolution are stored.
#[derive(Clone, Copy)]
pub(super) struct SumStorage<'a> {
    pub(super) bias: &'a [f32],
    /// Whether they are added to the stored values.
    pub(super) add: bool,
    /// Lower bound of the stored values.
    pub(super) least: f32,
}

impl SumStorage<'_> {
    /// Stores the sums of some channels of a cell, without their bias.
    #[inline(always)]
    pub(super) fn store<I: Isa>(&self, isa: I, sum: I::F32, bias: &[f32], to: &mut [f32]) {
        let ops = isa.f32();
        let sum = ops.add(sum, ops.load(bias));
        let sum = if self.add { ops.add(sum, ops.load(to)) } else { sum };
        ops.store(ops.max(sum, ops.splat(self.least)), to);
    }
}
