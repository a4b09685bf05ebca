//! Shape contexts: where a sample lies within its cluster (Belongie et al. 2001).
//!
//! A context counts the other samples of the cluster by distance (five classes, logarithmic) and direction
//! (twelve). Distances are measured by one length for each exemplar, the mean distance within its clusters. Measured by
//! the cluster's own mean, half an element would look like a whole.

/// Classes of distance and of direction.
const DISTANCES: usize = 5;
const DIRECTIONS: usize = 12;
/// Number of counts.
pub(crate) const BINS: usize = DISTANCES * DIRECTIONS;

/// Counts of a context, at most 255 each.
pub(crate) type Context = [u8; BINS];

/// Bounds of the classes of distance, in units of the exemplar's length: up to 1/8, then evenly in logarithms up to 2.
/// What is farther counts as the farthest.
const BOUNDS: [f64; DISTANCES - 1] = [0.125, 0.25, 0.5, 1.0];

fn bin(way: [f64; 2], unit: f64) -> usize {
    let far = vtex_base::geometry::plane::length(way) / unit;
    let class = BOUNDS.iter().filter(|b| far > **b).count();
    let turn = libm::atan2(way[1], way[0]) / std::f64::consts::TAU;
    let sector = (turn * DIRECTIONS as f64 + DIRECTIONS as f64 + 0.5) as usize % DIRECTIONS;
    class * DIRECTIONS + sector
}

/// The context of each point of a cluster, whose points are given by ways from any one place.
pub(crate) fn contexts(points: &[[f64; 2]], unit: f64) -> Vec<Context> {
    let mut all = vec![[0u8; BINS]; points.len()];
    for (i, p) in points.iter().enumerate() {
        for (j, q) in points.iter().enumerate() {
            if i != j {
                let count = &mut all[i][bin([q[0] - p[0], q[1] - p[1]], unit)];
                *count = count.saturating_add(1);
            }
        }
    }
    all
}

/// Mean distance of two points of one cluster, over clusters of at least two; 0 if there are none.
pub(crate) fn unit<'a>(clusters: impl Iterator<Item = &'a [[f64; 2]]>) -> f64 {
    let (mut sum, mut count) = (0.0, 0u32);
    for points in clusters.filter(|c| c.len() > 1) {
        let mut total = 0.0;
        for (i, p) in points.iter().enumerate() {
            total += points[..i]
                .iter()
                .map(|q| vtex_base::geometry::plane::length([q[0] - p[0], q[1] - p[1]]))
                .sum::<f64>();
        }
        sum += total * 2.0 / (points.len() * (points.len() - 1)) as f64;
        count += 1;
    }
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

/// A context with counts as shares.
pub(crate) fn shares(context: &Context) -> [f32; BINS] {
    let sum: u32 = context.iter().map(|c| u32::from(*c)).sum();
    let part = if sum == 0 { 0.0 } else { 1.0 / sum as f32 };
    context.map(|c| f32::from(c) * part)
}

/// Half the χ² distance of two contexts, 0 to 1: ½ Σ (a − b)² / (a + b).
pub(crate) fn difference(a: &[f32; BINS], b: &[f32; BINS]) -> f32 {
    // Eight sums, so that eight bins are computed at once.
    let mut sums = [0.0f32; 8];
    for (a, b) in a.chunks(8).zip(b.chunks(8)) {
        for k in 0..a.len() {
            let (d, s) = (a[k] - b[k], a[k] + b[k]);
            sums[k] += d * d / (s + 1e-20);
        }
    }
    0.5 * sums.iter().sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: i32, at: [f64; 2]) -> Vec<[f64; 2]> {
        let p = |k: i32| [at[0] + 7.0 * f64::from(k % side), at[1] + 7.3 * f64::from(k / side)];
        (0..side * side).map(p).collect()
    }

    #[test]
    fn equal_clusters_have_equal_contexts_wherever_they_are() {
        let (a, b) = (square(4, [0.0; 2]), square(4, [512.0, -64.0]));
        assert_eq!(contexts(&a, 15.0), contexts(&b, 15.0));
        let own = shares(&contexts(&a, 15.0)[3]);
        assert_eq!(difference(&own, &own), 0.0);
    }

    #[test]
    fn a_cut_cluster_differs() {
        let whole = square(4, [0.0; 2]);
        let unit = unit([&whole[..]].into_iter());
        let (of_whole, of_part) = (contexts(&whole, unit), contexts(&whole[..8], unit));
        let mean = (0..8).map(|k| difference(&shares(&of_whole[k]), &shares(&of_part[k]))).sum::<f32>() / 8.0;
        assert!(mean > 0.1, "{mean}");
    }

    #[test]
    fn a_lonely_sample_has_an_empty_context() {
        let alone = shares(&contexts(&[[3.0, 4.0]], 10.0)[0]);
        let other = shares(&contexts(&square(2, [0.0; 2]), 10.0)[0]);
        assert_eq!(difference(&alone, &alone), 0.0);
        assert!((difference(&alone, &other) - 0.5).abs() < 1e-6);
    }
}
