//! Numbers and colours that may vary over the canvas.

use super::Files;
use vtex_base::error::EditFault;
use vtex_base::geometry::Point;
use vtex_base::raster::ControlMap;
use vtex_base::raster::colour::Colour;
use vtex_drawing::control::ColourMap;
use vtex_scene::scene::{ColourOrMap, Instance, NumberOrMap, Scene};

/// A number: constant, or a map of numbers.
pub(super) enum Amount<'a> {
    Number(f64),
    Map(&'a ControlMap),
}

impl<'a> Amount<'a> {
    /// The number of an operation, with the map that it names.
    pub(super) fn new(number: &NumberOrMap, files: &'a Files) -> Result<Self, EditFault> {
        Ok(match number {
            NumberOrMap::Number(number) => Self::Number(*number),
            NumberOrMap::Map(name) => Self::Map(files.map(name)?),
        })
    }

    /// The value at an instance's place; white in a map is `white`.
    pub(super) fn of(&self, scene: &Scene, instance: &Instance, white: f64) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Map(map) => {
                let at = scene.place(instance);
                map.at([at.x, at.y], [f64::from(scene.width), f64::from(scene.height)]) * white
            }
        }
    }

    /// The value as a factor: middle grey is 1, white is 2.
    pub(super) fn factor(&self, scene: &Scene, instance: &Instance) -> f64 {
        let factor = self.of(scene, instance, 2.0);
        // Neither of the two middle grey values of 8 bits is exactly 1, so both count as 1.
        if matches!(self, Self::Map(_)) && (factor - 1.0).abs() < 1.0 / 255.0 { 1.0 } else { factor }
    }
}

/// A colour: constant, or a picture of colours.
pub(super) enum ColourByPlace<'a> {
    Colour(Colour),
    Map(&'a ColourMap),
}

impl<'a> ColourByPlace<'a> {
    /// The colour of an operation, with the picture that it names.
    pub(super) fn new(colour: &ColourOrMap, files: &'a Files) -> Result<Self, EditFault> {
        Ok(match colour {
            ColourOrMap::Colour(colour) => Self::Colour(*colour),
            ColourOrMap::Map(name) => Self::Map(files.colours(name)?),
        })
    }

    /// The colour at a point of a canvas, in Oklab, and its opacity.
    pub(super) fn at(&self, point: Point, canvas: [f64; 2]) -> ([f32; 3], f64) {
        match self {
            Self::Colour(colour) => (colour.to_oklab(), 1.0),
            Self::Map(map) => map.at([point.x, point.y], canvas),
        }
    }
}
