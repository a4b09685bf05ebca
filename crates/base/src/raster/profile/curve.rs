//! Curves of colour profiles.

use moxcms::{LutStore, ToneReprCurve};

/// A curve from 0..=1 to about 0..=1.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Curve {
    /// Values at even distances, at least two.
    Sampled(Vec<f32>),
    /// (`a` x + `b`)^`g` + `e` from `d` on, `c` x + `f` below.
    Formula { g: f64, a: f64, b: f64, c: f64, d: f64, e: f64, f: f64 },
}

impl Curve {
    /// x^`g`.
    pub(super) fn gamma(g: f64) -> Self {
        Self::Formula { g, a: 1.0, b: 0.0, c: 0.0, d: 0.0, e: 0.0, f: 0.0 }
    }

    /// That of sRGB.
    pub(super) fn srgb() -> Self {
        Self::Formula { g: 2.4, a: 1.0 / 1.055, b: 0.055 / 1.055, c: 1.0 / 12.92, d: 0.04045, e: 0.0, f: 0.0 }
    }

    /// A curve of a profile; `None` for a formula with an unknown number of parameters.
    pub(super) fn new(curve: &ToneReprCurve) -> Option<Self> {
        match curve {
            ToneReprCurve::Lut(values) => Some(match values[..] {
                [] => Self::gamma(1.0),
                // A number with 8 bits after the point.
                [g] => Self::gamma(f64::from(g) / 256.0),
                _ => Self::Sampled(values.iter().map(|&v| f32::from(v) / 65535.0).collect()),
            }),
            ToneReprCurve::Parametric(numbers) => {
                let numbers: Vec<f64> = numbers.iter().copied().map(f64::from).collect();
                let formula = |g, [a, b, c, d, e, f]: [f64; 6]| Some(Self::Formula { g, a, b, c, d, e, f });
                match numbers[..] {
                    [g] => Some(Self::gamma(g)),
                    [g, a, b] => formula(g, [a, b, 0.0, -b / a, 0.0, 0.0]),
                    [g, a, b, c] => formula(g, [a, b, 0.0, -b / a, c, c]),
                    [g, a, b, c, d] => formula(g, [a, b, c, d, 0.0, 0.0]),
                    [g, a, b, c, d, e, f] => formula(g, [a, b, c, d, e, f]),
                    _ => None,
                }
            }
        }
    }

    /// The curves of a table, one after the other, each of `count` entries; `None` if there are not `channels`.
    pub(super) fn stored(store: &LutStore, count: usize, channels: usize) -> Option<Vec<Self>> {
        let values = normalized(store);
        let fits = count >= 2 && values.len() == count * channels;
        fits.then(|| values.chunks_exact(count).map(|v| Self::Sampled(v.to_vec())).collect())
    }

    /// Its value at a place, which is clamped to 0..=1.
    pub(super) fn at(&self, x: f64) -> f64 {
        let x = x.clamp(0.0, 1.0);
        match self {
            Self::Sampled(values) => between(values, x),
            Self::Formula { g, a, b, c, d, e, f } if x >= *d => libm::pow((a * x + b).max(0.0), *g) + e,
            Self::Formula { c, f, .. } => c * x + f,
        }
    }

    /// Its values for a sample of 0 to `most`.
    pub(super) fn levels(&self, most: usize) -> Vec<f32> {
        (0..=most).map(|level| self.at(level as f64 / most as f64).clamp(0.0, 1.0) as f32).collect()
    }
}

/// The value at a place of 0..=1 between values at even distances.
pub(super) fn between(values: &[f32], x: f64) -> f64 {
    let place = x * (values.len() - 1) as f64;
    let low = (place as usize).min(values.len() - 2);
    let [a, b] = [values[low], values[low + 1]].map(f64::from);
    a + (b - a) * (place - low as f64)
}

/// Stored numbers as shares of the largest.
pub(super) fn normalized(store: &LutStore) -> Vec<f32> {
    match store {
        LutStore::Store8(values) => values.iter().map(|&v| f32::from(v) / 255.0).collect(),
        LutStore::Store16(values) => values.iter().map(|&v| f32::from(v) / 65535.0).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_those_of_the_specification() {
        let at = |curve: ToneReprCurve, x: f64| Curve::new(&curve).unwrap().at(x);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
        near(at(ToneReprCurve::Lut(vec![]), 0.3), 0.3);
        near(at(ToneReprCurve::Lut(vec![0x0200]), 0.5), 0.25);
        near(at(ToneReprCurve::Lut(vec![0, 65535, 0]), 0.25), 0.5);
        near(at(ToneReprCurve::Parametric(vec![2.0]), 0.5), 0.25);
        near(at(ToneReprCurve::Parametric(vec![2.0, 2.0, -0.5]), 0.2), 0.0);
        near(at(ToneReprCurve::Parametric(vec![2.0, 2.0, -0.5, 0.125]), 0.2), 0.125);
        near(at(ToneReprCurve::Parametric(vec![2.0, 2.0, -0.5, 0.125]), 0.5), 0.375);
        let srgb = vec![2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045];
        near(at(ToneReprCurve::Parametric(srgb.clone()), 0.5), 0.21404114);
        near(at(ToneReprCurve::Parametric(srgb), 0.02), 0.02 / 12.92);
        assert_eq!(Curve::new(&ToneReprCurve::Parametric(vec![1.0; 2])), None);
    }
}
