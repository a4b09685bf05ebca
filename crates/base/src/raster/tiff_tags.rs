//! What the decoder of TIFFs does not say.

use image::DynamicImage;
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

/// A TIFF whose tags can be read.
pub(super) struct TiffTags<'a>(Decoder<Cursor<&'a [u8]>>);

/// Inks: cyan, magenta, yellow and black for each pixel, 0 for no ink.
pub(super) enum Inks {
    Of8Bits(Vec<u8>),
    Of16Bits(Vec<u16>),
}

impl<'a> TiffTags<'a> {
    /// `None` if it is damaged.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        Decoder::new(Cursor::new(bytes)).ok().map(Self)
    }

    /// The first value of a tag.
    fn first(&mut self, tag: Tag) -> Option<u64> {
        self.0.find_tag_unsigned_vec(tag).ok()??.first().copied()
    }

    /// Its ICC profile.
    pub(super) fn icc_profile(&mut self) -> Option<Vec<u8>> {
        self.0.find_tag(Tag::IccProfile).ok()??.into_u8_vec().ok()
    }

    /// Whether colours are stored multiplied by their opacity.
    pub(super) fn has_associated_alpha(&mut self) -> bool {
        self.first(Tag::ExtraSamples) == Some(1)
    }

    /// The kind of a TIFF that is not read, with its article.
    pub(super) fn unread(&mut self) -> Option<String> {
        // The first picture of a camera's file is a small one, the raw one is beneath it.
        let is_reduced = self.first(Tag::NewSubfileType).is_some_and(|kind| kind & 1 == 1);
        if is_reduced && self.first(Tag::SubIfd).is_some() {
            return Some("a raw photograph of a camera".into());
        }
        let colours = match self.first(Tag::PhotometricInterpretation) {
            Some(3) => "a palette",
            Some(6) => "YCbCr colours",
            Some(8..=10) => "Lab colours",
            _ => "",
        };
        if !colours.is_empty() {
            return Some(format!("a TIFF with {colours}"));
        }
        let bits = match self.0.colortype().ok()? {
            ColorType::Gray(1) | ColorType::RGB(32) | ColorType::RGBA(32) => return None,
            ColorType::CMYKA(_) => return Some("a TIFF with CMYK colours and transparency".into()),
            ColorType::Multiband { num_samples: 2, .. } => {
                return Some("a TIFF with transparent grey".into());
            }
            ColorType::Multiband { num_samples, .. } => {
                return Some(format!("a TIFF with {num_samples} channels"));
            }
            other => other.bit_depth(),
        };
        (![8, 16].contains(&bits)).then(|| format!("a TIFF with {bits} bits for each sample"))
    }

    /// Its inks, decoded in at most `memory` bytes; `None` if it has none or is damaged.
    pub(super) fn inks(self, memory: u64) -> Option<Inks> {
        let most = usize::try_from(memory).unwrap_or(usize::MAX);
        let mut limits = Limits::default();
        (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (most, most);
        let mut decoder = self.0.with_limits(limits);
        let (width, height) = decoder.dimensions().ok()?;
        let samples = 4 * width as usize * height as usize;
        match (decoder.colortype().ok()?, decoder.read_image().ok()?) {
            (ColorType::CMYK(8), DecodingResult::U8(v)) if v.len() == samples => Some(Inks::Of8Bits(v)),
            (ColorType::CMYK(16), DecodingResult::U16(v)) if v.len() == samples => Some(Inks::Of16Bits(v)),
            _ => None,
        }
    }
}

/// Divides the colours of a picture by their opacity.
pub(super) fn divide_by_alpha(image: &mut DynamicImage) {
    /// Pixels of `each` samples, the last of which is the opacity.
    fn divide<S: Copy + Into<f64>>(pixels: &mut [S], each: usize, most: f64, of: impl Fn(f64) -> S) {
        for pixel in pixels.chunks_exact_mut(each) {
            let alpha: f64 = pixel[each - 1].into();
            let by = if alpha > 0.0 { most / alpha } else { 0.0 };
            pixel[..each - 1].iter_mut().for_each(|v| *v = of((<S as Into<f64>>::into(*v) * by).min(most)));
        }
    }
    let whole = |v: f64| libm::round(v);
    match image {
        DynamicImage::ImageLumaA8(p) => divide(p, 2, 255.0, |v| whole(v) as u8),
        DynamicImage::ImageRgba8(p) => divide(p, 4, 255.0, |v| whole(v) as u8),
        DynamicImage::ImageLumaA16(p) => divide(p, 2, 65535.0, |v| whole(v) as u16),
        DynamicImage::ImageRgba16(p) => divide(p, 4, 65535.0, |v| whole(v) as u16),
        DynamicImage::ImageRgba32F(p) => divide(p, 4, 1.0, |v| v as f32),
        _ => {}
    }
}
