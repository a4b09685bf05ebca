//! Fused elements: the shapes of an instance that no whole element fits.
//!
//! An instance that comes from several primaries, or from a piece of one, is traced along its own pixels, on
//! half pixels. Its rim follows the outlines of its parts where these end there. One paint runs across the
//! seams of parts of like colour. Its details are those of its parts, each clipped to its part; details of
//! like colour are joined across a seam. Scenes mark these elements as `fused` and paint them beneath whole
//! ones.

use super::instances::{PixelInstance, PrimaryPixels};
use super::mapped::to_place;
use crate::arrange::model::PlacementModel;
use vtex_base::geometry::{Affine, FittedMap, Interior, Outline, PlanarMap, Point, Scale};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{LabelMap, Mask, Span};
use vtex_scene::element::Gradient;
use vtex_scene::library::{self, Library};
use vtex_scene::scene::{Element, ElementId, LibraryId, Shape, pixels};

/// Cells along a pixel's side of the map that is traced.
const FINE: i32 = 2;
/// Largest distance of an outline to the map's borders, in pixels.
const TOLERANCE: f64 = 0.4;
/// Fewest pixels of an instance whose details are kept.
const DETAILED: u32 = 60;
/// Fewest pixels of a detail that is kept.
const LEAST_DETAIL: u32 = 3;
/// Largest distance of the colours of details that run on across a seam, in Oklab.
const SAME_COLOUR: f32 = 0.045;
/// Largest distance of the colours of parts that have one paint, in Oklab.
const ONE_PAINT: f32 = 0.09;
/// Distance by which a detail reaches beneath those painted later, in pixels.
const BENEATH: f64 = 0.6;
/// A part that has at least this share of an instance gives its paint to all of it.
const DOMINANT: f64 = 0.8;

/// The fused element of an instance, relative to the origin of its main part, and its pixels; `None` if
/// tracing leaves no outline. `is_free` tells whether a pixel beside the instance belongs to no other
/// instance.
pub(super) fn fused(
    instance: &PixelInstance,
    libraries: &[Library],
    model: &PlacementModel,
    is_free: impl Fn([i32; 2]) -> bool,
) -> Option<(Element, Mask)> {
    let main = instance.main();
    let at = main.at;
    let mask = instance.mask.shifted(-at[0], -at[1]);
    let (x0, y0, x1, y1) = mask.bounds()?;
    // A frame of two pixels around the box: the rim may move out by one.
    let corner = [x0 - 2, y0 - 2];
    let size = [x1 - x0 + 4, y1 - y0 + 4];
    let mut labels = LabelMap::filled((size[0] * FINE) as u32, (size[1] * FINE) as u32, 0);
    let to_map =
        Affine::scale(f64::from(FINE)) * Affine::translate((-f64::from(corner[0]), -f64::from(corner[1])));
    labels.fill(&on_map(&mask, corner), 1);

    let parts: Vec<PlacedPart<'_>> =
        instance.parts.iter().map(|part| PlacedPart::new(part, at, libraries, model)).collect();
    for placed in &parts {
        placed.refine(&mut labels, &mask, corner, to_map, |[x, y]| is_free([x + at[0], y + at[1]]));
    }
    let mut details = Details::default();
    for (k, placed) in parts.iter().enumerate() {
        let own = on_map(&placed.mask, corner);
        // A part of another colour, such as the heart of a flower, keeps its own paint.
        if k > 0 && placed.primary.base().colour.distance(parts[0].primary.base().colour) > ONE_PAINT {
            let label = details.joined(placed, placed.primary.base());
            fill(&mut labels, &own, label);
        }
        if mask.area() >= DETAILED {
            let Some((x0, y0, x1, y1)) = own.bounds() else { continue };
            let to_map = to_map * placed.to_place;
            for detail in placed.primary.details().iter().filter(|detail| !detail.is_soft()) {
                let b = detail.outline.bounds_after(to_map);
                let beside = b.x1 < f64::from(x0) || b.x0 > f64::from(x1);
                if beside || b.y1 < f64::from(y0) || b.y0 > f64::from(y1) {
                    continue;
                }
                let Some(outline) = Outline::new(&(to_map * detail.outline.path())) else { continue };
                let inside = pixels::mask(&outline);
                let shown = inside.intersection(&own);
                if shown.is_empty() {
                    continue;
                }
                let label = details.joined(placed, detail);
                fill(&mut labels, &shown, label);
            }
        }
    }
    let details = details.without_specks(&mut labels);
    let count = details.len() + 1;
    let planar = PlanarMap::trace(labels.width, labels.height, &labels.labels);
    let scale = Scale { tolerance: TOLERANCE, cells: f64::from(FINE) };
    let fitted = FittedMap::with_edges(planar, scale, count, 1, |label| label.min(1), |_, _, _, _| 0.0);
    let back = Affine::translate((f64::from(corner[0]), f64::from(corner[1])));
    let moved = |outline: &Outline| Outline::new(&(back * outline.path())).unwrap_or_default();
    let whole = moved(&fitted.outlines(1, |label| label.min(1))[1]);
    if whole.is_empty() {
        return None;
    }
    let patch = |(own, (placed, detail)): (u32, &(&PlacedPart<'_>, &Shape))| {
        let stacked = fitted.stacked_outline(own, |other| if own < other { BENEATH } else { 0.0 });
        placed.painted(detail, moved(&stacked))
    };
    let patches = (2..).zip(&details).map(patch).filter(|p| !p.outline.is_empty());
    let shading = parts.iter().flat_map(PlacedPart::shading);
    let base = base(&parts, &mask, whole);
    let known = model.element(main.variant);
    let element = Element {
        library: LibraryId(known.library as u32),
        source: Some(ElementId(known.index)),
        category: parts[0].primary.category,
        fused: true,
        silhouette: None,
        shapes: std::iter::once(base).chain(patches).chain(shading).collect(),
    };
    Some((element, mask))
}

/// The details of several parts.
#[derive(Default)]
struct Details<'a> {
    list: Vec<(&'a PlacedPart<'a>, &'a Shape)>,
}

impl<'a> Details<'a> {
    /// The label of a detail: that of the detail of another part with nearly the same colour, so that it runs on
    /// across the seam, or a new one.
    fn joined(&mut self, part: &'a PlacedPart<'a>, detail: &'a Shape) -> u32 {
        let others = self.list.iter().enumerate().filter(|(_, known)| !std::ptr::eq(known.0, part));
        let near = others
            .map(|(k, known)| (known.1.colour.distance(detail.colour), k))
            .filter(|(d, _)| *d <= SAME_COLOUR);
        let known = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let index = known.map_or(self.list.len(), |(_, k)| k);
        if index == self.list.len() {
            self.list.push((part, detail));
        }
        index as u32 + 2
    }

    /// The details that are large enough, in the order of their labels, which are numbered anew from 2 on; the
    /// cells of others become the base's.
    fn without_specks(self, labels: &mut LabelMap) -> Vec<(&'a PlacedPart<'a>, &'a Shape)> {
        let areas = labels.areas();
        let least = LEAST_DETAIL * (FINE * FINE) as u32;
        let mut numbers = vec![0, 1];
        let mut kept = Vec::new();
        for (label, detail) in (2..).zip(self.list) {
            let large = areas.get(label).is_some_and(|&area| area >= least);
            if large {
                kept.push(detail);
            }
            numbers.push(if large { kept.len() as u32 + 1 } else { 1 });
        }
        labels.labels.iter_mut().for_each(|label| *label = numbers[*label as usize]);
        kept
    }
}

/// A part with its primary, relative to the origin of the instance.
struct PlacedPart<'a> {
    primary: &'a library::ExemplarElement,
    /// Its pixels.
    mask: Mask,
    /// The map from the exemplar to the place of the part.
    to_place: Affine,
}

impl<'a> PlacedPart<'a> {
    fn new(part: &PrimaryPixels, origin: [i32; 2], libraries: &'a [Library], model: &PlacementModel) -> Self {
        let known = model.element(part.variant);
        let primary = &libraries[known.library].primaries()[known.index as usize];
        let way = [0, 1].map(|k| part.at[k] - origin[k]);
        let to_place = to_place(primary, model.variation(part.variant), way);
        Self { primary, mask: part.mask.shifted(-origin[0], -origin[1]), to_place }
    }

    /// The soft ellipses whose centres the part shows.
    fn shading(&self) -> impl Iterator<Item = Shape> {
        let soft = self.primary.details().iter().filter(|detail| detail.is_soft());
        soft.map(|detail| detail.moved(self.to_place)).filter(|detail| {
            let centre = detail.outline.bounds().center();
            self.mask.contains(libm::floor(centre.x) as i32, libm::floor(centre.y) as i32)
        })
    }

    /// A shape of the primary with another outline, without a soft rim: where it is cut off, nothing is out of focus.
    fn painted(&self, shape: &Shape, outline: Outline) -> Shape {
        Shape {
            gradient: shape.gradient.as_ref().map(|g| Box::new(g.moved(self.to_place))),
            rim: None,
            ..shape.with_outline(outline)
        }
    }

    /// Moves the rim of the whole to the outline of the part, by at most a pixel, where the part ends there.
    fn refine(
        &self,
        labels: &mut LabelMap,
        whole: &Mask,
        corner: [i32; 2],
        to_map: Affine,
        is_free: impl Fn([i32; 2]) -> bool,
    ) {
        let mut rim = Vec::new();
        self.mask.for_cracks(|[x, y], [dx, dy], _| {
            let beyond = [x + dx, y + dy];
            if !whole.contains(beyond[0], beyond[1]) && is_free(beyond) {
                rim.push(([x, y], beyond));
            }
        });
        if rim.is_empty() {
            return;
        }
        let Some(outline) = Outline::new(&(to_map * self.to_place * self.primary.outline().path())) else {
            return;
        };
        let inside = Interior::new(&outline);
        let mut set = |[x, y]: [i32; 2], within: bool| {
            for (u, v) in (0..FINE).flat_map(|v| (0..FINE).map(move |u| (u, v))) {
                let [cx, cy] = [(x - corner[0]) * FINE + u, (y - corner[1]) * FINE + v];
                let middle = Point::new(f64::from(cx) + 0.5, f64::from(cy) + 0.5);
                if inside.contains(middle) != within {
                    labels.set(cx as u32, cy as u32, u32::from(!within));
                }
            }
        };
        for (pixel, beyond) in rim {
            // A pixel within the rim keeps only its cells within the outline; a pixel beyond the rim gains
            // its cells within the outline.
            set(pixel, true);
            set(beyond, false);
        }
    }
}

/// Labels cells of the whole.
fn fill(labels: &mut LabelMap, cells: &Mask, label: u32) {
    for span in cells.spans() {
        let start = labels.index(span.x0 as u32, span.y as u32);
        let row = &mut labels.labels[start..start + span.len() as usize];
        row.iter_mut().filter(|own| **own > 0).for_each(|own| *own = label);
    }
}

/// The pixels of a mask as cells of the map.
fn on_map(mask: &Mask, corner: [i32; 2]) -> Mask {
    let at = |v: i32, k: usize| (v - corner[k]) * FINE;
    let rows = |s: Span| (0..FINE).map(move |v| Span { y: at(s.y, 1) + v, x0: at(s.x0, 0), x1: at(s.x1, 0) });
    Mask::from_spans(mask.spans().iter().copied().flat_map(rows).collect())
}

/// The bottom shape: it has the paint of the part that covers most of the whole, or a gradient from the
/// largest part to the second largest.
fn base(parts: &[PlacedPart<'_>], whole: &Mask, outline: Outline) -> Shape {
    let main = &parts[0];
    let shape = main.painted(main.primary.base(), outline);
    let area = |part: &PlacedPart<'_>| f64::from(part.mask.area());
    let colour = |part: &PlacedPart<'_>| part.primary.base().colour;
    let near = |part: &&PlacedPart<'_>| colour(part).distance(colour(main)) <= ONE_PAINT;
    let other = parts.iter().skip(1).filter(near).find(|part| colour(part) != colour(main));
    let Some(other) = other.filter(|_| area(main) < DOMINANT * f64::from(whole.area())) else { return shape };
    let middle = |part: &PlacedPart<'_>| part.mask.centroid().map_or([0.0; 2], |(x, y)| [x, y]);
    let (from, to) = (middle(main), middle(other));
    let gradient = Gradient::linear(from, to, [colour(main), colour(other)]);
    if gradient.fault().is_some() {
        return shape;
    }
    let share = area(main) / (area(main) + area(other));
    let [a, b] = [colour(main), colour(other)].map(Colour::to_f64);
    let mean = Colour::from_f64([0, 1, 2].map(|k| share * a[k] + (1.0 - share) * b[k]));
    Shape { colour: mean, gradient: Some(Box::new(gradient)), ..shape }
}
