//! Dense linear systems of a few hundred unknowns.

/// Solves `matrix · x = right` for three right-hand sides at once, by elimination with partial
/// pivoting. `matrix` is row-major with `right.len()` squared elements and is overwritten; `right`
/// becomes `x`. Returns `false` for a singular matrix; `right` is then meaningless.
pub(super) fn solve(matrix: &mut [f64], right: &mut [[f64; 3]]) -> bool {
    let n = right.len();
    let largest = matrix.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for k in 0..n {
        let pivot =
            (k..n).fold(k, |p, i| if matrix[i * n + k].abs() > matrix[p * n + k].abs() { i } else { p });
        let size = matrix[pivot * n + k].abs();
        if size.is_nan() || size <= largest * 1e-14 {
            return false;
        }
        if pivot != k {
            for j in k..n {
                matrix.swap(pivot * n + j, k * n + j);
            }
            right.swap(pivot, k);
        }
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let (row, head) = (&above[k * n + k..], right[k]);
        for (i, other) in below.chunks_exact_mut(n).enumerate() {
            let factor = other[k] / row[0];
            if factor != 0.0 {
                for (a, b) in other[k..].iter_mut().zip(row) {
                    *a -= factor * b;
                }
                for (a, b) in right[k + 1 + i].iter_mut().zip(head) {
                    *a -= factor * b;
                }
            }
        }
    }
    for k in (0..n).rev() {
        let (head, tail) = right.split_at_mut(k + 1);
        for (j, x) in tail.iter().enumerate() {
            let factor = matrix[k * n + k + 1 + j];
            for c in 0..3 {
                head[k][c] -= factor * x[c];
            }
        }
        head[k] = head[k].map(|v| v / matrix[k * n + k]);
    }
    right.iter().flatten().all(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    #[test]
    fn solution_fulfils_the_system() {
        let mut random = stream(1, "dense test", 0);
        for n in [1, 2, 7, 40] {
            let matrix: Vec<f64> = (0..n * n).map(|_| random.range(-1.0, 1.0)).collect();
            let right: Vec<[f64; 3]> = (0..n).map(|_| [0; 3].map(|_| random.range(-9.0, 9.0))).collect();
            let mut x = right.clone();
            assert!(solve(&mut matrix.clone(), &mut x));
            for i in 0..n {
                for c in 0..3 {
                    let sum: f64 = (0..n).map(|j| matrix[i * n + j] * x[j][c]).sum();
                    assert!((sum - right[i][c]).abs() < 1e-8);
                }
            }
        }
        assert!(!solve(&mut [1.0, 2.0, 2.0, 4.0], &mut [[0.0; 3]; 2]));
    }
}
