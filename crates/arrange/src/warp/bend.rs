//! The map from a scene to its warped form.

use kurbo::Shape;
use vtex_base::Parameter;
use vtex_base::error::Result;
use vtex_base::geometry::{Cage, Outline, PathEl, Point};
use vtex_scene::scene::{Element, Instance, Scene};

/// Longest segment of a domain that is bent as one, in pixels.
const LONGEST: f64 = 16.0;

/// A bend: the image of each point, the part of the scene that is kept, and the resulting canvas.
#[derive(Clone, Debug)]
pub struct Bend {
    canvas: [u32; 2],
    how: BendKind,
}

#[derive(Clone, Debug)]
enum BendKind {
    Scaled([f64; 2]),
    Caged { cage: Cage, before: Outline, after: Outline },
}

impl Bend {
    /// Factors of [`Bend::scale`].
    pub const FACTORS: Parameter<f64> = Parameter::new("scale", [0.1, 10.0], "each");

    /// Scales the canvas of `scene` along both axes.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] for a factor out of range.
    pub fn scale(scene: &Scene, factors: [f64; 2]) -> Result<Self> {
        factors.into_iter().try_for_each(|factor| Self::FACTORS.check(factor))?;
        let side = |size: u32, factor: f64| libm::round(f64::from(size) * factor).max(1.0) as u32;
        let canvas = [side(scene.width, factors[0]), side(scene.height, factors[1])];
        Ok(Self { canvas, how: BendKind::Scaled(factors) })
    }

    /// Deforms the content of the cage `before` with it into the cage `after`, on a canvas of a given size
    /// in pixels. A scene without a domain is cut out by the first cage and fills the second. The domain of
    /// a scene is bent.
    ///
    /// # Errors
    /// [`vtex_base::Error::Cages`] if they do not correspond; see [`Cage::new`].
    pub fn cage(before: Outline, after: Outline, canvas: [u32; 2]) -> Result<Self> {
        let cage = Cage::new(&before, &after)?;
        Ok(Self { canvas, how: BendKind::Caged { cage, before, after } })
    }

    /// Size of the resulting canvas, in pixels.
    pub(super) fn canvas(&self) -> [u32; 2] {
        self.canvas
    }

    /// The image of a point.
    pub(super) fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        match &self.how {
            BendKind::Scaled([sx, sy]) => [x * sx, y * sy],
            BendKind::Caged { cage, .. } => {
                let p = cage.map(Point::new(x, y));
                // The map is unbounded far outside the cage.
                [p.x, p.y].map(|v| if v.is_finite() { v.clamp(-1e6, 1e6) } else { 1e6 })
            }
        }
    }

    /// Largest factor by which distances grow around a point, over all directions.
    pub(super) fn stretch(&self, [x, y]: [f64; 2]) -> f64 {
        const STEP: f64 = 0.5;
        let difference = |dx: f64, dy: f64| {
            let [a, b] = [self.point([x - dx, y - dy]), self.point([x + dx, y + dy])];
            [0, 1].map(|k| (b[k] - a[k]) / (2.0 * STEP))
        };
        let ([a, b], [c, d]) = (difference(STEP, 0.0), difference(0.0, STEP));
        // The larger singular value.
        let sum = a * a + b * b + c * c + d * d;
        let determinant = a * d - b * c;
        let root = libm::sqrt((sum * sum - 4.0 * determinant * determinant).max(0.0));
        libm::sqrt((sum + root) / 2.0)
    }

    /// Whether a point is in the part of the scene that is kept.
    pub(super) fn holds(&self, [x, y]: [f64; 2]) -> bool {
        match &self.how {
            BendKind::Scaled(_) => true,
            BendKind::Caged { before, .. } => before.path().contains(Point::new(x, y)),
        }
    }

    /// The image of an instance's origin; `None` if no part of it is kept.
    pub(super) fn texton(&self, instance: &Instance, element: &Element) -> Option<[f64; 2]> {
        let [.., x, y] = instance.transform;
        let affine = instance.affine();
        let ends = || element.outline().path().elements().iter().filter_map(PathEl::end_point);
        let inside = self.holds([x, y])
            || ends().any(|p| {
                let p = affine * p;
                self.holds([p.x, p.y])
            });
        inside.then(|| self.point([x, y]))
    }

    /// The domain of the result; `None` if it is the whole canvas.
    pub(super) fn domain(&self, scene: &Scene) -> Option<Outline> {
        match (&scene.domain, &self.how) {
            (Some(domain), _) => domain.outline.carried(LONGEST, |p| {
                let [x, y] = self.point([p.x, p.y]);
                Point::new(x, y)
            }),
            (None, BendKind::Caged { after, .. }) => Some(after.clone()),
            (None, BendKind::Scaled(_)) => None,
        }
    }
}
