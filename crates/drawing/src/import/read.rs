//! SVG → items: every visible shape of the page, with its paint, group and layer.
//!
//! Unsupported parts are errors that name the element, or are left out and counted.

use super::clip;
use super::paint::{self, DrawnPaint};
use super::patterns;
use super::pieces::{DrawingPiece, subpaths};
use crate::svg_tree;
use kurbo::Shape as _;
use resvg::usvg::{self, roxmltree};
use std::collections::{BTreeMap, BTreeSet};
use vtex_base::error::{Error, Large, Result, clip_to};
use vtex_base::geometry::{Affine, BezPath, ConvexPolygon, PathEl, Point};
use vtex_base::progress::{Progress, advance};
use vtex_scene::element::stroked;

/// Largest SVG read, unpacked, in bytes.
const LARGEST: usize = 64 << 20;
/// Most shapes of a drawing.
const MOST_ITEMS: usize = 100_000;
/// Most XML elements of a drawing.
const MOST_NODES: usize = 400_000;
/// Most lines and curves of a drawing.
const MOST_SEGMENTS: usize = 10_000_000;
/// Furthest coordinate of a shape with its stroke, in widths of the page.
const FURTHEST: f64 = 100.0;
/// Length of a piece of a stroked path up to which it is a dot, in widths of the stroke.
const DOT: f64 = 0.02;
/// Largest side of a page, in units of the drawing.
const LARGEST_PAGE: f64 = 1e6;
/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";
/// A drawing as it was read; coordinates are those of its page.
pub(super) struct DrawingPage {
    /// Width and height.
    pub size: [f64; 2],
    /// Its shapes, in painting order, and what is drawn beside it in groups.
    pub(super) items: Vec<DrawnShape>,
    /// Number of shapes that count.
    pub(super) counted: usize,
    /// Its groups, each after those that hold it.
    pub(super) groups: Vec<ShapeGroup>,
    /// Names of its layers, bottom first; the first is for shapes outside of all layers.
    pub(super) layers: Vec<String>,
    /// One sentence for each kind of part that was changed or left out.
    pub(super) warnings: Vec<String>,
    /// Whether parts were left out that the tree contains.
    pub(super) is_incomplete: bool,
    /// The drawing itself.
    pub(super) tree: svg_tree::SvgTree,
}

/// A group of shapes.
pub(super) struct ShapeGroup {
    pub(super) parent: Option<usize>,
    /// Number of shapes within that count, those of inner groups included.
    pub(super) items: usize,
}

impl DrawingPage {
    /// Whether the shape of a piece lies beside the page.
    pub(super) fn is_beside(&self, piece: &DrawingPiece) -> bool {
        self.items[piece.item].is_beside
    }

    /// Counts the shapes of all groups, those beside the page only if it ends.
    pub(super) fn count(&mut self, ends: bool) {
        self.counted = 0;
        self.groups.iter_mut().for_each(|g| g.items = 0);
        for item in self.items.iter().filter(|i| ends || !i.is_beside) {
            self.counted += 1;
            let mut up = item.group;
            while let Some(g) = up {
                self.groups[g].items += 1;
                up = self.groups[g].parent;
            }
        }
    }
}

/// A shape.
pub(super) struct DrawnShape {
    pub(super) path: BezPath,
    pub(super) fill: Option<DrawnFill>,
    pub(super) stroke: Option<DrawnStroke>,
    /// The innermost group that holds it.
    pub(super) group: Option<usize>,
    pub(super) layer: usize,
    /// Whether it lies beside the page.
    pub(super) is_beside: bool,
}

/// How a shape is filled.
#[derive(Clone)]
pub(super) struct DrawnFill {
    pub(super) paint: DrawnPaint,
    pub(super) even_odd: bool,
}

/// How a shape is stroked. Lengths are those of the page.
#[derive(Clone)]
pub(super) struct DrawnStroke {
    pub(super) paint: DrawnPaint,
    pub(super) width: f64,
    pub(super) cap: usvg::LineCap,
    pub(super) join: usvg::LineJoin,
    pub(super) miter_limit: f64,
    pub(super) dashes: Vec<f64>,
    pub(super) dash_offset: f64,
}

/// Reads a drawing. Unsupported parts are errors, or are left out and counted if `lenient`.
/// With `of_pattern`, the page of a drawing that is nothing but a pattern is one copy of it.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    (lenient, of_pattern): (bool, bool),
    progress: &dyn Progress,
) -> Result<DrawingPage> {
    let fail = |found: svg_tree::SvgFault| fault(name, found.reason, found.advice);
    let text = svg_tree::text(bytes, name, fail)?;
    if text.len() > LARGEST {
        let found = format!("{} MB of SVG text", text.len() / 1_000_000);
        return Err(Error::TooLarge {
            what: Large::Drawing,
            name: name.into(),
            found,
            limit: "64 MiB".into(),
        });
    }
    let document = svg_tree::document(&text).map_err(fail)?;
    let nodes = document.descendants().filter(roxmltree::Node::is_element).count();
    if nodes > MOST_NODES {
        return Err(too_many(name, nodes, MOST_NODES));
    }
    let tree = svg_tree::tree_with_images(&document).map_err(fail)?;
    let size = [tree.size().width(), tree.size().height()].map(f64::from);
    let far = FURTHEST * size[0].max(size[1]);
    let part = if of_pattern { patterns::repeated_part(&tree) } else { None };
    let size = part.as_ref().map_or(size, |part| part.size);
    if size.iter().any(|v| !(1e-3..=LARGEST_PAGE).contains(v)) {
        // As 32-bit numbers they have no more digits than the drawing.
        let reason = format!("its page has {} x {} units", tree.size().width(), tree.size().height());
        return Err(fault(name, reason, "scale it to between 0.001 and 1000000 units"));
    }
    advance(progress, "drawing", 0, 4)?;
    let mut reader = DrawingReader { progress, far, ..DrawingReader::new(name, lenient, &document, size) };
    // The picture of the page is drawn from its shapes.
    (reader.is_pattern, reader.is_incomplete) = (part.is_some(), part.is_some());
    if part.as_ref().is_some_and(|part| part.is_turned) {
        reader.count("turned patterns are read upright");
    }
    let map = part.map_or(Affine::IDENTITY, |part| part.map);
    let root = WalkState { group: None, layer: 0, opacity: 1.0, map, depth: 0, id: "" };
    reader.group(tree.root(), root, &[])?;
    let DrawingReader { items, groups, layers, counts, is_incomplete, .. } = reader;
    let warnings = counts.into_iter().map(|(what, n)| format!("{what} ({n})"));
    let warnings = warnings.chain(texts(&document)).chain(foreign(&document)).collect();
    let mut page = DrawingPage { size, items, counted: 0, groups, layers, warnings, is_incomplete, tree };
    page.count(false);
    Ok(page)
}

/// An error about a drawing.
pub(super) fn fault(name: &str, reason: impl Into<String>, advice: &'static str) -> Error {
    Error::Control { name: name.into(), role: "a drawing", reason: reason.into(), advice }
}

fn too_many(name: &str, found: usize, most: usize) -> Error {
    let [found, limit] = [found, most].map(|n| format!("{n} shapes"));
    Error::TooLarge { what: Large::Drawing, name: name.into(), found, limit }
}

/// The message about texts, which the tree of shapes leaves out; `None` if there are no texts.
fn texts(document: &roxmltree::Document<'_>) -> Option<String> {
    let mut texts = document.descendants().filter(|n| n.has_tag_name((SVG, "text")));
    let first = texts.next()?;
    let words: String =
        first.descendants().filter_map(|n| if n.is_text() { n.text() } else { None }).collect();
    let words: String = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let more = match texts.count() {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    Some(format!("the text '{}'{more} is left out: turn it into a path", clip_to(&words, 60)))
}

/// The message about foreign objects, such as HTML, which the tree of shapes leaves out; `None` if there are none.
fn foreign(document: &roxmltree::Document<'_>) -> Option<String> {
    match document.descendants().filter(|n| n.has_tag_name((SVG, "foreignObject"))).count() {
        0 => None,
        1 => Some("1 <foreignObject> is left out: turn it into paths".into()),
        n => Some(format!("{n} <foreignObject> are left out: turn them into paths")),
    }
}

struct DrawingReader<'a, 'd> {
    progress: &'a dyn Progress,
    name: &'a str,
    lenient: bool,
    size: [f64; 2],
    /// Furthest coordinate of a shape.
    far: f64,
    /// The first XML element of each id.
    named: BTreeMap<&'a str, roxmltree::Node<'a, 'd>>,
    items: Vec<DrawnShape>,
    /// Lines and curves of all items.
    segments: usize,
    groups: Vec<ShapeGroup>,
    layers: Vec<String>,
    /// Names of the layers that are in use, and the next number of each title that occurs several times.
    taken: BTreeSet<String>,
    numbers: BTreeMap<String, usize>,
    /// Descriptions of what was changed or left out, with counts.
    counts: BTreeMap<&'static str, usize>,
    is_incomplete: bool,
    /// Number of copies of patterns.
    copies: usize,
    /// Whether the page is one copy of the pattern that the drawing is.
    is_pattern: bool,
}

/// State of the walk through the tree.
#[derive(Clone, Copy)]
struct WalkState<'t> {
    group: Option<usize>,
    layer: usize,
    opacity: f64,
    /// From the group to the page.
    map: Affine,
    depth: usize,
    /// The innermost id.
    id: &'t str,
}

impl<'a, 'd> DrawingReader<'a, 'd> {
    fn new(name: &'a str, lenient: bool, document: &'a roxmltree::Document<'d>, size: [f64; 2]) -> Self {
        let mut named = BTreeMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                named.entry(id).or_insert(node);
            }
        }
        let layers: Vec<String> = vec![vtex_scene::element::Role::Primary.name().into()];
        let background = vtex_scene::element::Role::Background.name().to_owned();
        Self {
            progress: &(),
            name,
            lenient,
            size,
            far: f64::INFINITY,
            named,
            items: Vec::new(),
            segments: 0,
            groups: Vec::new(),
            taken: layers.iter().cloned().chain([background]).collect(),
            layers,
            numbers: BTreeMap::new(),
            counts: BTreeMap::new(),
            is_incomplete: false,
            copies: 0,
            is_pattern: false,
        }
    }

    fn count(&mut self, what: &'static str) {
        *self.counts.entry(what).or_default() += 1;
    }

    /// Leaves a part out, or fails unless `lenient`.
    fn unreadable(&mut self, id: &str, what: &'static str, counted: &'static str) -> Result<()> {
        if self.lenient {
            self.count(counted);
            self.is_incomplete = true;
            return Ok(());
        }
        let id = if id.is_empty() { String::new() } else { format!(" '{}'", clip_to(id, 60)) };
        Err(Error::Undrawable { name: self.name.into(), reason: format!("the element{id} {what}") })
    }

    fn group<'t>(
        &mut self,
        group: &'t usvg::Group,
        place: WalkState<'t>,
        clips: &[ConvexPolygon],
    ) -> Result<()> {
        let id = group.id();
        let opacity = place.opacity * f64::from(group.opacity().get());
        let map = svg_tree::within(place.map, group);
        if group.mask().is_some() {
            return self.unreadable(id, "has a mask", "elements with masks are left out");
        }
        if !group.filters().is_empty() {
            return self.unreadable(id, "has a filter", "elements with filters are left out");
        }
        if group.blend_mode() != usvg::BlendMode::Normal {
            return self.unreadable(id, "is blended", "elements with blend modes are left out");
        }
        let mut clips = clips.to_vec();
        if let Some(path) = group.clip_path() {
            match clip::polygon(path, map) {
                Some(clip) => clips.push(clip),
                None => {
                    let what = "is clipped by something else than one convex polygon";
                    return self.unreadable(id, what, "elements with other clip paths are left out");
                }
            }
        }
        if opacity < 1.0 && group.opacity().get() < 1.0 && group.children().len() > 1 {
            self.count("translucent groups are drawn shape by shape");
        }
        let layer = self.layer(group, place);
        let depth = place.depth + 1;
        // The root and layers are not groups of shapes.
        let is_group = place.depth > 0 && layer == place.layer && group.children().len() > 1;
        let inner = if is_group {
            self.groups.push(ShapeGroup { parent: place.group, items: 0 });
            Some(self.groups.len() - 1)
        } else {
            place.group
        };
        let id = if id.is_empty() { place.id } else { id };
        let place = WalkState { group: inner, layer, opacity, map, depth, id };
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => self.group(inner, place, &clips)?,
                usvg::Node::Path(path) if path.is_visible() => {
                    self.pattern(path, place, &clips)?;
                    self.path(path, place, &clips)?;
                }
                usvg::Node::Image(image) if image.is_visible() => {
                    self.unreadable(place.id, "is a raster image", "raster images are left out")?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The layer of a group: its own if Inkscape or Illustrator marked it as one.
    fn layer(&mut self, group: &usvg::Group, place: WalkState<'_>) -> usize {
        let id = group.id();
        if id.is_empty() || place.group.is_some() {
            return place.layer;
        }
        let node = self.named.get(id).copied();
        let attribute = |name: &str| {
            node.and_then(|n| n.attributes().find(|a| a.name() == name).map(|a| a.value().to_owned()))
        };
        let marked = attribute("groupmode").as_deref() == Some("layer")
            || id.to_ascii_lowercase().starts_with("layer");
        if !marked {
            return place.layer;
        }
        let title = attribute("label").or_else(|| attribute("data-name")).unwrap_or_else(|| id.to_owned());
        let title: String = title.chars().filter(|c| !c.is_control()).take(60).collect();
        let mut name = title.clone();
        let number = self.numbers.entry(title.clone()).or_insert(2);
        while name.trim().is_empty() || self.taken.contains(&name) {
            name = format!("{title} {number}");
            *number += 1;
        }
        self.taken.insert(name.clone());
        self.layers.push(name);
        self.layers.len() - 1
    }

    /// The copies of the pattern that fills a path, if one does.
    fn pattern<'t>(
        &mut self,
        path: &'t usvg::Path,
        place: WalkState<'t>,
        clips: &[ConvexPolygon],
    ) -> Result<()> {
        let Some(fill) = path.fill() else { return Ok(()) };
        let usvg::Paint::Pattern(pattern) = fill.paint() else { return Ok(()) };
        let opacity = place.opacity * f64::from(fill.opacity().get());
        // The contents are no group.
        let within = |map: Affine| WalkState { opacity, map, depth: 0, id: path.id(), ..place };
        if self.is_pattern {
            // Its other copies are those of the page.
            let [a, b, c, d, ..] = patterns::map(pattern, place.map).as_coeffs();
            return self.group(pattern.root(), within(Affine::new([a, b, c, d, 0.0, 0.0])), clips);
        }
        let drawn = place.map * bezier(path.data());
        let Some(shape) = ConvexPolygon::of_path(&drawn) else {
            let what = "is no convex polygon, and filled with a pattern";
            return self.unreadable(path.id(), what, "pattern fills of other shapes are left out");
        };
        let Some(copies) = patterns::copies(pattern, place.map, drawn.bounding_box()) else {
            let what = "is filled with too many copies of a pattern";
            return self.unreadable(path.id(), what, "pattern fills of very many copies are left out");
        };
        self.copies += copies.len();
        if self.copies > MOST_ITEMS {
            return Err(too_many(self.name, self.copies, MOST_ITEMS));
        }
        for (map, tile) in copies {
            let clips = [clips, &[shape.clone(), tile]].concat();
            self.group(pattern.root(), within(map), &clips)?;
        }
        Ok(())
    }

    fn path(&mut self, path: &usvg::Path, place: WalkState<'_>, clips: &[ConvexPolygon]) -> Result<()> {
        advance(self.progress, "drawing", 0, 4)?;
        if self.items.len() >= MOST_ITEMS {
            return Err(too_many(self.name, self.items.len() + 1, MOST_ITEMS));
        }
        self.segments += path.data().len();
        if self.segments > MOST_SEGMENTS {
            let found = "more than 10 million lines and curves".into();
            return Err(Error::TooLarge {
                what: Large::Drawing,
                name: self.name.into(),
                found,
                limit: "10 million".into(),
            });
        }
        let map = place.map;
        let of = |paint: &usvg::Paint, opacity: usvg::Opacity| {
            paint::paint(paint, place.opacity * f64::from(opacity.get()), map)
        };
        let mut painted = Vec::new();
        for (part, found) in [
            (true, path.fill().map(|f| of(f.paint(), f.opacity()))),
            (false, path.stroke().map(|s| of(s.paint(), s.opacity()))),
        ] {
            match found {
                Some(Some((paint, remark))) => {
                    if let Some(remark) = remark {
                        self.count(remark);
                    }
                    painted.push((part, paint));
                }
                Some(None) if !part => {
                    let what = "is stroked with a pattern";
                    self.unreadable(path.id(), what, "strokes of a pattern are left out")?;
                }
                // The copies of the pattern are drawn.
                Some(None) | None => {}
            }
        }
        let fill = painted.iter().find(|p| p.0).map(|(_, paint)| DrawnFill {
            paint: paint.clone(),
            even_odd: path.fill().is_some_and(|f| f.rule() == usvg::FillRule::EvenOdd),
        });
        let stroke = painted.iter().find(|p| !p.0).and_then(|(_, p)| stroke(path.stroke()?, p.clone(), map));
        let whole = bezier(path.data());
        let reach = stroke.as_ref().map_or(0.0, |s| s.stroke.width / 2.0);
        let b = (map * &whole).bounding_box().inflate(reach, reach);
        if ![b.x0, b.y0, b.x1, b.y1].iter().all(|v| v.abs() <= self.far) {
            let what = "reaches further than a hundred pages away";
            return self.unreadable(path.id(), what, "shapes that reach far beyond the page are left out");
        }
        let (local, dots) = match &stroke {
            Some(stroke) => stroke.apart_from_dots(&whole),
            None => (whole, BezPath::new()),
        };
        let drawn = map * &local;
        let WalkState { group, layer, .. } = place;
        let new = |path, fill, stroke| DrawnShape { path, fill, stroke, group, layer, is_beside: false };
        let mut items = Vec::new();
        let cut = clips.iter().any(|clip| !clip.holds(inflated(&drawn, stroke.as_ref())));
        let plain = stroke.as_ref().is_none_or(|s| s.conformal) && !cut;
        let solid = |s: &Stroked| Some(DrawnFill { paint: s.stroke.paint.clone(), even_odd: false });
        let dots = stroke.as_ref().map(|s| new(map * dots, solid(s), None));
        if plain {
            items.push(new(drawn, fill, stroke.map(|s| s.stroke)));
        } else {
            let line = stroke.map(|s| new(map * s.expanded(&local), solid(&s), None));
            items.extend(fill.map(|fill| new(drawn, Some(fill), None)));
            items.extend(line);
        }
        items.extend(dots);
        for item in &mut items {
            item.path = clips.iter().fold(std::mem::take(&mut item.path), |p, clip| clip.clipped(&p));
        }
        let page = clip::page(self.size);
        let around = page.inflate(page.width(), page.height());
        for item in items {
            let reach = item.stroke.as_ref().map_or(0.0, |s| s.width * s.miter_limit.max(1.5));
            let painted = item.fill.is_some() || item.stroke.is_some();
            let b = item.path.bounding_box().inflate(reach, reach);
            let is_beside = !b.overlaps(page);
            // Beside the page only parts of groups matter.
            if painted
                && !item.path.elements().is_empty()
                && (!is_beside || group.is_some() && b.overlaps(around))
            {
                self.items.push(DrawnShape { is_beside, ..item });
            }
        }
        Ok(())
    }
}

/// Bounds of a path with its stroke.
fn inflated(path: &BezPath, stroke: Option<&Stroked>) -> kurbo::Rect {
    let reach = stroke.map_or(0.0, |s| s.stroke.width * s.stroke.miter_limit.max(1.5) / 2.0);
    path.bounding_box().inflate(reach, reach)
}

/// A stroke, on the page and before its transform.
struct Stroked {
    stroke: DrawnStroke,
    /// Whether the transform preserves angles.
    conformal: bool,
    /// The stroke before the transform.
    local: kurbo::Stroke,
}

impl Stroked {
    /// A path without its pieces that have no length to speak of, and what their caps paint: discs, squares, or nothing.
    /// Programs store dots so.
    fn apart_from_dots(&self, path: &BezPath) -> (BezPath, BezPath) {
        let width = self.local.width;
        let (mut lines, mut dots) = (BezPath::new(), BezPath::new());
        for piece in subpaths(path) {
            match (piece.elements(), self.local.start_cap) {
                (_, _) if piece.perimeter(DOT * width) > DOT * width => lines.extend(piece),
                ([PathEl::MoveTo(at), ..], kurbo::Cap::Round) => {
                    dots.extend(kurbo::Circle::new(*at, width / 2.0).path_elements(1e-3 * width));
                }
                ([PathEl::MoveTo(at), ..], kurbo::Cap::Square) => {
                    dots.extend(kurbo::Rect::from_center_size(*at, (width, width)).path_elements(width));
                }
                _ => {}
            }
        }
        (lines, dots)
    }

    /// The area that it paints, before the transform.
    fn expanded(&self, path: &BezPath) -> BezPath {
        let tolerance = 1e-3 * self.local.width.max(1e-6);
        stroked(path, self.local.clone(), tolerance)
    }
}

fn stroke(s: &usvg::Stroke, paint: DrawnPaint, map: Affine) -> Option<Stroked> {
    let [a, b, c, d, ..] = map.as_coeffs();
    let size = libm::sqrt(map.determinant().abs());
    let width = f64::from(s.width().get());
    if !(size > 0.0 && width > 0.0) {
        return None;
    }
    let off = |direct: bool| {
        let sign = if direct { 1.0 } else { -1.0 };
        (a - sign * d).abs() + (b + sign * c).abs()
    };
    let conformal = off(true).min(off(false)) < 1e-4 * size;
    let dashes: Vec<f64> = s.dasharray().into_iter().flatten().map(|d| f64::from(*d)).collect();
    let offset = f64::from(s.dashoffset());
    let miter_limit = f64::from(s.miterlimit().get());
    let cap = match s.linecap() {
        usvg::LineCap::Butt => kurbo::Cap::Butt,
        usvg::LineCap::Round => kurbo::Cap::Round,
        usvg::LineCap::Square => kurbo::Cap::Square,
    };
    let join = match s.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => kurbo::Join::Miter,
        usvg::LineJoin::Round => kurbo::Join::Round,
        usvg::LineJoin::Bevel => kurbo::Join::Bevel,
    };
    let mut local = kurbo::Stroke::new(width).with_caps(cap).with_join(join).with_miter_limit(miter_limit);
    if !dashes.is_empty() {
        local = local.with_dashes(offset, dashes.iter().copied());
    }
    let stroke = DrawnStroke {
        paint,
        width: width * size,
        cap: s.linecap(),
        join: s.linejoin(),
        miter_limit,
        dashes: dashes.iter().map(|d| d * size).collect(),
        dash_offset: offset * size,
    };
    Some(Stroked { stroke, conformal, local })
}

/// A path of the tree, its quadratic curves as cubic ones.
pub(super) fn bezier(path: &usvg::tiny_skia_path::Path) -> BezPath {
    use usvg::tiny_skia_path::PathSegment;
    let point = |p: usvg::tiny_skia_path::Point| Point::new(f64::from(p.x), f64::from(p.y));
    let mut out = BezPath::new();
    let mut at = Point::ORIGIN;
    for segment in path.segments() {
        match segment {
            PathSegment::MoveTo(p) => {
                at = point(p);
                out.move_to(at);
            }
            PathSegment::LineTo(p) => {
                at = point(p);
                out.line_to(at);
            }
            PathSegment::QuadTo(a, p) => {
                let (a, p) = (point(a), point(p));
                out.curve_to(at.lerp(a, 2.0 / 3.0), p.lerp(a, 2.0 / 3.0), p);
                at = p;
            }
            PathSegment::CubicTo(a, b, p) => {
                at = point(p);
                out.curve_to(point(a), point(b), at);
            }
            PathSegment::Close => out.close_path(),
        }
    }
    out
}
