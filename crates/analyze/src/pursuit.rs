//! Matching pursuit: soft ellipses that paint a part of a photograph.
//!
//! The place, size and colour of a soft ellipse that takes most from the squared error are found by convolutions on
//! a pyramid, its form by the moments of the error there. Where it is small and differs much from what is below it,
//! a sharp one in its place may do better. Ellipses that do not touch are taken in one round. Rounds end where no
//! ellipse is worth its bytes.

use rustc_hash::FxHashMap;
use std::collections::BTreeSet;
use std::sync::LazyLock;
use vtex_base::error::Result;
use vtex_base::geometry::Point;
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Ellipse, Profile};

/// Sizes of sharp ellipses relative to the soft ones that they replace.
const SPECK_SIZES: [f64; 3] = [0.6, 0.8, 1.0];
/// Shortest and longest semi-axis of a sharp ellipse, in pixels.
const SPECK_AXES: [f64; 2] = [1.0, 6.0];
/// Least difference of a component of a sharp ellipse from what it is painted on, in steps of 8 bits. What differs
/// less has no edge that is seen.
const EDGE: f64 = 20.0;
/// Weight of the gain of sharp ellipses. What is blurred beside crisp outlines looks out of focus.
const FOCUS: f64 = 1.05;
/// Smallest semi-axis of a soft ellipse, in pixels.
const LEAST_RADIUS: f64 = 1.4;
/// Largest ratio of a semi-axis to the radius at which an ellipse was found.
const STRETCH: f64 = 2.5;
/// Radius of the circle whose errors give an ellipse its form, relative to that at which it was found.
const WIDE: f64 = 1.5;
/// Rounds that are enough for any window.
pub(super) const ROUNDS: usize = 24;
/// Radii sought on each level of the pyramid, in pixels of the level.
const RADII: [f64; 2] = [2.0, 2.828_427];

/// A soft ellipse in its colour, in pixels of the photograph.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shade {
    pub(super) ellipse: Ellipse,
    pub(super) colour: Colour,
}

/// A part of a photograph that is painted.
#[derive(Clone)]
pub(super) struct PaintedWindow {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Place of its corner in the photograph.
    pub(super) corner: [f64; 2],
    /// Share of each pixel that is to be painted.
    pub(super) weight: Vec<f32>,
    /// The photograph's colour, the mean over that share.
    pub(super) target: Vec<[f32; 3]>,
    /// The colour painted so far.
    pub(super) painted: Vec<[f32; 3]>,
    /// The layer of each pixel, which hides what lies in lower ones; empty if there is one layer.
    pub(super) layers: Vec<u8>,
}

/// What ellipses are permitted.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    /// Largest difference of a component from what an ellipse is painted on, in steps of 8 bits.
    pub(super) contrast: f64,
    /// Largest error that an ellipse may add, relative to what it takes away.
    pub(super) harm: f64,
    /// Least share of an ellipse that is to be painted, by squared opacity.
    pub(super) seen: f64,
    /// Largest radius at which an ellipse is found, in pixels.
    pub(super) radius: f64,
    /// Least and largest area within the rim, in pixels.
    pub(super) areas: [f64; 2],
}

impl Rules {
    fn permit(&self, ellipse: &Ellipse, fit: &EllipseFit) -> bool {
        let [short, long] = ellipse.semi_axes();
        let area = std::f64::consts::PI * short * long;
        let [least, most] = self.areas;
        fit.contrast <= self.contrast && fit.seen >= self.seen && least <= area && area <= most
    }
}

/// What an ellipse in its best colour does.
struct EllipseFit {
    /// By how much it reduces the squared error.
    gain: f64,
    colour: [f64; 3],
    /// Largest difference of a component from what lies below it, in the mean.
    contrast: f64,
    /// Share of it that is to be painted, by squared opacity.
    seen: f64,
}

/// A place where an ellipse may stand.
#[derive(Clone)]
struct Candidate {
    gain: f64,
    centre: [f64; 2],
    radius: f64,
}

impl Candidate {
    fn key(&self) -> [u64; 3] {
        [self.centre[0], self.centre[1], self.radius].map(f64::to_bits)
    }
}

/// The circles of a round, by place.
struct TakenCircles {
    /// Side of a bucket, in pixels: no circle touches one that is two buckets away.
    side: f64,
    buckets: FxHashMap<[i32; 2], Vec<Candidate>>,
}

impl TakenCircles {
    /// Least distance of centres, relative to the sum of the radii.
    const APART: f64 = 0.7;

    /// None yet of these candidates.
    fn new(candidates: &[Candidate]) -> Self {
        let largest = candidates.iter().map(|c| c.radius).fold(1.0, f64::max);
        Self { side: 2.0 * Self::APART * largest, buckets: FxHashMap::default() }
    }

    fn bucket(&self, circle: &Candidate) -> [i32; 2] {
        circle.centre.map(|v| libm::floor(v / self.side) as i32)
    }

    fn add(&mut self, circle: Candidate) {
        self.buckets.entry(self.bucket(&circle)).or_default().push(circle);
    }

    fn touch(&self, circle: &Candidate) -> bool {
        let [u, v] = self.bucket(circle);
        let near = (v - 1..=v + 1).flat_map(|v| (u - 1..=u + 1).map(move |u| [u, v]));
        near.filter_map(|bucket| self.buckets.get(&bucket)).flatten().any(|other| {
            let [dx, dy] = [0, 1].map(|k| other.centre[k] - circle.centre[k]);
            let apart = Self::APART * (other.radius + circle.radius);
            dx * dx + dy * dy < apart * apart
        })
    }
}

/// The opacity of a profile by the square of the distance from the centre, in radii.
struct FallOff {
    opacities: [f32; FallOff::STEPS],
    /// Mean of the squared opacity over the disc.
    mean_square: f64,
}

impl FallOff {
    const STEPS: usize = 512;

    fn of(profile: Profile) -> &'static Self {
        static SOFT: LazyLock<FallOff> = LazyLock::new(|| FallOff::new(Profile::Soft));
        static SHARP: LazyLock<FallOff> = LazyLock::new(|| FallOff::new(Profile::Sharp));
        match profile {
            Profile::Soft => &SOFT,
            Profile::Sharp => &SHARP,
        }
    }

    fn new(profile: Profile) -> Self {
        let middle = |i: usize| profile.opacity_at((i as f64 + 0.5) / Self::STEPS as f64);
        let opacities: [f32; Self::STEPS] = std::array::from_fn(|i| middle(i) as f32);
        // Rings of equal steps of the square have equal areas.
        let mean_square = (0..Self::STEPS).map(|i| middle(i) * middle(i)).sum::<f64>() / Self::STEPS as f64;
        Self { opacities, mean_square }
    }

    fn at(&self, square: f64) -> f32 {
        self.opacities.get((square * Self::STEPS as f64) as usize).copied().unwrap_or(0.0)
    }
}

/// Whether a sharp ellipse is so small that nobody misses its true outline, and so large that pixels show it.
fn is_speck(ellipse: &Ellipse) -> bool {
    let [short, long] = ellipse.semi_axes();
    short >= SPECK_AXES[0] && long <= SPECK_AXES[1]
}

impl PaintedWindow {
    /// Squared error over all pixels and components.
    pub(super) fn error(&self) -> f64 {
        let all = self.weight.iter().zip(&self.target).zip(&self.painted);
        all.map(|((w, t), p)| f64::from(w * (0..3).map(|c| (t[c] - p[c]) * (t[c] - p[c])).sum::<f32>())).sum()
    }

    /// Paints ellipses that each reduce the error by `least` or more, in `rounds` at most.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    pub(super) fn paint(
        &mut self,
        least: f64,
        rounds: usize,
        rules: Rules,
        progress: &dyn Progress,
    ) -> Result<Vec<Shade>> {
        let pyramid = Level::pyramid(self);
        let mut shades = Vec::new();
        // Circles of which nothing came. Where others have been painted since, one is found at another place.
        let mut refused: BTreeSet<[u64; 3]> = BTreeSet::new();
        for round in 0..rounds {
            advance(progress, "spots", round as u64, rounds as u64)?;
            let mut candidates = self.candidates(&pyramid, least);
            candidates.retain(|c| c.radius <= rules.radius && !refused.contains(&c.key()));
            candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            let mut taken = TakenCircles::new(&candidates);
            let before = shades.len();
            for candidate in candidates {
                if taken.touch(&candidate) {
                    continue;
                }
                match self.painted_near(&candidate, least, rules) {
                    Some(shade) => {
                        shades.push(shade);
                        taken.add(candidate);
                    }
                    None => {
                        refused.insert(candidate.key());
                    }
                }
            }
            // Few are left to gain from a further round.
            if shades.len() - before <= before / 50 {
                break;
            }
        }
        Ok(shades)
    }

    /// Paints those of the given ellipses, in their best colours, that are permitted and still reduce the error by
    /// `least` or more.
    pub(super) fn repaint(&mut self, shades: &[Shade], least: f64, rules: Rules) -> Vec<Shade> {
        let again = shades.iter().filter_map(|shade| {
            let centre = [0, 1].map(|k| shade.ellipse.centre[k] - self.corner[k]);
            let ellipse = Ellipse { centre, ..shade.ellipse };
            let fit = self.fit(&ellipse)?;
            (fit.gain >= least && rules.permit(&ellipse, &fit)).then(|| self.add(&ellipse, fit.colour))
        });
        again.collect()
    }

    /// Paints ellipses that were found before.
    pub(super) fn draw(&mut self, shades: &[Shade]) {
        for Shade { ellipse, colour } in shades {
            let centre = [0, 1].map(|k| ellipse.centre[k] - self.corner[k]);
            self.add(&Ellipse { centre, ..*ellipse }, colour.to_f64());
        }
    }

    /// Paints an ellipse.
    fn add(&mut self, ellipse: &Ellipse, colour: [f64; 3]) -> Shade {
        let colour = Colour::from_f64(colour);
        let own = colour.to_f64().map(|v| v as f32);
        for (i, opacity) in self.covered(ellipse).collect::<Vec<_>>() {
            let painted = &mut self.painted[i];
            (0..3).for_each(|c| painted[c] += opacity * (own[c] - painted[c]));
        }
        let centre = [0, 1].map(|k| ellipse.centre[k] + self.corner[k]);
        Shade { ellipse: Ellipse { centre, ..*ellipse }, colour }
    }

    /// Where circles reduce the error most, of each size.
    fn candidates(&self, pyramid: &[Level], least: f64) -> Vec<Candidate> {
        let mut errors: [Vec<f32>; 3] = std::array::from_fn(|c| {
            let all = self.weight.iter().zip(&self.target).zip(&self.painted);
            all.map(|((w, t), p)| w * (t[c] - p[c])).collect()
        });
        let mut levels = Vec::with_capacity(pyramid.len());
        for level in pyramid {
            let coarser = errors.each_ref().map(|plane| halved(plane, level.width, level.height));
            levels.push((level, std::mem::replace(&mut errors, coarser)));
        }
        let each: Vec<_> = levels.iter().flat_map(|level| [(level, 0), (level, 1)]).collect();
        parallel::map(&each, |((level, errors), radius)| level.peaks(errors, *radius, least)).concat()
    }

    /// Paints an ellipse near a candidate if it reduces the error by `least`, and is permitted.
    fn painted_near(&mut self, candidate: &Candidate, least: f64, rules: Rules) -> Option<Shade> {
        let circle = circle(candidate.centre, candidate.radius)?;
        let mut best = (self.fit(&circle)?, circle);
        if let Some(fitted) = self.fitted(&circle, candidate.radius, best.0.colour)
            && let Some(fit) = self.fit(&fitted)
            && fit.gain > best.0.gain
        {
            best = (fit, fitted);
        }
        let specks = SPECK_SIZES.iter().filter_map(|size| best.1.resized(*size, Profile::Sharp));
        let mut to_beat = best.0.gain / FOCUS;
        for speck in specks.filter(is_speck).collect::<Vec<_>>() {
            if let Some(fit) = self.fit(&speck)
                && fit.contrast >= EDGE
                && fit.gain > to_beat
            {
                to_beat = fit.gain;
                best = (fit, speck);
            }
        }
        let (fit, ellipse) = best;
        if fit.gain < least || !rules.permit(&ellipse, &fit) {
            return None;
        }
        let is_harmless = self.harm(&ellipse, fit.colour) <= rules.harm * fit.gain;
        is_harmless.then(|| self.add(&ellipse, fit.colour))
    }

    /// The squared error that an ellipse adds where it paints over what was right.
    fn harm(&self, ellipse: &Ellipse, colour: [f64; 3]) -> f64 {
        let own = colour.map(|v| v as f32);
        let added = self.covered(ellipse).map(|(i, opacity)| {
            let (t, p) = (self.target[i], self.painted[i]);
            let more = (0..3).map(|c| {
                let (before, after) = (t[c] - p[c], t[c] - p[c] - opacity * (own[c] - p[c]));
                after * after - before * before
            });
            self.weight[i] * more.sum::<f32>().max(0.0)
        });
        added.map(f64::from).sum()
    }

    /// The colour in which an ellipse reduces the error most.
    fn fit(&self, ellipse: &Ellipse) -> Option<EllipseFit> {
        let (mut wanted, mut squares, mut before, mut black) = ([0f32; 3], 0f32, 0f32, 0f32);
        let (mut below, mut opacities) = ([0.0; 3], 1e-9);
        for (i, opacity) in self.covered(ellipse) {
            let (w, t, p) = (self.weight[i], self.target[i], self.painted[i]);
            squares += w * opacity * opacity;
            let share = f64::from(opacity * w);
            opacities += share;
            for c in 0..3 {
                // What is left if the ellipse were black.
                let rest = t[c] - p[c] + opacity * p[c];
                wanted[c] += w * opacity * rest;
                before += w * (t[c] - p[c]) * (t[c] - p[c]);
                black += w * rest * rest;
                below[c] += share * f64::from(p[c]);
            }
        }
        if squares < 0.5 {
            return None;
        }
        let colour = wanted.map(|v| (v / squares).clamp(0.0, 255.0));
        let after: f32 = black
            + (0..3).map(|c| squares * colour[c] * colour[c] - 2.0 * colour[c] * wanted[c]).sum::<f32>();
        let colour = colour.map(f64::from);
        let contrast = (0..3).map(|c| (colour[c] - below[c] / opacities).abs()).fold(0.0, f64::max);
        let [short, long] = ellipse.semi_axes();
        let seen = f64::from(squares)
            / (FallOff::of(ellipse.profile).mean_square * std::f64::consts::PI * short * long);
        Some(EllipseFit { gain: f64::from(before - after), colour, contrast, seen })
    }

    /// The ellipse that has the moments of the error towards `colour` around a circle.
    fn fitted(&self, around: &Ellipse, radius: f64, colour: [f64; 3]) -> Option<Ellipse> {
        let centre = around.centre;
        let wide = circle(centre, WIDE * radius)?;
        let aim = colour.map(|v| v as f32);
        let (mut sum, mut first, mut second) = (0f64, [0f64; 2], [0f64; 3]);
        for (i, opacity) in self.covered(&wide) {
            let (t, p) = (self.target[i], self.painted[i]);
            let (mut along, mut length) = (0f32, 1e-3f32);
            for c in 0..3 {
                let d = aim[c] - p[c];
                along += (t[c] - p[c]) * d;
                length += d * d;
            }
            let share = f64::from((along / length).clamp(0.0, 1.0) * self.weight[i] * opacity);
            let x = (i % self.width) as f64 + 0.5 - centre[0];
            let y = (i / self.width) as f64 + 0.5 - centre[1];
            sum += share;
            first = [first[0] + share * x, first[1] + share * y];
            second = [second[0] + share * x * x, second[1] + share * x * y, second[2] + share * y * y];
        }
        if sum < 0.1 {
            return None;
        }
        let mean = first.map(|v| v / sum);
        let own = [
            second[0] / sum - mean[0] * mean[0],
            second[1] / sum - mean[0] * mean[1],
            second[2] / sum - mean[1] * mean[1],
        ];
        // The window is a Gaussian itself: precisions of the two add up.
        let of_window = WIDE * WIDE * radius * radius / 8.0;
        let (half, rest) = ((own[0] + own[2]) / 2.0, libm::hypot((own[0] - own[2]) / 2.0, own[1]));
        let angle = 0.5 * libm::atan2(2.0 * own[1], own[0] - own[2]);
        let axis = |variance: f64| {
            let precision = 1.0 / variance.max(1e-3) - 1.0 / of_window;
            let free = if precision > 0.0 { 1.0 / precision } else { f64::INFINITY };
            libm::sqrt(8.0 * free).clamp((radius / STRETCH).max(LEAST_RADIUS), radius * STRETCH)
        };
        let (long, short) = (axis(half + rest), axis(half - rest));
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let (a, b) = (long * long, short * short);
        let square = [
            a * cosine * cosine + b * sine * sine,
            (a - b) * sine * cosine,
            a * sine * sine + b * cosine * cosine,
        ];
        Ellipse::of_square([centre[0] + mean[0], centre[1] + mean[1]], square, Profile::Soft)
    }

    /// The layer of an ellipse: that of the pixel at its centre.
    fn layer(&self, ellipse: &Ellipse) -> u8 {
        let [x, y] = [(ellipse.centre[0], self.width), (ellipse.centre[1], self.height)]
            .map(|(v, side)| (v as usize).min(side - 1));
        self.layers.get(y * self.width + x).copied().unwrap_or(0)
    }

    /// The pixels to be painted in which an ellipse is seen, and its opacity there.
    fn covered(&self, ellipse: &Ellipse) -> impl Iterator<Item = (usize, f32)> + use<'_> {
        let (inverse, fall) = (ellipse.map().inverse(), FallOff::of(ellipse.profile));
        let [xx, xy, yy] = ellipse.matrix;
        let (centre, reach) = (ellipse.centre, [libm::hypot(xx, xy), libm::hypot(xy, yy)]);
        let range = |k: usize, side: usize| {
            let [low, high] = [-1.0, 1.0].map(|s| centre[k] + s * reach[k]);
            (low.max(0.0) as usize)..(libm::ceil(high.clamp(0.0, side as f64)) as usize)
        };
        let (columns, rows) = (range(0, self.width), range(1, self.height));
        let layer = self.layer(ellipse);
        let pixels = rows.flat_map(move |y| columns.clone().map(move |x| (x, y)));
        pixels.filter_map(move |(x, y)| {
            let i = y * self.width + x;
            if self.weight[i] <= 0.0 || self.layers.get(i).is_some_and(|&above| above > layer) {
                return None;
            }
            let p = inverse * Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let square = p.x * p.x + p.y * p.y;
            (square < 1.0).then(|| (i, fall.at(square)))
        })
    }
}

/// A circle as an ellipse.
fn circle(centre: [f64; 2], radius: f64) -> Option<Ellipse> {
    Ellipse::of_square(centre, [radius * radius, 0.0, radius * radius], Profile::Soft)
}

/// What does not change from round to round, at a fraction of a window's resolution.
struct Level {
    /// Pixels of the window to a pixel, along one axis.
    scale: f64,
    width: usize,
    height: usize,
    /// Sum of the weights under the squared opacity of a circle around each pixel, by radius.
    weights: [Vec<f32>; 2],
}

impl Level {
    /// All levels of a window, each at half the resolution of the one before.
    fn pyramid(window: &PaintedWindow) -> Vec<Self> {
        let (mut width, mut height, mut plane) = (window.width, window.height, window.weight.clone());
        let mut levels: Vec<Self> = Vec::new();
        loop {
            let scale = levels.last().map_or(1.0, |level| 2.0 * level.scale);
            let weights = RADII.map(|radius| blurred(&plane, width, &kernel(radius, 8.0)));
            levels.push(Self { scale, width, height, weights });
            if width.min(height) < 4 {
                return levels;
            }
            plane = halved(&plane, width, height);
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
    }

    /// The peaks of the reduction of the error by circles of one of [`RADII`]. `errors` are weighted, by component.
    fn peaks(&self, errors: &[Vec<f32>; 3], radius: usize, least: f64) -> Vec<Candidate> {
        let (width, height) = (self.width, self.height);
        let (radius, weights) = (RADII[radius], &self.weights[radius]);
        let kernel = kernel(radius, 4.0);
        let errors = errors.each_ref().map(|plane| blurred(plane, width, &kernel));
        let gains: Vec<f32> = (0..width * height)
            .map(|i| {
                let squares: f32 = (0..3).map(|c| errors[c][i] * errors[c][i]).sum();
                squares / weights[i].max(0.5)
            })
            .collect();
        let mut found = Vec::new();
        for (i, &gain) in gains.iter().enumerate().filter(|(_, gain)| f64::from(**gain) >= least) {
            let (x, y) = (i % width, i / width);
            let mut around = (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(|v| (x.saturating_sub(1)..(x + 2).min(width)).map(move |u| v * width + u));
            // Of equals the first is the peak.
            let is_peak = around.all(|k| k == i || gains[k] < gain || (gains[k] == gain && k > i));
            if is_peak {
                let centre = [x, y].map(|v| (v as f64 + 0.5) * self.scale);
                found.push(Candidate { gain: gain.into(), centre, radius: radius * self.scale });
            }
        }
        found
    }
}

/// The opacity of a circle along one axis, or a power of it by `fall`.
fn kernel(radius: f64, fall: f64) -> Vec<f32> {
    let reach = libm::ceil(radius) as i32 - 1;
    let value = |i: i32| libm::exp(-fall * f64::from(i * i) / (radius * radius)) as f32;
    (-reach..=reach).map(value).collect()
}

/// A plane at half the resolution, of sums.
fn halved(plane: &[f32], width: usize, height: usize) -> Vec<f32> {
    let half = width.div_ceil(2);
    let mut out = vec![0.0; half * height.div_ceil(2)];
    for (i, value) in plane.iter().enumerate() {
        out[i / width / 2 * half + i % width / 2] += value;
    }
    out
}

/// A plane convolved along both axes with an odd, symmetric kernel; nothing lies beyond its borders.
fn blurred(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    for (from, to) in plane.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (k, factor) in kernel.iter().enumerate() {
            let (skip, shift) = (reach.saturating_sub(k), k.saturating_sub(reach));
            if skip < width && shift < width {
                let (to, from) = (&mut to[skip..], &from[shift..]);
                to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
            }
        }
    }
    let mut out = vec![0.0; plane.len()];
    for (k, factor) in kernel.iter().enumerate() {
        let (skip, shift) = (reach.saturating_sub(k) * width, k.saturating_sub(reach) * width);
        if skip < out.len() && shift < out.len() {
            let (to, from) = (&mut out[skip..], &rows[shift..]);
            to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window of 60 × 60 on black.
    fn window(target: impl Fn(f64, f64) -> f32) -> PaintedWindow {
        let at = |i: usize| [i % 60, i / 60].map(|v| v as f64 + 0.5);
        let target = (0..3600).map(|i| [target(at(i)[0], at(i)[1]); 3]).collect();
        let (weight, painted) = (vec![1.0; 3600], vec![[0.0; 3]; 3600]);
        PaintedWindow {
            width: 60,
            height: 60,
            corner: [100.0, 50.0],
            weight,
            target,
            painted,
            layers: Vec::new(),
        }
    }

    const RULES: Rules =
        Rules { contrast: f64::INFINITY, harm: 0.5, seen: 0.6, radius: 8.5, areas: [0.0, f64::INFINITY] };

    #[test]
    fn the_profile_is_that_of_the_photograph() {
        let from = |x: f64, y: f64| libm::hypot(x - 31.0, y - 28.5);
        let mut soft = window(|x, y| 90.0 * libm::exp(-from(x, y) * from(x, y) / 16.0) as f32);
        let mut sharp = window(|x, y| 90.0 * (4.0 - from(x, y)).clamp(0.0, 1.0) as f32);
        for (window, profile) in [(&mut soft, Profile::Soft), (&mut sharp, Profile::Sharp)] {
            let before = window.error();
            let shades = window.paint(2000.0, ROUNDS, RULES, &()).unwrap();
            assert_eq!(shades[0].ellipse.profile, profile);
            assert!(shades.len() < 12 && window.error() < 0.05 * before, "{shades:?} {}", window.error());
        }
    }

    #[test]
    fn ellipses_are_painted_as_they_are_returned() {
        let waves = |x: f64, y: f64| (100.0 + 60.0 * libm::sin(x / 5.0) * libm::sin(y / 7.0)) as f32;
        let mut first = window(waves);
        let before = first.error();
        let shades = first.paint(2000.0, ROUNDS, RULES, &()).unwrap();
        assert!(first.error() < 0.05 * before, "{} of {before}", first.error());
        assert!(shades.iter().all(|s| s.ellipse.centre[0] >= 100.0 && s.ellipse.centre[1] >= 50.0));
        // The same ellipses in the same order on black.
        let mut again = window(waves);
        let kept = again.repaint(&shades, f64::NEG_INFINITY, Rules { seen: 0.0, ..RULES });
        assert_eq!(kept.len(), shades.len());
        assert!((again.error() / first.error() - 1.0).abs() < 0.2, "{} {}", again.error(), first.error());
    }

    #[test]
    fn what_is_mostly_hidden_is_not_repainted() {
        let mut all = window(|_, _| 200.0);
        let ellipse = Ellipse::of_square([130.0, 80.0], [16.0, 0.0, 16.0], Profile::Soft).unwrap();
        let shade = Shade { ellipse, colour: Colour([9; 3]) };
        let kept = all.clone().repaint(&[shade], 0.0, RULES);
        // In the colour that is best where it is now.
        assert_eq!(kept[0].colour, Colour([255; 3]));
        (0..3600).filter(|i| i % 60 < 31).for_each(|i| all.weight[i] = 0.0);
        assert_eq!(all.repaint(&[shade], 0.0, RULES).len(), 0);
    }

    #[test]
    fn an_edge_that_is_large_is_not_blurred() {
        // Half black, half white: a soft ellipse across the edge adds as much error as it takes away.
        let mut halves = window(|x, _| if x < 30.0 { 0.0 } else { 250.0 });
        halves.painted.fill([125.0; 3]);
        let strict = Rules { harm: 0.02, ..RULES };
        let shades = halves.paint(100.0, ROUNDS, strict, &()).unwrap();
        assert!(!shades.is_empty());
        for shade in shades.iter().take(20) {
            let [_, long] = shade.ellipse.semi_axes();
            let distance = (shade.ellipse.centre[0] - 130.0).abs();
            assert!(distance > 0.2 * long, "{shade:?}");
        }
    }

    #[test]
    fn convolution_of_a_point_is_the_kernel() {
        let mut plane = vec![0.0; 15];
        plane[7] = 1.0;
        let kernel = [0.25, 0.5, 0.25];
        let out = blurred(&plane, 5, &kernel);
        let wanted: Vec<f32> =
            (0..3).flat_map(|y| [0.0, 0.25, 0.5, 0.25, 0.0].map(|v| v * kernel[y])).collect();
        assert_eq!(out, wanted);
        // Kernels longer than a plane.
        assert_eq!(blurred(&[1.0], 1, &[0.125, 0.25, 0.5, 0.25, 0.125]), [0.25]);
    }
}
