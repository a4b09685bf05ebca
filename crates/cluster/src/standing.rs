//! Elements that stand already, and the region beside them that is filled.
//!
//! The result is made on a window around the region. Elements that stand are the first of its board, and their samples
//! and clusters the first of its samples and clusters: they are compared and vote as others do, but keep their places.
//! Beside them, outside of the region, nothing is made. Elsewhere around the region elements are made and left out in the
//! end, so that its border leaves no trace in them.

use crate::figures::{ClusterExemplar, Figure, FigurePlace};
use crate::raster::pixels;
use crate::relations::PlaceRelations;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};
use vtex_base::geometry::{Affine, Interior, Outline, Point};
use vtex_base::parallel;

/// Distance from standing elements within which, outside of the region, nothing is made, in spacings.
const BESIDE: f64 = 1.0;
/// Distance up to which an element would be the same as one that stands, in spacings.
const SAME: f64 = 0.3;
/// Difference up to which a figure is the same as one of the exemplar.
const ALIKE: f64 = 0.06;
/// Difference of colours in Oklab that counts as much as that of figures that share nothing.
const OTHER_COLOUR: f64 = 0.25;
/// Grid on which the area to be filled is measured, in spacings.
const GRID: f64 = 0.1;
/// Most cells of that grid along an axis.
const MOST_CELLS: f64 = 1000.0;

/// Elements that stand already on the canvas, and the region to be filled beside them.
#[derive(Clone, Debug)]
pub struct ClusterContext {
    /// The elements that stand, on the canvas. Categories and the page do not count.
    pub drawing: ClusterExemplar,
    /// The region, on the canvas.
    pub region: Outline,
    /// A part of the exemplar of which a copy is laid in the region first, the middle of its bounds on that of the
    /// region's. `None`: the region is filled by chance.
    pub source: Option<Outline>,
}

/// An element that stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StandingElement {
    /// Its figure, among those of the exemplar and further ones.
    pub(crate) figure: u32,
    /// The exemplar's figure that is the most like it.
    pub(crate) like: u32,
    /// Its reference point on the window.
    pub(crate) at: [f64; 2],
}

/// The elements of a drawing, with figures of the exemplar, to which those are added that it does not have. Both have
/// the lengths of the optimiser.
pub(crate) fn recognised(drawing: &ClusterExemplar, exemplar: &mut ClusterExemplar) -> Vec<StandingElement> {
    let like = parallel::map(&drawing.figures, |figure| most_like(figure, &exemplar.figures));
    let mut figures = Vec::with_capacity(like.len());
    for (figure, &(like, unlike)) in drawing.figures.iter().zip(&like) {
        if unlike <= ALIKE {
            figures.push(like);
            continue;
        }
        figures.push(exemplar.figures.len() as u32);
        let category = exemplar.figures[like as usize].category;
        exemplar.figures.push(Figure { category, ..figure.clone() });
    }
    let of = |place: &FigurePlace| {
        let drawn = place.figure as usize;
        StandingElement { figure: figures[drawn], like: like[drawn].0, at: place.at }
    };
    drawing.places.iter().map(of).collect()
}

/// A context on the window that is synthesised. Lengths are those of the optimiser.
#[derive(Debug)]
pub(crate) struct StandingElements {
    pub(crate) plane: PeriodicPlane,
    /// The corner of the window on the canvas.
    pub(crate) low: [f64; 2],
    /// The elements on the window.
    pub(crate) elements: Vec<StandingElement>,
    region: Interior,
    canvas: [f64; 2],
    /// Reference points of the elements, and points of their figures.
    middles: PointIndex,
    spots: PointIndex,
    spacing: f64,
    /// Areas of the window in which elements are made, and of the region.
    pub(crate) free_area: f64,
    pub(crate) inside_area: f64,
    /// The way from the window to the part of the exemplar that is copied.
    pub(crate) copied: Option<[f64; 2]>,
}

impl StandingElements {
    /// The elements of a context on a canvas of a size, `unit` lengths of the optimiser to one of the exemplar. The window
    /// reaches `around` beyond the region.
    pub(crate) fn new(
        context: &ClusterContext,
        drawn: Vec<StandingElement>,
        relations: &PlaceRelations<'_>,
        (canvas, unit, around): ([f64; 2], f64, f64),
    ) -> Self {
        let canvas = canvas.map(|side| side * unit);
        let scaled = |outline: &Outline| outline.moved(Affine::scale(unit));
        let region = scaled(&context.region);
        let bounds = region.bounds();
        let ends = [[bounds.x0, bounds.x1], [bounds.y0, bounds.y1]];
        let corner = |end: usize, by: f64| [0, 1].map(|k| ends[k][end].clamp(0.0, canvas[k]) + by);
        let (low, high) = (corner(0, -around), corner(1, around));
        let plane = PeriodicPlane { size: [high[0] - low[0], high[1] - low[1]], wraps: [false; 2] };
        let moved = |e: StandingElement| StandingElement { at: [e.at[0] - low[0], e.at[1] - low[1]], ..e };
        let elements: Vec<StandingElement> =
            drawn.into_iter().map(moved).filter(|e| is_on(plane, e.at)).collect();
        let middle = |of: &Outline| of.bounds().center().to_vec2();
        let copied = context.source.as_ref().map(|source| middle(&scaled(source)) - middle(&region));
        let middles: Vec<[f64; 2]> = elements.iter().map(|e| e.at).collect();
        let mut spots = Vec::new();
        for e in &elements {
            spots.extend(relations.spots_of(e.figure).iter().map(|s| [e.at[0] + s[0], e.at[1] + s[1]]));
        }
        let spacing = relations.spacing;
        let mut made = Self {
            plane,
            low,
            elements,
            region: Interior::new(&region),
            canvas,
            middles: PointIndex::new(plane, spacing, &middles),
            spots: PointIndex::new(plane, spacing, &spots),
            spacing,
            free_area: 0.0,
            inside_area: 0.0,
            copied: copied.map(|way| [way.x + low[0], way.y + low[1]]),
        };
        made.free_area = made.area_of(|at| made.is_free(at));
        made.inside_area = made.area_of(|at| made.is_inside(at));
        made
    }

    /// Area of the window whose places satisfy a condition.
    fn area_of(&self, condition: impl Fn([f64; 2]) -> bool + Sync) -> f64 {
        let step = GRID * self.spacing;
        let count = self.plane.size.map(|side| libm::ceil(side / step).clamp(1.0, MOST_CELLS));
        let rows: Vec<usize> = (0..count[1] as usize).collect();
        let in_row = parallel::map(&rows, |row| {
            let y = (*row as f64 + 0.5) * self.plane.size[1] / count[1];
            let at = |column: usize| [(column as f64 + 0.5) * self.plane.size[0] / count[0], y];
            (0..count[0] as usize).filter(|c| condition(at(*c))).count()
        });
        in_row.into_iter().sum::<usize>() as f64 / (count[0] * count[1]) * self.plane.area()
    }

    /// Whether a place of the window lies in the region. What lies beyond the canvas counts as the nearest place on it.
    pub(crate) fn is_inside(&self, at: [f64; 2]) -> bool {
        self.region.contains_on(self.canvas, Point::new(at[0] + self.low[0], at[1] + self.low[1]))
    }

    /// Whether elements are made at a place: in the region, and around it where none stands near.
    pub(crate) fn is_free(&self, at: [f64; 2]) -> bool {
        is_on(self.plane, at) && (self.is_inside(at) || !self.spots.any(at, BESIDE * self.spacing))
    }

    /// Whether an element stands so near to a place that another one there would be the same.
    pub(crate) fn is_taken(&self, at: [f64; 2]) -> bool {
        self.middles.any(at, SAME * self.spacing)
    }
}

/// Whether a place lies on a plane that does not repeat.
fn is_on(plane: PeriodicPlane, at: [f64; 2]) -> bool {
    (0..2).all(|k| (0.0..=plane.size[k]).contains(&at[k]))
}

/// The figure that is the most like another, and how unlike it is: 0 for an equal one.
fn most_like(figure: &Figure, of: &[Figure]) -> (u32, f64) {
    let [own, _] = pixels(figure, 0.0);
    let unlike = |other: &Figure| {
        let [there, _] = pixels(other, 0.0);
        let both = f64::from(own.area + there.area).max(1.0);
        let shape = 1.0 - 2.0 * f64::from(own.overlap(&there, [0; 2])) / both;
        let [a, b] = [figure.colour, other.colour];
        let colour = length([a[0] - b[0], length([a[1] - b[1], a[2] - b[2]])]);
        shape + colour / OTHER_COLOUR
    };
    let all = of.iter().zip(0..).map(|(other, k)| (k, unlike(other)));
    all.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY))
}
