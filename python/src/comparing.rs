//! The similarity of two pictures.

use crate::library::Library;
use crate::pictures::PictureInput;
use crate::run::run;
use crate::scene::Scene;
use crate::writing::json;
use image::RgbImage;
use pyo3::prelude::*;
use std::sync::Arc;
use vtex::import::is_drawing;
use vtex::output::{png, raster_svg};
use vtex::synth::reconstruct;
use vtex::{Progress, Result, library, metrics, scene};

/// An object that can be drawn as a picture.
pub(crate) enum Viewed {
    Picture(PictureInput),
    Scene(Arc<scene::Scene>),
    Library(Arc<library::Library>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Viewed {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            return Ok(Self::Scene(scene.get().inner.clone()));
        }
        if let Ok(library) = object.cast::<Library>() {
            return Ok(Self::Library(library.get().inner.clone()));
        }
        object.extract().map(Self::Picture)
    }
}

impl Viewed {
    /// Its picture over white, with one pixel per pixel of the canvas.
    ///
    /// # Errors
    /// Those of decoding and drawing.
    fn picture(self, name: &str, progress: &dyn Progress) -> Result<RgbImage> {
        let pixmap = match self {
            Self::Picture(PictureInput::Bytes(ref bytes)) if is_drawing(bytes) => {
                raster_svg::render_svg(bytes, 1.0, name, progress)?
            }
            Self::Picture(picture) => return Ok(picture.exemplar(name)?.image),
            Self::Scene(scene) => png::render(&scene, 1.0)?,
            Self::Library(library) => png::render(&reconstruct(&library), 1.0)?,
        };
        Ok(png::over_white(&pixmap))
    }
}

/// The measures, as JSON.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    exemplar: (String, Viewed),
    result: (String, Viewed),
    scale: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let ((first, exemplar), (second, result)) = (exemplar, result);
    let measured = run(py, progress, move |progress| {
        let exemplar = exemplar.picture(&first, progress)?;
        let result = metrics::scaled(result.picture(&second, progress)?, scale)?;
        metrics::compare(&exemplar, &result, progress)
    })?;
    json(py, &measured)
}
