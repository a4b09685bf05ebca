//! Structural similarity of luma (0 to 255), pixel by pixel, at one scale (Wang and others 2004) and
//! at five (Wang, Simoncelli and Bovik 2003).
//!
//! Works badly for two textures that look the same but are not aligned: their values are near 0.

use super::plane::{Channel, gaussian};

/// Standard deviation of the Gaussian window, and its radius, in pixels.
const WINDOW: (f64, usize) = (1.5, 5);
/// Exponents of the five scales.
const WEIGHTS: [f64; 5] = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333];
/// Smallest side for five scales, in pixels.
const SMALLEST: usize = 176;
/// Stabilising constants C₁ and C₂ for the range 0 to 255.
const C: [f64; 2] = [6.5025, 58.5225];
/// Subtracted from luma before squaring, which limits rounding errors.
const MIDDLE: f32 = 128.0;

/// SSIM and MS-SSIM of the common central part of both pictures, 0 to 1. MS-SSIM is `None` if a side
/// is below 176 px.
pub(super) fn ssim(a: &Channel, b: &Channel) -> (f64, Option<f64>) {
    let (width, height) = (a.width.min(b.width), a.height.min(b.height));
    let luma = |p: &Channel| {
        let middle = p.crop((p.width - width) / 2, (p.height - height) / 2, width, height);
        middle.map(|v| libm::rintf(v * 255.0))
    };
    let (mut a, mut b) = (luma(a), luma(b));
    let (one, mut contrast) = scale(&a, &b);
    if width.min(height) < SMALLEST {
        return (one, None);
    }
    let (mut all, mut last) = (1.0, one);
    for (k, weight) in WEIGHTS.into_iter().enumerate() {
        if k > 0 {
            (a, b) = (halved(&a), halved(&b));
            (last, contrast) = scale(&a, &b);
        }
        all *= libm::pow(if k + 1 < WEIGHTS.len() { contrast } else { last }, weight);
    }
    (one, Some(all))
}

/// Mean similarity, and mean of its contrast–structure term alone; negative means count as 0.
fn scale(a: &Channel, b: &Channel) -> (f64, f64) {
    let (sigma, radius) = WINDOW;
    let bell = gaussian(sigma, 0);
    let middle = bell.len() / 2;
    let window = &bell[middle - radius..=middle + radius];
    let sum: f32 = window.iter().sum();
    let window: Vec<f32> = window.iter().map(|w| w / sum).collect();
    let mean = |p: &Channel| {
        // Only where the window fits the picture.
        p.correlate(&window, &window).crop(radius, radius, p.width - 2 * radius, p.height - 2 * radius)
    };
    let (a, b) = (a.clone().map(|v| v - MIDDLE), b.clone().map(|v| v - MIDDLE));
    let products = [a.zip(&a, |x, y| x * y), b.zip(&b, |x, y| x * y), a.zip(&b, |x, y| x * y)];
    let [aa, bb, ab] = products.map(|p| mean(&p));
    let (a, b) = (mean(&a), mean(&b));
    let (mut whole, mut structure) = (0.0, 0.0);
    for i in 0..a.data.len() {
        let [x, y, xx, yy, xy] = [&a, &b, &aa, &bb, &ab].map(|p| f64::from(p.data[i]));
        let contrast = (2.0 * (xy - x * y) + C[1]) / (xx - x * x + yy - y * y + C[1]);
        let contrast = contrast.max(0.0);
        let (x, y) = (x + f64::from(MIDDLE), y + f64::from(MIDDLE));
        structure += contrast;
        whole += contrast * (2.0 * x * y + C[0]) / (x * x + y * y + C[0]);
    }
    let count = a.data.len() as f64;
    (whole / count, structure / count)
}

/// Halves a plane by averaging 2 × 2 pixels. An odd side is padded by zeros at both ends.
fn halved(plane: &Channel) -> Channel {
    let at = |x: usize, y: usize| {
        // Coordinates in the padded plane.
        let inside = |v: usize, side: usize| v.checked_sub(side % 2).filter(|v| *v < side);
        inside(x, plane.width).zip(inside(y, plane.height)).map_or(0.0, |(x, y)| plane.at(x, y))
    };
    Channel::from_fn(plane.width.div_ceil(2), plane.height.div_ceil(2), |x, y| {
        let (x, y) = (2 * x, 2 * y);
        (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(width: usize, height: usize, phase: usize) -> Channel {
        Channel::from_fn(width, height, |x, y| ((x * 5 + y * 3 + phase) % 17) as f32 / 17.0)
    }

    #[test]
    fn a_picture_is_like_itself_and_unlike_its_negative() {
        let plane = wave(181, 190, 0);
        let (one, five) = ssim(&plane, &plane);
        assert!((one - 1.0).abs() < 1e-9 && (five.unwrap() - 1.0).abs() < 1e-9);
        let (one, five) = ssim(&plane, &plane.clone().map(|v| 1.0 - v));
        assert!(one < 0.05 && five.unwrap() < 0.2, "{one} {five:?}");
    }

    #[test]
    fn the_middles_are_compared() {
        let large = wave(120, 100, 0);
        let (one, five) = ssim(&large, &large.crop(10, 20, 100, 60));
        assert!((one - 1.0).abs() < 1e-9);
        assert_eq!(five, None);
    }

    #[test]
    fn halving_takes_means() {
        let even = halved(&Channel::from_fn(6, 4, |x, _| x as f32));
        assert_eq!((even.width, even.height, even.at(2, 1)), (3, 2, 4.5));
        let odd = halved(&Channel::from_fn(5, 4, |_, _| 4.0));
        assert_eq!((odd.width, odd.at(0, 0), odd.at(1, 0)), (3, 2.0, 4.0));
    }
}
