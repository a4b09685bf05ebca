//! Neural networks: named tensors in, named tensors out. Knows nothing of images.
//!
//! Two engines run ONNX networks: [ONNX Runtime](https://onnxruntime.ai), a shared library that is used
//! if one is found ([`locate`]), and [rten](https://github.com/robertknight/rten), which is part of
//! this crate. Their results agree to about five digits, not bitwise.
//!
//! Faults of engines become errors. ONNX Runtime is located here and loaded by its path, because `ort` panics
//! if its own search fails. Files are checked before rten reads them, because rten hangs on some damaged
//! ones. Panics within an engine are caught.

mod locate;
mod onnxruntime;
mod rten;
mod structure;

pub use locate::{GIVEN, RuntimeCandidate, locate};
pub use onnxruntime::{MINIMUM_MINOR, version};

use std::path::{Path, PathBuf};
use vtex_base::error::{Error, Result, caught};

/// The elements of a tensor in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// 64-bit integers.
    I64(Vec<i64>),
}

/// A dense tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Length of each axis.
    pub shape: Vec<usize>,
    /// The elements, as many as the product of the axes' lengths.
    pub values: Values,
}

impl Tensor {
    /// A tensor of floats.
    pub fn f32(shape: impl Into<Vec<usize>>, values: Vec<f32>) -> Self {
        Self { shape: shape.into(), values: Values::F32(values) }
    }

    /// The elements as floats; integers are rounded to the nearest.
    pub fn floats(&self) -> Vec<f32> {
        match &self.values {
            Values::F32(values) => values.clone(),
            Values::I64(values) => values.iter().map(|v| *v as f32).collect(),
        }
    }

    /// The elements as integers, truncated and clamped to the range of `i64`.
    fn integers(&self) -> Vec<i64> {
        match &self.values {
            Values::F32(values) => values.iter().map(|v| *v as i64).collect(),
            Values::I64(values) => values.clone(),
        }
    }

    /// Whether the number of elements fits the shape and is not 0.
    fn is_whole(&self) -> bool {
        let places = self.shape.iter().try_fold(1usize, |n, length| n.checked_mul(*length));
        let elements = match &self.values {
            Values::F32(values) => values.len(),
            Values::I64(values) => values.len(),
        };
        elements > 0 && places == Some(elements)
    }
}

/// An input or output of a network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name in the graph.
    pub name: String,
    /// Length of each axis, `None` where the graph does not fix it; `None` if not even the number of axes
    /// is known.
    pub shape: Option<Vec<Option<usize>>>,
}

impl std::fmt::Display for Port {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some(shape) = &self.shape else { return write!(f, "{}", self.name) };
        let axes = shape.iter().map(|axis| axis.map_or_else(|| "?".to_owned(), |n| n.to_string()));
        write!(f, "{} [{}]", self.name, axes.collect::<Vec<_>>().join("×"))
    }
}

/// A loaded network. It can be run from several threads at once.
pub trait Engine: Send + Sync {
    /// Name of its engine, such as `rten` or `ONNX Runtime 1.22.0`.
    fn runtime(&self) -> &str;

    /// Its inputs, in the order of the graph.
    fn inputs(&self) -> &[Port];

    /// Its outputs, in the order of the graph.
    fn outputs(&self) -> &[Port];

    /// Runs the network on named inputs and returns the named outputs in the order requested. Inputs are
    /// converted to the number type that the graph declares.
    ///
    /// # Errors
    /// [`Error::Network`] if inputs do not fit the graph or the run fails.
    fn run(&self, inputs: &[(&str, &Tensor)], outputs: &[&str]) -> Result<Vec<Tensor>>;
}

/// The engine that runs a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Runtime {
    /// ONNX Runtime if it is found and can load the network, otherwise rten.
    #[default]
    Auto,
    /// ONNX Runtime.
    OnnxRuntime,
    /// rten.
    Rten,
}

/// Options for running networks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EngineOptions {
    /// The engine. Default: [`Runtime::Auto`].
    pub runtime: Runtime,
    /// ONNX Runtime's shared library. Default: the first that [`locate`] finds. A process can load only
    /// one library; the first stays loaded.
    pub library: Option<PathBuf>,
    /// Number of threads of rten, at least 1. Default: one per core. Results do not depend on it.
    ///
    /// ONNX Runtime always uses all cores, because its order of summation, and with it the last digits of
    /// its results, depends on the number of threads.
    pub threads: Option<usize>,
}

/// The source of a network.
#[derive(Clone, Copy, Debug)]
pub enum NetworkSource<'a> {
    /// An ONNX file. Its weights may be in a second file next to it.
    File(&'a Path),
    /// An ONNX file in memory.
    Bytes {
        /// Name for errors.
        name: &'a str,
        /// The content of the file.
        bytes: &'a [u8],
    },
}

impl NetworkSource<'_> {
    /// Name for errors.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Bytes { name, .. } => (*name).to_owned(),
        }
    }
}

/// The engine chosen for running networks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EngineChoice {
    /// ONNX Runtime.
    OnnxRuntime {
        /// Its shared library.
        library: PathBuf,
        /// Its version, such as `1.22.0`.
        version: String,
    },
    /// rten.
    Rten {
        /// Why ONNX Runtime is not used; `None` if rten was requested explicitly.
        because: Option<String>,
    },
}

/// Chooses the engine for networks, and loads ONNX Runtime if that is chosen.
///
/// # Errors
/// [`Error::Network`] if ONNX Runtime or a particular library is requested and cannot be loaded.
pub fn choose(options: &EngineOptions) -> Result<EngineChoice> {
    if options.runtime == Runtime::Rten {
        return Ok(EngineChoice::Rten { because: None });
    }
    let insisting = options.runtime == Runtime::OnnxRuntime || options.library.is_some();
    let mut failure = None;
    for found in locate(options.library.as_deref()) {
        match onnxruntime::version(&found.path) {
            Ok(version) => return Ok(EngineChoice::OnnxRuntime { library: found.path, version }),
            // An explicitly named library must be used.
            Err(e) if found.named => {
                if insisting {
                    return Err(e);
                }
                return Ok(EngineChoice::Rten { because: Some(e.to_string()) });
            }
            Err(e) => failure = failure.or(Some(e)),
        }
    }
    match failure {
        Some(e) if insisting => Err(e),
        Some(e) => Ok(EngineChoice::Rten { because: Some(e.to_string()) }),
        None if insisting => Err(Error::Runtime {
            name: "ONNX Runtime".into(),
            reason: "its shared library was not found".into(),
        }),
        None => Ok(EngineChoice::Rten { because: Some("ONNX Runtime was not found".into()) }),
    }
}

/// Loads a network.
///
/// # Errors
/// [`Error::Network`] if the engine cannot be loaded or cannot read the network; [`Error::Read`] if
/// the file cannot be read.
pub fn load(source: NetworkSource<'_>, options: &EngineOptions) -> Result<Box<dyn Engine>> {
    if let NetworkSource::File(path) = source {
        // Both engines report problems with a path less clearly.
        std::fs::File::open(path).map_err(|e| Error::read(path, e))?;
    }
    let in_rten =
        || -> Result<Box<dyn Engine>> { Ok(Box::new(rten::RtenNetwork::load(source, options.threads)?)) };
    let network = match choose(options)? {
        EngineChoice::Rten { .. } => in_rten()?,
        EngineChoice::OnnxRuntime { library, .. } => {
            match onnxruntime::OnnxRuntimeNetwork::load(source, &library) {
                Ok(network) => Box::new(network),
                // rten may run a graph whose operators are too new for an old ONNX Runtime.
                Err(e) if options.runtime == Runtime::Auto => in_rten().map_err(|_| e)?,
                Err(e) => return Err(e),
            }
        }
    };
    if network.inputs().is_empty() || network.outputs().is_empty() {
        return Err(Error::Network {
            name: source.name(),
            reason: "it has no inputs or no outputs".into(),
            advice: "is the file complete?",
        });
    }
    Ok(network)
}

/// Calls an engine and converts a panic, as damaged networks may cause, to an error.
fn guarded<T>(name: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    caught(work).unwrap_or_else(|said| {
        let reason = format!("the engine gave up: {said}");
        Err(Error::Engine { name: name.to_owned(), engine: "", reason })
    })
}

/// Indices in `ports` of the given inputs. Checks that each tensor has as many elements as its shape.
fn input_indices(name: &str, ports: &[Port], inputs: &[(&str, &Tensor)]) -> Result<Vec<usize>> {
    if let Some((input, _)) = inputs.iter().find(|(_, tensor)| !tensor.is_whole()) {
        return Err(Error::Network {
            name: name.to_owned(),
            reason: format!("'{input}' does not have the elements of its shape"),
            advice: "",
        });
    }
    places(name, ports, &inputs.iter().map(|input| input.0).collect::<Vec<_>>())
}

/// Indices in `ports` of the requested outputs.
fn places(name: &str, ports: &[Port], wanted: &[&str]) -> Result<Vec<usize>> {
    let place = |wanted: &&str| {
        ports.iter().position(|port| port.name == *wanted).ok_or_else(|| Error::Network {
            name: name.to_owned(),
            reason: format!("it has no input or output '{wanted}'"),
            advice: "",
        })
    };
    wanted.iter().map(place).collect()
}

#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
