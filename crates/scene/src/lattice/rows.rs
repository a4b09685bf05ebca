//! Rows: directions along which the profile of a picture is periodic.
//!
//! For each direction the picture is averaged along it: its lightness, and its edges across the direction. The
//! correlation of such a profile is that of the picture, averaged along the direction. Rows are a period whose
//! multiples are all higher than the places half-way between them.

use super::maps::Maps;
use vtex_base::parallel;

/// Directions that are tried, over half a turn, and finer ones near the best, per direction.
const DIRECTIONS: i32 = 180;
const FINER: i32 = 10;
/// Least contrast of rows of which three multiples are seen, and two.
const LEAST: [f64; 2] = [0.05, 0.12];
/// Largest stray of a period, as a share of it, and in pixels.
const MOST_STRAY: [f64; 2] = [0.008, 0.12];
/// A period replaces longer ones if its contrast reaches this share of the largest.
const NEARLY: f64 = 0.7;
/// Shortest period, in pixels.
const SHORTEST: f64 = 8.0;
/// Longest lag, as a share of a profile's length.
const FARTHEST: f64 = 0.6;
/// Most and fewest multiples of a period that are compared.
const MULTIPLES: [usize; 2] = [5, 2];
/// Places of a profile count whose lines are at least this share of the longest.
const LEAST_LINE: f64 = 0.3;

/// Rows across a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    /// A unit vector across the rows.
    pub(super) normal: [f64; 2],
    pub(super) period: Period,
}

/// A period of a profile. Lengths are in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Period {
    pub(super) length: f64,
    /// The lowest correlation at a multiple, less the highest half-way between two.
    pub(super) contrast: f64,
    /// The lowest correlation at a multiple.
    pub(super) height: f64,
    /// Standard deviation of the peaks from the multiples.
    pub(super) stray: f64,
    /// Number of multiples that were compared.
    pub(super) multiples: usize,
}

/// The clearest rows of each direction in which there are any, clearest first. Of directions side by side only the
/// clearest is given.
pub(super) fn find(maps: &Maps) -> Vec<Rows> {
    let degrees: Vec<f64> = (0..DIRECTIONS).map(|k| f64::from(k) * 180.0 / f64::from(DIRECTIONS)).collect();
    let coarse = parallel::map(&degrees, |&degrees| across(maps, degrees, 2));
    let contrast = |k: usize| coarse[k].map_or(0.0, |rows| rows.period.contrast);
    let count = coarse.len();
    let best = |k: usize| {
        let around = (1..=8).flat_map(|d| [(k + d) % count, (k + count - d) % count]);
        contrast(k) > 0.0
            && around.into_iter().all(|n| contrast(n) < contrast(k) || (contrast(n) == contrast(k) && n > k))
    };
    let finer = |k: usize| {
        let step = 180.0 / f64::from(DIRECTIONS * FINER);
        let near = (-FINER..=FINER).map(|d| degrees[k] + step * f64::from(d));
        let near: Vec<f64> = near.collect();
        let all = parallel::map(&near, |&degrees| across(maps, degrees, 1));
        all.into_iter().flatten().max_by(|a, b| a.period.contrast.total_cmp(&b.period.contrast))
    };
    let mut found: Vec<Rows> = (0..count).filter(|&k| best(k)).filter_map(finer).collect();
    found.sort_by(|a, b| b.period.contrast.total_cmp(&a.period.contrast));
    found
}

/// The clearest rows across a direction. Of each line of pixels every `step`th is looked at.
fn across(maps: &Maps, degrees: f64, step: usize) -> Option<Rows> {
    let (sine, cosine) = libm::sincos(degrees.to_radians());
    let profiles = Profile::both(maps, [cosine, sine], step);
    let clearest =
        profiles.iter().filter_map(Profile::period).max_by(|a, b| a.contrast.total_cmp(&b.contrast));
    clearest.map(|period| Rows { normal: [cosine, sine], period })
}

/// Correlation of the means of a picture's lines.
struct Profile {
    correlation: Vec<f64>,
}

impl Profile {
    /// Profiles of lightness and of edges across a direction, a unit vector; of each line of pixels every `step`th,
    /// in turn.
    fn both(maps: &Maps, normal: [f64; 2], step: usize) -> [Self; 2] {
        let [width, height] = maps.edges.size;
        // Double the angle of the normal: edges across it count in full, those along it not at all.
        let turned =
            [normal[0] * normal[0] - normal[1] * normal[1], 2.0 * normal[0] * normal[1]].map(|v| v as f32);
        let low =
            [width, height].iter().zip(normal).map(|(&side, n)| (n * side as f64).min(0.0)).sum::<f64>();
        let high =
            [width, height].iter().zip(normal).map(|(&side, n)| (n * side as f64).max(0.0)).sum::<f64>();
        let length = (high - low) as usize + 3;
        let mut sums = vec![[0f32; 3]; length];
        let mut squares = [0f64; 2];
        for y in 0..height {
            let (mut row, start) = ([0f32; 2], y * width);
            for x in (y % step..width).step_by(step) {
                let i = start + x;
                let edge = 0.5
                    * (maps.edges.values[i]
                        + turned[0] * maps.turned[0].values[i]
                        + turned[1] * maps.turned[1].values[i]);
                let value = [maps.colour[0].values[i], edge];
                (0..2).for_each(|k| row[k] += value[k] * value[k]);
                let t = (normal[0] * x as f64 + normal[1] * y as f64 - low) as f32;
                let (bin, part) = (t as usize, t.fract());
                for (bin, share) in [(bin, 1.0 - part), (bin + 1, part)] {
                    (0..2).for_each(|k| sums[bin][k] += share * value[k]);
                    sums[bin][2] += share;
                }
            }
            (0..2).for_each(|k| squares[k] += f64::from(row[k]));
        }
        let longest = sums.iter().map(|s| f64::from(s[2])).fold(0.0, f64::max);
        let is_long = |s: &[f32; 3]| f64::from(s[2]) >= LEAST_LINE * longest;
        let first = sums.iter().position(is_long).unwrap_or(0);
        let last = sums.iter().rposition(is_long).map_or(first, |last| last + 1);
        let lines = &sums[first..last];
        [0, 1].map(|k| {
            let variance = (squares[k] * step as f64 / (width * height) as f64).max(f64::MIN_POSITIVE);
            // The mean of each line, and its number of pixels.
            let means: Vec<(f64, f32)> = lines.iter().map(|s| (f64::from(s[k] / s[2]), s[2])).collect();
            let at = |lag: usize| {
                let pairs = means.iter().zip(&means[lag..]);
                let (sum, weight) = pairs.fold((0.0, 0.0), |(sum, weight), (a, b)| {
                    let own = f64::from(a.1 * b.1);
                    (sum + own * a.0 * b.0, weight + own)
                });
                sum / weight / variance
            };
            Self { correlation: (0..(lines.len() as f64 * FARTHEST) as usize).map(at).collect() }
        })
    }

    /// The correlation at a lag.
    fn at(&self, lag: f64) -> Option<f64> {
        let low = lag as usize;
        let part = lag - low as f64;
        Some(self.correlation.get(low)? * (1.0 - part) + self.correlation.get(low + 1)? * part)
    }

    /// The highest correlation near a lag, and its place; `None` out of reach.
    fn peak_near(&self, lag: f64, radius: usize) -> Option<(f64, f64)> {
        let middle = libm::round(lag) as usize;
        if middle + radius + 1 >= self.correlation.len() {
            return None;
        }
        let near = middle.saturating_sub(radius).max(1)..=middle + radius;
        let best = near.max_by(|&a, &b| self.correlation[a].total_cmp(&self.correlation[b]))?;
        let [low, height, high] = [best - 1, best, best + 1].map(|k| self.correlation[k]);
        let bend = 2.0 * height - low - high;
        let vertex = if bend > 1e-12 { ((high - low) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
        Some((best as f64 + vertex, height))
    }

    /// The shortest period whose contrast is nearly the largest.
    fn period(&self) -> Option<Period> {
        let reach = self.correlation.len();
        let is_peak = |&t: &usize| {
            let around = self.correlation[t.saturating_sub(3)..(t + 4).min(reach)].iter();
            around.copied().fold(f64::MIN, f64::max) <= self.correlation[t]
        };
        let peaks = (SHORTEST as usize..reach.saturating_sub(2)).filter(is_peak);
        let periods: Vec<Period> = peaks.filter_map(|t| self.period_of(t)).collect();
        let clearest = periods.iter().map(|period| period.contrast).fold(0.0, f64::max);
        // Every odd multiple of a period has its contrast.
        periods.into_iter().find(|period| period.contrast >= NEARLY * clearest)
    }

    /// The period at a peak: its length fitted to multiples.
    fn period_of(&self, peak: usize) -> Option<Period> {
        let mut length = self.peak_near(peak as f64, 0)?.0;
        let mut lowest = f64::MAX;
        let mut places = Vec::new();
        for k in 1..=MULTIPLES[0] {
            // Each multiple corrects the length, so that the next is found nearby.
            let Some((at, height)) = self.peak_near(length * k as f64, 1 + k / 2) else { break };
            length = at / k as f64;
            lowest = lowest.min(height);
            places.push(at);
        }
        if places.len() < MULTIPLES[1] {
            return None;
        }
        let half_way = (0..=places.len()).filter_map(|k| self.at(length * (k as f64 + 0.5)));
        let contrast = lowest - half_way.fold(f64::MIN, f64::max);
        let miss = |(k, at): (usize, &f64)| (at - length * (k + 1) as f64) * (at - length * (k + 1) as f64);
        let stray = libm::sqrt(places.iter().enumerate().map(miss).sum::<f64>() / places.len() as f64);
        let least = if places.len() > 2 { LEAST[0] } else { LEAST[1] };
        let is_clear = contrast >= least && stray <= (MOST_STRAY[0] * length).max(MOST_STRAY[1]);
        is_clear.then_some(Period { length, contrast, height: lowest, stray, multiples: places.len() })
    }
}
