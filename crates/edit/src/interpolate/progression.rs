//! The progress of an interpolation: uniform over the canvas, or varying across it. A moving item has the
//! progress of the point where it then is.

use vtex_base::geometry::{Point, Vec2};
use vtex_base::raster::ControlMap;
use vtex_scene::scene::Axis;

/// Share of the canvas at either side that shows only one scene.
const MARGIN: f64 = 0.1;

/// Progress of an interpolation at each point of the canvas: 0 is the first scene, 1 the second.
pub(super) enum Progression {
    /// The same everywhere.
    Uniform(f64),
    /// From one side to the other of a canvas of the given length along the axis, in pixels.
    Across(Axis, f64),
    /// From the middle of a canvas of the given width and height to the ellipse that touches its sides.
    Radial([f64; 2]),
    /// By a map, 0 to 1, stretched over a canvas of the given width and height.
    Map(ControlMap, [f64; 2]),
}

/// Progress along a way from one end to the other, which both have a margin.
fn along(share: f64) -> f64 {
    ((share - MARGIN) / (1.0 - 2.0 * MARGIN)).clamp(0.0, 1.0)
}

impl Progression {
    /// The progress at a point.
    pub(super) fn at(&self, p: Point) -> f64 {
        match self {
            Self::Uniform(t) => *t,
            Self::Across(axis, length) => along(if *axis == Axis::X { p.x } else { p.y } / length),
            Self::Radial([width, height]) => {
                let out = Vec2::new(2.0 * p.x / width - 1.0, 2.0 * p.y / height - 1.0);
                along(libm::sqrt(out.hypot2()))
            }
            Self::Map(map, canvas) => map.at([p.x, p.y], *canvas).clamp(0.0, 1.0),
        }
    }

    /// The progress of an item that moves between two points: it equals the progress at the point where
    /// the item then is.
    pub(super) fn between(&self, [from, to]: [Point; 2]) -> f64 {
        if let Self::Uniform(t) = *self {
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
        let across = Progression::Across(Axis::X, 100.0);
        assert_eq!((across.at(Point::new(5.0, 0.0)), across.at(Point::new(95.0, 0.0))), (0.0, 1.0));
        for (a, b) in [(30.0, 50.0), (60.0, 20.0), (45.0, 45.0)] {
            let ends = [Point::new(a, 7.0), Point::new(b, 9.0)];
            let t = across.between(ends);
            assert!((across.at(ends[0].lerp(ends[1], t)) - t).abs() < 1e-4);
        }
        assert_eq!(across.between([Point::new(4.0, 0.0), Point::new(30.0, 0.0)]), 0.0);
        let down = Progression::Across(Axis::Y, 100.0);
        assert_eq!(down.at(Point::new(99.0, 50.0)), 0.5);
        let radial = Progression::Radial([100.0, 60.0]);
        assert_eq!((radial.at(Point::new(50.0, 30.0)), radial.at(Point::new(50.0, 0.0))), (0.0, 1.0));
        assert_eq!((radial.at(Point::new(0.0, 0.0)), radial.at(Point::new(75.0, 30.0))), (1.0, 0.5));
        let map = Progression::Map(ControlMap::new(2, 1, vec![0.0, 1.0]).unwrap(), [100.0, 60.0]);
        let ends = [Point::new(30.0, 7.0), Point::new(70.0, 9.0)];
        let t = map.between(ends);
        assert!((map.at(ends[0].lerp(ends[1], t)) - t).abs() < 1e-4);
    }
}
