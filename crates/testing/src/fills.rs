//! Fills: the appearance of an element inside its outline.

use super::noise::{fractal, hash, mix, noise, smoothstep, unit};
use super::shapes::Hit;
use vtex_base::sampling::Stream;

/// Linear-light colour, 0..1. Conversion to sRGB is approximated by the square root (gamma 2).
pub(super) type Light = [f32; 3];

/// A colour from `0xrrggbb`.
pub(super) fn hex(rgb: u32) -> Light {
    [rgb >> 16, rgb >> 8, rgb].map(|c| {
        let v = (c & 255) as f32 / 255.0;
        v * v
    })
}

/// Component-wise [`mix`].
pub(super) fn blend(a: Light, b: Light, t: f32) -> Light {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

/// Parameters of the fills of one kind of element. Amounts are 0 (none) to about 1.
#[derive(Clone, Debug)]
pub(super) struct Style {
    /// Amount of blotches of a second colour, then their wavelength in radii, then their hardness, 1 (soft)
    /// to 6 (hard).
    pub(super) mottle: f32,
    pub(super) wavelength: f32,
    pub(super) hardness: f32,
    /// The second colour, as a factor of the first.
    pub(super) second: Light,
    /// Amount of long streaks in one direction.
    pub(super) streak: f32,
    /// Amount of pale veins.
    pub(super) veins: f32,
    /// Amount of dark and pale crystals one or two pixels wide.
    pub(super) speckle: f32,
    /// Brightening (darkening if negative) of a rim, `rim_width` radii wide.
    pub(super) rim: f32,
    pub(super) rim_width: f32,
    /// Amount of a domed surface's shading, over `dome_width` radii from the border.
    pub(super) dome: f32,
    pub(super) dome_width: f32,
    /// Number and strength of plane facets on top.
    pub(super) facets: u32,
    pub(super) facet_strength: f32,
    /// Midrib and side ribs of a leaf, or grooves between petals.
    pub(super) ribs: f32,
    /// Brightness change from one end of the element to the other.
    pub(super) slope: f32,
    /// Colour of a flower's centre, and its share of the radius.
    pub(super) heart: Option<(Light, f32)>,
    /// Variation of brightness and tint between elements.
    pub(super) spread: f32,
    pub(super) tint: f32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            mottle: 0.25,
            wavelength: 0.8,
            hardness: 1.0,
            second: [0.6; 3],
            streak: 0.0,
            veins: 0.0,
            speckle: 0.0,
            rim: 0.0,
            rim_width: 0.2,
            dome: 0.0,
            dome_width: 1.0,
            facets: 0,
            facet_strength: 0.0,
            ribs: 0.0,
            slope: 0.1,
            heart: None,
            spread: 0.12,
            tint: 0.04,
        }
    }
}

/// The fill of one element.
#[derive(Clone, Debug)]
pub(super) struct ElementFill {
    style: Style,
    base: Light,
    second: Light,
    radius: f32,
    direction: [f32; 2],
    gradient: [f32; 2],
    facets: Vec<[f32; 3]>,
    seed: u32,
}

impl ElementFill {
    /// A random fill around `colour` for an element of the given radius in pixels.
    pub(super) fn new(style: &Style, colour: Light, radius: f32, random: &mut Stream) -> Self {
        let bright = (1.0 + style.spread * random.normal() as f32).clamp(0.3, 1.8);
        let base = colour.map(|c| c * bright * (1.0 + style.tint * random.normal() as f32).max(0.2));
        let second = [0, 1, 2].map(|i| base[i] * style.second[i]);
        let angle = random.range(0.0, std::f64::consts::TAU);
        let direction = [libm::cos(angle) as f32, libm::sin(angle) as f32];
        let slope = style.slope * random.normal() as f32 / radius.max(1.0);
        let facets = (0..style.facets)
            .map(|k| {
                let turn = f64::from(k) / f64::from(style.facets) + random.range(-0.1, 0.1);
                let angle = angle + turn * std::f64::consts::TAU;
                let steep = if k == 0 { random.range(0.0, 0.3) } else { random.range(0.35, 1.0) };
                let height = if k == 0 { 0.0 } else { random.range(-0.05, 0.45) * steep };
                [(steep * libm::cos(angle)) as f32, (steep * libm::sin(angle)) as f32, height as f32 * radius]
            })
            .collect();
        Self {
            style: style.clone(),
            base,
            second,
            radius: radius.max(1.0),
            direction,
            gradient: [direction[1] * slope, direction[0] * slope],
            facets,
            seed: random.bits() as u32,
        }
    }

    /// Darkens the element, which lies deep below others.
    pub(super) fn darken(&mut self, share: f32) {
        self.base = self.base.map(|c| c * share);
        self.second = self.second.map(|c| c * share);
    }

    /// The colour at a point of the element. `light` is the unit vector to the light in the element's
    /// frame.
    #[inline]
    pub(super) fn at(&self, p: [f32; 2], hit: &Hit, light: [f32; 3]) -> Light {
        let s = &self.style;
        let mut colour = self.base;
        if s.mottle > 0.0 {
            let scale = 1.0 / (s.wavelength * self.radius).max(2.0);
            let v = fractal(p[0] * scale, p[1] * scale, 3, self.seed);
            let t = (0.5 + v * s.hardness).clamp(0.0, 1.0);
            colour = blend(colour, self.second, t * s.mottle);
        }
        let mut gain = 1.0 + self.gradient[0] * p[0] + self.gradient[1] * p[1];
        if s.streak > 0.0 {
            let [c, d] = self.direction;
            let along = (p[0] * c + p[1] * d) * (0.35 / self.radius);
            let across = (p[1] * c - p[0] * d) * (3.0 / self.radius).min(0.45);
            gain *= 1.0 + s.streak * fractal(along, across, 2, self.seed ^ 0x51ed);
        }
        if s.veins > 0.0 {
            let scale = 0.7 / self.radius;
            let v = noise(p[0] * scale, p[1] * scale, self.seed ^ 0x7e19).abs();
            let width = 1.1 * scale;
            gain *= 1.0 + s.veins * (1.0 - smoothstep(0.3 * width, 1.4 * width, v));
        }
        if s.speckle > 0.0 {
            let v = noise(p[0] * 0.42, p[1] * 0.42, self.seed ^ 0x2b1d);
            gain *= 1.0 + s.speckle * (smoothstep(0.3, 0.55, v) - smoothstep(0.3, 0.55, -v));
        }
        if s.rim != 0.0 {
            gain *= 1.0 + s.rim * (1.0 - smoothstep(0.0, (s.rim_width * self.radius).max(1.2), hit.depth));
        }
        if s.ribs > 0.0 {
            gain *= 1.0 + s.ribs * self.ribs(hit);
        }
        if s.dome > 0.0 {
            let t = 1.0 - (hit.depth / (s.dome_width * self.radius).max(1.0)).clamp(0.0, 1.0);
            let slope = s.dome * t * t.sqrt();
            let up = (1.0 - slope * slope).max(0.04).sqrt();
            let lit = slope * (hit.normal[0] * light[0] + hit.normal[1] * light[1]) + up * light[2];
            gain *= 0.25 + 0.75 * lit.max(0.0) / light[2];
        }
        if !self.facets.is_empty() {
            let mut lowest = f32::INFINITY;
            let mut lit = 0.0;
            for f in &self.facets {
                let height = f[2] - f[0] * p[0] - f[1] * p[1];
                let tilt = (f[0] * light[0] + f[1] * light[1]) / light[2];
                // Edges between facets are blurred over about a pixel.
                let t = (0.5 + (lowest - height) * 0.6).clamp(0.0, 1.0);
                lit = mix(lit, tilt, t);
                lowest = lowest.min(height);
            }
            gain *= (1.0 + s.facet_strength * lit).clamp(0.3, 2.0);
        }
        if let Some((heart, size)) = s.heart {
            let bump = 0.12 * (unit(hash((p[0] * 1.3) as i32, (p[1] * 1.3) as i32, self.seed)) - 0.5);
            let rho = (p[0] * p[0] + p[1] * p[1]).sqrt() / self.radius;
            let t = 1.0 - smoothstep(0.85 * size, 1.1 * size, rho + bump);
            colour = blend(colour, heart, t);
            gain *= 1.0 + t * (0.25 * (0.6 - rho / size) + 2.0 * bump);
        }
        colour.map(|c| c * gain.max(0.05))
    }

    /// Brightness change by midrib, side ribs and the hollow between petals.
    #[inline]
    fn ribs(&self, hit: &Hit) -> f32 {
        let [along, across] = hit.place;
        // Widths are in pixels; otherwise ribs would fill small leaves.
        let midrib = 1.0 - smoothstep(0.35, 1.2, hit.off_axis);
        let phase = along * 5.0 - hit.off_axis * (4.0 / self.radius);
        let saw = (phase - phase as i32 as f32).abs();
        let side = (1.0 - smoothstep(0.0, 0.2, saw.min(1.0 - saw))) * (1.0 - 0.6 * across.abs());
        let hollow = across * across * across * across;
        midrib + 0.5 * side * smoothstep(8.0, 18.0, self.radius) - 0.4 * hollow
    }
}
