//! Documents, that is, libraries and scenes: reading, comparison and conversion to bytes.

use crate::errors;
use crate::pictures::Named;
use crate::run::run;
use crate::writing::gzipped;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;
use vtex::Result;
use vtex::library::Library;
use vtex::scene::Scene;

/// A category: name, colour, number of elements, share of the picture, its number, and its library.
pub(crate) type Category = (String, String, usize, f64, usize, usize);

/// A versioned document of JSON.
pub(crate) trait Document: PartialEq + Send + Sync + Sized {
    /// Reads a document, plain or gzip.
    fn from_bytes(bytes: &[u8], name: &str) -> Result<Self>;
    fn to_json(&self) -> Vec<u8>;
}

impl Document for Library {
    fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        Self::from_bytes(bytes, name)
    }

    fn to_json(&self) -> Vec<u8> {
        self.to_json()
    }
}

impl Document for Scene {
    fn from_bytes(bytes: &[u8], name: &str) -> Result<Self> {
        Self::from_bytes(bytes, name)
    }

    fn to_json(&self) -> Vec<u8> {
        self.to_json()
    }
}

pub(crate) fn read<T: Document>(py: Python<'_>, (name, bytes): Named) -> PyResult<T> {
    run(py, None, move |_| T::from_bytes(&bytes, &name))
}

/// The document as JSON, packed if asked to.
pub(crate) fn content<T: Document>(py: Python<'_>, document: &T, pack: bool) -> PyResult<Py<PyBytes>> {
    let bytes = py.detach(|| match document.to_json() {
        json if pack => gzipped(&json),
        json => Ok(json),
    });
    Ok(PyBytes::new(py, &bytes.map_err(|e| errors::raised(py, &e))?).unbind())
}

pub(crate) fn equal<T: Document>(py: Python<'_>, one: &Arc<T>, other: &Arc<T>) -> bool {
    Arc::ptr_eq(one, other) || py.detach(|| one == other)
}
