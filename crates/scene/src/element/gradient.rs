//! Linear and radial gradients.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Affine, Point};
use vtex_base::raster::colour::Colour;

/// A gradient in sRGB components, as in SVG: `start` before its first point, `end` after its last point,
/// linear between these and the stops between them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Whether it changes along a line or outwards from a point.
    #[serde(default, skip_serializing_if = "GradientKind::is_linear")]
    pub kind: GradientKind,
    /// Point where the change begins, in the coordinates of the shape that it fills; the centre of a
    /// radial gradient.
    pub from: [f64; 2],
    /// Point where the change ends; of a radial gradient, a point of the circle on which it ends.
    pub to: [f64; 2],
    /// The colour where it begins.
    pub start: Colour,
    /// The colour where it ends.
    pub end: Colour,
    /// Stops between the two, by rising offset.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub between: Vec<Stop>,
    /// Opacity where it begins and where it ends, 0 to 1. Default 1 and 1.
    #[serde(default = "opaque", skip_serializing_if = "is_opaque")]
    pub opacities: [f64; 2],
}

/// Whether a gradient changes along a line or outwards from a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum GradientKind {
    /// Along a line; constant at right angles to it.
    #[default]
    Linear,
    /// Outwards from a centre; constant on circles around it.
    Radial,
}

impl GradientKind {
    fn is_linear(&self) -> bool {
        *self == Self::Linear
    }
}

/// A colour at a place of a gradient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Offset from the first to the last point of the gradient, 0 to 1.
    pub offset: f64,
    /// The colour there.
    pub colour: Colour,
    /// Opacity there, 0 to 1. Default 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub opacity: f64,
}

fn one() -> f64 {
    1.0
}

fn is_one(opacity: &f64) -> bool {
    *opacity == 1.0
}

fn opaque() -> [f64; 2] {
    [1.0; 2]
}

fn is_opaque(opacities: &[f64; 2]) -> bool {
    *opacities == opaque()
}

impl Gradient {
    /// An opaque linear gradient of two colours.
    pub fn linear(from: [f64; 2], to: [f64; 2], [start, end]: [Colour; 2]) -> Self {
        let kind = GradientKind::Linear;
        Self { kind, from, to, start, end, between: Vec::new(), opacities: opaque() }
    }

    /// All stops by rising offset, those at 0 and at 1 included.
    pub fn stops(&self) -> impl Iterator<Item = Stop> {
        let [first, last] = self.opacities;
        let stop = |offset, colour, opacity| std::iter::once(Stop { offset, colour, opacity });
        let between = self.between.iter().copied();
        stop(0.0, self.start, first).chain(between).chain(stop(1.0, self.end, last))
    }

    /// The gradient of a transformed shape. Exact for transforms that preserve angles.
    pub fn moved(&self, affine: Affine) -> Self {
        self.carried(|p| affine * p)
    }

    /// The gradient of a shape drawn by any map; `None` if the result cannot be stored.
    pub fn drawn(&self, map: Affine) -> Option<Box<Self>> {
        let moved = self.moved(map);
        moved.fault().is_none().then(|| Box::new(moved))
    }

    /// The gradient with its two points mapped.
    pub fn carried(&self, map: impl Fn(Point) -> Point) -> Self {
        let [from, to] = [self.from, self.to].map(|[x, y]| {
            let p = map(Point::new(x, y));
            [p.x, p.y]
        });
        Self { from, to, ..self.clone() }
    }

    /// The gradient with all its colours changed.
    pub fn recoloured(&self, new: impl Fn(Colour) -> Colour) -> Self {
        let between = self.between.iter().map(|stop| Stop { colour: new(stop.colour), ..*stop });
        Self { start: new(self.start), end: new(self.end), between: between.collect(), ..*self }
    }

    /// Why the gradient is invalid; `None` if it is valid.
    pub fn fault(&self) -> Option<String> {
        let [from, to] = [self.from, self.to];
        let far = [from, to].iter().flatten().any(|v| v.is_nan() || v.abs() >= 1e7);
        if far || from == to {
            return Some(format!("from {from:?} to {to:?} is no way within 10 million pixels"));
        }
        let share = |v: f64| (0.0..=1.0).contains(&v);
        if self.stops().any(|s| !share(s.offset) || !share(s.opacity)) {
            return Some("has an offset or an opacity beyond 0 to 1".into());
        }
        let rising = self.between.is_sorted_by(|a, b| a.offset <= b.offset);
        (!rising).then(|| "has stops that do not rise".into())
    }
}
