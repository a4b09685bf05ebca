//! Image → masks: candidates for textons. Knows nothing of textons.

mod courses;
mod disjoint;
mod felzenszwalb;
mod flood;
mod given;
mod masks_file;
mod perceptron;
pub mod prompt;
pub mod regions;
mod similar;
#[cfg(feature = "onnx")]
pub mod texton;
mod tiles;

pub use felzenszwalb::Felzenszwalb;
pub use felzenszwalb::details;
pub use flood::flood;
pub use given::GivenCategory;
pub use masks_file::{MasksFile, masks_to_bytes};
pub use perceptron::Perceptron;
pub use regions::{OneTree, Regions};
pub use tiles::pieces;

use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_base::raster::Mask;

/// A set of pixels that may be a texton, with a confidence.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoredMask {
    /// The pixels, all within the image.
    pub mask: Mask,
    /// Confidence, 0 to 1. Only the order of scores matters.
    pub score: f32,
}

/// A method that finds candidates for textons in an image. Its masks may overlap, contain one another
/// and consist of several pieces. Uncovered pixels are background. One segmenter can serve several
/// threads.
pub trait Segmenter: Send + Sync {
    /// Name that is stored in the library, such as `regions`.
    fn name(&self) -> String;

    /// Finds the masks of an image.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`] if `progress` says stop, and errors of the method itself.
    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>>;

    /// Finds the masks of a photograph that was reduced; `whole` is its width and height before. Masks are those
    /// of the reduced image. Methods that only look at the image need not implement it.
    ///
    /// # Errors
    /// As [`Segmenter::segment`].
    fn segment_reduced(
        &self,
        image: &RgbImage,
        whole: [u32; 2],
        progress: &dyn Progress,
    ) -> Result<Vec<ScoredMask>> {
        let _ = whole;
        self.segment(image, progress)
    }

    /// Categories that a user has given to its masks, over an image of a width and a height. Elements of none belong to
    /// the one that they resemble most. None by default: analysis then finds categories.
    fn categories(&self, size: [u32; 2]) -> Vec<GivenCategory> {
        let _ = size;
        Vec::new()
    }

    /// Whether the size of elements matters to it. Photographs of large elements are then reduced further.
    fn seeks_elements(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_segmenter_serves_several_threads() {
        let shared: Arc<dyn Segmenter> = Arc::new(Regions);
        let other = Arc::clone(&shared);
        let name = std::thread::spawn(move || other.name()).join().unwrap();
        assert_eq!(name, shared.name());
    }
}
