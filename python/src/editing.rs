//! Operations from Python.

use crate::errors;
use crate::pictures::Named;
use pyo3::prelude::*;
use serde::Deserialize;
use vtex::edit::condition::EXPECTED;
use vtex::edit::{Action, Condition, Operation};
use vtex::raster::css;

/// An operation with its conditions as text.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TextOperation {
    action: Action,
    layer: Option<String>,
    conditions: Vec<String>,
}

impl TextOperation {
    /// The operation.
    ///
    /// # Errors
    /// `InputError` for text that is not a condition.
    pub(crate) fn operation(self, py: Python<'_>) -> PyResult<Operation> {
        let condition = |text: String| {
            text.parse::<Condition>().map_err(|fault| {
                errors::input(py, &format!("where: {fault}"), Some(&format!("conditions are {EXPECTED}")))
            })
        };
        let conditions = self.conditions.into_iter().map(condition).collect::<PyResult<_>>()?;
        Ok(Operation { action: self.action, layer: self.layer, conditions })
    }
}

/// A colour as #rrggbb; `None` for text that is not a colour.
#[pyfunction]
pub(crate) fn colour(text: &str) -> Option<String> {
    css::colour(text).map(|colour| colour.to_string())
}

/// The colours of a palette file, as #rrggbb.
#[pyfunction]
pub(crate) fn palette(py: Python<'_>, named: Named) -> PyResult<Vec<String>> {
    let (name, bytes) = named;
    let colours = vtex::control::palette(&bytes, &name).map_err(|error| errors::raised(py, &error))?;
    Ok(colours.iter().map(ToString::to_string).collect())
}
