//! Lower triangular 2 × 2 matrices with a positive diagonal: roots of covariances, and their powers.

/// The matrix [[a, 0], [b, c]], with a and c above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lower {
    /// The first element of the diagonal.
    pub a: f64,
    /// The element below the diagonal.
    pub b: f64,
    /// The second element of the diagonal.
    pub c: f64,
}

impl Lower {
    /// The Cholesky root L of a covariance xx, xy, yy: L · Lᵀ is the covariance. `None` unless it is
    /// positive definite.
    pub fn root([xx, xy, yy]: [f64; 3]) -> Option<Self> {
        let a = libm::sqrt(xx);
        let b = xy / a;
        let c = libm::sqrt(yy - b * b);
        (a > 0.0 && c > 0.0 && b.is_finite()).then_some(Self { a, b, c })
    }

    /// The inverse.
    pub fn inverse(self) -> Self {
        let Self { a, b, c } = self;
        Self { a: 1.0 / a, b: -b / (a * c), c: 1.0 / c }
    }

    /// The product with another.
    pub fn times(self, other: Self) -> Self {
        Self { a: self.a * other.a, b: self.b * other.a + self.c * other.b, c: self.c * other.c }
    }

    /// The power of any real exponent, in closed form: the off-diagonal element is b (aᵗ - cᵗ) / (a - c).
    /// Written with logarithms, the quotient is exact for nearly equal a and c too.
    pub fn power(self, t: f64) -> Self {
        let Self { a, b, c } = self;
        let ratio = libm::log1p((a - c) / c);
        let quotient = if ratio == 0.0 { t } else { libm::expm1(t * ratio) / libm::expm1(ratio) };
        Self { a: libm::pow(a, t), b: b * libm::pow(c, t - 1.0) * quotient, c: libm::pow(c, t) }
    }

    /// A covariance mapped by the matrix: W · U · Wᵀ.
    pub fn map(self, [xx, xy, yy]: [f64; 3]) -> [f64; 3] {
        let Self { a, b, c } = self;
        [a * a * xx, a * (b * xx + c * xy), b * b * xx + 2.0 * b * c * xy + c * c * yy]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Lower, b: Lower, tolerance: f64) -> bool {
        let size = a.a.abs().max(a.b.abs()).max(a.c.abs()).max(1.0);
        [(a.a, b.a), (a.b, b.b), (a.c, b.c)].iter().all(|(x, y)| (x - y).abs() <= tolerance * size)
    }

    #[test]
    fn a_root_squared_is_the_covariance() {
        for covariance in [[4.0, 1.0, 3.0], [0.2, -0.1, 9.0], [1e4, 30.0, 1.0]] {
            let root = Lower::root(covariance).unwrap();
            let again = root.map([1.0, 0.0, 1.0]);
            assert!(again.iter().zip(covariance).all(|(a, b)| (a - b).abs() < 1e-9 * covariance[0].max(9.0)));
            assert!(near(root.times(root.inverse()), Lower { a: 1.0, b: 0.0, c: 1.0 }, 1e-12));
        }
        assert_eq!(Lower::root([1.0, 2.0, 3.0]), None);
        assert_eq!(Lower::root([0.0, 0.0, 3.0]), None);
    }

    #[test]
    fn powers_in_closed_form_are_those_by_eigenvectors() {
        for (a, b, c) in [(2.0, 0.7, 0.5), (1.3, -4.0, 1.1), (3.0, 2.0, 3.0), (1.0, 0.2, 1.0 + 1e-7)] {
            let w = Lower { a, b, c };
            assert!(near(w.power(1.0), w, 1e-12));
            assert!(near(w.power(2.0), w.times(w), 1e-12));
            assert!(near(w.power(-1.0), w.inverse(), 1e-12));
            assert!(near(w.power(0.5).times(w.power(0.5)), w, 1e-12));
            // Eigenvectors are (1, b / (a - c)) of a, and (0, 1) of c.
            for t in [-0.5, 0.0, 0.3, 0.707, 1.6, 2.0] {
                if (a - c).abs() > 1e-3 {
                    let k = b / (a - c);
                    let (at, ct) = (libm::pow(a, t), libm::pow(c, t));
                    let numeric = Lower { a: at, b: k * at - k * ct, c: ct };
                    assert!(near(w.power(t), numeric, 1e-9), "{w:?} {t}");
                }
            }
        }
    }
}
