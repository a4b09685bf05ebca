//! SVG → pixels, any program's SVG.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster
//! images are not drawn.

use super::picture_size;
use crate::error::{Error, Result};
use crate::svg_tree;
use resvg::usvg::{Group, Tree};
use tiny_skia::{Pixmap, Transform};

/// Furthest place of a shape, in pixels of the picture: beyond some 10⁹ curves cannot be drawn.
const FURTHEST: f32 = 1e8;

/// Draws an SVG or SVGZ, `scale` pixels of the picture to a unit of the SVG; the size is rounded.
/// `name` appears in errors.
///
/// # Errors
/// Not an SVG that can be parsed; a shape that reaches 10⁸ pixels away; a scale that is not above 0;
/// [`Error::TooLarge`] beyond 2³⁰ pixels or 1 GiB of text.
pub fn render_svg(bytes: &[u8], scale: f64, name: &str) -> Result<Pixmap> {
    let fail = |reason: String| Error::Render { name: name.into(), reason };
    let tree = svg_tree::parse(bytes, name, fail)?;
    let (w, h) = (tree.size().width(), tree.size().height());
    let (width, height) = picture_size(f64::from(w), f64::from(h), scale, name)?;
    let mut pixmap = Pixmap::new(width, height)
        .ok_or_else(|| fail(format!("a picture of {width} x {height} pixels cannot be held in memory")))?;
    let transform = Transform::from_scale(width as f32 / w, height as f32 / h);
    if furthest(&tree) * transform.sx.max(transform.sy) > FURTHEST {
        return Err(fail("it has a shape that reaches further than can be drawn".into()));
    }
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    Ok(pixmap)
}

/// How far from the origin anything lies, in units of the SVG.
fn furthest(tree: &Tree) -> f32 {
    let hidden = (tree.clip_paths().iter().map(|c| c.root()))
        .chain(tree.masks().iter().map(|m| m.root()))
        .chain(tree.patterns().iter().map(|p| p.root()));
    let reach = |group: &Group| {
        let (own, all) = (group.stroke_bounding_box(), group.abs_stroke_bounding_box());
        [own.left(), own.top(), own.right(), own.bottom(), all.left(), all.top(), all.right(), all.bottom()]
            .into_iter()
            .fold(0.0, |most: f32, v| most.max(v.abs()))
    };
    hidden.map(reach).fold(reach(tree.root()), f32::max)
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
    fn shapes_that_reach_too_far_are_refused() {
        let curve = |far: &str| format!(r#"<path d="M7 18c-4.1-{far} 9-2 13-1l5 9z"/>"#);
        let draw = |inside: String| render_svg(format!("{RED}{inside}</svg>").as_bytes(), 1.0, "far.svg");
        assert!(draw(curve("40000000")).is_ok());
        for far in ["4e10", "4e20", "4e30"] {
            let clipped = format!(
                r##"<clipPath id="c">{}</clipPath><rect width="9" height="9" clip-path="url(#c)"/>"##,
                curve(far)
            );
            for inside in [curve(far), clipped] {
                assert!(matches!(draw(inside), Err(Error::Render { .. })), "{far}");
            }
        }
    }

    #[test]
    fn huge_pictures_are_refused() {
        let huge = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1e9" height="1e9"/>"#;
        assert!(matches!(render_svg(huge.as_bytes(), 1.0, "huge.svg"), Err(Error::TooLarge { .. })));
    }
}
