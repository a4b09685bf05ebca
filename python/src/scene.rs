//! Scenes.

use crate::document::{self, Category};
use crate::editing::TextOperation;
use crate::pictures::Named;
use crate::run::{run, warn};
use crate::writing::{WritingOptions, from_json, json, kind_of};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::edit::{self, Files};
use vtex::output::file::{FileKind, Format};
use vtex::output::{self, png};
use vtex::{Error, scene};

/// A synthesised texture.
#[pyclass(frozen, module = "vtex._vtex")]
pub(crate) struct Scene {
    pub(crate) inner: Arc<scene::Scene>,
}

impl From<scene::Scene> for Scene {
    fn from(scene: scene::Scene) -> Self {
        Self { inner: Arc::new(scene) }
    }
}

#[pymethods]
impl Scene {
    #[staticmethod]
    fn read(py: Python<'_>, named: Named) -> PyResult<Self> {
        document::read::<scene::Scene>(py, named).map(Self::from)
    }

    fn content(&self, py: Python<'_>, pack: bool) -> PyResult<Py<PyBytes>> {
        document::content(py, &*self.inner, pack)
    }

    fn equals(&self, py: Python<'_>, other: &Self) -> bool {
        document::equal(py, &self.inner, &other.inner)
    }

    /// The bytes of a file whose name has this ending, with its dot.
    fn encode(&self, py: Python<'_>, ending: &str, options: &str) -> PyResult<Py<PyBytes>> {
        let options: WritingOptions = from_json(py, options, "scene")?;
        let kind = kind(py, Path::new(&format!("scene{ending}")))?;
        let (bytes, warnings) = run(py, None, |progress| options.bytes(&self.inner, kind, progress))?;
        warnings.iter().try_for_each(|warning| warn(py, warning))?;
        Ok(PyBytes::new(py, &bytes).unbind())
    }

    /// Writes a file of the format that its name asks for; the number of bytes.
    fn save(&self, py: Python<'_>, path: PathBuf, options: &str, force: bool) -> PyResult<u64> {
        let options: WritingOptions = from_json(py, options, "scene")?;
        let kind = kind(py, &path)?;
        let (bytes, warnings) =
            run(py, None, |progress| options.save(&self.inner, (&path, kind), force, progress))?;
        warnings.iter().try_for_each(|warning| warn(py, warning))?;
        Ok(bytes)
    }

    /// Pixels: height × width × 3 over white, or × 4 with opacity.
    fn render<'py>(&self, py: Python<'py>, options: &str, alpha: bool) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let options: WritingOptions = from_json(py, options, "render")?;
        let (values, width, height) = run(py, None, |progress| {
            let pixmap = png::render_page(&*options.scene(&self.inner)?, options.scale, progress)?;
            let (width, height) = (pixmap.width() as usize, pixmap.height() as usize);
            let values = if alpha { png::straight(&pixmap, 4) } else { png::over_white(&pixmap).into_raw() };
            Ok((values, width, height))
        })?;
        // The array takes ownership of the pixels.
        PyArray1::from_vec(py, values).reshape([height, width, if alpha { 4 } else { 3 }])
    }

    /// Applies operations one after the other. Returns the scene and, for each operation, the number of
    /// elements that it applied to.
    fn edit(
        &self,
        py: Python<'_>,
        operations: &str,
        files: BTreeMap<String, PyBackedBytes>,
        seed: Option<u64>,
    ) -> PyResult<(Self, Vec<usize>)> {
        let asked: Vec<TextOperation> = from_json(py, operations, "edit")?;
        let operations = asked.into_iter().map(|a| a.operation(py)).collect::<PyResult<Vec<_>>>()?;
        let (scene, outcomes) = run(py, None, |_| {
            let canvas = [self.inner.width, self.inner.height];
            let read = |name: &str| match files.get(name) {
                Some(bytes) => Ok(bytes.to_vec()),
                None => std::fs::read(name).map_err(|e| Error::read(Path::new(name), e)),
            };
            let files = Files::read(&operations, canvas, read)?;
            edit::apply((*self.inner).clone(), &operations, &files, seed)
        })?;
        for (operation, outcome) in operations.iter().zip(&outcomes) {
            if outcome.matched == 0 {
                warn(py, &format!("'{operation}' matches nothing: the scene stays as it was"))?;
            }
        }
        Ok((scene.into(), outcomes.iter().map(|outcome| outcome.matched).collect()))
    }

    #[getter]
    fn width(&self) -> u32 {
        self.inner.width
    }

    #[getter]
    fn height(&self) -> u32 {
        self.inner.height
    }

    #[getter]
    fn page(&self) -> Option<(String, String)> {
        self.inner.page.map(|[width, height]| (width.to_string(), height.to_string()))
    }

    #[getter]
    fn seed(&self) -> Option<u64> {
        self.inner.parameters.as_ref().map(|p| p.seed)
    }

    #[getter]
    fn tile(&self) -> (bool, bool) {
        (self.inner.tile.x, self.inner.tile.y)
    }

    #[getter]
    fn exemplars(&self) -> Vec<&str> {
        self.inner.libraries.iter().map(|l| l.exemplar.as_str()).collect()
    }

    #[getter]
    fn elements(&self) -> usize {
        self.inner.elements.len()
    }

    #[getter]
    fn instances(&self) -> usize {
        self.inner.count()
    }

    #[getter]
    fn categories(&self, py: Python<'_>) -> PyResult<Vec<Category>> {
        run(py, None, |_| {
            let covered = output::coverage(&self.inner);
            let pixels = output::inside(&self.inner).max(1) as f64;
            let listed = output::categories(&self.inner).into_iter().map(|c| {
                let own = covered.get(&(c.library, c.category)).copied().unwrap_or(0);
                let share = own as f64 / pixels;
                (
                    c.name,
                    c.colour.to_string(),
                    c.elements,
                    share,
                    c.category.number() as usize,
                    c.library.index(),
                )
            });
            Ok(listed.collect())
        })
    }

    #[getter]
    fn layers(&self) -> Vec<(&str, &str, usize)> {
        self.inner.layers.iter().map(|l| (&*l.name, l.role.name(), l.instances.len())).collect()
    }

    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<String> {
        json(py, &self.inner.parameters)
    }

    #[getter]
    fn edits(&self, py: Python<'_>) -> PyResult<String> {
        json(py, &self.inner.edits)
    }
}

/// The kind of file for a name.
fn kind(py: Python<'_>, path: &Path) -> PyResult<FileKind> {
    kind_of(py, path, Format::is_of_scene, "says no format that a scene is written in")
}
