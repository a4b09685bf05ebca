//! SVG → pixels, any program's SVG.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster
//! images are not drawn.

use super::picture_size;
use crate::error::{Error, Result};
use flate2::read::GzDecoder;
use resvg::usvg;
use std::borrow::Cow;
use std::io::Read;
use tiny_skia::{Pixmap, Transform};

/// Largest SVG read, unpacked, in bytes.
const LARGEST_TEXT: u64 = 1 << 30;

/// Draws an SVG or SVGZ, `scale` pixels of the picture to a unit of the SVG; the size is rounded.
/// `name` appears in errors.
///
/// # Errors
/// Not an SVG that can be parsed; a scale that is not above 0; [`Error::TooLarge`] beyond 2³⁰
/// pixels or 1 GiB of text.
pub fn render_svg(bytes: &[u8], scale: f64, name: &str) -> Result<Pixmap> {
    let fail = |reason: String| Error::Render { name: name.into(), reason };
    let text = unpack(bytes, name)?;
    let options = usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_data(&text, &options).map_err(|e| fail(e.to_string()))?;
    let (w, h) = (tree.size().width(), tree.size().height());
    let (width, height) = picture_size(f64::from(w), f64::from(h), scale, name)?;
    let mut pixmap = Pixmap::new(width, height)
        .ok_or_else(|| fail(format!("a picture of {width} x {height} pixels cannot be held in memory")))?;
    let transform = Transform::from_scale(width as f32 / w, height as f32 / h);
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    Ok(pixmap)
}

/// The text itself, unpacked if it is gzip.
fn unpack<'a>(bytes: &'a [u8], name: &str) -> Result<Cow<'a, [u8]>> {
    let mut unpacked = Vec::new();
    let is_gzip = bytes.starts_with(&[0x1f, 0x8b]);
    if is_gzip {
        GzDecoder::new(bytes)
            .take(LARGEST_TEXT + 1)
            .read_to_end(&mut unpacked)
            .map_err(|e| Error::Render { name: name.into(), reason: format!("damaged gzip data: {e}") })?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    const RED: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="30" height="20"><rect width="30" height="20" fill="red"/>"#;

    #[test]
    fn plain_and_packed() {
        let text = format!("{RED}</svg>");
        let mut packed = crate::output::file::gzip(Vec::new());
        packed.write_all(text.as_bytes()).unwrap();
        let packed = packed.finish().unwrap();
        for bytes in [text.as_bytes(), &packed] {
            let picture = render_svg(bytes, 1.5, "red.svg").unwrap();
            assert_eq!((picture.width(), picture.height()), (45, 30));
            assert!(picture.pixels().iter().all(|p| (p.red(), p.green(), p.alpha()) == (255, 0, 255)));
        }
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        let deep = format!("{RED}{}", "<g>".repeat(100_000));
        let bomb = "<!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;'><!ENTITY c '&b;&b;&b;'>]>\
                    <svg>&c;";
        for bad in ["", "no svg", "<svg", "<html/>", RED, bomb, &deep, "\u{1f}\u{fffd}"] {
            let error = render_svg(bad.as_bytes(), 1.0, "bad.svg").unwrap_err();
            assert!(matches!(error, Error::Render { .. }), "{error}");
        }
        assert!(render_svg(&[0x1f, 0x8b, 8, 0, 1], 1.0, "bad.svgz").is_err());
    }

    #[test]
    fn deep_nesting_is_no_harm() {
        let deep = format!("{RED}{}{}</svg>", "<g>".repeat(100_000), "</g>".repeat(100_000));
        let _ = render_svg(deep.as_bytes(), 1.0, "deep.svg");
    }

    #[test]
    fn pictures_are_never_loaded() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner.svg");
        std::fs::write(&inner, format!("{RED}</svg>")).unwrap();
        let outer = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="30" height="20"><image width="30" height="20" href="{}"/></svg>"#,
            inner.display()
        );
        let picture = render_svg(outer.as_bytes(), 1.0, "outer.svg").unwrap();
        assert!(picture.pixels().iter().all(|p| p.alpha() == 0));
    }

    #[test]
    fn huge_pictures_are_refused() {
        let huge = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1e9" height="1e9"/>"#;
        assert!(matches!(render_svg(huge.as_bytes(), 1.0, "huge.svg"), Err(Error::TooLarge { .. })));
    }
}
