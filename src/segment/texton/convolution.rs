//! Convolutions of maps with several channels, computed directly.
//!
//! A library for networks in general copies the surroundings of each cell into a matrix first
//! ("im2col"), which for a network of few channels takes as long as the multiplications. Here the
//! multiplications read the maps themselves: maps have edges of zeros, so every tap of a kernel is the
//! same map read from another place.
//!
//! Every sum is taken in the order of the taps, so results do not depend on threads, nor, among
//! processors that multiply and add in one step, on the width of their vectors.

use crate::parallel::for_chunks;
use rten_simd::ops::{BitOps, NumOps};
use rten_simd::{Isa, SimdOp};

/// Width of the zeros around maps, in cells: as far as any kernel reaches.
const EDGE: usize = 4;
/// Number of cells of which lines hold a multiple: two of the widest vectors.
const BLOCK: usize = 32;
/// Number of channels computed together: as many as fit the registers, twice.
const TOGETHER: usize = 8;

/// Maps of the same size, one for each channel.
pub(super) struct Maps {
    pub(super) channels: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    /// For each row a line for each channel, with edges, and [`EDGE`] rows of zeros above and below.
    values: Vec<f32>,
}

impl Maps {
    pub(super) fn zeros(channels: usize, width: usize, height: usize) -> Self {
        let values = vec![0.0; (height + 2 * EDGE) * channels * line(width)];
        Self { channels, width, height, values }
    }

    /// The values of a channel in a row.
    pub(super) fn row(&self, channel: usize, y: usize) -> &[f32] {
        let start = ((y + EDGE) * self.channels + channel) * line(self.width) + EDGE;
        &self.values[start..start + self.width]
    }

    /// Does `f(y, lines)` for each row, on several threads. `lines` are those of all channels, see
    /// [`rows_of`].
    pub(super) fn for_rows(&mut self, f: impl Fn(usize, &mut [f32]) + Sync + Send) {
        let size = self.channels * line(self.width);
        let rows = &mut self.values[EDGE * size..(EDGE + self.height) * size];
        for_chunks(rows, size, f);
    }

    /// The four maps of every other cell and row of each channel: even rows before odd ones, in each even
    /// columns before odd ones. Channels of the same cells follow one another.
    pub(super) fn halved(&self) -> Self {
        let mut halves = Self::zeros(4 * self.channels, self.width / 2, self.height / 2);
        let width = halves.width;
        halves.for_rows(|y, lines| {
            for (channel, row) in rows_of(lines, width).enumerate() {
                let (part, channel) = (channel / self.channels, channel % self.channels);
                let from = self.row(channel, 2 * y + part / 2);
                row.iter_mut().zip(from[part % 2..].iter().step_by(2)).for_each(|(to, from)| *to = *from);
            }
        });
        halves
    }

    /// Adds maps of half the size, enlarged by linear interpolation.
    pub(super) fn add_enlarged(&mut self, half: &Self) {
        let width = self.width;
        self.for_rows(|y, lines| {
            let other = if y % 2 == 0 { (y / 2).saturating_sub(1) } else { (y / 2 + 1).min(half.height - 1) };
            for (channel, row) in rows_of(lines, width).enumerate() {
                let (near, far) = (half.row(channel, y / 2), half.row(channel, other));
                let at = |x: usize| 0.75 * near[x] + 0.25 * far[x];
                let mut before = at(0);
                let mut here = before;
                for x in 0..half.width {
                    let after = if x + 1 < half.width { at(x + 1) } else { here };
                    row[2 * x] += 0.75 * here + 0.25 * before;
                    row[2 * x + 1] += 0.75 * here + 0.25 * after;
                    (before, here) = (here, after);
                }
            }
        });
    }
}

/// Length of a line of maps, edges included.
fn line(width: usize) -> usize {
    width.next_multiple_of(BLOCK) + 2 * EDGE
}

/// The cells of each channel of the lines of a row.
pub(super) fn rows_of(lines: &mut [f32], width: usize) -> impl Iterator<Item = &mut [f32]> {
    lines.chunks_exact_mut(line(width)).map(move |line| &mut line[EDGE..EDGE + width])
}

/// Where a weight reads: a channel, and steps down and to the right, each at most [`EDGE`].
type Tap = (usize, isize, isize);

/// A convolution of step 1 whose output has the size of its input.
pub(super) struct Convolution {
    channels: usize,
    taps: Vec<Tap>,
    /// For each [`TOGETHER`] channels and each tap, their weights.
    weights: Vec<f32>,
    bias: Vec<f32>,
    /// Whether negative sums become 0.
    rectified: bool,
}

impl Convolution {
    /// From weights of shape outputs × inputs × `side` × `side` (`side` 1 or 3) and a bias for each output.
    /// Taps are `dilation` cells apart.
    pub(super) fn new(weights: &[f32], bias: &[f32], side: usize, dilation: usize) -> Self {
        let inputs = weights.len() / (bias.len() * side * side);
        let step = |k: usize| (k as isize - (side / 2) as isize) * dilation as isize;
        let taps =
            (0..inputs * side * side).map(|k| (k / (side * side), step(k / side % side), step(k % side)));
        Self::of_taps(weights, bias, taps.collect())
    }

    /// From weights of shape outputs × inputs × 3 × 3 for every other cell and row, to be applied to maps
    /// that are [`halved`](Maps::halved).
    pub(super) fn of_step_2(weights: &[f32], bias: &[f32]) -> Self {
        let inputs = weights.len() / (bias.len() * 9);
        let (part, step) = ([1, 0, 1], [-1, 0, 0]);
        let tap = |k: usize| {
            let (y, x) = (k / 3 % 3, k % 3);
            ((2 * part[y] + part[x]) * inputs + k / 9, step[y], step[x])
        };
        Self::of_taps(weights, bias, (0..inputs * 9).map(tap).collect())
    }

    fn of_taps(weights: &[f32], bias: &[f32], taps: Vec<Tap>) -> Self {
        let weight = |group: usize, k: usize, m: usize| weights[(group * TOGETHER + m) * taps.len() + k];
        let mut sorted = Vec::with_capacity(weights.len());
        for group in 0..bias.len() / TOGETHER {
            for k in 0..taps.len() {
                sorted.extend((0..TOGETHER).map(|m| weight(group, k, m)));
            }
        }
        Self { channels: bias.len(), taps, weights: sorted, bias: bias.to_vec(), rectified: true }
    }

    /// The same, but negative sums stay.
    pub(super) fn linear(self) -> Self {
        Self { rectified: false, ..self }
    }

    pub(super) fn of(&self, input: &Maps) -> Maps {
        let mut output = Maps::zeros(self.channels, input.width, input.height);
        self.run(input, &mut output, false);
        output
    }

    /// Adds to the sums what `output` holds.
    pub(super) fn add_to(&self, input: &Maps, output: &mut Maps) {
        self.run(input, output, true);
    }

    fn run(&self, input: &Maps, output: &mut Maps, add: bool) {
        let line = line(input.width);
        // From the first line of the uppermost row that a tap reads.
        let offset = |&(channel, dy, dx): &Tap| {
            let [row, column] = [dy, dx].map(|d| (EDGE as isize + d) as usize);
            (row * input.channels + channel) * line + column
        };
        let offsets: Vec<usize> = self.taps.iter().map(offset).collect();
        let width = input.width;
        output.for_rows(|y, lines| {
            let input = &input.values[y * input.channels * line..];
            Row { convolution: self, offsets: &offsets, input, add, width, lines }.dispatch();
        });
    }
}

/// The work of one row.
struct Row<'a> {
    convolution: &'a Convolution,
    /// Place in `input` of each tap for the first cell.
    offsets: &'a [usize],
    /// The input from the uppermost row that a tap reads.
    input: &'a [f32],
    add: bool,
    width: usize,
    /// The lines of all channels of the output.
    lines: &'a mut [f32],
}

impl SimdOp for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn eval<I: Isa>(self, isa: I) {
        // AVX2 has half as many registers as the others have.
        if isa.f32().len() == 8 { self.sums::<I, 4>(isa) } else { self.sums::<I, TOGETHER>(isa) }
    }
}

impl Row<'_> {
    /// The sums of all channels, `M` together.
    #[inline(always)]
    fn sums<I: Isa, const M: usize>(self, isa: I) {
        let ops = isa.f32();
        let Self { convolution, offsets, input, add, width, lines } = self;
        let (line, step) = (line(width), 2 * ops.len());
        let least = ops.splat(if convolution.rectified { 0.0 } else { f32::NEG_INFINITY });
        let groups = convolution.weights.chunks_exact(offsets.len() * TOGETHER);
        for (group, weights) in groups.enumerate() {
            for part in (0..TOGETHER).step_by(M) {
                let first = group * TOGETHER + part;
                let bias = &convolution.bias[first..first + M];
                let lines = &mut lines[first * line..(first + M) * line];
                for x in (0..width).step_by(step) {
                    // No closures here: where one is not inlined, it knows nothing of the vectors.
                    let mut sums = [[ops.zero(); 2]; M];
                    for (sum, &bias) in sums.iter_mut().zip(bias) {
                        *sum = [ops.splat(bias); 2];
                    }
                    for (&offset, weights) in offsets.iter().zip(weights.chunks_exact(TOGETHER)) {
                        let (first, second) = input[offset + x..offset + x + step].split_at(step / 2);
                        let (first, second) = (ops.load(first), ops.load(second));
                        for (sum, &weight) in sums.iter_mut().zip(&weights[part..part + M]) {
                            let weight = ops.splat(weight);
                            *sum = [ops.mul_add(first, weight, sum[0]), ops.mul_add(second, weight, sum[1])];
                        }
                    }
                    for (sum, line) in sums.into_iter().zip(lines.chunks_exact_mut(line)) {
                        let to = &mut line[EDGE + x..EDGE + x + step];
                        for (sum, to) in sum.into_iter().zip(to.chunks_exact_mut(step / 2)) {
                            let sum = if add { ops.add(sum, ops.load(to)) } else { sum };
                            ops.store(ops.max(sum, least), to);
                        }
                    }
                }
                // Beyond the last cell there are zeros again.
                for line in lines.chunks_exact_mut(line) {
                    line[EDGE + width..].fill(0.0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn maps(channels: usize, width: usize, height: usize, seed: u32) -> Maps {
        let mut maps = Maps::zeros(channels, width, height);
        maps.for_rows(|y, lines| {
            for (channel, row) in rows_of(lines, width).enumerate() {
                for (x, value) in row.iter_mut().enumerate() {
                    let k = ((channel * 31 + y) * 57 + x) as u32 ^ seed;
                    *value = (k.wrapping_mul(2_654_435_761) >> 16) as f32 / 32_768.0 - 1.0;
                }
            }
        });
        maps
    }

    fn at(maps: &Maps, channel: usize, y: isize, x: isize) -> f32 {
        let inside = (0..maps.height as isize).contains(&y) && (0..maps.width as isize).contains(&x);
        if inside { maps.row(channel, y as usize)[x as usize] } else { 0.0 }
    }

    /// The sum as the definition has it.
    fn sum(
        weights: &[f32],
        input: &Maps,
        output: usize,
        [y, x]: [isize; 2],
        [side, dilation]: [usize; 2],
    ) -> f32 {
        let reach = (side / 2 * dilation) as isize;
        let mut sum = 0.0;
        for channel in 0..input.channels {
            for ky in 0..side {
                for kx in 0..side {
                    let weight = weights[((output * input.channels + channel) * side + ky) * side + kx];
                    let [dy, dx] = [ky, kx].map(|k| (k * dilation) as isize - reach);
                    sum += weight * at(input, channel, y + dy, x + dx);
                }
            }
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn sums_are_those_of_the_definition(
            (inputs, outputs) in (1..4usize, 1..3usize),
            (width, height) in (1..70usize, 1..6usize),
            (side, dilation) in prop::sample::select(vec![(1, 1), (3, 1), (3, 2), (3, 4)]),
            seed in any::<u32>(),
        ) {
            let outputs = outputs * TOGETHER;
            let values = maps(outputs, inputs * side * side, 1, seed);
            let weights: Vec<f32> = (0..outputs).flat_map(|k| values.row(k, 0).to_vec()).collect();
            let bias: Vec<f32> = (0..outputs).map(|k| k as f32 / 8.0 - 1.0).collect();
            let input = maps(inputs, width, height, seed / 2);
            let convolution = Convolution::new(&weights, &bias, side, dilation);
            let rectified = convolution.of(&input);
            let mut added = maps(outputs, width, height, 7);
            let convolution = convolution.linear();
            convolution.add_to(&input, &mut added);
            let before = maps(outputs, width, height, 7);
            for channel in 0..outputs {
                for y in 0..height {
                    for x in 0..width {
                        let here = [y as isize, x as isize];
                        let sum = bias[channel] + sum(&weights, &input, channel, here, [side, dilation]);
                        prop_assert!((rectified.row(channel, y)[x] - sum.max(0.0)).abs() < 1e-4);
                        let sum = sum + before.row(channel, y)[x];
                        prop_assert!((added.row(channel, y)[x] - sum).abs() < 1e-4);
                    }
                }
            }
            // Edges are still zeros: what reads them adds nothing.
            let inner: f32 = (0..outputs).flat_map(|c| (0..height).map(move |y| (c, y)))
                .map(|(c, y)| rectified.row(c, y).iter().sum::<f32>()).sum();
            prop_assert!((rectified.values.iter().sum::<f32>() - inner).abs() <= 1e-3 * (1.0 + inner.abs()));
        }
    }

    #[test]
    fn a_step_of_2_is_every_other_sum() {
        let input = maps(3, 44, 10, 5);
        let values = maps(TOGETHER, 27, 1, 9);
        let weights: Vec<f32> = (0..TOGETHER).flat_map(|k| values.row(k, 0).to_vec()).collect();
        let bias = [0.25; TOGETHER];
        let all = Convolution::new(&weights, &bias, 3, 1).of(&input);
        let every_other = Convolution::of_step_2(&weights, &bias).of(&input.halved());
        assert_eq!([every_other.width, every_other.height], [22, 5]);
        for channel in 0..TOGETHER {
            for y in 0..5 {
                for x in 0..22 {
                    let (a, b) = (all.row(channel, 2 * y)[2 * x], every_other.row(channel, y)[x]);
                    assert!((a - b).abs() < 1e-5, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn what_is_linear_stays_so_enlarged() {
        let mut half = Maps::zeros(2, 6, 4);
        half.for_rows(|y, lines| {
            for (channel, row) in rows_of(lines, 6).enumerate() {
                row.iter_mut().enumerate().for_each(|(x, v)| *v = (x + 10 * y + 100 * channel) as f32);
            }
        });
        let mut whole = Maps::zeros(2, 12, 8);
        whole.add_enlarged(&half);
        for (y, x) in (1..7).flat_map(|y| (1..11).map(move |x| (y, x))) {
            let expected = 100.0 + (x as f32 - 0.5) / 2.0 + 10.0 * (y as f32 - 0.5) / 2.0;
            assert!((whole.row(1, y)[x] - expected).abs() < 1e-4, "{x} {y}");
        }
        assert_eq!(whole.row(0, 0)[0], 0.0);
    }
}
