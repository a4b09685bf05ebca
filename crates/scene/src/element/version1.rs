//! The shapes of elements as version 1 of libraries and scenes stored them.

use super::{Gradient, Shape};
use serde::Deserialize;
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;

/// A detail of an element.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Version1Detail {
    outline: Outline,
    colour: Colour,
    #[serde(default)]
    gradient: Option<Box<Gradient>>,
}

impl From<Version1Detail> for Shape {
    fn from(old: Version1Detail) -> Self {
        Self { gradient: old.gradient, ..Self::new(old.outline, old.colour) }
    }
}

/// A base and the details on it, as the shapes of one element.
pub(crate) fn shapes(
    outline: Outline,
    colour: Colour,
    gradient: Option<Box<Gradient>>,
    details: Vec<Version1Detail>,
) -> Vec<Shape> {
    let base = Shape { gradient, ..Shape::new(outline, colour) };
    std::iter::once(base).chain(details.into_iter().map(Shape::from)).collect()
}
