//! Finds the lattice of a picture, or its rows.
//!
//! What counts is how much higher the autocorrelation is at all multiples of a period than half-way between them, not
//! how high it is: a floor of tiles in many colours looks like itself moved by a tile only in its joints, but it does
//! so everywhere. Colours are correlated, and strengths of edges ([`maps`](super::maps)). Pairs of the highest peaks
//! propose lattices, and so do rows in two directions ([`rows`]). Each is fitted to the peaks at its multiples. The
//! smallest cell among the surest is taken. Where even the surest is doubtful, as for courses of bricks of many lengths,
//! the clearest rows are taken alone. A drawing that is one period repeats exactly: peaks alone propose its lattices, and
//! only those count whose whole sums its sides are.

use super::correlation::Autocorrelation;
use super::fit::{fitted, forward, is_near, is_same, shortest, sum};
use super::maps::Maps;
use super::rows::{self, Rows};
use super::{LEAST_SINE, Lattice, cross, length};
use image::RgbImage;
use std::borrow::Cow;
use vtex_base::parallel;
use vtex_base::raster::{Filter, resized};

/// Longest side at which pictures are correlated, in pixels.
const SIDE: u32 = 400;
/// Shortest side of a picture in which a lattice is sought, in pixels.
const LEAST_SIDE: u32 = 16;
/// Copies of a period along each side that are correlated.
const PERIODS: u32 = 4;
/// Shortest vector, in pixels of the reduced picture: shorter ones are those of a grain or a weave.
const SHORTEST: f64 = 8.0;
/// Highest peaks that propose lattices, and shortest ones of the high ones.
const MOST_PEAKS: usize = 12;
const HIGH_PEAKS: usize = 40;
/// Standard errors by which the correlation must be higher at multiples than half-way between them.
const ERRORS: f64 = 3.0;
/// Fewest multiples within reach.
const LEAST_MULTIPLES: f64 = 8.0;
/// Least rise of the correlation from half-way to the multiples, less the errors, and as a share of its height there.
/// Courses without a bond rise by a quarter, since each resembles the next wherever it is; bonds rise by two fifths.
const LEAST_RISE: f64 = 0.12;
const LEAST_SHARE: f64 = 0.4;
/// Smaller cells replace larger ones if the rise and the height are at least these shares.
const SMALLER: [f64; 2] = [0.5, 0.8];
/// Least contrast of rows alone of which three multiples are seen, and two.
const LEAST_CONTRAST: [f64; 2] = [0.12, 0.24];

/// A lattice that may be one of the picture's.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    vectors: [[f64; 2]; 2],
    /// Standard deviation of peaks from its multiples, in pixels.
    stray: f64,
    /// Mean correlation at its multiples.
    height: f64,
    /// How much lower the correlation is half-way, at the highest of three ways.
    rise: f64,
    /// The rise, less its errors.
    sure: f64,
}

/// The lattice of a picture, in its pixels; `None` if it has none.
pub fn find(picture: &RgbImage) -> Option<Lattice> {
    let reduced = Reduced::new(picture, SIDE);
    if reduced.size().into_iter().min() < Some(LEAST_SIDE) {
        return None;
    }
    let maps = Maps::new(&reduced.picture, false);
    let correlate = || {
        let [colour, chroma] = &maps.colour;
        [Autocorrelation::new(colour, Some(chroma)), Autocorrelation::new(&maps.edges, None)]
    };
    let (rows, correlations) = parallel::join(|| rows::find(&maps), correlate);
    if let Some(best) = best(&proposals(pairs(&rows, &[], &correlations), &correlations)) {
        return reduced.in_pixels(&best.vectors, best.height, best.stray);
    }
    let is_clear =
        |rows: &&Rows| rows.period.contrast >= LEAST_CONTRAST[usize::from(rows.period.multiples < 3)];
    let Rows { normal, period } = rows.iter().find(is_clear)?;
    reduced.in_pixels(&[forward(normal.map(|c| c * period.length))], period.height, period.stray)
}

/// The lattice of a picture that repeats, in pixels. If nothing smaller repeats within the picture, the vectors are its
/// sides. `None` if a side is shorter than 4 pixels.
pub fn of_period(picture: &RgbImage) -> Option<Lattice> {
    let reduced = Reduced::new(picture, SIDE / PERIODS);
    let sides = |[width, height]: [u32; 2]| [[f64::from(width), 0.0], [0.0, f64::from(height)]];
    let own = sides(reduced.size());
    let maps = Maps::new(&reduced.picture, true);
    let [colour, chroma] = &maps.colour;
    let correlate = |one, other| Autocorrelation::of_period(one, other, f64::from(PERIODS));
    let correlations = [correlate(colour, Some(chroma)), correlate(&maps.edges, None)];
    // The sides are whole sums of exactly these, and far fewer differ.
    let exact = |pair| divided(own, pair).filter(|&exact| is_near(pair, exact));
    let pairs = pairs(&[], &own, &correlations).into_iter().filter_map(exact).collect();
    let found = best(&proposals(pairs, &correlations))
        .and_then(|found| reduced.in_pixels(&divided(own, found.vectors)?, found.height, found.stray));
    found.or_else(|| Lattice::new(&sides(picture.dimensions().into())).ok())
}

/// The vectors near two others whose whole sums two sides are; `None` if the others are too long.
fn divided(sides: [[f64; 2]; 2], [a, b]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let of = |side| [cross(side, b), cross(a, side)].map(|v| libm::round(v / cross(a, b)));
    let [[p, q], [r, s]] = sides.map(of);
    let count = p * s - q * r;
    (count != 0.0).then(|| [sum(sides, [s / count, -q / count]), sum(sides, [-r / count, p / count])])
}

/// A picture, made smaller.
struct Reduced<'a> {
    picture: Cow<'a, RgbImage>,
    /// Pixels of the picture to one of it, along x and y.
    scale: [f64; 2],
}

impl<'a> Reduced<'a> {
    /// A picture whose longer side is at most `longest` pixels.
    fn new(picture: &'a RgbImage, longest: u32) -> Self {
        let (width, height) = picture.dimensions();
        let factor = (f64::from(width.max(height)) / f64::from(longest)).max(1.0);
        let size = [width, height].map(|v| libm::round(f64::from(v) / factor).max(1.0) as u32);
        let scale = [f64::from(width) / f64::from(size[0]), f64::from(height) / f64::from(size[1])];
        let smaller = (factor > 1.0).then(|| resized(picture, size[0], size[1], Filter::Triangle));
        Self { picture: smaller.map_or(Cow::Borrowed(picture), Cow::Owned), scale }
    }

    fn size(&self) -> [u32; 2] {
        self.picture.dimensions().into()
    }

    /// The lattice of vectors found in it, in pixels of the picture, and its other figures; `None` if it is invalid.
    fn in_pixels(&self, vectors: &[[f64; 2]], height: f64, stray: f64) -> Option<Lattice> {
        let scale = self.scale;
        // Rounded to hundredths, which hides the platform-dependent last digits of a transform.
        let round = |v: f64| libm::round(v * 100.0) / 100.0 + 0.0;
        let lattice = Lattice {
            vectors: vectors.iter().map(|v| [0, 1].map(|k| round(v[k] * scale[k]))).collect(),
            strength: round(height.clamp(0.0, 1.0)),
            stray: round(stray * scale[0].max(scale[1])),
        };
        lattice.fault().is_none().then_some(lattice)
    }
}

/// The smallest cell of nearly the surest lattice.
fn best(proposals: &[Proposal]) -> Option<Proposal> {
    let is_one = |p: &&Proposal| p.sure >= LEAST_RISE && p.rise >= LEAST_SHARE * p.height;
    let surest = proposals.iter().filter(is_one).max_by(|a, b| a.sure.total_cmp(&b.sure))?;
    let is_near =
        |p: &&Proposal| p.sure >= SMALLER[0] * surest.sure && p.height >= SMALLER[1] * surest.height;
    let area = |p: &Proposal| cross(p.vectors[0], p.vectors[1]).abs();
    proposals.iter().filter(is_one).filter(is_near).min_by(|a, b| area(a).total_cmp(&area(b))).copied()
}

/// Pairs of vectors of rows, and pairs of peaks and of periods that are known.
fn pairs(rows: &[Rows], known: &[[f64; 2]], correlations: &[Autocorrelation; 2]) -> Vec<[[f64; 2]; 2]> {
    let mut pairs: Vec<[[f64; 2]; 2]> = Vec::new();
    for (i, one) in rows.iter().enumerate() {
        for other in &rows[..i] {
            let [p, q] = [one, other].map(|r| r.normal.map(|n| n / r.period.length));
            let d = cross(p, q);
            pairs.extend(is_apart(p, q).then(|| [[q[1] / d, -q[0] / d], [-p[1] / d, p[0] / d]]));
        }
    }
    for correlation in correlations {
        let peaks = [high_peaks(correlation), known.to_vec()].concat();
        for (i, &p) in peaks.iter().enumerate() {
            pairs.extend(peaks[..i].iter().filter(|&&q| is_apart(p, q)).map(|&q| [p, q]));
        }
    }
    pairs
}

/// The lattices of pairs of vectors that differ, judged.
fn proposals(pairs: Vec<[[f64; 2]; 2]>, correlations: &[Autocorrelation; 2]) -> Vec<Proposal> {
    let mut different: Vec<[[f64; 2]; 2]> = Vec::new();
    for pair in pairs.into_iter().map(shortest).filter(|pair| length(pair[0]) >= SHORTEST) {
        if !different.iter().any(|&other| is_same(pair, other)) {
            different.push(pair);
        }
    }
    let judged = |&pair: &[[f64; 2]; 2]| {
        let of = correlations.iter().filter_map(|correlation| judged(correlation, pair));
        of.max_by(|a, b| a.sure.total_cmp(&b.sure))
    };
    parallel::map(&different, judged).into_iter().flatten().collect()
}

/// Whether two vectors are far from parallel.
fn is_apart(p: [f64; 2], q: [f64; 2]) -> bool {
    cross(p, q).abs() > LEAST_SINE * length(p) * length(q)
}

/// Lags of the highest peaks, and of the shortest of the high ones.
fn high_peaks(correlation: &Autocorrelation) -> Vec<[f64; 2]> {
    let mut peaks = correlation.peaks(SHORTEST);
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    peaks.truncate(HIGH_PEAKS);
    let mut chosen: Vec<[f64; 2]> = peaks.iter().take(MOST_PEAKS).map(|p| p.0).collect();
    peaks.drain(..chosen.len());
    peaks.sort_by(|a, b| length(a.0).total_cmp(&length(b.0)));
    chosen.extend(peaks.iter().take(MOST_PEAKS).map(|p| p.0));
    chosen
}

/// A lattice fitted to a correlation, with its means at the multiples and half-way between them.
fn judged(correlation: &Autocorrelation, vectors: [[f64; 2]; 2]) -> Option<Proposal> {
    let (vectors, stray) = fitted(correlation, vectors).unwrap_or((vectors, 0.0));
    // A fit may go astray.
    let vectors = shortest(vectors);
    if !is_apart(vectors[0], vectors[1]) {
        return None;
    }
    let on = mean(correlation, vectors, [0.0; 2]).filter(|on| on.count >= LEAST_MULTIPLES)?;
    let half_way = [[0.5, 0.0], [0.0, 0.5], [0.5, 0.5]].map(|offset| mean(correlation, vectors, offset));
    let [mut rise, mut sure] = [f64::MAX; 2];
    for half in half_way {
        let (half, own) = (half?, on.mean);
        rise = rise.min(own - half.mean);
        sure = sure.min(own - half.mean - ERRORS * libm::sqrt(on.error + half.error));
    }
    Some(Proposal { vectors, stray, height: on.mean, rise, sure })
}

/// A mean of a correlation.
struct Mean {
    mean: f64,
    /// The square of its standard error.
    error: f64,
    count: f64,
}

/// The mean at the places of a lattice, moved by an offset in periods, but for that at lag 0.
fn mean(correlation: &Autocorrelation, vectors: [[f64; 2]; 2], offset: [f64; 2]) -> Option<Mean> {
    let far = libm::hypot(correlation.near[0], correlation.near[1]);
    let d = cross(vectors[0], vectors[1]).abs();
    let most = [1, 0].map(|k: usize| (far * length(vectors[k]) / d) as i32 + 1);
    let (mut total, mut squares, mut count) = (0.0, 0.0, 0.0);
    for m in -most[1]..=most[1] {
        for n in -most[0]..=most[0] {
            let at = sum(vectors, [f64::from(n) + offset[0], f64::from(m) + offset[1]]);
            let is_near =
                at[1] >= 0.0 && at != [0.0; 2] && (0..2).all(|k| at[k].abs() <= correlation.near[k]);
            if let Some(value) = is_near.then(|| correlation.between(at)).flatten() {
                total += value;
                squares += value * value;
                count += 1.0;
            }
        }
    }
    let mean = total / count;
    (count >= 3.0).then(|| Mean {
        mean,
        error: (squares / count - mean * mean).max(0.0) / (count - 1.0),
        count,
    })
}
