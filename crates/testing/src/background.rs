//! The background of scenes: noise and small grains without labels.

use super::fills::{Light, blend};
use super::noise::{fractal, hash, smoothstep, split, unit};

/// Parameters of the background.
#[derive(Clone, Debug)]
pub(super) struct BackgroundParams {
    pub(super) base: Light,
    pub(super) second: Light,
    /// Strength (0..1) of large blotches of the second colour, then their wavelength in pixels.
    pub(super) broad: f32,
    pub(super) broad_wavelength: f32,
    /// Strength of the fine brightness variation, then its wavelength in pixels.
    pub(super) fine: f32,
    pub(super) fine_wavelength: f32,
    /// Strength of the brightness noise of single pixels.
    pub(super) dust: f32,
    /// Anisotropy of the fine variation along x, 1 for none; for brushed or fibrous surfaces.
    pub(super) stretch: f32,
    /// Layers of small grains, the topmost first.
    pub(super) grains: Vec<Grains>,
    pub(super) seed: u32,
}

/// A layer of small round or oval grains, at most one in each cell of a jittered grid.
#[derive(Clone, Debug)]
pub(super) struct Grains {
    /// Side of a cell in pixels. Grains measure 0.35 to 0.9 of it.
    pub(super) cell: f32,
    /// Share of cells that contain a grain.
    pub(super) share: f32,
    pub(super) colours: Vec<Light>,
    /// Opacity of the grains, 0..1.
    pub(super) strength: f32,
    /// Strength of the shading; positive for raised grains, negative for pits.
    pub(super) relief: f32,
}

impl BackgroundParams {
    /// The colour at a pixel. `light` is the unit vector to the light.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32, light: [f32; 3]) -> Light {
        let (bx, by) = (x / self.broad_wavelength, y / self.broad_wavelength);
        let broad = fractal(bx, by, 3, self.seed);
        let mut colour = blend(self.base, self.second, (self.broad * (0.5 + broad)).clamp(0.0, 1.0));
        let (fx, fy) = (x / (self.fine_wavelength * self.stretch), y / self.fine_wavelength);
        // Rotated, so that the noise lattice is not aligned with the pixels.
        let fine = fractal(0.8 * fx + 0.6 * fy, 0.8 * fy - 0.6 * fx, 2, self.seed ^ 0xf17e);
        let dust = unit(hash(x as i32, y as i32, self.seed ^ 0xd057)) - 0.5;
        let gain = (1.0 + self.fine * fine + self.dust * dust).max(0.05);
        colour = colour.map(|c| c * gain);
        for (i, layer) in self.grains.iter().enumerate().rev() {
            colour = layer.over(colour, x, y, self.seed.wrapping_add(0x1357 * (i as u32 + 1)), light);
        }
        colour
    }
}

impl Grains {
    #[inline]
    fn over(&self, below: Light, x: f32, y: f32, seed: u32, light: [f32; 3]) -> Light {
        // Every layer is rotated, so that no row of its grid is aligned with the pixels.
        let (c, s) = [(0.8, 0.6), (0.28, 0.96), (0.923_076_9, 0.384_615_4)][seed as usize % 3];
        let (x, y) = (c * x + s * y, c * y - s * x);
        let shift = split(split(y / self.cell).0 as f32 * 0.618).1;
        let (cx, fx) = split(x / self.cell + shift);
        let (cy, fy) = split(y / self.cell);
        let h = hash(cx, cy, seed);
        if unit(h) >= self.share || self.colours.is_empty() {
            return below;
        }
        let g = hash(cy, cx, seed ^ 0x6a09);
        let size = 0.15 + 0.3 * unit(g << 8) * unit(g << 16);
        let oval = 0.65 + 0.35 * unit(h << 10);
        let room = 0.5 - size;
        let dx = fx - 0.5 - room * (2.0 * unit(h << 5) - 1.0);
        let dy = fy - 0.5 - room * (2.0 * unit(g << 3) - 1.0);
        let (c, s) = if g & 2 == 0 { (0.8, 0.6) } else { (0.28, -0.96) };
        let (ax, ay) = (dx * c + dy * s, (dy * c - dx * s) / oval);
        // Every second grain is angular.
        let rho = if g & 4 == 0 {
            (ax * ax + ay * ay).sqrt()
        } else {
            ax.abs().max(ay.abs()).max(0.78 * (ax + 1.3 * ay).abs())
        };
        let cover = ((size - rho) * self.cell + 0.5).clamp(0.0, 1.0);
        if cover <= 0.0 {
            return below;
        }
        let colour = self.colours[(g >> 24) as usize % self.colours.len()];
        let tone = 0.75 + 0.4 * unit(h << 14);
        let shade = 1.0 + self.relief * (dx * light[0] + dy * light[1]) / size;
        let rim = 1.0 - 0.3 * self.relief.abs() * smoothstep(0.6 * size, size, rho);
        let lit = (tone * shade * rim).max(0.1);
        blend(below, colour.map(|v| v * lit), cover * self.strength)
    }
}
