//! The command-line program, within Python's process.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::io::{Write as _, stdout};
use std::path::PathBuf;

/// Runs the command-line program and returns its exit code. The first argument is the name of the program; `script`
/// is the file that starts it. Runs once in a process; Ctrl-C may end the process.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, arguments: Vec<OsString>, script: Option<PathBuf>) -> u8 {
    py.detach(|| {
        let code = vtex::program::run(arguments, script);
        // Programs in Rust do this at their end; Python does not know this buffer. An error does not matter, because
        // commands flush their results themselves.
        let _ = stdout().flush();
        code
    })
}
