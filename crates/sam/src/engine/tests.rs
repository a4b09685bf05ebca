//! Both engines on small networks and on invalid files.

use super::testing::{engines, network};
use super::*;

/// A matrix product that both engines split among threads, and its exact result: sums of small integers.
fn product(columns: usize) -> (Tensor, Tensor, Vec<f32>) {
    let number = |i: usize| ((i * 7919) % 17) as f32 - 8.0;
    let a: Vec<f32> = (0..200 * 300).map(number).collect();
    let b: Vec<f32> = (0..300 * columns).map(|i| number(i + 5)).collect();
    let mut exact = Vec::with_capacity(200 * columns);
    for i in 0..200 {
        for j in 0..columns {
            exact.push((0..300).map(|k| a[i * 300 + k] * b[k * columns + j]).sum());
        }
    }
    (Tensor::f32([200, 300], a), Tensor::f32([300, columns], b), exact)
}

#[test]
fn a_product_is_right_from_file_and_memory_with_any_threads() {
    let (a, b, exact) = product(40);
    let bytes = std::fs::read(network("product")).unwrap();
    for options in engines() {
        for threads in [None, Some(1), Some(3)] {
            let options = EngineOptions { threads, ..options.clone() };
            let path = network("product");
            for source in
                [NetworkSource::File(&path), NetworkSource::Bytes { name: "product", bytes: &bytes }]
            {
                let engine = load(source, &options).unwrap();
                let ports: Vec<String> = engine.inputs().iter().map(ToString::to_string).collect();
                assert_eq!(ports, ["a [?×300]", "b [300×?]"]);
                let found = engine.run(&[("b", &b), ("a", &a)], &["elements", "product"]).unwrap();
                assert_eq!(found[0].floats(), [8000.0]);
                assert_eq!((&found[1].shape[..], found[1].floats()), (&[200, 40][..], exact.clone()));
            }
        }
    }
}

#[test]
fn the_bits_of_a_result_do_not_depend_on_threads() {
    // Thirds do not add up exactly, so the order of summation shows.
    let third = |t: Tensor| Tensor { values: Values::F32(t.floats().iter().map(|v| v / 3.0).collect()), ..t };
    let (a, b, _) = product(333);
    let (a, b) = (third(a), third(b));
    for options in engines() {
        let run = |threads| {
            let options = EngineOptions { threads: Some(threads), ..options.clone() };
            let engine = load(NetworkSource::File(&network("product")), &options).unwrap();
            engine.run(&[("a", &a), ("b", &b)], &["product"]).unwrap()
        };
        let one = run(1);
        for threads in [2, 4, 7] {
            assert!(one == run(threads), "{:?} with {threads} threads", options.runtime);
        }
    }
}

#[test]
fn what_does_not_fit_the_graph_is_an_error() {
    let (a, b, _) = product(4);
    let short = Tensor::f32([200, 300], vec![0.0; 7]);
    let empty = Tensor::f32([0, 300], Vec::new());
    let narrow = Tensor::f32([200, 299], vec![0.0; 200 * 299]);
    let flat = Tensor::f32([300], vec![0.0; 300]);
    for options in engines() {
        let engine = load(NetworkSource::File(&network("product")), &options).unwrap();
        type Given<'a> = Vec<(&'a str, &'a Tensor)>;
        let wrong: [(Given<'_>, &[&str]); 8] = [
            (vec![("a", &a)], &["product"]),
            (vec![], &["product"]),
            (vec![("a", &a), ("c", &b)], &["product"]),
            (vec![("a", &a), ("b", &b)], &["other"]),
            (vec![("a", &short), ("b", &b)], &["product"]),
            (vec![("a", &empty), ("b", &b)], &["product"]),
            (vec![("a", &narrow), ("b", &b)], &["product"]),
            (vec![("a", &flat), ("b", &b)], &["product"]),
        ];
        for (given, wanted) in &wrong {
            let names: Vec<&str> = given.iter().map(|g| g.0).collect();
            let outcome = engine.run(given, wanted);
            // Some engines accept a vector times a matrix as a product.
            let lenient = given.first().is_some_and(|g| g.1 == &flat) && outcome.is_ok();
            let named = matches!(outcome, Err(Error::Network { .. } | Error::Engine { .. }));
            assert!(named || lenient, "{:?}: {names:?} {wanted:?}: {outcome:?}", options.runtime);
        }
    }
}

#[test]
fn files_that_are_no_networks_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(network("sam_decoder")).unwrap();
    for options in engines() {
        let missing = folder.path().join("none.onnx");
        assert!(matches!(load(NetworkSource::File(&missing), &options), Err(Error::Read { .. })));
        for name in ["a.onnx", "a.bin"] {
            for content in [&b""[..], b"hello", &[0xff; 4000], &whole[..whole.len() / 2]] {
                let path = folder.path().join(name);
                std::fs::write(&path, content).unwrap();
                let by_path = load(NetworkSource::File(&path), &options);
                let by_bytes = load(NetworkSource::Bytes { name, bytes: content }, &options);
                for outcome in [by_path, by_bytes] {
                    let error =
                        outcome.err().unwrap_or_else(|| panic!("{name}: {} bytes pass", content.len()));
                    assert!(matches!(error, Error::Network { .. } | Error::Engine { .. }), "{error}");
                    assert!(error.hint().is_some(), "{error}");
                }
            }
        }
    }
}

#[test]
fn damaged_networks_give_results_or_errors() {
    let whole = std::fs::read(network("product")).unwrap();
    let (a, b, _) = product(4);
    for options in engines() {
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x15;
            if let Ok(engine) = load(NetworkSource::Bytes { name: "damaged", bytes: &damaged }, &options) {
                let _ = engine.run(&[("a", &a), ("b", &b)], &["product", "elements"]);
            }
        }
    }
}

#[test]
fn a_library_that_is_none_is_an_error_or_makes_way_for_rten() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libonnxruntime.so");
    std::fs::write(&text, "not a library").unwrap();
    for library in [text, folder.path().join("none.so"), folder.path().to_owned()] {
        for runtime in [Runtime::Auto, Runtime::OnnxRuntime] {
            let options = EngineOptions { runtime, library: Some(library.clone()), threads: None };
            let error = choose(&options).unwrap_err();
            assert!(matches!(error, Error::Runtime { .. } | Error::Engine { .. }), "{error}");
            assert!(error.hint().is_some_and(|hint| hint.contains("pip install onnxruntime")), "{error}");
        }
        let options = EngineOptions { runtime: Runtime::Rten, library: Some(library), threads: None };
        assert_eq!(choose(&options).unwrap(), EngineChoice::Rten { because: None });
    }
    let auto = choose(&EngineOptions::default()).unwrap();
    let named = load(NetworkSource::File(&network("product")), &EngineOptions::default())
        .unwrap()
        .runtime()
        .to_owned();
    assert_eq!(
        named.starts_with("ONNX Runtime "),
        matches!(auto, EngineChoice::OnnxRuntime { .. }),
        "{named} {auto:?}"
    );
}
