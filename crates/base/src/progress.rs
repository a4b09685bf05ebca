//! Progress of long work: reports to the caller, and requests to stop.

use crate::error::{Error, Result};
use image::RgbImage;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Reports from a long function to its caller, who may stop it.
///
/// The library displays nothing and asks nothing: a program that wants a progress bar, a way to interrupt, or
/// a picture of each stage implements this trait. `()` implements it and ignores all.
pub trait Progress: Sync {
    /// `done` of `total` steps of `stage` are finished; `total` is 0 while it is unknown.
    /// Answer `false` to stop: the function then returns [`Error::Interrupted`].
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        let _ = (stage, done, total);
        true
    }

    /// A warning for the user; the work continues.
    fn warn(&self, message: &str) {
        let _ = message;
    }

    /// As [`Progress::warn`], of something that shows only where the elements of an exemplar are placed anew.
    fn warn_of_placing(&self, message: &str) {
        self.warn(message);
    }

    /// Offers a picture of an intermediate result; `draw` makes it. `name` is a file stem such as
    /// `categories`. Nothing is drawn unless an implementation calls `draw`.
    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        let _ = (name, draw);
    }
}

impl Progress for () {}

/// [`Progress::advance`] as a `Result`, for use with `?`.
pub fn advance(progress: &dyn Progress, stage: &'static str, done: u64, total: u64) -> Result<()> {
    if progress.advance(stage, done, total) { Ok(()) } else { Err(Error::Interrupted) }
}

/// Tasks that run in parallel. One of them reports progress; all can be stopped.
pub struct SideBySide<'a> {
    progress: &'a dyn Progress,
    /// The last report.
    last: Mutex<(&'static str, u64, u64)>,
}

impl<'a> SideBySide<'a> {
    /// Tasks of a stage.
    pub fn new(progress: &'a dyn Progress, stage: &'static str) -> Self {
        Self { progress, last: Mutex::new((stage, 0, 0)) }
    }

    /// A handle for a task whose stages are not reported.
    pub fn silent(&self) -> Silent<'_> {
        Silent(self)
    }

    fn last(&self) -> MutexGuard<'_, (&'static str, u64, u64)> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for SideBySide<'_> {
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        *self.last() = (stage, done, total);
        self.progress.advance(stage, done, total)
    }

    fn warn(&self, message: &str) {
        self.progress.warn(message);
    }

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        self.progress.picture(name, draw);
    }
}

/// One of several tasks, whose stages are not reported: see [`SideBySide::silent`].
pub struct Silent<'a>(&'a SideBySide<'a>);

impl Progress for Silent<'_> {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        let (stage, done, total) = *self.0.last();
        self.0.progress.advance(stage, done, total)
    }

    fn warn(&self, message: &str) {
        self.0.warn(message);
    }

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        self.0.picture(name, draw);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Collects reports, and stops at a stage.
    struct Kept(Mutex<Vec<(&'static str, u64, u64)>>);

    impl Progress for Kept {
        fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
            self.0.lock().unwrap().push((stage, done, total));
            stage != "last"
        }
    }

    #[test]
    fn a_silent_task_repeats_what_was_reported_and_is_stopped_too() {
        let kept = Kept(Mutex::default());
        let tasks = SideBySide::new(&kept, "first");
        let silent = tasks.silent();
        assert!(silent.advance("unheard of", 7, 8));
        assert!(tasks.advance("second", 1, 2) && silent.advance("unheard of", 8, 8));
        assert!(!tasks.advance("last", 0, 3) && !silent.advance("unheard of", 8, 8));
        let last = ("last", 0, 3);
        assert_eq!(
            *kept.0.lock().unwrap(),
            [("first", 0, 0), ("second", 1, 2), ("second", 1, 2), last, last]
        );
    }
}
