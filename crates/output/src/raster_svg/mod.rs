//! SVG → pixels, any program's SVG.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text, embedded raster
//! images and foreign objects are not drawn; they are counted and warned of. A large SVG is drawn piece by piece.
//! What would take minutes or gigabytes is refused.

mod pieces;

use super::picture_size;
use pieces::{PiecePurpose, SvgPieces};
use resvg::usvg::roxmltree::Document;
use tiny_skia::{BlendMode, Pixmap, PixmapPaint, Transform};
use vtex_base::Progress;
use vtex_base::error::{Error, Large, Result};
use vtex_base::progress::advance;
use vtex_drawing::svg_tree::{self, SvgFault, SvgTree};

/// Most pixels of a page as large as it is, without those for each megabyte of the file: a gigabyte of memory.
const PAGE: f64 = 268_435_456.0;

/// Pixels of a picture for which drawing takes no longer than usual.
const USUAL: f64 = 4e6;

/// Draws an SVG or SVGZ, `scale` pixels of the picture to a unit of the SVG; the size is rounded.
/// `name` appears in errors and in the warning of what is not drawn. Progress counts elements, as
/// stage `drawing`.
///
/// # Errors
/// Not an SVG that can be parsed; what [`svg_tree::draw`] refuses, piece by piece; a scale that is not above 0;
/// [`Error::TooLarge`] beyond 100 000 pixels on a side, 2³⁰ pixels, 2²⁸ for a small file that is not enlarged, or
/// 1 GiB of text; [`Error::Interrupted`].
pub fn render_svg(bytes: &[u8], scale: f64, name: &str, progress: &dyn Progress) -> Result<Pixmap> {
    render_part_of(bytes, scale, (name, 1.0), progress)
}

/// [`render_svg`] of one of several drawings that may take a `share` of the time together.
///
/// # Errors
/// Those of [`render_svg`].
pub fn render_part_of(
    bytes: &[u8],
    scale: f64,
    (name, share): (&str, f64),
    progress: &dyn Progress,
) -> Result<Pixmap> {
    let fail = |fault| failed(name, fault);
    let text = svg_tree::text(bytes, name, fail)?;
    let document = svg_tree::document(&text).map_err(fail)?;
    if let Some(warning) = left_out(&document, name) {
        progress.warn(&warning);
    }
    let pieces = SvgPieces::new(&text, &document);
    let total = pieces.weight();
    let parse = |text: &str| svg_tree::document(text).and_then(|d| svg_tree::tree(&d));
    // The error for an SVG of that number of elements that cannot be parsed.
    let refused = |fault: SvgFault, elements: u64| {
        if elements <= svg_tree::MOST_ELEMENTS {
            return fail(fault);
        }
        let reason = "more than a million of its elements, every <use> followed, can only be drawn together";
        Error::Render { name: name.into(), reason: reason.into() }
    };
    if !pieces.several() {
        advance(progress, "drawing", 0, total)?;
        let tree = svg_tree::tree(&document).map_err(|fault| refused(fault, total))?;
        let mut canvas = LayeredPicture::new(&tree, scale, (name, share))?;
        canvas.draw(&tree)?;
        return Ok(canvas.picture);
    }
    let mut canvas = LayeredPicture::new(&parse(&pieces.empty()).map_err(fail)?, scale, (name, share))?;
    let mut done = 0;
    pieces.each(&mut |step| {
        advance(progress, "drawing", done, total)?;
        match step {
            PiecePurpose::Draw { text, weight } => {
                done += weight;
                canvas.draw(&parse(&text).map_err(|fault| refused(fault, weight))?)
            }
            PiecePurpose::Open => canvas.open(),
            PiecePurpose::Close(shape) => canvas.close(&parse(&shape).map_err(fail)?),
        }
    })?;
    advance(progress, "drawing", total, total)?;
    Ok(canvas.picture)
}

/// An SVG that cannot be drawn.
fn failed(name: &str, fault: SvgFault) -> Error {
    let reason = if fault.advice == svg_tree::COMPLETE {
        fault.reason
    } else {
        format!("{}; {}", fault.reason, fault.advice)
    };
    Error::Render { name: name.into(), reason }
}

/// An SVG that would take too much time or memory at its scale.
fn too_much(name: &str, fault: SvgFault) -> Error {
    if fault.advice != svg_tree::SHAPES {
        return failed(name, fault);
    }
    let SvgFault { reason, advice } = fault;
    Error::Render { name: name.into(), reason: format!("{reason}; {advice}, or ask for a smaller picture") }
}

/// Elements of an SVG once every `<use>` is followed.
#[cfg(test)]
pub(super) fn weight(text: &str) -> u64 {
    SvgPieces::new(text, &svg_tree::document(text).unwrap()).weight()
}

/// A sentence on the parts of a document that are not drawn.
fn left_out(document: &Document<'_>, name: &str) -> Option<String> {
    let count = |what: &str| document.descendants().filter(|n| n.tag_name().name() == what).count();
    let counts = ["image", "text", "foreignObject"].map(|what| (count(what), what));
    let found: Vec<String> =
        counts.iter().filter(|c| c.0 > 0).map(|(n, what)| format!("{n} <{what}>")).collect();
    (!found.is_empty())
        .then(|| format!("'{name}' contains {}, which vtex does not draw", found.join(" and ")))
}

/// A picture, and open layers above it that are to be clipped.
struct LayeredPicture<'a> {
    name: &'a str,
    transform: Transform,
    /// How many times as long drawing may take, because a large picture was asked for, or several.
    patience: f64,
    picture: Pixmap,
    below: Vec<Pixmap>,
}

impl<'a> LayeredPicture<'a> {
    /// An empty canvas of the size of an SVG at a scale.
    fn new(tree: &SvgTree, scale: f64, (name, share): (&'a str, f64)) -> Result<Self> {
        let (w, h) = (tree.size().width(), tree.size().height());
        let (width, height) = picture_size(f64::from(w), f64::from(h), scale, name)?;
        let transform = Transform::from_scale(width as f32 / w, height as f32 / h);
        let most = (PAGE * (1.0 + tree.megabytes()) * (scale * scale).max(1.0)) as u64;
        if u64::from(width) * u64::from(height) > most {
            let found = format!("a picture of {width} x {height} pixels");
            let limit = format!("{} megapixels for a file of its size", most / 1_000_000);
            return Err(Error::TooLarge { what: Large::Drawn, name: name.into(), found, limit });
        }
        let picture = layer(width, height, name)?;
        let enlarged = (scale * scale).min(f64::from(width) * f64::from(height) / USUAL);
        let patience = share * enlarged.max(1.0);
        Ok(Self { name, transform, patience, picture, below: Vec::new() })
    }

    /// Draws an SVG over the topmost layer.
    fn draw(&mut self, tree: &SvgTree) -> Result<()> {
        svg_tree::draw(tree, self.transform, &mut self.picture, self.patience)
            .map_err(|fault| too_much(self.name, fault))
    }

    /// Begins a layer.
    fn open(&mut self) -> Result<()> {
        let above = layer(self.picture.width(), self.picture.height(), self.name)?;
        self.below.push(std::mem::replace(&mut self.picture, above));
        Ok(())
    }

    /// Ends a layer: clips it to `shape` and draws it over the one below.
    fn close(&mut self, shape: &SvgTree) -> Result<()> {
        let mut mask = layer(self.picture.width(), self.picture.height(), self.name)?;
        svg_tree::draw(shape, self.transform, &mut mask, self.patience)
            .map_err(|fault| too_much(self.name, fault))?;
        let paint = |blend_mode| PixmapPaint { blend_mode, ..PixmapPaint::default() };
        let still = Transform::identity();
        self.picture.draw_pixmap(0, 0, mask.as_ref(), &paint(BlendMode::DestinationIn), still, None);
        drop(mask);
        if let Some(mut below) = self.below.pop() {
            below.draw_pixmap(0, 0, self.picture.as_ref(), &paint(BlendMode::SourceOver), still, None);
            self.picture = below;
        }
        Ok(())
    }
}

/// A transparent picture.
fn layer(width: u32, height: u32, name: &str) -> Result<Pixmap> {
    Pixmap::new(width, height).ok_or_else(|| Error::Render {
        name: name.into(),
        reason: format!("a picture of {width} x {height} pixels cannot be held in memory"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    const RED: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="30" height="20"><rect width="30" height="20" fill="red"/>"#;

    #[test]
    fn plain_and_packed() {
        let text = format!("{RED}</svg>");
        let mut packed = crate::file::gzip(Vec::new());
        packed.write_all(text.as_bytes()).unwrap();
        let packed = packed.finish().unwrap();
        for bytes in [text.as_bytes(), &packed] {
            let picture = render_svg(bytes, 1.5, "red.svg", &()).unwrap();
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
            let error = render_svg(bad.as_bytes(), 1.0, "bad.svg", &()).unwrap_err();
            assert!(matches!(error, Error::Render { .. }), "{error}");
        }
        assert!(render_svg(&[0x1f, 0x8b, 8, 0, 1], 1.0, "bad.svgz", &()).is_err());
    }

    #[test]
    fn deep_nesting_is_no_harm() {
        let deep = format!("{RED}{}{}</svg>", "<g>".repeat(100_000), "</g>".repeat(100_000));
        let _ = render_svg(deep.as_bytes(), 1.0, "deep.svg", &());
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
        let picture = render_svg(outer.as_bytes(), 1.0, "outer.svg", &()).unwrap();
        assert!(picture.pixels().iter().all(|p| p.alpha() == 0));
    }

    #[test]
    fn shapes_that_reach_too_far_are_refused() {
        let curve = |far: &str| format!(r#"<path d="M7 18c-4.1-{far} 9-2 13-1l5 9z"/>"#);
        let draw =
            |inside: String| render_svg(format!("{RED}{inside}</svg>").as_bytes(), 1.0, "far.svg", &());
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
        assert!(matches!(render_svg(huge.as_bytes(), 1.0, "huge.svg", &()), Err(Error::TooLarge { .. })));
    }

    /// Squares of half a pixel in groups, some repeated, some shaded, under a clip path.
    fn crowd(count: usize, clip: &str) -> String {
        let mut text = format!(
            r##"{RED}<defs><clipPath id="c"><path d="M3 2h20v9l-7 8z"/></clipPath><symbol id="s" overflow="visible"><path d="M0 0h.5v.5z"/><path fill="blue" d="M0 0h.3v.3z"/></symbol></defs><g{clip} fill="#0c0" fill-opacity=".7" stroke="#00c" stroke-width=".1" transform="translate(.25)"><linearGradient id="l"><stop stop-color="#fff"/><stop offset="1"/></linearGradient><linearGradient id="m"><stop stop-color="red"/></linearGradient>"##
        );
        for i in 0..count {
            let (x, y) = (i % 59 / 2, i % 41 / 2);
            text += &match i % 4 {
                3 => format!(
                    r##"<path d="M{x}.1 {y}h.6v.5z" style="fill:url( '#l' );stroke-width:.2;stroke:url(#m)"/>"##
                ),
                0 => format!(r##"<use href="#s" x="{x}" y="{y}"/>"##),
                1 => format!(r#"<rect x="{x}.2" y="{y}" width=".7" height=".6" fill="url(#l)"/>"#),
                _ => format!(r#"<g id="g{i}"><path d="M{x} {y}.4h.7v.6z"/></g>"#),
            };
        }
        text + "</g></svg>"
    }

    #[test]
    fn pieces_make_the_picture_of_the_whole() {
        for clip in ["", r#" clip-path="url(#c)""#, r#" opacity=".5""#] {
            let text = crowd(120_000, clip);
            let document = svg_tree::document(&text).unwrap();
            let pieces = SvgPieces::new(&text, &document);
            assert!(pieces.several() && pieces.weight() < svg_tree::MOST_ELEMENTS);
            let (mut drawn, mut layers) = (0, 0);
            let step = &mut |step| -> Result<(), ()> {
                match step {
                    PiecePurpose::Draw { .. } => drawn += 1,
                    PiecePurpose::Open | PiecePurpose::Close(_) => layers += 1,
                }
                Ok(())
            };
            pieces.each(step).unwrap();
            assert_eq!(
                (drawn > 2, layers),
                (!clip.contains("opacity"), 2 * usize::from(clip.contains("clip")))
            );
            let tree = svg_tree::tree(&document).unwrap();
            let mut whole = LayeredPicture::new(&tree, 2.0, ("crowd", 1.0)).unwrap();
            whole.draw(&tree).unwrap();
            let found = render_svg(text.as_bytes(), 2.0, "crowd", &()).unwrap();
            let off = whole.picture.data().iter().zip(found.data()).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(off <= Some(2), "{clip}: {off:?}");
        }
    }

    #[test]
    fn many_elements_deep_within_groups_are_refused() {
        let leaves = r#"<rect width="1" height="1"/>"#.repeat(250_000);
        let deep = format!("{RED}{}{leaves}{}</svg>", "<g>".repeat(50_000), "</g>".repeat(50_000));
        assert!(matches!(render_svg(deep.as_bytes(), 1.0, "deep.svg", &()), Err(Error::Render { .. })));
    }

    #[test]
    fn more_elements_than_the_parser_takes_are_drawn() {
        let text = crowd(600_000, "");
        let document = svg_tree::document(&text).unwrap();
        assert!(svg_tree::tree(&document).is_err());
        assert!(render_svg(text.as_bytes(), 1.0, "crowd.svg", &()).is_ok());
        let stopped = render_svg(text.as_bytes(), 1.0, "crowd.svg", &vtex_testing::StopAtOnce);
        assert!(matches!(stopped, Err(Error::Interrupted)));
        let whole = render_svg(crowd(600_000, r#" opacity=".5""#).as_bytes(), 1.0, "crowd.svg", &());
        assert!(whole.unwrap_err().to_string().contains("can only be drawn together"));
    }

    #[test]
    fn filters_without_end_are_refused() {
        let draw = |filter: &str, region: &str, scale: f64| {
            let text = format!(
                r#"{RED}<filter id="f" {region}>{filter}</filter><rect filter="url(#f)" width="30" height="20"/></svg>"#
            );
            render_svg(text.as_bytes(), scale, "f.svg", &())
        };
        let wide = r#"x="-1e6" y="-1e6" width="1e7" height="1e7""#;
        for (filter, region, scale) in [
            (r#"<feTurbulence numOctaves="100000" baseFrequency="0.1"/>"#, wide, 3.0),
            (r#"<feMorphology operator="dilate" radius="10"/>"#, "", 60.0),
            (&r#"<feTurbulence baseFrequency="0.1"/>"#.repeat(100_000), "", 10.0),
        ] {
            let error = draw(filter, region, scale).unwrap_err();
            assert!(error.to_string().contains("more than"), "{error}");
        }
        for filter in [
            r#"<feGaussianBlur stdDeviation="2"/>"#,
            r#"<feTurbulence numOctaves="4" baseFrequency="0.1"/>"#,
            r#"<feMorphology radius="1"/>"#,
        ] {
            assert!(draw(filter, "", 20.0).is_ok(), "{filter}");
        }
        // Each pattern is filled with the next, many times.
        let mut nested = String::from(RED);
        for k in 0..12 {
            let fill = "<rect fill='url(#p)' width='9' height='9'/>"
                .replace("#p", &format!("#p{}", k + 1))
                .repeat(10);
            nested += &format!(
                "<pattern id='p{k}' width='9' height='9' patternUnits='userSpaceOnUse'>{fill}</pattern>"
            );
        }
        nested += "<pattern id='p12' width='9' height='9'><path d='M0 0h1v1z'/></pattern><rect fill='url(#p0)' width='9' height='9'/></svg>";
        assert!(render_svg(nested.as_bytes(), 1.0, "n.svg", &()).is_err());
    }

    #[test]
    fn what_is_not_drawn_is_counted() {
        struct Heard(std::sync::Mutex<Vec<String>>);
        impl Progress for Heard {
            fn warn(&self, message: &str) {
                self.0.lock().unwrap().push(message.into());
            }
        }
        let heard = Heard(Vec::new().into());
        let text = format!(
            r#"{RED}<image width="3" href="a.png"/><g><image href="b.png"/></g><text>a</text></svg>"#
        );
        render_svg(text.as_bytes(), 1.0, "mixed.svg", &heard).unwrap();
        render_svg(format!("{RED}</svg>").as_bytes(), 1.0, "red.svg", &heard).unwrap();
        let wanted = "'mixed.svg' contains 2 <image> and 1 <text>, which vtex does not draw";
        assert_eq!(*heard.0.lock().unwrap(), [wanted]);
    }
}
