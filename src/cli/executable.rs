//! The executable file of this program, which other programs can start.

use std::path::PathBuf;
use std::sync::OnceLock;

/// What [`set`] was given. Python's process has Python's executable, and the script that starts vtex.
static FILE: OnceLock<PathBuf> = OnceLock::new();

/// Says which file starts this program, if it is not the executable of this process.
pub(crate) fn set(file: Option<PathBuf>) {
    if let Some(file) = file {
        // The program runs once in a process, so nothing else was set.
        let _ = FILE.set(file);
    }
}

/// The file that starts this program.
///
/// # Errors
/// The path is unknown to the system.
pub(crate) fn path() -> std::io::Result<PathBuf> {
    FILE.get().map_or_else(std::env::current_exe, |file| Ok(file.clone()))
}
