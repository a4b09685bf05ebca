//! Photograph or drawing → library.

use crate::library::Library;
use crate::pictures::{Named, PictureInput};
use crate::run::run;
use crate::writing::from_json;
use pyo3::prelude::*;
use serde::Deserialize;
use std::path::PathBuf;
use vtex::analyze::{Limits, borders_join};
use vtex::engine::{EngineOptions, NetworkSource, Runtime};
use vtex::import::{ImportParams, import, is_drawing, shows_lines};
use vtex::layers::LayerPicture;
use vtex::library::{AnalyzeParams, PictureKind};
use vtex::segment::prompt::{Generator, GeneratorParams, Sam};
use vtex::segment::texton::Texton;
use vtex::segment::{Felzenszwalb, MasksFile, OneTree, Regions, Segmenter};
use vtex::{Error, Result};

/// How an exemplar is analysed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnalysisOptions {
    segmenter: SegmenterOption,
    /// Files of a network of Segment Anything.
    networks: Vec<PathBuf>,
    engine: Engine,
    onnxruntime: Option<PathBuf>,
    /// Whether the exemplar tiles; if it is not given, borders are tested.
    wrap: Option<bool>,
    parameters: AnalyzeParams,
}

/// The segmenter that finds masks.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SegmenterOption {
    Auto,
    Texton,
    Regions,
    Felzenszwalb,
    Sam,
    /// The segmenter for redrawing a picture, without a network.
    #[serde(rename = "one-tree")]
    OneTree,
}

/// The engine that runs networks.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Engine {
    Auto,
    OnnxRuntime,
    Rten,
}

impl AnalysisOptions {
    /// The segmenter that finds masks.
    ///
    /// # Errors
    /// Those of loading it.
    fn segmenter(&self) -> Result<Box<dyn Segmenter>> {
        let runtime = match self.engine {
            Engine::Auto => Runtime::Auto,
            Engine::OnnxRuntime => Runtime::OnnxRuntime,
            Engine::Rten => Runtime::Rten,
        };
        // If a number of threads is given, networks have their own threads, which end with them.
        let threads = Some(crate::run::threads());
        let engine = EngineOptions { runtime, library: self.onnxruntime.clone(), threads };
        let sam = || -> Result<Box<dyn Segmenter>> {
            let files: Vec<NetworkSource<'_>> =
                self.networks.iter().map(|path| NetworkSource::File(path)).collect();
            let sam = Sam::open(&files, &engine)?;
            Ok(Box::new(Generator::new(Box::new(sam), GeneratorParams::default())?))
        };
        match self.segmenter {
            SegmenterOption::Auto if !self.networks.is_empty() => sam(),
            SegmenterOption::Sam => sam(),
            SegmenterOption::Auto | SegmenterOption::Texton => Ok(Box::new(Texton::new()?)),
            SegmenterOption::OneTree => Ok(Box::new(OneTree)),
            SegmenterOption::Regions => Ok(Box::new(Regions)),
            SegmenterOption::Felzenszwalb => Ok(Box::new(Felzenszwalb::default())),
        }
    }
}

/// Analyses an exemplar.
#[pyfunction]
pub(crate) fn analyze(
    py: Python<'_>,
    name: String,
    exemplar: PictureInput,
    options: &str,
    masks: Option<Named>,
    layer_map: Option<Named>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Library> {
    let options: AnalysisOptions = from_json(py, options, "analyze")?;
    let found = run(py, progress, move |progress| {
        let is_drawing = options.parameters.kind == PictureKind::Curves
            || matches!(&exemplar, PictureInput::Bytes(bytes) if is_drawing(bytes));
        // Errors name the file as it was given.
        let file =
            std::path::Path::new(&name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into());
        if is_drawing {
            if masks.is_some() || layer_map.is_some() {
                return Err(Error::Control {
                    name,
                    role: "an exemplar with masks or a layer map",
                    reason: "it is a drawing, which has neither".into(),
                    advice: "leave out masks and layer_map",
                });
            }
            let params = ImportParams { wrap: options.wrap, analyze: options.parameters };
            let mut library = import(&exemplar.bytes(&name)?, &name, &params, progress)?;
            library.source.file = file;
            return Ok(library);
        }
        let mut exemplar = exemplar.exemplar(&name, options.wrap != Some(false))?;
        exemplar.file = file;
        if shows_lines(&exemplar.image) {
            progress.warn("the picture shows lines on paper: kind='curves' reads it as a drawing of strokes");
        }
        if let Some((name, bytes)) = layer_map {
            exemplar.layers = Some(LayerPicture::from_bytes(&bytes, &name, &Limits::default())?.layers()?);
        }
        let segmenter = match masks {
            Some((name, bytes)) => Box::new(MasksFile::from_bytes(bytes.to_vec(), &name)?),
            None => options.segmenter()?,
        };
        let wrap = options.wrap.unwrap_or_else(|| borders_join(&exemplar.image));
        let params = AnalyzeParams { wrap, ..options.parameters };
        vtex::analyze::analyze(&exemplar, &*segmenter, &params, progress)
    });
    found.map(Library::from)
}
