//! Any program's SVG as a tree of shapes, and pixels of it.
//!
//! Nothing outside the file is ever loaded: linked pictures are left out. Text and embedded raster images are
//! not read. Documents that would take the parser hours or overflow its stack are refused beforehand, and a
//! panic of the libraries that parse and draw becomes an error.

mod beginning;
mod bounds;
mod cost;
mod markup;
mod stops;
mod unfolding;

pub(crate) use beginning::is_svg;
pub use bounds::{ids, referred, uses, weights};
pub use unfolding::MOST_ELEMENTS;

use cost::DrawingCost;

use resvg::usvg::{self, roxmltree};
use tiny_skia::{Pixmap, Transform};
use vtex_base::error::{Error, Large, Result, caught, clip, clip_to};
use vtex_base::geometry::Affine;
use vtex_base::gzip;

/// Largest SVG read, unpacked, in bytes.
const LARGEST_TEXT: usize = 1 << 30;

/// Largest coordinate of a shape, in pixels of the picture: curves beyond some 10⁹ cannot be drawn.
const FURTHEST: f32 = 1e8;

/// Maximum time for drawing, in nanoseconds: for any file, and for each of its megabytes in addition.
const MOST_TIME: [f64; 2] = [1e10, 1e10];
/// Maximum memory for layers, patterns and masks, in bytes; for large canvases as a multiple of their own memory.
const MOST_MEMORY: f64 = 1e9;
const MOST_CANVASES: f64 = 4.0;

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
pub const SHAPES: &str = "turn it into plain shapes in the program that made it";

impl From<String> for SvgFault {
    fn from(reason: String) -> Self {
        Self { reason, advice: COMPLETE }
    }
}

/// Parses an SVG or SVGZ; `name` appears in errors.
///
/// # Errors
/// As [`text`], [`document`] and [`tree`].
pub(crate) fn parse(bytes: &[u8], name: &str, fail: impl Fn(SvgFault) -> Error) -> Result<SvgTree> {
    let text = text(bytes, name, &fail)?;
    document(&text).and_then(|document| tree(&document)).map_err(fail)
}

/// The shapes of a document.
pub struct SvgTree {
    tree: usvg::Tree,
    /// Length of the text of the document, in bytes.
    text: usize,
}

impl SvgTree {
    /// Length of the text of the document, in megabytes.
    pub fn megabytes(&self) -> f64 {
        self.text as f64 / 1e6
    }
}

impl std::ops::Deref for SvgTree {
    type Target = usvg::Tree;

    fn deref(&self) -> &usvg::Tree {
        &self.tree
    }
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
/// # Errors
/// A text that is not well formed, an element with more than 1000 attributes, more than 200 namespaces, or entities
/// that unfold to more than 10 MB.
pub fn document(text: &str) -> Result<roxmltree::Document<'_>, SvgFault> {
    if text.trim().is_empty() {
        return Err(String::from("it is empty").into());
    }
    if let Some(fault) = markup::refused(text) {
        return Err(fault);
    }
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options)
        .map_err(|e| format!("it is not well-formed XML: {e}").into())
}

/// The shapes of a document, every `<use>` followed. Gradients have at most 256 stops: those of more are thinned.
///
/// # Errors
/// Why it is not an SVG, or not one that can be parsed in reasonable time.
pub fn tree(document: &roxmltree::Document<'_>) -> Result<SvgTree, SvgFault> {
    tree_of(document, || None)
}

/// As [`tree`], with an empty drawing in place of raster images and other files.
///
/// # Errors
/// As [`tree`].
pub(crate) fn tree_with_images(document: &roxmltree::Document<'_>) -> Result<SvgTree, SvgFault> {
    let empty = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>"#;
    tree_of(document, || {
        usvg::Tree::from_str(empty, &usvg::Options::default()).ok().map(usvg::ImageKind::SVG)
    })
}

fn tree_of(
    document: &roxmltree::Document<'_>,
    image: impl Fn() -> Option<usvg::ImageKind> + Copy + Send + Sync,
) -> Result<SvgTree, SvgFault> {
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
    let thinned = stops::thinned(document)?;
    let thinned = thinned.as_deref().map(self::document).transpose()?;
    let shown = thinned.as_ref().unwrap_or(document);
    let parsed = caught(|| usvg::Tree::from_xmltree(shown, &options));
    let tree = parsed.map_err(|said| panicked("read", &said))?.map_err(|e| fault(document, e))?;
    Ok(SvgTree { tree, text: document.input_text().len() })
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
        ElementsLimitReached | ParsingFailed(NodesLimitReached) => {
            let reason =
                "its references lead back to themselves, or unfold to more than a million elements".into();
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

/// From a group to the page, given that from what is around it. The tree's own product, `abs_transform`, is wrong below
/// `use` elements of symbols: it has their transforms twice.
pub(crate) fn within(around: Affine, group: &usvg::Group) -> Affine {
    around * affine(group.transform())
}

/// A transform of a tree.
pub(crate) fn affine(t: Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

/// Draws a tree over a picture. `patience` is how many times as long drawing may take as for a page as large as it is: more
/// if more pixels were asked for, less if it is one of several drawings.
///
/// # Errors
/// Why it cannot be drawn: a shape reaches 10⁸ pixels away; drawing would take more than some ten seconds, in a file of
/// a megabyte twice that, or layers and patterns more than a gigabyte; or the library that draws gave up.
pub fn draw(
    tree: &SvgTree,
    transform: Transform,
    picture: &mut Pixmap,
    patience: f64,
) -> Result<(), SvgFault> {
    let scale = transform.sx.abs().max(transform.sy.abs());
    if furthest(tree) * scale > FURTHEST {
        let reason = "it has a shape or a filter that reaches further than can be drawn".into();
        return Err(SvgFault { reason, advice: "delete what lies far outside the page" });
    }
    let [any, each] = MOST_TIME;
    let canvas = [picture.width(), picture.height()];
    let most = DrawingCost {
        time: (any + each * tree.megabytes()) * patience,
        memory: MOST_MEMORY.max(MOST_CANVASES * 4.0 * f64::from(canvas[0]) * f64::from(canvas[1])),
    };
    let cost = DrawingCost::of(tree.root(), transform, canvas, most);
    if cost.memory > most.memory {
        let reason = "its layers, patterns or masks would take more than a gigabyte of memory".into();
        return Err(SvgFault { reason, advice: SHAPES });
    }
    if cost.time > most.time {
        let reason =
            "its filters, patterns, layers, dashes or crossings would take more than ten seconds".into();
        return Err(SvgFault { reason, advice: SHAPES });
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

/// Largest distance of any shape from the origin, in units of the SVG.
fn furthest(tree: &usvg::Tree) -> f32 {
    let reach = |group: &usvg::Group| {
        let (own, all) = (group.stroke_bounding_box(), group.abs_stroke_bounding_box());
        [own.left(), own.top(), own.right(), own.bottom(), all.left(), all.top(), all.right(), all.bottom()]
            .into_iter()
            .fold(0.0, |most: f32, v| most.max(v.abs()))
    };
    let filters = tree.filters().iter().map(|filter| filter_reach(filter));
    roots(tree).map(reach).chain(filters).fold(0.0, f32::max)
}

/// Largest distance in what the steps of a filter do.
fn filter_reach(filter: &usvg::filter::Filter) -> f32 {
    use usvg::filter::Kind;
    let of_step = |step: &usvg::filter::Primitive| match step.kind() {
        Kind::Offset(o) => [o.dx(), o.dy(), 0.0, 0.0],
        Kind::DropShadow(s) => [s.dx(), s.dy(), s.std_dev_x().get(), s.std_dev_y().get()],
        Kind::GaussianBlur(b) => [b.std_dev_x().get(), b.std_dev_y().get(), 0.0, 0.0],
        Kind::Morphology(m) => [m.radius_x().get(), m.radius_y().get(), 0.0, 0.0],
        Kind::DisplacementMap(d) => [d.scale(), 0.0, 0.0, 0.0],
        _ => [0.0; 4],
    };
    filter.primitives().iter().flat_map(of_step).fold(0.0, |most, v| most.max(v.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(inner: &str) -> Result<SvgTree, SvgFault> {
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
    fn arcs_that_would_be_of_millions_of_curves_are_refused() {
        for hostile in [
            r#"<path d="M5 5a1e30 9 0 0 1 4 4"/>"#,
            r#"<path d="M5 5A9 10000000000000.5 0 0 1 4 4"/>"#,
            r#"<circle r="1E+25"/>"#,
            r#"<rect width="9" height="9" rx="99999999999999999999"/>"#,
            r#"<filter id="f" height="1e38"><feFlood/></filter><rect width="9" height="9" filter="url(#f)"/>"#,
            r#"<rect width="9" height="9" filter="blur(1e38)"/>"#,
        ] {
            refused(hostile, "larger than can be drawn");
        }
        assert!(read(r#"<path d="M5 5a9 9 0 0 1 4 4h.12345678901234567"/><circle r="1e8"/>"#).is_ok());
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
            (&round, "unfold to more than 1 million elements"),
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
            draw(&read(inner).unwrap(), Transform::identity(), &mut picture, 1.0)
        };
        assert!(drawn("<circle r='9'/>").is_ok());
        let far = r#"<clipPath id="c"><path d="M-1e9 -1e9h2e9v2e9h-2e9z"/></clipPath><g clip-path="url(#c)"><circle r="5"/></g>"#;
        let far_step = |step: &str| {
            format!(r#"<filter id="f">{step}</filter><rect width="40" height="40" filter="url(#f)"/>"#)
        };
        for far in [
            far.to_owned(),
            far_step(r#"<feOffset dx="1e9"/>"#),
            far_step(r#"<feMorphology operator="dilate" radius="1e9"/>"#),
            far_step(r#"<feGaussianBlur stdDeviation="1e9"/>"#),
            r#"<rect width="40" height="40" filter="blur(1e9)"/>"#.into(),
        ] {
            let fault = read(&far)
                .and_then(|tree| draw(&tree, Transform::identity(), &mut Pixmap::new(90, 90).unwrap(), 1.0));
            let reason = fault.unwrap_err().reason;
            assert!(reason.contains("reaches further"), "{far}: {reason}");
        }
        let wide = r#"<filter id="f" height="1e11"><feFlood/></filter><rect width="9" height="9" filter="url(#f)"/>"#;
        assert!(drawn(wide).is_ok());
        assert!(drawn(&far_step(r#"<feOffset dx="3"/><feGaussianBlur stdDeviation="2"/>"#)).is_ok());
        let slow = |inner: &str| assert!(drawn(inner).unwrap_err().reason.contains("more than ten seconds"));
        let dashed = |length: f64, more: &str| {
            let circle =
                format!(r#"<circle r="40" fill="none" stroke="red" stroke-dasharray="{length}" {more}/>"#);
            circle.repeat(30)
        };
        assert!(drawn(&dashed(0.1, "")).is_ok());
        slow(&dashed(0.001, ""));
        slow(&dashed(0.004, r#"stroke-linecap="round" stroke-width="9""#));
        let zigzag = |count: usize| -> String {
            let lines: String = (0..count).map(|k| format!("L{} {}", k * 37 % 90, k % 2 * 90)).collect();
            format!(r#"<path d="M0 0{lines}"/>"#)
        };
        assert!(drawn(&zigzag(2_000)).is_ok());
        slow(&zigzag(60_000));
        // Many lines are no problem if no row meets many of them.
        let stairs: String = "h.001v.0015".repeat(60_000);
        assert!(drawn(&format!(r#"<path d="M0 0{stairs}"/>"#)).is_ok());
        let octaves = r#"<filter id="f"><feTurbulence numOctaves="99999" baseFrequency=".1"/></filter><circle r="40" filter="url(#f)"/>"#;
        slow(octaves);
        let merged =
            format!(r#"<filter id="f"><feMerge>{}</feMerge></filter>"#, "<feMergeNode/>".repeat(2_000));
        let merged = merged + r#"<rect width="900" height="900" filter="url(#f)"/>"#;
        assert!(drawn_on(900, &merged).unwrap_err().reason.contains("more than ten seconds"));
    }

    /// What drawing content on a page of a size says.
    fn drawn_on(size: u32, inner: &str) -> Result<(), SvgFault> {
        let text = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{size}" height="{size}">{inner}</svg>"#
        );
        let mut picture = Pixmap::new(size, size).unwrap();
        draw(&document(&text).and_then(|d| tree(&d))?, Transform::identity(), &mut picture, 1.0)
    }

    #[test]
    fn what_would_take_gigabytes_is_refused() {
        let pattern = |size: &str| {
            format!(
                r#"<pattern id="p" {size} patternUnits="userSpaceOnUse"><rect width="5" height="5"/></pattern><rect width="99" height="99" fill="url(#p)"/>"#
            )
        };
        let layers = |count: usize, style: &str| {
            format!(
                "{}<rect width='3000' height='3000'/>{}",
                format!("<g {style}>").repeat(count),
                "</g>".repeat(count)
            )
        };
        let clip = r#"<clipPath id="c"><rect width="3000" height="3000"/></clipPath>"#;
        let mask = |k: usize| {
            let next = k + 1;
            format!(
                r#"<mask id="m{k}" mask="url(#m{next})"><rect width="3000" height="3000" fill="white"/></mask>"#
            )
        };
        let masks: String = (0..25).map(mask).collect();
        for (size, hostile) in [
            (90, pattern(r#"width="1e6" height="1e6""#)),
            (90, pattern(r#"width="10" height="10" patternTransform="scale(1e4)""#)),
            (3000, layers(30, r#"opacity=".9""#)),
            (3000, format!("{masks}{}", layers(1, r#"mask="url(#m0)""#))),
            (3000, format!("{clip}{}", layers(27, r#"clip-path="url(#c)""#))),
        ] {
            let fault = drawn_on(size, &hostile).unwrap_err();
            assert!(fault.reason.contains("a gigabyte"), "{}", fault.reason);
        }
        assert!(drawn_on(90, &pattern(r#"width="20" height="9""#)).is_ok());
        assert!(drawn_on(300, &format!("{masks}{}", layers(1, r##"mask="url(#m0)" opacity=".9""##))).is_ok());
    }

    #[test]
    fn references_that_lead_back_are_refused() {
        let shape = |more: &str| format!(r#"<rect width="9" height="9" {more}/>"#);
        let user = r#"width="9" height="9" patternUnits="userSpaceOnUse""#;
        let picture = r##"<filter id="f"><feImage href="#a"/></filter>"##;
        for hostile in [
            format!(r#"{picture}<g id="a">{}</g>"#, shape(r#"filter="url(#f)""#)),
            format!(
                r#"{picture}<pattern id="p" {user}>{}</pattern>{}"#,
                shape(r#"filter="url(#f)""#),
                shape(r#"id="a" fill="url(#p)""#)
            ),
            format!(
                r#"<pattern id="p" {user}>{0}</pattern><mask id="m">{1}</mask>{1}"#,
                shape(r#"mask="url(#m)""#),
                shape(r#"fill="url(#p)""#)
            ),
            format!(r##"<g id="a">{}<use href="#a"/></g>"##, shape("")),
            // By what is inherited, and by a style sheet.
            format!(r#"<g fill="url(#p)"><pattern id="p" {user}>{}</pattern></g>{}"#, shape(""), shape(r#"fill="url(#p)""#)),
            format!(r#"<style>.a{{mask:url(#m)}}</style><mask id="m">{0}</mask>{0}"#, shape(r#"class="a""#)),
            r#"<marker id="k"><path d="M0 0h9" style="marker-end: url(#k)"/></marker><path d="M0 0h9" marker-start="url(#k)"/>"#.into(),
        ] {
            refused(&hostile, "lead back to themselves");
        }
        // What refers to itself without being drawn twice.
        assert!(read(r##"<a id="a" href="#a"><rect width="9" height="9"/></a>"##).is_ok());
    }

    #[test]
    fn documents_that_unfold_without_end_are_refused() {
        let eight = |style: &str| format!(r#"<rect width="9" height="9" {style}/>"#).repeat(8);
        let chain =
            |open: &dyn Fn(usize) -> String, close: &str, style: &dyn Fn(usize) -> String| -> String {
                let level = |k: usize| {
                    format!("{}{}{close}", open(k), eight(&if k < 9 { style(k + 1) } else { String::new() }))
                };
                (0..10).map(level).collect::<String>() + &eight(&style(0))
            };
        let pattern =
            |k: usize| format!(r#"<pattern id="d{k}" width="9" height="9" patternUnits="userSpaceOnUse">"#);
        let fill = |k: usize| format!(r#"fill="url(#d{k})""#);
        let inherited =
            |k: usize| format!("{}<g {}>", pattern(k), if k < 9 { fill(k + 1) } else { String::new() });
        let of = |name: &'static str| move |k: usize| format!(r#"{name}="url(#d{k})""#);
        let marker = |k: usize| {
            let inner = format!(r#"<path d="M0 0L5 5L3 3L6 6L2 2" style="marker-mid:url(#d{})"/>"#, k + 1);
            format!(r#"<marker id="d{k}">{inner}</marker>"#)
        };
        let images =
            |k: usize| format!(r##"<filter id="d{k}"><feImage href="#e{k}"/></filter><g id="e{k}">"##);
        for hostile in [
            chain(&pattern, "</pattern>", &fill),
            chain(&inherited, "</g></pattern>", &|k| if k == 0 { fill(0) } else { String::new() }),
            chain(&|k| format!(r#"<mask id="d{k}">"#), "</mask>", &of("mask")),
            chain(&|k| format!(r#"<clipPath id="d{k}">"#), "</clipPath>", &of("clip-path")),
            chain(&images, "</g>", &of("filter")),
            (0..20).map(marker).collect::<String>() + r#"<path marker-mid="url(#d0)" d="M0 0L9 9L1 1L5 5"/>"#,
        ] {
            refused(&hostile, "unfold to more than");
        }
        let attributes: String = (0..60_000).map(|k| format!("a{k}='1' ")).collect();
        refused(&format!("<rect {attributes}/>"), "more than 1000 attributes");
        let long = |count: usize| format!(r#"<path id="a" d="M1 1{}"/>"#, "l2 1-1 2".repeat(count));
        let uses = |count: usize| r##"<use xlink:href="#a"/>"##.repeat(count);
        let markers = format!(
            r#"<marker id="m">{}</marker><path fill="none" marker-mid="url(#m)" d="M0 0{}"/>"#,
            long(1_000),
            "l1 1-1 1".repeat(10_000)
        );
        let in_bounds = |name: &str, units: &str| {
            let inner = long(1_000);
            format!(
                r#"<{name} id="m" width="9" height="9" {name}Units="userSpaceOnUse" {name}ContentUnits="{units}">{inner}</{name}>"#
            ) + &r#"<rect width="9" height="9" fill="url(#m)" mask="url(#m)"/>"#.repeat(8_000)
        };
        let outlines = "have more than 50 million characters";
        refused(&(long(1_000) + &uses(8_000)), outlines);
        refused(&markers, outlines);
        refused(&in_bounds("pattern", "objectBoundingBox"), outlines);
        refused(&in_bounds("mask", "objectBoundingBox"), outlines);
        assert!(read(&in_bounds("pattern", "userSpaceOnUse")).is_ok());
        assert!(read(&(long(1_000) + &uses(1_000))).is_ok());
        // A pattern of many parts in many shapes is no problem.
        let busy = format!(r#"{}{}</pattern>{}"#, pattern(0), eight(""), eight(&fill(0)).repeat(500));
        assert!(read(&busy).is_ok());
    }

    #[test]
    fn what_is_nested_as_deeply_as_permitted_needs_no_more_stack_than_threads_have() {
        let chain = |count: usize,
                     open: &dyn Fn(usize) -> String,
                     close: &str,
                     style: &dyn Fn(usize) -> String|
         -> String {
            let shape = |k: usize| {
                format!(
                    r#"<rect width="9" height="9" {}/>"#,
                    if k < count { style(k) } else { String::new() }
                )
            };
            (0..count).map(|k| format!("{}{}{close}", open(k), shape(k + 1))).collect::<String>() + &shape(0)
        };
        let url = |name: &'static str| move |k: usize| format!(r#"{name}="url(#d{k})""#);
        let deepest = |count: usize| {
            let user = r#"width="9" height="9" patternUnits="userSpaceOnUse""#;
            [
                format!(
                    "{}<rect width='9' height='9'/>{}",
                    "<g opacity='.9'>".repeat(count * 8),
                    "</g>".repeat(count * 8)
                ),
                chain(count, &|k| format!(r#"<pattern id="d{k}" {user}>"#), "</pattern>", &url("fill")),
                chain(count, &|k| format!(r#"<mask id="d{k}">"#), "</mask>", &url("mask")),
                chain(count, &|k| format!(r#"<clipPath id="d{k}">"#), "</clipPath>", &url("clip-path")),
                chain(
                    count / 2,
                    &|k| format!(r##"<filter id="d{k}"><feImage href="#e{k}"/></filter><g id="e{k}">"##),
                    "</g>",
                    &url("filter"),
                ),
            ]
        };
        let run = |inner: String| {
            let thread = std::thread::Builder::new().stack_size(2 << 20);
            thread.spawn(move || drawn_on(20, &inner).map(|_| ())).unwrap().join().unwrap()
        };
        for inner in deepest(110) {
            if let Err(fault) = run(inner) {
                assert!(fault.reason.contains("more than"), "{}", fault.reason);
            }
        }
        for inner in deepest(2_000) {
            assert!(run(inner).is_err());
        }
    }
}
