//! Accuracy and size of reconstructions of an exemplar.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::{Library, Shading};
use vtex::output::{png, svg};
use vtex::scene::Scene;
use vtex::segment::Regions;
use vtex::synth;

/// A part of an exemplar.
fn exemplar() -> Exemplar {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars/terrazzo.png");
    let part = image::open(&path).unwrap().crop_imm(64, 64, 288, 288);
    let mut bytes = io::Cursor::new(Vec::new());
    part.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    Exemplar::from_bytes(&bytes.into_inner(), "terrazzo", &Limits::default()).unwrap()
}

fn analysed(exemplar: &Exemplar, params: &AnalyzeParams) -> (Library, Scene) {
    let library = analyze(exemplar, &Regions, params, &()).unwrap();
    let scene = synth::reconstruct(&library);
    (library, scene)
}

fn bytes(scene: &Scene) -> u64 {
    svg::write(scene, &svg::SvgOptions::default(), io::sink()).unwrap().bytes
}

/// Mean squared difference to the photograph, by component.
fn error(exemplar: &Exemplar, scene: &Scene) -> f64 {
    let picture = png::render(scene, 1.0).unwrap();
    let pairs = exemplar.image.pixels().zip(picture.pixels());
    let sum: f64 = pairs
        .map(|(a, b)| {
            let b = [b.red(), b.green(), b.blue()];
            (0..3).map(|c| f64::from(a.0[c].abs_diff(b[c]))).map(|d| d * d).sum::<f64>()
        })
        .sum();
    sum / (3.0 * picture.pixels().len() as f64)
}

/// Primaries, details and secondaries.
fn shapes(library: &Library) -> usize {
    let details: usize = library.primaries().iter().map(|p| p.details().len()).sum();
    library.primaries().len() + details + library.secondaries().len()
}

fn gradients(library: &Library) -> usize {
    library.primaries().iter().flat_map(|p| &p.shapes).filter(|s| s.gradient.is_some()).count()
}

#[test]
fn coarser_fidelity_makes_smaller_files_and_larger_errors() {
    let exemplar = exemplar();
    let found: Vec<(u64, f64)> = [0.1, 0.25, 0.5, 1.0, 2.0]
        .map(|fidelity| {
            let (_, scene) = analysed(&exemplar, &AnalyzeParams { fidelity, ..AnalyzeParams::default() });
            (bytes(&scene), error(&exemplar, &scene))
        })
        .to_vec();
    for pair in found.windows(2) {
        assert!(pair[1].0 < pair[0].0 && pair[1].1 > pair[0].1, "{found:?}");
    }
}

#[test]
fn gradients_tell_more_with_fewer_bytes() {
    let exemplar = exemplar();
    let of = |shading| {
        let (library, scene) = analysed(&exemplar, &AnalyzeParams { shading, ..AnalyzeParams::default() });
        (gradients(&library), error(&exemplar, &scene))
    };
    let (flat, gradual) = (of(Shading::Flat), of(Shading::Gradient));
    assert!(flat.0 == 0 && gradual.0 > 20, "{flat:?} {gradual:?}");
    assert!(gradual.1 < flat.1, "{flat:?} {gradual:?}");
}

#[test]
fn colours_and_shapes_stay_within_their_limits() {
    let exemplar = exemplar();
    let (library, _) = analysed(&exemplar, &AnalyzeParams { colors: 6, ..AnalyzeParams::default() });
    let primaries = library.primaries().iter();
    let colours: BTreeSet<_> = primaries
        .flat_map(|p| p.shapes.iter().map(|s| s.colour))
        .chain(library.secondaries().iter().map(|s| s.colour))
        .collect();
    assert!(colours.len() <= 6 && colours.len() > 2, "{colours:?}");
    assert_eq!(gradients(&library), 0);

    let (free, _) = analysed(&exemplar, &AnalyzeParams::default());
    let most = free.primaries().len() + (shapes(&free) - free.primaries().len()) / 3;
    let max_paths = most as u32;
    let (library, _) = analysed(&exemplar, &AnalyzeParams { max_paths, ..AnalyzeParams::default() });
    assert!((most * 9 / 10..=most).contains(&shapes(&library)), "{} of {most}", shapes(&library));
    assert_eq!(library.primaries().len(), free.primaries().len());
    let (library, _) = analysed(&exemplar, &AnalyzeParams { max_paths: 1, ..AnalyzeParams::default() });
    assert_eq!(shapes(&library), library.primaries().len());
    assert!(library.source.warnings.iter().any(|w| w.contains("more than the 1 paths asked for")));
}
