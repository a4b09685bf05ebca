//! Any program's SVG as a tree of shapes.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster
//! images are not read.

use flate2::read::GzDecoder;
use resvg::usvg;
use std::borrow::Cow;
use std::io::Read;

use crate::error::{Error, Result};

/// Largest SVG read, unpacked, in bytes.
const LARGEST_TEXT: u64 = 1 << 30;

/// Parses an SVG or SVGZ; `name` appears in errors.
///
/// # Errors
/// What `fail` makes of the reason, if it cannot be parsed; [`Error::TooLarge`] beyond 1 GiB of
/// text.
pub(crate) fn parse(bytes: &[u8], name: &str, fail: impl Fn(String) -> Error) -> Result<usvg::Tree> {
    let text = unpack(bytes, name, &fail)?;
    let options = usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    };
    usvg::Tree::from_data(&text, &options).map_err(|e| fail(e.to_string()))
}

/// The text itself, unpacked if it is gzip.
pub(crate) fn unpack<'a>(
    bytes: &'a [u8],
    name: &str,
    fail: impl Fn(String) -> Error,
) -> Result<Cow<'a, [u8]>> {
    let mut unpacked = Vec::new();
    let is_gzip = bytes.starts_with(&[0x1f, 0x8b]);
    if is_gzip {
        GzDecoder::new(bytes)
            .take(LARGEST_TEXT + 1)
            .read_to_end(&mut unpacked)
            .map_err(|e| fail(format!("damaged gzip data: {e}")))?;
    }
    if bytes.len().max(unpacked.len()) as u64 > LARGEST_TEXT {
        return Err(Error::TooLarge {
            name: name.into(),
            found: "more than 1 GiB of SVG text".into(),
            limit: "1 GiB".into(),
        });
    }
    Ok(if is_gzip { unpacked.into() } else { bytes.into() })
}
