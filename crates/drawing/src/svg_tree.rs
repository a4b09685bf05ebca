//! Any program's SVG as a tree of shapes, and pixels of it.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster images are
//! not read. Documents that would take the parser hours or overflow its stack are refused beforehand, and a
//! panic of the libraries that parse and draw becomes an error.

mod bounds;

pub use bounds::{MOST_ELEMENTS, ids, referred, uses, weights};

use resvg::usvg::{self, roxmltree};
use tiny_skia::{Pixmap, Transform};
use vtex_base::error::{Error, Large, Result, caught, clip, clip_to};
use vtex_base::geometry::Affine;
use vtex_base::gzip;

/// Largest SVG read, unpacked, in bytes.
const LARGEST_TEXT: usize = 1 << 30;

/// Number of bytes in which an SVG is recognised.
const HEAD: usize = 4096;

/// Largest coordinate of a shape, in pixels of the picture: curves beyond some 10⁹ cannot be drawn.
const FURTHEST: f32 = 1e8;

/// Largest number of dashes of all strokes, which take some four seconds to draw.
const MOST_DASHES: f64 = 1e6;
/// Largest number of pairs of lines of one path that may cross, which take some ten seconds to draw.
const MOST_CROSSINGS: f64 = 1e9;

/// Why an SVG is not read or drawn.
#[derive(Debug)]
pub struct SvgFault {
    /// In one sentence without a full stop.
    pub reason: String,
    /// What to try, in one sentence without a full stop.
    pub advice: &'static str,
}

/// Advice where bytes are no SVG.
pub const COMPLETE: &str = "it must be an SVG or SVGZ; is the file complete?";
/// Advice for parts that are beyond the limits.
const SHAPES: &str = "turn it into plain shapes in the program that made it";

impl From<String> for SvgFault {
    fn from(reason: String) -> Self {
        Self { reason, advice: COMPLETE }
    }
}

/// Whether bytes, plain or gzip, begin as an SVG does, in UTF-16 too, which [`text`] then refuses.
pub(crate) fn is_svg(bytes: &[u8]) -> bool {
    let head = gzip::beginning(bytes, HEAD);
    let wide = matches!(head.get(..2), Some([0xff, 0xfe] | [0xfe, 0xff]));
    let of_wide = |head: &[u8]| head.iter().copied().filter(|b| b.is_ascii() && *b != 0).collect();
    let head: Vec<u8> = if wide { of_wide(&head) } else { head.into_owned() };
    let text = String::from_utf8_lossy(&head);
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<') && text.contains("<svg")
}

/// Parses an SVG or SVGZ; `name` appears in errors.
///
/// # Errors
/// As [`text`], [`document`] and [`tree`].
pub(crate) fn parse(bytes: &[u8], name: &str, fail: impl Fn(SvgFault) -> Error) -> Result<usvg::Tree> {
    let text = text(bytes, name, &fail)?;
    document(&text).and_then(|document| tree(&document)).map_err(fail)
}

/// The text of an SVG or SVGZ.
///
/// # Errors `fail` of the reason if the bytes are damaged or not UTF-8; [`Error::TooLarge`] beyond 1 GiB.
pub fn text(bytes: &[u8], name: &str, fail: impl Fn(SvgFault) -> Error) -> Result<String> {
    let bytes = gzip::unpack(bytes, LARGEST_TEXT as u64 + 1).map_err(|reason| fail(reason.into()))?;
    if bytes.len() > LARGEST_TEXT {
        let (found, limit) = ("more than 1 GiB of SVG text".into(), "1 GiB".into());
        return Err(Error::TooLarge { what: Large::File, name: name.into(), found, limit });
    }
    let text = String::from_utf8(bytes.into_owned()).map_err(|e| {
        let wide = [b"\xff\xfe", b"\xfe\xff"].iter().any(|mark| e.as_bytes().starts_with(*mark));
        let reason = if wide { "it is UTF-16 text, not UTF-8" } else { "it is not UTF-8 text" };
        fail(SvgFault { reason: reason.into(), advice: "save it as UTF-8 in the program that made it" })
    })?;
    Ok(text.strip_prefix('\u{feff}').map(Into::into).unwrap_or(text))
}

/// The XML of a text.
///
/// # Errors A text that is not well formed.
pub fn document(text: &str) -> Result<roxmltree::Document<'_>, SvgFault> {
    if text.trim().is_empty() {
        return Err(String::from("it is empty").into());
    }
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options)
        .map_err(|e| format!("it is not well-formed XML: {e}").into())
}

/// The shapes of a document, every `<use>` followed.
///
/// # Errors
/// Why it is not an SVG, or not one that can be parsed in reasonable time.
pub fn tree(document: &roxmltree::Document<'_>) -> Result<usvg::Tree, SvgFault> {
    tree_of(document, || None)
}

/// As [`tree`], with an empty drawing in place of raster images and other files.
///
/// # Errors
/// As [`tree`].
pub(crate) fn tree_with_images(document: &roxmltree::Document<'_>) -> Result<usvg::Tree, SvgFault> {
    let empty = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>"#;
    tree_of(document, || {
        usvg::Tree::from_str(empty, &usvg::Options::default()).ok().map(usvg::ImageKind::SVG)
    })
}

fn tree_of(
    document: &roxmltree::Document<'_>,
    image: impl Fn() -> Option<usvg::ImageKind> + Copy + Send + Sync,
) -> Result<usvg::Tree, SvgFault> {
    if let Some(fault) = bounds::refused(document) {
        return Err(fault);
    }
    let options = usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(move |_, _, _| image()),
            resolve_string: Box::new(move |_, _| image()),
        },
        ..usvg::Options::default()
    };
    let parsed = caught(|| usvg::Tree::from_xmltree(document, &options));
    parsed.map_err(|said| panicked("read", &said))?.map_err(|e| fault(document, e))
}

/// The fault for an error of the parser.
fn fault(document: &roxmltree::Document<'_>, error: usvg::Error) -> SvgFault {
    use roxmltree::Error::{NoRootNode, NodesLimitReached};
    use usvg::Error::{ElementsLimitReached, InvalidSize, ParsingFailed};
    let (reason, advice) = match error {
        ParsingFailed(NoRootNode) => {
            let root = document.root_element().tag_name();
            let reason = match root.namespace() {
                Some(other) if root.name() == "svg" => {
                    format!("its namespace is '{}', not that of SVG", clip_to(other, 60))
                }
                _ => format!("its root is <{}>, not <svg>", clip(root.name())),
            };
            (reason, r#"the root of an SVG is <svg xmlns="http://www.w3.org/2000/svg">"#)
        }
        ParsingFailed(NodesLimitReached) if depth(document) > bounds::DEEPEST => {
            let reason = format!("it nests more than {} elements in one another", bounds::DEEPEST);
            (reason, "ungroup it in the program that made it")
        }
        ElementsLimitReached | ParsingFailed(NodesLimitReached) => {
            let most = MOST_ELEMENTS;
            let reason =
                format!("its references lead back to themselves, or unfold to more than {most} elements");
            (reason, "replace its <use> elements by copies of what they show")
        }
        InvalidSize => {
            let reason = "its width, height or viewBox is missing, 0 or no number";
            (reason.into(), "give it a width and a height, or a viewBox")
        }
        other => return other.to_string().into(),
    };
    SvgFault { reason, advice }
}

/// Largest nesting depth of elements.
fn depth(document: &roxmltree::Document<'_>) -> usize {
    let mut depths = Vec::new();
    for node in document.descendants() {
        let above = node.parent().map_or(0, |parent| depths[parent.id().get_usize()]);
        depths.push(above + usize::from(node.is_element()));
    }
    depths.into_iter().max().unwrap_or(0)
}

/// From a group to the page, given that from what is around it. The tree's own product, `abs_transform`, is wrong below
/// `use` elements of symbols: it has their transforms twice.
pub(crate) fn within(around: Affine, group: &usvg::Group) -> Affine {
    around * affine(group.transform())
}

/// A transform of a tree.
pub(crate) fn affine(t: Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

/// Draws a tree over a picture.
///
/// # Errors
/// Why it cannot be drawn: a shape reaches 10⁸ pixels away, strokes have more than a million dashes, a path
/// crosses itself too often, or the library that draws gave up.
pub fn draw(tree: &usvg::Tree, transform: Transform, picture: &mut Pixmap) -> Result<(), SvgFault> {
    let scale = transform.sx.abs().max(transform.sy.abs());
    if furthest(tree) * scale > FURTHEST {
        let reason = "it has a shape that reaches further than can be drawn".into();
        return Err(SvgFault { reason, advice: "delete what lies far outside the page" });
    }
    let DrawingCost { dashes, crossings } = DrawingCost::of(tree);
    if dashes > MOST_DASHES {
        let reason = "its strokes have more than a million dashes".into();
        return Err(SvgFault { reason, advice: "make the dashes longer, or the strokes solid" });
    }
    if crossings > MOST_CROSSINGS {
        let reason = "a path of it crosses itself too often to be drawn".into();
        return Err(SvgFault { reason, advice: "take it apart into several paths, or simplify it" });
    }
    caught(|| resvg::render(tree, transform, &mut picture.as_mut())).map_err(|said| panicked("drawn", &said))
}

fn panicked(done: &str, said: &str) -> SvgFault {
    let reason = format!("it cannot be {done}: {said}");
    SvgFault { reason, advice: "simplify it in the program that made it, and please report it" }
}

/// All outermost groups: that of the page, and those of clip paths, masks and patterns.
fn roots(tree: &usvg::Tree) -> impl Iterator<Item = &usvg::Group> {
    (std::iter::once(tree.root()))
        .chain(tree.clip_paths().iter().map(|c| c.root()))
        .chain(tree.masks().iter().map(|m| m.root()))
        .chain(tree.patterns().iter().map(|p| p.root()))
}

/// The cost of drawing, besides the number of shapes and pixels.
#[derive(Default)]
struct DrawingCost {
    /// Upper bound of the number of dashes of all strokes.
    dashes: f64,
    /// Pairs of lines of one path that may cross, in all paths. The renderer sorts them for each row of the
    /// picture, starting from the order of the row before.
    crossings: f64,
}

impl DrawingCost {
    fn of(tree: &usvg::Tree) -> Self {
        let mut cost = Self::default();
        let mut open: Vec<&usvg::Group> = roots(tree).collect();
        while let Some(group) = open.pop() {
            for node in group.children() {
                match node {
                    usvg::Node::Group(inner) => open.push(inner),
                    usvg::Node::Path(path) => cost.add(path),
                    usvg::Node::Image(_) | usvg::Node::Text(_) => {}
                }
            }
        }
        cost
    }

    fn add(&mut self, path: &usvg::Path) {
        let t = path.abs_transform();
        let [kx, ky] = [t.ky, t.sy].map(f64::from);
        let length = length(path.data(), |[dx, dy]| libm::hypot(dx, dy));
        let rise = self::length(path.data(), |[dx, dy]| (kx * dx + ky * dy).abs());
        let mut sides = f64::from(u8::from(path.fill().is_some()));
        if let Some(stroke) = path.stroke() {
            sides = 2.0;
            let pattern = stroke.dasharray().unwrap_or_default();
            let period: f64 = pattern.iter().map(|d| f64::from(*d)).sum();
            if period > 0.0 {
                self.dashes += length / period * pattern.len() as f64;
            }
        }
        // Mean number of lines that a row of the picture meets.
        let lines = sides * rise / f64::from(path.abs_stroke_bounding_box().height()).max(1e-6);
        self.crossings += lines * lines;
    }
}

/// The sum of `size` over the lines of a path, with curves replaced by their control polygons.
fn length(path: &usvg::tiny_skia_path::Path, size: impl Fn([f64; 2]) -> f64) -> f64 {
    use usvg::tiny_skia_path::{PathSegment, Point};
    let (mut sum, mut start) = (0.0, Point::zero());
    let mut at = start;
    for segment in path.segments() {
        let mut go = |to: &[Point]| {
            for &p in to {
                sum += size([p.x - at.x, p.y - at.y].map(f64::from));
                at = p;
            }
        };
        match segment {
            PathSegment::MoveTo(p) => (start, at) = (p, p),
            PathSegment::LineTo(p) => go(&[p]),
            PathSegment::QuadTo(a, p) => go(&[a, p]),
            PathSegment::CubicTo(a, b, p) => go(&[a, b, p]),
            PathSegment::Close => go(&[start]),
        }
    }
    sum
}

/// Largest distance of any shape from the origin, in units of the SVG.
fn furthest(tree: &usvg::Tree) -> f32 {
    let reach = |group: &usvg::Group| {
        let (own, all) = (group.stroke_bounding_box(), group.abs_stroke_bounding_box());
        [own.left(), own.top(), own.right(), own.bottom(), all.left(), all.top(), all.right(), all.bottom()]
            .into_iter()
            .fold(0.0, |most: f32, v| most.max(v.abs()))
    };
    roots(tree).map(reach).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(inner: &str) -> Result<usvg::Tree, SvgFault> {
        let text = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="90" height="90">{inner}</svg>"#
        );
        document(&text).and_then(|document| tree(&document))
    }

    fn refused(inner: &str, reason: &str) {
        let fault = read(inner).map(|_| ()).unwrap_err();
        assert!(fault.reason.contains(reason), "{}", fault.reason);
        assert!(!fault.advice.is_empty() && !fault.advice.ends_with('.'));
    }

    #[test]
    fn path_data_that_would_take_the_stack_are_refused() {
        for z in ["Z", "z ", " Z\n\t"] {
            refused(&format!(r#"<path d="M5 5h9v9{}"/>"#, z.repeat(25_000)), "closed more than 1000 times");
        }
        let rings = "M5 5h9v9zZ z".repeat(25_000);
        assert!(read(&format!(r#"<path d="{rings}"/><path d="M5 5h9v9{}"/>"#, "z".repeat(900))).is_ok());
    }

    #[test]
    fn styles_that_would_take_minutes_are_refused() {
        let deep = |count: usize| {
            format!("{}<rect width='9' height='9'/>{}", "<g>".repeat(count), "</g>".repeat(count))
        };
        let circle = |style: &str| format!(r#"<circle r="9" style="{style}"/>"#);
        let rules: String = (0..30_000).map(|k| format!(".a{k}{{fill:#00f}}")).collect();
        let many = format!("<style>*{{{}}}</style>{}", "fill:red;".repeat(3_000), "<g/>".repeat(30_000));
        let list = format!("<style>{}{{{}}}</style>", "g,".repeat(60_000), "fill:red;".repeat(9_000));
        // Few elements, each of them used often.
        let used = format!(
            "<style>{}</style><g id='a'>{}</g>{}",
            &rules[..rules.len() / 15],
            "<g/>".repeat(12),
            r##"<use xlink:href="#a"/>"##.repeat(30_000)
        );
        for hostile in [
            format!("<style>{}{{fill:red}}</style>{}", "g ".repeat(40), deep(40)),
            format!("<style>{}{{fill:red}}</style>{}", "g * > g ".repeat(15), deep(60)),
            format!("<style>{rules}</style>{}", "<g/>".repeat(40_000)),
            "<style>g{fill:red}</style>".repeat(40_000),
            circle(&"fill:red;".repeat(100_000)),
            many,
            list,
            used,
        ] {
            refused(&hostile, "its styles would take");
        }
        for usual in [
            format!("<style>svg g g > g rect{{fill:red}}</style>{}", deep(60)),
            format!("<style>{}</style>{}", &rules[..40_000], r#"<g class="a7"/>"#.repeat(30_000)),
            circle(&"fill:red;".repeat(2_000)),
            format!(
                "<style>@media print{{g{{fill:red}}}} /* }} */ g[a=\"{{\"],b{{fill:url(#a)}}</style>{}",
                deep(3)
            ),
        ] {
            assert!(read(&usual).is_ok());
        }
    }

    #[test]
    fn references_within_references_without_end_are_refused() {
        let fills = |to: &str| format!("<path fill='url(#{to})'/>").repeat(8_000);
        let nested: String = (0..60).map(|k| format!("<pattern id='n{k}'>")).collect();
        let hostile = format!(
            "{nested}{}{}<pattern id='p'>{}</pattern>",
            fills("p"),
            "</pattern>".repeat(60),
            fills("q")
        );
        refused(&hostile, "refer to one another too often");
        let clips: String =
            (0..9_000).map(|k| format!("<clipPath id='c{k}'><path d='M0 0h9v9z'/></clipPath>")).collect();
        assert!(read(&clips).is_ok());
    }

    #[test]
    fn what_is_no_svg_is_said() {
        let fault = |text: &str| document(text).and_then(|d| tree(&d).map(|_| ())).unwrap_err();
        let deep = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">{}{}</svg>"#,
            "<g>".repeat(3_000),
            "</g>".repeat(3_000)
        );
        let round = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><use href="#a"/><g id="a"><rect/></g>"##;
        let round = (0..40).fold(round.to_owned(), |all, k| {
            all + &format!(r##"<g id="b{k}"><use href="#b{0}"/><use href="#b{0}"/></g>"##, k + 1)
        }) + r##"<use href="#b0"/><g id="b40"><rect/></g></svg>"##;
        for (text, reason) in [
            ("", "it is empty"),
            (" \n", "it is empty"),
            ("<svg", "not well-formed XML"),
            ("<html/>", "its root is <html>, not <svg>"),
            (
                r#"<svg xmlns="http://example.org/a"/>"#,
                "its namespace is 'http://example.org/a', not that of SVG",
            ),
            (r#"<svg xmlns="http://www.w3.org/2000/svg" width="0" height="1"/>"#, "width, height or viewBox"),
            (&deep, "nests more than 1024 elements in one another"),
            (&round, "unfold to more than 1000000 elements"),
        ] {
            let found = fault(text);
            assert!(found.reason.contains(reason), "{}: {}", text.get(..60).unwrap_or(text), found.reason);
        }
        let wide: Vec<u8> = "<svg/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let wide = [&[0xff, 0xfe], &wide[..]].concat();
        let fail = |fault: SvgFault| Error::Render { name: "a".into(), reason: fault.reason };
        assert!(text(&wide, "a", fail).unwrap_err().to_string().contains("UTF-16"));
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        let drawn = |inner: &str| {
            let mut picture = Pixmap::new(90, 90).unwrap();
            draw(&read(inner).unwrap(), Transform::identity(), &mut picture)
        };
        assert!(drawn("<circle r='9'/>").is_ok());
        let far = r#"<clipPath id="c"><path d="M-1e9 -1e9h2e9v2e9h-2e9z"/></clipPath><g clip-path="url(#c)"><circle r="5"/></g>"#;
        assert!(drawn(far).unwrap_err().reason.contains("reaches further"));
        let dashed = |length: f64| {
            format!(r#"<circle r="40" fill="none" stroke="red" stroke-dasharray="{length}"/>"#).repeat(20)
        };
        assert!(drawn(&dashed(0.1)).is_ok());
        let zigzag = |count: usize| -> String {
            let lines: String = (0..count).map(|k| format!("L{} {}", k * 37 % 90, k % 2 * 90)).collect();
            format!(r#"<path d="M0 0{lines}"/>"#)
        };
        assert!(drawn(&zigzag(2_000)).is_ok());
        assert!(drawn(&zigzag(60_000)).unwrap_err().reason.contains("crosses itself"));
        // Many lines are no problem if no row meets many of them.
        let stairs: String = "h.001v.0015".repeat(60_000);
        assert!(drawn(&format!(r#"<path d="M0 0{stairs}"/>"#)).is_ok());
        assert!(drawn(&dashed(0.001)).unwrap_err().reason.contains("a million dashes"));
    }
}
