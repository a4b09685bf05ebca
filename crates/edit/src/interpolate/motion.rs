//! Interpolations as keyframes: three shapes of each texton, from which a viewer plays an animation.

use super::Interpolation;
use super::effects::{Effects, half_way};
use super::layer::LayerTween;
use super::region::{DomainTween, RegionTween};
use super::ring::{Ring, count, even};
use super::tween::{Ends, Tween};
use vtex_base::geometry::{Affine, Outline, Point, Rect, Vec2};
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{Edge, Field, InstanceId, Role, Scene};

/// Smallest and largest number of points of a ring.
const COUNT: (usize, usize) = (6, 32);
/// Reduction of a ring's points, as a divisor.
const REDUCTION: usize = 4;
/// Largest distance between a polygon and its curve, in pixels.
const FLAT: f64 = 0.1;

/// The motion of one element.
pub struct Motion {
    /// Id of its instance, the same in every scene in between.
    pub id: InstanceId,
    /// Its shapes over time, in painting order.
    pub shapes: Vec<MovingShape>,
    /// The period in which it changes, as times 0 to 1, for a texton that vanishes or appears. `None`
    /// means the whole time.
    pub window: Option<[f64; 2]>,
}

/// A shape that changes over time.
pub struct MovingShape {
    /// Each ring at the beginning, at half-time and at the end, in canvas pixels, with the same number
    /// of points.
    pub rings: Vec<[Vec<Point>; 3]>,
    /// Its paint.
    pub brush: Brush,
}

/// The paint of a changing shape, at the beginning and at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brush {
    /// A fill with these colours. A gradient is replaced by its mean colour.
    Fill([Colour; 2]),
    /// A shadow with a sharp edge: black with these opacities, 0 to 1.
    Shadow([f64; 2]),
    /// A stroke along the outline.
    Line {
        /// Colours of the stroke.
        colours: [Colour; 2],
        /// Widths of the stroke, in pixels.
        widths: [f64; 2],
    },
}

/// The motion of one layer.
pub struct LayerMotion<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its role.
    pub role: Role,
    /// Its field in either scene, if it has one there.
    pub fields: [Option<&'a Field>; 2],
    /// The motion of its region; `None` if it fills the canvas all the time.
    pub region: Option<MovingShape>,
    /// The motions of its elements, in the painting order at half-time.
    pub motions: Vec<Motion>,
}

impl Interpolation {
    /// The motions of all layers, in painting order. Soft ellipses are left out.
    pub fn motions(&self) -> Vec<LayerMotion<'_>> {
        self.layers.iter().map(|layer| self.motion_of(layer)).collect()
    }

    fn motion_of<'a>(&'a self, layer: &'a LayerTween) -> LayerMotion<'a> {
        let field = |k: usize| layer.pair.layer(k, &self.scenes[k])?.field.as_ref();
        LayerMotion {
            name: &layer.name,
            role: layer.role,
            fields: [field(0), field(1)],
            region: layer.region.as_ref().map(RegionTween::moving),
            motions: self.motions_of(layer),
        }
    }

    /// The motion of the domain, and what happens to individual elements at its edge. `None` if both
    /// scenes fill the canvas.
    pub fn domain_motion(&self) -> Option<(MovingShape, Edge)> {
        self.domain.as_ref().map(DomainTween::motion)
    }

    /// The two scenes, with everything that repeats in only one of them listed copy by copy.
    pub fn scenes(&self) -> [&Scene; 2] {
        [&self.scenes[0], &self.scenes[1]]
    }

    fn motions_of(&self, layer: &LayerTween) -> Vec<Motion> {
        let ends = Ends { scenes: self.scenes(), libraries: [&self.indices[0], &self.indices[1]] };
        let numbered: Vec<(u32, &Tween)> = (layer.first as u32..).zip(&layer.tweens).collect();
        let motion = |(id, tween): &(u32, &Tween)| tween.motion(&ends, layer.pair, InstanceId(*id));
        let motions = vtex_base::parallel::map(&numbered, motion);
        let mut order: Vec<(f64, Motion)> = layer.tweens.iter().map(|t| t.key(0.5)).zip(motions).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().map(|(_, motion)| motion).collect()
    }
}

impl MovingShape {
    /// A shape from its rings around the centres at the three times, with the same number of rings at each.
    pub(super) fn new(rings: [Vec<Ring>; 3], centres: [Point; 3], colours: [Colour; 2]) -> Self {
        let [a, b, c] = rings;
        let three = a
            .iter()
            .zip(&b)
            .zip(&c)
            .map(|((a, b), c)| [thin(a, centres[0]), thin(b, centres[1]), thin(c, centres[2])]);
        Self { rings: three.collect(), brush: Brush::Fill(colours) }
    }

    /// An outline on the canvas that shrinks to a point or grows from one.
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

    /// A texton's shapes with its shadow underneath and its stroke along the first shape.
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

    /// Bounding box over the whole motion.
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

/// A ring around `centre`, reduced to fewer points.
fn thin(ring: &Ring, centre: Point) -> Ring {
    let n = ring.len();
    let m = (n / REDUCTION).clamp(COUNT.0, COUNT.1);
    (0..m).map(|i| ring[i * n / m] + centre.to_vec2()).collect()
}
