//! How long work reports what it does, and how it is asked to stop.

use crate::error::{Error, Result};
use image::RgbImage;

/// Reports from a long function to its caller, who may stop it.
///
/// The library draws nothing and asks nothing: a program that wants a progress bar, a way to
/// interrupt, or a picture of each stage implements this trait. `()` implements it and ignores all.
pub trait Progress: Sync {
    /// `done` of `total` steps of `stage` are finished; `total` is 0 while it is unknown.
    /// Answer `false` to stop: the function then returns [`Error::Interrupted`].
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        let _ = (stage, done, total);
        true
    }

    /// Something the user should know; the work goes on.
    fn warn(&self, message: &str) {
        let _ = message;
    }

    /// A picture of an intermediate result is at hand; `draw` makes it. `name` is a file stem
    /// such as `categories`. Nothing is drawn unless an implementation calls `draw`.
    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        let _ = (name, draw);
    }
}

impl Progress for () {}

/// [`Progress::advance`] as a `Result`, for use with `?`.
pub(crate) fn advance(progress: &dyn Progress, stage: &'static str, done: u64, total: u64) -> Result<()> {
    if progress.advance(stage, done, total) { Ok(()) } else { Err(Error::Interrupted) }
}

/// For tests: asks at once to stop.
#[cfg(test)]
pub(crate) struct Stop;

#[cfg(test)]
impl Progress for Stop {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        false
    }
}
