//! The whole way at once, as few pictures of each texton: what an animation that a viewer plays is
//! made of.

use super::Interpolation;
use super::domain::Region;
use super::effects::{Effects, half_way};
use super::item::{Ends, Item, Layer};
use super::ring::{Ring, count, even};
use crate::geometry::{Affine, Outline, Point, Rect, Vec2};
use crate::raster::colour::Colour;
use crate::scene::{Edge, Scene};

/// Points of a ring in a motion.
const COUNT: (usize, usize) = (6, 32);
/// So many points of a ring become one.
const EVERY: usize = 4;
/// How far polygons may lie from their curves, in pixels.
const FLAT: f64 = 0.1;

/// A texton on its way.
pub struct Motion {
    /// The same in every scene between the two.
    pub id: u32,
    /// Its shapes, in painting order.
    pub shapes: Vec<Moving>,
    /// The shares of the way between which it changes, where that is not all the way: it shrinks to
    /// nothing or grows from nothing.
    pub window: Option<[f64; 2]>,
}

/// A shape that turns into another.
pub struct Moving {
    /// Its rings at the beginning, half-way and at the end, in canvas pixels: as many points each.
    pub rings: Vec<[Vec<Point>; 3]>,
    /// How it is painted.
    pub brush: Brush,
}

/// How a shape on its way is painted, at the beginning and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brush {
    /// In colours; in place of a gradient its mean.
    Fill([Colour; 2]),
    /// In black of these opacities, 0 to 1, with a sharp edge.
    Shadow([f64; 2]),
    /// A line along the outline, of these widths in pixels.
    Line {
        /// Its colours.
        colours: [Colour; 2],
        /// Its widths.
        widths: [f64; 2],
    },
}

impl Interpolation<'_> {
    /// The secondaries, and the primaries, on their way, in the painting order half-way.
    pub fn motions(&self) -> [Vec<Motion>; 2] {
        let first = self.secondary.len() as u32;
        [(Layer::Secondary, &self.secondary, 0), (Layer::Primary, &self.primary, first)]
            .map(|(layer, items, first)| self.motions_of(layer, items, first))
    }

    /// The shape that is filled, on its way, and what becomes of primaries at its edge; none if both
    /// scenes fill the canvas.
    pub fn domain_motion(&self) -> Option<(Moving, Edge)> {
        self.region.as_ref().map(Region::motion)
    }

    /// The two scenes, with what repeats in only one of them listed copy by copy.
    pub fn scenes(&self) -> [&Scene; 2] {
        [&self.scenes[0], &self.scenes[1]]
    }

    fn motions_of(&self, layer: Layer, items: &[Item], first: u32) -> Vec<Motion> {
        let ends = Ends { scenes: self.scenes(), libraries: [&self.indices[0], &self.indices[1]] };
        let numbered: Vec<(u32, &Item)> = (first..).zip(items).collect();
        let motion = |(id, item): &(u32, &Item)| item.motion(&ends, layer, *id);
        let motions = crate::parallel::map(&numbered, motion);
        let mut order: Vec<(f64, Motion)> = items.iter().map(|i| i.key(0.5)).zip(motions).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().map(|(_, motion)| motion).collect()
    }
}

impl Moving {
    /// From its rings around centres at the three times, as many at each.
    pub(super) fn new(rings: [Vec<Ring>; 3], centres: [Point; 3], colours: [Colour; 2]) -> Self {
        let [a, b, c] = rings;
        let three = a
            .iter()
            .zip(&b)
            .zip(&c)
            .map(|((a, b), c)| [thin(a, centres[0]), thin(b, centres[1]), thin(c, centres[2])]);
        Self { rings: three.collect(), brush: Brush::Fill(colours) }
    }

    /// From an outline on the canvas that shrinks to a point, or grows from it.
    pub(super) fn resized(
        outline: &Outline,
        affine: Affine,
        centre: Point,
        grows: bool,
        colour: Colour,
    ) -> Self {
        let rings = outline.polygons(FLAT).into_iter().map(|ring| {
            let ring: Ring = ring.iter().map(|p| affine * *p).collect();
            let whole = thin(&even(&ring, count(&ring, &ring)), Point::ORIGIN);
            let nothing = vec![centre; whole.len()];
            let half = whole.iter().map(|p| p.midpoint(centre)).collect();
            if grows { [nothing, half, whole] } else { [whole, half, nothing] }
        });
        Self { rings: rings.collect(), brush: Brush::Fill([colour; 2]) }
    }

    /// Shapes of a texton with the shadow beneath them and the line along the first of them that both
    /// ends have.
    pub(super) fn with_effects(mut shapes: Vec<Self>, [from, to]: [Effects; 2]) -> Vec<Self> {
        let Some(rings) = shapes.first().map(|shape| shape.rings.clone()) else { return shapes };
        if let Some((a, b)) = from.shadow.zip(to.shadow) {
            let shifts = [a.shift(), half_way(&a, &b), b.shift()];
            let moved = |ring: &Ring, shift: Vec2| ring.iter().map(|p| *p + shift).collect::<Ring>();
            let fallen = |ring: &[Ring; 3]| [0, 1, 2].map(|k| moved(&ring[k], shifts[k]));
            let rings = rings.iter().map(fallen).collect();
            shapes.insert(0, Self { rings, brush: Brush::Shadow([a.opacity, b.opacity]) });
        }
        if let Some((a, b)) = from.stroke.zip(to.stroke) {
            let brush = Brush::Line { colours: [a.colour, b.colour], widths: [a.width, b.width] };
            shapes.push(Self { rings, brush });
        }
        shapes
    }

    /// A box around all that it passes.
    pub fn bounds(&self) -> Rect {
        let margin = match self.brush {
            Brush::Line { widths: [a, b], .. } => a.max(b) / 2.0,
            Brush::Fill(_) | Brush::Shadow(_) => 0.0,
        };
        let points = self.rings.iter().flatten().flatten();
        let mut all = points.map(|p| Rect::from_points(*p, *p));
        let first = all.next().unwrap_or_default();
        all.fold(first, |sum, r| sum.union(r)).inflate(margin, margin)
    }
}

/// Some of the points of a ring around a place.
fn thin(ring: &Ring, centre: Point) -> Ring {
    let n = ring.len();
    let m = (n / EVERY).clamp(COUNT.0, COUNT.1);
    (0..m).map(|i| ring[i * n / m] + centre.to_vec2()).collect()
}
