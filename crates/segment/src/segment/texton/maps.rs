//! Maps with several channels.

use vtex_base::parallel::for_chunks;

/// The number of channels is a multiple of this: the length of the widest vectors.
pub(super) const WIDE: usize = 16;

/// Maps of the same size, one for each channel.
pub(super) struct FeatureMaps {
    /// A multiple of [`WIDE`].
    pub(super) channels: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    /// The channels of each cell, cells in rows.
    values: Vec<f32>,
}

impl FeatureMaps {
    pub(super) fn zeros(channels: usize, width: usize, height: usize) -> Self {
        Self::of(channels, width, height, vec![0.0; channels * width * height])
    }

    /// Maps from the channels of each cell, cell by cell in rows.
    pub(super) fn of(channels: usize, width: usize, height: usize, values: Vec<f32>) -> Self {
        assert!(channels.is_multiple_of(WIDE) && values.len() == channels * width * height);
        Self { channels, width, height, values }
    }

    /// The channels of each cell, cells in rows.
    pub(super) fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// The channels of a cell.
    pub(super) fn cell(&self, x: usize, y: usize) -> &[f32] {
        &self.values[(y * self.width + x) * self.channels..][..self.channels]
    }

    /// The channels of a cell, or `outside` where there is none.
    pub(super) fn cell_or<'a>(&'a self, x: isize, y: isize, outside: &'a [f32]) -> &'a [f32] {
        match (usize::try_from(x), usize::try_from(y)) {
            (Ok(x), Ok(y)) if x < self.width && y < self.height => self.cell(x, y),
            _ => outside,
        }
    }

    /// Replaces rows by all rows of other maps of the same width and number of channels.
    pub(super) fn set_rows(&mut self, first: usize, rows: Self) {
        let start = first * self.width * self.channels;
        self.values[start..start + rows.values.len()].copy_from_slice(&rows.values);
    }

    /// Calls `f(k, rows)` for each `count` rows (fewer at the end), on several threads.
    pub(super) fn for_rows(&mut self, count: usize, f: impl Fn(usize, &mut [f32]) + Sync + Send) {
        for_chunks(&mut self.values, count * self.width * self.channels, f);
    }

    /// Adds maps of half the size, enlarged by linear interpolation.
    pub(super) fn add_enlarged(&mut self, half: &Self) {
        // The nearest cell, and the next one on the other side of the sample.
        let next = |v: usize, n: usize| {
            if v.is_multiple_of(2) { (v / 2).saturating_sub(1) } else { (v / 2 + 1).min(n - 1) }
        };
        let channels = self.channels;
        self.for_rows(1, |y, row| {
            let (near, far) = (y / 2, next(y, half.height));
            for (x, cell) in row.chunks_exact_mut(channels).enumerate() {
                let (here, beside) = (x / 2, next(x, half.width));
                let corners = half.cell(here, near).iter().zip(half.cell(here, far));
                let others = half.cell(beside, near).iter().zip(half.cell(beside, far));
                for ((value, (a, b)), (c, d)) in cell.iter_mut().zip(corners).zip(others) {
                    *value += 0.75 * (0.75 * a + 0.25 * b) + 0.25 * (0.75 * c + 0.25 * d);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_linear_stays_so_enlarged() {
        let mut half = FeatureMaps::zeros(WIDE, 6, 4);
        for (k, value) in half.values.iter_mut().enumerate() {
            let (channel, x, y) = (k % WIDE, k / WIDE % 6, k / WIDE / 6);
            *value = (x + 10 * y + 100 * channel) as f32;
        }
        let mut whole = FeatureMaps::zeros(WIDE, 12, 8);
        whole.add_enlarged(&half);
        for (y, x) in (1..7).flat_map(|y| (1..11).map(move |x| (y, x))) {
            let expected = 100.0 + (x as f32 - 0.5) / 2.0 + 10.0 * (y as f32 - 0.5) / 2.0;
            assert!((whole.cell(x, y)[1] - expected).abs() < 1e-4, "{x} {y}");
        }
        assert_eq!(whole.cell(0, 0)[0], 0.0);
    }
}
