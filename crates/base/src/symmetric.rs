//! Small matrices: eigenvectors and roots of symmetric ones, inverses.

/// A small square matrix, mostly symmetric.
#[derive(Clone, Debug)]
pub struct Symmetric {
    size: usize,
    data: Vec<f64>,
}

impl Symmetric {
    /// From its elements by row and column.
    pub fn new(size: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        Self { size, data: (0..size * size).map(|k| value(k / size, k % size)).collect() }
    }

    /// The element of a row and a column.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.data[i * self.size + j]
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.size).map(|i| self.at(i, i)).sum()
    }

    /// The product with another matrix of the same size.
    pub fn product(&self, other: &Self) -> Self {
        Self::new(self.size, |i, j| (0..self.size).map(|k| self.at(i, k) * other.at(k, j)).sum())
    }

    /// The square root of a positive semidefinite matrix. Negative eigenvalues, which come from rounding,
    /// count as 0.
    pub fn square_root(&self) -> Self {
        let (values, vectors) = self.eigen();
        let roots: Vec<f64> = values.iter().map(|v| libm::sqrt(v.max(0.0))).collect();
        Self::new(self.size, |i, j| {
            (0..self.size).map(|k| vectors.at(i, k) * roots[k] * vectors.at(j, k)).sum()
        })
    }

    /// Eigenvalues, and eigenvectors in columns, by rotations (Jacobi 1846).
    pub fn eigen(&self) -> (Vec<f64>, Self) {
        const SWEEPS: usize = 60;
        let size = self.size;
        let mut a = self.clone();
        let mut vectors = Self::new(size, |i, j| f64::from(u8::from(i == j)));
        let enough = 1e-28 * self.data.iter().map(|v| v * v).sum::<f64>();
        for _ in 0..SWEEPS {
            let off: f64 = (0..size)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| a.at(i, j) * a.at(i, j))
                .sum();
            if off <= enough {
                break;
            }
            for p in 0..size {
                for q in p + 1..size {
                    a.rotate(p, q, &mut vectors);
                }
            }
        }
        ((0..size).map(|i| a.at(i, i)).collect(), vectors)
    }

    /// Turns the axes `p` and `q` so that the element between them vanishes.
    fn rotate(&mut self, p: usize, q: usize, vectors: &mut Self) {
        let between = self.at(p, q);
        if between == 0.0 {
            return;
        }
        let theta = (self.at(q, q) - self.at(p, p)) / (2.0 * between);
        let t = theta.signum() / (theta.abs() + libm::sqrt(theta * theta + 1.0));
        let cos = 1.0 / libm::sqrt(t * t + 1.0);
        let sin = t * cos;
        let n = self.size;
        for k in 0..n {
            let (x, y) = (self.at(k, p), self.at(k, q));
            (self.data[k * n + p], self.data[k * n + q]) = (cos * x - sin * y, sin * x + cos * y);
        }
        for k in 0..n {
            let (x, y) = (self.at(p, k), self.at(q, k));
            (self.data[p * n + k], self.data[q * n + k]) = (cos * x - sin * y, sin * x + cos * y);
            let (x, y) = (vectors.at(k, p), vectors.at(k, q));
            (vectors.data[k * n + p], vectors.data[k * n + q]) = (cos * x - sin * y, sin * x + cos * y);
        }
    }
}

/// The inverse of a matrix of three rows; `None` if it has none.
pub fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |r: usize, c: usize| {
        let [r1, r2, c1, c2] = [(r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3];
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|k| m[0][k] * minor(0, k)).sum();
    let found: [[f64; 3]; 3] = std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant));
    found.iter().flatten().all(|v| v.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    #[test]
    fn roots_squared_are_the_matrix() {
        let mut random = stream(1, "filter bank test", 0);
        let any: Vec<f64> = (0..24 * 24).map(|_| random.normal()).collect();
        let matrix = Symmetric::new(24, |i, j| (0..24).map(|k| any[i * 24 + k] * any[j * 24 + k]).sum());
        let root = matrix.square_root();
        let again = root.product(&root);
        assert!(again.data.iter().zip(&matrix.data).all(|(a, b)| (a - b).abs() < 1e-9));
        let flat = Symmetric::new(3, |_, _| 2.0);
        assert!((flat.square_root().trace() - libm::sqrt(6.0)).abs() < 1e-9);
    }

    #[test]
    fn eigenvectors_and_values_make_up_the_matrix() {
        let mut random = stream(3, "symmetric test", 0);
        for size in [1, 4, 9] {
            let b: Vec<f64> = (0..size * size).map(|_| random.normal()).collect();
            let a = Symmetric::new(size, |i, j| (0..size).map(|k| b[i * size + k] * b[j * size + k]).sum());
            let (values, v) = a.eigen();
            for (i, j) in (0..size * size).map(|k| (k / size, k % size)) {
                let back: f64 = (0..size).map(|k| v.at(i, k) * values[k] * v.at(j, k)).sum();
                assert!((back - a.at(i, j)).abs() < 1e-9, "{back} {}", a.at(i, j));
                let product: f64 = (0..size).map(|k| v.at(k, i) * v.at(k, j)).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
}
