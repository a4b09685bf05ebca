//! Errors of the library as exceptions, with hints in the words of Python.

use pyo3::prelude::*;
use std::io;
use vtex::Error;
use vtex::error::EditFault;

/// An exception made by a function of `vtex._errors`, or the exception that this call raises.
fn made<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let value = py.import("vtex._errors").and_then(|module| module.getattr(name)?.call1(arguments));
    value.map_or_else(|error| error, PyErr::from_value)
}

/// A value that cannot be used.
pub(crate) fn input(py: Python<'_>, message: &str, hint: Option<&str>) -> PyErr {
    made(py, "InputError", (message, hint))
}

/// An error for an argument of the wrong type.
pub(crate) fn kind(py: Python<'_>, message: &str, hint: &str) -> PyErr {
    made(py, "InputTypeError", (message, hint))
}

/// An error of an engine or of threads.
pub(crate) fn engine(py: Python<'_>, message: &str) -> PyErr {
    made(py, "EngineError", (message, None::<&str>))
}

/// The exception for an error of the library.
pub(crate) fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let (message, hint) = (message(error), hint(error));
    match error {
        Error::Read { path, source } | Error::Write { path, source } => {
            made(py, "file_error", (number(py, source), message, hint, path))
        }
        Error::Exists { path, .. } => {
            let exists = number(py, &io::ErrorKind::AlreadyExists.into());
            made(py, "file_error", (exists, message, hint, path))
        }
        Error::Interrupted => made(py, "Interrupted", (message, hint)),
        Error::Network { .. } | Error::Runtime { .. } | Error::Engine { .. } => {
            made(py, "EngineError", (message, hint))
        }
        _ => made(py, "InputError", (message, hint)),
    }
}

/// Python's error number for a fault of a file, which on Windows differs from the system's.
fn number(py: Python<'_>, error: &io::Error) -> Option<i32> {
    if !cfg!(windows) && error.raw_os_error().is_some() {
        return error.raw_os_error();
    }
    let name = match error.kind() {
        io::ErrorKind::NotFound => "ENOENT",
        io::ErrorKind::PermissionDenied => "EACCES",
        io::ErrorKind::IsADirectory => "EISDIR",
        io::ErrorKind::NotADirectory => "ENOTDIR",
        io::ErrorKind::AlreadyExists => "EEXIST",
        _ => return error.raw_os_error(),
    };
    py.import("errno").ok()?.getattr(name).ok()?.extract().ok()
}

/// The message, with parameters named as in Python.
fn message(error: &Error) -> String {
    match error {
        // The others have names of one word.
        Error::Parameter { name, .. } if name.contains('-') => {
            error.to_string().replacen(*name, &name.replace('-', "_"), 1)
        }
        Error::Edit { operation, fault: EditFault::Range { name, value, allowed } } => {
            let name = field(operation, name);
            format!("cannot do '{operation}': {name} = {value} is out of range: {allowed}")
        }
        _ => error.to_string(),
    }
}

/// The field of a class of edits for a number that the command line calls `name`.
fn field<'a>(operation: &str, name: &'a str) -> &'a str {
    let verb = operation.split(' ').next().unwrap_or_default();
    match (verb, name) {
        ("orient", "degrees") => "direction",
        ("jitter", "move") => "distance",
        (_, "move") => "by",
        (_, "degrees" | "rotate") => "angle",
        (_, "px") => "tolerance",
        (_, "min-area") => "minimum_area",
        (_, "min-distance") => "minimum_distance",
        (_, "color") => "colour",
        _ => name,
    }
}

/// A hint in terms of the Python package, else the library's own.
fn hint(error: &Error) -> Option<String> {
    let text = match error {
        Error::Exists { .. } => "give another name, or force=True to replace it",
        Error::Format { format: "vtex-library", .. } => "make a library with vtex.analyze",
        Error::Format { format: "vtex-scene", .. } => "make a scene with vtex.synthesize",
        Error::Runtime { .. } => {
            "'pip install onnxruntime' brings it; name its library by onnxruntime=, or use engine='rten'"
        }
        Error::Engine { engine: "rten", .. } => "try engine='onnxruntime'",
        Error::Engine { engine: "ONNX Runtime", .. } => {
            "use an export with 32-bit inputs and outputs, or try engine='rten'"
        }
        Error::Edit { fault: EditFault::TooFar(_), .. } => "give smaller numbers",
        Error::Edit { fault: EditFault::LikeNothing, .. } => "give drawing or of, which the others are like",
        Error::Edit { fault: EditFault::NoLayer { known, .. }, .. } => {
            return Some(format!("layer takes {}", known.join(", ")));
        }
        Error::Edit { fault: EditFault::NoCategory { known, .. }, .. } => {
            return Some(match &known[..] {
                [] => "no element of the scene has a category".into(),
                known => format!("the categories are {}", known.join(", ")),
            });
        }
        Error::Edit { fault: EditFault::BackgroundCondition, .. } => {
            "its points are told apart by x, y, inside and outside"
        }
        Error::Undrawable { .. } => {
            return error.hint().map(|advice| advice + "; lenient=True leaves it out");
        }
        Error::DrawingPeriods { .. } => "give another size, or method='descriptor', which fits any",
        Error::OtherLibrary { .. } => {
            "give the libraries that the scene was made from: scene.exemplars names them"
        }
        Error::Periods { nearest: Some([w, h]), .. } => {
            return Some(format!("give size=({w}, {h}), or lattice='off', which fits any size"));
        }
        Error::Periods { .. } => "give a larger size, or lattice='off', which fits any",
        Error::Sizes { .. } => "make both of the same size, or stretch one by vtex.warp",
        Error::MaxBytes { smallest, .. } => {
            return Some(format!("give max_bytes={smallest} or more, or make the texture smaller"));
        }
        _ => return error.hint(),
    };
    Some(text.to_owned())
}
