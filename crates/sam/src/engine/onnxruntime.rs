//! Networks run by ONNX Runtime, a shared library that is loaded when first needed.
//!
//! Each network has its own thread pool with one thread per core. The number of threads is fixed because
//! it determines how matrix products are split, hence the order of summation and the last digits. The
//! library's telemetry is switched off. A process can load only one library.

use super::{Engine, NetworkSource, Port, Tensor, Values, guarded, input_indices, places};
use ort::environment::Environment;
use ort::logging::LoggerFunction;
use ort::session::{Session, SessionInputValue};
use ort::value::{Tensor as OrtTensor, TensorElementType, ValueType};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use vtex_base::error::{Error, Result};

/// Oldest supported version of ONNX Runtime, as its minor number: 17 means 1.17.
pub const MINIMUM_MINOR: u32 = ort::MINOR_VERSION;

/// The loaded library.
struct Loaded {
    path: PathBuf,
    version: String,
    environment: Environment,
}

static LOADED: Mutex<Option<Loaded>> = Mutex::new(None);

/// Calls `work` with the library, which is loaded on the first call.
fn with_library<T>(path: &Path, work: impl FnOnce(&Loaded) -> Result<T>) -> Result<T> {
    let failure = |reason| Error::Runtime { name: path.display().to_string(), reason };
    let path = std::fs::canonicalize(path).map_err(|e| failure(format!("cannot be loaded: {e}")))?;
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    match &*loaded {
        Some(known) if known.path == path => {}
        Some(known) => {
            let message = format!("'{}' is loaded already, and one must do", known.path.display());
            return Err(failure(message));
        }
        None => {
            let start = || {
                let found = ort::init_from(&path).map_err(|e| failure(format!("cannot be loaded: {e}")))?;
                // Fails, possibly by a caught panic, if the library lacks the expected interface.
                let build = ort::info();
                let version = version_in(build).or_else(|| version_of(&path)).unwrap_or_else(|| "1.?".into());
                // Messages that it would print are also returned as errors.
                let silent: LoggerFunction = Arc::new(|_, _, _, _, _| {});
                let built = found.with_name("vtex").with_telemetry(false).with_logger(silent).build();
                let environment = built.map_err(|e| failure(format!("cannot be started: {e}")))?;
                Ok(Loaded { path: path.clone(), version, environment })
            };
            *loaded = Some(guarded(&path.display().to_string(), start)?);
        }
    }
    match &*loaded {
        Some(known) => work(known),
        None => Err(failure("cannot be loaded".into())),
    }
}

/// Loads a library and returns its version.
///
/// # Errors
/// [`Error::Runtime`] if it cannot be loaded, or another one is loaded already.
pub fn version(library: &Path) -> Result<String> {
    with_library(library, |loaded| Ok(loaded.version.clone()))
}

/// `1.22.0` in the name of a file such as `libonnxruntime.so.1.22.0` or `libonnxruntime.1.22.0.dylib`.
fn version_of(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let rest = name.trim_start_matches(|c: char| !c.is_ascii_digit());
    let version = rest.trim_end_matches(|c: char| !c.is_ascii_digit());
    version.contains('.').then(|| version.to_owned())
}

/// `1.22.0` in `ORT Build Info: git-branch=rel-1.22.0, …`.
fn version_in(text: &str) -> Option<String> {
    let branch = text.split("git-branch=").nth(1)?.split([',', ' ']).next()?;
    let version = branch.trim_start_matches(|c: char| !c.is_ascii_digit());
    (!version.is_empty()).then(|| version.to_owned())
}

/// A loaded network.
pub(super) struct OnnxRuntimeNetwork {
    name: String,
    runtime: String,
    // ONNX Runtime's sessions are thread-safe, but the crate requires exclusive access.
    session: Mutex<Session>,
    inputs: Vec<Port>,
    kinds: Vec<TensorElementType>,
    outputs: Vec<Port>,
}

impl OnnxRuntimeNetwork {
    /// Loads a network with a library.
    ///
    /// # Errors
    /// [`Error::Network`].
    pub(super) fn load(source: NetworkSource<'_>, library: &Path) -> Result<Self> {
        let name = source.name();
        let failure = |e: ort::Error| Error::Network {
            name: name.clone(),
            reason: format!("ONNX Runtime cannot read it: {e}"),
            advice: "is it an ONNX file, and complete? A newer library reads newer files",
        };
        with_library(library, |loaded| {
            guarded(&name, || {
                let mut builder = Session::builder(&loaded.environment).map_err(failure)?;
                builder = builder.with_deterministic_compute(true).map_err(|e| failure(e.into()))?;
                // By default it also pins threads to cores, which fails if some cores are not available.
                let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
                builder = builder.with_intra_threads(cores).map_err(|e| failure(e.into()))?;
                // Idle threads sleep, because the cores have other work between two runs.
                builder = builder.with_intra_op_spinning(false).map_err(|e| failure(e.into()))?;
                let session = match source {
                    NetworkSource::File(path) => builder.commit_from_file(path),
                    NetworkSource::Bytes { bytes, .. } => builder.commit_from_memory(bytes),
                };
                let session = session.map_err(failure)?;
                let ports = |outlets: &[ort::value::Outlet]| {
                    outlets.iter().map(|outlet| port(outlet.name(), outlet.dtype())).collect()
                };
                let kinds = session.inputs().iter().map(|outlet| kind(outlet.dtype())).collect();
                let runtime = format!("ONNX Runtime {}", loaded.version);
                let (inputs, outputs) = (ports(session.inputs()), ports(session.outputs()));
                Ok(Self { name: name.clone(), runtime, session: Mutex::new(session), inputs, kinds, outputs })
            })
        })
    }

    /// Converts a tensor to the number type that an input takes.
    fn converted(&self, place: usize, tensor: &Tensor) -> Result<SessionInputValue<'static>> {
        let shape = tensor.shape.clone();
        let limited = |low: i64, high: i64| tensor.integers().into_iter().map(move |v| v.clamp(low, high));
        let value = match self.kinds[place] {
            TensorElementType::Float32 => OrtTensor::from_array((shape, tensor.floats())).map(Into::into),
            TensorElementType::Int64 => OrtTensor::from_array((shape, tensor.integers())).map(Into::into),
            TensorElementType::Int32 => {
                let values = limited(i32::MIN.into(), i32::MAX.into()).map(|v| v as i32);
                OrtTensor::from_array((shape, values.collect::<Vec<_>>())).map(Into::into)
            }
            TensorElementType::Uint8 => {
                let values = limited(0, 255).map(|v| v as u8);
                OrtTensor::from_array((shape, values.collect::<Vec<_>>())).map(Into::into)
            }
            TensorElementType::Float64 => {
                let values = tensor.floats().into_iter().map(f64::from);
                OrtTensor::from_array((shape, values.collect::<Vec<_>>())).map(Into::into)
            }
            other => {
                let name = &self.inputs[place].name;
                return Err(
                    self.failure(format!("its input '{name}' is of {other:?}, which is not known here"))
                );
            }
        };
        value.map_err(|e| self.failure(format!("an input does not fit: {e}")))
    }

    fn failure(&self, reason: String) -> Error {
        Error::Engine { name: self.name.clone(), engine: "ONNX Runtime", reason }
    }
}

impl Engine for OnnxRuntimeNetwork {
    fn runtime(&self) -> &str {
        &self.runtime
    }

    fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    fn run(&self, inputs: &[(&str, &Tensor)], outputs: &[&str]) -> Result<Vec<Tensor>> {
        let indices = input_indices(&self.name, &self.inputs, inputs)?;
        let arguments = indices.into_iter().zip(inputs).map(|(place, (name, tensor))| {
            Ok((Cow::from((*name).to_owned()), self.converted(place, tensor)?))
        });
        let arguments: Vec<(Cow<'_, str>, SessionInputValue<'_>)> = arguments.collect::<Result<_>>()?;
        places(&self.name, &self.outputs, outputs)?;
        guarded(&self.name, || {
            let mut session = self.session.lock().unwrap_or_else(PoisonError::into_inner);
            let results = session.run(arguments);
            let results = results.map_err(|e| self.failure(format!("ONNX Runtime cannot run it: {e}")))?;
            let take = |wanted: &&str| {
                let value =
                    results.get(wanted).ok_or_else(|| self.failure(format!("it gave no '{wanted}'")))?;
                taken(value).map_err(|e| self.failure(format!("its output '{wanted}': {e}")))
            };
            outputs.iter().map(take).collect()
        })
    }
}

/// Converts a value to a tensor.
fn taken(value: &ort::value::DynValue) -> ort::Result<Tensor> {
    let lengths = |shape: &ort::value::Shape| shape.iter().map(|n| *n as usize).collect();
    let ValueType::Tensor { ty, .. } = value.dtype() else {
        return Err(ort::Error::new("it is no tensor"));
    };
    Ok(match ty {
        TensorElementType::Int64 => {
            let (shape, values) = value.try_extract_tensor::<i64>()?;
            Tensor { shape: lengths(shape), values: Values::I64(values.to_vec()) }
        }
        TensorElementType::Int32 => {
            let (shape, values) = value.try_extract_tensor::<i32>()?;
            let values = values.iter().map(|v| i64::from(*v)).collect();
            Tensor { shape: lengths(shape), values: Values::I64(values) }
        }
        _ => {
            let (shape, values) = value.try_extract_tensor::<f32>()?;
            Tensor { shape: lengths(shape), values: Values::F32(values.to_vec()) }
        }
    })
}

/// Describes an input or output of the graph.
fn port(name: &str, kind: &ValueType) -> Port {
    let shape = match kind {
        ValueType::Tensor { shape, .. } => Some(shape.iter().map(|n| usize::try_from(*n).ok()).collect()),
        _ => None,
    };
    Port { name: name.to_owned(), shape }
}

fn kind(of: &ValueType) -> TensorElementType {
    match of {
        ValueType::Tensor { ty, .. } => *ty,
        _ => TensorElementType::Undefined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_read_from_what_builds_say() {
        let info = "ORT Build Info: git-branch=rel-1.19.2, git-commit-id=2, build type=Release";
        assert_eq!(version_in(info).as_deref(), Some("1.19.2"));
        assert_eq!(version_in("ORT Build Info: git-branch=main, git-commit-id=2"), None);
        assert_eq!(version_in(""), None);
        let named = |name| version_of(Path::new(name));
        assert_eq!(named("/a.1/libonnxruntime.so.1.31.1").as_deref(), Some("1.31.1"));
        assert_eq!(named("libonnxruntime.1.22.0.dylib").as_deref(), Some("1.22.0"));
        assert_eq!(named("libonnxruntime.so"), None);
    }
}
