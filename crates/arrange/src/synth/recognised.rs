//! Elements of a drawing beside which a texture is made that are elements of the library, too: the same shapes in the same
//! colours, at the same size and angle.

use super::clustered::ClusteredDrawing;
use crate::arrange::context::DrawnContext;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex};
use vtex_base::geometry::{Affine, Interior, Outline, Point, Rect};
use vtex_base::raster::colour::Colour;
use vtex_cluster::{ClusterContext, Figure, FigurePlace};
use vtex_scene::element::Shape;
use vtex_scene::library::Library;

/// Largest difference of places and sizes, as a share of the library's page, and in pixels; of areas, as a share; and of
/// colours in Oklab.
const OFF: f64 = 0.004;
const OFF_PIXELS: f64 = 1.0;
const OFF_AREA: f64 = 0.06;
const OFF_COLOUR: f64 = 0.02;

/// A drawing that stands, as clusters know it.
pub(super) struct StandingDrawing {
    pub(super) context: ClusterContext,
    /// How many of its elements are the library's.
    pub(super) recognised: usize,
    /// Whether each shape stays, in painting order: those of elements whose middle lies in a region that is made anew do
    /// not. What lies beyond the canvas counts as the nearest place on it.
    pub(super) is_kept: Vec<bool>,
}

impl StandingDrawing {
    /// Recognises the elements of a library in the drawing of a context.
    pub(super) fn new(library: &ClusteredDrawing, context: &DrawnContext, canvas: [f64; 2]) -> Self {
        let shapes = context.shapes();
        let region = Interior::new(&context.region);
        let (mut figures, mut places, mut recognised) = (Vec::new(), Vec::new(), 0);
        let mut is_kept = vec![true; shapes.len()];
        for element in self::recognised(library, &context.drawing, &shapes) {
            let [x, y] = element.at;
            if context.anew && region.contains_on(canvas, Point::new(x, y)) {
                element.shapes.iter().for_each(|s| is_kept[*s] = false);
                continue;
            }
            recognised += usize::from(element.figure.is_some());
            let figure = element.figure.unwrap_or_else(|| {
                let moved = Affine::translate((-x, -y));
                let outlines: Vec<Outline> =
                    element.shapes.iter().map(|s| shapes[*s].outline.moved(moved)).collect();
                let colour = oklab(shapes[element.shapes[0]].colour);
                figures.push(Figure { outlines, category: 0, colour });
                (library.exemplar.figures.len() + figures.len()) as u32 - 1
            });
            places.push(FigurePlace { figure, at: element.at, placeable: true });
        }
        let (region, source) = (context.region.clone(), context.source.clone());
        let context = ClusterContext { figures, places, region, source };
        Self { context, recognised, is_kept }
    }
}

/// What a shape is recognised by.
pub(super) struct ShapeLook {
    bounds: Rect,
    area: f64,
    colour: [f64; 3],
}

impl ShapeLook {
    pub(super) fn of(shape: &Shape, map: Affine) -> Self {
        let outline = shape.outline.moved(map);
        Self { bounds: outline.bounds(), area: outline.area(), colour: oklab(shape.colour) }
    }

    fn is_like(&self, other: &Self, off: f64) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= off;
        let areas = (self.area - other.area).abs() <= OFF_AREA * self.area.max(other.area) + off;
        let colours = (0..3).all(|k| (self.colour[k] - other.colour[k]).abs() <= OFF_COLOUR);
        let [a, b] = [self.bounds, other.bounds];
        areas && colours && near(a.width(), b.width()) && near(a.height(), b.height())
    }
}

/// An element of a drawing.
struct RecognisedElement {
    /// Indices of its shapes in the drawing's painting order.
    shapes: Vec<usize>,
    /// The figure of the library that it is; `None` for a shape that is none.
    figure: Option<u32>,
    /// Its reference point.
    at: [f64; 2],
}

/// The page of a drawing that stands.
fn page(drawing: &Library) -> PeriodicPlane {
    PeriodicPlane { size: [drawing.source.width, drawing.source.height].map(f64::from), wraps: [false; 2] }
}

/// The elements of a drawing: those of the library, of as many shapes as possible, then the other shapes one by one.
fn recognised(library: &ClusteredDrawing, drawing: &Library, shapes: &[Shape]) -> Vec<RecognisedElement> {
    let [w, h] = library.exemplar.page.size;
    let off = (OFF * 0.5 * (w + h)).max(OFF_PIXELS);
    let looks: Vec<ShapeLook> = shapes.iter().map(|shape| ShapeLook::of(shape, Affine::IDENTITY)).collect();
    let middles: Vec<[f64; 2]> = looks.iter().map(|look| place(look.bounds.center())).collect();
    let index = PointIndex::new(page(drawing), 8.0 * off, &middles);
    let mut is_taken = vec![false; looks.len()];
    let mut found = Vec::new();
    let mut order: Vec<usize> = (0..library.looks.len()).collect();
    order.sort_by_key(|f| std::cmp::Reverse(library.looks[*f].len()));
    for figure in order {
        let own = &library.looks[figure];
        let largest = (0..own.len()).max_by(|a, b| own[*a].area.total_cmp(&own[*b].area));
        let Some(largest) = largest else { continue };
        for first in 0..looks.len() {
            if is_taken[first] || !looks[first].is_like(&own[largest], off) {
                continue;
            }
            let way = looks[first].bounds.center() - own[largest].bounds.center();
            let mut parts = Vec::with_capacity(own.len());
            for look in own {
                let mut here: Vec<usize> = Vec::new();
                index.within(place(look.bounds.center() + way), 2.0 * off, |s, _| here.push(s));
                here.sort_unstable();
                let fits = |s: &usize| !is_taken[*s] && !parts.contains(s) && looks[*s].is_like(look, off);
                let Some(part) = here.into_iter().find(fits) else { break };
                parts.push(part);
            }
            if parts.len() == own.len() {
                parts.iter().for_each(|s| is_taken[*s] = true);
                let at = [way.x, way.y];
                found.push(RecognisedElement { shapes: parts, figure: Some(figure as u32), at });
            }
        }
    }
    let others = (0..looks.len()).filter(|s| !is_taken[*s]);
    found.extend(others.map(|s| RecognisedElement { shapes: vec![s], figure: None, at: middles[s] }));
    found
}

fn place(p: Point) -> [f64; 2] {
    [p.x, p.y]
}

pub(super) fn oklab(colour: Colour) -> [f64; 3] {
    colour.to_oklab().map(f64::from)
}
