//! Categories of a drawing's elements: those similar in shape, size and colours.

use vtex_base::geometry::{Outline, SecondMoments};
use vtex_scene::library::{Category, CategoryId, ExemplarElement};

/// Features of an element, scaled so that a distance of 1 is a clear difference: Oklab of the
/// whole, logarithm of the area, compactness, elongation.
type Features = [f64; 6];

/// Initial distance within which elements are of one category.
const ALIKE: f64 = 0.7;
/// Factor by which that distance grows while there are too many categories.
const WIDER: f64 = 1.3;

/// Gives each element its category. There are at most `most` categories, numbered by the area that they cover, the
/// largest first. `shares` are the shares of the page that elements cover.
pub(super) fn categorise(elements: &mut [ExemplarElement], shares: &[f64], most: usize) -> Vec<Category> {
    let features: Vec<Features> = elements.iter().map(features).collect();
    let mut reach = ALIKE;
    let of = loop {
        match within(&features, reach, most) {
            Some(of) => break of,
            None => reach *= WIDER,
        }
    };
    let count = of.iter().max().map_or(0, |m| m + 1);
    let mut members = vec![0u32; count];
    of.iter().for_each(|&c| members[c] += 1);
    let mut covered = vec![0.0; count];
    of.iter().zip(shares).for_each(|(&c, share)| covered[c] += share);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| covered[b].total_cmp(&covered[a]).then(a.cmp(&b)));
    let mut id = vec![0; count];
    order.iter().enumerate().for_each(|(new, &old)| id[old] = new);
    let mut categories = vec![Category { name: None, centre: [0.0; 5], members: 0, coverage: 0.0 }; count];
    for ((element, &c), share) in elements.iter_mut().zip(&of).zip(shares) {
        let category = &mut categories[id[c]];
        let [r, g, b] = element.colour.to_f64();
        let own = [r, g, b, f64::from(element.area), element.compactness.unwrap_or(0.0)];
        let weight = 1.0 / f64::from(members[c]);
        (0..5).for_each(|k| category.centre[k] += weight * own[k]);
        category.members += 1;
        category.coverage += share;
        element.category = Some(CategoryId(id[c] as u16));
    }
    for category in &mut categories {
        category.coverage = category.coverage.min(1.0);
    }
    categories
}

fn features(element: &ExemplarElement) -> Features {
    let [l, a, b] = element.colour.to_oklab().map(f64::from);
    let moments = SecondMoments::new(element.outline());
    let [xx, xy, yy] = moments.covariance;
    let spread = libm::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy);
    let elongation = spread / (xx + yy).max(1e-9);
    let area = libm::log(f64::from(element.area.max(1)));
    [l * 6.0, a * 9.0, b * 9.0, area * 1.4, compactness(element.outline()) * 2.0, elongation * 1.5]
}

fn compactness(outline: &Outline) -> f64 {
    outline.compactness()
}

/// Each element goes to the first category whose first member is near; `None` if that makes too many.
fn within(features: &[Features], reach: f64, most: usize) -> Option<Vec<usize>> {
    let mut first: Vec<&Features> = Vec::new();
    let mut of = Vec::with_capacity(features.len());
    for f in features {
        let distance = |g: &Features| (0..6).map(|k| (f[k] - g[k]) * (f[k] - g[k])).sum::<f64>();
        let near = (0..first.len()).map(|c| (distance(first[c]), c)).min_by(|a, b| a.0.total_cmp(&b.0));
        match near {
            Some((d, c)) if d <= reach * reach => of.push(c),
            _ if first.len() == most => return None,
            _ => {
                of.push(first.len());
                first.push(f);
            }
        }
    }
    Some(of)
}
