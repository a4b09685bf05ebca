//! Engines and networks for tests.

use super::{EngineChoice, EngineOptions, Runtime, choose};
use std::path::PathBuf;

/// rten, and ONNX Runtime if it is found; prints a note if it is not.
pub(crate) fn engines() -> Vec<EngineOptions> {
    let with = |runtime| EngineOptions { runtime, ..EngineOptions::default() };
    let mut engines = vec![with(Runtime::Rten)];
    match choose(&with(Runtime::OnnxRuntime)) {
        Ok(EngineChoice::OnnxRuntime { .. }) => engines.push(with(Runtime::OnnxRuntime)),
        other => eprintln!("skipped: no ONNX Runtime to test ({other:?})"),
    }
    engines
}

/// A network of `tests/networks`.
pub(crate) fn network(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../../tests/networks/{name}.onnx"))
}
