//! Properties of the search.

use super::*;
use vtex_base::document::Document;
use vtex_base::error::Error;
use vtex_scene::library::testing::{library, mosaic};

fn params(seed: u64, evaluations: u32) -> TuneParams {
    let synth = SynthParams { width: 120, height: 100, seed, ..SynthParams::default() };
    TuneParams { synth, seeds: 1, evaluations }
}

#[test]
fn what_is_found_is_valid_and_no_worse() {
    let library = library(&mosaic(120, 14.0, 0.8, 1));
    // Weights that refuse nearly everything leave all to density.
    let mut params = params(1, 40);
    params.synth.weights =
        Weights { empty: -9.0, mismatched: -9.0, same_overlap: -9.0, ..Weights::default() };
    let found = tune(&library, &params, &()).unwrap();
    assert_eq!(found.validate(), Ok(()));
    assert_eq!(TunedWeights::from_bytes(found.to_json(), "x").unwrap(), found);
    assert!(found.after.objective() < 0.9 * found.before.objective(), "{found:?}");
    assert!((40..48).contains(&found.evaluations));
    assert_eq!(found.weights.target, 0.5);
    assert!(found.weights.empty < 0.0 && found.weights.mismatched < 0.0);
}

#[test]
fn same_weights_on_any_number_of_threads() {
    let library = library(&mosaic(100, 14.0, 0.8, 2));
    let with = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| tune(&library, &params(seed, 16), &()).unwrap())
    };
    assert_eq!(with(1, 3), with(4, 3));
    assert_ne!(with(1, 3).before, with(1, 4).before);
}

#[test]
fn bad_parameters_are_refused_and_without_textons_nothing_changes() {
    let mut library = library(&mosaic(100, 14.0, 0.8, 2));
    for wrong in [TuneParams { seeds: 0, ..params(1, 10) }, params(1, 9)] {
        assert!(matches!(tune(&library, &wrong, &()), Err(Error::Parameter { .. })));
    }
    library.elements.iter_mut().for_each(|p| p.clipped = true);
    let found = tune(&library, &params(1, 10), &()).unwrap();
    assert_eq!((found.weights, found.after), (Weights::default(), found.before));
}

#[test]
fn asked_to_stop_it_stops() {
    struct StopEarly;
    impl Progress for StopEarly {
        fn advance(&self, stage: &'static str, done: u64, _: u64) -> bool {
            assert_eq!(stage, STAGE);
            done < 8
        }
    }
    let library = library(&mosaic(100, 14.0, 0.8, 2));
    assert!(matches!(tune(&library, &params(1, 100), &StopEarly), Err(Error::Interrupted)));
}

#[test]
fn coordinates_of_the_search_are_weights_and_back() {
    let begin = Weights { uncovered: -0.4, empty: 0.3, mismatched: 0.0, ..Weights::default() };
    let back = at(&begin, coordinates(&begin));
    assert_eq!((back.target, back.uncovered, back.empty, back.same_overlap), (0.5, -0.4, 0.3, -0.5));
    // Nothing vanishes, and nothing leaves the range.
    let far = at(&begin, [99.0, -99.0, 99.0, f64::INFINITY]);
    let params = SynthParams { weights: far.clone(), ..SynthParams::default() };
    assert!(params.validate().is_ok() && far.empty > 0.0, "{far:?}");
}
