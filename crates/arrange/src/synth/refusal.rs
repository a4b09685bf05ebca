//! What is said where a method is not for something.

use std::borrow::Cow;
use vtex_base::error::{Error, Result};
use vtex_scene::scene::Method;

/// What is found, if it is.
///
/// # Errors
/// [`Error::Interrupted`].
pub(super) fn if_fits<T>(found: Result<T>) -> Result<Option<T>> {
    match found {
        Err(Error::Interrupted) => Err(Error::Interrupted),
        found => Ok(found.ok()),
    }
}

/// The error of a method that is not for something.
pub(super) fn refusal(method: Method, allowed: impl Into<Cow<'static, str>>) -> Error {
    Error::Parameter { name: "method", value: format!("{method:?}").to_lowercase(), allowed: allowed.into() }
}
