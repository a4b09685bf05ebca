//! Interpolation of colours and gradients.

use crate::geometry::Point;
use crate::raster::colour::Colour;
use crate::scene::Gradient;

/// A shape's fill. A gradient replaces the colour.
#[derive(Clone, Copy)]
pub(super) struct Paint {
    pub(super) colour: Colour,
    pub(super) gradient: Option<Gradient>,
}

impl Paint {
    /// The paint with its gradient's end points mapped by `carry`.
    pub(super) fn carried(&self, carry: impl Fn(Point) -> Point) -> Self {
        let gradient = self.gradient.map(|g| {
            let [from, to] = [g.from, g.to].map(|[x, y]| carry(Point::new(x, y)));
            Gradient { from: [from.x, from.y], to: [to.x, to.y], ..g }
        });
        Self { gradient: gradient.filter(|g| g.fault().is_none()), ..*self }
    }

    /// The paint at time `t` (0 to 1) towards another. Colours are mixed in Oklab.
    pub(super) fn mixed(&self, other: &Self, t: f64) -> Self {
        let colour = self.colour.mixed(other.colour, t);
        let gradient = match (self.gradient, other.gradient) {
            (None, None) => None,
            (Some(a), None) => Some(gradients(&a, &flat(&a, other.colour), t)),
            (None, Some(b)) => Some(gradients(&flat(&b, self.colour), &b, t)),
            (Some(a), Some(b)) => Some(gradients(&a, &b, t)),
        };
        Self { colour, gradient: gradient.filter(|g| g.fault().is_none()) }
    }
}

/// A gradient of one colour with the end points of `like`.
fn flat(like: &Gradient, colour: Colour) -> Gradient {
    Gradient { start: colour, end: colour, ..*like }
}

fn gradients(a: &Gradient, b: &Gradient, t: f64) -> Gradient {
    let direction = |g: &Gradient| [g.to[0] - g.from[0], g.to[1] - g.from[1]];
    let (u, v) = (direction(a), direction(b));
    // Reverse the second if both would cancel out.
    let b = if u[0] * v[0] + u[1] * v[1] < 0.0 {
        Gradient { from: b.to, to: b.from, start: b.end, end: b.start }
    } else {
        *b
    };
    let between = |a: [f64; 2], b: [f64; 2]| [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
    Gradient {
        from: between(a.from, b.from),
        to: between(a.to, b.to),
        start: a.start.mixed(b.start, t),
        end: a.end.mixed(b.end, t),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_gradients_do_not_vanish() {
        let grey = |v: u8| Colour([v; 3]);
        let gradient =
            |from, to, a, b| Gradient { from: [from, 0.0], to: [to, 0.0], start: grey(a), end: grey(b) };
        let a = Paint { colour: grey(90), gradient: Some(gradient(0.0, 10.0, 0, 200)) };
        let b = Paint { colour: grey(90), gradient: Some(gradient(12.0, 2.0, 0, 200)) };
        let half = a.mixed(&b, 0.5).gradient.unwrap();
        assert_eq!((half.from, half.to), ([1.0, 0.0], [11.0, 0.0]));
        assert_eq!(half.start, half.end);
        let plain = Paint { colour: grey(50), gradient: None };
        assert_eq!(a.mixed(&plain, 0.0).gradient, a.gradient);
        let end = a.mixed(&plain, 1.0).gradient.unwrap();
        assert_eq!((end.start, end.end), (grey(50), grey(50)));
    }
}
