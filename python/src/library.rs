//! Libraries.

use crate::errors;
use crate::pictures::Named;
use crate::run::run;
use crate::writing::{gzipped, save};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::Error;
use vtex::library::{self, SourceKind};
use vtex::output::file::{Format, Kind};

/// What analysis knows of an exemplar.
#[pyclass(frozen, module = "vtex._vtex")]
pub(crate) struct Library {
    pub(crate) inner: Arc<library::Library>,
}

impl From<library::Library> for Library {
    fn from(library: library::Library) -> Self {
        Self { inner: Arc::new(library) }
    }
}

#[pymethods]
impl Library {
    #[staticmethod]
    fn from_bytes(py: Python<'_>, named: Named) -> PyResult<Self> {
        let (name, bytes) = named;
        run(py, None, move |_| library::Library::from_bytes(&bytes[..], &name)).map(Self::from)
    }

    fn json(&self, py: Python<'_>) -> Py<PyBytes> {
        let json = py.detach(|| self.inner.to_json());
        PyBytes::new(py, &json).unbind()
    }

    fn gzip(&self, py: Python<'_>) -> PyResult<Py<PyBytes>> {
        let packed = py.detach(|| gzipped(&self.inner.to_json()));
        Ok(PyBytes::new(py, &packed.map_err(|e| errors::raised(py, &e))?).unbind())
    }

    /// Writes a file; the number of bytes.
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<u64> {
        let Some(Kind { format: Format::Library, gzip }) = Kind::from_path(&path) else {
            let message = format!("the name of '{}' is not that of a library", path.display());
            return Err(errors::input(py, &message, Some("names end in .lib.json or .lib.json.gz")));
        };
        run(py, None, |_| {
            let json = self.inner.to_json();
            let fail = |e| Error::write(Path::new("-"), e);
            save(&path, force, gzip, |out| out.write_all(&json).map_err(fail))
        })
    }

    fn equals(&self, py: Python<'_>, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || py.detach(|| self.inner == other.inner)
    }

    #[getter]
    fn width(&self) -> u32 {
        self.inner.source.width
    }

    #[getter]
    fn height(&self) -> u32 {
        self.inner.source.height
    }

    #[getter]
    fn file(&self) -> &str {
        &self.inner.source.file
    }

    #[getter]
    fn drawing(&self) -> bool {
        self.inner.source.kind == SourceKind::Drawing
    }

    #[getter]
    fn periodic(&self) -> bool {
        self.inner.arrangement.periodic
    }

    #[getter]
    fn coverage(&self) -> f64 {
        self.inner.coverage
    }

    #[getter]
    fn elements(&self) -> usize {
        self.inner.elements.len()
    }

    #[getter]
    fn primaries(&self) -> usize {
        self.inner.primaries().len()
    }

    #[getter]
    fn categories(&self) -> usize {
        self.inner.categories.len()
    }

    #[getter]
    fn layers(&self) -> Vec<(&str, &str, usize)> {
        self.inner.layers.iter().map(|l| (&*l.name, l.role.name(), l.instances.len())).collect()
    }

    #[getter]
    fn warnings(&self) -> &[String] {
        &self.inner.source.warnings
    }

    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<String> {
        crate::writing::json(py, &self.inner.source.parameters)
    }
}
