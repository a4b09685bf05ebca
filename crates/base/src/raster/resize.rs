//! Pictures at another size.

use fast_image_resize::images::{TypedImage, TypedImageRef};
use fast_image_resize::pixels::U8x3;
use fast_image_resize::{FilterType, ResizeAlg, ResizeOptions, Resizer};
use image::RgbImage;

/// How pixels are weighted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The mean of the pixels that become one when reducing; linear interpolation when enlarging.
    Triangle,
    /// Catmull and Rom's cubic: sharp when enlarging.
    CatmullRom,
    /// Lanczos' filter of three lobes: sharp when reducing.
    Lanczos,
}

/// A picture at another size; black if it has no pixels.
pub fn resized(image: &RgbImage, width: u32, height: u32, filter: Filter) -> RgbImage {
    let mut to = RgbImage::new(width, height);
    let filter = match filter {
        Filter::Triangle => FilterType::Bilinear,
        Filter::CatmullRom => FilterType::CatmullRom,
        Filter::Lanczos => FilterType::Lanczos3,
    };
    let options = ResizeOptions::new().resize_alg(ResizeAlg::Convolution(filter));
    const WHOLE: &str = "a picture has all of its pixels";
    let source = TypedImageRef::<U8x3>::from_buffer(image.width(), image.height(), image.as_raw());
    let mut target = TypedImage::<U8x3>::from_buffer(width, height, to.as_mut()).expect(WHOLE);
    Resizer::new().resize_typed(&source.expect(WHOLE), &mut target, &options).expect(WHOLE);
    to
}
