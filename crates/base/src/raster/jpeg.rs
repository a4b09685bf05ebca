//! What the decoder of JPEGs does not say.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The segments of a JPEG up to its image data: the number and the content of each.
struct Segments<'a> {
    rest: &'a [u8],
}

impl<'a> Segments<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.get(2..).unwrap_or_default() }
    }
}

impl<'a> Iterator for Segments<'a> {
    type Item = (u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.rest {
                // The image data.
                [0xff, 0xda, ..] => return None,
                [0xff, 0xff, ..] => self.rest = &self.rest[1..],
                [0xff, kind, after @ ..] if after.len() >= 2 => {
                    let length = usize::from(u16::from_be_bytes([after[0], after[1]])).min(after.len());
                    self.rest = &after[length..];
                    return Some((*kind, after.get(2..length).unwrap_or_default()));
                }
                // Cut short.
                [0xff, ..] => {
                    self.rest = &[];
                    return None;
                }
                _ => return None,
            }
        }
    }
}

/// The header of its image data: the way of coding, bits of a sample, and number of channels.
fn frame(bytes: &[u8]) -> Option<(u8, u8, u8)> {
    // Neither tables (0xc4, 0xcc) nor what is reserved (0xc8).
    let is_frame = |kind: u8| (0xc0..=0xcf).contains(&kind) && ![0xc4, 0xc8, 0xcc].contains(&kind);
    Segments::new(bytes).find_map(|(kind, content)| match content {
        [bits, _, _, _, _, channels, ..] if is_frame(kind) => Some((kind, *bits, *channels)),
        _ => None,
    })
}

/// The kind of a JPEG that is not read, with its article.
pub(super) fn unread(bytes: &[u8]) -> Option<&'static str> {
    let (kind, bits, _) = frame(bytes)?;
    match kind {
        0xc9..=0xcf => Some("an arithmetic-coded JPEG"),
        0xc3 => Some("a lossless JPEG"),
        0xc5..=0xc7 => Some("a hierarchical JPEG"),
        _ if bits > 8 => Some("a JPEG of 12 bits"),
        _ => None,
    }
}

/// Whether it has the four channels of inks.
pub(super) fn has_inks(bytes: &[u8]) -> bool {
    frame(bytes).is_some_and(|(_, _, channels)| channels == 4)
}

/// Whether its image data is followed by an end marker. Without it the decoder fills the missing part with grey and
/// reports no error.
pub(super) fn is_whole(bytes: &[u8]) -> bool {
    // Segments before the image data, such as a thumbnail, may contain end markers of their own.
    let mut segments = Segments::new(bytes);
    segments.by_ref().for_each(drop);
    segments.rest.windows(2).rev().any(|w| w == [0xff, 0xd9])
}

/// Inks of a JPEG of four channels, cyan, magenta, yellow and black for each pixel, 0 for no ink; `None` if it is
/// damaged.
pub(super) fn inks(bytes: &[u8]) -> Option<Vec<u8>> {
    let options = || {
        DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX)
    };
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder.decode_headers().ok()?;
    let stored = decoder.input_colorspace()?;
    decoder.set_options(options().jpeg_set_out_colorspace(stored));
    let mut samples = decoder.decode().ok()?;
    let by_adobe = Segments::new(bytes).any(|(kind, content)| kind == 0xee && content.starts_with(b"Adobe"));
    for pixel in samples.chunks_exact_mut(4) {
        if stored == ColorSpace::YCCK {
            let [y, cb, cr] = [0, 1, 2].map(|k| f64::from(pixel[k]));
            let (cb, cr) = (cb - 128.0, cr - 128.0);
            let light = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
            // Light that is left by inks, which are stored as its complement.
            (0..3).for_each(|k| pixel[k] = 255 - libm::round(light[k].clamp(0.0, 255.0)) as u8);
        }
        // Programs of Adobe, and those that follow them, store the complement of inks.
        if by_adobe {
            pixel.iter_mut().for_each(|v| *v = 255 - *v);
        }
    }
    Some(samples)
}
