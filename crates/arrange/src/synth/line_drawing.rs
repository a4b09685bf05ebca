//! Drawings as strokes, each with its appearance.
//!
//! Stroked paths are taken as they are. Filled outlines that are long and thin, and strokes that the border of a page
//! has cut, are painted into cells, whose centre lines are the strokes.

use super::compose::{Placement, What};
use super::page_raster::PageRaster;
use vtex_base::error::Result;
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, Curve, PathEl, Point, rounded};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{CentreLine, Ink, centre_lines};
use vtex_curves::{CurveElement, CurveExemplar, CurveResult, CurveStroke, PlacedCurveElement, TracedCurve};
use vtex_scene::element::{Cap, CategoryId, ElementId, Join, Line, Shape};
use vtex_scene::library::{ExemplarElement, ExemplarInstance, Library};
use vtex_scene::scene::{Element, LibraryId, SynthParams};

/// Least ratio of length to width of a filled outline that is a line.
const THIN: f64 = 5.0;
/// Cells across the thinnest painted line, and most cells of a page: for each appearance, and for all together.
const CELLS: f64 = 20.0;
const MOST_CELLS: f64 = 6e6;
const MOST_CELLS_OF_ALL: f64 = 12e6;
/// How far beyond a page that ends painted lines lead, in cells.
const RIM: usize = 80;
/// Number from which on styles are kinds of elements.
const FIRST_OF_ELEMENTS: u32 = 1 << 24;
/// Distance up to which ends meet, in widths of the thinnest line.
const WELD: f64 = 0.25;
/// Largest deviation of a stroked path from its points, in widths.
const FLAT: f64 = 0.02;
/// Difference in colour, in Oklab, that counts as much as a width e times as large.
const COLOUR: f64 = 0.5;

/// Whether a shape is a stroke or looks like one.
pub(super) fn is_line(shape: &Shape) -> bool {
    shape.line.is_some()
        || !shape.is_soft() && proportion(shape).is_some_and(|(width, ratio)| width > 0.0 && ratio > THIN)
}

/// Width of a thin outline, and the ratio of its length to it.
fn proportion(shape: &Shape) -> Option<(f64, f64)> {
    let (area, compactness) = (shape.outline.area(), shape.outline.compactness());
    let perimeter = libm::sqrt(4.0 * std::f64::consts::PI * area / compactness.max(1e-9));
    // Of a rectangle: area = width · length, half the perimeter = width + length.
    let half = 0.5 * perimeter;
    let root = half * half - 4.0 * area;
    (area > 0.0 && root >= 0.0).then(|| {
        let width = 0.5 * (half - libm::sqrt(root));
        (width, (half - width) / width.max(1e-9))
    })
}

/// The appearance of a stroke.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LineStyle {
    /// A line without path.
    line: Line,
    colour: Colour,
    opacity: f64,
    pub(super) layer: usize,
    /// The first element that has it, and its category.
    element: usize,
    category: Option<CategoryId>,
    /// Whether its width is found by thinning.
    is_painted: bool,
}

/// A drawing as strokes.
pub(super) struct LineDrawing {
    pub(super) exemplar: CurveExemplar,
    pub(super) styles: Vec<LineStyle>,
    /// The elements between the lines, as the exemplar numbers them.
    pub(super) elements: Vec<ElementBetween>,
    /// Width of the thinnest line.
    pub(super) thinnest: f64,
}

impl LineDrawing {
    /// The lines of a library on a page. `by_look`: lines of one appearance have one style, whatever their layers and
    /// categories.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn new(
        library: &Library,
        page: PeriodicPlane,
        by_look: bool,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let (mut styles, mut strokes): (Vec<LineStyle>, Vec<CurveStroke>) = (Vec::new(), Vec::new());
        // The outlines of each style that are painted.
        let mut painted: Vec<(u32, Vec<Shape>)> = Vec::new();
        let mut thinnest = f64::INFINITY;
        let mut elements = Vec::new();
        for (layer, own) in library.layers.iter().enumerate() {
            for instance in &own.instances {
                go_on()?;
                let number = instance.element.index();
                let Some(element) = library.primaries().get(number) else { continue };
                elements.extend(ElementBetween::of(element, instance, layer));
                for shape in element.shapes.iter().filter(|s| is_line(s)) {
                    let shape = shape.moved(Affine::new(instance.transform));
                    let line = match &shape.line {
                        Some(line) => Line { path: Curve::default(), ..(**line).clone() },
                        None => Line {
                            cap: Cap::Round,
                            join: Join::Round,
                            ..Line::new(Curve::default(), proportion(&shape).map_or(1.0, |p| p.0))
                        },
                    };
                    thinnest = thinnest.min(line.width);
                    let fresh = LineStyle {
                        line,
                        colour: shape.colour,
                        opacity: shape.opacity,
                        layer,
                        element: number,
                        category: element.category,
                        is_painted: shape.line.is_none(),
                    };
                    let known = styles.iter().position(|s| s.is_like(&fresh, by_look));
                    let style = known.unwrap_or(styles.len());
                    match &shape.line {
                        Some(line) => strokes.extend(of_path(line, style as u32)),
                        None => match painted.iter_mut().find(|p| p.0 == style as u32) {
                            Some(shapes) => shapes.1.push(shape.clone()),
                            None => painted.push((style as u32, vec![shape.clone()])),
                        },
                    }
                    if known.is_none() {
                        styles.push(fresh);
                    }
                }
            }
        }
        let most_cells = MOST_CELLS.min(MOST_CELLS_OF_ALL / painted.len().max(1) as f64);
        for (style, shapes) in painted {
            let (lines, width) = thinned(&shapes, page, (thinnest, most_cells), go_on)?;
            styles[style as usize].line.width = width.max(1e-3);
            let stroke = |(points, closed)| CurveStroke { points, closed, style };
            strokes.extend(lines.into_iter().map(stroke));
        }
        let thinnest = styles.iter().map(|s| s.line.width).fold(f64::INFINITY, f64::min);
        let between = elements.iter().map(|e| CurveElement { at: e.at, style: FIRST_OF_ELEMENTS + e.kind });
        let exemplar = CurveExemplar { page, strokes, elements: between.collect(), weld: WELD * thinnest };
        Ok(Self { exemplar, styles, elements, thinnest })
    }

    /// A curve as an element, its place and its layer.
    pub(super) fn element(&self, curve: &TracedCurve) -> Option<(Element, Point, usize)> {
        let style = &self.styles[curve.style as usize];
        let first = curve.path.elements().first().and_then(PathEl::end_point)?;
        let at = Point::new(libm::round(first.x), libm::round(first.y));
        let path = Curve::new(Affine::translate(-at.to_vec2()) * curve.path.clone())?;
        let shape = Shape::stroked(Line { path, ..style.line.clone() }, style.colour)?;
        if shape.outline.is_empty() {
            return None;
        }
        let element = Element {
            library: LibraryId(0),
            source: Some(ElementId::after(style.element)),
            category: style.category,
            fused: true,
            silhouette: None,
            shapes: vec![Shape { opacity: style.opacity, ..shape }],
        };
        Some((element, at, style.layer))
    }

    /// Share of the canvas that the lines and elements of each category cover, lines by their lengths times their
    /// widths.
    pub(super) fn covered(&self, library: &Library, found: &CurveResult, params: &SynthParams) -> Vec<f64> {
        let mut areas = vec![0.0; library.categories.len()];
        let of_curve = |curve: &TracedCurve| {
            let style = &self.styles[curve.style as usize];
            (style.category, curve.shown_length * style.line.width)
        };
        let size = [params.width, params.height].map(f64::from);
        let is_shown = |e: &&PlacedCurveElement| (0..2).all(|k| (0.0..=size[k]).contains(&e.at[k]));
        let of_element = |placed: &PlacedCurveElement| {
            let element = &self.elements[placed.element as usize];
            (element.category, element.area)
        };
        let curves = found.curves.iter().map(of_curve);
        for (category, area) in curves.chain(found.elements.iter().filter(is_shown).map(of_element)) {
            if let Some(category) = category {
                areas[category.index()] += area;
            }
        }
        let canvas = size[0] * size[1];
        areas.into_iter().map(|made| (made / canvas).min(1.0)).collect()
    }

    /// The number of the style that looks most like another.
    pub(super) fn style_like(&self, other: &LineStyle) -> usize {
        let far: Vec<f64> = self.styles.iter().map(|own| own.distance(other)).collect();
        (0..far.len()).min_by(|a, b| far[*a].total_cmp(&far[*b])).unwrap_or(0)
    }
}

/// An element between the lines.
pub(super) struct ElementBetween {
    content: BetweenContent,
    /// The map from the scene's element, about the origin, to its place in the drawing.
    transform: Affine,
    /// The middle of its bounds there.
    at: [f64; 2],
    /// Those of one kind may stand for one another.
    kind: u32,
    category: Option<CategoryId>,
    area: f64,
    layer: usize,
    /// The element of the library that it is or is part of.
    number: usize,
}

/// What an element between lines consists of.
enum BetweenContent {
    /// An element of the library.
    Whole(ElementId),
    /// A shape of one that has lines, too.
    Part(Box<Element>),
}

impl ElementBetween {
    /// The elements of an instance: all of it if it has no lines, else each shape that is no line.
    fn of(element: &ExemplarElement, instance: &ExemplarInstance, layer: usize) -> Vec<Self> {
        let (number, category) = (instance.element.index(), element.category);
        let is_whole = !element.shapes.iter().any(is_line);
        if is_whole && element.clipped {
            return Vec::new();
        }
        // Elements of scenes have their own place at the origin.
        let [x, y] = element.origin().map(f64::from);
        let drawn = Affine::new(instance.transform);
        let transform = drawn * Affine::translate((x, y));
        let made = |shapes: &[&Shape], content: BetweenContent| {
            let bounds = shapes.iter().map(|s| s.outline.bounds_after(drawn)).reduce(|a, b| a.union(b))?;
            let kind = 2 * category.map_or(0, |c| c.index() as u32) + u32::from(!is_whole);
            let area = shapes[0].outline.area() * drawn.determinant().abs();
            let at = bounds.center();
            Some(Self { content, transform, at: [at.x, at.y], kind, category, area, layer, number })
        };
        let others: Vec<&Shape> = element.shapes.iter().filter(|s| !is_line(s)).collect();
        if is_whole {
            return made(&others, BetweenContent::Whole(instance.element)).into_iter().collect();
        }
        let part = |shape: &&Shape| {
            let element = Element {
                library: LibraryId(0),
                source: Some(instance.element),
                category,
                fused: true,
                silhouette: None,
                shapes: vec![shape.moved(Affine::translate((-x, -y)))],
            };
            made(&[shape], BetweenContent::Part(Box::new(element)))
        };
        others.iter().filter_map(part).collect()
    }

    /// It with its middle at a place of a layer.
    pub(super) fn placed(&self, at: [f64; 2]) -> Placement<'static> {
        let what = match &self.content {
            BetweenContent::Whole(element) => What::Known(LibraryId(0), *element, None),
            BetweenContent::Part(element) => What::Made(element.clone()),
        };
        let by = Affine::translate((at[0] - self.at[0], at[1] - self.at[1]));
        Placement { what, transform: rounded(by * self.transform), layer: self.layer, motif: None, height: 0 }
    }

    /// Whether it is drawn before all lines of some styles.
    pub(super) fn is_below(&self, styles: &[LineStyle]) -> bool {
        styles.iter().all(|style| self.number < style.element)
    }
}

impl LineStyle {
    /// How different two styles look, by colour and width.
    fn distance(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|s| s.colour.to_oklab());
        let apart = (0..3).map(|k| f64::from(a[k] - b[k])).fold(0.0, |sum, d| sum + d * d);
        libm::sqrt(apart) / COLOUR + libm::log(self.line.width / other.line.width).abs()
    }

    /// Whether lines of the two styles look the same and, unless only that counts, are of one layer and category. The
    /// width of painted ones is found later.
    fn is_like(&self, other: &Self, by_look: bool) -> bool {
        let line =
            |s: &Self| if s.is_painted { Line { width: 1.0, ..s.line.clone() } } else { s.line.clone() };
        let place = |s: &Self| (s.layer, s.category);
        self.is_painted == other.is_painted
            && self.colour == other.colour
            && (by_look || place(self) == place(other))
            && self.opacity == other.opacity
            && line(self) == line(other)
    }
}

/// The pieces of a stroked path.
fn of_path(line: &Line, style: u32) -> Vec<CurveStroke> {
    let mut strokes: Vec<CurveStroke> = Vec::new();
    kurbo::flatten(line.path.path().iter(), FLAT * line.width, |element| match element {
        PathEl::MoveTo(p) => strokes.push(CurveStroke { points: vec![[p.x, p.y]], closed: false, style }),
        PathEl::ClosePath => {
            if let Some(stroke) = strokes.last_mut() {
                stroke.closed = true;
            }
        }
        element => {
            if let (Some(stroke), Some(p)) = (strokes.last_mut(), element.end_point()) {
                stroke.points.push([p.x, p.y]);
            }
        }
    });
    strokes.retain(|s| s.points.len() > 1);
    strokes
}

/// The centre lines of outlines, and their mean width.
fn thinned(
    shapes: &[Shape],
    page: PeriodicPlane,
    (thinnest, most_cells): (f64, f64),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(Vec<CentreLine>, f64)> {
    let raster = PageRaster::new(page, CELLS / thinnest.max(1e-6), most_cells);
    let [columns, rows] = raster.size;
    let mut ink = Ink { size: raster.size, wraps: page.wraps, cells: vec![false; columns * rows] };
    for shape in shapes {
        go_on()?;
        raster.each(&shape.outline, |cell| ink.cells[cell] = true);
    }
    let (lines, width) = centre_lines(&ink, RIM, go_on)?;
    let back = |line: Vec<[f64; 2]>| line.into_iter().map(|p| raster.unscaled(p)).collect();
    let lines = lines.into_iter().map(|(points, closed)| (back(points), closed));
    Ok((lines.collect(), width * raster.unit()))
}
