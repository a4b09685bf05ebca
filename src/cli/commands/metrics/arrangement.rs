//! Comparison of a library and a scene made from it: coverage, pair correlation and repetition of elements.

use super::show::{digits, print_found};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::foreign::escaped;
use crate::cli::progress::Reporter;
use crate::cli::table::table;
use serde::Serialize;
use vtex::library::Library;
use vtex::scene::{CategoryId, LibraryId, Scene};
use vtex::statistics::{
    Difference, Groups, Layout, PairCorrelations, Repetition, largest_categories, neighbour_distance,
};

/// The report in JSON.
#[derive(Serialize)]
struct ArrangementReport {
    program: &'static str,
    command: &'static str,
    exemplar: String,
    result: String,
    /// Share of the picture that primaries cover, 0 to 1, of all and by category.
    coverage: Shares,
    categories: Vec<CategoryShares>,
    /// Repetition of the same primaries.
    repetition: Repetition,
    /// Groups whose arrangement is copied from the exemplar.
    groups: Groups,
    correlation: PairCorrelation,
    /// Mean distance between neighbouring primaries of the exemplar, in pixels.
    neighbour_distance: f64,
}

#[derive(Serialize)]
struct Shares {
    exemplar: f64,
    result: f64,
}

#[derive(Serialize)]
struct CategoryShares {
    /// Its number, from 1.
    category: u32,
    name: String,
    #[serde(flatten)]
    coverage: Shares,
}

/// Pair correlation of the centres of the largest categories.
#[derive(Serialize)]
struct PairCorrelation {
    /// Difference of the curves, and the difference that chance alone would give; `None` for too few
    /// primaries.
    #[serde(skip_serializing_if = "Option::is_none")]
    difference: Option<Difference>,
    /// Upper end of each bin of the curves, in pixels.
    distances: Vec<f64>,
    curves: Vec<CurvePair>,
}

/// Number of pairs at each distance relative to random scattering.
#[derive(Serialize)]
struct CurvePair {
    /// Their numbers, from 1.
    categories: [u32; 2],
    exemplar: Vec<Option<f64>>,
    result: Vec<Option<f64>>,
}

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    [exemplar, result]: [String; 2],
    library: &Library,
    scene: &Scene,
) -> anyhow::Result<()> {
    reporter.stage("comparing")?;
    let Some(number) = scene.libraries.iter().position(|l| l.sha256 == library.source.sha256) else {
        let message = format!("'{result}' was not made from '{exemplar}': it names another exemplar");
        return Err(Failure::failed(message).hint("give the library that the scene was made from").into());
    };
    let number = LibraryId(number as u32);
    let (coverage, categories) = coverage(library, scene, number);
    let unit = neighbour_distance(library);
    let mut layout = Layout::of_scene(scene);
    layout.centres.retain(|c| c.library == number);
    layout.centres.iter_mut().for_each(|c| c.library = LibraryId::default());
    let placeable = library.primaries().iter().filter(|p| !p.clipped).count();
    let found = ArrangementReport {
        program: vtex::PROGRAM,
        command: "metrics",
        exemplar,
        result,
        coverage,
        categories,
        repetition: Repetition::new(&layout, placeable, &[unit]),
        groups: Groups::new(&layout, &[Layout::whole(library)]),
        correlation: PairCorrelation::new(library, &layout, unit),
        neighbour_distance: unit,
    };
    reporter.finish();
    print_found(common, &found, || found.show())
}

/// Coverage of all primaries, and of each category.
fn coverage(library: &Library, scene: &Scene, number: LibraryId) -> (Shares, Vec<CategoryShares>) {
    let pixels = vtex::output::coverage(scene);
    let canvas = (vtex::output::inside(scene) as f64).max(1.0);
    let share = |category: CategoryId| pixels.get(&(number, category)).map_or(0.0, |n| *n as f64 / canvas);
    let categories: Vec<CategoryShares> = (0..)
        .map(CategoryId)
        .zip(&library.categories)
        .zip(library.category_names())
        .map(|((category, known), name)| {
            let coverage = Shares { exemplar: known.coverage, result: share(category) };
            CategoryShares { category: category.number(), name, coverage }
        })
        .collect();
    let result = categories.iter().map(|c| c.coverage.result).sum();
    (Shares { exemplar: library.coverage, result }, categories)
}

impl PairCorrelation {
    fn new(library: &Library, layout: &Layout, unit: f64) -> Self {
        let largest = largest_categories(library);
        let curves = |layout: &Layout| PairCorrelations::new(layout, LibraryId::default(), &largest, unit);
        let (wanted, got) = (curves(&Layout::of_library(library)), curves(layout));
        let bins = wanted.curves.first().map_or(0, |c| c.pairs.len());
        let end = |k: usize| (k + 1) as f64 * PairCorrelations::REACH * unit / bins as f64;
        let pairs = wanted.curves.iter().zip(&got.curves).map(|(a, b)| CurvePair {
            categories: a.categories.map(CategoryId::number),
            exemplar: a.values(),
            result: b.values(),
        });
        Self {
            difference: wanted.difference(&got),
            distances: (0..bins).map(end).collect(),
            curves: pairs.collect(),
        }
    }
}

impl ArrangementReport {
    fn show(&self) -> String {
        let mut text = format!("{} and {}\n\n", escaped(&self.exemplar), escaped(&self.result));
        let cent = |v: f64| format!("{:.1} %", v * 100.0);
        let shares = |name: String, s: &Shares| vec![name, cent(s.exemplar), cent(s.result), String::new()];
        let mut rows = vec![["coverage", "exemplar", "result", ""].map(str::to_owned).to_vec()];
        rows.push(shares("all".into(), &self.coverage));
        let categories = self.categories.iter();
        rows.extend(categories.map(|c| shares(format!("category {} {}", c.category, c.name), &c.coverage)));
        text += &table(&rows);
        text.push('\n');
        let line = |name: &str, value: String, meaning: &str| vec![name.into(), value, meaning.into()];
        let r = &self.repetition;
        let used = format!("{} of {}", r.textons, r.placeable);
        let mut rows = vec![["repetition", "", ""].map(str::to_owned).to_vec()];
        rows.push(line("primaries used", used, "different ones, of those that can be placed"));
        rows.push(line("largest share", cent(r.largest_share), "of the one placed most often"));
        rows.push(line("copies near", cent(r.near), "have a copy within two distances of neighbours"));
        if let Some(copies) = &r.copies {
            rows.push(line("shortest", format!("{:.0} px", copies.shortest), "from a copy to the next"));
            rows.push(line("median", format!("{:.0} px", copies.median), "from a copy to the next"));
        }
        let g = &self.groups;
        rows.push(line("kept", cent(g.kept), "stand among the same five neighbours as in the exemplar"));
        rows.push(line("largest group", g.largest.to_string(), "of such side by side"));
        rows.push(line("copied groups", g.copies.to_string(), "pairs with more than six in common"));
        if let Some(shortest) = g.shortest {
            rows.push(line("nearest", format!("{shortest:.0} px"), "from a group to its copy"));
        }
        rows.push(line("in windows", cent(g.windows), "of the exemplar's size a group is seen twice"));
        text += &table(&rows);
        text.push('\n');
        let mut rows = vec![["pair correlation", "", ""].map(str::to_owned).to_vec()];
        match &self.correlation.difference {
            Some(d) => {
                rows.push(line("difference", digits(d.rms), "root mean square over the largest categories"));
                rows.push(line("by chance", digits(d.noise), "of two samples of one arrangement"));
            }
            None => rows.push(line("difference", "-".into(), "there are too few primaries to tell")),
        }
        text + &table(&rows)
    }
}
