//! Panics, reported in the form of any other error.

use super::failure::Failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Place in the sources of the last panic.
static PLACE: Mutex<Option<String>> = Mutex::new(None);

/// Stores the place of a panic instead of printing a trace, which is useless to users.
pub(crate) fn watch() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|at| {
            // The folders before `src` are those of the machine that compiled the program.
            let file = at.file().rsplit_once("/src/").map_or(at.file(), |(_, file)| file);
            format!("{file}:{}", at.line())
        });
        *PLACE.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }));
}

/// Runs work; returns an error if it panics.
pub(crate) fn guarded<T>(work: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
        let place = PLACE.lock().unwrap_or_else(PoisonError::into_inner).take();
        let place = place.map(|place| format!(" ({place})")).unwrap_or_default();
        let failure = Failure::failed(format!("a defect of this program: {said}{place}"));
        Err(failure.hint("please report it, with the input if you can").into())
    })
}

#[cfg(test)]
mod tests {
    use super::super::exit::Exit;
    use super::super::failure::explain;
    use super::*;

    #[test]
    fn a_panic_becomes_an_error() {
        let error = guarded::<()>(|| panic!("number {}", 7)).unwrap_err();
        let (message, hint, exit) = explain(&error);
        assert!(message.starts_with("a defect of this program: number 7"), "{message}");
        assert_eq!(exit, Exit::Failed);
        assert!(hint.unwrap().contains("report"));
        assert_eq!(guarded(|| Ok(3)).unwrap(), 3);
    }
}
