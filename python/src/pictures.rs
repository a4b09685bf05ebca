//! Pictures from Python: encoded bytes, and arrays of pixels.

use crate::errors;
use crate::run::run;
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma, RgbImage, RgbaImage};
use numpy::{Element, PyArrayDescrMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::borrow::Cow;
use std::io::Cursor;
use std::path::PathBuf;
use vtex::Error;
use vtex::analyze::{Exemplar, Limits};

/// A picture: a file's bytes, or pixels.
pub(crate) enum PictureInput {
    Bytes(PyBackedBytes),
    Pixels(DynamicImage),
}

impl PictureInput {
    /// Converts it to an exemplar; a small one that may be a tile is repeated if it is one.
    ///
    /// # Errors
    /// Those of decoding.
    pub(crate) fn exemplar(self, name: &str, may_tile: bool) -> vtex::Result<Exemplar> {
        let limits = Limits::default();
        match (self, may_tile) {
            (Self::Bytes(bytes), true) => Exemplar::tile_from_bytes(&bytes, name, &limits),
            (Self::Bytes(bytes), false) => Exemplar::from_bytes(&bytes, name, &limits),
            (Self::Pixels(image), true) => Exemplar::tile_from_image(image, name),
            (Self::Pixels(image), false) => Exemplar::from_image(image, name),
        }
    }
}

impl PictureInput {
    /// Its bytes as those of a file: pixels as a PNG.
    ///
    /// # Errors
    /// [`Error::Decode`] for pixels that cannot be encoded.
    pub(crate) fn bytes(&self, name: &str) -> vtex::Result<Cow<'_, [u8]>> {
        match self {
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
            Self::Pixels(image) => {
                let mut png = Cursor::new(Vec::new());
                let fail = |e: image::ImageError| Error::Decode { name: name.into(), reason: e.to_string() };
                image.write_to(&mut png, ImageFormat::Png).map_err(fail)?;
                Ok(Cow::Owned(png.into_inner()))
            }
        }
    }
}

/// A picture with the name that errors call it by.
pub(crate) type Named = (String, PyBackedBytes);

impl<'a, 'py> FromPyObject<'a, 'py> for PictureInput {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<PyBackedBytes>() {
            Ok(bytes) => Ok(Self::Bytes(bytes)),
            Err(_) => pixels(&object).map(Self::Pixels),
        }
    }
}

/// The values of an array, row by row; copied, because another thread may write to it.
fn values<T: Element + Copy>(array: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    let array: PyReadonlyArrayDyn<'_, T> = array.extract()?;
    Ok(match array.as_slice() {
        Ok(values) => values.to_vec(),
        Err(_) => array.as_array().iter().copied().collect(),
    })
}

/// An array as an image: height × width, or height × width × 3 or 4, of 8 bits; height × width of 16.
fn pixels(object: &Bound<'_, PyAny>) -> PyResult<DynamicImage> {
    let py = object.py();
    let unfit = || errors::kind(py, "this is no picture", "give bytes or an array of uint8");
    let array = object.cast::<PyUntypedArray>().map_err(|_| unfit())?;
    let (height, width, channels) = match *array.shape() {
        [height, width] => (height, width, 1),
        [height, width, channels] => (height, width, channels),
        _ => return Err(unfit()),
    };
    let side = |length: usize| u32::try_from(length).map_err(|_| unfit());
    let (width, height) = (side(width)?, side(height)?);
    let wide = array.dtype().is_equiv_to(&numpy::dtype::<u16>(py));
    let image = match (channels, wide) {
        (1, true) => ImageBuffer::<Luma<u16>, _>::from_raw(width, height, values(object)?).map(Into::into),
        (1, false) => GrayImage::from_raw(width, height, values(object)?).map(Into::into),
        (3, false) => RgbImage::from_raw(width, height, values(object)?).map(Into::into),
        (4, false) => RgbaImage::from_raw(width, height, values(object)?).map(Into::into),
        _ => None,
    };
    image.ok_or_else(unfit)
}

/// An array as the bytes of a PNG.
#[pyfunction]
pub(crate) fn encode(py: Python<'_>, array: &Bound<'_, PyAny>) -> PyResult<Py<PyBytes>> {
    let image = pixels(array)?;
    let bytes = run(py, None, move |_| {
        let mut bytes = Cursor::new(Vec::new());
        let written = image.write_to(&mut bytes, ImageFormat::Png);
        written.map_err(|e| Error::Decode { name: "array".into(), reason: e.to_string() })?;
        Ok(bytes.into_inner())
    })?;
    Ok(PyBytes::new(py, &bytes).unbind())
}

/// The bytes of a file.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Py<PyBytes>> {
    let bytes = py.detach(|| std::fs::read(&path).map_err(|e| Error::read(&path, e)));
    Ok(PyBytes::new(py, &bytes.map_err(|e| errors::raised(py, &e))?).unbind())
}
