//! How evenly elements are spread: each weighs on those around it, the more the nearer it is.

use vtex_base::error::Result;
use vtex_base::geometry::{NearPoints, Point, shortest_offset};

/// Distance up to which elements weigh on one another, in units of the mean distance between elements.
const REACH: f64 = 2.0;
/// Most elements around a place that are looked at, five times the usual number. It bounds the work on crowds.
const MOST_AROUND: usize = 256;

/// The places of elements, and how far they may be from those by which they are found.
pub(super) struct Spread {
    places: Vec<Point>,
    near: NearPoints,
    periods: [Option<f64>; 2],
    /// Distance up to which elements weigh on one another, in pixels.
    reach: f64,
    /// Farthest that a place may be from that by which it is found, in pixels.
    farthest: f64,
}

impl Spread {
    /// Places of elements whose mean distance is `spacing`. Each may be set once, at most `farthest` away.
    pub(super) fn new(places: Vec<Point>, periods: [Option<f64>; 2], spacing: f64, farthest: f64) -> Self {
        let reach = REACH * spacing;
        let near = NearPoints::new(&places, periods, reach + farthest);
        Self { places, near, periods, reach, farthest }
    }

    /// The same places, each of which may be set once more.
    pub(super) fn settled(self) -> Self {
        let near = NearPoints::new(&self.places, self.periods, self.reach + self.farthest);
        Self { near, ..self }
    }

    /// Moves an element.
    pub(super) fn set(&mut self, element: usize, place: Point) {
        self.places[element] = place;
    }

    /// What all others weigh on an element if it is at `place`: each from 1 at the same place to 0 out of reach, by
    /// Wendland's function. Its Fourier transform is positive, so that no clumps have the least weight.
    pub(super) fn load(&self, element: usize, place: Point) -> f64 {
        let (mut load, mut left) = (0.0, MOST_AROUND);
        self.near.each_while(place, |other| {
            if other != element {
                let apart = shortest_offset(place, self.places[other], self.periods).hypot() / self.reach;
                let rest = (1.0 - apart).max(0.0);
                let square = rest * rest;
                load += square * square * (1.0 + 4.0 * apart);
            }
            left -= 1;
            left > 0
        });
        load
    }

    /// The sum of what weighs on some elements. Calls `go_on` before each.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn loads(&self, elements: &[usize], go_on: impl Fn() -> Result<()>) -> Result<f64> {
        let load = |&i: &usize| go_on().map(|()| self.load(i, self.places[i]));
        elements.iter().map(load).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places of a square lattice of 8 × 8 at distances of 10, every second column moved by `by`.
    fn spread(by: f64) -> Spread {
        let at = |k: usize| Point::new((k % 8) as f64 * 10.0 + by * (k % 2) as f64, (k / 8) as f64 * 10.0);
        Spread::new((0..64).map(at).collect(), [Some(80.0); 2], 10.0, 5.0)
    }

    #[test]
    fn clumps_weigh_more_than_even_places() {
        let all: Vec<usize> = (0..64).collect();
        let loads = [0.0, 2.0, 4.0, 6.0].map(|by| spread(by).loads(&all, || Ok(())).unwrap());
        assert!(loads.windows(2).all(|pair| pair[1] > 1.01 * pair[0]), "{loads:?}");
    }

    #[test]
    fn a_place_that_was_set_counts_where_it_is_now_and_across_the_border() {
        let mut spread = spread(0.0);
        let alone = spread.load(0, Point::new(0.0, 0.0));
        // The neighbours beyond the border come nearer.
        spread.set(7, Point::new(75.0, 0.0));
        let moved = spread.load(0, Point::new(0.0, 0.0));
        assert!(moved > alone + 0.1, "{alone} {moved}");
        assert_eq!(spread.settled().load(0, Point::new(0.0, 0.0)).to_bits(), moved.to_bits());
    }
}
