//! Ctrl-C: the first one stops the work, and ends the program if the work does not stop in time; the second
//! ends the program at once.

use super::exit::Exit;
use super::failure;
use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use vtex::output::file::remove_unfinished;

static ASKED: AtomicBool = AtomicBool::new(false);
/// Whether the first Ctrl-C may end the program, because there is nothing to clean up.
static WAITING: AtomicBool = AtomicBool::new(false);
/// Files and folders to be removed when Ctrl-C ends the program.
static PASSING: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Time allowed for the work to stop. Libraries that parse and draw SVGs or run networks cannot be stopped.
const PATIENCE: Duration = Duration::from_millis(800);

/// Starts to watch for Ctrl-C and signals to end.
pub(crate) fn watch() {
    outlive_large_files();
    // Without a handler the signal ends the program as usual, so an error is ignored.
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) || WAITING.load(Ordering::SeqCst) {
            end();
        }
        let last = std::thread::Builder::new().spawn(|| {
            std::thread::sleep(PATIENCE);
            if std::io::stderr().is_terminal() {
                // The progress bar may be on the line.
                eprintln!();
            }
            failure::show(&vtex::Error::Interrupted.into());
            end();
        });
        if last.is_err() {
            end();
        }
    });
}

/// Lets a file beyond the system's limit (`ulimit -f`) fail with an error: the signal would end the program, and
/// leave unfinished files behind.
#[cfg(unix)]
fn outlive_large_files() {
    use std::sync::Arc;
    let unread = Arc::new(AtomicBool::new(false));
    // Without a handler the signal ends the program as usual, so an error is ignored.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, unread);
}

#[cfg(not(unix))]
fn outlive_large_files() {}

/// Ends the program and removes unfinished files.
fn end() {
    remove_unfinished();
    for path in &*PASSING.lock().unwrap_or_else(PoisonError::into_inner) {
        let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
    std::process::exit(i32::from(Exit::Interrupted.code()));
}

/// A file or folder that is removed if Ctrl-C ends the program before this is dropped.
pub(crate) struct Passing(PathBuf);

impl Passing {
    pub(crate) fn new(path: &Path) -> Self {
        PASSING.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Passing {
    fn drop(&mut self) {
        PASSING.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}

/// Whether the user asked to stop.
pub(crate) fn is_requested() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// An error if the user asked to stop.
pub(crate) fn check() -> vtex::Result<()> {
    if is_requested() { Err(vtex::Error::Interrupted) } else { Ok(()) }
}

/// Stops work if the user asked to. Shows no progress.
pub(crate) struct Requests;

impl vtex::Progress for Requests {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        !is_requested()
    }
}

/// Runs work that may wait for another program without end, such as reading standard input; Ctrl-C then ends
/// the program at once.
pub(crate) fn waiting<T>(work: impl FnOnce() -> T) -> T {
    WAITING.store(true, Ordering::SeqCst);
    let value = work();
    WAITING.store(false, Ordering::SeqCst);
    value
}
