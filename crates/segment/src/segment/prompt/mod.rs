//! Promptable segmenters: they return masks of the object at a given point.

mod generator;
mod proposal;

#[cfg(feature = "onnx")]
pub(in crate::segment) use generator::View;
pub use generator::{Cost, FoundMask, Generator, GeneratorParams};

use image::RgbImage;
use vtex_base::error::Result;

/// A promptable network. It embeds an image once and then gives masks for points in it.
pub trait Prompter: Send + Sync {
    /// Name that is stored in the library, such as `texton`.
    fn name(&self) -> String;

    /// Embeds an image.
    ///
    /// # Errors
    /// [`vtex_base::Error::Network`] if the network fails.
    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>>;
}

/// An image embedded by a [`Prompter`].
pub trait Embedded: Send + Sync {
    /// Predicted IoU of the best mask at each point, 0 to 1, without decoding it. `None` if the network
    /// cannot give it cheaply. `points` in pixels of the image.
    fn expected_iou(&self, points: &[[f32; 2]]) -> Option<Vec<f32>>;

    /// Number of points per call of [`Embedded::masks`] at which it is most efficient.
    fn batch(&self) -> usize;

    /// One to four masks for each point. `points` are x and y in pixels of the image.
    ///
    /// # Errors
    /// [`vtex_base::Error::Network`] if the network fails.
    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>>;
}

/// A mask given by a prompt, as logits: positive values are inside.
#[derive(Clone, Debug, PartialEq)]
pub struct PromptMask {
    /// IoU with the true mask as predicted by the network, 0 to 1.
    pub predicted_iou: f32,
    /// The logits.
    pub logits: Logits,
}

/// Logits on a grid. The value in column i and row j belongs to the point
/// `origin + step · (i + ½, j + ½)` of the image. The mask does not extend beyond the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Logits {
    /// Corner of the first cell, in pixels of the image.
    pub origin: [f32; 2],
    /// Size of a cell, in pixels of the image.
    pub step: [f32; 2],
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// The values, row by row.
    pub values: Vec<f32>,
}

#[cfg(test)]
mod tests;
