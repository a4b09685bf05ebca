//! The whole way at once, as few pictures of each texton: what an animation that a viewer plays is
//! made of.

use super::domain::Region;
use super::item::{Ends, Item, Layer};
use super::{Interpolation, ring::Ring};
use crate::geometry::{Point, Rect};
use crate::raster::colour::Colour;
use crate::scene::{Edge, Instance, Scene};

/// Points of a ring in a motion.
const COUNT: (usize, usize) = (6, 32);
/// So many points of a ring become one.
const EVERY: usize = 4;

/// A texton on its way.
pub struct Motion<'a> {
    /// The same in every scene between the two.
    pub id: u32,
    /// What becomes of it.
    pub change: Change<'a>,
}

/// What becomes of a texton.
pub enum Change<'a> {
    /// It turns into another: its shapes, in painting order.
    Shapes(Vec<Moving>),
    /// It shrinks to nothing, or grows from nothing.
    Size(Resizing<'a>),
}

/// A shape that turns into another.
pub struct Moving {
    /// Its rings at the beginning, half-way and at the end, in canvas pixels: as many points each.
    pub rings: Vec<[Vec<Point>; 3]>,
    /// Its colour at the beginning and at the end. In place of a gradient its mean.
    pub colours: [Colour; 2],
}

/// A texton that is there at one end only.
pub struct Resizing<'a> {
    /// The scene that it is of, which holds its texton.
    pub scene: &'a Scene,
    /// The texton at its full size.
    pub instance: &'a Instance,
    /// The place that it grows from or shrinks to.
    pub centre: Point,
    /// Whether it grows.
    pub grows: bool,
    /// The shares of the way between which it does.
    pub window: [f64; 2],
}

impl Interpolation<'_> {
    /// The secondaries, and the primaries, on their way, in the painting order half-way.
    pub fn motions(&self) -> [Vec<Motion<'_>>; 2] {
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

    fn motions_of(&self, layer: Layer, items: &[Item], first: u32) -> Vec<Motion<'_>> {
        let ends = Ends { scenes: self.scenes(), libraries: [&self.indices[0], &self.indices[1]] };
        let numbered: Vec<(u32, &Item)> = (first..).zip(items).collect();
        let motion = |(id, item): &(u32, &Item)| Motion { id: *id, change: item.change(&ends, layer) };
        let motions = crate::parallel::map(&numbered, motion);
        let mut order: Vec<(f64, Motion<'_>)> = items.iter().map(|i| i.key(0.5)).zip(motions).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().map(|(_, motion)| motion).collect()
    }
}

impl Moving {
    /// From its rings at the three times, as many at each.
    pub(super) fn new(rings: [Vec<Ring>; 3], centres: [Point; 3], colours: [Colour; 2]) -> Self {
        let [a, b, c] = rings;
        let thin = |ring: Ring, centre: Point| -> Ring {
            let n = ring.len();
            let m = (n / EVERY).clamp(COUNT.0, COUNT.1);
            (0..m).map(|i| ring[i * n / m] + centre.to_vec2()).collect()
        };
        let three = a
            .into_iter()
            .zip(b)
            .zip(c)
            .map(|((a, b), c)| [thin(a, centres[0]), thin(b, centres[1]), thin(c, centres[2])]);
        Self { rings: three.collect(), colours }
    }

    /// A box around all that it passes.
    pub fn bounds(&self) -> Rect {
        let points = self.rings.iter().flatten().flatten();
        let mut all = points.map(|p| Rect::from_points(*p, *p));
        let first = all.next().unwrap_or_default();
        all.fold(first, |sum, r| sum.union(r))
    }
}
