//! Tables of colour profiles: from samples to the colour space in which profiles meet.

use super::curve::{Curve, normalized};
use moxcms::{DataColorSpace, LutType, LutWarehouse, ToneReprCurve};

/// White of the space in which profiles meet: X, Y and Z of D50.
pub(super) const WHITE: [f64; 3] = [0.9642, 1.0, 0.8249];

/// How a table encodes colours.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Xyz,
    Lab,
    /// Lab of 16 bits in profiles of the second version.
    LabOf16Bits,
}

/// The matrix of a table with the curves before it and the numbers added after it.
#[derive(Clone, Debug, PartialEq)]
struct MatrixStage {
    curves: Vec<Curve>,
    matrix: [[f64; 3]; 3],
    add: [f64; 3],
}

/// From samples, after a first curve for each, to X, Y and Z.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    /// Points along each channel, and the distance of two neighbours in `values`.
    axes: Vec<[usize; 2]>,
    /// Three numbers for each point; none if samples are taken as they are.
    values: Vec<f32>,
    stage: Option<MatrixStage>,
    last: Vec<Curve>,
    encoding: Encoding,
}

impl Table {
    /// The table of a profile for a number of channels, with the curve of each channel; `None` if it is damaged.
    pub(super) fn new(
        lut: &LutWarehouse,
        pcs: DataColorSpace,
        channels: usize,
    ) -> Option<(Vec<Curve>, Self)> {
        let (first, grid, values, stage, last, is_old) = match lut {
            LutWarehouse::Lut(lut) => {
                let [input, output] = [lut.num_input_channels, lut.num_output_channels].map(usize::from);
                if [input, output] != [channels, 3] {
                    return None;
                }
                let first =
                    Curve::stored(&lut.input_table, usize::from(lut.num_input_table_entries), channels)?;
                let last = Curve::stored(&lut.output_table, usize::from(lut.num_output_table_entries), 3)?;
                let grid = vec![usize::from(lut.num_clut_grid_points); channels];
                (first, grid, normalized(&lut.clut_table), None, last, lut.lut_type == LutType::Lut16)
            }
            LutWarehouse::Multidimensional(lut) => {
                let curves =
                    |curves: &[ToneReprCurve]| curves.iter().map(Curve::new).collect::<Option<Vec<Curve>>>();
                let [mut first, middle, last] =
                    [curves(&lut.a_curves)?, curves(&lut.m_curves)?, curves(&lut.b_curves)?];
                if first.is_empty() {
                    first = vec![Curve::gamma(1.0); channels];
                }
                let grid = lut.grid_points.iter().take(channels).map(|&n| usize::from(n)).collect();
                let values = lut.clut.as_ref().map(normalized).unwrap_or_default();
                let stage = MatrixStage { curves: middle, matrix: lut.matrix.v, add: lut.bias.v };
                (first, grid, values, (stage.curves.len() == 3).then_some(stage), last, false)
            }
        };
        let encoding = match (pcs, is_old) {
            (DataColorSpace::Xyz, _) => Encoding::Xyz,
            (_, true) => Encoding::LabOf16Bits,
            (_, false) => Encoding::Lab,
        };
        let mut axes: Vec<[usize; 2]> = grid.iter().map(|&n: &usize| [n, 0]).collect();
        let mut step = 3;
        // The last channel changes fastest.
        for axis in axes.iter_mut().rev() {
            axis[1] = step;
            step = axis[0].checked_mul(step)?;
        }
        let is_sound = if values.is_empty() {
            channels == 3
        } else {
            axes.iter().all(|axis| axis[0] >= 2) && values.len() == step
        };
        let fits = is_sound && first.len() == channels && last.len() == 3;
        fits.then_some((first, Self { axes, values, stage, last, encoding }))
    }

    /// X, Y and Z of samples after their curves, each 0 to 1.
    pub(super) fn xyz(&self, samples: &[f64]) -> [f64; 3] {
        let mut v = match samples {
            [a, b, c] if self.values.is_empty() => [*a, *b, *c],
            samples => self.interpolated(samples),
        };
        if let Some(MatrixStage { curves, matrix, add }) = &self.stage {
            v = std::array::from_fn(|k| curves[k].at(v[k]));
            v = std::array::from_fn(|k| (0..3).map(|i| matrix[k][i] * v[i]).sum::<f64>() + add[k]);
        }
        v = std::array::from_fn(|k| self.last[k].at(v[k]));
        let lab = match self.encoding {
            Encoding::Xyz => return v.map(|v| v * (1.0 + 32767.0 / 32768.0)),
            Encoding::Lab => [100.0 * v[0], 255.0 * v[1] - 128.0, 255.0 * v[2] - 128.0],
            Encoding::LabOf16Bits => {
                let [l, a, b] = v.map(|v| v * 65535.0 / 256.0);
                [l * 100.0 / 255.0, a - 128.0, b - 128.0]
            }
        };
        from_lab(lab)
    }

    /// The value between the points of the table: over the tetrahedron of three channels, linear along a fourth.
    fn interpolated(&self, samples: &[f64]) -> [f64; 3] {
        let mut shares = [0.0; 4];
        let mut base = 0;
        for ((share, sample), [points, step]) in shares.iter_mut().zip(samples).zip(&self.axes) {
            let place = sample.clamp(0.0, 1.0) * (points - 1) as f64;
            let low = (place as usize).min(points - 2);
            *share = place - low as f64;
            base += low * step;
        }
        if self.axes.len() < 4 {
            return self.within(base, &shares[..self.axes.len()], &self.axes);
        }
        let [a, b] = [0, self.axes[0][1]].map(|by| self.within(base + by, &shares[1..], &self.axes[1..]));
        std::array::from_fn(|k| a[k] + (b[k] - a[k]) * shares[0])
    }

    /// The value within the simplex at a point that holds the place at some shares of the ways to the next points.
    fn within(&self, mut at: usize, shares: &[f64], axes: &[[usize; 2]]) -> [f64; 3] {
        let mut order = [0, 1, 2];
        let order = &mut order[..shares.len()];
        order.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
        let mut value = [0.0; 3];
        let mut before = 1.0;
        let mut add = |at: usize, weight: f64| {
            for (sum, own) in value.iter_mut().zip(&self.values[at..at + 3]) {
                *sum += weight * f64::from(*own);
            }
        };
        for &axis in order.iter() {
            add(at, before - shares[axis]);
            before = shares[axis];
            at += axes[axis][1];
        }
        add(at, before);
        value
    }
}

/// X, Y and Z of a colour of Lab under D50.
fn from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let middle = (l + 16.0) / 116.0;
    let cubed = |v: f64| if v > 6.0 / 29.0 { v * v * v } else { (v - 4.0 / 29.0) * 108.0 / 841.0 };
    let f = [middle + a / 500.0, middle, middle - b / 200.0];
    std::array::from_fn(|k| WHITE[k] * cubed(f[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lab_becomes_xyz() {
        let near = |a: [f64; 3], b: [f64; 3]| {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4), "{a:?} {b:?}")
        };
        near(from_lab([100.0, 0.0, 0.0]), WHITE);
        near(from_lab([0.0, 0.0, 0.0]), [0.0; 3]);
        near(from_lab([50.0, 0.0, 0.0]), WHITE.map(|v| 0.184187 * v));
        near(from_lab([5.0, 0.0, 0.0]), WHITE.map(|v| 0.005535 * v));
    }

    /// A table of points 0 and 1 along each channel, whose values are those of a function.
    fn cube(channels: usize, value: impl Fn(&[f64]) -> [f64; 3]) -> Table {
        let mut axes = vec![[2, 3]; channels];
        (0..channels).rev().skip(1).for_each(|k| axes[k][1] = 2 * axes[k + 1][1]);
        let corner =
            |i: usize| -> Vec<f64> { (0..channels).map(|k| (i >> (channels - 1 - k) & 1) as f64).collect() };
        let values = (0..1 << channels).flat_map(|i| value(&corner(i))).map(|v| v as f32).collect();
        let last = vec![Curve::gamma(1.0); 3];
        Table { axes, values, stage: None, last, encoding: Encoding::Xyz }
    }

    #[test]
    fn tables_are_linear_between_their_points() {
        for channels in [1, 3, 4] {
            let sums = |v: &[f64]| [v.iter().sum::<f64>() / 8.0, v[0] / 2.0, v[channels - 1] / 4.0 + 0.1];
            let table = cube(channels, sums);
            for sample in [[0.0; 4], [1.0; 4], [0.3, 0.9, 0.1, 0.6], [0.5, 0.5, 0.2, 0.2]] {
                let (got, wanted) = (table.interpolated(&sample[..channels]), sums(&sample[..channels]));
                assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{got:?} {wanted:?}");
            }
        }
        // Over tetrahedra: the product of two channels is their minimum half-way along a diagonal.
        let product = cube(3, |v| [v[0] * v[1], 0.0, 0.0]);
        assert!((product.interpolated(&[0.5, 0.25, 0.0])[0] - 0.25).abs() < 1e-6);
    }
}
