//! What error a byte is worth: the one measure by which shapes are joined, filled and left out.

use super::grid::Grid;
use super::moments::Moments;
use crate::library::{AnalyzeParams, Shading};

/// Squared error over all components (8-bit steps) that a byte is worth at a fidelity of 1 px.
const BYTE: f64 = 16.0;
/// Bytes of a gradient.
const GRADIENT: f64 = 145.0;
/// Least pixels of a gradient at a fidelity of 1 px: through fewer, noise and the blocks of JPEG lay
/// slopes that glare like chrome.
const GRADIENT_AREA: f64 = 80.0;
/// Bytes of a pixel of border.
const BORDER: f64 = 9.0;
/// Bytes of a secondary beside its border.
pub(super) const SECONDARY: f64 = 120.0;
/// Halvings of the range of prices when one is sought.
const HALVINGS: usize = 16;

/// What fills may be, and what a byte is worth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Price {
    /// Least cells of a region that a gradient may fill; infinite if all fills are flat.
    pub(super) gradient_area: f64,
    /// Squared error over all cells and components (8-bit steps) that a byte is worth.
    pub(super) byte: f64,
    /// Bytes of a border as long as a cell, which the shapes on both sides draw.
    pub(super) border: f64,
}

impl Price {
    /// What fidelity makes of it: outlines twice as coarse go with twice the error for a byte. Few
    /// colours leave no room for gradients.
    pub(super) fn new(params: &AnalyzeParams, grid: Grid) -> Self {
        let gradients = params.shading == Shading::Gradient && params.colors == 0;
        let gradient_area =
            if gradients { GRADIENT_AREA * params.fidelity * grid.area() } else { f64::INFINITY };
        Self { gradient_area, byte: BYTE * params.fidelity * grid.area(), border: BORDER / grid.along() }
    }

    /// The lowest price, from this one on, at which there are at most so many shapes. `count` falls
    /// as prices rise; where even the highest price leaves too many, that one.
    pub(super) fn within(self, most: usize, count: impl Fn(Self) -> usize) -> Self {
        if count(self) <= most {
            return self;
        }
        let at = |doublings: f64| Self { byte: self.byte * libm::exp2(doublings), ..self };
        let (mut low, mut high) = (0.0, 40.0);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if count(at(middle)) <= most { high = middle } else { low = middle }
        }
        at(high)
    }

    /// What a region costs without its border, and whether a gradient is the better fill.
    pub(super) fn of(self, sums: &Moments) -> (f64, bool) {
        let flat = sums.flat_error();
        if sums.count() < self.gradient_area {
            return (flat, false);
        }
        let gradient = sums.gradient_error() + GRADIENT * self.byte;
        (flat.min(gradient), gradient < flat)
    }

    /// Whether a secondary is worth its bytes, so many cells whose colour differs so much from
    /// the ground.
    pub(super) fn affords(self, area: u32, difference: [i16; 3]) -> bool {
        let squares: f64 = difference.iter().map(|&d| f64::from(d) * f64::from(d)).sum();
        f64::from(area) * squares >= SECONDARY * self.byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_price_that_is_high_enough() {
        let start = Price::new(&AnalyzeParams::default(), Grid { cells: 2 });
        // Shapes fall with the square root of the price.
        let count = |p: Price| (1000.0 / libm::sqrt(p.byte / start.byte)) as usize;
        assert_eq!(start.within(1000, count).byte, start.byte);
        let found = start.within(100, count);
        assert_eq!(count(found), 100);
        assert!(count(Price { byte: found.byte * 0.95, ..found }) > 100);
        assert!(start.within(0, |_| 5).byte > 1e9 * start.byte);
    }
}
