//! Decoding of common image formats, within limits.

use super::profile::ColourProfile;
use super::tiff_tags::{Inks, TiffTags, divide_by_alpha};
use super::{foreign, jpeg};
use crate::error::{Error, Large, Result, check};
use image::metadata::Orientation;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, RgbImage};
use std::io::{Cursor, ErrorKind};

/// Default limit of an image's width and height, in pixels.
pub const LARGEST_SIDE: u32 = 16_384;

/// Most bytes of what a PNG holds beside its pixels, unpacked: a colour profile of hundreds of megabytes packs to a few
/// hundred kilobytes.
const PNG_BUFFERS: u64 = 64 << 20;

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

/// Whether content is a picture by its first bytes, of a format that is read or of another.
pub fn is_picture(bytes: &[u8]) -> bool {
    image::guess_format(bytes).is_ok() || foreign::format(bytes).is_some()
}

/// Decodes a PNG, JPEG, TIFF, WebP, BMP, GIF or PNM image of data, such as a mask or a map of heights: samples are as
/// they are stored. The format is detected from the content.
/// Only the first frame of an animation is used. Also returns the EXIF orientation, not yet applied.
/// `kept` is the number of bytes per pixel that the caller keeps besides the decoded image, and
/// again while applying the orientation.
///
/// # Errors
/// [`Error::Decode`] if the bytes are no image or damaged, [`Error::OtherFormat`] for a picture of another kind,
/// [`Error::TooLarge`] beyond `limits`.
pub fn decode(bytes: &[u8], name: &str, limits: &Limits, kept: u64) -> Result<(DynamicImage, Orientation)> {
    decoded(bytes, name, limits, kept, None)
}

/// Decodes an image of colours as [`decode`] does, and converts them to sRGB from their ICC profile, or what a PNG says
/// of them. Profiles that change no colour by more than a step of 8 bits are left out; those that cannot be applied are
/// a warning.
///
/// # Errors
/// Those of [`decode`].
pub fn decode_colours(
    bytes: &[u8],
    name: &str,
    limits: &Limits,
    kept: u64,
    warnings: &mut Vec<String>,
) -> Result<(DynamicImage, Orientation)> {
    decoded(bytes, name, limits, kept, Some(warnings))
}

/// Decodes an image; with `warnings` one of colours.
fn decoded(
    bytes: &[u8],
    name: &str,
    limits: &Limits,
    kept: u64,
    warnings: Option<&mut Vec<String>>,
) -> Result<(DynamicImage, Orientation)> {
    let fail = |reason: String| Error::Decode { name: name.into(), reason };
    let other = |format: String| Err(Error::OtherFormat { name: name.into(), format });
    if bytes.is_empty() {
        return Err(fail("the file is empty".into()));
    }
    if let Some(format) = foreign::format(bytes) {
        return other(format.into());
    }
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fail(e.to_string()))?;
    let Some(format) = reader.format() else { return Err(fail("its format is not known".into())) };
    let mut tags = (format == ImageFormat::Tiff).then(|| TiffTags::new(bytes)).flatten();
    let unread = match (format, &mut tags) {
        (ImageFormat::Jpeg, _) => jpeg::unread(bytes).map(String::from),
        (_, Some(tags)) => tags.unread(),
        _ => None,
    };
    if let Some(format) = unread {
        return other(format);
    }
    // Limits are checked below, where the error can name them. Decoders get the memory limit as well,
    // for their own buffers.
    let mut inner = image::Limits::no_limits();
    let most = if format == ImageFormat::Png { limits.memory.min(PNG_BUFFERS) } else { limits.memory };
    inner.max_alloc = Some(most);
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
    let inks = match decoder.original_color_type() {
        ExtendedColorType::Cmyk8 => 4,
        ExtendedColorType::Cmyk16 => 8,
        _ if format == ImageFormat::Jpeg && jpeg::has_inks(bytes) => 4,
        _ => 0,
    };
    let needed = decoder.total_bytes().saturating_add(pixels * (kept * copies + inks));
    if needed > limits.memory {
        let mebibytes = |n: u64| format!("{} MiB of memory", n.div_ceil(1 << 20));
        return Err(too_large(mebibytes(needed), mebibytes(limits.memory)));
    }
    if format == ImageFormat::Jpeg && !jpeg::is_whole(bytes) {
        return Err(fail("the file ends in the middle of the picture".into()));
    }
    let profile = warnings.is_some().then(|| profile(&mut decoder, tags.as_mut(), bytes)).flatten();
    let mut fault = None;
    if let (1.., Some(Ok(profile))) = (inks, &profile) {
        if !profile.is_for_inks() {
            fault = Some("is not for CMYK as the picture is");
        } else if let Some(rgb) = colours_of_inks(profile, bytes, tags.take(), [width, height], limits) {
            return Ok((rgb.into(), orientation));
        }
    }
    let mut image = DynamicImage::from_decoder(decoder).map_err(|e| fail(reason(&e)))?;
    if tags.is_some_and(|mut tags| tags.has_associated_alpha()) {
        divide_by_alpha(&mut image);
    }
    match profile {
        Some(Ok(profile)) if fault.is_none() && !profile.is_srgb() => match profile.converted(&mut image) {
            Ok(()) => {}
            Err(why) => fault = Some(why),
        },
        Some(Err(why)) => fault = Some(why),
        _ => {}
    }
    if let (Some(why), Some(warnings)) = (fault, warnings) {
        warnings.push(format!("the picture's colour profile {why}: its colours are taken as sRGB"));
    }
    Ok((image, orientation))
}

/// What a file says of its colours, or what is wrong with that.
fn profile(
    decoder: &mut impl ImageDecoder,
    tags: Option<&mut TiffTags<'_>>,
    bytes: &[u8],
) -> Option<Result<ColourProfile, &'static str>> {
    let icc = match tags {
        // `image` reads no profile that is larger than a small picture.
        Some(tags) => tags.icc_profile(),
        None => decoder.icc_profile().ok().flatten(),
    };
    ColourProfile::of_png(bytes).or_else(|| icc.map(|icc| ColourProfile::from_icc(&icc)))
}

/// The colours of a picture of inks; `None` if it is damaged.
fn colours_of_inks(
    profile: &ColourProfile,
    bytes: &[u8],
    tags: Option<TiffTags<'_>>,
    size: [u32; 2],
    limits: &Limits,
) -> Option<RgbImage> {
    let inks = match tags {
        Some(tags) => tags.inks(limits.memory)?,
        None => Inks::Of8Bits(jpeg::inks(bytes)?),
    };
    let count = 4 * size[0] as usize * size[1] as usize;
    match inks {
        Inks::Of8Bits(inks) => (inks.len() == count).then(|| profile.of_inks(&inks, size)),
        Inks::Of16Bits(inks) => (inks.len() == count).then(|| profile.of_inks(&inks, size)),
    }
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
    match error {
        ImageError::Decoding(_) | ImageError::IoError(_) => "its data are damaged".into(),
        ImageError::Limits(_) => "it needs more memory than pictures may".into(),
        _ if text.contains(['{', '}', '"']) => "its data are damaged".into(),
        _ => text,
    }
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

#[cfg(test)]
mod tests;
