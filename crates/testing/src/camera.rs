//! Camera simulation: uneven lighting, lens blur, tone curve and sensor noise.

use super::fills::Light;
use super::noise::hash;
use image::RgbImage;

/// Parameters of the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    /// Relative brightening from the centre to the right and to the lower border.
    pub(super) gradient: [f32; 2],
    /// Darkening of the corners.
    pub(super) vignette: f32,
    /// Standard deviation of the blur in pixels.
    pub(super) blur: f32,
    /// Tone adjustment: positive lifts the middle tones, negative lowers them.
    pub(super) tone: f32,
    /// Standard deviation of the noise in 8-bit levels.
    pub(super) noise: f32,
    pub(super) seed: u32,
}

impl Camera {
    /// Takes the picture: converts linear light to 8-bit sRGB.
    pub(super) fn take(&self, mut light: Vec<Light>, width: usize, height: usize) -> RgbImage {
        let (cx, cy) = (width as f32 * 0.5, height as f32 * 0.5);
        for (i, pixel) in light.iter_mut().enumerate() {
            let (u, v) = (((i % width) as f32 - cx) / cx, ((i / width) as f32 - cy) / cy);
            let gain =
                1.0 + self.gradient[0] * u + self.gradient[1] * v - 0.5 * self.vignette * (u * u + v * v);
            *pixel = pixel.map(|c| c * gain.max(0.1));
        }
        expose(&mut light);
        blur(&mut light, width, height, self.blur);
        let mut bytes = Vec::with_capacity(light.len() * 3);
        for (i, pixel) in light.iter().enumerate() {
            let (x, y) = ((i % width) as i32, (i / width) as i32);
            let shared = bell(hash(x, y, self.seed));
            let own = hash(y, x, self.seed ^ 0x00ca_3e4a);
            for (k, &c) in pixel.iter().enumerate() {
                let v = c.clamp(0.0, 1.0).sqrt();
                let v = v + self.tone * v * (1.0 - v);
                let grain = 0.8 * shared + 0.6 * bell(own.rotate_left(11 * k as u32) & 0x00ff_ffff);
                let level = v * 255.0 + self.noise * grain;
                bytes.push((level + 0.5).clamp(0.0, 255.0) as u8);
            }
        }
        RgbImage::from_raw(width as u32, height as u32, bytes).unwrap_or_default()
    }
}

/// Roughly normal, deviation 1, from the sum of three bytes.
fn bell(bits: u32) -> f32 {
    let sum = (bits & 255) + ((bits >> 8) & 255) + ((bits >> 16) & 255);
    (sum as f32 - 382.5) * (1.0 / 128.0)
}

/// Brightens a dark picture, like automatic exposure.
fn expose(light: &mut [Light]) {
    let sum: f64 = light.iter().map(|c| f64::from(c[0] + c[1] + c[2])).sum();
    let mean = sum / (3 * light.len()) as f64;
    if mean < 0.15 {
        let gain = libm::pow(0.15 / mean.max(0.002), 0.4) as f32;
        for pixel in light {
            *pixel = pixel.map(|c| c * gain);
        }
    }
}

/// Repeated three-tap blur with the variance of a Gaussian of deviation `sigma`.
fn blur(light: &mut [Light], width: usize, height: usize, sigma: f32) {
    let variance = sigma * sigma;
    if variance < 0.01 {
        return;
    }
    let passes = (variance / 0.5) as usize + 1;
    let k = variance / passes as f32 * 0.5;
    for _ in 0..passes {
        for row in light.chunks_mut(width) {
            let mut before = row[0];
            for x in 0..width {
                let (here, after) = (row[x], row[(x + 1).min(width - 1)]);
                for c in 0..3 {
                    row[x][c] = here[c] + k * (before[c] + after[c] - 2.0 * here[c]);
                }
                before = here;
            }
        }
        let mut above = light[..width].to_vec();
        for y in 0..height {
            let below = (y + 1).min(height - 1) * width;
            for x in 0..width {
                let (here, after) = (light[y * width + x], light[below + x]);
                for c in 0..3 {
                    light[y * width + x][c] = here[c] + k * (above[x][c] + after[c] - 2.0 * here[c]);
                }
                above[x] = here;
            }
        }
    }
}
