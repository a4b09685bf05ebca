//! Shapes and their paint.

use super::Gradient;
use crate::geometry::{Affine, Outline};
use crate::raster::colour::Colour;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A filled shape of an element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Its outline, in the coordinates of the element.
    pub outline: Outline,
    /// Fill colour; if there is a gradient, its mean colour.
    pub colour: Colour,
    /// Gradient that replaces the colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<Gradient>,
    /// Opacity, 0 to 1. Default 1.
    #[serde(default = "opaque", skip_serializing_if = "is_opaque")]
    pub opacity: f64,
}

fn opaque() -> f64 {
    1.0
}

fn is_opaque(opacity: &f64) -> bool {
    *opacity == 1.0
}

impl Shape {
    /// An opaque shape of one colour.
    pub fn new(outline: Outline, colour: Colour) -> Self {
        Self { outline, colour, gradient: None, opacity: 1.0 }
    }

    /// The shape with a map that preserves angles applied. The outline stays as it was where the map
    /// leads beyond ±10⁷ pixels.
    pub(crate) fn moved(&self, affine: Affine) -> Self {
        Self {
            outline: Outline::new(&(affine * self.outline.path())).unwrap_or_else(|| self.outline.clone()),
            gradient: self.gradient.map(|g| g.moved(affine)),
            ..*self
        }
    }

    /// The shape with another outline.
    pub(crate) fn with_outline(&self, outline: Outline) -> Self {
        Self { outline, ..*self }
    }

    /// The shape with all its colours changed.
    pub(crate) fn recoloured(&self, new: impl Fn(Colour) -> Colour) -> Self {
        let gradient = self.gradient.map(|g| Gradient { start: new(g.start), end: new(g.end), ..g });
        Self { outline: self.outline.clone(), colour: new(self.colour), gradient, ..*self }
    }

    /// Why the shape is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        if !(0.0..=1.0).contains(&self.opacity) {
            return Some(format!("opacity = {} is not within 0 to 1", self.opacity));
        }
        Some(format!("a gradient {}", self.gradient.as_ref()?.fault()?))
    }
}
