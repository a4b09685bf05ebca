//! Loading of exemplars: decodes common image formats to 8-bit RGB, within limits.
//!
//! Colour profiles are ignored: every image is taken for sRGB.

use image::{DynamicImage, GrayAlphaImage, RgbImage, RgbaImage};
use sha2::{Digest, Sha256};
use std::path::Path;
use vtex_base::error::{Error, Large, Result};
use vtex_base::raster::{self, Limits};
use vtex_field::layers::LayerMap;

/// An exemplar: the photograph that a library is made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exemplar {
    /// Pixels, 8-bit sRGB, with the EXIF rotation applied.
    pub image: RgbImage,
    /// File name without the folder.
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// A painted layer map of its size, used in place of layers found. Usually `None`.
    pub layers: Option<LayerMap>,
    /// Conversions that the user may not expect, one sentence each. Usually empty.
    pub warnings: Vec<String>,
}

impl Exemplar {
    /// Smallest permitted width and height, in pixels.
    pub const SMALLEST_SIDE: u32 = 32;
    /// Largest permitted width and height, in pixels.
    pub const LARGEST_SIDE: u32 = raster::LARGEST_SIDE;

    /// Reads and decodes an image file; see [`Exemplar::from_bytes`].
    ///
    /// # Errors
    /// [`Error::Read`] if the file cannot be read, and the errors of [`Exemplar::from_bytes`].
    pub fn open(path: &Path, limits: &Limits) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::read(path, e))?;
        let file = path.file_name().unwrap_or(path.as_os_str());
        Self::from_bytes(&bytes, &file.to_string_lossy(), limits)
    }

    /// Decodes a PNG, JPEG, TIFF, WebP, BMP, GIF or PNM image; the format is detected from the
    /// content. `name` is stored as the file name and appears in errors. Only the first frame of an
    /// animation is used. 16-bit samples are rounded to 8 bits, grey and CMYK are converted to RGB, and
    /// the EXIF rotation is applied. Transparent pixels are composited over white, with a warning.
    ///
    /// # Errors
    /// [`Error::Decode`] if the bytes are no image or damaged, [`Error::TooLarge`] beyond `limits`,
    /// [`Error::Unusable`] below 32 × 32 pixels or if all pixels have the same colour.
    pub fn from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        let mut warnings = Vec::new();
        let image = decode(bytes, name, limits, &mut warnings)?;
        Ok(Self { sha256: sha256(bytes), warnings, ..Self::new(image, name, String::new())? })
    }

    /// An image in memory, converted as in [`Exemplar::from_bytes`]. Its sum is that of the binary PPM file
    /// that its pixels would be.
    ///
    /// # Errors
    /// [`Error::Unusable`] below 32 × 32 pixels or if all pixels have the same colour,
    /// [`Error::TooLarge`] beyond [`Exemplar::LARGEST_SIDE`].
    pub fn from_image(image: DynamicImage, name: &str) -> Result<Self> {
        let (width, height) = (image.width(), image.height());
        if width.max(height) > Self::LARGEST_SIDE {
            let found = format!("{width} x {height} pixels");
            let limit = format!("{} pixels on each side", Self::LARGEST_SIDE);
            return Err(Error::TooLarge { what: Large::Picture, name: name.into(), found, limit });
        }
        let mut warnings = Vec::new();
        let image = flatten(image, &mut warnings);
        let mut hash = Sha256::new();
        hash.update(format!("P6\n{width} {height}\n255\n"));
        hash.update(image.as_raw());
        Ok(Self { warnings, ..Self::new(image, name, hexadecimal(hash))? })
    }

    fn new(image: RgbImage, name: &str, sha256: String) -> Result<Self> {
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
            let colour = vtex_base::raster::colour::Colour(first);
            return Err(unusable(format!("every pixel has the colour {colour}, there is no texture to see")));
        }
        Ok(Self { image, file: name.into(), sha256, layers: None, warnings: Vec::new() })
    }
}

fn decode(bytes: &[u8], name: &str, limits: &Limits, warnings: &mut Vec<String>) -> Result<RgbImage> {
    let (decoded, orientation) = raster::decode(bytes, name, limits, 3)?;
    let mut rgb = DynamicImage::ImageRgb8(flatten(decoded, warnings));
    rgb.apply_orientation(orientation);
    Ok(rgb.into_rgb8())
}

/// Composites transparent pixels over white and rounds to 8 bits.
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
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
