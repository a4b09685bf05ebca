//! Periods of a page. An offset from the canvas to the page that misses them costs more, on every level.

/// Cost of a source whose offset misses the periods by one cell more than the tolerance, as a share of the
/// squared standard deviation. It grows with the square of the excess.
const ASTRAY: f32 = 4.0;
/// Least distance by which an offset may miss, in cells: sources are whole cells.
const LEAST: f32 = 0.75;

/// The periods of a page and of the canvas. A source suits a cell if both have the same phase: their
/// distances from the origin, in periods, differ by whole numbers. For rows, the second period is zero
/// throughout.
#[derive(Clone, Debug, PartialEq)]
pub struct Periods {
    /// Two vectors on the page, in cells.
    pub vectors: [[f32; 2]; 2],
    /// Number of periods along each vector for a step of one cell of the page, by axis.
    pub page: [[f32; 2]; 2],
    /// The same on the canvas, which may be stretched.
    pub canvas: [[f32; 2]; 2],
    /// Number of cells of the canvas before the cell whose phase equals that of the page's first cell.
    pub margin: [f32; 2],
    /// Distance by which offsets may miss, in cells.
    pub tolerance: f32,
}

impl Periods {
    /// The periods in cells twice as large.
    pub(super) fn halved(&self) -> Self {
        let all = |list: [[f32; 2]; 2], factor: f32| list.map(|v| v.map(|c| c * factor));
        Self {
            vectors: all(self.vectors, 0.5),
            page: all(self.page, 2.0),
            canvas: all(self.canvas, 2.0),
            margin: self.margin.map(|v| v * 0.5),
            tolerance: self.tolerance * 0.5,
        }
    }

    /// The phase of a cell of the page.
    pub(super) fn on_page(&self, cell: [f32; 2]) -> [f32; 2] {
        self.page.map(|wave| wave[0] * cell[0] + wave[1] * cell[1])
    }

    /// The phase of a cell of the canvas.
    pub(super) fn on_canvas(&self, cell: [f32; 2]) -> [f32; 2] {
        let [x, y] = [0, 1].map(|k| cell[k] - self.margin[k]);
        self.canvas.map(|wave| wave[0] * x + wave[1] * y)
    }

    /// The offset, in cells, of a source from the nearest place that would suit the cell, given the phases of
    /// both.
    #[inline]
    pub(super) fn residual(&self, page: [f32; 2], canvas: [f32; 2]) -> [f32; 2] {
        // Written out, because an exhaustive search spends most of its time here.
        let (u, v) = (page[0] - canvas[0], page[1] - canvas[1]);
        let (u, v) = (u - nearest_whole(u), v - nearest_whole(v));
        let [a, b] = &self.vectors;
        [u * a[0] + v * b[0], u * a[1] + v * b[1]]
    }

    /// Cost of a source for a cell, as a share of the squared standard deviation, given the phases of both.
    #[inline]
    pub(super) fn cost(&self, page: [f32; 2], canvas: [f32; 2]) -> f32 {
        let [x, y] = self.residual(page, canvas);
        let (square, free) = (x * x + y * y, self.tolerance.max(LEAST));
        if square <= free * free {
            return 0.0;
        }
        let over = square.sqrt() - free;
        ASTRAY * over * over
    }
}

/// The whole number nearest to a value below four million: sums of this size have no fraction.
#[inline]
fn nearest_whole(v: f32) -> f32 {
    const NO_FRACTION: f32 = 12_582_912.0;
    (v + NO_FRACTION) - NO_FRACTION
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_a_whole_number_of_periods_away_are_free() {
        let vectors = [[12.0, 2.0], [-3.0, 9.0]];
        let determinant = 12.0 * 9.0 + 2.0 * 3.0;
        let waves = [[9.0 / determinant, 3.0 / determinant], [-2.0 / determinant, 12.0 / determinant]];
        let periods = Periods { vectors, page: waves, canvas: waves, margin: [0.0; 2], tolerance: 0.0 };
        let cost =
            |source: [f32; 2], cell: [f32; 2]| periods.cost(periods.on_page(source), periods.on_canvas(cell));
        for (n, m) in [(0.0, 0.0), (3.0, -2.0), (-7.0, 5.0)] {
            let source = [40.0 + n * 12.0 - m * 3.0, 50.0 + n * 2.0 + m * 9.0];
            assert!(cost(source, [40.0, 50.0]) < 1e-3);
            let [x, y] = periods
                .residual(periods.on_page([source[0] + 2.0, source[1]]), periods.on_canvas([40.0, 50.0]));
            assert!((x - 2.0).abs() < 1e-3 && y.abs() < 1e-3);
            assert!((cost([source[0], source[1] + 2.75], [40.0, 50.0]) - ASTRAY * 4.0).abs() < 0.05);
        }
        let rows = Periods {
            vectors: [[0.0, 8.0], [0.0; 2]],
            page: [[0.0, 0.125], [0.0; 2]],
            canvas: [[0.0, 0.125], [0.0; 2]],
            margin: [0.0; 2],
            tolerance: 0.0,
        };
        assert_eq!(rows.cost(rows.on_page([91.5, 24.0]), rows.on_canvas([3.0, 8.0])), 0.0);
        assert!(rows.cost(rows.on_page([3.0, 12.0]), rows.on_canvas([3.0, 8.0])) > 30.0);
    }
}
