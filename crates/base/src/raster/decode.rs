//! Decoding of common image formats, within limits.

use crate::error::{Error, Large, Result, check};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader};
use std::io::{Cursor, ErrorKind};

/// Default limit of an image's width and height, in pixels.
pub const LARGEST_SIDE: u32 = 16_384;

/// Limits of images, checked before they are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest width and height, in pixels. Default 16384.
    pub side: u32,
    /// Most memory for decoded and retained pixels, in bytes. Default 3 GiB, which suffices for
    /// 16384 × 16384 pixels of 16-bit RGBA.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { side: LARGEST_SIDE, memory: 3 << 30 }
    }
}

/// Decodes a PNG, JPEG, TIFF, WebP, BMP, GIF or PNM image; the format is detected from the content.
/// Only the first frame of an animation is used. Also returns the EXIF orientation, not yet applied.
/// `kept` is the number of bytes per pixel that the caller keeps besides the decoded image, and
/// again while applying the orientation.
///
/// # Errors
/// [`Error::Decode`] if the bytes are no image or damaged, [`Error::TooLarge`] beyond `limits`.
pub fn decode(bytes: &[u8], name: &str, limits: &Limits, kept: u64) -> Result<(DynamicImage, Orientation)> {
    let fail = |reason: String| Error::Decode { name: name.into(), reason };
    if bytes.is_empty() {
        return Err(fail("the file is empty".into()));
    }
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fail(e.to_string()))?;
    let Some(format) = reader.format() else { return Err(fail("its format is not known".into())) };
    // Limits are checked below, where the error can name them. Decoders get the memory limit as well,
    // for their own buffers.
    let mut inner = image::Limits::no_limits();
    inner.max_alloc = Some(limits.memory);
    reader.limits(inner);
    let mut decoder = reader.into_decoder().map_err(|e| fail(reason(&e)))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(fail(format!("it has {width} x {height} pixels")));
    }
    let too_large = |found, limit| Error::TooLarge { what: Large::Picture, name: name.into(), found, limit };
    if width.max(height) > limits.side {
        let limit = format!("{} pixels on each side", limits.side);
        return Err(too_large(format!("{width} x {height} pixels"), limit));
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let pixels = u64::from(width) * u64::from(height);
    let copies = 1 + u64::from(orientation != Orientation::NoTransforms);
    let needed = decoder.total_bytes().saturating_add(pixels * kept * copies);
    if needed > limits.memory {
        let mebibytes = |n: u64| format!("{} MiB of memory", n.div_ceil(1 << 20));
        return Err(too_large(mebibytes(needed), mebibytes(limits.memory)));
    }
    if format == image::ImageFormat::Jpeg && !jpeg_is_whole(bytes) {
        return Err(fail("the file ends in the middle of the picture".into()));
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(|e| fail(reason(&e)))?;
    Ok((decoded, orientation))
}

/// The message of a decoder in plain words: decoders print their own types.
fn reason(error: &ImageError) -> String {
    let text = error.to_string();
    if matches!(error, ImageError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof)
        || ["failed to fill whole buffer", "unexpected end", "UnexpectedEof", "end of file"]
            .iter()
            .any(|said| text.contains(said))
    {
        return "the file ends in the middle of the picture".into();
    }
    let types = |c: char| ['{', '}', '"'].contains(&c);
    if text.contains(types) { "its data are damaged".into() } else { text }
}

/// Whether a JPEG's image data is followed by an end marker. Without it the decoder fills the missing
/// part with grey and reports no error.
fn jpeg_is_whole(bytes: &[u8]) -> bool {
    // Segments before the image data, such as a thumbnail, may contain end markers of their own.
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
/// Refuses canvases without pixels, and those with a side beyond [`LARGEST_SIDE`].
///
/// # Errors
/// [`Error::Parameter`], [`Error::TooLarge`].
pub fn check_size([width, height]: [usize; 2]) -> Result<()> {
    check(width.min(height) > 0, "size", format!("{width}x{height}"), "1 px or more on each side")?;
    if width.max(height) <= LARGEST_SIDE as usize {
        return Ok(());
    }
    let found = format!("{width} x {height} pixels");
    Err(Error::TooLarge {
        what: Large::Canvas,
        name: "size".into(),
        found,
        limit: format!("{LARGEST_SIDE} pixels on each side"),
    })
}
