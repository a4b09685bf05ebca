//! Libraries.

use crate::document::{self, Category};
use crate::pictures::Named;
use crate::run::run;
use crate::writing::{json, kind_of, save_document};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Arc;
use vtex::library::{self, SourceKind};
use vtex::output::file::Format;

/// The result of the analysis of an exemplar.
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
    fn read(py: Python<'_>, named: Named) -> PyResult<Self> {
        document::read::<library::Library>(py, named).map(Self::from)
    }

    fn content(&self, py: Python<'_>, pack: bool) -> PyResult<Py<PyBytes>> {
        document::content(py, &*self.inner, pack)
    }

    fn equals(&self, py: Python<'_>, other: &Self) -> bool {
        document::equal(py, &self.inner, &other.inner)
    }

    /// Writes a file; the number of bytes.
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<u64> {
        let kind = kind_of(py, &path, |format| format == Format::Library, "is not that of a library")?;
        run(py, None, |_| save_document(&path, kind, force, &self.inner.to_json()))
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
    fn categories(&self) -> Vec<Category> {
        let named = self.inner.categories.iter().zip(self.inner.category_names()).enumerate();
        let listed = named.map(|(index, (category, name))| {
            let colour = category.colour().to_string();
            (name, colour, category.members as usize, category.coverage, index + 1, 0)
        });
        listed.collect()
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
        json(py, &self.inner.source.parameters)
    }
}
