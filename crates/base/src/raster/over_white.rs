//! Pictures as opaque colours of 8 bits.

use super::{Limits, decode_colours};
use crate::error::Result;
use image::{DynamicImage, GrayAlphaImage, RgbImage, RgbaImage};

/// Decodes a picture as [`decode_colours`] does and lays it over white, with its EXIF rotation applied. 16-bit samples are
/// rounded to 8 bits, grey and CMYK are converted to RGB.
///
/// # Errors
/// Those of [`decode_colours`].
pub fn decode_over_white(
    bytes: &[u8],
    name: &str,
    limits: &Limits,
    warnings: &mut Vec<String>,
) -> Result<RgbImage> {
    let (decoded, orientation) = decode_colours(bytes, name, limits, 3, warnings)?;
    let mut rgb = DynamicImage::ImageRgb8(over_white(decoded, warnings));
    rgb.apply_orientation(orientation);
    Ok(rgb.into_rgb8())
}

/// Lays transparent pixels over white, with a warning, and rounds to 8 bits.
pub fn over_white(image: DynamicImage, warnings: &mut Vec<String>) -> RgbImage {
    let mixed = |v: u8, alpha: u8| {
        let (v, alpha) = (u32::from(v), u32::from(alpha));
        ((v * alpha + 255 * (255 - alpha) + 127) / 255) as u8
    };
    let mut transparent = false;
    let flat = match image {
        DynamicImage::ImageLumaA8(_) | DynamicImage::ImageLumaA16(_) => {
            let grey: GrayAlphaImage = image.into_luma_alpha8();
            let mut flat = RgbImage::new(grey.width(), grey.height());
            for (to, from) in flat.pixels_mut().zip(grey.pixels()) {
                transparent |= from.0[1] < 255;
                to.0 = [mixed(from.0[0], from.0[1]); 3];
            }
            flat
        }
        image if image.color().has_alpha() => {
            let rgba: RgbaImage = image.into_rgba8();
            let mut flat = RgbImage::new(rgba.width(), rgba.height());
            for (to, from) in flat.pixels_mut().zip(rgba.pixels()) {
                let [r, g, b, alpha] = from.0;
                transparent |= alpha < 255;
                to.0 = [r, g, b].map(|v| mixed(v, alpha));
            }
            flat
        }
        image => image.into_rgb8(),
    };
    if transparent {
        warnings.push("the picture is partly transparent: it was laid over white".into());
    }
    flat
}
