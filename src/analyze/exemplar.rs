//! Loading the exemplar: any common image to plain 8-bit RGB, within limits.
//!
//! Works badly with colour profiles other than sRGB: they are not applied.

use crate::error::{Error, Result};
use image::metadata::Orientation;
use image::{DynamicImage, GrayAlphaImage, ImageDecoder, ImageReader, RgbImage, RgbaImage};
use sha2::{Digest, Sha256};
use std::io::Cursor;
use std::path::Path;

/// The photograph that a library is made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exemplar {
    /// Its pixels, 8-bit sRGB, upright.
    pub image: RgbImage,
    /// Its file name, without the folder.
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// What was done to the image that the user may not expect.
    pub warnings: Vec<String>,
}

/// What is refused before it is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest side, in pixels. Default 16384.
    pub side: u32,
    /// Most memory for the pixels as decoded and as kept, in bytes. Default 3 GiB: room for
    /// 16384 × 16384 pixels of 16-bit RGB with alpha.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { side: Exemplar::LARGEST_SIDE, memory: 3 << 30 }
    }
}

impl Exemplar {
    /// Smallest side, in pixels.
    pub const SMALLEST_SIDE: u32 = 32;
    /// Largest side that a library can describe, in pixels.
    pub const LARGEST_SIDE: u32 = 16_384;

    /// Reads an image file.
    ///
    /// # Errors
    /// [`Error::Read`], and as [`Exemplar::from_bytes`].
    pub fn open(path: &Path, limits: &Limits) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::read(path, e))?;
        let file = path.file_name().unwrap_or(path.as_os_str());
        Self::from_bytes(&bytes, &file.to_string_lossy(), limits)
    }

    /// Decodes a PNG, JPEG, TIFF, WebP, BMP, GIF or PNM, told apart by content. Of an animation the
    /// first frame counts. 16-bit samples are rounded to 8, grey becomes RGB, CMYK is converted,
    /// the rotation of EXIF is applied. Whatever is transparent is laid over white, with a warning.
    ///
    /// # Errors
    /// [`Error::Decode`] if it is no image or damaged, [`Error::TooLarge`] beyond `limits`,
    /// [`Error::Unusable`] below 32 × 32 pixels or if all pixels are alike.
    pub fn from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        let mut warnings = Vec::new();
        let image = decode(bytes, name, limits, &mut warnings)?;
        let (width, height) = image.dimensions();
        let unusable = |reason| Error::Unusable { name: name.into(), reason };
        if width.min(height) < Self::SMALLEST_SIDE {
            let least = Self::SMALLEST_SIDE;
            return Err(unusable(format!(
                "it has {width} x {height} pixels, at least {least} x {least} are needed"
            )));
        }
        let first = image.get_pixel(0, 0).0;
        if image.pixels().all(|p| p.0 == first) {
            let colour = crate::raster::colour::Colour(first);
            return Err(unusable(format!("every pixel has the colour {colour}, there is no texture to see")));
        }
        Ok(Self { image, file: name.into(), sha256: sha256(bytes), warnings })
    }
}

fn decode(bytes: &[u8], name: &str, limits: &Limits, warnings: &mut Vec<String>) -> Result<RgbImage> {
    let fail = |reason: String| Error::Decode { name: name.into(), reason };
    if bytes.is_empty() {
        return Err(fail("the file is empty".into()));
    }
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fail(e.to_string()))?;
    let Some(format) = reader.format() else { return Err(fail("its format is not known".into())) };
    // Limits are checked below, where the error can name them; decoders get the memory limit as
    // well for what they need beside the pixels.
    let mut inner = image::Limits::no_limits();
    inner.max_alloc = Some(limits.memory);
    reader.limits(inner);
    let mut decoder = reader.into_decoder().map_err(|e| fail(e.to_string()))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(fail(format!("it has {width} x {height} pixels")));
    }
    let too_large = |found, limit| Error::TooLarge { name: name.into(), found, limit };
    if width.max(height) > limits.side {
        let limit = format!("{} pixels on each side", limits.side);
        return Err(too_large(format!("{width} x {height} pixels"), limit));
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let pixels = u64::from(width) * u64::from(height);
    // As decoded, as RGB, and once more to turn it.
    let copies = 1 + u64::from(orientation != Orientation::NoTransforms);
    let needed = decoder.total_bytes().saturating_add(pixels * 3 * copies);
    if needed > limits.memory {
        let mebibytes = |n: u64| format!("{} MiB of memory", n.div_ceil(1 << 20));
        return Err(too_large(mebibytes(needed), mebibytes(limits.memory)));
    }
    if format == image::ImageFormat::Jpeg && !jpeg_is_whole(bytes) {
        return Err(fail("the file ends in the middle of the picture".into()));
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(|e| fail(e.to_string()))?;
    let mut rgb = DynamicImage::ImageRgb8(flatten(decoded, warnings));
    rgb.apply_orientation(orientation);
    Ok(rgb.into_rgb8())
}

/// Whether the mark of the end follows a JPEG's picture: without it the decoder paints what is
/// missing grey and reports nothing.
fn jpeg_is_whole(bytes: &[u8]) -> bool {
    // Segments before the picture, such as a thumbnail, may hold such a mark of their own.
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [0xff, kind, after @ ..] = rest {
        match (kind, after) {
            (0xda, _) => break,
            (0xff, _) => rest = &rest[1..],
            (_, [high, low, ..]) => {
                let length = usize::from(u16::from_be_bytes([*high, *low]));
                rest = after.get(length..).unwrap_or_default();
            }
            _ => return false,
        }
    }
    rest.windows(2).rev().any(|w| w == [0xff, 0xd9])
}

/// Lays what is transparent over white and rounds to 8 bits.
fn flatten(image: DynamicImage, warnings: &mut Vec<String>) -> RgbImage {
    let over_white = |v: u8, alpha: u8| {
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
                to.0 = [over_white(from.0[0], from.0[1]); 3];
            }
            flat
        }
        image if image.color().has_alpha() => {
            let rgba: RgbaImage = image.into_rgba8();
            let mut flat = RgbImage::new(rgba.width(), rgba.height());
            for (to, from) in flat.pixels_mut().zip(rgba.pixels()) {
                let [r, g, b, alpha] = from.0;
                transparent |= alpha < 255;
                to.0 = [r, g, b].map(|v| over_white(v, alpha));
            }
            flat
        }
        image => image.into_rgb8(),
    };
    if transparent {
        warnings.push("the photograph is partly transparent: it was laid over white".into());
    }
    flat
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
