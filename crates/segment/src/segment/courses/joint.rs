//! The joint between rows: its place in the period, and its colours.

use vtex_base::geometry::plane::length;
use vtex_base::raster::blur::Plane;
use vtex_base::symmetric::inverse;
use vtex_scene::lattice::Lattice;

/// Numbers of equal parts of a period.
const PARTS: [f64; 2] = [8.0, 64.0];
/// A part belongs to the joint if its variance of colours exceeds the least by at most this share of the way to the upper
/// quartile.
const CALM: f64 = 0.3;
/// Least ratio of that quartile to the least variance.
const CLEAR: f64 = 3.0;
/// Largest share of the joint in the period, and least width of it, in pixels.
const WIDEST: f64 = 0.45;
const NARROWEST: f64 = 2.0;
/// Rounds in which the colours of joints are estimated, each without what is far from them.
const ROUNDS: usize = 4;
/// Squared Mahalanobis distance up to which a colour is one of the joints': three deviations.
const ALIKE: f64 = 9.0;
/// Least variance of a component of Oklab, that of a picture's noise.
const NOISE: f64 = 2e-6;
/// Most pixels from which colours are estimated.
const SAMPLES: usize = 100_000;

/// The joint of the rows of a picture.
pub(super) struct Joint {
    /// Width and height of the picture.
    pub(super) size: [usize; 2],
    /// Its scalar product with a place is the place's row and phase, with the end of the joint at 0.
    wave: [f64; 2],
    end: f64,
    /// The period across the rows, and the width of the joint, in pixels.
    pub(super) period: f64,
    pub(super) width: f64,
    /// Whether each pixel has the colours of the joint.
    is_joint: Vec<bool>,
}

/// The part of a period in which colours vary least.
struct Strip {
    wave: [f64; 2],
    /// Where it begins, and its width, as shares of the period.
    start: f64,
    width: f64,
    /// How much less colours vary in it.
    contrast: f64,
}

impl Joint {
    /// The clearest joint of a picture, given as Oklab; `None` if none is clear.
    pub(super) fn new(planes: &[Plane; 3], lattice: &Lattice) -> Option<Self> {
        let waves = lattice.phases().waves;
        let waves = match waves[..] {
            // Rows of a bond lie along sums of the lattice's vectors.
            [a, b] => vec![a, b, [a[0] + b[0], a[1] + b[1]], [a[0] - b[0], a[1] - b[1]]],
            _ => waves,
        };
        let strips = waves.into_iter().filter_map(|wave| Strip::new(planes, wave));
        let is_clear = |strip: &Strip| {
            let width = strip.width / length(strip.wave);
            strip.contrast >= CLEAR && strip.width <= WIDEST && width >= NARROWEST
        };
        let strip = strips.filter(is_clear).max_by(|a, b| a.contrast.total_cmp(&b.contrast))?;
        let colours = Colours::new(planes, &strip)?;
        let period = 1.0 / length(strip.wave);
        Some(Self {
            size: planes[0].size,
            wave: strip.wave,
            end: strip.start + strip.width,
            period,
            width: strip.width * period,
            is_joint: (0..planes[0].values.len()).map(|k| colours.distance(at(planes, k)) < ALIKE).collect(),
        })
    }

    /// Whether a pixel has the colours of the joint.
    pub(super) fn has_colours(&self, x: usize, y: usize) -> bool {
        self.is_joint[y * self.size[0] + x]
    }

    /// The row of a pixel, its distance from the end of the joint before that row, and its place along the row.
    pub(super) fn place(&self, x: usize, y: usize) -> (i32, f64, f64) {
        let (x, y) = (x as f64 + 0.5, y as f64 + 0.5);
        let across = self.wave[0] * x + self.wave[1] * y - self.end;
        let row = libm::floor(across);
        let along = (self.wave[0] * y - self.wave[1] * x) * self.period;
        (row as i32, (across - row) * self.period, along)
    }

    /// The pixel at a distance from the end of the joint before a row, and at a place along it; the inverse of
    /// [`Joint::place`].
    pub(super) fn pixel(&self, row: i32, across: f64, along: f64) -> [f64; 2] {
        let normal = self.wave.map(|w| w * self.period);
        let across = (f64::from(row) + self.end) * self.period + across;
        [normal[0] * across - normal[1] * along, normal[1] * across + normal[0] * along]
    }
}

fn at(planes: &[Plane; 3], k: usize) -> [f64; 3] {
    [0, 1, 2].map(|c| f64::from(planes[c].values[k]))
}

/// The phase of each pixel, 0 to 1, row by row.
fn phases(size: [usize; 2], wave: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..size[1]).flat_map(move |y| {
        (0..size[0]).map(move |x| {
            let phase = wave[0] * (x as f64 + 0.5) + wave[1] * (y as f64 + 0.5);
            phase - libm::floor(phase)
        })
    })
}

impl Strip {
    fn new(planes: &[Plane; 3], wave: [f64; 2]) -> Option<Self> {
        let parts = libm::round(1.0 / length(wave)).clamp(PARTS[0], PARTS[1]) as usize;
        let mut sums = vec![[0.0; 7]; parts];
        for (k, phase) in phases(planes[0].size, wave).enumerate() {
            let sum = &mut sums[((phase * parts as f64) as usize).min(parts - 1)];
            sum[0] += 1.0;
            for (c, v) in at(planes, k).into_iter().enumerate() {
                sum[1 + c] += v;
                sum[4 + c] += v * v;
            }
        }
        let variance = |[n, sums @ ..]: &[f64; 7]| {
            (0..3).map(|c| sums[3 + c] / n - (sums[c] / n) * (sums[c] / n)).sum::<f64>().max(0.0)
        };
        let variances: Vec<f64> = sums.iter().map(variance).collect();
        let mut sorted = variances.clone();
        sorted.sort_by(f64::total_cmp);
        let (least, upper) = (sorted[0].max(3.0 * NOISE), sorted[parts * 3 / 4]);
        let most = least + CALM * (upper - least);
        let run = |start: usize| (0..parts).take_while(|k| variances[(start + k) % parts] < most).count();
        let start = (0..parts).max_by_key(|start| (run(*start), parts - start))?;
        let share = |count: usize| count as f64 / parts as f64;
        Some(Self { wave, start: share(start), width: share(run(start)), contrast: upper / least })
    }

    /// Whether a phase is within it.
    fn contains(&self, phase: f64) -> bool {
        let off = phase - self.start;
        off - libm::floor(off) < self.width
    }
}

/// The colours of joints: their mean, and the inverse of their covariance.
struct Colours {
    mean: [f64; 3],
    inverse: [[f64; 3]; 3],
}

impl Colours {
    fn new(planes: &[Plane; 3], strip: &Strip) -> Option<Self> {
        let within =
            phases(planes[0].size, strip.wave).enumerate().filter(|(_, phase)| strip.contains(*phase));
        let all: Vec<usize> = within.map(|(k, _)| k).collect();
        let samples: Vec<[f64; 3]> =
            all.iter().step_by(all.len() / SAMPLES + 1).map(|&k| at(planes, k)).collect();
        let mut colours = Self::of(&samples)?;
        for _ in 0..ROUNDS {
            let near: Vec<[f64; 3]> =
                samples.iter().filter(|colour| colours.distance(**colour) < ALIKE).copied().collect();
            colours = Self::of(&near)?;
        }
        Some(colours)
    }

    fn of(samples: &[[f64; 3]]) -> Option<Self> {
        let count = samples.len() as f64;
        let mean = [0, 1, 2].map(|c| samples.iter().map(|s| s[c]).sum::<f64>() / count);
        let entry = |a: usize, b: usize| {
            let sum: f64 = samples.iter().map(|s| (s[a] - mean[a]) * (s[b] - mean[b])).sum();
            sum / count + if a == b { NOISE } else { 0.0 }
        };
        let covariance = [0, 1, 2].map(|a| [0, 1, 2].map(|b| entry(a, b)));
        Some(Self { mean, inverse: inverse(&covariance)? })
    }

    /// Squared Mahalanobis distance of a colour.
    fn distance(&self, colour: [f64; 3]) -> f64 {
        let d = [0, 1, 2].map(|c| colour[c] - self.mean[c]);
        (0..3).map(|a| (0..3).map(|b| d[a] * self.inverse[a][b] * d[b]).sum::<f64>()).sum()
    }
}
