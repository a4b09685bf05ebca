//! Vectors fitted to the peaks of a correlation.

use super::correlation::Autocorrelation;
use super::{cross, dot, length};

/// Multiples of each vector to which a lattice is fitted.
const MULTIPLES: i32 = 6;
/// Largest distance of a peak from the lattice, as a share of the shortest vector, and in pixels.
const ASTRAY: f64 = 0.16;
const MOST_ASTRAY: f64 = 6.0;
/// Least height of a peak that counts.
const LEAST_HEIGHT: f64 = 0.05;
/// Least share of the multiples that are peaks.
const LEAST_SHARE: f64 = 0.5;

/// A peak near a multiple of two vectors.
struct Near {
    factors: [f64; 2],
    place: [f64; 2],
    height: f64,
}

/// The vectors of least squares through the peaks near the multiples of two vectors, and the standard deviation of
/// these peaks from them, in pixels; `None` if most multiples have no peak.
pub(super) fn fitted(correlation: &Autocorrelation, vectors: [[f64; 2]; 2]) -> Option<([[f64; 2]; 2], f64)> {
    let mut vectors = vectors;
    let mut share = 0.0;
    let mut stray = 0.0;
    // Multiples are used from the nearest outwards: each fit predicts the places of the next ring.
    for most in 1..=MULTIPLES {
        let radius = astray(vectors) as i32;
        let factors = (-most..=most).flat_map(|m| (0..=most).map(move |n| [f64::from(n), f64::from(m)]));
        let wanted = factors.filter(|&[n, m]| n > 0.0 || m > 0.0).filter(|&factors| {
            correlation.at(sum(vectors, factors).map(|c| libm::round(c) as i32)).is_some()
        });
        let wanted: Vec<[f64; 2]> = wanted.collect();
        let near = |&factors: &[f64; 2]| {
            let (place, height) = correlation.peak_near(sum(vectors, factors), radius)?;
            (height > LEAST_HEIGHT).then_some(Near { factors, place, height })
        };
        let found: Vec<Near> = wanted.iter().filter_map(near).collect();
        if found.is_empty() {
            return None;
        }
        share = found.len() as f64 / wanted.len() as f64;
        vectors = least_squares(vectors, &found);
        let miss = |near: &Near| {
            let at = sum(vectors, near.factors);
            let d = [near.place[0] - at[0], near.place[1] - at[1]];
            dot(d, d)
        };
        stray = libm::sqrt(found.iter().map(miss).sum::<f64>() / found.len() as f64);
    }
    (share >= LEAST_SHARE).then_some((vectors, stray))
}

/// Largest distance of peaks from a lattice, in pixels.
fn astray(vectors: [[f64; 2]; 2]) -> f64 {
    (ASTRAY * length(vectors[0]).min(length(vectors[1]))).clamp(1.0, MOST_ASTRAY)
}

/// Whether peaks at two vectors may be those of two others.
pub(super) fn is_near(peaks: [[f64; 2]; 2], vectors: [[f64; 2]; 2]) -> bool {
    (0..2).all(|k| length(sum([peaks[k], vectors[k]], [1.0, -1.0])) <= astray(vectors))
}

/// The sum of two vectors times two factors.
pub(super) fn sum([a, b]: [[f64; 2]; 2], [n, m]: [f64; 2]) -> [f64; 2] {
    [n * a[0] + m * b[0], n * a[1] + m * b[1]]
}

/// Vectors that fit places at multiples of them, weighted by height.
fn least_squares(vectors: [[f64; 2]; 2], found: &[Near]) -> [[f64; 2]; 2] {
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    let (mut ax, mut bx) = ([0.0; 2], [0.0; 2]);
    for Near { factors: [n, m], place, height } in found {
        aa += height * n * n;
        ab += height * n * m;
        bb += height * m * m;
        for k in 0..2 {
            ax[k] += height * n * place[k];
            bx[k] += height * m * place[k];
        }
    }
    let d = aa * bb - ab * ab;
    if d.abs() < 1e-9 {
        return vectors;
    }
    let solved = |k: usize| [(ax[k] * bb - bx[k] * ab) / d, (bx[k] * aa - ax[k] * ab) / d];
    let [x, y] = [solved(0), solved(1)];
    [[x[0], y[0]], [x[1], y[1]]]
}

/// The shortest vectors of the same lattice, pointing right or down.
pub(super) fn shortest([mut a, mut b]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    loop {
        if dot(b, b) < dot(a, a) {
            (a, b) = (b, a);
        }
        let n = libm::round(dot(a, b) / dot(a, a));
        let shorter = [b[0] - n * a[0], b[1] - n * a[1]];
        // Without this, two vectors of equal length would be exchanged endlessly, and so would vectors of no length.
        let is_shorter = dot(shorter, shorter) < dot(b, b) * 0.999;
        if !is_shorter {
            break;
        }
        b = shorter;
    }
    [a, b].map(forward)
}

/// The vector or its opposite, whichever points down, or right if it is level.
pub(super) fn forward(v: [f64; 2]) -> [f64; 2] {
    if v[1] < 0.0 || (v[1] == 0.0 && v[0] < 0.0) { v.map(|c| -c) } else { v }
}

/// Whether a vector is nearly a sum of whole multiples of two others.
pub(super) fn is_sum(v: [f64; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    /// Largest distance from a whole multiple.
    const NEAR: f64 = 0.06;
    let whole = |v: f64| (v - libm::round(v)).abs() < NEAR;
    whole(cross(v, b) / cross(a, b)) && whole(cross(a, v) / cross(a, b))
}

/// Whether two pairs of vectors make nearly the same lattice.
pub(super) fn is_same(one: [[f64; 2]; 2], other: [[f64; 2]; 2]) -> bool {
    let areas = cross(one[0], one[1]) / cross(other[0], other[1]);
    (areas.abs() - 1.0).abs() < 0.1 && one.iter().all(|&v| is_sum(v, other))
}
