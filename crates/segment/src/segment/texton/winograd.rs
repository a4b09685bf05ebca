//! Convolutions with 3 × 3 weights by Winograd's method: 36 products give the 16 sums of a tile of 4 × 4
//! cells, which directly take 144.
//!
//! A tile's surroundings of 6 × 6 cells are transformed, multiplied by transformed weights and transformed
//! back; F(4×4, 3×3) of Lavin and Gray, "Fast Algorithms for Convolutional Neural Networks" (2016), section
//! 4.1. With dilation, the cells of a tile are as far apart as the weights.

use super::maps::{FeatureMaps, WIDE};
use super::matrix::{Matrix, SumStorage, TOGETHER, multiply};
use rten_simd::ops::{BitOps, NumOps};
use rten_simd::{Isa, SimdOp};
use vtex_base::parallel::map;

/// Side of a tile, and of its surroundings, in cells.
pub(super) const TILE: usize = 4;
const SIDE: usize = TILE + 2;
/// Number of products.
const PRODUCTS: usize = SIDE * SIDE;
/// Number of values that the tiles computed together may have: as many as stay in a processor's cache.
const VALUES: usize = 1 << 17;
/// Number of tiles that share this memory, if there are enough rows.
const TILES: usize = 256;

/// The matrices of weights of shape `outputs` × `inputs` × 3 × 3, one for each product.
pub(super) fn matrices(weights: &[f32], inputs: usize, outputs: usize) -> Vec<Matrix> {
    let transformed = map(weights.as_chunks::<9>().0, transformed);
    let products: Vec<usize> = (0..PRODUCTS).collect();
    map(&products, |&product| {
        Matrix::new(inputs, outputs, |k, m| transformed[m * inputs + k].as_flattened()[product])
    })
}

/// The weights of the products: by columns, then by rows.
fn transformed(weights: &[f32; 9]) -> [[f32; SIDE]; SIDE] {
    let line = |[a, b, c]: [f32; 3]| {
        let (even, odd) = (a + c, a + 4.0 * c);
        let thirds = [-(even + b) / 6.0, -(even - b) / 6.0, (odd + 2.0 * b) / 24.0, (odd - 2.0 * b) / 24.0];
        [a / 4.0, thirds[0], thirds[1], thirds[2], thirds[3], c]
    };
    let columns = [0, 1, 2].map(|x| line([0, 1, 2].map(|y| weights[3 * y + x])));
    std::array::from_fn(|y| line([0, 1, 2].map(|x| columns[x][y])))
}

/// Distance in memory between the values of two products of some tiles. It exceeds the number of these
/// values, because otherwise the values of a tile compete for the same lines of the cache.
fn stride(tiles: usize, channels: usize) -> usize {
    tiles * channels + WIDE
}

/// A convolution of an input.
pub(super) struct Tiles<'a> {
    pub(super) matrices: &'a [Matrix],
    pub(super) dilation: usize,
    pub(super) input: &'a FeatureMaps,
    /// Row of the input at the first row of the output.
    pub(super) top: usize,
    pub(super) store: SumStorage<'a>,
}

impl Tiles<'_> {
    pub(super) fn run(&self, output: &mut FeatureMaps) {
        let (width, height) = (output.width, output.height);
        // With dilation, rows of tiles interleave and are computed together.
        let band = TILE * self.dilation;
        let (wide, high) = (width.div_ceil(band) * self.dilation, height.div_ceil(band));
        let bands = TILES.div_ceil(wide).min(high.div_ceil(8)).max(1);
        let channels = [self.input.channels, self.store.bias.len()];
        let most = VALUES / (PRODUCTS * (channels[0] + channels[1]));
        let most = most.next_multiple_of(TOGETHER);
        let starts =
            |end: usize| (0..end).step_by(band).flat_map(|v| v..v + self.dilation).filter(move |&v| v < end);
        let zeros = vec![0.0; channels[0]];
        output.for_rows(bands * band, |k, rows| {
            let first = k * bands * band;
            let end = rows.len() / (width * channels[1]);
            let tiles: Vec<[usize; 2]> =
                starts(end).flat_map(|y| starts(width).map(move |x| [x, first + y])).collect();
            let count = most.min(tiles.len().next_multiple_of(TOGETHER));
            let [mut surroundings, mut products] = channels.map(|n| vec![0.0; PRODUCTS * stride(count, n)]);
            for tiles in tiles.chunks(count) {
                let (surroundings, products) = (&mut surroundings[..], &mut products[..]);
                let (work, zeros) = (self, &zeros[..]);
                TileBatch { work, tiles, count, zeros, surroundings, products, first, width, rows }
                    .dispatch();
            }
        });
    }
}

/// Tiles computed together.
struct TileBatch<'a> {
    work: &'a Tiles<'a>,
    /// The first cell of each.
    tiles: &'a [[usize; 2]],
    /// Number of tiles for which there is room, a multiple of [`TOGETHER`].
    count: usize,
    /// A cell outside the input.
    zeros: &'a [f32],
    /// For each product and tile the channels of the transformed input, and those of the output.
    surroundings: &'a mut [f32],
    products: &'a mut [f32],
    /// Rows of the output, the first of them, and their width.
    rows: &'a mut [f32],
    first: usize,
    width: usize,
}

impl SimdOp for TileBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn eval<I: Isa>(mut self, isa: I) {
        self.transform(isa);
        match self.work.matrices[0].vectors {
            1 => self.multiply::<I, 1>(isa),
            2 => self.multiply::<I, 2>(isa),
            3 => self.multiply::<I, 3>(isa),
            _ => self.multiply::<I, 4>(isa),
        }
        self.transform_back(isa);
    }
}

impl TileBatch<'_> {
    #[inline(always)]
    fn transform<I: Isa>(&mut self, isa: I) {
        let ops = isa.f32();
        let Tiles { input, dilation, top, .. } = *self.work;
        let channels = input.channels;
        let stride = stride(self.count, channels);
        for (tile, &[x, y]) in self.tiles.iter().enumerate() {
            let at = |v: usize, k: usize| (v + k * dilation) as isize - dilation as isize;
            let mut cells = [[self.zeros; SIDE]; SIDE];
            for (i, cells) in cells.iter_mut().enumerate() {
                for (j, cell) in cells.iter_mut().enumerate() {
                    *cell = input.cell_or(at(x, j), at(top + y, i), self.zeros);
                }
            }
            for c in (0..channels).step_by(ops.len()) {
                let mut columns = [[ops.zero(); SIDE]; SIDE];
                for j in 0..SIDE {
                    let mut line = [ops.zero(); SIDE];
                    for i in 0..SIDE {
                        line[i] = ops.load(&cells[i][j][c..]);
                    }
                    columns[j] = transformed_input(isa, line);
                }
                for i in 0..SIDE {
                    let mut line = [ops.zero(); SIDE];
                    for j in 0..SIDE {
                        line[j] = columns[j][i];
                    }
                    let line = transformed_input(isa, line);
                    for j in 0..SIDE {
                        let to = (i * SIDE + j) * stride + tile * channels + c;
                        ops.store(line[j], &mut self.surroundings[to..]);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn multiply<I: Isa, const V: usize>(&mut self, isa: I) {
        let ops = isa.f32();
        let (inputs, outputs) = (self.work.input.channels, self.work.store.bias.len());
        let used = self.tiles.len().next_multiple_of(TOGETHER);
        let from = self.surroundings.chunks_exact(stride(self.count, inputs));
        let to = self.products.chunks_exact_mut(stride(self.count, outputs));
        for ((matrix, from), to) in self.work.matrices.iter().zip(from).zip(to) {
            for (strip, weights) in matrix.strips().enumerate() {
                let from = from[..used * inputs].chunks_exact(TOGETHER * inputs);
                let to = to[..used * outputs].chunks_exact_mut(TOGETHER * outputs);
                for (from, to) in from.zip(to) {
                    let mut cells = [from; TOGETHER];
                    for (cell, from) in cells.iter_mut().zip(from.chunks_exact(inputs)) {
                        *cell = from;
                    }
                    let mut sums = [[ops.zero(); V]; TOGETHER];
                    multiply(isa, cells, weights, &mut sums);
                    for (to, sums) in to.chunks_exact_mut(outputs).zip(sums) {
                        let to = to[strip * V * ops.len()..].chunks_exact_mut(ops.len());
                        for (to, sum) in to.zip(sums) {
                            ops.store(sum, to);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn transform_back<I: Isa>(&mut self, isa: I) {
        let ops = isa.f32();
        let Tiles { store, dilation, .. } = *self.work;
        let channels = store.bias.len();
        let stride = stride(self.count, channels);
        for (tile, &[x, y]) in self.tiles.iter().enumerate() {
            for c in (0..channels).step_by(ops.len()) {
                let mut rows = [[ops.zero(); TILE]; SIDE];
                for i in 0..SIDE {
                    let mut line = [ops.zero(); SIDE];
                    for j in 0..SIDE {
                        let from = (i * SIDE + j) * stride + tile * channels + c;
                        line[j] = ops.load(&self.products[from..]);
                    }
                    rows[i] = back(isa, line);
                }
                for j in 0..TILE {
                    let mut line = [ops.zero(); SIDE];
                    for i in 0..SIDE {
                        line[i] = rows[i][j];
                    }
                    let x = x + j * dilation;
                    if x >= self.width {
                        break;
                    }
                    for (i, sum) in back(isa, line).into_iter().enumerate() {
                        let y = y + i * dilation - self.first;
                        let to = (y * self.width + x) * channels + c;
                        if to < self.rows.len() {
                            store.store(isa, sum, &store.bias[c..], &mut self.rows[to..]);
                        }
                    }
                }
            }
        }
    }
}

/// Transforms a line of a tile's surroundings.
#[inline(always)]
fn transformed_input<I: Isa>(isa: I, [a, b, c, d, e, f]: [I::F32; SIDE]) -> [I::F32; SIDE] {
    let ops = isa.f32();
    let [two, four] = [ops.splat(2.0), ops.splat(4.0)];
    let [less_4, less_5] = [ops.splat(-4.0), ops.splat(-5.0)];
    let (even, odd) = (ops.mul_add(less_4, c, e), ops.mul_add(less_4, b, d));
    let (near, far) = (ops.sub(e, c), ops.mul(two, ops.sub(d, b)));
    [
        ops.mul_add(four, a, ops.mul_add(less_5, c, e)),
        ops.add(even, odd),
        ops.sub(even, odd),
        ops.add(near, far),
        ops.sub(near, far),
        ops.mul_add(four, b, ops.mul_add(less_5, d, f)),
    ]
}

/// Transforms a line of products back.
#[inline(always)]
fn back<I: Isa>(isa: I, [a, b, c, d, e, f]: [I::F32; SIDE]) -> [I::F32; TILE] {
    let ops = isa.f32();
    let [two, four, eight] = [ops.splat(2.0), ops.splat(4.0), ops.splat(8.0)];
    let (even, odd) = (ops.add(b, c), ops.sub(b, c));
    let (near, far) = (ops.add(d, e), ops.sub(d, e));
    [
        ops.add(ops.add(a, even), near),
        ops.mul_add(two, far, odd),
        ops.mul_add(four, near, even),
        ops.add(ops.mul_add(eight, far, odd), f),
    ]
}
