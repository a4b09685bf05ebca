//! Elements as drawings in ink: an outline on paper, and hatching that is the denser the darker an element is there.
//!
//! Up to four sets of parallel lines lie one over the other, each where the element is darker than a limit: lines, as
//! many between them, lines across these, and as many between those. Lightness is Oklab's, between the darkest and the
//! lightest parts of the selected elements. What is too small for lines, soft ellipses too, becomes dots of ink if it is
//! dark, and is left out if it is light.

use super::selection::Chosen;
use super::textons::{change, selected, selected_mut, size};
use super::thin::retain;
use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;
use vtex_base::geometry::{Affine, BezPath, Curve, Interior, Outline, Point, rotation};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Join, Line, Profile};
use vtex_scene::scene::{Element, Instance, InstanceId, Scene, Shape};

/// What is drawn with, and on. Lengths in pixels of the canvas.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    /// Distance of the lines of a set.
    pub(super) spacing: f64,
    /// Direction of the first lines, in radians.
    pub(super) angle: f64,
    pub(super) width: f64,
    pub(super) ink: Colour,
    pub(super) paper: Colour,
}

impl Pen {
    /// Whether an element shown at `size` is no more than a dot.
    fn dots(&self, element: &Element, size: f64) -> bool {
        let least = SMALL * self.spacing;
        element.base().is_soft() || element.outline().area() * size * size < least * least
    }
}

/// A set of parallel lines.
struct LineSet {
    /// Lightness below which they are drawn, 0 to 1.
    limit: f64,
    /// Offset, in spacings.
    offset: f64,
    /// Whether they lie across the first.
    across: bool,
}

/// From the one that is drawn most to the one that is drawn least.
const SETS: [LineSet; 4] = [
    LineSet { limit: 0.75, offset: 0.0, across: false },
    LineSet { limit: 0.5, offset: 0.5, across: false },
    LineSet { limit: 0.3, offset: 0.0, across: true },
    LineSet { limit: 0.15, offset: 0.5, across: true },
];
/// Side of the smallest square that has lines, in spacings.
const SMALL: f64 = 2.0;
/// Lightness from which a dot is left out.
const LIGHT: f64 = 0.5;
/// Distance of the places along a line at which lightness is looked up, in spacings.
const STEP: f64 = 0.25;
/// Shares of the area that are darker than the darkest tone, and darker than the lightest.
const EXTREMES: [f64; 2] = [0.04, 0.96];

/// Draws the selected elements in ink.
pub(super) fn hatch(scene: &mut Scene, chosen: &Chosen, pen: Pen) {
    let tones = Tones::of(scene, chosen);
    let is_light = |instance: &&Instance| {
        let element = &scene.elements[instance.element.index()];
        let colour = instance.colour.unwrap_or(element.base().colour);
        pen.dots(element, size(instance)) && tones.lightness(colour) >= LIGHT
    };
    let light: BTreeSet<InstanceId> =
        selected(scene, chosen).filter(is_light).map(|instance| instance.id).collect();
    change(scene, chosen, |element, size| {
        if pen.dots(element, size) { dot(element, pen.ink) } else { drawn(element, size, pen, &tones) }
    });
    for instance in selected_mut(scene, chosen) {
        (instance.colour, instance.stroke) = (None, None);
    }
    retain(scene, chosen, |_, instance| !light.contains(&instance.id));
}

/// The range of lightness of elements.
struct Tones {
    range: [f64; 2],
}

impl Tones {
    /// Of the selected elements, each counted once for each place.
    fn of(scene: &Scene, chosen: &Chosen) -> Self {
        let mut parts = Vec::new();
        for instance in selected(scene, chosen) {
            let mut own = instance.colour;
            for shape in &scene.elements[instance.element.index()].shapes {
                let colour = own.take().unwrap_or(shape.colour);
                parts.push((f64::from(colour.to_oklab()[0]), shape.area()));
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = parts.iter().map(|part| part.1).sum();
        let range = EXTREMES.map(|share| {
            let mut below = 0.0;
            let found = parts.iter().find(|(_, area)| {
                below += area;
                below >= share * all
            });
            found.map_or(share, |part| part.0)
        });
        Self { range }
    }

    /// The lightness of a colour within the range, 0 to 1.
    fn lightness(&self, colour: Colour) -> f64 {
        let [low, high] = self.range;
        ((f64::from(colour.to_oklab()[0]) - low) / (high - low).max(0.02)).clamp(0.0, 1.0)
    }
}

/// A small element as a dot of as much ink.
fn dot(element: &Element, ink: Colour) -> Element {
    let outline = element.outline();
    let middle = outline.bounds().center().to_vec2();
    let radius = element.base().ellipse.as_ref().map_or(1.0, |ellipse| ellipse.profile.opaque_radius());
    let shrink = Affine::translate(middle) * Affine::scale(radius) * Affine::translate(-middle);
    Element { silhouette: None, shapes: vec![Shape::new(outline.moved(shrink), ink)], ..*element }
}

/// An element in ink, shown at `size`.
fn drawn(element: &Element, size: f64, pen: Pen, tones: &Tones) -> Element {
    let (spacing, width) = (pen.spacing / size.max(1e-6), pen.width / size.max(1e-6));
    let outline = element.outline();
    let stroked = |path: BezPath| {
        let line = Line { join: Join::Round, ..Line::new(Curve::new(path)?, width) };
        Shape::stroked(line, pen.ink)
    };
    let mut path = BezPath::new();
    for (across, angle) in [(false, pen.angle), (true, pen.angle + FRAC_PI_2)] {
        let turned = TurnedElement::new(element, angle, tones);
        SETS.iter()
            .filter(|set| set.across == across)
            .for_each(|set| turned.add_lines(set, spacing, &mut path));
    }
    let mut shapes = vec![Shape::new(outline.clone(), pen.paper)];
    shapes.extend(Some(path).filter(|path| !path.is_empty()).and_then(stroked));
    shapes.extend(stroked(outline.path().clone()));
    Element { silhouette: None, shapes, ..*element }
}

/// An element turned so that the lines of its hatching are horizontal.
struct TurnedElement {
    back: Affine,
    outline: Outline,
    inside: Interior,
    /// Lightness of the whole.
    lightness: f64,
    details: Vec<TurnedDetail>,
}

/// A detail of a turned element: where it lies, and its lightness.
struct TurnedDetail {
    extent: DetailExtent,
    lightness: f64,
}

/// Where a detail covers what lies below it.
enum DetailExtent {
    Filled(Interior),
    /// From the element to the unit disc.
    Soft(Affine, Profile),
}

impl TurnedElement {
    fn new(element: &Element, angle: f64, tones: &Tones) -> Self {
        let turn = rotation(-angle);
        let outline = element.outline().moved(turn);
        let details = element.details().iter().map(|shape| {
            let shape = shape.moved(turn);
            let extent = match &shape.ellipse {
                Some(ellipse) => DetailExtent::Soft(ellipse.map().inverse(), ellipse.profile),
                None => DetailExtent::Filled(Interior::new(&shape.outline)),
            };
            TurnedDetail { extent, lightness: tones.lightness(shape.colour) }
        });
        Self {
            back: rotation(angle),
            inside: Interior::new(&outline),
            lightness: tones.lightness(element.base().colour),
            details: details.collect(),
            outline,
        }
    }

    /// Adds the lines of a set where the element is darker than their limit.
    fn add_lines(&self, set: &LineSet, spacing: f64, path: &mut BezPath) {
        let bounds = self.outline.bounds();
        let first = libm::ceil(bounds.y0 / spacing - set.offset) as i64;
        let last = libm::floor(bounds.y1 / spacing - set.offset) as i64;
        for y in (first..=last).map(|k| (k as f64 + set.offset) * spacing) {
            let filled: Vec<Vec<[f64; 2]>> = self.details.iter().map(|detail| detail.intervals(y)).collect();
            for [from, to] in self.inside.intervals(y) {
                let steps = libm::ceil((to - from) / (STEP * spacing)).max(1.0) as usize;
                let place = |k: usize| from + (to - from) * k as f64 / steps as f64;
                let is_dark = |k: usize| {
                    let x = (place(k) + place(k + 1)) / 2.0;
                    self.lightness_at(Point::new(x, y), &filled) < set.limit
                };
                let mut start = None;
                for k in 0..=steps {
                    match (start, k < steps && is_dark(k)) {
                        (None, true) => start = Some(k),
                        (Some(begin), false) => {
                            path.move_to(self.back * Point::new(place(begin), y));
                            path.line_to(self.back * Point::new(place(k), y));
                            start = None;
                        }
                        _ => {}
                    }
                }
            }
        }
    }

    /// The lightness at a place on a line. `filled` has the intervals of the line in each detail.
    fn lightness_at(&self, at: Point, filled: &[Vec<[f64; 2]>]) -> f64 {
        let details = self.details.iter().zip(filled);
        details.fold(self.lightness, |below, (detail, intervals)| {
            let opacity = match &detail.extent {
                DetailExtent::Filled(_) => {
                    f64::from(u8::from(intervals.iter().any(|[a, b]| (*a..*b).contains(&at.x))))
                }
                DetailExtent::Soft(map, profile) => {
                    let p = *map * at;
                    profile.opacity_at(p.x * p.x + p.y * p.y)
                }
            };
            below + opacity * (detail.lightness - below)
        })
    }
}

impl TurnedDetail {
    /// The intervals of a horizontal line within a filled detail.
    fn intervals(&self, y: f64) -> Vec<[f64; 2]> {
        match &self.extent {
            DetailExtent::Filled(interior) => interior.intervals(y),
            DetailExtent::Soft(..) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;
    use vtex_scene::scene::testing::element;

    const PEN: Pen =
        Pen { spacing: 4.0, angle: 0.0, width: 0.5, ink: Colour([0; 3]), paper: Colour([255; 3]) };
    const TONES: Tones = Tones { range: [0.0, 1.0] };

    fn outline(text: &str) -> Outline {
        Outline::new(&parse_path(text).unwrap()).unwrap()
    }

    /// The pieces of the hatching of a square of 40 pixels, as ends of lines.
    fn pieces(element: &Element) -> Vec<[Point; 2]> {
        let drawn = drawn(element, 1.0, PEN, &TONES);
        let [_, between @ .., _] = &drawn.shapes[..] else { panic!("{drawn:?}") };
        let lines = between.iter().filter_map(|shape| shape.line.as_ref());
        let points: Vec<Point> =
            lines.flat_map(|line| line.path.path().elements()).filter_map(|e| e.end_point()).collect();
        points.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    fn square(colour: Colour) -> Element {
        element(0, Some(0), outline("M0 0h40v40h-40z"), colour)
    }

    #[test]
    fn the_darker_the_denser() {
        let counts = [250, 160, 95, 40, 5].map(|v| pieces(&square(Colour([v; 3]))).len());
        assert_eq!(counts[0], 0);
        assert!(counts.windows(2).all(|pair| pair[0] < pair[1]), "{counts:?}");
        // Ink within the outline only, and as long as the square is wide.
        for [from, to] in pieces(&square(Colour([95; 3]))) {
            assert!(from.y == to.y && from.x == 0.0 && to.x == 40.0, "{from:?} {to:?}");
        }
    }

    #[test]
    fn light_details_and_soft_light_interrupt_the_lines() {
        let mut with_patch = square(Colour([95; 3]));
        with_patch.shapes.push(Shape::new(outline("M10 -5h10v60h-10z"), Colour([250; 3])));
        let rim =
            outline("M10 20C10 9 14.5 0 20 0C25.5 0 30 9 30 20C30 31 25.5 40 20 40C14.5 40 10 31 10 20z");
        let mut shaded = square(Colour([95; 3]));
        shaded.shapes.push(Shape::soft_along(&rim, Colour([255; 3]), Profile::Sharp).unwrap());
        let whole = pieces(&square(Colour([95; 3]))).len();
        assert_eq!(pieces(&with_patch).len(), 2 * whole);
        assert!(pieces(&with_patch).iter().all(|[a, b]| b.x <= 10.5 || a.x >= 19.5));
        assert!(pieces(&shaded).len() > whole);
    }

    #[test]
    fn the_lightest_and_darkest_of_a_texture_make_its_range() {
        let tones = Tones { range: [0.4, 0.6] };
        let [dark, light] = [Colour([20; 3]), Colour([230; 3])].map(|colour| tones.lightness(colour));
        assert_eq!([dark, light], [0.0, 1.0]);
    }
}
