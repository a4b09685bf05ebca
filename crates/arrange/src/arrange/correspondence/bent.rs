//! Bent elements: whole elements whose outline is brought nearer to that of an instance.
//!
//! Where elements interlock, one that is placed whole leaves gaps beside it and lies on its neighbours. Its radii about
//! its middle are therefore lengthened and shortened a little, by factors that change slowly with the angle: a Fourier
//! series of few harmonics. All of its shapes are bent with it, so that it keeps its one surface.

use super::mapped::to_place;
use super::resolve::Mapped;
use vtex_base::geometry::{Affine, Outline, Point, Vec2};
use vtex_base::raster::Mask;
use vtex_scene::element::Gradient;
use vtex_scene::library::ExemplarElement;
use vtex_scene::scene::{Shape, pixels};

/// Directions in which radii are compared.
const DIRECTIONS: usize = 32;
/// Harmonics of the factors of radii.
const HARMONICS: usize = 4;
/// Longest segment of an outline that is bent as one, as a share of the side of a square of the element's area.
const SEGMENT: f64 = 0.4;
/// Least and greatest factor of a radius.
const FACTORS: [f64; 2] = [0.87, 1.15];

/// Factors of the radii of an element about its middle.
struct Bend {
    middle: Point,
    /// Their mean, then the amplitudes of the cosines and sines of multiples of the angle.
    mean: f64,
    harmonics: [[f64; 2]; HARMONICS],
    growth: f64,
    /// Longest segment of an outline that follows them, in pixels.
    longest: f64,
}

impl Bend {
    /// The bend that brings a mask nearer to another, both about the middle of the first, and enlarges it.
    fn onto(mask: &Mask, wanted: &Mask, growth: f64) -> Option<Self> {
        let (x, y) = mask.centroid()?;
        let middle = Point::new(x, y);
        let (mut mean, mut harmonics) = (0.0, [[0.0; 2]; HARMONICS]);
        let longest = SEGMENT * libm::sqrt(f64::from(mask.area()));
        for k in 0..DIRECTIONS {
            let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            let (sine, cosine) = libm::sincos(angle);
            let [own, other] = [mask, wanted].map(|mask| radius(mask, middle, Vec2::new(cosine, sine)));
            let factor = growth * (other / own.max(1.0)).clamp(FACTORS[0], FACTORS[1]);
            mean += factor / DIRECTIONS as f64;
            for (n, [c, s]) in (1..).zip(&mut harmonics) {
                let (sine, cosine) = libm::sincos(f64::from(n) * angle);
                *c += 2.0 * factor * cosine / DIRECTIONS as f64;
                *s += 2.0 * factor * sine / DIRECTIONS as f64;
            }
        }
        Some(Self { middle, mean, harmonics, growth, longest })
    }

    /// The factor of the radius to a point.
    fn factor(&self, point: Point) -> f64 {
        let way = point - self.middle;
        let length = way.hypot();
        if length < 1e-6 {
            return 1.0;
        }
        let [x, y] = [way.x / length, way.y / length];
        let (mut cosine, mut sine, mut factor) = (1.0, 0.0, self.mean);
        for [c, s] in self.harmonics {
            (cosine, sine) = (cosine * x - sine * y, cosine * y + sine * x);
            factor += c * cosine + s * sine;
        }
        self.growth * (factor / self.growth).clamp(FACTORS[0], FACTORS[1])
    }

    fn point(&self, point: Point) -> Point {
        self.middle + (point - self.middle) * self.factor(point)
    }

    fn outline(&self, outline: &Outline) -> Option<Outline> {
        outline.carried(self.longest, |p| self.point(p))
    }

    /// A shape bent; a soft ellipse is moved and scaled as its middle is.
    fn shape(&self, shape: &Shape) -> Option<Shape> {
        if shape.is_soft() {
            let middle = shape.outline.bounds().center();
            let there = self.point(middle).to_vec2();
            let by = Affine::translate(there) * Affine::scale(self.factor(middle));
            return Some(shape.moved(by * Affine::translate(-middle.to_vec2())));
        }
        let gradient = |g: &Gradient| {
            let bent = g.carried(|p| self.point(p));
            if bent.fault().is_none() { bent } else { g.clone() }
        };
        Some(Shape {
            gradient: shape.gradient.as_ref().map(|g| Box::new(gradient(g))),
            rim: shape.rim.clone(),
            ..shape.with_outline(self.outline(&shape.outline)?)
        })
    }
}

/// An element that is bent.
pub(super) struct Bent<'a> {
    bend: Bend,
    pub(super) primary: &'a ExemplarElement,
    /// The map from the exemplar to the place where the element is bent.
    to_place: Affine,
    base: Shape,
    /// Its pixels, relative to its origin.
    pub(super) mask: Mask,
}

impl<'a> Bent<'a> {
    /// A mapped primary bent onto an instance and enlarged; `None` if no outline is left.
    pub(super) fn onto(
        mapped: &Mapped,
        primary: &'a ExemplarElement,
        instance: &Mask,
        growth: f64,
    ) -> Option<Self> {
        let bend = Bend::onto(&mapped.mask, &instance.shifted(-mapped.at[0], -mapped.at[1]), growth)?;
        let to_place = to_place(primary, &mapped.map, [0; 2]);
        let base = bend.shape(&primary.base().moved(to_place))?;
        let mask = pixels::mask(&base.outline);
        (!mask.is_empty()).then_some(Self { bend, primary, to_place, base, mask })
    }

    /// All its shapes, and its pixels.
    pub(super) fn into_shapes(self) -> (Vec<Shape>, Mask) {
        let details = self.primary.details().iter().map(|detail| detail.moved(self.to_place));
        let bent = details.filter_map(|detail| self.bend.shape(&detail));
        (std::iter::once(self.base).chain(bent).collect(), self.mask)
    }
}

/// Distance from a point to the farthest pixel of a mask in a direction.
fn radius(mask: &Mask, from: Point, way: Vec2) -> f64 {
    const STEP: f64 = 0.5;
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return 0.0 };
    let corners =
        [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| Point::new(f64::from(x), f64::from(y)));
    let farthest = corners.iter().map(|corner| corner.distance(from)).fold(0.0, f64::max);
    let steps = (farthest / STEP) as i32;
    let is_inside = |k: &i32| {
        let p = from + way * (f64::from(*k) * STEP);
        mask.contains(libm::floor(p.x) as i32, libm::floor(p.y) as i32)
    };
    (1..=steps).rev().find(is_inside).map_or(0.0, |k| f64::from(k) * STEP)
}

#[cfg(test)]
mod tests {
    use super::super::resolve::union;
    use super::*;
    use vtex_base::geometry::parse_path;
    use vtex_base::raster::Span;

    /// Pixels whose radius about the origin is at most that of their angle.
    fn mask(radius: impl Fn(f64) -> f64) -> Mask {
        let inside = |x: i32, y: i32| {
            let [u, v] = [x, y].map(|v| f64::from(v) + 0.5);
            libm::hypot(u, v) <= radius(libm::atan2(v, u))
        };
        let all = (-60..60).flat_map(|y| (-60..60).map(move |x| (x, y)));
        let pixels = all.filter(|&(x, y)| inside(x, y));
        Mask::from_spans(pixels.map(|(x, y)| Span { y, x0: x, x1: x + 1 }).collect())
    }

    #[test]
    fn a_bent_outline_is_nearer_and_no_radius_changes_much() {
        let disc = mask(|_| 30.0);
        let outline = Outline::new(
            &parse_path("M30 0C30 16.6 16.6 30 0 30C-16.6 30-30 16.6-30 0C-30-16.6-16.6-30 0-30C16.6-30 30-16.6 30 0z").unwrap(),
        );
        let wanted = mask(|angle| 30.0 * (1.0 + 0.1 * libm::cos(3.0 * angle)));
        let bend = Bend::onto(&disc, &wanted, 1.0).unwrap();
        let bent = pixels::mask(&bend.outline(&outline.unwrap()).unwrap());
        let (after, before) = (union(&bent, &wanted, [0; 2]), union(&disc, &wanted, [0; 2]));
        assert!(after > 0.97 && before < 0.9, "{after} {before}");
        // Radii that are much too short become as long as is permitted.
        let far = Bend::onto(&disc, &mask(|_| 55.0), 1.0).unwrap();
        assert!((far.point(Point::new(0.0, 30.0)).y - 30.0 * FACTORS[1]).abs() < 0.2);
    }
}
