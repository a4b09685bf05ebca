//! Any program's SVG as a tree of shapes.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster
//! images are not read.

use crate::error::{Error, Result};
use crate::gzip;
use resvg::usvg::{self, roxmltree};

/// Largest SVG read, unpacked, in bytes.
const LARGEST_TEXT: usize = 1 << 30;

/// Bytes by which an SVG is recognised.
const HEAD: usize = 4096;

/// Whether bytes, plain or gzip, begin as an SVG does.
pub(crate) fn is_svg(bytes: &[u8]) -> bool {
    let head = gzip::beginning(bytes, HEAD);
    let text = String::from_utf8_lossy(&head);
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<') && text.contains("<svg")
}

/// Parses an SVG or SVGZ; `name` appears in errors.
///
/// # Errors
/// As [`text`], [`document`] and [`tree`].
pub(crate) fn parse(bytes: &[u8], name: &str, fail: impl Fn(String) -> Error) -> Result<usvg::Tree> {
    let text = text(bytes, name, &fail)?;
    document(&text).and_then(|document| tree(&document)).map_err(fail)
}

/// The text of an SVG or SVGZ.
///
/// # Errors
/// What `fail` makes of the reason, if it is damaged or not UTF-8; [`Error::TooLarge`] beyond 1 GiB.
pub(crate) fn text(bytes: &[u8], name: &str, fail: impl Fn(String) -> Error) -> Result<String> {
    let bytes = gzip::unpack(bytes, LARGEST_TEXT as u64 + 1).map_err(&fail)?;
    if bytes.len() > LARGEST_TEXT {
        let (found, limit) = ("more than 1 GiB of SVG text".into(), "1 GiB".into());
        return Err(Error::TooLarge { name: name.into(), found, limit });
    }
    let text = String::from_utf8(bytes.into_owned()).map_err(|_| fail("it is not UTF-8 text".into()))?;
    Ok(text.strip_prefix('\u{feff}').map(Into::into).unwrap_or(text))
}

/// The XML of a text.
///
/// # Errors
/// Where it is not well formed.
pub(crate) fn document(text: &str) -> Result<roxmltree::Document<'_>, String> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options).map_err(|e| e.to_string())
}

/// The shapes of a document, every `<use>` followed.
///
/// # Errors
/// Why it is not an SVG.
pub(crate) fn tree(document: &roxmltree::Document<'_>) -> Result<usvg::Tree, String> {
    tree_of(document, || None)
}

/// The same, with an empty drawing wherever a raster image or another file is shown.
///
/// # Errors
/// As [`tree`].
pub(crate) fn tree_with_images(document: &roxmltree::Document<'_>) -> Result<usvg::Tree, String> {
    let empty = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>"#;
    tree_of(document, || {
        usvg::Tree::from_str(empty, &usvg::Options::default()).ok().map(usvg::ImageKind::SVG)
    })
}

fn tree_of(
    document: &roxmltree::Document<'_>,
    image: impl Fn() -> Option<usvg::ImageKind> + Copy + Send + Sync,
) -> Result<usvg::Tree, String> {
    let options = usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(move |_, _, _| image()),
            resolve_string: Box::new(move |_, _| image()),
        },
        ..usvg::Options::default()
    };
    usvg::Tree::from_xmltree(document, &options).map_err(|e| match e {
        usvg::Error::ParsingFailed(e) => format!("it is not well-formed XML: {e}"),
        usvg::Error::InvalidSize => "its width, height or viewBox is missing, 0 or no number".into(),
        usvg::Error::ElementsLimitReached => "it has too many elements".into(),
        e => e.to_string(),
    })
}
