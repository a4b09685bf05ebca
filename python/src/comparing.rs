//! The similarity of two pictures.

use crate::library::Library;
use crate::pictures::PictureInput;
use crate::run::run;
use crate::scene::Scene;
use crate::writing::json;
use image::RgbImage;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use std::sync::Arc;
use vtex::import::is_drawing;
use vtex::output::{png, raster_svg};
use vtex::synth::reconstruct;
use vtex::{Progress, Result, library, metrics, scene};

/// An object that is a picture or can be drawn as one.
pub(crate) enum Viewed {
    Picture(PictureInput),
    Drawing(Drawing),
}

/// What can be drawn at any size.
pub(crate) enum Drawing {
    Svg(PyBackedBytes),
    Scene(Arc<scene::Scene>),
    Library(Arc<library::Library>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Viewed {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            return Ok(Self::Drawing(Drawing::Scene(scene.get().inner.clone())));
        }
        if let Ok(library) = object.cast::<Library>() {
            return Ok(Self::Drawing(Drawing::Library(library.get().inner.clone())));
        }
        Ok(match object.extract()? {
            PictureInput::Bytes(bytes) if is_drawing(&bytes) => Self::Drawing(Drawing::Svg(bytes)),
            picture => Self::Picture(picture),
        })
    }
}

impl Drawing {
    /// Its picture over white, with `scale` pixels per pixel of the canvas along each axis.
    ///
    /// # Errors
    /// Those of drawing.
    fn drawn(&self, scale: f64, name: &str, progress: &dyn Progress) -> Result<RgbImage> {
        let pixmap = match self {
            Self::Svg(bytes) => raster_svg::render_svg(bytes, scale, name, progress)?,
            Self::Scene(scene) => png::render(scene, scale)?,
            Self::Library(library) => png::render(&reconstruct(library), scale)?,
        };
        Ok(png::over_white(&pixmap))
    }
}

impl Viewed {
    /// Its picture over white; of a drawing, with one pixel per pixel of the canvas, beside the drawing itself.
    ///
    /// # Errors
    /// Those of decoding and drawing.
    fn picture(self, name: &str, progress: &dyn Progress) -> Result<(RgbImage, Option<Drawing>)> {
        match self {
            Self::Picture(picture) => Ok((picture.exemplar(name, false)?.image, None)),
            Self::Drawing(drawing) => Ok((drawing.drawn(1.0, name, progress)?, Some(drawing))),
        }
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
        let (exemplar, _) = exemplar.picture(&first, progress)?;
        let (result, drawing) = result.picture(&second, progress)?;
        let contours = match drawing {
            Some(drawing)
                if scale == 1.0 && metrics::can_compare_contours(&exemplar, result.dimensions().into()) =>
            {
                let enlarged = drawing.drawn(metrics::ENLARGED.into(), &second, progress)?;
                Some(metrics::contours(&exemplar, &enlarged, progress)?)
            }
            _ => None,
        };
        let pictures = metrics::reduced([exemplar, metrics::scaled(result, scale)?], progress);
        Ok(metrics::Metrics { contours, ..metrics::compare(&pictures[0], &pictures[1], progress)? })
    })?;
    json(py, &measured)
}
