//! Pieces → library: elements, their layers, the map of them, the guide.
//!
//! A library has one element for each place in the drawing, so that labels of the arrangement tell them
//! apart. Scenes store equal elements once.

use super::ImportParams;
use super::categories::categorise;
use super::clip::page as page_of;
use super::elements::{NEAREST, PieceProperties, elements};
use super::motifs::{MotifSource, motifs};
use super::offsets::{Offsets, Shift, minus, plus};
use super::pieces::DrawingPiece;
use super::read::DrawingPage;
use super::shapes::shapes;
use super::stacking::{DrawnCopy, Overlaps};
use super::torus::Torus;
use image::RgbImage;
use kurbo::Shape as _;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::{Affine, ConvexPolygon, Outline, Rect};
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::contact;
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::element;
use vtex_scene::lattice;
use vtex_scene::library::{
    AnalyzeParams, Arrangement, ElementId, ExemplarElement, ExemplarInstance, ExemplarLayer, Guide, Library,
    Role, Shape, Source, SourceKind,
};
use vtex_scene::scene::{Field, pixels};

/// Least length of a page's shorter side, in pixels.
const LEAST_SIDE: f64 = 200.0;
/// Largest length of a page's longer side, in pixels.
const MOST_SIDE: f64 = 4096.0;
/// Longest side to which a page with small pieces is enlarged, in pixels.
const ENLARGED: f64 = 1600.0;
/// Cells of the guide across the median piece.
const CELLS: f64 = 8.0;
/// Distance by which shapes cut at a border reach beyond it, in pixels, so that copies leave no gap.
const UNDERLAP: f64 = 0.4;
/// Least share of the page that a background covers.
const COVERS: f64 = 0.995;

/// Least length of a page's shorter side, and largest of its longer one, in units of the library.
const SHORTEST: f64 = 10.0;
const LONGEST: f64 = 16_000.0;

/// Further inputs of the library.
pub(super) struct DrawingOrigin<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) name: &'a str,
    pub(super) params: &'a ImportParams,
    pub(super) wrap: bool,
    /// What was drawn, in painting order, as copies of the pieces; empty for a page that ends.
    pub(super) copies: Vec<DrawnCopy>,
    pub(super) scale: [u32; 2],
    pub(super) picture: RgbImage,
    pub(super) background: Colour,
}

/// Most pixels that all pieces together may paint.
const MOST_PAINTED: f64 = 1e9;
/// Most runs of pixels of all pieces together.
const MOST_RUNS: usize = 50_000_000;
/// Number of pieces rasterised at a time.
const AT_ONCE: usize = 1024;

/// Size of the page, in pixels of the library.
///
/// # Errors
/// [`Error::TooLarge`] for pieces that cover the page too often.
pub(super) fn scale(page: &DrawingPage, pieces: &[DrawingPiece], name: &str) -> Result<[u32; 2]> {
    let [short, long] = [page.size[0].min(page.size[1]), page.size[0].max(page.size[1])];
    let mut extents: Vec<f64> = pieces
        .iter()
        .filter(|p| !page.is_beside(p))
        .map(DrawingPiece::bounds)
        .filter(|b| b.width() < 0.9 * page.size[0] || b.height() < 0.9 * page.size[1])
        .map(|b| libm::sqrt(b.width().max(1e-6) * b.height().max(1e-6)))
        .collect();
    extents.sort_by(f64::total_cmp);
    let median = extents.get(extents.len() / 2).copied().unwrap_or(short);
    let for_pieces = (2.0 * CELLS / median.max(1e-6)).min(ENLARGED / long);
    let mut factor = libm::ceil((LEAST_SIDE / short).max(for_pieces)).max(1.0);
    factor = factor.min(MOST_SIDE / long);
    let around = page_of(page.size).inflate(page.size[0], page.size[1]);
    let painted: f64 = pieces.iter().map(|p| p.bounds().intersect(around).area().min(p.reach())).sum();
    if painted * factor * factor > MOST_PAINTED {
        factor = libm::sqrt(MOST_PAINTED / painted).max(factor.min(LEAST_SIDE / short));
    }
    let times = |painted: f64| painted / page.size[0] / page.size[1];
    if painted * factor * factor > 1.01 * MOST_PAINTED {
        let found = format!("shapes that cover its page {:.0} times", times(painted));
        let limit = format!("{:.0} times", times(MOST_PAINTED / factor / factor));
        return Err(Error::TooLarge { what: Large::Drawing, name: name.into(), found, limit });
    }
    Ok(page.size.map(|v| libm::round(v * factor).max(1.0) as u32))
}

/// The colour of the page, and the pieces on it. Without a background, the page is white.
pub(super) fn background(page: &DrawingPage, pieces: Vec<DrawingPiece>) -> (Colour, Vec<DrawingPiece>) {
    let clip = ConvexPolygon::rect(page_of(page.size));
    let whole = page.size[0] * page.size[1];
    let covers = |piece: &DrawingPiece| {
        let [part] = &piece.parts[..] else { return false };
        let plain = part.stroke.is_none() && part.paint.gradient.is_none() && part.paint.opacity >= 1.0;
        let b = part.path.bounding_box();
        let wide = b.width() >= COVERS * page.size[0] && b.height() >= COVERS * page.size[1];
        plain && wide && clip.clipped(&part.path).area().abs() >= COVERS * whole
    };
    match pieces.iter().rposition(covers) {
        Some(k) => (pieces[k].parts[0].paint.colour, pieces.into_iter().skip(k + 1).collect()),
        None => (Colour([255; 3]), pieces),
    }
}

/// An element under construction.
struct Draft {
    shapes: Vec<Shape>,
    layer: usize,
    /// Place in the painting order.
    order: usize,
    /// Its pieces, and the periods by which they are moved.
    pieces: Vec<(usize, Shift)>,
    mask: Mask,
    /// The author's innermost group, if all of it is in one.
    group: Option<usize>,
    /// Whether it is endless: it continues across the borders of the page from copy to copy.
    endless: bool,
}

/// The library of pieces.
///
/// # Errors
/// [`Error::TooLarge`] for pieces of too many runs of pixels; [`Error::Interrupted`].
pub(super) fn assemble(
    page: &DrawingPage,
    pieces: &[DrawingPiece],
    origin: DrawingOrigin<'_>,
    progress: &dyn Progress,
) -> Result<Library> {
    let go_on = || advance(progress, "drawing", 3, 4);
    let DrawingOrigin { wrap, scale: [width, height], .. } = origin;
    let size = [f64::from(width), f64::from(height)];
    let (stacking, drafts) = stacked(drafts(page, pieces, &origin, size, &go_on)?, &origin.copies);
    let mut labels = LabelMap::filled(width, height, 0);
    for (k, draft) in drafts.iter().enumerate() {
        go_on()?;
        paint(&mut labels, &draft.mask, k as u32 + 1, wrap);
    }
    let areas = labels.areas();
    let pixels = size[0] * size[1];
    let visible = |k: usize| areas.get(k + 1).map_or(0.0, |a| f64::from(*a));
    let mut elements: Vec<ExemplarElement> = Vec::with_capacity(drafts.len());
    for draft in &drafts {
        go_on()?;
        elements.push(element(draft, size, wrap));
    }
    let motifs = {
        let layers: Vec<usize> = drafts.iter().map(|d| d.layer).collect();
        let groups: Vec<Option<usize>> = drafts.iter().map(|d| d.group).collect();
        let is_endless: Vec<bool> = drafts.iter().map(|d| d.endless).collect();
        let source = MotifSource {
            elements: &elements,
            layers: &layers,
            groups: &groups,
            is_endless: &is_endless,
            size,
            wrap,
        };
        motifs(&source, origin.params.analyze.group, &go_on)?
    };
    let shares: Vec<f64> = (0..elements.len()).map(|k| visible(k) / pixels).collect();
    let params = &origin.params.analyze;
    go_on()?;
    let categories = categorise(&mut elements, &shares, params.categories.most());
    let coverage = categories.iter().fold(0.0, |sum, c| sum + c.coverage).min(1.0);
    let spacing = libm::sqrt(pixels / (elements.len().max(1) as f64));
    let most = width.min(height) / 2;
    let mut warnings = page.warnings.clone();
    if elements.is_empty() {
        warnings.push("the drawing contains nothing but a background".into());
    }
    let analyze = AnalyzeParams { wrap, ..params.clone() };
    let guide = Guide::of(&origin.picture);
    let layers = layers(page, &drafts, origin.background);
    let (unit, remark) = unit(page);
    warnings.extend(remark);
    let page = page.size.map(|side| side / unit);
    let pixels = [0, 1].map(|k| size[k] / page[k]);
    let library = Library {
        format: Library::FORMAT.into(),
        version: Library::VERSION,
        source: Source {
            kind: SourceKind::Drawing,
            file: origin.name.into(),
            width,
            height,
            scale: [1.0; 2],
            copies: [1; 2],
            stacking,
            contrast: 1.0,
            light: None,
            sha256: Sha256::digest(origin.bytes).iter().map(|b| format!("{b:02x}")).collect(),
            segmenter: "drawing".into(),
            parameters: analyze,
            program: vtex_base::PROGRAM.into(),
            strata_reason: None,
            warnings,
        },
        layers,
        elements,
        categories,
        coverage,
        arrangement: Arrangement { periodic: wrap, ..Arrangement::from_labels(&labels) },
        descriptor_half: (libm::round(params.descriptor_reach * spacing) as u32).clamp(1, most.max(1)),
        lattice: if wrap { lattice::of_period(&origin.picture) } else { lattice::find(&origin.picture) },
        motifs,
        guide: Some(guide),
    };
    let mut library = library.scaled(pixels.map(|v| 1.0 / v));
    library.source.scale = pixels;
    [library.source.width, library.source.height] = page.map(|side| (libm::round(side) as u32).max(1));
    Ok(library)
}

/// Units of the page per unit of the library, a power of ten, and a warning about it. It is 1 except for
/// pages that are too small or too large for a library.
fn unit(page: &DrawingPage) -> (f64, Option<String>) {
    let [short, long] = [page.size[0].min(page.size[1]), page.size[0].max(page.size[1])];
    let mut unit = 1.0;
    while short / unit < SHORTEST {
        unit /= 10.0;
    }
    while long / unit > LONGEST {
        unit *= 10.0;
    }
    let [w, h] = page.size.map(|side| libm::round(side / unit));
    let remark = || {
        let [x, y] = page.size.map(|side| libm::round(side * 1e3) / 1e3);
        format!("the page of {x} x {y} units is read as one of {w} x {h}")
    };
    (unit, (unit != 1.0).then(remark))
}

/// Shapes and pixels of each piece.
///
/// # Errors
/// [`Error::TooLarge`] for too many runs of pixels.
fn drawn(
    pieces: &[DrawingPiece],
    name: &str,
    draw: impl Fn(&DrawingPiece) -> (Vec<Shape>, Mask) + Sync,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(Vec<Vec<Shape>>, Vec<Mask>)> {
    let (mut shapes, mut masks) = (Vec::with_capacity(pieces.len()), Vec::with_capacity(pieces.len()));
    let mut runs = 0;
    for chunk in pieces.chunks(AT_ONCE) {
        go_on()?;
        for (own, mask) in parallel::map(chunk, &draw) {
            runs += mask.spans().len();
            shapes.push(own);
            masks.push(mask);
        }
        if runs > MOST_RUNS {
            let found = "shapes of more than 50 million runs of pixels".into();
            return Err(Error::TooLarge {
                what: Large::Drawing,
                name: name.into(),
                found,
                limit: "50 million runs".into(),
            });
        }
    }
    Ok((shapes, masks))
}

/// The elements in painting order, layer by layer.
fn drafts(
    page: &DrawingPage,
    pieces: &[DrawingPiece],
    origin: &DrawingOrigin<'_>,
    size: [f64; 2],
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<Draft>> {
    let map = Affine::scale_non_uniform(size[0] / page.size[0], size[1] / page.size[1]);
    let torus = Torus::new(page.size);
    let wrap = origin.wrap;
    let pixels = size[0] / page.size[0];
    let cut: Vec<bool> = pieces
        .iter()
        .map(|p| wrap && p.parts.iter().any(|part| part.stroke.is_none() && torus.is_cut(&part.path)))
        .collect();
    let draw = |piece: &DrawingPiece| {
        let shapes = shapes(piece, map);
        let [w, h] = size.map(|v| v as i32);
        let mask = mask(&shapes, size);
        (shapes, if wrap { mask } else { mask.within([0, 0], [w, h]) })
    };
    let (drawn, masks) = drawn(pieces, origin.name, draw, go_on)?;
    let sides = size.map(|v| v as i32);
    let (visible, mut contacts) = contact::ContactPage::new(sides, [wrap; 2], &masks);
    let reach = 2.5 * NEAREST * libm::sqrt(size[0] * size[1]);
    visible.near(libm::ceil(reach).min(400.0) as u16, &mut contacts, go_on)?;
    let properties = PieceProperties {
        page,
        pieces,
        cut: cut.clone(),
        bounds: drawn.iter().map(|d| element::bounds(d)).collect(),
        areas: masks.iter().map(Mask::area).collect(),
        contacts,
        size,
    };
    drop(masks);
    go_on()?;
    let mut sets = elements(&properties, &drawn, origin.params.analyze.elements);
    mark_endless(&properties, &mut sets);
    // Shapes that were cut extend beyond the border.
    let widened = |k: usize| -> Vec<Shape> {
        if !cut[k] {
            return drawn[k].clone();
        }
        let mut piece = pieces[k].clone();
        // Where translucent copies overlapped, a line would be seen.
        for part in piece.parts.iter_mut().filter(|p| p.stroke.is_none() && p.paint.opacity >= 1.0) {
            part.path = torus.widened(&part.path, UNDERLAP / pixels);
        }
        let wide = shapes(&piece, map);
        // A hairline along the border may vanish.
        if wide.is_empty() { drawn[k].clone() } else { wide }
    };
    let mut groups: BTreeMap<(usize, usize), Vec<(usize, Shift)>> = BTreeMap::new();
    for k in (0..pieces.len()).filter(|&k| !drawn[k].is_empty()) {
        let (root, shift) = sets.find(k);
        // Each piece of an endless set is its own element.
        let key = if sets.is_endless(k) { ((k, 1), [0; 2]) } else { ((root, 0), shift) };
        groups.entry(key.0).or_default().push((k, key.1));
    }
    let mut drafts: Vec<Draft> = Vec::with_capacity(groups.len());
    // What lies beside the page belongs to an element on it, or to none.
    groups.retain(|_, members| !members.iter().all(|m| page.is_beside(&pieces[m.0])));
    for ((_, kind), members) in groups {
        go_on()?;
        drafts.push(draft(&members, pieces, &widened, size, wrap, kind == 1));
    }
    drafts.sort_by_key(|d| (d.layer, d.order));
    Ok(drafts)
}

/// How copies of the page overlap, and the elements, in the order in which their copies on the page are painted if copies
/// are stacked.
fn stacked(drafts: Vec<Draft>, copies: &[DrawnCopy]) -> ([i32; 2], Vec<Draft>) {
    let mut elements: BTreeMap<usize, (usize, Shift)> = BTreeMap::new();
    for (k, draft) in drafts.iter().enumerate() {
        elements.extend(draft.pieces.iter().map(|&(piece, shift)| (piece, (k, shift))));
    }
    let of_element = |copy: &DrawnCopy| {
        let (element, own) = elements.get(&copy.piece)?;
        Some(DrawnCopy { piece: *element, shift: plus(copy.shift, minus(*own)), ..*copy })
    };
    let seen: Vec<DrawnCopy> = copies.iter().filter_map(of_element).collect();
    // Where each is painted: on the page, or where it is drawn at all.
    let mut painted: Vec<(bool, usize)> = vec![(false, 0); drafts.len()];
    for (place, copy) in seen.iter().enumerate() {
        painted[copy.piece] = painted[copy.piece].max((copy.shift == [0; 2], place));
    }
    let mut order: Vec<usize> = (0..drafts.len()).collect();
    order.sort_by_key(|&k| (drafts[k].layer, painted[k].1, k));
    let mut place = vec![0; drafts.len()];
    order.iter().enumerate().for_each(|(n, &k)| place[k] = n);
    let in_order: Vec<DrawnCopy> = seen.iter().map(|c| DrawnCopy { piece: place[c.piece], ..*c }).collect();
    let layers: Vec<usize> = order.iter().map(|&k| drafts[k].layer).collect();
    let stacking = Overlaps::new(&in_order, &layers).stacking();
    if stacking == [0; 2] {
        return (stacking, drafts);
    }
    let mut numbered: Vec<(usize, Draft)> = place.into_iter().zip(drafts).collect();
    numbered.sort_by_key(|(place, _)| *place);
    (stacking, numbered.into_iter().map(|(_, draft)| draft).collect())
}

/// Marks the endless pieces: those that touch their own copy a period away.
fn mark_endless(properties: &PieceProperties<'_>, sets: &mut Offsets) {
    for (&(a, b, shift), contact) in &properties.contacts {
        let same = sets.find(a as usize).0 == sets.find(b as usize).0;
        if contact.gap == 0 && same && (properties.cut[a as usize] || a == b) {
            sets.join(a as usize, b as usize, shift);
        }
    }
}

/// An element made of pieces, moved by whole periods so that its middle lies on the page.
fn draft(
    members: &[(usize, Shift)],
    pieces: &[DrawingPiece],
    drawn: &dyn Fn(usize) -> Vec<Shape>,
    size: [f64; 2],
    wrap: bool,
    endless: bool,
) -> Draft {
    let vector = |s: Shift| (f64::from(s[0]) * size[0], f64::from(s[1]) * size[1]);
    let mut shapes: Vec<Shape> = members
        .iter()
        .flat_map(|&(k, shift)| {
            let by = Affine::translate(vector(shift));
            drawn(k).into_iter().map(move |shape| if shift == [0; 2] { shape } else { shape.moved(by) })
        })
        .collect();
    let mut all = mask(&shapes, size);
    let mut home = [0; 2];
    if wrap && !endless {
        let middle = all.centroid().map_or_else(|| element::bounds(&shapes).center(), |(x, y)| (x, y).into());
        home = minus([libm::floor(middle.x / size[0]) as i32, libm::floor(middle.y / size[1]) as i32]);
        if home != [0; 2] {
            let by = Affine::translate(vector(home));
            shapes = shapes.iter().map(|s| s.moved(by)).collect();
            all = mask(&shapes, size);
        }
    }
    let order = members.iter().map(|m| m.0).max().unwrap_or(0);
    let layer = members.first().map_or(0, |m| pieces[m.0].layer);
    let group = members.first().and_then(|m| pieces[m.0].group);
    let group = group.filter(|g| members.iter().all(|m| pieces[m.0].group == Some(*g)));
    let own = members.iter().map(|&(piece, shift)| (piece, plus(shift, home))).collect();
    Draft { shapes, layer, order, pieces: own, mask: all, group, endless }
}

/// The pixels that shapes paint on the page and up to a page away.
fn mask(shapes: &[Shape], size: [f64; 2]) -> Mask {
    let [w, h] = size.map(|v| v as i32);
    pixels::of_shapes(shapes).within([-w, -h], [2 * w, 2 * h])
}

/// Whether the border of a page that ends cuts shapes: they have an edge along it, run across the page, or their `middle`
/// lies beside it. Shapes that go on beyond the border are whole as they were drawn.
fn is_cut(shapes: &[Shape], middle: [f64; 2], size: [f64; 2]) -> bool {
    let torus = Torus::new(size);
    let is_beside = (0..2).any(|k| !(0.0..size[k]).contains(&middle[k]));
    let runs_across = |b: Rect| b.x0 <= 0.0 && b.x1 >= size[0] || b.y0 <= 0.0 && b.y1 >= size[1];
    let ends = |s: &Shape| runs_across(s.outline.bounds()) || torus.is_cut(s.outline.path());
    is_beside || shapes.iter().any(ends)
}

fn paint(labels: &mut LabelMap, mask: &Mask, label: u32, wrap: bool) {
    let [w, h] = [labels.width as i32, labels.height as i32];
    for (x, y) in mask.pixels() {
        if wrap || ((0..w).contains(&x) && (0..h).contains(&y)) {
            labels.set(x.rem_euclid(w) as u32, y.rem_euclid(h) as u32, label);
        }
    }
}

fn element(draft: &Draft, size: [f64; 2], wrap: bool) -> ExemplarElement {
    let bounds = element::bounds(&draft.shapes);
    let centre = bounds.center();
    let (x, y) = draft.mask.centroid().map_or((centre.x, centre.y), |(x, y)| (x + 0.5, y + 0.5));
    let inside = |v: f64, size: f64| if v.is_finite() { v.clamp(0.0, size) } else { 0.0 };
    let centroid = [inside(x, size[0]), inside(y, size[1])].map(|v| libm::round(v * 100.0) / 100.0);
    let largest = draft.shapes.iter().max_by(|a, b| a.outline.area().total_cmp(&b.outline.area()));
    let silhouette = silhouette(&draft.shapes);
    ExemplarElement {
        category: None,
        colour: largest.map_or(Colour([0; 3]), |s| s.colour),
        difference: None,
        area: draft.mask.area().max(1),
        centroid,
        compactness: Some(silhouette.as_ref().unwrap_or(&draft.shapes[0].outline).compactness()),
        clipped: draft.endless || !wrap && is_cut(&draft.shapes, [x, y], size),
        silhouette,
        shapes: draft.shapes.clone(),
    }
}

/// The union of the outlines of all shapes; `None` for a single shape.
fn silhouette(shapes: &[Shape]) -> Option<Outline> {
    if shapes.len() < 2 {
        return None;
    }
    let ring = |shape: &Shape| {
        let path = shape.outline.path();
        if path.area() < 0.0 { path.reverse_subpaths() } else { path.clone() }
    };
    Outline::new(&shapes.iter().flat_map(ring).collect())
}

/// The background, and the layers of the drawing that are not empty.
fn layers(page: &DrawingPage, drafts: &[Draft], colour: Colour) -> Vec<ExemplarLayer> {
    let field = Field { spacing: 25.0, fallback: colour, points: Vec::new() };
    let background = ExemplarLayer { field: Some(field), ..ExemplarLayer::new(Role::Background) };
    let mut layers = vec![background];
    let mut first = 0;
    for run in drafts.chunk_by(|a, b| a.layer == b.layer) {
        let instances =
            (first..first + run.len()).map(|k| ExemplarInstance::of(ElementId::after(k))).collect();
        let name = page.layers[run[0].layer].clone();
        layers.push(ExemplarLayer { name, instances, ..ExemplarLayer::new(Role::Primary) });
        first += run.len();
    }
    if layers.len() == 1 {
        layers.push(ExemplarLayer::new(Role::Primary));
    }
    layers
}
