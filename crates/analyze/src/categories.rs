//! Categories of primaries: kinds that the eye tells apart, or k-means over colour, area and compactness. Neither
//! depends on the seed of the analysis, so that names and numbers in scripts stay valid.

use super::kinds::{Features, kinds};
use std::cmp::Ordering;
use vtex_base::kmeans;
use vtex_base::sampling::stream;
use vtex_scene::library::{Categories, Category, CategoryId};

/// Colours count twice as much as area and compactness (paper §3.1.3).
const WEIGHTS: Features = [2.0, 2.0, 2.0, 1.0, 1.0];

/// Divides primaries into the wanted number of categories. See [`kinds`] and [`cluster`].
pub(super) fn divide(
    features: &[Features],
    wanted: Categories,
    image_area: f64,
) -> (Vec<CategoryId>, Vec<Category>) {
    match wanted {
        Categories::AtMost(k) => cluster(features, k as usize, image_area),
        Categories::Auto => number(&kinds(features, wanted.most()), features, image_area),
    }
}

/// Clusters primaries into at most `k` categories: k-means++ seeding, Lloyd's iterations, best of
/// ten starts. Each feature is scaled to 0..1 over the primaries, then weighted. Categories are
/// numbered by the area that they cover; none is empty. `image_area` (pixels) is the
/// denominator of their coverage.
fn cluster(features: &[Features], k: usize, image_area: f64) -> (Vec<CategoryId>, Vec<Category>) {
    if features.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let points = scale(features);
    let weights = vec![1.0; points.len()];
    let assigned = kmeans::cluster(&points, &weights, k, |start| stream(0, "analyze/categories", start)).of;
    number(&assigned, features, image_area)
}

fn scale(features: &[Features]) -> Vec<Features> {
    let (mut low, mut high) = ([f64::INFINITY; 5], [f64::NEG_INFINITY; 5]);
    for f in features {
        for i in 0..5 {
            low[i] = low[i].min(f[i]);
            high[i] = high[i].max(f[i]);
        }
    }
    let one = |f: &Features| {
        std::array::from_fn(|i| {
            let range = high[i] - low[i];
            if range > 0.0 { WEIGHTS[i] * (f[i] - low[i]) / range } else { 0.0 }
        })
    };
    features.iter().map(one).collect()
}

/// Categories that a user has given, in their order; those without primaries are left out. `of` is the given category
/// of each primary; one without joins that whose mean is nearest in its features. `None` if no primary has any.
pub(super) fn take(
    (names, of): (&[&str], &[Option<usize>]),
    features: &[Features],
    image_area: f64,
) -> Option<(Vec<CategoryId>, Vec<Category>)> {
    let points = scale(features);
    let mut sums = vec![([0.0; 5], 0.0); names.len()];
    for (point, category) in points.iter().zip(of) {
        if let Some(category) = category {
            let (sum, members) = &mut sums[*category];
            (0..5).for_each(|i| sum[i] += point[i]);
            *members += 1.0;
        }
    }
    let means = sums.iter().map(|(sum, members)| (*members > 0.0).then(|| sum.map(|v| v / members)));
    let means: Vec<Option<Features>> = means.collect();
    let nearest = |point: &Features| {
        let distance =
            |mean: &Features| (0..5).map(|i| (point[i] - mean[i]) * (point[i] - mean[i])).sum::<f64>();
        let known = means.iter().enumerate().filter_map(|(c, mean)| Some((c, distance(mean.as_ref()?))));
        known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(category, _)| category)
    };
    let assigned: Option<Vec<usize>> =
        points.iter().zip(of).map(|(point, own)| own.or_else(|| nearest(point))).collect();
    let assigned = assigned.filter(|all| !all.is_empty())?;
    let order: Vec<usize> = (0..names.len()).filter(|c| assigned.contains(c)).collect();
    let (ids, mut categories) = in_order(&order, &assigned, features, image_area);
    for (category, &k) in categories.iter_mut().zip(&order) {
        category.name = Some(names[k].to_owned());
    }
    Some((ids, categories))
}

/// Numbers clusters by the area that they cover, the largest first.
fn number(assigned: &[usize], features: &[Features], image_area: f64) -> (Vec<CategoryId>, Vec<Category>) {
    let count = assigned.iter().max().map_or(0, |m| m + 1);
    let mut areas = vec![None::<f64>; count];
    for (&c, f) in assigned.iter().zip(features) {
        *areas[c].get_or_insert(0.0) += f[3];
    }
    let mut order: Vec<usize> = (0..count).filter(|&c| areas[c].is_some()).collect();
    order.sort_by(|&a, &b| areas[b].partial_cmp(&areas[a]).unwrap_or(Ordering::Equal).then(a.cmp(&b)));
    in_order(&order, assigned, features, image_area)
}

/// Categories of clusters in an order, which has all that have members.
fn in_order(
    order: &[usize],
    assigned: &[usize],
    features: &[Features],
    image_area: f64,
) -> (Vec<CategoryId>, Vec<Category>) {
    let mut id = vec![0u16; order.iter().max().map_or(0, |most| most + 1)];
    for (new, &old) in order.iter().enumerate() {
        id[old] = new as u16;
    }
    let empty = Category { name: None, centre: [0.0; 5], members: 0, coverage: 0.0 };
    let mut categories = vec![empty; order.len()];
    for (&c, f) in assigned.iter().zip(features) {
        let category = &mut categories[usize::from(id[c])];
        for i in 0..5 {
            category.centre[i] += f[i];
        }
        category.members += 1;
        category.coverage += f[3];
    }
    for category in &mut categories {
        category.centre = category.centre.map(|v| v / f64::from(category.members));
        category.coverage /= image_area;
    }
    (assigned.iter().map(|&c| CategoryId(id[c])).collect(), categories)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_clusters_are_found() {
        let mut random = stream(5, "test", 0);
        let colours = [[200.0, 30.0, 30.0], [30.0, 200.0, 30.0], [30.0, 30.0, 200.0]];
        let features: Vec<Features> = (0..90)
            .map(|i| {
                let [r, g, b] = colours[i % 3].map(|v| v + random.range(-10.0, 10.0));
                [r, g, b, random.range(50.0, 60.0), 0.7]
            })
            .collect();
        let (ids, categories) = cluster(&features, 3, 10_000.0);
        assert_eq!(categories.len(), 3);
        for i in 3..90 {
            assert_eq!(ids[i], ids[i % 3]);
        }
        let covered: f64 = categories.iter().map(|c| c.coverage).sum();
        let area: f64 = features.iter().map(|f| f[3]).sum();
        assert!((covered - area / 10_000.0).abs() < 1e-9);
        assert!(categories.iter().all(|c| c.members == 30));
    }

    #[test]
    fn numbers_follow_the_area_covered() {
        let leaf = |v: f64, area: f64| [v, 40.0, 40.0, area, 0.7];
        // Many small ones cover less than a few large ones.
        let features = [vec![leaf(40.0, 20.0); 60], vec![leaf(240.0, 900.0); 5]].concat();
        for wanted in [Categories::Auto, Categories::AtMost(2)] {
            let (ids, categories) = divide(&features, wanted, 10_000.0);
            assert_eq!([ids[0], ids[64]], [CategoryId(1), CategoryId(0)], "{wanted}");
            assert_eq!(categories.iter().map(|c| c.members).collect::<Vec<_>>(), [5, 60]);
        }
        assert!(divide(&[], Categories::Auto, 1000.0).1.is_empty());
    }

    #[test]
    fn given_categories_keep_their_order_and_take_in_the_others() {
        let red = |v: f64| [200.0 + v, 30.0, 30.0, 50.0, 0.7];
        let blue = |v: f64| [30.0, 30.0, 200.0 + v, 50.0, 0.7];
        let features = [red(0.0), blue(0.0), red(5.0), blue(5.0), blue(9.0)];
        let names = ["sky", "gone", "brick"];
        let of = [Some(2), Some(0), None, None, Some(2)];
        let (ids, categories) = take((&names, &of), &features, 1000.0).unwrap();
        // Those without go to what they resemble; the last blue one stays where it was put.
        assert_eq!(ids, [1, 0, 1, 0, 1].map(CategoryId));
        let found: Vec<_> = categories.iter().map(|c| (c.name.as_deref(), c.members)).collect();
        assert_eq!(found, [(Some("sky"), 2), (Some("brick"), 3)]);
        assert_eq!(categories[0].centre, [30.0, 30.0, 202.5, 50.0, 0.7]);
        assert_eq!(categories[1].coverage, 0.15);
        assert!(take((&names, &[None; 5]), &features, 1000.0).is_none());
        assert!(take((&names, &[]), &[], 1000.0).is_none());
    }

    #[test]
    fn fewer_points_than_categories() {
        let same = [[1.0, 2.0, 3.0, 4.0, 0.5]; 3];
        let (ids, categories) = cluster(&same, 15, 100.0);
        assert_eq!((ids.len(), categories.len()), (3, 1));
        assert!(cluster(&[], 15, 100.0).0.is_empty());
    }
}
