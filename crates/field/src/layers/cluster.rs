//! k-means of colours.

use vtex_base::sampling::stream;

/// Largest number of samples that centres are fitted to.
const SAMPLES: usize = 20_000;
/// Starts, of which the best is kept.
const STARTS: u64 = 6;
/// Most iterations.
const ITERATIONS: usize = 25;

/// `count` centres of points by k-means++ (Arthur and Vassilvitskii 2007) with the least squared distance;
/// fewer if there are fewer distinct points.
pub(super) fn centres(points: &[[f32; 3]], count: usize, seed: u64) -> Vec<[f32; 3]> {
    let mut best: Option<(f64, Vec<[f32; 3]>)> = None;
    // The samples are the same for all seeds. Only the starts differ.
    let count_of_samples = points.len().min(SAMPLES);
    let mut place = stream(0, "layers/samples", 0);
    let sample = |k: usize| {
        let [from, to] = [k, k + 1].map(|k| k * points.len() / count_of_samples);
        points[from + place.index(to - from)]
    };
    let samples: Vec<[f32; 3]> = (0..count_of_samples).map(sample).collect();
    for start in 0..STARTS {
        let mut random = stream(seed, "layers/clusters", start);
        let Some(&first) = samples.get(random.index(samples.len())) else { return Vec::new() };
        let mut found = vec![first];
        while found.len() < count {
            let weights: Vec<f64> = samples.iter().map(|p| nearest(&found, p).1).collect();
            let Some(next) = random.weighted(weights.iter().copied()) else { break };
            found.push(samples[next]);
        }
        for _ in 0..ITERATIONS {
            let mut sums = vec![([0f64; 3], 0usize); found.len()];
            for p in &samples {
                let (sum, n) = &mut sums[nearest(&found, p).0];
                (0..3).for_each(|c| sum[c] += f64::from(p[c]));
                *n += 1;
            }
            let moved: Vec<[f32; 3]> = sums
                .iter()
                .zip(&found)
                .map(|((sum, n), old)| if *n > 0 { sum.map(|v| (v / *n as f64) as f32) } else { *old })
                .collect();
            if moved == found {
                break;
            }
            found = moved;
        }
        let error: f64 = samples.iter().map(|p| nearest(&found, p).1).sum();
        if best.as_ref().is_none_or(|b| error < b.0) {
            best = Some((error, found));
        }
    }
    best.map_or_else(Vec::new, |b| b.1)
}

/// Index of the nearest centre and the squared distance to it; ties go to the first.
pub(super) fn nearest(centres: &[[f32; 3]], p: &[f32; 3]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (k, c) in centres.iter().enumerate() {
        let d: f32 = (0..3).map(|i| (c[i] - p[i]) * (c[i] - p[i])).sum();
        if f64::from(d) < best.1 {
            best = (k, f64::from(d));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_found_whatever_the_seed() {
        let groups = [[0.0, 0.0, 0.0f32], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let points: Vec<[f32; 3]> = (0..30_000)
            .map(|i| {
                let g = groups[i % 3];
                [g[0] + (i % 7) as f32 * 0.01, g[1] + (i % 5) as f32 * 0.01, g[2]]
            })
            .collect();
        for seed in 0..5 {
            let mut found = centres(&points, 3, seed);
            found.sort_by(|a, b| (a[0] + 2.0 * a[1]).total_cmp(&(b[0] + 2.0 * b[1])));
            for (c, g) in found.iter().zip(&groups) {
                assert!((0..3).all(|k| (c[k] - g[k]).abs() < 0.05), "{found:?}");
            }
        }
        assert_eq!(centres(&points[..1], 3, 1).len(), 1);
        assert!(centres(&[], 2, 1).is_empty());
    }
}
