//! Power spectra by frequency and direction, and repetition by autocorrelation.

use super::plane::Channel;
use rustfft::FftDirection;
use std::f64::consts::PI;
use vtex_base::fourier::Spectrum;

/// Number of frequency bands, evenly spaced in the logarithm.
const BANDS: usize = 14;
/// Number of directions over half a turn.
const DIRECTIONS: usize = 8;
/// Added to power before its logarithm is taken.
const FLOOR: f64 = 1e-7;
/// Largest and smallest side of a window, in pixels.
const WINDOW: [usize; 2] = [256, 64];
/// Largest number of windows along a side.
const WINDOWS: usize = 3;
/// Standard deviation of the local mean that is subtracted before the autocorrelation, in pixels.
const LOCAL: f64 = 12.0;
/// Shortest lag that counts as repetition, in pixels.
const SHORTEST: f64 = 12.0;

/// Side of the windows on which two pictures are compared, in pixels.
pub(super) fn window(a: &Channel, b: &Channel) -> usize {
    let smallest = a.width.min(a.height).min(b.width).min(b.height);
    (smallest.min(WINDOW[0]) / 16 * 16).max(WINDOW[1])
}

/// Root mean square differences of log power: over bands, and over bands split by direction.
pub(super) fn psd(a: &Channel, b: &Channel, window: usize) -> [f64; 2] {
    let (a, b) = (Power::new(a, window), Power::new(b, window));
    let rms = |a: &[Option<f64>], b: &[Option<f64>]| {
        let pairs = a.iter().zip(b).filter_map(|(a, b)| Some((*a)? - (*b)?));
        let (sum, count) = pairs.fold((0.0, 0.0), |(s, n), d| (s + d * d, n + 1.0));
        libm::sqrt(sum / f64::max(count, 1.0))
    };
    [rms(&a.bands, &b.bands), rms(&a.directed, &b.directed)]
}

/// Logarithms of mean power; `None` for a band that contains no frequency.
struct Power {
    bands: Vec<Option<f64>>,
    directed: Vec<Option<f64>>,
}

impl Power {
    /// Mean over windows of side `w`.
    fn new(plane: &Channel, w: usize) -> Self {
        let bell: Vec<f64> =
            (0..w).map(|i| 0.5 - 0.5 * libm::cos(2.0 * PI * i as f64 / (w - 1) as f64)).collect();
        let mut power = vec![0.0; w * w];
        let windows = windows(plane, w);
        for part in &windows {
            let mean = part.data.iter().map(|v| f64::from(*v)).sum::<f64>() / (w * w) as f64;
            let faded = |x, y| (f64::from(part.at(x, y)) - mean) * bell[x] * bell[y];
            let spectrum = Spectrum::new(w, w, faded).transformed(FftDirection::Forward);
            power.iter_mut().zip(&spectrum.data).for_each(|(p, v)| *p += v.norm_sqr());
        }
        let weight: f64 = bell.iter().map(|v| v * v).sum::<f64>();
        let scale = 1.0 / (windows.len() as f64 * weight * weight);
        Self::binned(&power, w, scale)
    }

    fn binned(power: &[f64], w: usize, scale: f64) -> Self {
        let lowest = (3.0 / w as f64).max(0.012);
        let edge = |i: usize| match i {
            0 => lowest,
            BANDS => 0.5,
            _ => lowest * libm::pow(0.5 / lowest, i as f64 / BANDS as f64),
        };
        let edges: Vec<f64> = (0..=BANDS).map(edge).collect();
        let mut bands = [(0.0, 0u32); BANDS];
        let mut directed = [(0.0, 0u32); BANDS * DIRECTIONS];
        let frequency =
            |i: usize| (if i < w.div_ceil(2) { i as f64 } else { i as f64 - w as f64 }) / w as f64;
        for (i, value) in power.iter().enumerate() {
            // The spectrum is transposed.
            let (x, y) = (frequency(i / w), frequency(i % w));
            let radius = libm::hypot(x, y);
            let band = edges.partition_point(|e| *e <= radius);
            if band == 0 || band > BANDS {
                continue;
            }
            let add = |bin: &mut (f64, u32)| *bin = (bin.0 + value * scale, bin.1 + 1);
            add(&mut bands[band - 1]);
            let angle = libm::atan2(y, x).rem_euclid(PI);
            for d in 0..DIRECTIONS {
                let apart = (angle - d as f64 * PI / DIRECTIONS as f64).abs();
                // A frequency on the border of two directions belongs to both.
                if apart.min(PI - apart) <= PI / (2 * DIRECTIONS) as f64 + 1e-9 {
                    add(&mut directed[(band - 1) * DIRECTIONS + d]);
                }
            }
        }
        let log = |least: u32| {
            move |&(sum, n): &(f64, u32)| (n >= least).then(|| libm::log(sum / f64::from(n) + FLOOR))
        };
        Self { bands: bands.iter().map(log(1)).collect(), directed: directed.iter().map(log(2)).collect() }
    }
}

/// Windows on an even grid; they overlap if the picture is small. A picture smaller than a window is
/// mirrored.
fn windows(plane: &Channel, w: usize) -> Vec<Channel> {
    let mirrored = |i: usize, n: usize| {
        let i = i % (2 * (n - 1));
        if i < n { i } else { 2 * (n - 1) - i }
    };
    let (width, height) = (plane.width.max(w), plane.height.max(w));
    let plane =
        Channel::from_fn(width, height, |x, y| plane.at(mirrored(x, plane.width), mirrored(y, plane.height)));
    let starts = |side: usize| -> Vec<usize> {
        let free = (side - w) as f64;
        let count = (libm::ceil(free / (w as f64 / 2.0)) as usize + 1).min(WINDOWS);
        let start = |i: usize| libm::rint(free * i as f64 / (count - 1).max(1) as f64) as usize;
        let mut all: Vec<usize> = (0..count).map(start).collect();
        all.dedup();
        all
    };
    let (xs, ys) = (starts(width), starts(height));
    ys.iter().flat_map(|y| xs.iter().map(|x| plane.crop(*x, *y, w, w))).collect()
}

/// Largest normalised autocorrelation at lags beyond 12 px for which at least a quarter of the
/// picture overlaps itself. 1 for an exactly repeating picture.
pub(super) fn acf_peak(plane: &Channel) -> f64 {
    let (width, height) = (plane.width, plane.height);
    let mean = plane.smooth(LOCAL);
    // Padding to twice the size avoids wrap-around.
    let padded = Spectrum::new(2 * width, 2 * height, |x, y| {
        if x < width && y < height { f64::from(plane.at(x, y) - mean.at(x, y)) } else { 0.0 }
    });
    let mut power = padded.transformed(FftDirection::Forward);
    power.data.iter_mut().for_each(|v| *v = v.norm_sqr().into());
    let found = power.transformed(FftDirection::Inverse);
    let scale = 1.0 / (4 * width * height) as f64;
    let all = (width * height) as f64;
    let none = found.data[0].re * scale / all + 1e-12;
    let mut peak = f64::NEG_INFINITY;
    for y in 0..height {
        for x in -(width as isize) + 1..width as isize {
            let common = (width - x.unsigned_abs()) as f64 * (height - y) as f64;
            if common <= 0.25 * all || libm::hypot(x as f64, y as f64) <= SHORTEST {
                continue;
            }
            let column = x.rem_euclid(2 * width as isize) as usize;
            peak = peak.max(found.data[y * 2 * width + column].re * scale / common / none);
        }
    }
    peak
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    fn noise(side: usize) -> Channel {
        let mut random = stream(1, "spectrum test", 0);
        Channel { width: side, height: side, data: (0..side * side).map(|_| random.unit() as f32).collect() }
    }

    #[test]
    fn what_repeats_has_a_peak() {
        let tile = noise(40);
        let repeated = Channel::from_fn(160, 150, |x, y| tile.at(x % 40, y % 40));
        assert!(acf_peak(&repeated) > 0.95);
        assert!(acf_peak(&noise(150)) < 0.1);
        // A flat picture does not repeat, and neither does its rounding noise.
        assert!(acf_peak(&Channel::from_fn(64, 64, |_, _| 0.5)).abs() < 0.1);
    }

    #[test]
    fn smooth_differs_from_rough_and_stripes_from_both() {
        let (rough, smooth) = (noise(128), noise(128).smooth(1.0));
        assert_eq!(psd(&rough, &rough, 128), [0.0; 2]);
        assert!(psd(&rough, &smooth, 128)[0] > 1.0);
        let [upright, level] = [[1.5, 0.0], [0.0, 1.5]].map(|[x, y]| rough.correlate(&blur(x), &blur(y)));
        let [radial, directed] = psd(&upright, &level, 128);
        assert!(directed > 4.0 * radial, "{radial} {directed}");
    }

    fn blur(sigma: f64) -> Vec<f32> {
        if sigma == 0.0 { vec![1.0] } else { super::super::plane::gaussian(sigma, 0) }
    }

    #[test]
    fn small_pictures_are_mirrored_and_large_ones_covered() {
        assert_eq!(windows(&noise(40), 64).len(), 1);
        assert_eq!(windows(&noise(70), 64).len(), 4);
        let found = windows(&noise(300), 64);
        assert_eq!(found.len(), 9);
        assert_eq!(found[8].at(63, 63), noise(300).at(299, 299));
    }
}
