//! Pair correlation of the centres of primaries, within and between categories.
//!
//! g(r) is the number of pairs at a distance r relative to a random scatter: 1 for a random scatter, 0 below
//! the least distance of elements, high at distances at which they cluster or line up. It is estimated as
//! pairs found by pairs expected, with the translation correction for the edges (Ohser 1983; Illian and
//! others, "Statistical Analysis and Modelling of Spatial Point Patterns", 2008, section 4.3): a rectangle
//! with the sides w and h and its copy moved by r overlap in an area of wh - 2r(w + h)/π + r²/π on average
//! over all directions; along axes that wrap there is no loss. Because pairs and expectations are kept,
//! curves of several scenes add up.

use super::Layout;
use crate::element::CategoryId;
use crate::library::Library;
use crate::scene::LibraryId;
use serde::Serialize;
use std::f64::consts::PI;
use vtex_base::geometry::wrapped;

/// Bins of a curve.
const BINS: usize = 16;
/// Radius at which curves end, in mean neighbour distances.
const REACH: f64 = 4.0;
/// Most categories compared.
const CATEGORIES: usize = 5;

/// Pair correlation within and between categories.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairCorrelations {
    /// A curve for each pair of categories, first with first, first with second, and so on.
    pub curves: Vec<CorrelationCurve>,
}

/// Pair correlation of two categories, or within one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrelationCurve {
    /// The categories.
    pub categories: [CategoryId; 2],
    /// Pairs found, for each bin of distances. Bins are equally wide and end at
    /// [`PairCorrelations::REACH`] mean neighbour distances.
    pub pairs: Vec<f64>,
    /// Pairs expected of a random scatter; 0 for distances too large for the canvas.
    pub expected: Vec<f64>,
}

/// The distance between two sets of curves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Root mean square of the differences of g, weighted by their precision.
    pub rms: f64,
    /// The expected difference of two independent samples of one process, from the numbers of pairs alone. A
    /// scene made from the exemplar may have a smaller difference.
    pub noise: f64,
}

/// The categories of a library that cover most, at most five, in order of their share.
pub fn largest_categories(library: &Library) -> Vec<CategoryId> {
    let coverage = |c: &CategoryId| library.categories[c.index()].coverage;
    let count = library.categories.len().min(usize::from(u16::MAX)) as u16;
    let mut order: Vec<CategoryId> = (0..count).map(CategoryId).collect();
    order.sort_by(|a, b| coverage(b).total_cmp(&coverage(a)).then(a.cmp(b)));
    order.truncate(CATEGORIES);
    order
}

impl PairCorrelations {
    /// Radius at which curves end, in mean neighbour distances.
    pub const REACH: f64 = REACH;

    /// Correlates the centres within a layout that belong to `categories` of a library; `unit` is the mean
    /// neighbour distance, in pixels. All counts are 0 if it is not positive.
    pub fn new(layout: &Layout, library: LibraryId, categories: &[CategoryId], unit: f64) -> Self {
        let period = layout.period();
        let slot = |c: CategoryId| categories.iter().position(|k| *k == c);
        let mut points: Vec<(usize, [f64; 2])> = layout
            .centres
            .iter()
            .filter(|c| c.library == library)
            .filter_map(|c| Some((slot(c.category)?, [0, 1].map(|k| wrapped(c.at[k], period[k])))))
            .filter(|(_, p)| (0..2).all(|k| p[k] >= 0.0 && p[k] < layout.size[k]))
            .collect();
        points.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then(a.1[1].total_cmp(&b.1[1])).then(a.0.cmp(&b.0)));
        let mut numbers = vec![0.0f64; categories.len()];
        points.iter().for_each(|p| numbers[p.0] += 1.0);

        let width = REACH * unit / BINS as f64;
        let covariance = Covariance::new(layout);
        // Pairs in both orders are counted, so each twice.
        let mut pairs = vec![[0u64; BINS]; categories.len() * categories.len()];
        if width > 0.0 {
            for_pairs(&points, period, (REACH * unit).min(covariance.limit), |a, b, distance| {
                let bin = (distance / width) as usize;
                if bin < BINS {
                    pairs[a.min(b) * categories.len() + a.max(b)][bin] += 1;
                }
            });
        }
        let mut curves = Vec::new();
        for a in 0..categories.len() {
            for b in a..categories.len() {
                let possible =
                    if a == b { numbers[a] * (numbers[a] - 1.0) / 2.0 } else { numbers[a] * numbers[b] };
                let expected = |k: usize| {
                    let (from, to) = (k as f64 * width, (k + 1) as f64 * width);
                    // A bin that is cut off would be counted only in part.
                    if to > covariance.limit { 0.0 } else { possible.max(0.0) * covariance.share(from, to) }
                };
                let expected: Vec<f64> = (0..BINS).map(expected).collect();
                let counts = &pairs[a * categories.len() + b];
                let counts = (0..BINS).map(|k| if expected[k] > 0.0 { counts[k] as f64 / 2.0 } else { 0.0 });
                curves.push(CorrelationCurve {
                    categories: [categories[a], categories[b]],
                    pairs: counts.collect(),
                    expected,
                });
            }
        }
        Self { curves }
    }

    /// Adds the pairs of another scene of the same exemplar; the curves then are those of both.
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.curves.iter_mut().zip(&other.curves) {
            let bins = mine.pairs.iter_mut().zip(&mut mine.expected);
            for ((pairs, expected), (p, e)) in bins.zip(theirs.pairs.iter().zip(&theirs.expected)) {
                *pairs += p;
                *expected += e;
            }
        }
    }

    /// The difference of the curves of the same categories. Each bin is weighted by its precision: the
    /// inverse of its variance under random scattering. `None` if there is no bin in which both expect a
    /// pair.
    pub fn difference(&self, other: &Self) -> Option<Difference> {
        let (mut weights, mut squares, mut noise) = (0.0, 0.0, 0.0);
        for (a, b) in self.curves.iter().zip(&other.curves) {
            for k in 0..BINS {
                let (ea, eb) = (a.expected[k], b.expected[k]);
                if ea <= 0.0 || eb <= 0.0 {
                    continue;
                }
                let weight = 1.0 / (1.0 / ea + 1.0 / eb);
                let d = a.pairs[k] / ea - b.pairs[k] / eb;
                // Counts vary as Poisson numbers of their common mean.
                let g = (a.pairs[k] + b.pairs[k]) / (ea + eb);
                weights += weight;
                squares += weight * d * d;
                noise += g;
            }
        }
        (weights > 0.0)
            .then(|| Difference { rms: libm::sqrt(squares / weights), noise: libm::sqrt(noise / weights) })
    }
}

impl CorrelationCurve {
    /// g for each bin; `None` where no pair is expected.
    pub fn values(&self) -> Vec<Option<f64>> {
        self.pairs.iter().zip(&self.expected).map(|(p, e)| (*e > 0.0).then(|| p / e)).collect()
    }
}

/// The overlap of a rectangle with its shifted copy, averaged over all directions, as a polynomial in the
/// distance.
struct Covariance {
    area: f64,
    linear: f64,
    square: f64,
    /// Largest distance at which it is valid.
    limit: f64,
}

impl Covariance {
    fn new(layout: &Layout) -> Self {
        let [w, h] = layout.size;
        let [x, y] = layout.period().map(|p| p.is_some());
        // Each axis that does not repeat takes away |r cos| or |r sin|.
        let linear = if x { 0.0 } else { h } + if y { 0.0 } else { w };
        let along = |side: f64, wraps: bool| if wraps { side / 2.0 } else { side };
        Self {
            area: w * h,
            linear: -2.0 / PI * linear,
            square: if x || y { 0.0 } else { 1.0 / PI },
            limit: along(w, x).min(along(h, y)),
        }
    }

    /// Share of all pairs that are expected at distances between two.
    fn share(&self, from: f64, to: f64) -> f64 {
        let integral = |r: f64| {
            let r2 = r * r;
            2.0 * PI * (self.area * r2 / 2.0 + self.linear * r2 * r / 3.0 + self.square * r2 * r2 / 4.0)
        };
        (integral(to) - integral(from)) / (self.area * self.area)
    }
}

/// Calls `visit(a, b, distance)` for every pair of points not further apart than `reach`, in both
/// orders. `points` are sorted by x; `reach` is at most half of a period.
fn for_pairs(
    points: &[(usize, [f64; 2])],
    period: [Option<f64>; 2],
    reach: f64,
    mut visit: impl FnMut(usize, usize, f64),
) {
    let shifted = |by: f64| points.iter().map(move |&(c, p)| (c, [p[0] + by, p[1]]));
    // Only those near the border are needed again beyond the other one.
    let images: Vec<(usize, [f64; 2])> = match period[0] {
        Some(w) => {
            let before = shifted(-w).filter(|(_, p)| p[0] >= -reach);
            let after = shifted(w).filter(|(_, p)| p[0] <= w + reach);
            before.chain(shifted(0.0)).chain(after).collect()
        }
        None => shifted(0.0).collect(),
    };
    let own = images.partition_point(|(_, p)| p[0] < 0.0);
    for (i, &(a, p)) in points.iter().enumerate() {
        let start = images.partition_point(|(_, q)| q[0] < p[0] - reach);
        for (j, &(b, q)) in images.iter().enumerate().skip(start) {
            if q[0] > p[0] + reach {
                break;
            }
            let dy = (q[1] - p[1]).abs();
            let dy = period[1].map_or(dy, |h| dy.min(h - dy));
            let distance = libm::sqrt((q[0] - p[0]) * (q[0] - p[0]) + dy * dy);
            if j != own + i && distance <= reach {
                visit(a, b, distance);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Centre;
    use super::*;
    use crate::element::ElementId;
    use crate::scene::Tile;
    use vtex_base::sampling::{Stream, stream};

    fn layout(size: [f64; 2], torus: bool, points: &[(u16, [f64; 2])]) -> Layout {
        let centre = |&(category, at): &(u16, [f64; 2])| Centre {
            library: LibraryId(0),
            source: ElementId(0),
            category: CategoryId(category),
            at,
        };
        Layout { size, tile: Tile { x: torus, y: torus }, centres: points.iter().map(centre).collect() }
    }

    fn scatter(size: [f64; 2], n: usize, random: &mut Stream) -> Vec<(u16, [f64; 2])> {
        (0..n).map(|i| ((i % 3) as u16, size.map(|s| random.range(0.0, s)))).collect()
    }

    fn ids<const N: usize>(categories: [u16; N]) -> [CategoryId; N] {
        categories.map(CategoryId)
    }

    /// Curves of many random scatters together.
    fn poisson(torus: bool, tile: Option<Tile>) -> PairCorrelations {
        let (size, mut sum) = ([30.0, 12.0], None::<PairCorrelations>);
        let mut random = stream(1, "correlation test", u64::from(torus));
        for _ in 0..60 {
            let mut layout = layout(size, torus, &scatter(size, 240, &mut random));
            layout.tile = tile.unwrap_or(layout.tile);
            let one = PairCorrelations::new(&layout, LibraryId(0), &ids([0, 1, 2]), 1.5);
            match &mut sum {
                Some(sum) => sum.add(&one),
                None => sum = Some(one),
            }
        }
        sum.unwrap()
    }

    #[test]
    fn a_random_scatter_has_no_correlation_at_any_distance() {
        // Also at distances of half the rectangle, where most pairs are lost over its edges.
        for tile in [Some(Tile { x: true, y: false }), None] {
            for torus in [false, true] {
                let found = poisson(torus, tile);
                assert_eq!(found.curves.len(), 6);
                for curve in &found.curves {
                    for (k, g) in curve.values().into_iter().enumerate() {
                        let error = 4.0 / libm::sqrt(curve.expected[k]);
                        assert!((g.unwrap() - 1.0).abs() < error, "{torus} {k} {g:?} {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn two_random_scatters_differ_by_noise_alone() {
        let mut random = stream(2, "correlation test", 2);
        let size = [30.0; 2];
        let mut sums = [0.0; 2];
        for _ in 0..40 {
            let [a, b] = [400, 900].map(|n| {
                PairCorrelations::new(
                    &layout(size, false, &scatter(size, n, &mut random)),
                    LibraryId(0),
                    &ids([0, 1, 2]),
                    1.0,
                )
            });
            let d = a.difference(&b).unwrap();
            sums[0] += d.rms * d.rms;
            sums[1] += d.noise * d.noise;
        }
        assert!((sums[0] / sums[1] - 1.0).abs() < 0.1, "{sums:?}");
    }

    #[test]
    fn a_lattice_has_its_peaks() {
        let points: Vec<(u16, [f64; 2])> =
            (0..900).map(|i| (0, [f64::from(i % 30) + 0.5, f64::from(i / 30) + 0.5])).collect();
        for torus in [false, true] {
            let g = PairCorrelations::new(&layout([30.0; 2], torus, &points), LibraryId(0), &ids([0]), 1.0)
                .curves[0]
                .values();
            let g: Vec<f64> = g.into_iter().map(Option::unwrap).collect();
            // Bins of 0.25: none below 1, four at 1, four at √2, none from 1.5 to 2, four at 2.
            let density = |k: usize, pairs: f64| {
                let (from, to) = (0.25 * k as f64, 0.25 * (k + 1) as f64);
                pairs / (PI * (to * to - from * from))
            };
            for (k, wanted) in [(0, 0.0), (3, 0.0), (4, 4.0), (5, 4.0), (6, 0.0), (7, 0.0)] {
                assert!((g[k] - density(k, wanted)).abs() < 0.15, "{torus} {k} {} {wanted}", g[k]);
            }
            // √5 twice four, and 2 itself.
            assert!((g[8] - density(8, 12.0)).abs() < 0.15, "{}", g[8]);
        }
    }

    #[test]
    fn a_hard_core_is_empty_and_categories_are_told_apart() {
        use vtex_base::sampling::{Area, poisson_disk};
        let mut random = stream(3, "correlation test", 3);
        let discs = poisson_disk(Area::plane(40.0, 40.0), 1.0, &mut random);
        // Every third disc has a companion of another category beside it.
        let mut points: Vec<(u16, [f64; 2])> = discs.iter().map(|p| (4, *p)).collect();
        points.extend(discs.iter().step_by(3).map(|p| (2, [p[0] + 0.1, p[1]])));
        let found =
            PairCorrelations::new(&layout([40.0; 2], false, &points), LibraryId(0), &ids([4, 2]), 1.0);
        assert_eq!(
            found.curves.iter().map(|c| c.categories).collect::<Vec<_>>(),
            [ids([4, 4]), ids([4, 2]), ids([2, 2])]
        );
        let values = |i: usize| found.curves[i].values();
        assert!(values(0)[..4].iter().all(|g| *g == Some(0.0)));
        assert!(values(0)[4].unwrap() > 1.2);
        assert!(values(1)[0].unwrap() > 2.0, "{:?}", values(1));
        assert!(values(2)[..4].iter().all(|g| *g == Some(0.0)));
        // Equal curves have distance 0, those of shuffled categories have not.
        assert_eq!(found.difference(&found).unwrap().rms, 0.0);
        let mixed: Vec<(u16, [f64; 2])> =
            points.iter().map(|p| (if random.chance(0.25) { 2 } else { 4 }, p.1)).collect();
        let other = PairCorrelations::new(&layout([40.0; 2], false, &mixed), LibraryId(0), &ids([4, 2]), 1.0);
        let apart = found.difference(&other).unwrap();
        assert!(apart.rms > 2.0 * apart.noise, "{apart:?}");
    }

    #[test]
    fn nothing_and_too_little_have_no_difference() {
        let empty = PairCorrelations::new(&layout([10.0; 2], true, &[]), LibraryId(0), &ids([0, 1]), 1.0);
        assert_eq!(empty.difference(&empty), None);
        // Distances too large for the canvas.
        let point = [(0, [1.0, 1.0]), (0, [2.0, 2.0])];
        let small = PairCorrelations::new(&layout([3.0; 2], false, &point), LibraryId(0), &ids([0]), 100.0);
        assert_eq!(small.curves[0].values(), vec![None; BINS]);
        let none = PairCorrelations::new(&layout([3.0; 2], false, &point), LibraryId(0), &ids([0]), 0.0);
        assert_eq!(none.difference(&none), None);
    }
}
