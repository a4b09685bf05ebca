//! Tiling scenes, and the copies of their contents.
//!
//! Opposite edges of a tiling scene are joined: left and right for [`Tile::x`], top and bottom for
//! [`Tile::y`]. An instance is listed once, with its origin on or near the canvas, and stands for all its
//! copies, shifted by whole widths and heights of the canvas. The same holds for control points of the
//! background and for the outline of a domain. Code that draws a scene asks [`Scene::copies`] which copies
//! reach the canvas and draws them directly after the original, so two overlapping textons overlap alike at
//! every edge. Where copies are stacked, as scales in rows are, it draws them by [`Scene::height`].

use super::{Instance, Scene};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Point, Rect, Vec2, wrapped};

/// The axes along which a scene repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tile {
    /// The left edge joins the right edge.
    pub x: bool,
    /// The top edge joins the bottom edge.
    pub y: bool,
}

/// Largest number of copies along an axis. Broader shapes are hardly recognised as repeating, and a
/// hostile file must not request trillions.
const MOST_COPIES: f64 = 64.0;

impl Tile {
    /// Whether a scene repeats along any axis.
    pub fn any(self) -> bool {
        self.x || self.y
    }

    /// Whether a scene repeats along both axes.
    pub fn both(self) -> bool {
        self.x && self.y
    }

    /// Period along each axis of a canvas of the given width and height; `None` along an axis that does
    /// not repeat.
    pub fn periods<T>(self, [width, height]: [T; 2]) -> [Option<T>; 2] {
        [self.x.then_some(width), self.y.then_some(height)]
    }
}

impl Scene {
    /// Whether originals and copies of a layer are painted by their height.
    pub fn is_stacked(&self) -> bool {
        self.stacking != [0; 2] && self.tile.any()
    }

    /// The height of a copy of an instance with this shift.
    pub fn height(&self, instance: &Instance, shift: Vec2) -> i64 {
        i64::from(instance.height) + self.height_of_copy(shift)
    }

    /// What the height of a copy with this shift is more than that of its original.
    pub fn height_of_copy(&self, shift: Vec2) -> i64 {
        let count = [shift.x / f64::from(self.width), shift.y / f64::from(self.height)];
        let along = |k: usize| i64::from(self.stacking[k]) * libm::round(count[k]) as i64;
        along(0) + along(1)
    }

    /// Period along each axis, in pixels; `None` along an axis that does not repeat.
    pub fn periods(&self) -> [Option<f64>; 2] {
        self.tile.periods([f64::from(self.width), f64::from(self.height)])
    }

    /// The place of an instance: its origin, wrapped onto the canvas where the scene repeats.
    pub fn place(&self, instance: &Instance) -> Point {
        let [.., x, y] = instance.transform;
        self.on_canvas(Point::new(x, y))
    }

    /// A point, moved onto the canvas where the scene repeats.
    pub fn on_canvas(&self, p: Point) -> Point {
        let [width, height] = self.periods();
        Point::new(wrapped(p.x, width), wrapped(p.y, height))
    }

    /// Shifts, in pixels, at which content with the given bounds is drawn. The first is zero, for the
    /// original, wherever it is; the others are those of the copies that reach the canvas, by row and column.
    /// A scene that does not tile has only the first. At most 64 copies along an axis.
    pub fn copies(&self, bounds: Rect) -> impl Iterator<Item = Vec2> + use<> {
        let axis = |repeats: bool, low: f64, high: f64, size: u32| {
            let size = f64::from(size);
            if !(repeats && low.is_finite() && high.is_finite()) {
                return (0, 1, size);
            }
            // Copy k overlaps the canvas if low + k·size < size and high + k·size > 0.
            let first = libm::floor(-high / size) + 1.0;
            let end = libm::ceil((size - low) / size).min(first + MOST_COPIES);
            (first as i64, end as i64, size)
        };
        let (left, right, width) = axis(self.tile.x, bounds.x0, bounds.x1, self.width);
        let (top, bottom, height) = axis(self.tile.y, bounds.y0, bounds.y1, self.height);
        let all = (top..bottom).flat_map(move |j| (left..right).map(move |i| (i, j)));
        let shift = move |(i, j): (i64, i64)| Vec2::new(i as f64 * width, j as f64 * height);
        std::iter::once(Vec2::ZERO).chain(all.filter(|&copy| copy != (0, 0)).map(shift))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::testing;
    use vtex_base::raster::colour::Colour;

    fn scene(x: bool, y: bool) -> Scene {
        let field = testing::flat(Colour([0; 3]));
        Scene { tile: Tile { x, y }, ..testing::scene([100, 60], Vec::new(), Vec::new(), Vec::new(), field) }
    }

    fn copies(x: bool, y: bool, bounds: [f64; 4]) -> Vec<[f64; 2]> {
        let [x0, y0, x1, y1] = bounds;
        scene(x, y).copies(Rect::new(x0, y0, x1, y1)).map(|v| [v.x, v.y]).collect()
    }

    #[test]
    fn copies_are_those_that_reach_the_canvas() {
        let inside = [10.0, 10.0, 100.0, 60.0];
        let corner = [90.0, 50.0, 110.0, 70.0];
        assert_eq!(copies(true, true, inside), [[0.0, 0.0]]);
        assert_eq!(copies(false, false, corner), [[0.0, 0.0]]);
        assert_eq!(copies(true, false, corner), [[0.0, 0.0], [-100.0, 0.0]]);
        assert_eq!(copies(false, true, corner), [[0.0, 0.0], [0.0, -60.0]]);
        assert_eq!(copies(true, true, corner), [[0.0, 0.0], [-100.0, -60.0], [0.0, -60.0], [-100.0, 0.0]]);
        // The original comes first even if it is listed beyond the canvas.
        assert_eq!(copies(true, false, [210.0, 0.0, 230.0, 9.0]), [[0.0, 0.0], [-200.0, 0.0]]);
    }

    #[test]
    fn every_copy_on_the_canvas_is_found() {
        for k in 0..200 {
            let (x, y) = (f64::from(k) * 7.3 - 500.0, f64::from(k) * 3.1 - 300.0);
            let (w, h) = (f64::from(k % 17) * 21.0 + 0.5, f64::from(k % 5) * 40.0 + 0.5);
            let found = copies(true, true, [x, y, x + w, y + h]);
            let meets = |i: i32, j: i32| {
                let (dx, dy) = (f64::from(i) * 100.0, f64::from(j) * 60.0);
                (x + dx < 100.0 && x + w + dx > 0.0 && y + dy < 60.0 && y + h + dy > 0.0) || (i, j) == (0, 0)
            };
            let all = (-20..20).flat_map(|j| (-20..20).map(move |i| (i, j)));
            assert_eq!(found.len(), all.filter(|&(i, j)| meets(i, j)).count());
        }
    }

    #[test]
    fn hostile_bounds_end() {
        let count = |bounds| copies(true, true, bounds).len();
        assert!(count([-1e7, -1e7, 1e7, 1e7]) <= 64 * 64 + 1);
        assert_eq!(count([f64::NEG_INFINITY, 0.0, f64::INFINITY, f64::NAN]), 1);
        assert_eq!(count([1e300, 1e300, 1e300, 1e300]), 1);
    }
}
