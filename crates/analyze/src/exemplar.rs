//! Loading of exemplars: decodes common image formats to 8-bit RGB, within limits.
//!
//! Colour profiles are ignored: every image is taken for sRGB.

use image::{DynamicImage, RgbImage};
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
    /// animation is used. Colours are converted to sRGB from the colour profile of the image, with a warning
    /// if it cannot be applied. 16-bit samples are rounded to 8 bits, grey and CMYK are converted to RGB, and
    /// the EXIF rotation is applied. Transparent pixels are composited over white, with a warning.
    ///
    /// # Errors
    /// [`Error::Decode`] if the bytes are no image or damaged, [`Error::OtherFormat`] for a picture of another
    /// kind, [`Error::TooLarge`] beyond `limits`,
    /// [`Error::Unusable`] below 32 × 32 pixels or if all pixels have the same colour.
    pub fn from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        let mut warnings = Vec::new();
        let image = raster::decode_over_white(bytes, name, limits, &mut warnings)?;
        Ok(Self { sha256: sha256(bytes), warnings, ..Self::new(image, name, String::new())? })
    }

    /// An image in memory in sRGB, converted as in [`Exemplar::from_bytes`]. Its sum is that of the binary PPM file
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
        let image = raster::over_white(image, &mut warnings);
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

fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
