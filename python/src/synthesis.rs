//! Libraries → scene.

use crate::library::Library;
use crate::pictures::Named;
use crate::run::run;
use crate::scene::Scene;
use crate::writing::from_json;
use pyo3::prelude::*;
use serde::Deserialize;
use std::borrow::Cow;
use vtex::analyze::Limits;
use vtex::import::{as_drawn, is_drawing};
use vtex::layers::LayerPicture;
use vtex::scene::{Length, LengthUnit, SynthParams};
use vtex::synth::{self, CanvasSize, Controls, DrawnContext, StructureGuide, layer_map, synthesize_with};
use vtex::{Result, control, library};

/// Files that steer.
struct SteeringFiles {
    domain: Option<Named>,
    density: Option<Named>,
    maps: Vec<Named>,
    control: Option<Named>,
    guide: Option<Named>,
    /// The region beside a drawing that stays.
    region: Option<Named>,
    /// Whether it is made anew.
    anew: bool,
    /// The part of the library's drawing that is copied to it.
    source: Option<Named>,
}

impl SteeringFiles {
    /// The content of the files.
    ///
    /// # Errors Errors of files that do not suit their use.
    fn controls(&self, canvas: [u32; 2], libraries: &[library::Library]) -> Result<Controls> {
        let domain = self.domain.as_ref().map(|(name, bytes)| match is_drawing(bytes) {
            true => control::shape(bytes, name, canvas),
            false => control::mask(bytes, name, canvas),
        });
        let density = self.density.as_ref().map(|(name, bytes)| control::density(bytes, name));
        let maps: Vec<(&str, &[u8])> =
            self.maps.iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
        let shares = if maps.is_empty() { Vec::new() } else { control::shares(&maps, libraries.len())? };
        let structure = match (&self.control, &self.guide, libraries) {
            (Some((name, bytes)), _, [library]) => {
                let picture = LayerPicture::from_bytes(bytes, name, &Limits::default())?;
                Some(StructureGuide::Strata(picture.in_colours_of(&layer_map(library))?))
            }
            (_, Some((name, bytes)), _) => Some(StructureGuide::Lightness(control::level(bytes, name)?)),
            _ => None,
        };
        let (domain, density) = (domain.transpose()?, density.transpose()?);
        Ok(Controls { domain, density, shares, structure, context: None })
    }

    /// The region, beside a drawing.
    ///
    /// # Errors Those of a region, or of a part to be copied, that does not suit.
    fn beside(
        &self,
        drawing: library::Library,
        canvas: [u32; 2],
        libraries: &[library::Library],
    ) -> Result<Option<DrawnContext>> {
        let Some((name, bytes)) = &self.region else { return Ok(None) };
        let region = control::shape(bytes, name, canvas)?;
        let source = match (&self.source, libraries) {
            (Some((name, bytes)), [library, ..]) => {
                Some(control::shape(bytes, name, [library.source.width, library.source.height])?)
            }
            _ => None,
        };
        Ok(Some(DrawnContext { drawing, region, source, anew: self.anew }))
    }
}

/// The size that is asked for: in pixels, as a page, or neither.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskedSize {
    pixels: Option<[u32; 2]>,
    page: Option<[Length; 2]>,
    dpi: Option<u32>,
}

impl AskedSize {
    /// The size, or that of a drawing beside which the texture is made.
    fn size(&self, drawing: Option<&library::Library>) -> CanvasSize {
        match (self.pixels, self.page, drawing) {
            (Some(size), ..) => CanvasSize::Pixels(size),
            (_, Some(page), _) if page.iter().all(|side| side.unit() == LengthUnit::Pixel) => {
                CanvasSize::Pixels(page.map(|side| side.value().round() as u32))
            }
            (_, Some(page), _) => CanvasSize::Page(page),
            (.., Some(drawing)) => CanvasSize::Pixels([drawing.source.width, drawing.source.height]),
            _ => CanvasSize::Auto,
        }
    }
}

/// Synthesises a texture on a [`CanvasSize`].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called by keyword from Python, in one place")]
pub(crate) fn synthesize(
    py: Python<'_>,
    libraries: Vec<PyRef<'_, Library>>,
    parameters: &str,
    canvas: &str,
    domain: Option<Named>,
    density: Option<Named>,
    maps: Vec<Named>,
    control: Option<Named>,
    guide: Option<Named>,
    context: Option<Named>,
    region: Option<Named>,
    anew: bool,
    source: Option<Named>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Scene> {
    let mut params: SynthParams = from_json(py, parameters, "synthesize")?;
    let asked: AskedSize = from_json(py, canvas, "size")?;
    let libraries: Vec<_> = libraries.iter().map(|library| library.inner.clone()).collect();
    let steering = SteeringFiles { domain, density, maps, control, guide, region, anew, source };
    let made = run(py, progress, move |progress| {
        // A single library, the usual case, is not copied.
        let libraries: Cow<'_, [library::Library]> = match &libraries[..] {
            [library] => Cow::Borrowed(std::slice::from_ref(&**library)),
            several => several.iter().map(|library| (**library).clone()).collect(),
        };
        let drawing = context.as_ref().map(|(name, bytes)| as_drawn(bytes, name, progress)).transpose()?;
        asked.size(drawing.as_ref()).set(&mut params, &libraries, asked.dpi);
        params.validate()?;
        let canvas = [params.width, params.height];
        let mut controls = steering.controls(canvas, &libraries)?;
        if let Some(drawing) = drawing {
            controls.context = steering.beside(drawing, canvas, &libraries)?;
        }
        synthesize_with(&libraries, &params, &controls, progress)
    });
    made.map(|(scene, _)| scene.into())
}

/// The exemplar drawn back from its library.
#[pyfunction]
pub(crate) fn reconstruct(py: Python<'_>, library: PyRef<'_, Library>) -> PyResult<Scene> {
    let library = library.inner.clone();
    run(py, None, move |_| Ok(synth::reconstruct(&library))).map(Scene::from)
}
