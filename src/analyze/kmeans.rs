//! Weighted k-means: k-means++ seeding, Lloyd's iterations, best of several starts.

use crate::sampling::Stream;

const STARTS: u64 = 10;
const ROUNDS: usize = 100;

/// The cluster of each point, from at most `k` clusters. Weights must be above 0. `random(i)` is the
/// random stream of start `i`.
pub(super) fn cluster<const N: usize>(
    points: &[[f64; N]],
    weights: &[f64],
    k: usize,
    random: impl Fn(u64) -> Stream + Sync,
) -> Vec<usize> {
    if points.is_empty() {
        return Vec::new();
    }
    let starts: Vec<u64> = (0..STARTS).collect();
    let runs = crate::parallel::map(&starts, |&start| {
        lloyd(points, weights, k.min(points.len()), &mut random(start))
    });
    // Ties go to the first start.
    let best = runs.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
    best.map_or_else(Vec::new, |b| b.0)
}

fn distance2<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

fn nearest<const N: usize>(p: &[f64; N], centres: &[[f64; N]]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (i, c) in centres.iter().enumerate() {
        let d = distance2(p, c);
        if d < best.1 {
            best = (i, d);
        }
    }
    best
}

/// One run: the cluster of each point, and the sum of squared distances.
fn lloyd<const N: usize>(
    points: &[[f64; N]],
    weights: &[f64],
    k: usize,
    random: &mut Stream,
) -> (Vec<usize>, f64) {
    let mut centres = vec![points[random.index(points.len())]];
    while centres.len() < k {
        let far = points.iter().zip(weights).map(|(p, w)| w * nearest(p, &centres).1);
        match random.weighted(far.collect::<Vec<_>>()) {
            Some(i) => centres.push(points[i]),
            None => break, // fewer different points than clusters
        }
    }
    let mut assigned: Vec<usize> = points.iter().map(|p| nearest(p, &centres).0).collect();
    for _ in 0..ROUNDS {
        let mut sums = vec![([0.0; N], 0.0); centres.len()];
        for ((p, w), &c) in points.iter().zip(weights).zip(&assigned) {
            for i in 0..N {
                sums[c].0[i] += w * p[i];
            }
            sums[c].1 += w;
        }
        for (centre, (sum, count)) in centres.iter_mut().zip(&sums) {
            if *count > 0.0 {
                *centre = sum.map(|s| s / count);
            }
        }
        let next: Vec<usize> = points.iter().map(|p| nearest(p, &centres).0).collect();
        if next == assigned {
            break;
        }
        assigned = next;
    }
    let error = |((p, w), &c): ((&[f64; N], &f64), &usize)| w * distance2(p, &centres[c]);
    let error = points.iter().zip(weights).zip(&assigned).map(error).sum();
    (assigned, error)
}
