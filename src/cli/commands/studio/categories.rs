//! Categories that the page changes: their names, and the elements in them.

use super::drawing::{elements_of, put_elements};
use super::session::Session;
use crate::cli::failure::Failure;
use serde::Deserialize;
use vtex_studio::elements::categories_of_library;

/// Elements and the name of the category that they are moved to; without a name, analysis finds the categories of all.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Categorize {
    /// The version of the elements that the page shows.
    version: u64,
    elements: Vec<usize>,
    name: Option<String>,
}

/// Moves elements between categories, merges or renames these.
pub(super) fn categorize(session: &Session, wanted: Categorize) -> anyhow::Result<()> {
    let Categorize { version, elements: which, name } = wanted;
    let (ground, mut elements, size) = elements_of(session, version)?;
    let library = ground.library.as_ref().ok_or_else(|| Failure::failed("there are no categories yet"))?;
    let before = match &name {
        Some(name) => elements.categorize(&which, name, &categories_of_library(library)),
        None => Ok(elements.forget_categories()),
    };
    put_elements(session, (ground, version), (elements, size), &before.map_err(Failure::failed)?)
}
