//! Elements that stand already, and the region beside them that is filled.
//!
//! The result is made on a window around the region. Elements that stand are the first of its board, and their samples
//! and clusters the first of its samples and clusters: they are compared and vote as others do, but keep their places.
//! Beside them, outside of the region, nothing is made. Elsewhere around the region elements are made and left out in the
//! end, so that its border leaves no trace in them.

use crate::figures::{ClusterExemplar, Figure, FigurePlace};
use crate::raster::{FigurePixels, pixels};
use crate::relations::PlaceRelations;
use std::collections::BTreeSet;
use vtex_base::error::Result;
use vtex_base::geometry::plane::{PointIndex, length};
use vtex_base::geometry::{Affine, Outline, Rect, RegionWindow};
use vtex_base::parallel;

/// Distance from standing elements within which, outside of the region, nothing is made, in spacings.
const BESIDE: f64 = 1.0;
/// Distance up to which an element would be the same as one that stands, in spacings.
const SAME: f64 = 0.3;
/// Side of a square in which points of elements count as one, in spacings.
const ONE_SPOT: f64 = 0.02;
/// Difference up to which a figure is the same as one of the exemplar.
const ALIKE: f64 = 0.06;
/// Difference of colours in Oklab that counts as much as that of figures that share nothing.
const OTHER_COLOUR: f64 = 0.25;
/// Grid on which the area to be filled is measured, in spacings.
const GRID: f64 = 0.1;
/// Figures recognised between two questions whether to go on.
const AT_ONCE: usize = 64;

/// Elements that stand already on the canvas, and the region to be filled beside them.
#[derive(Clone, Debug)]
pub struct ClusterContext {
    /// Figures that the exemplar does not have. Their categories do not count.
    pub figures: Vec<Figure>,
    /// The elements that stand, on the canvas. Their figures are numbered: those of the exemplar, then those above.
    pub places: Vec<FigurePlace>,
    /// The region, on the canvas.
    pub region: Outline,
    /// A part of the exemplar of which a copy is laid in the region first, the middle of its bounds on that of the
    /// region's. `None`: the region is filled by chance.
    pub source: Option<Outline>,
}

impl ClusterContext {
    /// The window that reaches `around` beyond the region on a canvas of a size, `unit` lengths of the optimiser to one of
    /// the context.
    pub(crate) fn window(&self, (canvas, unit): ([f64; 2], f64), around: f64) -> RegionWindow {
        let region = self.region.moved(Affine::scale(unit));
        RegionWindow::new(&region, canvas.map(|side| side * unit), around)
    }

    /// The part of the exemplar that is copied, in lengths of the optimiser.
    pub(crate) fn source_at(&self, unit: f64) -> Option<Outline> {
        self.source.as_ref().map(|source| source.moved(Affine::scale(unit)))
    }
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

/// The elements of a context on a window, `unit` lengths of the optimiser to one of it. Figures are added to those of the
/// exemplar, which has the optimiser's lengths, except for those that look the same as one. Of a figure that reaches
/// beyond the window its part on the window is an element.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn standing(
    context: &ClusterContext,
    (unit, window): (f64, &RegionWindow),
    exemplar: &mut ClusterExemplar,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<StandingElement>> {
    let (own, size) = (exemplar.figures.len(), window.plane.size);
    // Figures that the exemplar does not have: the context's, each once, and what the window cuts of them.
    let mut figures: Vec<Figure> = Vec::new();
    let mut known: Vec<Option<usize>> = vec![None; context.figures.len()];
    let mut placed: Vec<(usize, [f64; 2])> = Vec::with_capacity(context.places.len());
    for place in &context.places {
        let at = [0, 1].map(|k| place.at[k] * unit - window.low[k]);
        let Some(further) = (place.figure as usize).checked_sub(own) else {
            placed.push((place.figure as usize, at));
            continue;
        };
        let figure = &context.figures[further];
        let here = Rect::new(-at[0], -at[1], size[0] - at[0], size[1] - at[1]);
        if here.contains_rect(figure.bounds().scale_from_origin(unit)) {
            let number = *known[further].get_or_insert(own + figures.len());
            if number == own + figures.len() {
                figures.push(figure.scaled(unit));
            }
            placed.push((number, at));
        } else if let Some((part, by)) = figure.scaled(unit).within(here) {
            placed.push((own + figures.len(), [at[0] + by[0], at[1] + by[1]]));
            figures.push(part);
        }
    }
    placed.retain(|(_, at)| window.holds(*at));
    // The number of each figure, and of the exemplar's that is the most like it.
    let mut numbers: Vec<[u32; 2]> = (0..own as u32).map(|figure| [figure; 2]).collect();
    if !figures.is_empty() {
        let looks = parallel::map(&exemplar.figures, FigureLook::of);
        for some in figures.chunks(AT_ONCE) {
            go_on()?;
            let like = parallel::map(some, |figure| FigureLook::of(figure).most_like(&looks));
            for (figure, (like, unlike)) in some.iter().zip(like) {
                if unlike <= ALIKE {
                    numbers.push([like; 2]);
                    continue;
                }
                numbers.push([exemplar.figures.len() as u32, like]);
                let category = exemplar.figures[like as usize].category;
                exemplar.figures.push(Figure { category, ..figure.clone() });
            }
        }
    }
    let of = |(figure, at): (usize, [f64; 2])| {
        let [figure, like] = numbers[figure];
        StandingElement { figure, like, at }
    };
    Ok(placed.into_iter().map(of).collect())
}

/// What a figure is recognised by.
struct FigureLook {
    pixels: FigurePixels,
    colour: [f64; 3],
}

impl FigureLook {
    fn of(figure: &Figure) -> Self {
        let [pixels, _] = pixels(figure, 0.0);
        Self { pixels, colour: figure.colour }
    }

    /// The number of the look that is the most like this one, the first of equals, and how unlike it is: 0 for an equal one.
    fn most_like(&self, others: &[Self]) -> (u32, f64) {
        let mut best = (0, f64::INFINITY);
        for (other, k) in others.iter().zip(0..) {
            let [a, b] = [self.colour, other.colour];
            let colour = length([a[0] - b[0], length([a[1] - b[1], a[2] - b[2]])]) / OTHER_COLOUR;
            let (own, there) = (&self.pixels, &other.pixels);
            let both = f64::from(own.area + there.area).max(1.0);
            let unlike = |shared: u32| 1.0 - 2.0 * f64::from(shared) / both + colour;
            // They cannot share more than the smaller one has.
            if unlike(own.area.min(there.area)) < best.1 {
                let found = unlike(own.overlap(there, [0; 2]));
                best = if found < best.1 { (k, found) } else { best };
            }
        }
        best
    }
}

/// A context on the window that is synthesised. Lengths are those of the optimiser.
#[derive(Debug)]
pub(crate) struct StandingElements {
    pub(crate) window: RegionWindow,
    /// The elements on the window.
    pub(crate) elements: Vec<StandingElement>,
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
    /// Elements on a window, and the part of the exemplar of which a copy is laid in the region.
    pub(crate) fn new(
        window: RegionWindow,
        elements: Vec<StandingElement>,
        relations: &PlaceRelations<'_>,
        source: Option<&Outline>,
    ) -> Self {
        let middles: Vec<[f64; 2]> = elements.iter().map(|e| e.at).collect();
        let spacing = relations.spacing;
        let mut spots: Vec<[f64; 2]> = Vec::new();
        // Of elements over one another, points at the same places once.
        let mut known = BTreeSet::new();
        for e in &elements {
            for s in relations.spots_of(e.figure) {
                let at = [e.at[0] + s[0], e.at[1] + s[1]];
                if known.insert(at.map(|v| libm::floor(v / (ONE_SPOT * spacing)) as i64)) {
                    spots.push(at);
                }
            }
        }
        let mut made = Self {
            elements,
            middles: PointIndex::new(window.plane, spacing, &middles),
            spots: PointIndex::new(window.plane, spacing, &spots),
            spacing,
            free_area: 0.0,
            inside_area: 0.0,
            copied: source.map(|source| window.way_to(source)),
            window,
        };
        let step = GRID * spacing;
        made.free_area = made.window.area_of(step, |at| made.is_free(at));
        made.inside_area = made.window.area_of(step, |at| made.is_inside(at));
        made
    }

    /// Whether a place of the window lies in the region.
    pub(crate) fn is_inside(&self, at: [f64; 2]) -> bool {
        self.window.is_inside(at)
    }

    /// Whether elements are made at a place: in the region, and around it where none stands near.
    pub(crate) fn is_free(&self, at: [f64; 2]) -> bool {
        self.window.holds(at) && (self.is_inside(at) || !self.spots.any(at, BESIDE * self.spacing))
    }

    /// Whether an element stands so near to a place that another one there would be the same.
    pub(crate) fn is_taken(&self, at: [f64; 2]) -> bool {
        self.middles.any(at, SAME * self.spacing)
    }
}
