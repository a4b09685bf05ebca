use super::*;
use crate::import::motifs::swatches::{Swatch, SwatchPlan, thirty};
use crate::import::{ImportParams, import};
use vtex_base::geometry::{Point, shortest_offset};
use vtex_scene::library::{AnalyzeParams, Grouping, Library};

fn read(svg: &str, wrap: bool, group: MotifGrouping, elements: Grouping) -> Library {
    let analyze = AnalyzeParams { group, elements, ..AnalyzeParams::default() };
    import(svg.as_bytes(), "swatch.svg", &ImportParams { wrap: Some(wrap), analyze }, &()).unwrap()
}

/// For each part of a swatch, the number of its motif, or of its element beyond those of the motifs.
fn found(swatch: &Swatch, library: &Library) -> Vec<usize> {
    let periods = [0, 1].map(|k| swatch.wrap.then_some(swatch.size[k]));
    let mut own: Vec<usize> = (0..library.elements.len()).map(|k| library.motifs.len() + k).collect();
    for (m, motif) in library.motifs.iter().enumerate() {
        motif.parts.iter().for_each(|p| own[p.element.index()] = m);
    }
    let shapes: Vec<(Point, usize)> = (library.elements.iter().enumerate())
        .flat_map(|(k, e)| e.shapes.iter().map(move |s| (s.outline.bounds().center(), k)))
        .collect();
    let nearest = |at: Point| {
        let far = |p: Point| shortest_offset(at, p, periods).hypot();
        let (place, element) = shapes.iter().min_by(|a, b| far(a.0).total_cmp(&far(b.0))).unwrap();
        assert!(far(*place) < 2.5, "no shape at {at}");
        own[*element]
    };
    swatch.parts.iter().map(|(at, _)| nearest(*at)).collect()
}

/// The adjusted Rand index of two divisions (Hubert and Arabie 1985).
fn adjusted_rand(a: &[usize], b: &[usize]) -> f64 {
    let pairs =
        |counts: BTreeMap<(usize, usize), f64>| counts.values().map(|n| n * (n - 1.0) / 2.0).sum::<f64>();
    let count = |key: &dyn Fn(usize) -> (usize, usize)| {
        let mut counts: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        (0..a.len()).for_each(|k| *counts.entry(key(k)).or_default() += 1.0);
        pairs(counts)
    };
    let (both, first, second) = (count(&|k| (a[k], b[k])), count(&|k| (a[k], 0)), count(&|k| (b[k], 0)));
    let all = a.len() as f64 * (a.len() as f64 - 1.0) / 2.0;
    let expected = first * second / all;
    (both - expected) / ((first + second) / 2.0 - expected)
}

/// Adjusted Rand indices of swatches, with elements as `how` says.
fn indices(plans: &[SwatchPlan], how: Grouping, group: MotifGrouping) -> Vec<f64> {
    let index = |plan: &SwatchPlan| {
        let swatch = plan.drawn();
        let library = read(&swatch.svg, swatch.wrap, group, how);
        let known: Vec<usize> = swatch.parts.iter().map(|p| p.1).collect();
        let index = adjusted_rand(&known, &found(&swatch, &library));
        println!("{index:.3} {:?} {plan:?}", library.motif_sizes());
        index
    };
    let all: Vec<f64> = plans.iter().map(index).collect();
    println!("{how:?}, {group:?}: mean {:.3}", all.iter().sum::<f64>() / all.len() as f64);
    all
}

#[test]
fn known_groups_of_thirty_swatches_are_found() {
    // Pieces that are very near each other are one element already; with pieces as elements none are.
    for (how, seed) in [(Grouping::Auto, 0), (Grouping::Piece, 1000)] {
        let all = indices(&thirty(seed), how, MotifGrouping::Auto);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        assert!(mean >= 0.95 && all.iter().all(|v| *v >= 0.7), "{how:?}: {mean} {all:?}");
    }
    let alone = indices(&thirty(1000)[..5], Grouping::Piece, MotifGrouping::None);
    assert!(alone.iter().all(|v| *v < 0.05), "{alone:?}");
}
