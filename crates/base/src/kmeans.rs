//! Weighted k-means: k-means++ seeding, Lloyd's iterations, best of several starts.

use crate::parallel;
use crate::sampling::Stream;

const STARTS: u64 = 10;
const ROUNDS: usize = 100;

/// Points in clusters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clusters<const N: usize> {
    /// The cluster of each point.
    pub of: Vec<usize>,
    /// The centre of each cluster.
    pub centres: Vec<[f64; N]>,
}

/// At most `k` clusters of points: fewer if there are fewer different points. Weights must be above 0.
/// `random(i)` is the random stream of start `i`.
pub fn cluster<const N: usize>(
    points: &[[f64; N]],
    weights: &[f64],
    k: usize,
    random: impl Fn(u64) -> Stream + Sync,
) -> Clusters<N> {
    if points.is_empty() {
        return Clusters::default();
    }
    let starts: Vec<u64> = (0..STARTS).collect();
    let runs =
        parallel::map(&starts, |&start| lloyd(points, weights, k.min(points.len()), &mut random(start)));
    // Ties go to the first start.
    let best = runs.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
    best.map_or_else(Clusters::default, |b| b.0)
}

/// Index of the centre nearest to a point; ties go to the first.
pub fn nearest<const N: usize>(centres: &[[f64; N]], point: &[f64; N]) -> usize {
    Member::of(point, centres).cluster
}

fn distance2<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// Share by which computed bounds are widened, so that they hold in spite of rounding.
const ROUNDING: f64 = 1e-9;

/// A point's cluster, with bounds that tell whether another centre can be nearer after centres have moved
/// (Hamerly 2010, "Making k-means even faster").
#[derive(Clone)]
struct Member {
    cluster: usize,
    /// Upper bound of the distance to the cluster's centre, and lower bound of that to any other.
    own: f64,
    others: f64,
}

impl Member {
    /// Ties go to the first centre.
    fn of<const N: usize>(p: &[f64; N], centres: &[[f64; N]]) -> Self {
        let (mut best, mut second) = ((0, f64::INFINITY), f64::INFINITY);
        for (i, c) in centres.iter().enumerate() {
            let d = distance2(p, c);
            if d < best.1 {
                (best, second) = ((i, d), best.1);
            } else if d < second {
                second = d;
            }
        }
        let [own, others] = [best.1, second].map(f64::sqrt);
        Self { cluster: best.0, own: own * (1.0 + ROUNDING), others: others * (1.0 - ROUNDING) }
    }
}

/// One run: the clusters, and the weighted sum of squared distances.
fn lloyd<const N: usize>(
    points: &[[f64; N]],
    weights: &[f64],
    k: usize,
    random: &mut Stream,
) -> (Clusters<N>, f64) {
    let mut centres = vec![points[random.index(points.len())]];
    let mut far = vec![f64::INFINITY; points.len()];
    while centres.len() < k {
        let newest = centres[centres.len() - 1];
        far.iter_mut().zip(points).for_each(|(far, p)| *far = far.min(distance2(p, &newest)));
        match random.weighted(far.iter().zip(weights).map(|(far, w)| w * far)) {
            Some(i) => centres.push(points[i]),
            None => break, // fewer different points than clusters
        }
    }
    let mut members: Vec<Member> = points.iter().map(|p| Member::of(p, &centres)).collect();
    for _ in 0..ROUNDS {
        let mut sums = vec![([0.0; N], 0.0); centres.len()];
        for ((p, w), member) in points.iter().zip(weights).zip(&members) {
            let sum = &mut sums[member.cluster];
            for i in 0..N {
                sum.0[i] += w * p[i];
            }
            sum.1 += w;
        }
        let mut moves = vec![0.0; centres.len()];
        for ((centre, (sum, count)), moved) in centres.iter_mut().zip(&sums).zip(&mut moves) {
            if *count > 0.0 {
                let to = sum.map(|s| s / count);
                *moved = distance2(centre, &to).sqrt() * (1.0 + ROUNDING);
                *centre = to;
            }
        }
        let furthest = moves.iter().copied().fold(0.0, f64::max);
        let mut changed = false;
        for (p, member) in points.iter().zip(&mut members) {
            member.own += moves[member.cluster];
            member.others -= furthest;
            if member.own >= member.others {
                let next = Member::of(p, &centres);
                changed |= next.cluster != member.cluster;
                *member = next;
            }
        }
        if !changed {
            break;
        }
    }
    let assigned: Vec<usize> = members.into_iter().map(|member| member.cluster).collect();
    let error = |((p, w), &c): ((&[f64; N], &f64), &usize)| w * distance2(p, &centres[c]);
    let error = points.iter().zip(weights).zip(&assigned).map(error).sum();
    (Clusters { of: assigned, centres }, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    #[test]
    fn groups_are_found_whatever_the_seed() {
        let groups = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let point =
            |i: usize| [groups[i % 3][0] + (i % 7) as f64 * 0.01, groups[i % 3][1] + (i % 5) as f64 * 0.01];
        let points: Vec<[f64; 2]> = (0..3000).map(point).collect();
        for seed in 0..5 {
            let found = cluster(&points, &[1.0; 3000], 3, |start| stream(seed, "test", start));
            for (p, &of) in points.iter().zip(&found.of) {
                assert_eq!(nearest(&found.centres, p), of);
                assert!(distance2(p, &found.centres[of]) < 0.01, "{found:?}");
            }
        }
        let few = |points: &[[f64; 2]]| cluster(points, &[1.0; 2], 3, |start| stream(1, "test", start));
        assert_eq!(few(&[[1.0, 2.0]; 2]).centres, [[1.0, 2.0]]);
        assert!(few(&[]).of.is_empty());
    }
}
