//! Image → masks: what may be a texton. Knows nothing of textons.

mod alike;
mod felzenszwalb;
mod flood;
mod masks_file;
mod perceptron;
pub mod prompt;
pub mod regions;
#[cfg(feature = "onnx")]
pub mod texton;

pub use felzenszwalb::{Felzenszwalb, Smoothed, details, felzenszwalb};
pub use flood::flood;
pub use masks_file::{MasksFile, masks_to_bytes};
pub use perceptron::Perceptron;
pub use regions::Regions;

use crate::error::Result;
use crate::progress::Progress;
use crate::raster::Mask;
use image::RgbImage;

/// A set of pixels that may be a texton, with a confidence.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoredMask {
    /// The pixels, within the image.
    pub mask: Mask,
    /// Confidence, 0 to 1; only the order matters.
    pub score: f32,
}

/// Finds what may be textons in an image: scored masks, which may overlap, contain one another
/// and have several pieces. What no mask covers is ground.
pub trait Segmenter {
    /// Name stored in the library, such as `regions`.
    fn name(&self) -> String;

    /// The masks of an image.
    ///
    /// # Errors
    /// [`crate::Error::Interrupted`], and what the method itself can meet.
    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>>;
}
