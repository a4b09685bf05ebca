//! The part of a canvas around a region that is filled beside what stands.

use super::plane::PeriodicPlane;
use super::{Interior, Outline, Point};
use crate::parallel;

/// Most cells of the grid on which areas are measured, along an axis.
const MOST_CELLS: f64 = 1000.0;

/// A window of a canvas around a region. Places are those of the window, from its corner.
#[derive(Debug)]
pub struct RegionWindow {
    /// Its plane, which does not repeat.
    pub plane: PeriodicPlane,
    /// Its corner on the canvas.
    pub low: [f64; 2],
    canvas: [f64; 2],
    region: Interior,
    /// Middle of the bounds of the region, on the canvas.
    middle: Point,
}

impl RegionWindow {
    /// The window that reaches `around` beyond the part of a region that lies on a canvas of a size.
    pub fn new(region: &Outline, canvas: [f64; 2], around: f64) -> Self {
        let bounds = region.bounds();
        let ends = [[bounds.x0, bounds.x1], [bounds.y0, bounds.y1]];
        let corner = |end: usize, by: f64| [0, 1].map(|k| ends[k][end].clamp(0.0, canvas[k]) + by);
        let (low, high) = (corner(0, -around), corner(1, around));
        let size = [high[0] - low[0], high[1] - low[1]];
        let plane = PeriodicPlane { size, wraps: [false; 2] };
        Self { plane, low, canvas, region: Interior::new(region), middle: bounds.center() }
    }

    /// Whether a place lies on the window.
    pub fn holds(&self, at: [f64; 2]) -> bool {
        (0..2).all(|k| (0.0..=self.plane.size[k]).contains(&at[k]))
    }

    /// Whether a place lies in the region. What lies beyond the canvas counts as the nearest place on it.
    pub fn is_inside(&self, at: [f64; 2]) -> bool {
        self.region.contains_on(self.canvas, Point::new(at[0] + self.low[0], at[1] + self.low[1]))
    }

    /// Whether a place lies on the canvas, or up to `margin` beyond it.
    pub fn is_on_canvas(&self, at: [f64; 2], margin: f64) -> bool {
        (0..2).all(|k| (-margin..=self.canvas[k] + margin).contains(&(at[k] + self.low[k])))
    }

    /// The way from a place of the window to that of a drawing of which a part is laid on the region, middle on middle.
    pub fn way_to(&self, part: &Outline) -> [f64; 2] {
        let way = part.bounds().center() - self.middle;
        [way.x + self.low[0], way.y + self.low[1]]
    }

    /// Area of the places that satisfy a condition, on a grid of a step, of at most [`MOST_CELLS`] cells along an axis.
    pub fn area_of(&self, step: f64, condition: impl Fn([f64; 2]) -> bool + Sync + Send) -> f64 {
        let size = self.plane.size;
        let count = size.map(|side| libm::ceil(side / step).clamp(1.0, MOST_CELLS));
        let rows: Vec<usize> = (0..count[1] as usize).collect();
        let in_row = parallel::map(&rows, |row| {
            let y = (*row as f64 + 0.5) * size[1] / count[1];
            let at = |column: usize| [(column as f64 + 0.5) * size[0] / count[0], y];
            (0..count[0] as usize).filter(|c| condition(at(*c))).count()
        });
        in_row.into_iter().sum::<usize>() as f64 / (count[0] * count[1]) * self.plane.area()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::parse_path;

    #[test]
    fn a_window_ends_around_what_the_canvas_shows_of_a_region() {
        let outline = |d: &str| Outline::new(&parse_path(d).unwrap()).unwrap();
        let window = RegionWindow::new(&outline("M60 20H140V60H60Z"), [100.0, 80.0], 10.0);
        assert_eq!((window.low, window.plane.size), ([50.0, 10.0], [60.0, 60.0]));
        assert!(window.holds([60.0, 0.0]) && !window.holds([60.1, 0.0]));
        // Beside the canvas the region goes on, above it does not begin.
        assert!(window.is_inside([55.0, 30.0]) && !window.is_inside([55.0, 5.0]));
        assert!(window.is_on_canvas([50.0, 30.0], 0.0) && !window.is_on_canvas([55.0, 30.0], 4.0));
        assert_eq!(window.way_to(&outline("M0 0H20V20H0Z")), [-40.0, -20.0]);
        let area = window.area_of(0.5, |at| window.is_inside(at));
        assert!((area - 2000.0).abs() < 1.0, "{area}");
    }
}
