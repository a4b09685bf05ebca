//! Ctrl-C: the first asks the work to stop, the second ends the program at once.

use super::exit::Exit;
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);
/// Whether there is nothing to clean up, so that the first Ctrl-C may end the program.
static WAITING: AtomicBool = AtomicBool::new(false);

/// Starts to watch for Ctrl-C and signals to end.
pub(crate) fn watch() {
    // Without a handler the signal ends the program as it always did: nothing to report.
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) || WAITING.load(Ordering::SeqCst) {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
    });
}

/// Whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// An error if the user asked to stop.
pub(crate) fn check() -> vtex::Result<()> {
    if asked() { Err(vtex::Error::Interrupted) } else { Ok(()) }
}

/// Does something that may wait for another program without end, such as reading standard input;
/// Ctrl-C then ends the program at once.
pub(crate) fn waiting<T>(work: impl FnOnce() -> T) -> T {
    WAITING.store(true, Ordering::SeqCst);
    let value = work();
    WAITING.store(false, Ordering::SeqCst);
    value
}
