//! How far along the way things are, everywhere alike or from one side of the canvas to the other.

use crate::geometry::Point;
use crate::scene::Axis;

/// Share of the canvas at either side that shows one scene alone.
const PURE: f64 = 0.1;

/// How far along the way things are: 0 at the first scene, 1 at the second.
pub(super) enum When {
    /// Everywhere alike.
    Now(f64),
    /// From one side to the other of a canvas that is so long along the axis, in pixels.
    Across(Axis, f64),
}

impl When {
    /// At a place.
    pub(super) fn at(&self, p: Point) -> f64 {
        match *self {
            Self::Now(t) => t,
            Self::Across(axis, length) => {
                let along = if axis == Axis::X { p.x } else { p.y };
                ((along / length - PURE) / (1.0 - 2.0 * PURE)).clamp(0.0, 1.0)
            }
        }
    }

    /// Of something that moves from one place to another: where it is as far along its way as its
    /// place says.
    pub(super) fn on_way(&self, [from, to]: [Point; 2]) -> f64 {
        if let Self::Now(t) = *self {
            return t;
        }
        if self.at(from) <= 0.0 {
            return 0.0;
        }
        if self.at(to) >= 1.0 {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..20 {
            let middle = (low + high) / 2.0;
            if self.at(from.lerp(to, middle)) > middle { low = middle } else { high = middle }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_is_as_far_as_its_place_says() {
        let across = When::Across(Axis::X, 100.0);
        assert_eq!((across.at(Point::new(5.0, 0.0)), across.at(Point::new(95.0, 0.0))), (0.0, 1.0));
        for (a, b) in [(30.0, 50.0), (60.0, 20.0), (45.0, 45.0)] {
            let ends = [Point::new(a, 7.0), Point::new(b, 9.0)];
            let t = across.on_way(ends);
            assert!((across.at(ends[0].lerp(ends[1], t)) - t).abs() < 1e-4);
        }
        assert_eq!(across.on_way([Point::new(4.0, 0.0), Point::new(30.0, 0.0)]), 0.0);
        let down = When::Across(Axis::Y, 100.0);
        assert_eq!(down.at(Point::new(99.0, 50.0)), 0.5);
    }
}
