//! Elements of a drawing beside which a texture is made that are elements of the library, too: the same shapes in the same
//! colours, at the same size and angle.

use super::clustered::ClusteredDrawing;
use crate::arrange::context::DrawnContext;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex};
use vtex_base::geometry::{Affine, Interior, Outline, Point, Rect};
use vtex_base::raster::colour::Colour;
use vtex_cluster::{ClusterContext, ClusterExemplar, Figure, FigurePlace};
use vtex_scene::element::Shape;
use vtex_scene::library::Library;

/// Largest difference of places and sizes, as a share of the library's page, and in pixels; of areas, as a share; and of
/// colours in Oklab.
const OFF: f64 = 0.004;
const OFF_PIXELS: f64 = 1.0;
const OFF_AREA: f64 = 0.06;
const OFF_COLOUR: f64 = 0.02;

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
pub(super) struct RecognisedElement {
    /// Indices of its shapes in the drawing's painting order.
    pub(super) shapes: Vec<usize>,
    /// The figure of the library that it is; `None` for a shape that is none.
    figure: Option<u32>,
    /// Its reference point.
    pub(super) at: [f64; 2],
}

/// The shapes of a drawing in its painting order.
fn shapes(drawing: &Library) -> Vec<Shape> {
    let instances = drawing.layers.iter().flat_map(|layer| &layer.instances);
    let of = |(element, map): (usize, Affine)| {
        drawing
            .elements
            .get(element)
            .into_iter()
            .flat_map(move |e| e.shapes.iter().map(move |s| s.moved(map)))
    };
    instances.map(|i| (i.element.index(), Affine::new(i.transform))).flat_map(of).collect()
}

/// The elements of a drawing: those of the library, of as many shapes as possible, then the other shapes one by one.
pub(super) fn recognised(library: &ClusteredDrawing, drawing: &Library) -> Vec<RecognisedElement> {
    let [w, h] = library.exemplar.page.size;
    let off = (OFF * 0.5 * (w + h)).max(OFF_PIXELS);
    let looks: Vec<ShapeLook> =
        shapes(drawing).iter().map(|shape| ShapeLook::of(shape, Affine::IDENTITY)).collect();
    let middles: Vec<[f64; 2]> = looks.iter().map(|look| place(look.bounds.center())).collect();
    let page = PeriodicPlane {
        size: [drawing.source.width, drawing.source.height].map(f64::from),
        wraps: [false; 2],
    };
    let index = PointIndex::new(page, 8.0 * off, &middles);
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

/// A context for clusters, and how many of its elements are the library's.
pub(super) fn cluster_context(library: &ClusteredDrawing, context: &DrawnContext) -> (ClusterContext, usize) {
    let shapes = shapes(&context.drawing);
    let mut figures = library.exemplar.figures.clone();
    let mut places = Vec::new();
    let found = recognised(library, &context.drawing);
    for element in &found {
        let figure = element.figure.unwrap_or_else(|| {
            let moved = Affine::translate((-element.at[0], -element.at[1]));
            let outlines: Vec<Outline> =
                element.shapes.iter().map(|s| shapes[*s].outline.moved(moved)).collect();
            let colour = oklab(shapes[element.shapes[0]].colour);
            figures.push(Figure { outlines, category: 0, colour });
            figures.len() as u32 - 1
        });
        places.push(FigurePlace { figure, at: element.at, placeable: true });
    }
    let size = [context.drawing.source.width, context.drawing.source.height].map(f64::from);
    let page = PeriodicPlane { size, wraps: [false; 2] };
    let drawing = ClusterExemplar { page, figures, places };
    let context = ClusterContext { drawing, region: context.region.clone(), source: context.source.clone() };
    (context, found.iter().filter(|e| e.figure.is_some()).count())
}

/// A context without the elements of its drawing whose middle lies in the region. What lies beyond a canvas of a width and
/// height counts as the nearest place on it.
pub(super) fn without_region(
    library: &ClusteredDrawing,
    context: &DrawnContext,
    canvas: [u32; 2],
) -> DrawnContext {
    let region = Interior::new(&context.region);
    let mut is_kept = vec![true; shapes(&context.drawing).len()];
    for element in recognised(library, &context.drawing) {
        let at = Point::new(element.at[0], element.at[1]);
        if region.contains_on(canvas.map(f64::from), at) {
            element.shapes.iter().for_each(|s| is_kept[*s] = false);
        }
    }
    context.keeping(&is_kept)
}
