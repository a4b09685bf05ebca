//! Loading of exemplars: decodes common image formats to 8-bit RGB, within limits. Small tiles are repeated.
//!
//! Colours are converted to sRGB from the colour profile of the image.

use super::small_tiles;
use image::{DynamicImage, RgbImage};
use sha2::{Digest, Sha256};
use std::path::Path;
use vtex_base::error::{Error, Large, Result};
use vtex_base::raster::{self, Limits};
use vtex_field::layers::LayerMap;

/// An exemplar: the photograph that a library is made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exemplar {
    /// Pixels, 8-bit sRGB, with the EXIF rotation applied; those of all copies of a small tile.
    pub image: RgbImage,
    /// Number of copies of a small tile along x and y that the image is made of: 1 and 1 for all other pictures.
    pub copies: [u32; 2],
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
    /// Smallest permitted width and height of a tile that is repeated, in pixels.
    pub const SMALLEST_TILE: u32 = 4;
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
        Self::decoded(bytes, name, limits)?.once(name)
    }

    /// [`Exemplar::from_bytes`] of what may be a small tile, which is repeated to at least 96 px and three copies along
    /// each side: a picture with a side below 32 px, or with one below 64 px whose opposite borders join, or below 128 px if its
    /// structure is fine.
    ///
    /// # Errors
    /// Those of [`Exemplar::from_bytes`], but [`Error::Unusable`] only below 4 × 4 pixels.
    pub fn tile_from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        Ok(Self::decoded(bytes, name, limits)?.repeated())
    }

    fn decoded(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
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
        Self::in_memory(image, name)?.once(name)
    }

    /// [`Exemplar::from_image`] of what may be a small tile, as in [`Exemplar::tile_from_bytes`].
    ///
    /// # Errors
    /// Those of [`Exemplar::from_image`], but [`Error::Unusable`] only below 4 × 4 pixels.
    pub fn tile_from_image(image: DynamicImage, name: &str) -> Result<Self> {
        Ok(Self::in_memory(image, name)?.repeated())
    }

    fn in_memory(image: DynamicImage, name: &str) -> Result<Self> {
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
        check_size(&image, Self::SMALLEST_TILE, name)?;
        let first = image.get_pixel(0, 0).0;
        if image.pixels().all(|p| p.0 == first) {
            let colour = vtex_base::raster::colour::Colour(first);
            let reason = format!("every pixel has the colour {colour}, there is no texture to see");
            let advice = "use a photograph that shows more than one colour";
            return Err(Error::Unusable { name: name.into(), reason, advice });
        }
        Ok(Self { image, copies: [1; 2], file: name.into(), sha256, layers: None, warnings: Vec::new() })
    }

    /// The exemplar, which must be large enough as it is.
    fn once(self, name: &str) -> Result<Self> {
        check_size(&self.image, Self::SMALLEST_SIDE, name)?;
        Ok(self)
    }

    /// The exemplar, repeated if it is a small tile.
    fn repeated(self) -> Self {
        let copies = small_tiles::copies(&self.image);
        if copies == [1; 2] {
            return self;
        }
        Self { image: small_tiles::repeated(&self.image, copies), copies, ..self }
    }
}

/// An error if a side of a picture has fewer than `least` pixels.
fn check_size(image: &RgbImage, least: u32, name: &str) -> Result<()> {
    let (width, height) = image.dimensions();
    if width.min(height) >= least {
        return Ok(());
    }
    let reason = format!("it has {width} x {height} pixels, at least {least} x {least} are needed");
    Err(Error::Unusable { name: name.into(), reason, advice: "use a larger picture" })
}

fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
