//! Ctrl-C: the first asks the work to stop, the second ends the program at once.

use super::Exit;
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Starts to watch for Ctrl-C and signals to end.
pub(crate) fn watch() {
    // Without a handler the signal ends the program as it always did: nothing to report.
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
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
