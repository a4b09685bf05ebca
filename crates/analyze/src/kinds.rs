//! Kinds of primaries that the eye tells apart: groups that look different, with few in between.
//!
//! Primaries are points in colour, size and compactness, in units of about one clear difference. Points are halved along
//! their longest axis as long as the halves look different. Then the pair of groups with the least evidence is joined,
//! until every pair has enough. The evidence for a pair is the distance of its means, times the ratio of that distance to
//! the spreads along it: 1.3 for the halves of a normal distribution, 1.7 for those of an even one, more across a gap.
//! Nothing is drawn at random, and the larger of two primaries counts more, by the root of its area.
//!
//! Works badly for small distinct kinds: those with less than a fiftieth of the weight join what they resemble.

use vtex_base::raster::colour::Colour;
use vtex_base::symmetric::Symmetric;

/// Red, green, blue (0 to 255), area (px), Polsby–Popper compactness (0 to 1).
pub(super) type Features = [f64; 5];

/// Lightness, the two axes of Oklab, logarithm of the area, compactness.
type Look = [f64; 5];

/// Factors from Oklab, from the natural logarithm of the area and from compactness to units of a clear difference.
const UNITS: Look = [6.0, 14.0, 14.0, 0.45, 1.0];
/// Least distance of the means of two groups that look different.
const VISIBLE: f64 = 0.6;
/// Least share of all weight of a group that is made by halving.
const LEAST_SHARE: f64 = 0.02;
/// Least evidence for two groups, and the largest ratio of distance to spread that counts in it.
const EVIDENCE: f64 = 1.7;
const CLEAR_GAP: f64 = 3.0;
/// Most rounds in which points go to the nearest mean.
const ROUNDS: usize = 50;

/// The kind of each primary, from 0 without gaps; at most `most` kinds.
pub(super) fn kinds(features: &[Features], most: usize) -> Vec<usize> {
    let looks: Vec<Look> = features.iter().map(look).collect();
    let weights: Vec<f64> = features.iter().map(|f| libm::sqrt(f[3].max(1.0))).collect();
    let cloud = Cloud { looks: &looks, weights: &weights };
    let mut groups = cloud.nearest(cloud.halved());
    join(&mut groups, &cloud, most);
    let mut of = vec![0; features.len()];
    for (kind, group) in groups.iter().enumerate() {
        group.iter().for_each(|&i| of[i] = kind);
    }
    of
}

fn look(&[r, g, b, area, compactness]: &Features) -> Look {
    let [l, a, b] = Colour::from_f64([r, g, b]).to_oklab().map(f64::from);
    let look = [l, a, b, libm::log(area.max(1.0)), compactness];
    std::array::from_fn(|k| UNITS[k] * look[k])
}

/// The points that are divided.
struct Cloud<'a> {
    looks: &'a [Look],
    weights: &'a [f64],
}

impl Cloud<'_> {
    /// Groups of points, halved as long as the halves look different and are not too small.
    fn halved(&self) -> Vec<Vec<usize>> {
        let least = LEAST_SHARE * self.weights.iter().sum::<f64>();
        let (mut open, mut done) = (vec![(0..self.looks.len()).collect::<Vec<usize>>()], Vec::new());
        while let Some(group) = open.pop() {
            let whole = self.moments(&group);
            let halves = self.halves(&group, &whole).filter(|halves| {
                let [a, b] = halves.each_ref().map(|half| self.moments(half));
                a.weight.min(b.weight) >= least && distance(&a.mean, &b.mean) >= VISIBLE
            });
            match halves {
                Some(halves) => open.extend(halves),
                None => done.push(group),
            }
        }
        done.retain(|group| !group.is_empty());
        done
    }

    /// Two halves of a group: cut across its longest axis where their spreads are least, then each point goes to the
    /// nearer mean. `None` if all points are the same.
    fn halves(&self, group: &[usize], whole: &Moments) -> Option<[Vec<usize>; 2]> {
        let axis = whole.longest_axis();
        let along = |i: usize| (0..5).map(|k| axis[k] * (self.looks[i][k] - whole.mean[k])).sum::<f64>();
        let mut sorted: Vec<(f64, usize)> = group.iter().map(|&i| (along(i), i)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (mut weight, mut sum, mut best) = (0.0, 0.0, (0.0, 0));
        for (k, pair) in sorted.windows(2).enumerate() {
            let own = self.weights[pair[0].1];
            weight += own;
            sum += own * pair[0].0;
            // The mean of all is 0, so the sums of both parts are opposite.
            let between = sum * sum * (1.0 / weight + 1.0 / (whole.weight - weight));
            if pair[0].0 < pair[1].0 && between > best.0 {
                best = (between, k + 1);
            }
        }
        let parts = [&sorted[..best.1], &sorted[best.1..]].map(|part| part.iter().map(|p| p.1).collect());
        <[Vec<usize>; 2]>::try_from(self.nearest(parts.to_vec())).ok().filter(|_| best.1 > 0)
    }

    /// The groups after their points have gone to the nearest mean until none moves; empty groups are left out.
    fn nearest(&self, mut groups: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
        for _ in 0..ROUNDS {
            let means: Vec<Look> = groups.iter().map(|group| self.moments(group).mean).collect();
            let mut points: Vec<usize> = groups.concat();
            points.sort_unstable();
            let mut next = vec![Vec::new(); groups.len()];
            for i in points {
                let far = |g: &usize| distance(&means[*g], &self.looks[i]);
                let own = (0..means.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
                next[own].push(i);
            }
            next.retain(|group| !group.is_empty());
            let is_settled = next == groups;
            groups = next;
            if is_settled {
                break;
            }
        }
        groups
    }

    fn moments(&self, group: &[usize]) -> Moments {
        let weight = group.iter().map(|&i| self.weights[i]).sum::<f64>().max(f64::MIN_POSITIVE);
        let mean = |value: &dyn Fn(&Look) -> f64| {
            group.iter().map(|&i| self.weights[i] * value(&self.looks[i])).sum::<f64>() / weight
        };
        let middle: Look = std::array::from_fn(|k| mean(&|look| look[k]));
        let covariance =
            Symmetric::new(5, |i, j| mean(&|look| (look[i] - middle[i]) * (look[j] - middle[j])));
        Moments { weight, mean: middle, covariance }
    }
}

/// The weight, the mean and the covariance of a group.
struct Moments {
    weight: f64,
    mean: Look,
    covariance: Symmetric,
}

impl Moments {
    fn longest_axis(&self) -> Look {
        let (values, vectors) = self.covariance.eigen();
        let longest = (0..5).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
        std::array::from_fn(|k| vectors.at(k, longest))
    }

    /// Root mean square distance from the mean along a direction of length 1.
    fn spread(&self, direction: &Look) -> f64 {
        let terms = (0..25).map(|k| direction[k / 5] * direction[k % 5] * self.covariance.at(k / 5, k % 5));
        libm::sqrt(terms.sum::<f64>().max(0.0))
    }

    /// The evidence that this group and another are two kinds; 0 if they do not look different.
    fn evidence(&self, other: &Self) -> f64 {
        let far = distance(&self.mean, &other.mean);
        if far < VISIBLE {
            return 0.0;
        }
        let way: Look = std::array::from_fn(|k| (other.mean[k] - self.mean[k]) / far);
        far * (far / (self.spread(&way) + other.spread(&way)).max(1e-9)).min(CLEAR_GAP)
    }
}

/// Joins the two groups with the least evidence, until all pairs have enough and there are at most `most`.
fn join(groups: &mut Vec<Vec<usize>>, cloud: &Cloud<'_>, most: usize) {
    let mut moments: Vec<Moments> = groups.iter().map(|group| cloud.moments(group)).collect();
    loop {
        let pairs = (1..groups.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let weighed = pairs.map(|[a, b]| (moments[a].evidence(&moments[b]), [a, b]));
        let Some((evidence, [a, b])) = weighed.min_by(|x, y| x.0.total_cmp(&y.0)) else { return };
        if evidence >= EVIDENCE && groups.len() <= most {
            return;
        }
        let other = groups.remove(b);
        moments.remove(b);
        groups[a].extend(other);
        groups[a].sort_unstable();
        moments[a] = cloud.moments(&groups[a]);
    }
}

fn distance(a: &Look, b: &Look) -> f64 {
    libm::sqrt((0..5).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    fn count(features: &[Features]) -> usize {
        kinds(features, 15).into_iter().max().map_or(0, |most| most + 1)
    }

    #[test]
    fn as_many_kinds_as_there_are_colours() {
        let mut random = stream(6, "test", 0);
        for colours in [1, 2, 5, 9] {
            let features: Vec<Features> = (0..40 * colours)
                .map(|i| {
                    // Hues around the grey axis, far enough apart for different names.
                    let hue = (i % colours) as f64 / colours as f64 * std::f64::consts::TAU;
                    let [r, g, b] = [0.0, 2.1, 4.2].map(|shift| 128.0 + 90.0 * libm::cos(hue - shift));
                    let noise = random.range(-8.0, 8.0);
                    [r + noise, g + noise, b + noise, random.range(50.0, 90.0), 0.7]
                })
                .collect();
            let of = kinds(&features, 15);
            assert_eq!(count(&features), colours);
            assert!((0..of.len()).all(|i| of[i] == of[i % colours]));
        }
    }

    #[test]
    fn shades_without_a_gap_are_one_kind_and_sizes_with_one_are_two() {
        let mut random = stream(7, "test", 0);
        let mut stones = |light: [f64; 2], count: usize| -> Vec<Features> {
            (0..count)
                .map(|_| {
                    let v = random.range(light[0], light[1]);
                    [v, v, v, random.range(100.0, 300.0), 0.7]
                })
                .collect()
        };
        let even = stones([100.0, 150.0], 300);
        assert_eq!(count(&even), 1);
        let gap = [even.clone(), stones([230.0, 250.0], 60)].concat();
        assert_eq!(count(&gap), 2);
        let large: Vec<Features> = even.iter().map(|&[r, g, b, area, c]| [r, g, b, 40.0 * area, c]).collect();
        let of = kinds(&[even, large].concat(), 15);
        assert!((0..600).all(|i| (of[i] == of[0]) == (i < 300)));
    }

    #[test]
    fn at_most_so_many_and_none_without_primaries() {
        let grey = |v: usize| [v as f64, v as f64, v as f64, 50.0, 0.7];
        let steps: Vec<Features> = (0..200).map(|i| grey(i % 4 * 80)).collect();
        assert_eq!((count(&steps), kinds(&steps, 2).into_iter().max()), (4, Some(1)));
        assert_eq!(kinds(&[grey(9); 3], 15), [0; 3]);
        assert!(kinds(&[], 15).is_empty());
    }
}
