//! Finds the lattice of a picture from its autocorrelation.
//!
//! The lightness and the main axis of chroma are correlated, without structure larger than an eighth of the
//! side. A peak is a period if its double is a peak too, or if its sum and its difference with another peak
//! are. Two periods in different directions make a lattice. One period makes rows: the other direction is
//! free, or has no period. Vectors are fitted to all peaks at their multiples. A drawing that is one period
//! is repeated first.

use super::correlation::Autocorrelation;
use super::{LEAST_SINE, Lattice, cross, dot};
use image::RgbImage;
use vtex_base::raster::{Filter, resized};

/// Longest side at which pictures are correlated, in pixels.
const SIDE: u32 = 400;
/// Copies of a period along each side that are correlated.
const PERIODS: u32 = 3;
/// Shortest period, in pixels of the reduced picture.
const SHORTEST: f64 = 5.0;
/// Least correlation of the first period, and of a second one.
const LEAST: [f64; 2] = [0.3, 0.16];
/// Least correlation at the double of a period, as a share of that at the period.
const DOUBLE: f64 = 0.6;
/// Least rise of a peak above the lowest place on the way to it, as a share of its height.
const RISE: f64 = 0.35;
/// Shorter periods replace longer ones if their peaks reach this share of the highest.
const SHORTER: f64 = 0.55;
/// Least correlation along a free axis, and its largest variation there.
const FREE: [f64; 2] = [0.5, 0.25];
/// Longest periods that are confirmed by their sum and difference, as a share of the longest lag.
const NEAR: f64 = 0.6;
/// Multiples of each vector to which a lattice is fitted.
const MULTIPLES: i32 = 6;
/// Largest distance of a peak from the lattice, as a share of the shortest vector.
const ASTRAY: f64 = 0.16;

/// A peak of the autocorrelation.
#[derive(Clone, Copy)]
struct Peak {
    at: [f64; 2],
    height: f64,
}

/// The lattice of a picture, in its pixels; `None` if it has none. `repeated` if the picture is one period of a
/// larger one.
pub(crate) fn find(picture: &RgbImage, repeated: bool) -> Option<Lattice> {
    if repeated {
        let (width, height) = picture.dimensions();
        let at = |x: u32, y: u32| *picture.get_pixel(x % width, y % height);
        return find(&RgbImage::from_fn(PERIODS * width, PERIODS * height, at), false);
    }
    let (width, height) = picture.dimensions();
    let longest = width.max(height);
    if width.min(height) < 16 {
        return None;
    }
    let factor = (f64::from(longest) / f64::from(SIDE)).max(1.0);
    let size = [width, height].map(|v| libm::round(f64::from(v) / factor).max(1.0) as u32);
    let reduced =
        if factor > 1.0 { resized(picture, size[0], size[1], Filter::Triangle) } else { picture.clone() };
    let scale = [f64::from(width) / f64::from(size[0]), f64::from(height) / f64::from(size[1])];
    let correlation = Autocorrelation::new(&reduced);
    let found = lattice(&correlation)?;
    // Rounded to hundredths, which hides the platform-dependent last digits of a transform.
    let round = |v: f64| libm::round(v * 100.0) / 100.0 + 0.0;
    Some(Lattice {
        vectors: found.vectors.iter().map(|v| [0, 1].map(|k| round(v[k] * scale[k]))).collect(),
        strength: round(found.strength.clamp(0.0, 1.0)),
        stray: round(found.stray * scale[0].max(scale[1])),
    })
}

/// The lattice of a correlation, in its pixels.
fn lattice(correlation: &Autocorrelation) -> Option<Lattice> {
    let vectors = match free_axis(correlation) {
        Some(axis) => vec![across(correlation, axis)?],
        None => {
            let peaks = peaks(correlation);
            let recurs =
                |p: &Peak| has_double(correlation, p) || peaks.iter().any(|q| has_sum(correlation, p, q));
            let first = shortest(&peaks, |p| p.height >= LEAST[0] && recurs(p))?;
            let beside = |p: &Peak| {
                cross(p.at, first.at).abs() > 0.5 * dot(first.at, first.at).min(dot(p.at, p.at))
                    && cross(p.at, first.at).abs() > LEAST_SINE * length(p.at) * length(first.at)
            };
            let second = shortest(&peaks, |p| beside(p) && recurs(p));
            std::iter::once(first.at).chain(second.map(|p| p.at)).collect()
        }
    };
    fitted(correlation, vectors)
}

/// The direction along which the picture stays the same, a unit vector.
fn free_axis(correlation: &Autocorrelation) -> Option<[f64; 2]> {
    let far = 0.7 * f64::from(correlation.reach[0].min(correlation.reach[1]));
    let lowest = |degrees: i32| {
        let (sine, cosine) = libm::sincos(f64::from(degrees).to_radians());
        let steps = (2..=40).map(|k| far * f64::from(k) / 40.0);
        let values = steps.filter_map(|t| correlation.between([t * cosine, t * sine]));
        let [low, high] = values.fold([1.0, 0.0], |[low, high], v| [f64::min(low, v), f64::max(high, v)]);
        (low, high, [cosine, sine])
    };
    let (low, high, axis) = (0..180).map(lowest).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (low >= FREE[0] && high - low <= FREE[1]).then_some(axis)
}

/// The period across a free axis.
fn across(correlation: &Autocorrelation, axis: [f64; 2]) -> Option<[f64; 2]> {
    let normal = [-axis[1], axis[0]];
    let profile = |t: f64| correlation.between(normal.map(|c| c * t));
    let most = (0..).map(f64::from).take_while(|&t| profile(t).is_some()).last()?;
    let value = |t: f64| profile(t).unwrap_or(0.0);
    let mut lowest = 1.0f64;
    let mut found: Vec<(f64, f64)> = Vec::new();
    for t in (1..most as i32 - 1).map(f64::from) {
        let height = value(t);
        lowest = lowest.min(height);
        let is_peak = (1..=3).map(f64::from).all(|d| value(t - d) <= height && value(t + d) <= height);
        let high = (-2..=2).map(|d| value(2.0 * t + f64::from(d))).fold(-1.0, f64::max);
        if is_peak
            && t >= SHORTEST
            && height >= LEAST[0]
            && height - lowest >= RISE * height
            && high >= DOUBLE * height
        {
            found.push((t, height));
        }
    }
    let highest = found.iter().map(|f| f.1).fold(0.0, f64::max);
    let (t, _) = *found.iter().find(|f| f.1 >= SHORTER * highest)?;
    Some(normal.map(|c| c * t))
}

/// The peaks of a half plane of lags.
fn peaks(correlation: &Autocorrelation) -> Vec<Peak> {
    let [rx, ry] = correlation.reach;
    let mut peaks = Vec::new();
    for y in 0..=ry - 2 {
        for x in -rx + 2..=rx - 2 {
            if (y == 0 && x <= 0) || libm::hypot(f64::from(x), f64::from(y)) < SHORTEST {
                continue;
            }
            let height = correlation.at([x, y]).unwrap_or(0.0);
            if height < LEAST[1] {
                continue;
            }
            let around = (-2..=2).flat_map(|v| (-2..=2).map(move |u| [u, v]));
            if around
                .filter(|&d| d != [0, 0])
                .any(|[u, v]| correlation.at([x + u, y + v]).unwrap_or(0.0) > height)
            {
                continue;
            }
            let Some((at, height)) = correlation.peak_near([f64::from(x), f64::from(y)], 1) else { continue };
            let way = (1..=12).filter_map(|k| correlation.between(at.map(|c| c * f64::from(k) / 13.0)));
            if height - way.fold(1.0, f64::min) >= RISE * height {
                peaks.push(Peak { at, height });
            }
        }
    }
    peaks
}

/// The peak with the shortest lag among those that satisfy `counts` and are nearly as high as the highest of
/// them.
fn shortest(peaks: &[Peak], counts: impl Fn(&Peak) -> bool) -> Option<Peak> {
    let counting: Vec<&Peak> = peaks.iter().filter(|p| counts(p)).collect();
    let highest = counting.iter().map(|p| p.height).fold(0.0, f64::max);
    let high = counting.into_iter().filter(|p| p.height >= SHORTER * highest);
    high.min_by(|a, b| length(a.at).total_cmp(&length(b.at))).copied()
}

/// Whether the double of a peak is a peak too.
fn has_double(correlation: &Autocorrelation, peak: &Peak) -> bool {
    let radius = (0.06 * length(peak.at)).clamp(2.0, 8.0) as i32;
    let double = correlation.peak_near(peak.at.map(|c| 2.0 * c), radius);
    let between = correlation.between(peak.at.map(|c| 1.5 * c)).unwrap_or(1.0);
    double
        .is_some_and(|(_, height)| height >= DOUBLE * peak.height && height - between >= 0.5 * RISE * height)
}

/// Whether two peaks of nearly the same height, one of them high, are periods because their sum and their difference are
/// peaks too.
fn has_sum(correlation: &Autocorrelation, p: &Peak, q: &Peak) -> bool {
    let low = p.height.min(q.height);
    let beside = cross(p.at, q.at).abs() > 0.5 * length(p.at) * length(q.at);
    let is_peak = |sign: f64| {
        let at = [0, 1].map(|k| p.at[k] + sign * q.at[k]);
        correlation.peak_near(at, 2).is_some_and(|(_, height)| height >= DOUBLE * low)
    };
    let near = [p, q].iter().all(|v| (0..2).all(|k| v.at[k].abs() <= NEAR * f64::from(correlation.reach[k])));
    low >= LEAST[0] && near && beside && is_peak(1.0) && is_peak(-1.0)
}

/// The lattice of least squares through the peaks near the multiples of vectors; `None` if most of these are
/// no peaks.
fn fitted(correlation: &Autocorrelation, vectors: Vec<[f64; 2]>) -> Option<Lattice> {
    let mut vectors = reduced(vectors);
    let heights = |vectors: &[[f64; 2]]| {
        let of = |v: &[f64; 2]| {
            let peak = correlation.peak_near(*v, 2).map(|p| p.1);
            peak.or_else(|| correlation.between(*v)).unwrap_or(0.0)
        };
        vectors.iter().map(of).fold(1.0, f64::min)
    };
    let mut stray = 0.0;
    let mut share = 0.0;
    // Multiples are used from the nearest outwards: each fit predicts the places of the next ring.
    for most in 1..=MULTIPLES {
        let near = ASTRAY * vectors.iter().map(|v| length(*v)).fold(f64::INFINITY, f64::min);
        let radius = near.clamp(1.0, 6.0) as i32;
        let second = if vectors.len() > 1 { -most..=most } else { 0..=0 };
        let (mut found, mut wanted) = (Vec::new(), 0);
        for m in second {
            for n in 0..=most {
                if n == 0 && m <= 0 {
                    continue;
                }
                let factors = [f64::from(n), f64::from(m)];
                let at = [0, 1].map(|k| vectors.iter().zip(factors).map(|(v, f)| v[k] * f).sum::<f64>());
                if correlation.at(at.map(|c| libm::round(c) as i32)).is_none() {
                    continue;
                }
                wanted += 1;
                if let Some((place, height)) = correlation.peak_near(at, radius).filter(|p| p.1 > 0.05) {
                    found.push((factors, place, height));
                }
            }
        }
        if found.is_empty() {
            return None;
        }
        share = found.len() as f64 / f64::from(wanted);
        vectors = least_squares(&vectors, &found);
        let miss = |(factors, place, _): &([f64; 2], [f64; 2], f64)| {
            let at = [0, 1].map(|k| vectors.iter().zip(factors).map(|(v, f)| v[k] * f).sum::<f64>());
            // Rows have no period along themselves.
            let d = [place[0] - at[0], place[1] - at[1]];
            match vectors[..] {
                [a] => dot(d, a) * dot(d, a) / dot(a, a),
                _ => dot(d, d),
            }
        };
        stray = libm::sqrt(found.iter().map(miss).sum::<f64>() / found.len() as f64);
    }
    let strength = heights(&vectors);
    (share >= 0.5).then_some(Lattice { vectors, strength, stray })
}

/// Vectors that fit places at multiples of them, weighted by height.
fn least_squares(vectors: &[[f64; 2]], found: &[([f64; 2], [f64; 2], f64)]) -> Vec<[f64; 2]> {
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    let (mut ax, mut bx) = ([0.0; 2], [0.0; 2]);
    for ([n, m], place, height) in found {
        aa += height * n * n;
        ab += height * n * m;
        bb += height * m * m;
        for k in 0..2 {
            ax[k] += height * n * place[k];
            bx[k] += height * m * place[k];
        }
    }
    if let [a] = vectors {
        // Only the length is fitted: the place of a row along itself is arbitrary.
        let along = if aa > 0.0 { dot(ax, *a) / (aa * dot(*a, *a)) } else { 1.0 };
        return vec![a.map(|c| c * along)];
    }
    let d = aa * bb - ab * ab;
    if d.abs() < 1e-9 {
        return vectors.to_vec();
    }
    let solved = |k: usize| [(ax[k] * bb - bx[k] * ab) / d, (bx[k] * aa - ax[k] * ab) / d];
    let [x, y] = [solved(0), solved(1)];
    vec![[x[0], y[0]], [x[1], y[1]]]
}

/// The shortest vectors of the same lattice, pointing right or down.
fn reduced(vectors: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let [mut a, mut b] = vectors[..] else { return vectors };
    loop {
        if dot(b, b) < dot(a, a) {
            (a, b) = (b, a);
        }
        let n = libm::round(dot(a, b) / dot(a, a));
        let shorter = [b[0] - n * a[0], b[1] - n * a[1]];
        // Without this, two vectors of equal length would be exchanged endlessly.
        if dot(shorter, shorter) >= dot(b, b) * 0.999 {
            break;
        }
        b = shorter;
    }
    let forward = |v: [f64; 2]| if v[1] < 0.0 || (v[1] == 0.0 && v[0] < 0.0) { v.map(|c| -c) } else { v };
    let [a, b] = [forward(a), forward(b)];
    vec![a, b]
}

fn length(v: [f64; 2]) -> f64 {
    libm::hypot(v[0], v[1])
}
