//! stand-in
use image::RgbImage;
/// An exemplar.
pub struct Exemplar {
    /// Pixels.
    pub image: RgbImage,
    /// Name.
    pub file: String,
    /// Hash.
    pub sha256: String,
}
