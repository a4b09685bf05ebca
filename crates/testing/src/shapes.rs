//! Outlines as implicit functions: signed depth and normal at a point.

use super::noise::{fractal, mix, split};
use std::f32::consts::{PI, TAU};
use std::sync::OnceLock;
use vtex_base::sampling::Stream;

/// Number of directions in which a radial outline is tabulated.
const STEPS: usize = 192;
/// Intervals of a leaf's width profile.
const PROFILE: usize = 40;

/// An outline in its own frame: pixels, centre at the origin, long axis along x.
#[derive(Clone, Debug)]
pub(super) struct LocalOutline {
    outline: OutlineForm,
    /// Half extents of a box around it.
    pub(super) extent: [f32; 2],
    /// Amplitude in pixels of the noise that displaces the outline, and its wavelength.
    roughness: f32,
    wavelength: f32,
    seed: u32,
}

#[derive(Clone, Debug)]
enum OutlineForm {
    /// Intersection of half planes `x n₀ + y n₁ <= n₂`, corners rounded.
    Convex { sides: Vec<[f32; 3]>, rounding: f32 },
    /// Tabulated in equal steps of the diamond angle: the radius, and the angular distance from the axis of
    /// the nearest petal or lobe, 0 on the axis, 1 at its edge. `spread` is the angle from axis to edge.
    Radial { radii: Vec<[f32; 2]>, spread: f32 },
    /// Two edges about a bent midrib.
    Leaf { half_length: f32, widths: [f32; PROFILE + 1], bend: f32 },
}

/// The relation of a point to an outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Distance to the border in pixels, positive inside; first-order exact near the border.
    pub(super) depth: f32,
    /// Unit vector towards the outside.
    pub(super) normal: [f32; 2],
    /// Leaves: position along and across, -1..1. Radial outlines: shares of the radius and of the angle
    /// from the petal's axis to its edge. Others: 0.
    pub(super) place: [f32; 2],
    /// Distance in pixels from the midrib or the petal's axis.
    pub(super) off_axis: f32,
}

impl LocalOutline {
    /// A convex polygon from its corners, counter-clockwise; `None` if it has no area.
    pub(super) fn polygon(corners: &[[f32; 2]], rounding: f32) -> Option<Self> {
        let mut sides = Vec::with_capacity(corners.len());
        let mut extent = [0.0f32; 2];
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = (dx * dx + dy * dy).sqrt();
            extent = [extent[0].max(a[0].abs()), extent[1].max(a[1].abs())];
            if length > 1e-3 {
                let n = [dy / length, -dx / length];
                sides.push([n[0], n[1], n[0] * a[0] + n[1] * a[1]]);
            }
        }
        (sides.len() >= 3 && polygon_area(corners) > 1.0).then(|| Self {
            outline: OutlineForm::Convex { sides, rounding: rounding.max(0.01) },
            extent,
            roughness: 0.0,
            wavelength: 1.0,
            seed: 0,
        })
    }

    /// A broken chip with the area of a circle of radius `radius`: 4 to 8 straight sides.
    pub(super) fn chip(
        radius: f32,
        corners: [u32; 2],
        stretch: f32,
        rounding: f32,
        random: &mut Stream,
    ) -> Self {
        let n = corners[0] + random.below(u64::from(corners[1] - corners[0] + 1)) as u32;
        let mut polygon = vec![[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]];
        let turn = random.range(0.0, f64::from(TAU)) as f32;
        for k in 0..n {
            let angle = turn + (k as f32 + random.range(-0.38, 0.38) as f32) * TAU / n as f32;
            let offset = random.range(0.62, 1.0) as f32;
            clip(&mut polygon, [libm::cosf(angle), libm::sinf(angle), offset]);
        }
        for p in &mut polygon {
            *p = [p[0] * stretch, p[1] / stretch];
        }
        let scale = radius * (PI / polygon_area(&polygon).max(0.1)).sqrt();
        let centre = centroid(&polygon);
        for p in &mut polygon {
            *p = [(p[0] - centre[0]) * scale, (p[1] - centre[1]) * scale];
        }
        Self::polygon(&polygon, rounding * radius).unwrap_or_else(|| Self::pebble(radius, 0.1, 1.0, random))
    }

    /// A rounded stone: an ellipse with a few random waves.
    pub(super) fn pebble(radius: f32, wobble: f32, stretch: f32, random: &mut Stream) -> Self {
        let waves: Vec<[f32; 2]> = (0..5)
            .map(|k| {
                let size = f64::from(wobble) / f64::from(k + 1) * random.range(0.3, 1.0);
                let phase = random.range(0.0, f64::from(TAU));
                [(size * libm::cos(phase)) as f32, (size * libm::sin(phase)) as f32]
            })
            .collect();
        Self::radial(radius, 0.0, |_, c, s| {
            let ellipse = 1.0 / ((c / stretch) * (c / stretch) + (s * stretch) * (s * stretch)).sqrt();
            let (mut re, mut im) = (c * c - s * s, 2.0 * c * s);
            let mut sum = 1.0;
            for w in &waves {
                sum += w[0] * re + w[1] * im;
                (re, im) = (re * c - im * s, re * s + im * c);
            }
            [ellipse * sum.max(0.25), 0.0]
        })
    }

    /// A leaf of about five pointed lobes around its stalk.
    pub(super) fn lobed(radius: f32, lobes: u32, depth: f32, serration: f32, random: &mut Stream) -> Self {
        let spread = random.range(0.78, 0.95) as f32 * PI;
        let tips: Vec<[f32; 3]> = (0..lobes)
            .map(|k| {
                let at = (k as f32 / (lobes - 1).max(1) as f32 * 2.0 - 1.0) * spread;
                let length = 1.0 - 0.45 * (at / PI).abs() + random.range(-0.08, 0.08) as f32;
                [at + random.range(-0.08, 0.08) as f32, length, spread / lobes as f32 * 1.5]
            })
            .collect();
        let teeth = random.range(24.0, 44.0) as f32;
        let half = spread / lobes as f32;
        Self::radial(radius, half, |angle, _, _| {
            let turn = if angle > PI { angle - TAU } else { angle };
            let (mut r, mut across) = (1.0 - depth, 9.0f32);
            for [at, length, width] in &tips {
                let t = ((turn - at) / width).abs();
                across = across.min((turn - at).abs() / half);
                r = r.max(length * (1.0 - depth * t * (1.35 - 0.3 * t)));
            }
            let tooth = (split(angle * teeth / TAU).1 - 0.5).abs();
            // The notch at the stalk.
            let notch = 1.0 - 0.7 * super::noise::smoothstep(PI - 0.35, PI, turn.abs());
            [r * notch * (1.0 + serration * (tooth - 0.25)), across]
        })
    }

    /// A flower of `petals` joined petals. `pointed` is 0 (round) to 1 (pointed); `gap` is the depth of
    /// the cuts between petals, 0 to 1.
    pub(super) fn star(radius: f32, petals: u32, pointed: f32, gap: f32, random: &mut Stream) -> Self {
        let lengths: Vec<f32> = (0..petals).map(|_| random.range(0.8, 1.05) as f32).collect();
        let shift = random.unit() as f32;
        Self::radial(radius, PI / petals as f32, |angle, _, _| {
            let (k, f) = split(angle / TAU * petals as f32 + shift);
            let x = (2.0 * f - 1.0).abs();
            let round = (1.0 - x * x * x).max(0.0).sqrt();
            let profile = mix(round, 1.0 - x, pointed);
            [lengths[k.rem_euclid(petals as i32) as usize] * (1.0 - gap + gap * profile), x]
        })
    }

    /// A leaf or a blade: `ratio` is length over width, `fullness` the position of the widest place (0.5
    /// the middle, more: towards the tip), `bend` the sideways bend as a share of the half length.
    pub(super) fn leaf(
        radius: f32,
        ratio: f32,
        fullness: f32,
        bend: f32,
        serration: f32,
        teeth: u32,
    ) -> Self {
        // Moves the widest place; the map stays monotonic up to 0.95.
        let shift = ((0.5 - fullness) / (fullness * (1.0 - fullness)).max(0.1)).clamp(-0.95, 0.95);
        let mut widths: [f32; PROFILE + 1] = std::array::from_fn(|i| {
            let t = i as f32 / PROFILE as f32;
            let tooth = (split(t * teeth as f32).1 - 0.5) * serration;
            let s = t + shift * t * (1.0 - t);
            let lens = (4.0 * s * (1.0 - s)).max(0.0).sqrt();
            lens * lens.sqrt() * (1.0 + tooth)
        });
        let widest = widths.iter().copied().fold(1e-6, f32::max);
        // Area of the unit leaf: half length 1, half width 1 / ratio.
        let area = 4.0 / (ratio * widest) * widths.iter().sum::<f32>() / PROFILE as f32;
        let half_length = radius * (PI / area).sqrt();
        let half_width = half_length / ratio;
        for w in &mut widths {
            *w *= half_width / widest;
        }
        let bend = bend * half_length;
        Self {
            outline: OutlineForm::Leaf { half_length, widths, bend },
            extent: [half_length, half_width + 0.5 * bend.abs()],
            roughness: 0.0,
            wavelength: 1.0,
            seed: 0,
        }
    }

    /// A radial outline from `f(angle, cosine, sine)`, which gives the radius and the share of the angle off
    /// the axis.
    fn radial(radius: f32, spread: f32, f: impl Fn(f32, f32, f32) -> [f32; 2]) -> Self {
        let directions = directions();
        let mut radii: Vec<[f32; 2]> = directions.iter().map(|[angle, c, s]| f(*angle, *c, *s)).collect();
        let mut area = 0.0;
        for i in 0..STEPS {
            let (a, b) = (directions[i], directions[i + 1]);
            area += 0.5 * radii[i][0] * radii[i + 1][0] * (a[1] * b[2] - a[2] * b[1]);
        }
        let scale = radius * (PI / area.max(1e-3)).sqrt();
        let mut extent = [0.0f32; 2];
        for ([r, _], [_, c, s]) in radii.iter_mut().zip(directions) {
            *r *= scale;
            extent = [extent[0].max((*r * c).abs()), extent[1].max((*r * s).abs())];
        }
        Self {
            outline: OutlineForm::Radial { radii, spread },
            extent,
            roughness: 0.0,
            wavelength: 1.0,
            seed: 0,
        }
    }

    /// The outline displaced by noise of `amount` pixels with the given wavelength.
    pub(super) fn roughened(mut self, amount: f32, wavelength: f32, seed: u32) -> Self {
        self.extent = self.extent.map(|e| e + amount);
        (self.roughness, self.wavelength, self.seed) = (amount, wavelength.max(1.0), seed);
        self
    }

    /// Evaluates the outline at a point.
    #[inline]
    pub(super) fn at(&self, p: [f32; 2]) -> Hit {
        let mut hit = self.smooth(p);
        if self.roughness > 0.0 && hit.depth.abs() < 2.0 * self.roughness + 1.0 {
            let (x, y) = (p[0] / self.wavelength, p[1] / self.wavelength);
            hit.depth += self.roughness * fractal(x, y, 2, self.seed).clamp(-1.0, 1.0);
        }
        hit
    }

    /// Evaluates the outline at a point, without roughness.
    #[inline]
    pub(super) fn smooth(&self, p: [f32; 2]) -> Hit {
        match &self.outline {
            OutlineForm::Convex { sides, rounding } => convex(sides, *rounding, p),
            OutlineForm::Radial { radii, spread } => radial(radii, *spread, p),
            OutlineForm::Leaf { half_length, widths, bend } => leaf(*half_length, widths, *bend, p),
        }
    }
}

#[inline]
fn convex(sides: &[[f32; 3]], rounding: f32, p: [f32; 2]) -> Hit {
    let (mut first, mut second) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
    let (mut at, mut next) = (0, 0);
    for (i, s) in sides.iter().enumerate() {
        let d = s[0] * p[0] + s[1] * p[1] - s[2];
        if d > first {
            (second, next) = (first, at);
            (first, at) = (d, i);
        } else if d > second {
            (second, next) = (d, i);
        }
    }
    // Smooth maximum of the two nearest sides (quadratic blend).
    let h = (rounding - (first - second)).max(0.0) / rounding;
    let w = 0.5 * h;
    let (a, b) = (sides[at], sides[next]);
    let n = [mix(a[0], b[0], w), mix(a[1], b[1], w)];
    let length = (n[0] * n[0] + n[1] * n[1]).sqrt().max(1e-3);
    Hit {
        depth: -(first + h * h * rounding * 0.25),
        normal: [n[0] / length, n[1] / length],
        place: [0.0; 2],
        off_axis: 0.0,
    }
}

#[inline]
fn radial(radii: &[[f32; 2]], spread: f32, p: [f32; 2]) -> Hit {
    let [x, y] = p;
    let sum = x.abs() + y.abs();
    let t = if sum > 1e-6 { y / sum } else { 0.0 };
    let diamond = if x < 0.0 {
        2.0 - t
    } else if y < 0.0 {
        4.0 + t
    } else {
        t
    };
    let (i, f) = split(diamond * (STEPS as f32 / 4.0));
    let i = (i as usize).min(STEPS - 1);
    let ([a, from], [b, to]) = (radii[i], radii[i + 1]);
    let across = mix(from, to, f);
    let radius = mix(a, b, f);
    let rho = (x * x + y * y).sqrt();
    let within = split(diamond).1;
    let per_angle = (b - a) * (STEPS as f32 / 4.0) * ((1.0 - within) * (1.0 - within) + within * within);
    let slope = (per_angle / rho.max(0.3 * radius)).clamp(-6.0, 6.0);
    let norm = 1.0 / (1.0 + slope * slope).sqrt();
    let e = if rho > 1e-3 { [x / rho, y / rho] } else { [1.0, 0.0] };
    Hit {
        depth: (radius - rho) * norm,
        normal: [(e[0] + slope * e[1]) * norm, (e[1] - slope * e[0]) * norm],
        place: [rho / radius.max(0.1), across],
        off_axis: across * spread * rho,
    }
}

#[inline]
fn leaf(half_length: f32, widths: &[f32; PROFILE + 1], bend: f32, p: [f32; 2]) -> Hit {
    let u = p[0] / half_length;
    let y = p[1] - bend * (0.5 - u * u);
    let t = (u + 1.0) * 0.5;
    let side = if y < 0.0 { -1.0 } else { 1.0 };
    if !(0.0..=1.0).contains(&t) {
        let beyond = p[0].abs() - half_length;
        return Hit {
            depth: -(beyond * beyond + y * y).sqrt(),
            normal: [0.0, side],
            place: [u, 0.0],
            off_axis: y.abs(),
        };
    }
    let (i, f) = split(t * PROFILE as f32);
    let i = (i as usize).min(PROFILE - 1);
    let (a, b) = (widths[i], widths[i + 1]);
    let width = mix(a, b, f);
    let slope = (b - a) * PROFILE as f32 / (2.0 * half_length);
    let tilt = 2.0 * bend * u / half_length;
    let fall = slope.abs().max(tilt.abs());
    let norm = 1.0 / (1.0 + fall * fall).sqrt();
    Hit {
        depth: (width - y.abs()) * norm,
        normal: [-slope * norm, side * norm],
        place: [u, y / width.max(0.5)],
        off_axis: y.abs(),
    }
}

/// Angle, cosine and sine of every radial step; the last repeats the first.
fn directions() -> &'static [[f32; 3]; STEPS + 1] {
    static TABLE: OnceLock<[[f32; 3]; STEPS + 1]> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|i| {
            let d = (i % STEPS) as f32 * 4.0 / STEPS as f32;
            let (quadrant, t) = split(d);
            let (x, y) = match quadrant {
                0 => (1.0 - t, t),
                1 => (-t, 1.0 - t),
                2 => (t - 1.0, -t),
                _ => (t, t - 1.0),
            };
            let angle = libm::atan2f(y, x);
            let angle = if angle < 0.0 { angle + TAU } else { angle };
            let rho = (x * x + y * y).sqrt();
            [angle, x / rho, y / rho]
        })
    })
}

/// Cuts a convex polygon down to `x n₀ + y n₁ <= n₂`.
pub(super) fn clip(polygon: &mut Vec<[f32; 2]>, plane: [f32; 3]) {
    let over = |p: [f32; 2]| plane[0] * p[0] + plane[1] * p[1] - plane[2];
    if polygon.iter().all(|&p| over(p) <= 0.0) {
        return;
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = (over(a), over(b));
        if da <= 0.0 {
            kept.push(a);
        }
        if (da <= 0.0) != (db <= 0.0) {
            let t = da / (da - db);
            kept.push([mix(a[0], b[0], t), mix(a[1], b[1], t)]);
        }
    }
    *polygon = kept;
}

/// Area of a counter-clockwise polygon.
pub(super) fn polygon_area(corners: &[[f32; 2]]) -> f32 {
    let mut area = 0.0;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    area
}

/// Mean of the corners.
pub(super) fn centroid(corners: &[[f32; 2]]) -> [f32; 2] {
    let n = corners.len().max(1) as f32;
    let sum = corners.iter().fold([0.0, 0.0], |s, p| [s[0] + p[0], s[1] + p[1]]);
    [sum[0] / n, sum[1] / n]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    fn area(shape: &LocalOutline) -> f32 {
        let [w, h] = shape.extent.map(|e| e as i32 + 2);
        let mut sum = 0.0;
        for y in -h..=h {
            for x in -w..=w {
                sum += (shape.at([x as f32, y as f32]).depth + 0.5).clamp(0.0, 1.0);
            }
        }
        sum
    }

    #[test]
    fn every_form_has_the_area_asked_for() {
        let random = &mut stream(3, "test/shapes", 0);
        for _ in 0..20 {
            let r = random.range(8.0, 40.0) as f32;
            for (name, shape) in [
                ("chip", LocalOutline::chip(r, [4, 8], 1.3, 0.02, random)),
                ("pebble", LocalOutline::pebble(r, 0.15, 1.2, random)),
                ("lobed", LocalOutline::lobed(r, 5, 0.6, 0.1, random)),
                ("star", LocalOutline::star(r, 8, 0.4, 0.6, random)),
                ("leaf", LocalOutline::leaf(r, 2.0, 0.5, 0.1, 0.1, 12)),
            ] {
                let ratio = area(&shape) / (PI * r * r);
                assert!((0.85..1.12).contains(&ratio), "{name} {r}: {ratio}");
            }
        }
    }

    #[test]
    fn nothing_lies_outside_the_extent() {
        let random = &mut stream(4, "test/shapes", 0);
        for shape in [
            LocalOutline::chip(20.0, [4, 8], 1.3, 0.1, random),
            LocalOutline::pebble(20.0, 0.3, 1.4, random).roughened(2.0, 5.0, 1),
            LocalOutline::lobed(20.0, 5, 0.6, 0.1, random),
            LocalOutline::star(20.0, 8, 0.4, 0.6, random),
            LocalOutline::leaf(20.0, 6.0, 0.5, 0.3, 0.1, 12),
        ] {
            for y in -90..90 {
                for x in -90..90 {
                    let p = [x as f32, y as f32];
                    if p[0].abs() > shape.extent[0] + 0.5 || p[1].abs() > shape.extent[1] + 0.5 {
                        assert!(shape.at(p).depth < 0.0, "{p:?} {shape:?}");
                    }
                }
            }
        }
    }
}
