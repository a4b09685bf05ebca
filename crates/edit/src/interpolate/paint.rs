//! Interpolation of colours and gradients.

use vtex_base::geometry::Point;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Gradient, GradientKind, Stop};

/// A shape's fill. A gradient replaces the colour.
#[derive(Clone)]
pub(super) struct ShapePaint {
    pub(super) colour: Colour,
    pub(super) gradient: Option<Gradient>,
}

impl ShapePaint {
    /// The paint with its gradient's end points mapped by `carry`.
    pub(super) fn carried(&self, carry: impl Fn(Point) -> Point) -> Self {
        let gradient = self.gradient.as_ref().map(|g| g.carried(&carry));
        Self { gradient: gradient.filter(|g| g.fault().is_none()), ..*self }
    }

    /// The paint at time `t` (0 to 1) towards another. Colours are mixed in Oklab.
    pub(super) fn mixed(&self, other: &Self, t: f64) -> Self {
        let colour = self.colour.mixed(other.colour, t);
        let gradient = match (&self.gradient, &other.gradient) {
            (None, None) => None,
            (Some(a), None) => Some(gradients(a, &flat(a, other.colour), t)),
            (None, Some(b)) => Some(gradients(&flat(b, self.colour), b, t)),
            (Some(a), Some(b)) => Some(gradients(a, b, t)),
        };
        Self { colour, gradient: gradient.filter(|g| g.fault().is_none()) }
    }
}

/// A gradient of one colour, like another otherwise.
fn flat(like: &Gradient, colour: Colour) -> Gradient {
    like.recoloured(|_| colour)
}

/// The gradient between two. Of a linear and a radial one, it has the kind of the nearer.
fn gradients(a: &Gradient, b: &Gradient, t: f64) -> Gradient {
    let direction = |g: &Gradient| [g.to[0] - g.from[0], g.to[1] - g.from[1]];
    let (u, v) = (direction(a), direction(b));
    // Reverse the second if both would cancel out.
    let opposite = u[0] * v[0] + u[1] * v[1] < 0.0;
    let linear = [a, b].iter().all(|g| g.kind == GradientKind::Linear);
    let b = if opposite && linear { &reversed(b) } else { b };
    let between = |a: [f64; 2], b: [f64; 2]| [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
    let mut offsets: Vec<f64> = a.between.iter().chain(&b.between).map(|s| s.offset).collect();
    offsets.sort_by(f64::total_cmp);
    let stop = |offset: f64| {
        let [from, to] = [a, b].map(|g| at(g, offset));
        let opacity = from.opacity + (to.opacity - from.opacity) * t;
        Stop { offset, colour: from.colour.mixed(to.colour, t), opacity }
    };
    Gradient {
        kind: if t < 0.5 { a.kind } else { b.kind },
        from: between(a.from, b.from),
        to: between(a.to, b.to),
        start: a.start.mixed(b.start, t),
        end: a.end.mixed(b.end, t),
        between: offsets.into_iter().map(stop).collect(),
        opacities: between(a.opacities, b.opacities),
    }
}

/// The same linear gradient, described from its other end.
fn reversed(g: &Gradient) -> Gradient {
    let between = g.between.iter().rev().map(|s| Stop { offset: 1.0 - s.offset, ..*s });
    let [first, last] = g.opacities;
    Gradient {
        from: g.to,
        to: g.from,
        start: g.end,
        end: g.start,
        between: between.collect(),
        opacities: [last, first],
        ..*g
    }
}

/// The colour of a gradient at an offset, as renderers mix it.
fn at(g: &Gradient, offset: f64) -> Stop {
    let mut before = Stop { offset: 0.0, colour: g.start, opacity: g.opacities[0] };
    for after in g.stops() {
        if after.offset >= offset {
            let span = after.offset - before.offset;
            let t = if span > 0.0 { (offset - before.offset) / span } else { 1.0 };
            let (a, b) = (before.colour.to_f64(), after.colour.to_f64());
            let colour = Colour::from_f64([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t));
            return Stop { offset, colour, opacity: before.opacity + (after.opacity - before.opacity) * t };
        }
        before = after;
    }
    Stop { offset, ..before }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_gradients_do_not_vanish() {
        let grey = |v: u8| Colour([v; 3]);
        let gradient = |from, to, a, b| Gradient::linear([from, 0.0], [to, 0.0], [grey(a), grey(b)]);
        let a = ShapePaint { colour: grey(90), gradient: Some(gradient(0.0, 10.0, 0, 200)) };
        let b = ShapePaint { colour: grey(90), gradient: Some(gradient(12.0, 2.0, 0, 200)) };
        let half = a.mixed(&b, 0.5).gradient.unwrap();
        assert_eq!((half.from, half.to), ([1.0, 0.0], [11.0, 0.0]));
        assert_eq!(half.start, half.end);
        let plain = ShapePaint { colour: grey(50), gradient: None };
        assert_eq!(a.mixed(&plain, 0.0).gradient, a.gradient);
        let end = a.mixed(&plain, 1.0).gradient.unwrap();
        assert_eq!((end.start, end.end), (grey(50), grey(50)));
    }
}
