//! Slow changes of light: a plate lit from one side, a dark corner.
//!
//! Taken for colours of things they come back as blotches, since neighbours of a texture come from places that were lit
//! differently. The light is a surface of second degree, fitted to the logarithms of the mean linear lightness of blocks,
//! as in the correction of shading of microscope pictures (Likar et al., "Retrospective shading correction based on
//! entropy minimization", 2000, who fit the same surface by another measure). It is divided out.
//!
//! Works badly where half of a photograph shows another thing, slowly changing into the first.

use image::RgbImage;
use vtex_base::raster::colour::{encoded, linear};
use vtex_scene::library::EvenLight;

/// Blocks along each side.
const BLOCKS: usize = 16;
/// Least share of the blocks' variance that the surface explains, also as a multiple of the share that one straight
/// border between two even halves explains: of light that falls off evenly such a border explains three quarters.
const EXPLAINED: f64 = 0.5;
const UNLIKE_HALVES: f64 = 1.25;
/// Share from which on there is nothing but light.
const ALL: f64 = 0.98;
/// Least ratio of the brightest to the darkest place of the surface.
const SEEN: f64 = 1.25;
/// Greatest change of lightness of a place, either way.
const MOST: f64 = 3.0;
/// Directions of straight borders.
const DIRECTIONS: usize = 12;
/// Added to linear lightness, so that black has a logarithm.
const BLACK: f64 = 1e-3;

/// The light over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Light {
    /// Coefficients of the [`terms`] of a place. The values are logarithms of lightness, 0 on average.
    surface: [f64; 5],
    /// How many times as bright as the darkest place the brightest is.
    pub(super) ratio: f64,
}

impl Light {
    /// The light to be taken out of a picture; `None` to leave it as it is.
    pub(super) fn of(image: &RgbImage, choice: EvenLight) -> Option<Self> {
        if choice == EvenLight::Off || image.width().min(image.height()) < 4 * BLOCKS as u32 {
            return None;
        }
        let blocks = blocks(image);
        let light = Self::fitted(&blocks);
        let is_seen = || {
            let explained = light.explains(&blocks);
            light.ratio >= SEEN
                && (EXPLAINED..ALL).contains(&explained)
                && explained >= UNLIKE_HALVES * halves(&blocks)
        };
        (choice == EvenLight::On || is_seen()).then_some(light)
    }

    /// The surface of least squares through the blocks.
    fn fitted(blocks: &[f64]) -> Self {
        // The terms are orthogonal over the blocks, so each has its own coefficient.
        let (mut products, mut squares) = ([0.0; 5], [0.0; 5]);
        for (k, value) in blocks.iter().enumerate() {
            let terms = terms(middle(k));
            for i in 0..5 {
                products[i] += terms[i] * value;
                squares[i] += terms[i] * terms[i];
            }
        }
        let surface = std::array::from_fn(|i| products[i] / squares[i]);
        let values: Vec<f64> = (0..blocks.len()).map(|k| value(&surface, middle(k))).collect();
        let most = |start: f64, by: fn(f64, f64) -> f64| values.iter().copied().fold(start, by);
        let ratio = libm::exp(most(f64::NEG_INFINITY, f64::max) - most(f64::INFINITY, f64::min));
        Self { surface, ratio }
    }

    /// Share of the blocks' variance that it explains.
    fn explains(&self, blocks: &[f64]) -> f64 {
        let all = mean(blocks);
        let square = |rest: &dyn Fn(usize) -> f64| (0..blocks.len()).map(|k| rest(k) * rest(k)).sum::<f64>();
        let rest = square(&|k| blocks[k] - all - value(&self.surface, middle(k)));
        1.0 - rest / square(&|k| blocks[k] - all).max(1e-12)
    }

    /// A picture without this light.
    pub(super) fn taken_out(&self, image: &RgbImage) -> RgbImage {
        let [width, height] = [image.width(), image.height()].map(f64::from);
        RgbImage::from_fn(image.width(), image.height(), |x, y| {
            let place = [(2.0 * f64::from(x) + 1.0) / width - 1.0, (2.0 * f64::from(y) + 1.0) / height - 1.0];
            let gain = libm::exp(-value(&self.surface, place)).clamp(1.0 / MOST, MOST) as f32;
            let mut pixel = *image.get_pixel(x, y);
            pixel.0 = pixel.0.map(|c| encoded((gain * linear(c)).min(1.0)));
            pixel
        })
    }
}

/// Logarithms of the mean linear lightness of blocks, row by row.
fn blocks(image: &RgbImage) -> Vec<f64> {
    let mut sums = vec![(0.0f64, 0u32); BLOCKS * BLOCKS];
    let block = |v: u32, size: u32| (v as usize * BLOCKS) / size as usize;
    for (x, y, pixel) in image.enumerate_pixels() {
        let k = block(y, image.height()) * BLOCKS + block(x, image.width());
        sums[k].0 += f64::from(pixel.0.iter().map(|&c| linear(c)).sum::<f32>() / 3.0);
        sums[k].1 += 1;
    }
    sums.iter().map(|&(sum, count)| libm::log(sum / f64::from(count.max(1)) + BLACK)).collect()
}

/// The middle of a block, each coordinate from -1 to 1.
fn middle(k: usize) -> [f64; 2] {
    [k % BLOCKS, k / BLOCKS].map(|v| (2 * v + 1) as f64 / BLOCKS as f64 - 1.0)
}

/// u, v, u² - m, uv, v² - m at a place, where u and v are -1 at the left and at the top, 1 at the right and at the bottom,
/// and m is the mean square of such a coordinate over the blocks.
fn terms([u, v]: [f64; 2]) -> [f64; 5] {
    const MEAN: f64 = (1.0 - 1.0 / (BLOCKS * BLOCKS) as f64) / 3.0;
    [u, v, u * u - MEAN, u * v, v * v - MEAN]
}

fn value(surface: &[f64; 5], place: [f64; 2]) -> f64 {
    terms(place).iter().zip(surface).map(|(a, b)| a * b).sum()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Share of the blocks' variance that the best straight border between two even parts explains.
fn halves(blocks: &[f64]) -> f64 {
    let (count, all) = (blocks.len(), mean(blocks));
    let sum = |values: &[f64]| values.iter().map(|v| v - all).sum::<f64>();
    let mut best = 0.0f64;
    for turn in (0..DIRECTIONS).map(|k| std::f64::consts::PI * k as f64 / DIRECTIONS as f64) {
        let (sine, cosine) = libm::sincos(turn);
        let across = |k: usize| {
            let [u, v] = middle(k);
            cosine * u + sine * v
        };
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| across(a).total_cmp(&across(b)));
        let sorted: Vec<f64> = order.into_iter().map(|k| blocks[k]).collect();
        for at in (count / 6..count - count / 6).step_by(BLOCKS / 2) {
            let (left, right) = sorted.split_at(at);
            let parts = [left, right].map(|part| sum(part) * sum(part) / part.len() as f64);
            best = best.max(parts.iter().sum());
        }
    }
    best / blocks.iter().map(|v| (v - all) * (v - all)).sum::<f64>().max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::sampling::stream;

    /// Stones on a ground under a light, which is given for places from 0 to 1.
    fn picture(light: impl Fn(f64, f64) -> f64) -> RgbImage {
        let mut random = stream(3, "light test", 0);
        let mut picture = vec![0.25f64; 160 * 160];
        for _ in 0..160 {
            let (cx, cy, r) = (random.range(0.0, 160.0), random.range(0.0, 160.0), random.range(4.0, 9.0));
            let tone = random.range(0.2, 0.35);
            for (i, value) in picture.iter_mut().enumerate() {
                let (dx, dy) = ((i % 160) as f64 - cx, (i / 160) as f64 - cy);
                *value = if dx * dx + dy * dy < r * r { tone } else { *value };
            }
        }
        RgbImage::from_fn(160, 160, |x, y| {
            let lit = picture[(y * 160 + x) as usize] * light(f64::from(x) / 160.0, f64::from(y) / 160.0);
            Rgb([encoded(lit.min(1.0) as f32); 3])
        })
    }

    #[test]
    fn light_from_one_side_is_found_and_taken_out() {
        let lit = picture(|x, y| 0.5 + x + 0.3 * y);
        let light = Light::of(&lit, EvenLight::Auto).expect("the light is seen");
        assert!((2.5..4.5).contains(&light.ratio), "{}", light.ratio);
        let even = light.taken_out(&lit);
        // Lightness of the left and the right third.
        let third = |image: &RgbImage, from: u32| {
            let pixels = image.enumerate_pixels().filter(|(x, _, _)| (from..from + 53).contains(x));
            pixels.map(|(_, _, p)| f64::from(linear(p.0[0]))).sum::<f64>()
        };
        let ratio = |image: &RgbImage| third(image, 107) / third(image, 0);
        assert!(
            ratio(&lit) > 1.8 && (0.87..1.15).contains(&ratio(&even)),
            "{} {}",
            ratio(&lit),
            ratio(&even)
        );
        assert!(Light::of(&even, EvenLight::Auto).is_none());
        assert!(Light::of(&lit, EvenLight::Off).is_none());
    }

    #[test]
    fn other_changes_are_left_as_they_are() {
        // Even light; another surface on one half.
        assert!(Light::of(&picture(|_, _| 1.0), EvenLight::Auto).is_none());
        assert!(Light::of(&picture(|x, _| if x < 0.5 { 0.5 } else { 1.5 }), EvenLight::Auto).is_none());
        assert!(Light::of(&picture(|_, _| 1.0), EvenLight::On).is_some());
    }
}
