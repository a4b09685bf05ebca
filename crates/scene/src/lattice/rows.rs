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
/// Fractions of a pixel that are distinguished.
const FRACTION_BITS: u32 = 24;
const FRACTIONS: f64 = (1u64 << FRACTION_BITS) as f64;
/// Number of maps whose lines are averaged: lightness, and the three of edges.
const MAPS: usize = 4;

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
    let maps = &PixelMaps::new(maps);
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

/// Maps pixel by pixel.
struct PixelMaps {
    /// Columns and rows.
    size: [usize; 2],
    /// The values of all maps, row by row, and column by column.
    values: [Vec<[f32; MAPS]>; 2],
    /// Mean products of each two maps.
    products: [[f64; MAPS]; MAPS],
}

impl PixelMaps {
    fn new(maps: &Maps) -> Self {
        let planes = [&maps.colour[0], &maps.edges, &maps.turned[0], &maps.turned[1]];
        let size @ [width, height] = maps.edges.size;
        let at = |x: usize, y: usize| planes.map(|plane| plane.at(x, y));
        let rows: Vec<_> = (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).collect();
        let columns = (0..width).flat_map(|x| (0..height).map(move |y| at(x, y))).collect();
        let mut products = [[0.0; MAPS]; MAPS];
        for value in &rows {
            for (a, row) in products.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(b, sum)| *sum += f64::from(value[a] * value[b]));
            }
        }
        let count = rows.len() as f64;
        Self { size, values: [rows, columns], products: products.map(|row| row.map(|sum| sum / count)) }
    }
}

/// The clearest rows across a direction. Of each line of pixels every `step`th is looked at.
fn across(maps: &PixelMaps, degrees: f64, step: usize) -> Option<Rows> {
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
    fn both(maps: &PixelMaps, normal: [f64; 2], step: usize) -> [Self; 2] {
        // Double the angle of the normal: edges across it count in full, those along it not at all.
        let turned = [normal[0] * normal[0] - normal[1] * normal[1], 2.0 * normal[0] * normal[1]];
        let shares = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.5 * turned[0], 0.5 * turned[1]]];
        // Along the lines of pixels that are least at right angles to it, neighbours fall into different bins.
        let axis = usize::from(normal[0].abs() < normal[1].abs());
        let [sides, normal] = [maps.size.map(|side| side as f64), normal].map(|v| [v[axis], v[1 - axis]]);
        let ends =
            [f64::min, f64::max].map(|end| (0..2).map(|k| end(normal[k] * sides[k], 0.0)).sum::<f64>());
        let count = (ends[1] - ends[0]) as usize + 4;
        let (mut sums, mut pixels) = (vec![[0f32; MAPS]; count], vec![0f32; count]);
        // Places as whole numbers, in fractions of a pixel, of which the first is a pixel away from the first bin.
        let [start, along, across] =
            [1.0 - ends[0], normal[0], normal[1]].map(|v| libm::round(v * FRACTIONS) as i64);
        for (line, values) in maps.values[axis].chunks_exact(maps.size[axis]).enumerate() {
            let mut at = start + across * line as i64 + along * (line % step) as i64;
            for value in values[line % step..].iter().step_by(step) {
                let (bin, part) =
                    ((at >> FRACTION_BITS) as usize, (at & (FRACTIONS as i64 - 1)) as f32 / FRACTIONS as f32);
                for (bin, share) in [(bin, 1.0 - part), (bin + 1, part)] {
                    let mut sum = sums[bin];
                    (0..MAPS).for_each(|k| sum[k] += share * value[k]);
                    sums[bin] = sum;
                    pixels[bin] += share;
                }
                at += along * step as i64;
            }
        }
        let least = LEAST_LINE * f64::from(pixels.iter().copied().fold(0.0, f32::max));
        let is_long = |count: &f32| f64::from(*count) >= least;
        let first = pixels.iter().position(is_long).unwrap_or(0);
        let last = pixels.iter().rposition(is_long).map_or(first, |last| last + 1);
        let weights: Vec<f64> = pixels[first..last].iter().copied().map(f64::from).collect();
        let lags = 0..(weights.len() as f64 * FARTHEST) as usize;
        let pairs: Vec<f64> = lags.clone().map(|lag| correlated(&weights, lag)).collect();
        shares.map(|shares: [f64; MAPS]| {
            let total = |v: &[f32; MAPS]| (0..MAPS).map(|k| shares[k] * f64::from(v[k])).sum();
            let sums: Vec<f64> = sums[first..last].iter().map(total).collect();
            let products = maps.products.map(|row| (0..MAPS).map(|k| shares[k] * row[k]).sum::<f64>());
            let variance = (0..MAPS).map(|k| shares[k] * products[k]).sum::<f64>().max(f64::MIN_POSITIVE);
            let at = |lag: usize| correlated(&sums, lag) / pairs[lag] / variance;
            Self { correlation: lags.clone().map(at).collect() }
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

/// The sum of the products of values that are `lag` apart.
fn correlated(values: &[f64], lag: usize) -> f64 {
    const LANES: usize = 4;
    let (early, late) = (&values[..values.len() - lag], &values[lag..]);
    let (a, a_rest) = early.as_chunks::<LANES>();
    let (b, b_rest) = late.as_chunks::<LANES>();
    // Separate sums depend on one another no more than the processor's lanes do.
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        (0..LANES).for_each(|k| sums[k] += a[k] * b[k]);
    }
    sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}
