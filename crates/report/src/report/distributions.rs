//! Distributions of sizes and distances in the exemplar and in the result.

use super::groups::ReportGroup;
use super::neighbours::nearest;
use serde::Serialize;
use vtex_scene::library::Library;
use vtex_scene::scene::{CategoryId, Instance, LibraryId, Role, Scene};
use vtex_scene::statistics::{Layout, PairCorrelations, largest_categories, neighbour_distance};

/// Largest number of bins in a histogram.
const BINS: usize = 24;
/// Smallest value on a logarithmic axis. Areas of outlines are hardly ever below it.
const LEAST: f64 = 0.01;
/// Largest number of categories whose pairs are shown.
const CATEGORIES: usize = 5;

/// A binned distribution of the exemplar, of the result, or of both.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct BinnedDistribution {
    /// Title of the diagram.
    title: String,
    /// Numbers of the two categories of a pair correlation; `None` for other distributions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) categories: Option<[u32; 2]>,
    /// Label of the x axis, with its unit.
    x: &'static str,
    /// Label of the y axis, with its unit.
    y: &'static str,
    /// Whether x is logarithmic.
    logarithmic: bool,
    /// The value of y that chance would give, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    neutral: Option<f64>,
    /// Borders of the bins along x, one more than there are bins.
    pub(super) edges: Vec<f64>,
    /// The exemplar's value in each bin; `None` where it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) exemplar: Option<Vec<Option<f64>>>,
    /// The result's value in each bin; `None` where it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) result: Option<Vec<Option<f64>>>,
}

/// Values with their weights.
type Sample = Vec<(f64, f64)>;

/// All distributions of a group that are not empty.
pub(super) fn all(group: &ReportGroup<'_>, scene: Option<&Scene>) -> Vec<BinnedDistribution> {
    let library = group.library.map(|l| &l.content);
    let scene = scene.filter(|_| !group.references.is_empty());
    let layouts = [library.map(Layout::of_library), scene.map(|s| layout(s, &group.references))];
    let mut found = Vec::new();
    let sizes = |title: &str, of_library: fn(&Library) -> Sample, role: Role| {
        let samples = [library.map(of_library), scene.map(|s| areas(s, &group.references, role))];
        histogram(title, "area, px²", samples, true)
    };
    found.extend(sizes(
        "Area of primaries",
        |l| l.primaries().iter().filter(|p| !p.clipped).map(|p| (p.outline().area(), 1.0)).collect(),
        Role::Primary,
    ));
    found.extend(sizes(
        "Area of secondaries",
        |l| l.secondaries().iter().map(|s| (s.outline().area(), 1.0)).collect(),
        Role::Secondary,
    ));
    let distances = layouts.each_ref().map(|l| l.as_ref().map(nearest));
    found.extend(histogram("Distance to the nearest primary", "centre to centre, px", distances, false));
    found.extend(pairs(library, &layouts));
    found
}

/// The primaries of a scene that come from one exemplar.
fn layout(scene: &Scene, references: &[LibraryId]) -> Layout {
    let mut layout = Layout::of_scene(scene);
    layout.centres.retain(|c| references.contains(&c.library));
    layout.centres.iter_mut().for_each(|c| c.library = LibraryId::default());
    layout
}

/// Areas of the placed textons of one layer that come from one exemplar.
fn areas(scene: &Scene, references: &[LibraryId], role: Role) -> Sample {
    let own: Vec<f64> = scene
        .elements
        .iter()
        .map(|t| if references.contains(&t.library) { t.outline().area() } else { 0.0 })
        .collect();
    let area = |i: &Instance| own[i.element.index()] * i.affine().determinant().abs();
    scene.of_role(role).map(area).filter(|a| *a > 0.0).map(|a| (a, 1.0)).collect()
}

/// Histograms of two samples with common bins; `None` if both are empty.
fn histogram(
    title: &str,
    x: &'static str,
    samples: [Option<Sample>; 2],
    logarithmic: bool,
) -> Option<BinnedDistribution> {
    let value = |v: f64| if logarithmic { libm::log2(v) } else { v };
    let samples = samples.map(|s| {
        s.map(|s| {
            let valid = s.into_iter().filter(|(v, _)| v.is_finite() && (!logarithmic || *v >= LEAST));
            valid.map(|(v, w)| (value(v), w)).collect::<Sample>()
        })
    });
    let mut sorted: Vec<f64> = samples.iter().flatten().flatten().map(|s| s.0).collect();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    // A few outliers must not compress the rest.
    let last = if logarithmic { last } else { last.min(1.5 * sorted[(sorted.len() - 1) * 99 / 100]) };
    let first = if logarithmic { first } else { 0.0 };
    let step = step((last - first) / BINS as f64, logarithmic);
    let from = libm::floor(first / step);
    let count = (libm::floor(last / step) - from) as usize + 1;
    let shares = |sample: Sample| {
        let mut bins = vec![0.0; count];
        for (v, weight) in &sample {
            if let Some(bin) = bins.get_mut((libm::floor(v / step) - from).max(0.0) as usize) {
                *bin += weight;
            }
        }
        let all: f64 = sample.iter().map(|s| s.1).sum();
        bins.into_iter().map(|b| Some(rounded(if all > 0.0 { 100.0 * b / all } else { 0.0 }))).collect()
    };
    let edge = |k: usize| (from + k as f64) * step;
    let [exemplar, result] = samples.map(|s| s.map(shares));
    Some(BinnedDistribution {
        title: title.into(),
        categories: None,
        x,
        y: "share, %",
        logarithmic,
        neutral: None,
        edges: (0..=count)
            .map(|k| rounded(if logarithmic { libm::exp2(edge(k)) } else { edge(k) }))
            .collect(),
        exemplar,
        result,
    })
}

/// A rounded bin width, not below `least`.
fn step(least: f64, logarithmic: bool) -> f64 {
    if logarithmic {
        // Half and whole octaves.
        return if least <= 0.5 { 0.5 } else { libm::ceil(least) };
    }
    let least = least.max(1e-3);
    let power = libm::pow(10.0, libm::floor(libm::log10(least)));
    [1.0, 2.0, 2.5, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= least).unwrap_or(10.0 * power)
}

/// Pair correlations: of all primaries, then within and between the largest categories.
fn pairs(library: Option<&Library>, layouts: &[Option<Layout>; 2]) -> Vec<BinnedDistribution> {
    let unit = match (library, &layouts[1]) {
        (Some(library), _) => neighbour_distance(library),
        // Distance of neighbours on a square lattice of the same density.
        (None, Some(layout)) => {
            let area = layout.size[0] * layout.size[1];
            libm::sqrt(area / layout.centres.len().max(1) as f64).max(1.0)
        }
        (None, None) => return Vec::new(),
    };
    let categories = library.map_or_else(|| frequent(layouts[1].as_ref()), largest_categories);
    let merged = layouts.each_ref().map(|l| {
        l.clone().map(|mut layout| {
            layout.centres.iter_mut().for_each(|c| c.category = CategoryId::default());
            layout
        })
    });
    let mut found = curves(&merged, &[CategoryId::default()], unit);
    for distribution in &mut found {
        (distribution.title, distribution.categories) = ("Pair correlation of all primaries".into(), None);
    }
    found.extend(curves(layouts, &categories, unit));
    found
}

/// The most frequent categories, at most five.
fn frequent(layout: Option<&Layout>) -> Vec<CategoryId> {
    let mut counts = std::collections::BTreeMap::new();
    for centre in layout.iter().flat_map(|l| &l.centres) {
        *counts.entry(centre.category).or_insert(0) += 1;
    }
    let mut order: Vec<(CategoryId, i32)> = counts.into_iter().collect();
    order.sort_by_key(|&(category, count)| (-count, category));
    order.into_iter().take(CATEGORIES).map(|(category, _)| category).collect()
}

fn curves(layouts: &[Option<Layout>; 2], categories: &[CategoryId], unit: f64) -> Vec<BinnedDistribution> {
    let [exemplar, result] = layouts
        .each_ref()
        .map(|l| l.as_ref().map(|l| PairCorrelations::new(l, LibraryId::default(), categories, unit).curves));
    let count = exemplar.as_ref().or(result.as_ref()).map_or(0, Vec::len);
    let values = |curves: &Option<Vec<vtex_scene::statistics::CorrelationCurve>>, i: usize| {
        let known = curves.as_ref()?[i].values();
        Some(known.into_iter().map(|g| g.map(rounded)).collect::<Vec<_>>())
    };
    let mut found = Vec::new();
    for i in 0..count {
        let (mine, theirs) = (values(&exemplar, i), values(&result, i));
        let nothing = |v: &Option<Vec<Option<f64>>>| v.iter().flatten().all(Option::is_none);
        let pair = exemplar.as_ref().or(result.as_ref()).map(|c| c[i].categories);
        let bins = mine.as_ref().or(theirs.as_ref()).map_or(0, Vec::len);
        if bins == 0 || (nothing(&mine) && nothing(&theirs)) {
            continue;
        }
        let width = PairCorrelations::REACH * unit / bins as f64;
        found.push(BinnedDistribution {
            title: pair.map_or(String::new(), |[a, b]| format!("Category {a} around {b}")),
            categories: pair.map(|pair| pair.map(CategoryId::number)),
            x: "distance, px",
            y: "g, 1 is by chance",
            logarithmic: false,
            neutral: Some(1.0),
            edges: (0..=bins).map(|k| rounded(k as f64 * width)).collect(),
            exemplar: mine,
            result: theirs,
        });
    }
    found
}

/// Rounded to visible precision.
fn rounded(v: f64) -> f64 {
    libm::round(v * 1e3) / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(values: &[f64]) -> Option<Sample> {
        Some(values.iter().map(|v| (*v, 1.0)).collect())
    }

    fn sum(shares: &Option<Vec<Option<f64>>>) -> f64 {
        shares.iter().flatten().flatten().sum()
    }

    #[test]
    fn shares_add_up_in_common_bins() {
        for logarithmic in [false, true] {
            let values: Vec<f64> = (1..=400).map(f64::from).collect();
            let d = histogram("", "", [sample(&values), sample(&values[..7])], logarithmic).unwrap();
            assert!((sum(&d.exemplar) - 100.0).abs() < 0.1 && (sum(&d.result) - 100.0).abs() < 0.1, "{d:?}");
            assert_eq!(d.edges.len(), d.exemplar.as_ref().unwrap().len() + 1);
            assert!(d.edges.len() <= BINS + 3, "{}", d.edges.len());
            assert!(d.edges.windows(2).all(|e| e[0] < e[1]));
            assert!(d.edges[0] <= 1.0 && *d.edges.last().unwrap() > 400.0);
        }
    }

    #[test]
    fn nothing_and_one_value_are_no_trouble() {
        assert_eq!(histogram("", "", [None, None], true), None);
        assert_eq!(histogram("", "", [sample(&[]), sample(&[f64::NAN, 0.0, -1.0])], true), None);
        for v in [0.02, 3.0, 1e12] {
            for logarithmic in [false, true] {
                let d = histogram("", "", [sample(&[v]), Some(Vec::new())], logarithmic).unwrap();
                assert_eq!((sum(&d.exemplar), sum(&d.result)), (100.0, 0.0));
                assert!(d.edges.len() <= BINS + 3, "{v}: {}", d.edges.len());
            }
        }
    }

    #[test]
    fn one_far_off_does_not_press_the_others_together() {
        let mut values: Vec<f64> = (0..300).map(|i| 10.0 + f64::from(i % 10)).collect();
        values.push(1e6);
        let d = histogram("", "", [sample(&values), None], false).unwrap();
        assert!(*d.edges.last().unwrap() < 40.0, "{:?}", d.edges);
    }
}
