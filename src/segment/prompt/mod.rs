//! Promptable segmenters: a point in, masks of what it lies on out.

mod generator;
mod proposal;
#[cfg(feature = "onnx")]
pub mod sam;

#[cfg(feature = "onnx")]
pub(in crate::segment) use generator::View;
pub use generator::{Cost, Found, Generator, GeneratorParams};
#[cfg(feature = "onnx")]
pub use sam::Sam;

use crate::error::Result;
use image::RgbImage;

/// A network that, shown an image once, gives masks for points in it.
pub trait Prompter: Send + Sync {
    /// Name stored in the library, such as `texton`.
    fn name(&self) -> String;

    /// Shows it an image.
    ///
    /// # Errors
    /// [`crate::Error::Network`] if the network fails.
    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>>;
}

/// An image as a [`Prompter`] sees it.
pub trait Embedded: Send + Sync {
    /// How well the best mask at each point would do, 0 to 1, where that costs next to nothing.
    fn promise(&self, points: &[[f32; 2]]) -> Option<Vec<f32>>;

    /// How many points are best asked for at once.
    fn batch(&self) -> usize;

    /// The masks at each point, x and y in pixels of the image: one to four a point.
    ///
    /// # Errors
    /// [`crate::Error::Network`] if the network fails.
    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>>;
}

/// A mask as logits on a grid of its own: it holds where they are above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct PromptMask {
    /// Intersection over union with the truth as the network predicts it, 0 to 1.
    pub predicted_iou: f32,
    /// Values in rows.
    pub logits: Logits,
}

/// Logits on a grid: the value in column i and row j belongs to the point
/// `origin + step · (i + ½, j + ½)` of the image. Outside the grid the mask does not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Logits {
    /// Corner of the first cell in pixels of the image.
    pub origin: [f32; 2],
    /// Size of a cell in pixels of the image.
    pub step: [f32; 2],
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// The values in rows, `width · height` of them.
    pub values: Vec<f32>,
}

#[cfg(test)]
mod tests;
